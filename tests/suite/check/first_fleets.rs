//! What new users meet in their first fleets: one mistake, told once, where it was made.

use std::fs;

use saoms_testkit::Fleet;

use super::hints::{assert_hint, told_of};
use super::rules::{Component, MASTER, ROBOT, found};
use crate::support::root;

fn with(scenario: &str, others: &[Component<'_>]) -> Vec<String> {
    let scenario = [("scenario", scenario)];
    found(&[&[("Environment", "saoms.Environment", &scenario[..], false)], others].concat())
}

const WORLD: Component<'_> = ("World", "saoms.World", &[], false);

#[test]
fn a_fleet_without_robots_is_told_once() {
    let none = "warning S5008 there is no robot to bring the luggage of this scenario";
    assert_eq!(with("at 1s luggage (3,1) to (4,1); at 2s breakdown Robot2", &[WORLD, MASTER]), [none]);
    // Without luggage only the event tells it.
    assert_eq!(with("at 2s breakdown Robot2", &[WORLD, MASTER]), ["error S5005 the fleet has no robot 2"]);
}

#[test]
fn a_robot_whose_battery_lasts_for_no_luggage_is_told_where_others_bring_it() {
    let weak = ("Robot2", "saoms.Robot", &[("discharge", "20")][..], true);
    let strong = ("Robot1", "saoms.Robot", &[("discharge", "1")][..], true);
    let told = with("at 1s luggage (5,1) to (9,1); at 2s luggage (4,4) to (8,8)", &[WORLD, MASTER, strong, weak]);
    let message = "warning S5006 robot 2 can bring no luggage of this scenario: it is at least 10 moves \
        from its charger; a full battery allows 1, there and back";
    assert_eq!(told, [message]);
    assert_eq!(with("at 1s luggage (1,1)..(2,2) to (0,2)..(5,5)", &[WORLD, MASTER, strong, weak]), [""; 0]);
}

#[test]
fn the_distance_of_luggage_is_that_of_the_robot_whose_battery_is_named() {
    let weak = ("Robot1", "saoms.Robot", &[("discharge", "15")][..], true);
    let better = ("Robot2", "saoms.Robot", &[("discharge", "4"), ("chargeX", "0")][..], true);
    let world = ("World", "saoms.World", &[("width", "30")][..], false);
    let told = with("at 1s luggage (12,1)..(20,1) to (1,1)", &[world, MASTER, weak, better]);
    assert!(told.len() == 1 && told[0].contains("(12,1) is 12 moves from the nearest charger"), "{told:?}");
    assert!(told[0].ends_with("a full battery allows 1, there and back"), "{told:?}");
}

#[test]
fn robots_that_share_a_charger_which_cannot_keep_them_charged_are_told() {
    let robots = |charge: &'static str| {
        let places = [("0", "5"), ("3", "5"), ("6", "5")];
        let values = places.map(|(x, y)| {
            let [level, at, gain] = [("dischargePerSecond", "6"), ("chargeY", "5"), ("chargePerSecond", charge)];
            vec![level, at, gain, ("startX", x), ("startY", y)]
        });
        let fleet = ["Robot1", "Robot2", "Robot3"].into_iter().zip(&values);
        let robots: Vec<Component<'_>> =
            fleet.map(|(id, values)| (id, "saoms.Robot", values.as_slice(), true)).collect();
        with("at 1s luggage (1,1) to (2,2)", &[&[WORLD, MASTER], robots.as_slice()].concat())
    };
    let message = "warning S5006 robots 1, 2, 3 share the charger at (0,5), and need it for 120 % of the time even if \
        they never move";
    assert_eq!(robots("9"), [message]);
    assert_eq!(robots("20"), [""; 0]);
}

#[test]
fn only_a_slip_in_the_name_of_a_robot_is_proposed() {
    let robots: Vec<Component<'_>> =
        vec![WORLD, MASTER, ROBOT, ("Robot02", "saoms.Robot", &[], true), ("Robot3", "saoms.Robot", &[], true)];
    let help = |name: &str| {
        let text = super::rules::fleet(
            &[
                &[(
                    "Environment",
                    "saoms.Environment",
                    &[("scenario", &*format!("at 1s breakdown {name}"))][..],
                    false,
                )],
                &robots[..],
            ]
            .concat(),
        );
        saoms_testkit::Fleet::of_text(text).shown()
    };
    let shown = help("Robot20");
    assert!(shown.contains("replace `Robot20` with `Robot02`"), "{shown}");
    let shown = help("Robot5");
    assert!(shown.contains("the robots are `Robot1`, `Robot02`, `Robot3`") && !shown.contains("replace"), "{shown}");
}

#[test]
fn a_world_without_robots_is_told_at_the_robots() {
    let text = super::rules::fleet(&[WORLD, ROBOT, ("Robot2", "saoms.Robot", &[], true)]);
    let unwired = text.replace(" target=\"World\"", "");
    let shown = saoms_testkit::Fleet::of_text(unwired).shown();
    assert!(shown.contains("robots `Robot1` and `Robot2` are not wired to the world"), "{shown}");
    assert!(shown.contains("----- the world") && shown.contains(" ^^^^^"), "{shown}");
}

#[test]
fn a_shift_shorter_than_a_period_is_told() {
    let fleet = include_str!("../../../composites/shift.composite").replace("value=\"15s\"", "value=\"15\"");
    let told = saoms_testkit::Fleet::of_text(fleet).diagnostics();
    let message = "S5013 31:34 a shift of 15ms is shorter than the period of `Robot2`, 100ms: the \
        component executes only once in a shift";
    assert!(told.lines().count() == 1 && told.contains(message), "{told}");
}

#[test]
fn one_mistake_in_a_fleet_of_replicas_is_told_once_with_what_to_do() {
    const HANGAR: &str = include_str!("../../../composites/hangar.composite");
    const TABLE: &str = include_str!("../../../composites/hangar.csv");
    let condition = r#"saoms:if="landings""#;
    for (test, written, arguments, code, help) in [
        ("no robots", condition, &["--set", "robots=0"][..], "S5008", "add a `saoms.Robot`"),
        ("no", condition, &["--set", "landings=no"], "S2045", "give it the value `false`"),
        ("zero", condition, &["--set", "landings=0"], "S2045", "give it the value `false`"),
        ("and", r#"saoms:if="landings AND robots > 3""#, &[], "S2045", "replace `AND` with `and`"),
        ("unless", r#"saoms:unless="landings""#, &[], "S1007", "its attributes of SAOMS are"),
        ("severity", condition, &["--severity", "S5009=off"], "S2048", "replace it with `allow`"),
        ("swapped", condition, &["--severity", "error=S5009"], "S2048", "write `S5009=error`: the code comes first"),
    ] {
        let fleet = HANGAR.replace(condition, written);
        let files = [("fleet.composite", fleet.as_str()), ("hangar.csv", TABLE)];
        let told = told_of(&format!("hangar {test}"), &files, &[&["fleet.composite"], arguments].concat());
        assert_hint(test, &told, code, help);
    }
    // A property beside which a component has a value of its own.
    let fleet = HANGAR.replace("name=\"landings\">true", "name=\"width\">24").replace(condition, "");
    let told = told_of("hangar unused", &[("fleet.composite", &fleet), ("hangar.csv", TABLE)], &["fleet.composite"]);
    assert_hint("unused", &told, "S2026", "let component `World` take the value, with `source=\"$width\"`");
}

#[test]
fn shipped_fleets_break_no_rule() {
    for entry in fs::read_dir(root().join("composites")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "composite") {
            let found = Fleet::of_file(&path).diagnostics();
            assert!(!found.contains(" S50"), "{}:\n{found}", path.display());
        }
    }
}
