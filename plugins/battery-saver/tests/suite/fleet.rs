//! A robot with the saver beside one without, with the plugin's code linked in.

use std::time::Duration;

use saoms_battery_saver as _;
use saoms_testkit::{Fleet, Run};

/// The level below which the composite lets the battery of the robot with the saver not come, in percent.
const FLOOR: f64 = 50.0;

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
    // How low it comes before that depends on the roads, which it shares with the other one.
    let saver = run.journal().of("Robot1").of_loop("Saver").texts();
    let is_too_low = |text: &str| {
        let level = text.strip_prefix("battery was down to ")?.strip_suffix(" %, which is too low")?;
        Some(level.parse::<f64>().ok()? < FLOOR)
    };
    let judged: Vec<&str> =
        saver.iter().map(|text| if is_too_low(text) == Some(true) { "too low" } else { text.as_str() }).collect();
    let charges_earlier = [
        ["too low", "charges at 60 % from now on", "chargeAt: 0 -> 60"],
        ["too low", "charges at 70 % from now on", "chargeAt: 60 -> 70"],
    ];
    assert_eq!(judged, charges_earlier.concat(), "{saver:?}");
    let (with, without) = (turned(&run, "Robot1"), turned(&run, "Robot9"));
    // It turns earlier from then on, unless it has luggage to bring away first.
    let earlier = with.iter().filter(|battery| **battery >= 60.0).count();
    assert!(with[0] < 60.0 && 2 * earlier > with.len(), "{with:?}");
    assert!(with.iter().any(|battery| *battery >= 70.0), "{with:?}");
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
