//! Somebody at the port of the relay who is no program of the fleet.

use std::io::Write;
use std::net::TcpStream;
use std::thread::sleep;
use std::time::Duration;

use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use saoms_api::host::cdr;
use saoms_core::network::exchange::wire::{Again, Alive, Covered, Enclosed, Envelope, Reads, Received, Sends, Welcome};

use super::programs::Programs;
use super::{reader, senders};

/// A frame of the relay.
fn frame(kind: u8, key: &str, message: &[u8], attachment: &[u8]) -> Vec<u8> {
    let mut frame = vec![kind];
    for part in [key.as_bytes(), message, attachment] {
        frame.extend((part.len() as u64).to_le_bytes());
        frame.extend(part);
    }
    frame
}

fn bytes() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec(any::<u8>(), 0..200)
}

/// Numbers at the edges of what there is.
fn edge() -> impl Strategy<Value = u64> {
    prop_oneof![Just(0), Just(1), 2..300_u64, Just(u64::MAX - 1), Just(u64::MAX), any::<u64>()]
}

fn key() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("saoms/2/alive/7".to_owned()),
        Just("saoms/2/topic/NUMBERS/Sender1".to_owned()),
        Just("saoms/2/topic/%F/%".to_owned()),
        "saoms/2/(ask|again|covered)/[0-9a-f]{1,16}(/NUMBERS)?",
        "[a-z0-9/*%]{0,20}",
    ]
}

/// A sign of life of a program that says what cannot be.
fn alive() -> impl Strategy<Value = Vec<u8>> {
    let numbers = prop::collection::vec(edge(), 11);
    let topic = prop_oneof![Just("NUMBERS"), Just("PRESENT"), Just("")];
    // A few programs, so that each says several things.
    (0..40_u64, numbers, topic, any::<bool>(), any::<bool>()).prop_map(|(program, number, topic, is_state, leaves)| {
        let topic = topic.to_owned();
        let alive = Alive {
            program,
            origin: number[9] % 40,
            start: number[10],
            began: number[10] % 40,
            name: "stranger".to_owned(),
            number: number[0],
            patience: number[1],
            sends: vec![Sends {
                topic: topic.clone(),
                is_state,
                last: number[2],
                oldest: number[3],
                before: number[8],
                ..Sends::default()
            }],
            reads: vec![Reads { topic: topic.clone() }],
            received: vec![Received { program: number[4], topic: topic.clone(), next: number[5] }],
            welcomes: vec![Welcome { reader: number[6], topic, first: number[7] }],
            // One that sees work left would keep the fleet from its end, as it may.
            vote: if leaves { 2 } else { 0 },
            leaves,
        };
        frame(0, &format!("saoms/2/alive/{program:x}"), &cdr::encode(&alive), &[])
    })
}

/// A message of such a program.
fn numbered() -> impl Strategy<Value = Vec<u8>> {
    let topic = prop_oneof![Just("NUMBERS"), Just("PRESENT")];
    (0..40_u64, edge(), topic, bytes(), any::<bool>()).prop_map(|(program, number, topic, message, has_key)| {
        let size = u32::try_from(message.len()).unwrap();
        let messages = vec![Enclosed { size, to: String::new(), key: 3, has_key, sent: 0, cause: number }];
        let envelope =
            Envelope { program, number, component: "Stranger".to_owned(), schema: 0, messages, cells: Vec::new() };
        frame(0, &format!("saoms/2/topic/{topic}/Stranger"), &message, &cdr::encode(&envelope))
    })
}

/// What somebody may send.
fn sent() -> impl Strategy<Value = Vec<u8>> {
    prop_oneof![
        bytes(),
        (key(), bytes(), bytes()).prop_map(|(key, message, attachment)| frame(0, &key, &message, &attachment)),
        (any::<u8>(), key(), bytes()).prop_map(|(kind, key, message)| frame(kind, &key, &message, &[])),
        alive(),
        numbered(),
    ]
}

/// Requests and answers, to every program: their keys are heard first by who listens.
fn asked(program: u64, numbers: &[u64]) -> Vec<Vec<u8>> {
    let (topic, first, last) = ("NUMBERS".to_owned(), numbers[0], numbers[1]);
    let again = Again { reader: 3, topic, first, last };
    let covered = Covered { program: 3, topic: "PRESENT".to_owned(), first, last, numbers: numbers.to_vec() };
    vec![
        frame(0, &format!("saoms/2/ask/{program:x}"), &cdr::encode(&again), &[]),
        frame(0, &format!("saoms/2/covered/{program:x}"), &cdr::encode(&covered), &[]),
    ]
}

/// The numbers of the programs that give a sign of life.
fn programs_at(port: u16) -> Vec<u64> {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream.write_all(&frame(1, "saoms/2/alive/*", &[], &[])).unwrap();
    sleep(Duration::from_secs(1));
    stream.set_nonblocking(true).unwrap();
    let mut heard = vec![0; 1 << 20];
    let size = std::io::Read::read(&mut stream, &mut heard).unwrap();
    let heard = String::from_utf8_lossy(&heard[..size]).into_owned();
    let digits = |text: &str| text.chars().take_while(char::is_ascii_hexdigit).collect::<String>();
    let mut programs: Vec<u64> =
        heard.split("saoms/2/alive/").skip(1).filter_map(|rest| u64::from_str_radix(&digits(rest), 16).ok()).collect();
    programs.sort_unstable();
    programs.dedup();
    programs
}

#[test]
fn a_fleet_goes_on_whatever_somebody_sends_to_its_broker() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = reader(&programs, "reader", programs.port, &[("count", "6000")]);
    let senders = senders(&programs, programs.port, &[("count", "6000"), ("each", "100")]);
    programs.until(&senders, "Sender2        begins");
    let known = programs_at(programs.port);
    assert_eq!(known.len(), 3, "broker, reader and senders: {known:x?}");
    let mut runner = TestRunner::new(Config { cases: 60, failure_persistence: None, ..Config::default() });
    let all = (prop::collection::vec(sent(), 1..12), prop::collection::vec(edge(), 4));
    let outcome = runner.run(&all, |(frames, numbers)| {
        let mut stream = TcpStream::connect(("127.0.0.1", programs.port)).unwrap();
        let asked = known.iter().flat_map(|program| asked(*program, &numbers));
        for frame in asked.chain(frames) {
            // The relay may have closed the connection.
            let _ = stream.write_all(&frame);
        }
        Ok(())
    });
    outcome.unwrap();
    for sender in ["Sender1", "Sender2"] {
        programs.until(&reader, &format!("has received 1 to 6000 of {sender}"));
    }
    // A stranger that says that it sees work left, or reads and never says what it received, is waited for.
    programs.stop(&reader);
    programs.stop(&senders);
    // What strangers claim to have sent may be lost.
    programs.end_without(&broker, &["wrong:", "panicked"]);
}

#[test]
fn a_program_of_another_version_is_told_once_and_not_heard() {
    let programs = Programs::new();
    let broker = programs.broker();
    let reader = reader(&programs, "reader", programs.port, &[("count", "10")]);
    programs.until(&reader, "has joined the network at");
    let stream = TcpStream::connect(("127.0.0.1", programs.port)).unwrap();
    // It may subscribe a moment after it has joined.
    programs.wait("the reader says nothing of the other version", || {
        (&stream).write_all(&frame(0, "saoms/1/alive/77", b"what no program of this version reads", &[])).unwrap();
        reader.printed().contains("speaks version 1 of its language, and this one version 2")
    });
    programs.until(&reader, "build both from one version");
    let senders = senders(&programs, programs.port, &[("count", "10"), ("each", "1")]);
    for sender in ["Sender1", "Sender2"] {
        programs.until(&reader, &format!("has received 1 to 10 of {sender}"));
    }
    assert_eq!(reader.printed().matches("speaks version 1").count(), 1, "{}", reader.printed());
    programs.stop(&senders);
    programs.stop(&reader);
    programs.stop(&broker);
}
