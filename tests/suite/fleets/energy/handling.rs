//! Robots that handle luggage for long: standing takes less from a battery than driving.

use std::time::Duration;

use saoms_testkit::Fleet;

/// A robot with this battery, and luggage whose destination is six blocks from its charger.
fn fleet(battery: &[(&str, &str)]) -> Fleet {
    let property = |(name, value): &(&str, &str)| format!("<property name=\"{name}\">{value}</property>");
    let component = |name: &str, class: &str, properties: &[(&str, &str)], wire: &str| {
        let properties: String =
            [&[("ID", name), ("period", "100")], properties].concat().iter().map(property).collect();
        format!(
            "<component name=\"{name}\"><implementation.rust class=\"saoms.{class}\"/>{properties}{wire}</component>\n"
        )
    };
    let text = component("World", "World", &[("width", "5"), ("height", "5"), ("handlingTime", "1s")], "")
        + &component("Master", "MasterEnvironment", &[], "")
        + &component("Environment", "Environment", &[("scenario", "at 1s luggage (4,0) to (4,2)")], "")
        + &component("Robot1", "Robot", battery, "<reference name=\"world\" target=\"World\"/>");
    Fleet::of_text(format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"f\" targetNamespace=\"urn:f\">\n\
         {text}</composite>"
    ))
}

#[test]
fn a_robot_deposits_its_luggage_where_it_stands_before_it_charges() {
    let battery = [("dischargePerBlock", "4"), ("dischargePerSecond", "0.15"), ("chargePerSecond", "8")];
    let run = fleet(&battery).with_severity("S5006", "allow").run(1, Duration::from_secs(60));
    let log = run.log_of("Robot1").join("\n");
    let deposits = log.find("deposited luggage 1").unwrap_or_else(|| panic!("{log}"));
    assert!(log.find("starts charging").is_none_or(|charges| deposits < charges), "{log}");
    assert_eq!(run.count("stranded"), 0, "{log}");
}
