//! A robot with the saver beside one without, with the plugin's code linked in.

use std::time::Duration;

use saoms_battery_saver as _;
use saoms_testkit::{Fleet, Run};

/// Battery levels, in percent, at which a robot returned to its charger.
fn turned(run: &Run, robot: &str) -> Vec<f64> {
    let percent = |line: &String| line.strip_prefix("battery is low (")?.split_once(' ')?.0.parse().ok();
    run.log_of(robot).iter().filter_map(percent).collect()
}

#[test]
fn the_robot_learns_to_charge_in_time() {
    let fleet = Fleet::of_file("fleet.composite");
    assert_eq!(fleet.diagnostics(), "");
    let run = fleet.run(0, Duration::from_secs(100));
    assert_eq!(run.sections["luggage"]["delivered"], 40, "{}", run.log());
    let saver = run.journal().of("Robot1").of_loop("Saver").texts();
    assert_eq!(
        saver,
        [
            "battery was down to 28 %, which is too low",
            "charges at 60 % from now on",
            "chargeAt: 0 -> 60",
            "battery was down to 34 %, which is too low",
            "charges at 70 % from now on",
            "chargeAt: 60 -> 70",
        ]
    );
    let (with, without) = (turned(&run, "Robot1"), turned(&run, "Robot9"));
    assert!(with.len() > 3 && with[2..].iter().all(|battery| *battery >= 60.0), "{with:?}");
    assert!(without.iter().all(|battery| *battery < 60.0), "{without:?}");
}

#[test]
fn two_loops_that_set_when_a_robot_charges_are_an_error() {
    let text = std::fs::read_to_string("fleet.composite").unwrap();
    let second = "<saoms:loop name=\"Second\" class=\"saver.BatterySaver\"/></component>";
    let robot = text.replacen("</saoms:loop>\n  </component>", &format!("</saoms:loop>{second}"), 1);
    let found = Fleet::of_text(robot).diagnostics();
    assert!(found.contains("chargeAt") && found.starts_with("error"), "{found}");
}
