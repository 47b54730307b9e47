//! The manual's section 8.2: two robots, four pieces of luggage.

use super::run::Run;

/// The acts of both robots in this scenario and, after a landing, in the next one.
pub(crate) const FIRST: &str = "\
8: claims (1,5) to (10,5), 100.0
14: arrives, 92.0
15: collects, 90.0
18: sees a risk of collision, 84.0
25: arrives, 70.0
26: deposits, 68.0
27: claims (3,1) to (3,10), 66.0
39: arrives, 42.0
40: collects, 40.0
50: arrives, 20.0
51: deposits, 18.0
52: goes under charge, 16.0
64: is in charge, 0.0
74: is charged, 100.0
";
pub(crate) const SECOND: &str = "\
6: claims (3,1) to (3,10), 100.0
11: arrives, 94.0
12: collects, 92.0
17: sees a risk of collision, 82.0
23: arrives, 70.0
24: deposits, 68.0
25: claims (10,8) to (1,8), 66.0
35: arrives, 46.0
36: collects, 44.0
46: arrives, 24.0
47: deposits, 22.0
48: goes under charge, 20.0
55: is in charge, 6.0
65: is charged, would heal 2, 100.0
66: heals and is awake, 100.0
67: would heal 1, 100.0
68: heals and awakes another, 100.0
";

#[test]
fn the_robots_share_the_luggage_and_heal_each_other() {
    let run = Run::of("scenario2.composite", 200);
    assert_eq!(run.story("Robot001"), FIRST);
    assert_eq!(run.story("Robot002"), SECOND);
    assert_eq!(run.count("luggage", "delivered"), 4);
}

#[test]
fn the_risk_of_figure_8_19_is_seen_and_is_a_collision() {
    let run = Run::of("scenario2.composite", 200);
    let step = |robot, number| run.execution(robot, number).step();
    assert_eq!(step("Robot001", 17), Some(("(2,5)", "(3,5)")));
    assert_eq!(step("Robot002", 17), None, "it stops");
    assert_eq!(step("Robot001", 18), Some(("(3,5)", "(4,5)")));
    assert_eq!(step("Robot002", 18), Some(("(3,5)", "(3,6)")));
    assert_eq!((run.count("collisions", "vertex"), run.count("collisions", "swap")), (1, 0));
}
