//! A program that was stopped for long comes back while another one runs in its place.

use super::programs::{Given, Programs, Transport};
use super::{reader, receives_all, senders};

#[test]
fn a_program_that_returns_ends_and_readers_that_began_meanwhile_hear_its_successor_alone() {
    for transport in [Transport::Relay, Transport::Zenoh] {
        let programs = Programs::over(transport);
        let broker = programs.broker();
        let given: Given<'_> = &[("count", "10000"), ("each", "100")];
        let known = reader(&programs, "known", programs.port, &[("count", "10000")]);
        let first = senders(&programs, programs.port, given);
        programs.until(&first, "Sender2        begins");
        first.signal(libc::SIGSTOP);
        let second = senders(&programs, programs.port, &[given, &[("readers", "2")]].concat());
        programs.until(&second, "has joined the network");
        // It has not heard of the first one, which it will hear last.
        let later = reader(&programs, "later", programs.port, &[("count", "10000")]);
        programs.until(&second, "Sender2        begins");
        first.signal(libc::SIGCONT);
        programs.ends(&first, 1);
        let printed = first.printed();
        assert!(
            printed.contains("runs in program `senders` by now, which began while this one was not heard"),
            "{printed}"
        );
        receives_all(&programs, &later, "10000");
        receives_all(&programs, &known, "10000");
        programs.ends(&second, 0);
        for text in ["wrong:", "has begun anew", "are lost"] {
            assert!(!later.printed().contains(text), "{text}\n{}", later.printed());
        }
        assert!(!second.printed().contains("by now"), "{}", second.printed());
        programs.end_without(&broker, &["panicked"]);
    }
}
