//! Clients that take nothing of what they asked for.

use std::io::Write;
use std::os::unix::net::UnixStream;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::exposition::read;
use super::metrics::metrics;
use super::{Running, fleet};

#[test]
fn a_client_that_reads_nothing_is_dropped_and_counted() {
    let running = Running::start(&fleet(), &["--stay"]);
    let listed: Value = serde_json::from_str(&running.told(&["ps", "--format", "json"])).unwrap();
    let mut client = UnixStream::connect(listed[0]["socket"].as_str().unwrap()).unwrap();
    // The answers soon fill what is kept for a client.
    let requests = "GET /v1/status HTTP/1.1\r\nHost: localhost\r\n\r\n".repeat(2000);
    client.write_all(requests.as_bytes()).unwrap();
    let count = |name: &str| read(&metrics(&running))[name].samples[0].1.1;
    assert_eq!(count("saoms_control_dropped_total"), 0.0);
    assert!(count("saoms_control_clients") >= 2.0);
    let is_dropped = (0..600).any(|_| {
        sleep(Duration::from_millis(100));
        count("saoms_control_dropped_total") > 0.0
    });
    assert!(is_dropped);
    // Nobody is connected any more but who asks.
    let is_alone = (0..100).any(|_| count("saoms_control_clients") == 1.0);
    assert!(is_alone);
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}
