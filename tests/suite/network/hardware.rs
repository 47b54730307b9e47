//! Robots whose hardware is in another program.

use std::sync::Arc;

use serde_json::Value;

use super::programs::{Program, Programs, component};

/// Writes a fleet with a broker, a scenario and a master in `control`, a world in `floor`, a zone and robots in `gate`.
fn write_fleet(programs: &Programs, scenario: &str, robots: usize, more: &[(&str, &str)]) {
    let url = programs.url(programs.port);
    let task = |name: &str, class: &str, more: &[(&str, &str)]| {
        let usual = [("ID", name), ("period", "100"), ("url", &url)];
        component(name, class, &[&usual, more].concat())
    };
    let at = |node: &str, text: String| text.replacen("<component ", &format!("<component s:node=\"{node}\" "), 1);
    let wired =
        |text: String| text.replacen("</component>", "<reference name=\"world\" target=\"World\"/></component>", 1);
    let port = programs.port.to_string();
    let broker = [("IP", "127.0.0.1"), ("transport", "relay"), ("port", &port)];
    let mut components = component("Broker", "unibg.robotics.tca.MessageBrokerImpl", &broker)
        + &task("Environment", "saoms.Environment", &[("scenario", scenario)])
        + &task("Master", "saoms.MasterEnvironment", &[])
        + &at("floor", task("World", "saoms.World", &[("width", "11"), ("height", "11")]))
        + &at("gate", wired(task("Zone", "saoms.Zone", &[])));
    let battery = [("dischargePerBlock", "1"), ("chargePerSecond", "10")];
    for robot in 1..=robots {
        let robot = task(&format!("Robot{robot}"), "saoms.Robot", &[&battery, more].concat());
        components += &at("gate", wired(robot));
    }
    programs.write(
        "fleet.composite",
        &format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:s=\"urn:saoms:1\" \
             targetNamespace=\"urn:fleet\" name=\"fleet\" s:defaultNode=\"control\">\n{components}</composite>\n"
        ),
    );
}

fn start(programs: &Programs, node: &str) -> Arc<Program> {
    let report = format!("{node}.json");
    programs.run(node, &["run", "fleet.composite", "--node", node, "--report", &report])
}

#[test]
fn robots_deliver_with_their_hardware_in_another_program() {
    let programs = Programs::new();
    let scenario =
        "at 1s luggage (3,1) to (3,10)\nthen 300ms every 300ms 3 times luggage (5,0)..(9,10) to (1,0)..(4,10)";
    write_fleet(&programs, scenario, 2, &[]);
    let all = ["gate", "floor", "control"].map(|node| start(&programs, node));
    for program in &all {
        programs.ends(program, 0);
    }
    let floor: Value = serde_json::from_str(&programs.read("floor.json")).unwrap();
    assert_eq!(floor["luggage"]["delivered"], 4, "{}", programs.printed());
    assert_eq!((&floor["collisions"]["vertex"], &floor["collisions"]["swap"]), (&0.into(), &0.into()));
    let printed = all[0].printed();
    for luggage in 1..=4 {
        assert_eq!(printed.matches(&format!("deposited luggage {luggage} at")).count(), 1, "{printed}");
    }
}

#[test]
fn hardware_that_is_stopped_is_waited_for() {
    let programs = Programs::new();
    write_fleet(&programs, "at 1s luggage (3,1) to (3,10)", 1, &[]);
    let all = ["gate", "floor", "control"].map(|node| start(&programs, node));
    programs.until(&all[0], "collected luggage 1 at");
    all[1].signal(libc::SIGSTOP);
    programs.until(&all[0], "program `floor` gives no sign of life");
    // It cannot deposit what cannot be reached.
    assert!(!all[0].printed().contains("deposited luggage 1 at"), "{}", programs.printed());
    all[1].signal(libc::SIGCONT);
    programs.until(&all[0], "deposited luggage 1 at");
    for program in &all {
        programs.ends(program, 0);
    }
    let floor: Value = serde_json::from_str(&programs.read("floor.json")).unwrap();
    assert_eq!(floor["luggage"]["delivered"], 1, "{}", programs.printed());
}

#[test]
fn hardware_that_begins_anew_gets_its_robots_again() {
    let programs = Programs::new();
    write_fleet(&programs, "at 1s luggage (3,1) to (3,10)\nat 12s luggage (5,1) to (5,3)", 1, &[]);
    let (gate, floor, control) = (start(&programs, "gate"), start(&programs, "floor"), start(&programs, "control"));
    programs.until(&gate, "deposited luggage 1 at");
    floor.kill();
    let floor = start(&programs, "floor");
    programs.until(&gate, "deposited luggage 2 at");
    programs.ends(&gate, 0);
    [&floor, &control].iter().for_each(|program| programs.stop(program));
}
