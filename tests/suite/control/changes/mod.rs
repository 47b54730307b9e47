//! `saoms plan`, `saoms apply` and `saoms run --watch`.

mod again;
mod apply;
mod borders;
mod leaving;
mod plan;
mod watch;

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use super::{Running, component, composite, fleet};

const WORLD: &str = "<reference name=\"world\" target=\"World\"/>";

/// The fleet with another robot and without the one that waits, whose master has another period.
fn other() -> String {
    let period = "<property name=\"period\">50</property>";
    let master = component("Master", "saoms.MasterEnvironment", "");
    composite(
        &[
            component("World", "saoms.World", ""),
            master.replace(period, "<property name=\"period\">100</property>"),
            component("Robot1", "saoms.Robot", WORLD),
            component("Robot3", "saoms.Robot", WORLD),
        ]
        .concat(),
    )
}

/// Writes another composite beside the first one.
fn write(running: &Running, text: &str) {
    fs::write(running.folder().join("other.composite"), text).unwrap();
}

/// What the log has of a component that is asked to leave.
const LEAVES: &str = "leaves, once it has finished what it has begun";

/// How often the log has it.
fn logged(running: &Running, what: &str) -> usize {
    running.told(&["logs", "--lines", "1000"]).matches(what).count()
}

/// Waits until the log has it so often.
#[track_caller]
fn until_logged(running: &Running, what: &str, times: usize) {
    for _ in 0..1000 {
        if logged(running, what) >= times {
            return;
        }
        sleep(Duration::from_millis(10));
    }
    panic!("`{what}` is not so often in the log:\n{}", running.told(&["logs", "--lines", "1000"]));
}
