//! The manual's section 8.3: scenario 2 after a landing.

use super::run::Run;
use super::scenario2::{FIRST, SECOND};

#[test]
fn the_landing_changes_nothing_where_all_robots_are_awake() {
    let run = Run::of("scenario3.composite", 200);
    assert_eq!(run.story("Robot001"), FIRST);
    assert_eq!(run.story("Robot002"), SECOND);
    assert_eq!(run.count("luggage", "delivered"), 4);
}
