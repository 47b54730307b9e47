//! Bad lines between a program and its broker.

use std::thread::sleep;
use std::time::Duration;

use super::programs::{Programs, Transport};
use super::proxy::{Line, Proxy};
use super::{MANY, beside_each_other, reader, receives_all, senders, took_little_memory};

/// All events arrive over the proxy, to which this happens while they are sent: with the reader behind it, and with the
/// senders, over each transport. Some program says this then.
#[track_caller]
fn all_arrive(line: Line, count: &str, each: &str, happens: impl Fn(&Proxy) + Sync, said: &str) {
    let trial = |transport, is_reader_behind: bool| {
        let programs = Programs::over(transport);
        let broker = programs.broker();
        programs.until(&broker, "listens at");
        let proxy = Proxy::to(programs.port, line);
        let ports = if is_reader_behind { (proxy.port, programs.port) } else { (programs.port, proxy.port) };
        let reader = reader(&programs, "reader", ports.0, &[("count", count)]);
        let senders = senders(&programs, ports.1, &[("count", count), ("each", each)]);
        programs.until(&senders, "Sender2        begins");
        happens(&proxy);
        receives_all(&programs, &reader, count);
        programs.ends(&senders, 0);
        programs.end(&broker);
        took_little_memory(&programs);
        assert!(programs.printed().contains(said), "{}", programs.printed());
    };
    beside_each_other(&[
        &|| trial(Transport::Relay, true),
        &|| trial(Transport::Relay, false),
        &|| trial(Transport::Zenoh, true),
        &|| trial(Transport::Zenoh, false),
    ]);
}

#[test]
fn events_arrive_over_a_slow_line() {
    // Each way: an answer takes twice as long.
    let line = Line { delay: Duration::from_millis(200), few: 0 };
    all_arrive(line, MANY, "1000", |_| {}, "");
}

#[test]
fn events_arrive_in_bits() {
    let line = Line { delay: Duration::ZERO, few: 500 };
    all_arrive(line, MANY, "1000", |_| {}, "");
    let line = Line { delay: Duration::ZERO, few: 7 };
    all_arrive(line, "60", "3", |_| {}, "");
}

#[test]
fn events_arrive_over_a_line_that_breaks_again_and_again() {
    let cuts = |proxy: &Proxy| {
        for _ in 0..5 {
            sleep(Duration::from_millis(300));
            proxy.cut();
        }
    };
    all_arrive(Line::default(), MANY, "1000", cuts, "the link to the network was lost");
}

#[test]
fn events_arrive_after_a_line_that_was_dead_without_a_word() {
    let swallows = |proxy: &Proxy| {
        proxy.swallow();
        sleep(Duration::from_secs(2));
        proxy.cut();
    };
    all_arrive(Line::default(), MANY, "1000", swallows, "gives no sign of life");
}
