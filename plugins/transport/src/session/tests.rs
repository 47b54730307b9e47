use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::sync::mpsc;

use super::*;
use crate::mqtt::Mqtt;
use crate::tls::Files;

/// What a broker of MQTT 5 says that lets a program in, and has quality of service 0 alone.
const ACCEPTS: &[u8] = &[0x20, 5, 0, 0, 2, 0x24, 0];

struct Links(Mutex<mpsc::Sender<(bool, String)>>);

impl Listener for Links {
    fn deliver(&self, _: u64, _: Message<'_>) -> bool {
        true
    }

    fn link(&self, is_up: bool, reason: &str) {
        let _ = lock(&self.0).send((is_up, reason.to_owned()));
    }
}

/// A broker that answers so many connections at once, and ends them, and the next one only after more than the time
/// for which a network of a fleet opens. The thread ends with that connection.
fn broker(at_once: usize) -> (Settings, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let settings = Settings::new(format!("mqtt://{}", listener.local_addr().unwrap()), None, Files::default());
    let thread = thread::spawn(move || {
        let mut heard = [0; 256];
        for _ in 0..at_once {
            let (mut stream, _) = listener.accept().unwrap();
            assert!(stream.read(&mut heard).unwrap() > 0);
            stream.write_all(ACCEPTS).unwrap();
        }
        let (mut stream, _) = listener.accept().unwrap();
        assert!(stream.read(&mut heard).unwrap() > 0);
        stream.set_read_timeout(Some(OPENING + OPENING / 2)).unwrap();
        if stream.read(&mut heard).is_ok() {
            // The program has given it up.
            return;
        }
        stream.write_all(ACCEPTS).unwrap();
        stream.set_read_timeout(None).unwrap();
        while stream.read(&mut heard).is_ok_and(|bytes| bytes > 0) {}
    });
    (settings, thread)
}

/// What the program hears of its link.
type Told = mpsc::Receiver<(bool, String)>;

fn join(settings: Settings) -> (Result<Session<Mqtt>, Failure>, Told) {
    let (links, told) = mpsc::channel();
    (Session::join(settings, Box::new(Links(Mutex::new(links)))), told)
}

#[test]
fn a_broker_that_takes_its_time_is_waited_for_unless_the_network_of_a_fleet_opens() {
    let (settings, slow) = broker(0);
    drop(join(settings).0.map_err(|failure| failure.text).unwrap());
    slow.join().unwrap();

    let (settings, slow) = broker(0);
    let text = join(Settings { is_of_fleet: true, ..settings }).0.map(drop).unwrap_err().text;
    assert!(text.starts_with("it does not answer as an MQTT broker does within 400ms"), "{text}");
    slow.join().unwrap();

    let (settings, slow) = broker(1);
    let (session, told) = join(Settings { is_of_fleet: true, ..settings });
    let told: Vec<(bool, String)> = told.iter().take(2).collect();
    assert_eq!(told, [(false, "the broker is away".to_owned()), (true, String::new())]);
    drop(session);
    slow.join().unwrap();
}

#[test]
fn what_may_not_be_read_is_named() {
    let settings = |is_of_fleet| {
        let account = Some(("robots".to_owned(), "sesame".to_owned()));
        Settings { is_of_fleet, ..Settings::new("mqtt://localhost:1883".to_owned(), account, Files::default()) }
    };
    let said = |is_of_fleet| not_read(&settings(is_of_fleet), "uagv/v2/ACME/7/state");
    let own = "the broker does not let user `robots` read `uagv/v2/ACME/7/state`";
    assert_eq!(said(false), format!("{own}: allow it that"));
    assert_eq!(said(true), format!("{own}, which a fleet needs: allow it all that begins with `saoms`"));
}
