//! A server of the web that is not ours.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};
use std::thread::spawn;

/// A server that answers each request as this code does, which gets the connection after the request was read, and
/// what was asked.
pub(crate) fn answering(answer: impl Fn(&mut TcpStream, &str) + Send + 'static) -> (String, Receiver<String>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let (told, asked) = channel();
    spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let mut request = Vec::new();
            let mut part = [0; 4096];
            let body = b"{\"least\":1}";
            while !request.ends_with(body) {
                match stream.read(&mut part) {
                    Ok(0) | Err(_) => break,
                    Ok(count) => request.extend_from_slice(&part[..count]),
                }
            }
            let request = String::from_utf8_lossy(&request).into_owned();
            if told.send(request.clone()).is_err() {
                return;
            }
            answer(&mut stream, &request);
        }
    });
    (address, asked)
}

/// The same answer to each request.
pub(crate) fn plain(answer: &'static str) -> impl Fn(&mut TcpStream, &str) + Send + 'static {
    move |stream, _| stream.write_all(answer.as_bytes()).unwrap()
}
