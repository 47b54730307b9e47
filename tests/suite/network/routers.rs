//! A router that is killed and started again while robots of several programs work.

use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::nodes::{at_node, start};
use super::programs::{Program, Programs, Transport, component};
use super::{MANY, took_little_memory};
use crate::support::stdout;

/// Pieces of luggage, and robots in each of the two programs.
const PIECES: u32 = 100;
const ROBOTS: u32 = 5;

/// A fleet with its router, its zone and its world, its robots, and all else in programs of their own.
fn write(programs: &Programs) {
    let url = programs.url(programs.port);
    let task = |name: &str, class: &str, more: &[(&str, &str)]| {
        let usual = [("ID", name), ("period", "100"), ("url", &url)];
        component(name, class, &[&usual, more].concat())
    };
    let broker = [("IP", "127.0.0.1"), ("port", &programs.port.to_string())];
    let map = "...........\n".repeat(11);
    let scenario = format!("from 1s every 200ms {PIECES} times luggage (4,0)..(10,10) to (1,0)..(3,10)");
    let mut components = task("Environment", "saoms.Environment", &[("scenario", &scenario)])
        + &task("Master", "saoms.MasterEnvironment", &[])
        + &at_node("router", component("Broker", "unibg.robotics.tca.MessageBrokerImpl", &broker))
        + &at_node("traffic", task("Zone", "saoms.Zone", &[("map", &map)]))
        + &at_node("traffic", task("World", "saoms.World", &[("width", "11"), ("height", "11")]));
    // Numbered events of two programs, of which a third one misses none.
    let numbers = [("count", MANY), ("each", "200")];
    components += &task("Sender1", "numbers.Sender", &numbers);
    components += &at_node("gate-a", task("Sender2", "numbers.Sender", &numbers));
    let reader = [("count", MANY), ("senders", "2"), ("queue", "200000")];
    components += &at_node("gate-b", task("Reader", "numbers.Reader", &reader));
    for robot in 1..=2 * ROBOTS {
        let name = format!("Robot{robot}");
        let one = task(&name, "saoms.Robot", &[("dischargePerBlock", "1"), ("chargePerSecond", "10")]);
        let one = one.replace("</component>", "<reference name=\"world\" target=\"World\"/></component>");
        components += &at_node(if robot <= ROBOTS { "gate-a" } else { "gate-b" }, one);
    }
    programs.write(
        "fleet.composite",
        &format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
             targetNamespace=\"urn:fleet\" name=\"fleet\" s:defaultNode=\"control\">\n{components}</composite>\n"
        ),
    );
}

#[test]
fn each_piece_is_delivered_once_although_the_router_is_started_again_twice() {
    let programs = Programs::over(Transport::Zenoh);
    write(&programs);
    let node = |node: &str| start(&programs, "fleet.composite", node, &[]);
    let mut router = node("router");
    let all: [Arc<Program>; 4] = ["control", "traffic", "gate-a", "gate-b"].map(node);
    for delivered in [PIECES / 4, PIECES / 2] {
        let deposited = || {
            let printed = [&all[2], &all[3]].map(|gate| gate.printed()).concat();
            printed.matches("deposited luggage").count()
        };
        programs.wait("luggage is delivered", || deposited() >= delivered as usize);
        // They are under way.
        let has_sent = [&all[0], &all[2]].iter().any(|program| program.printed().contains("has sent 1 to"));
        assert!(!has_sent, "{}", programs.printed());
        router.kill();
        sleep(Duration::from_secs(3));
        router = node("router");
    }
    for program in &all {
        programs.ends(program, 0);
    }
    router.signal(libc::SIGTERM);
    programs.ends(&router, 130);
    let printed = programs.printed();
    for piece in 1..=PIECES {
        for what in ["collected", "deposited"] {
            let found = printed.matches(&format!("{what} luggage {piece} at")).count();
            assert_eq!(found, 1, "luggage {piece} is {what} {found} times\n{printed}");
        }
    }
    for sender in ["Sender1", "Sender2"] {
        let received = format!("has received 1 to {MANY} of {sender}");
        assert_eq!(all[3].printed().matches(&received).count(), 1, "{received}\n{printed}");
    }
    took_little_memory(&programs);
    for sign in ["panicked", "are lost", "which was granted to", "wrong:"] {
        assert!(!printed.contains(sign), "{sign}\n{printed}");
    }
    let files = ["control.json", "traffic.json", "gate-a.json", "gate-b.json"];
    let merged = programs.saoms(&[&["report", "merge"], &files[..]].concat());
    let merged: Value = serde_json::from_str(&stdout(&merged)).unwrap();
    assert_eq!(merged["luggage"]["delivered"], PIECES);
    assert_eq!(merged["collisions"], serde_json::json!({"vertex": 0, "swap": 0}));
}
