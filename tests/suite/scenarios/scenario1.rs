//! The manual's section 8.1: one robot, three pieces of luggage.

use super::run::Run;

#[test]
fn the_robot_brings_two_pieces_charges_and_heals_itself() {
    let run = Run::of("scenario1.composite", 200);
    assert_eq!(
        run.story("Robot001"),
        "\
7: claims (3,1) to (3,10), 100.0
11: arrives, 96.0
12: collects, 94.0
22: arrives, 74.0
23: deposits, 72.0
24: claims (1,5) to (10,5), 70.0
32: arrives, 54.0
33: collects, 52.0
43: arrives, 32.0
44: deposits, 30.0
45: goes under charge, 28.0
59: is in charge, 0.0
69: is charged, would heal 1, 100.0
70: heals and is awake, claims (10,8) to (1,8), 100.0
88: arrives, 68.0
89: collects, 66.0
99: arrives, 46.0
100: deposits, 44.0
"
    );
    assert_eq!(run.count("luggage", "delivered"), 3);
}

#[test]
fn it_goes_as_in_figures_8_4_and_8_6() {
    let run = Run::of("scenario1.composite", 200);
    let step = |number| run.execution("Robot001", number).step();
    assert_eq!(step(8), Some(("(0,1)", "(1,1)")));
    assert_eq!(step(9), Some(("(1,1)", "(2,1)")));
    assert_eq!(step(10), Some(("(2,1)", "(3,1)")));
    assert_eq!(step(58), Some(("(1,1)", "(0,1)")));
    let battery = |number| run.execution("Robot001", number).battery();
    for number in 0..=9 {
        assert_eq!(battery(number), Some("100.0"));
    }
    assert_eq!((battery(10), battery(60), battery(61)), (Some("98.0"), Some("10.0"), Some("20.0")));
}
