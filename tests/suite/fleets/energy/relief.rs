//! Robots that go to charge, and are relieved by robots that sleep.

use std::time::Duration;

use saoms_testkit::{Fleet, Run};

/// A robot that arrives at its charger with 46 %, one that sleeps with 90 % and does not answer, and one that sleeps
/// with a battery of this level.
fn relieved(battery: u32) -> Run {
    let property = |name: &str, value: &str| format!("<property name=\"{name}\">{value}</property>");
    let component = |name: &str, class: &str, more: &str| {
        let given = property("ID", name) + &property("period", "100");
        format!("<component name=\"{name}\"><implementation.rust class=\"saoms.{class}\"/>{given}{more}</component>\n")
    };
    let scenario = "at 500ms for 5min stall Robot2; at 1s luggage (5,0) to (8,2); at 25s end";
    let mut text = component("World", "World", &(property("width", "11") + &property("height", "5")))
        + &component("Master", "MasterEnvironment", "")
        + &component("Environment", "Environment", &property("scenario", scenario));
    for (number, level, asleep) in [(1, 66, "false"), (2, 90, "true"), (3, battery, "true")] {
        let own = [("chargeX", "0"), ("dischargePerBlock", "1"), ("chargePerSecond", "0.1"), ("asleep", asleep)];
        let own = own.map(|(name, value)| property(name, value)).concat();
        let level = property("battery", &level.to_string()) + &property("chargeY", &(number - 1).to_string());
        let wire = "<reference name=\"world\" target=\"World\"/>";
        text += &component(&format!("Robot{number}"), "Robot", &[own, level, wire.to_owned()].concat());
    }
    let fleet = Fleet::of_text(format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"f\" targetNamespace=\"urn:f\">\n\
         {text}</composite>"
    ));
    fleet.run(1, Duration::from_secs(30))
}

#[test]
fn a_robot_is_relieved_by_one_with_more_charge_alone() {
    for (battery, is_better) in [(12, false), (44, false), (60, true)] {
        let run = relieved(battery);
        let log = run.log_of("Robot1");
        let asked = |number: u32| log.contains(&format!("wakes robot {number} to stand in for robot 1"));
        assert_eq!((asked(2), asked(3)), (true, is_better), "{battery} %: {}", run.log());
        assert_eq!(run.log_of("Robot3").contains(&"wakes up".to_owned()), is_better, "{battery} %: {}", run.log());
    }
}
