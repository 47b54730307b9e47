//! Sockets of fleets that start and end while others look for them.

use std::os::unix::net::UnixListener;
use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use saoms_control::{Listener, default_socket, running};
use socket2::{Domain, SockAddr, Socket, Type};

#[test]
fn a_socket_is_not_taken_for_that_of_a_program_that_has_ended_while_it_is_made() {
    let path = default_socket("made", process::id());
    let has_ended = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !has_ended.load(Ordering::Relaxed) {
                running();
            }
        });
        let lost = (0..10_000).find_map(|_| match Listener::bind(&path) {
            Ok(_listener) => (!path.exists()).then(|| "its file was removed".to_owned()),
            Err(error) => Some(error.to_string()),
        });
        has_ended.store(true, Ordering::Relaxed);
        assert_eq!(lost, None);
    });
}

#[test]
fn a_fleet_that_was_stopped_with_a_full_queue_does_not_hold_up_who_looks_for_fleets() {
    let path = default_socket("stopped", process::id());
    drop(Listener::bind(&path).unwrap());
    let _takes_nobody = UnixListener::bind(&path).unwrap();
    let waiting: Vec<Socket> = std::iter::repeat_with(|| {
        let socket = Socket::new(Domain::UNIX, Type::STREAM, None).unwrap();
        socket.set_nonblocking(true).unwrap();
        socket.connect(&SockAddr::unix(&path).unwrap()).map(|()| socket)
    })
    .map_while(Result::ok)
    .collect();
    assert!(!waiting.is_empty());
    let (sender, looked) = channel();
    thread::spawn(move || sender.send(running()));
    // Without a bound it would wait for ever.
    let fleets = looked.recv_timeout(Duration::from_secs(30)).unwrap();
    assert!(fleets.iter().all(|(_, fleet)| fleet.name != "stopped"));
    assert!(path.exists());
    std::fs::remove_file(&path).unwrap();
}
