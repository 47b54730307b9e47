//! Clients that send no requests, too much, or too slowly, at the socket and on the network.

use std::fs;
use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use saoms_control::Client;

use super::{Served, served};

/// A connection to a server.
trait Connection: Read + Write {
    fn end_of_request(&self);
    fn wait_at_most(&self, time: Duration);
}

macro_rules! connection {
    ($stream:ty) => {
        impl Connection for $stream {
            fn end_of_request(&self) {
                // The server may have closed it.
                let _ = self.shutdown(Shutdown::Write);
            }

            fn wait_at_most(&self, time: Duration) {
                self.set_read_timeout(Some(time)).unwrap();
            }
        }
    };
}

connection!(UnixStream);
connection!(TcpStream);

/// A way to the server, with a head of headers that it wants, and its client.
struct Way<'a> {
    connect: Box<dyn Fn() -> Box<dyn Connection> + 'a>,
    headers: String,
    client: &'a Client,
}

fn ways(served: &Served) -> [Way<'_>; 2] {
    let token = fs::read_to_string(&served.token).unwrap();
    let headers = format!("Host: localhost\r\nAuthorization: Bearer {}\r\n", token.trim());
    [
        Way {
            connect: Box::new(|| Box::new(UnixStream::connect(&served.socket).unwrap())),
            headers: "Host: localhost\r\n".to_owned(),
            client: &served.client,
        },
        Way {
            connect: Box::new(|| Box::new(TcpStream::connect(&served.address).unwrap())),
            headers,
            client: &served.of_network,
        },
    ]
}

/// The status of what the server answers to these bytes; `None` if it closes without an answer.
fn status(way: &Way<'_>, bytes: &[u8]) -> Option<u16> {
    let mut connection = (way.connect)();
    let _ = connection.write_all(bytes);
    connection.end_of_request();
    let mut start = [0; 12];
    connection.read_exact(&mut start).ok()?;
    std::str::from_utf8(&start).unwrap().split(' ').nth(1)?.parse().ok()
}

#[test]
fn what_is_no_request_harms_nothing() {
    let served = served();
    for way in ways(&served) {
        let headers = &way.headers;
        let requests: Vec<Vec<u8>> = vec![
            b"GET /v1/status".to_vec(),
            vec![0xff; 300],
            vec![0; 20_000],
            b"\r\n\r\n\r\n".to_vec(),
            format!("GET /{} HTTP/1.1\r\n{headers}\r\n", "../".repeat(100)).into_bytes(),
            format!("GET /v1/../../../../etc/passwd HTTP/1.0\r\n{headers}\r\n").into_bytes(),
            format!("GET /v1/%2e%2e%2f%2e%2e%2fetc%2fpasswd HTTP/1.0\r\n{headers}\r\n").into_bytes(),
            format!("GET /v1/{} HTTP/1.0\r\n{headers}\r\n", "x".repeat(100_000)).into_bytes(),
            format!("POST /v1/events HTTP/1.1\r\n{headers}Content-Length: 99999999999999999999\r\n\r\n").into_bytes(),
            format!("POST /v1/events HTTP/1.1\r\n{headers}Content-Length: -1\r\n\r\n").into_bytes(),
            format!("POST /v1/events HTTP/1.1\r\n{headers}Content-Length: 1\r\nContent-Length: 2\r\n\r\nx")
                .into_bytes(),
            format!("POST /v1/events HTTP/1.1\r\n{headers}Transfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\n")
                .into_bytes(),
            format!("GET /v1/logs?lines=18446744073709551616 HTTP/1.0\r\n{headers}\r\n").into_bytes(),
            format!("GET / HTTP/1.1\r\n{headers}{}\r\n", "a: b\r\n".repeat(1000)).into_bytes(),
            format!("GET / HTTP/1.1\r\n{headers}a: {}\r\n\r\n", "b".repeat(100_000)).into_bytes(),
            format!("PUT /v1/components/%ff/properties/%00 HTTP/1.0\r\n{headers}Content-Length: 1\r\n\r\nx")
                .into_bytes(),
            format!("BREW /v1/fleet HTTP/1.0\r\n{headers}\r\n").into_bytes(),
            format!("GET /v1/fleet HTTP/9.9\r\n{headers}\r\n").into_bytes(),
        ];
        for number in 0..10_000 {
            let answered = status(&way, &requests[number % requests.len()]);
            assert!(answered.is_none_or(|status| (400..500).contains(&status)), "{number}: {answered:?}");
        }
        assert_eq!(way.client.description().unwrap().pid, 7);
    }
}

#[test]
fn a_body_that_is_too_long_is_refused() {
    let served = served();
    for way in ways(&served) {
        let headers = &way.headers;
        assert!(way.client.request("POST", "/v1/events", &"x".repeat(1_000_000)).is_err());
        assert!(way.client.request("POST", "/v1/events", &"x".repeat(65_536)).is_ok());
        let announced = format!("POST /v1/events HTTP/1.1\r\n{headers}Content-Length: 65537\r\n\r\n");
        assert_eq!(status(&way, announced.as_bytes()), Some(413));
        let chunk = format!("4000\r\n{}\r\n", "x".repeat(0x4000));
        let chunked = format!("POST /v1/events HTTP/1.1\r\n{headers}Transfer-Encoding: chunked\r\n\r\n");
        assert_eq!(status(&way, format!("{chunked}{}", chunk.repeat(5)).as_bytes()), Some(413));
    }
}

#[test]
fn one_more_client_than_there_are_places_is_told_so_and_hinders_no_other_way() {
    let served = served();
    let [socket, network] = ways(&served);
    for (way, other) in [(&network, &socket), (&socket, &network)] {
        let held: Vec<_> = (0..512).map(|_| (way.connect)()).collect();
        // The server takes them one after the other; where it is slow, the queue of the system is full in the meantime.
        let mut refusals = (0..500).filter_map(|_| Some(way.client.description().err()?.to_string()));
        let refused = refusals.find(|refused| !refused.contains("timed out")).unwrap();
        assert!(refused.contains("no more places"), "{refused}");
        assert_eq!(other.client.description().unwrap().pid, 7);
        drop(held);
        let served_again = (0..500).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            way.client.description().is_ok()
        });
        assert!(served_again);
    }
}

#[test]
fn who_leaves_the_server_waiting_is_left() {
    let served = served();
    for way in ways(&served) {
        let headers = &way.headers;
        let slow = [
            "GET /v1/fleet HT".to_owned(),
            format!("POST /v1/events HTTP/1.1\r\n{headers}Content-Length: 5\r\n\r\nab"),
            // The answer comes, and no further request.
            format!("GET /v1/fleet HTTP/1.1\r\n{headers}\r\n"),
        ];
        let mut connections: Vec<_> = slow.iter().map(|_| (way.connect)()).collect();
        for (connection, start) in connections.iter_mut().zip(&slow) {
            connection.write_all(start.as_bytes()).unwrap();
        }
        // A byte now and then makes no difference.
        let dripping = Instant::now();
        while dripping.elapsed() < Duration::from_secs(3) {
            let _ = connections[0].write_all(b"T");
            std::thread::sleep(Duration::from_millis(100));
        }
        for connection in &mut connections {
            connection.wait_at_most(Duration::from_secs(60));
            // It ends; a server that waits on would let this time out.
            let mut answer = Vec::new();
            let end = connection.read_to_end(&mut answer).map_err(|error| error.kind());
            assert!(!matches!(end, Err(std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut)), "{end:?}");
        }
        assert_eq!(way.client.description().unwrap().pid, 7);
    }
}
