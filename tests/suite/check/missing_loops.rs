//! Robots without a loop for a part of their work: where S5017 says so, and where it says nothing.

use saoms_testkit::Fleet;

/// The messages about a fleet of two robots: what else it has, and the elements of the robots.
fn told(scenario: &str, more: &str, robots: [&str; 2]) -> Vec<String> {
    let component = |name: &str, class: &str, elements: &str| {
        format!(
            "<component name=\"{name}\"><implementation.rust class=\"saoms.{class}\"/>\
            <property name=\"ID\">{name}</property><property name=\"period\">100ms</property>{elements}</component>\n"
        )
    };
    let wired = "<reference name=\"world\" target=\"World\"/>";
    let [first, second] = robots;
    let fleet = [
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" \
        name=\"t\" targetNamespace=\"urn:t\">\n",
        &component("World", "World", ""),
        &component("Environment", "Environment", &format!("<property name=\"scenario\">{scenario}</property>")),
        &component("Master", "MasterEnvironment", ""),
        more,
        &component("Robot1", "Robot", &format!("{wired}{first}")),
        &if second == ALONE { String::new() } else { component("Robot2", "Robot", &format!("{wired}{second}")) },
        "</composite>",
    ];
    let found = Fleet::of_text(fleet.concat()).diagnostics();
    let message = |line: &str| Some(line.strip_prefix("warning S5017 ")?.split_once(' ')?.1.to_owned());
    found.lines().filter_map(message).collect()
}

/// In place of a second robot.
const ALONE: &str = "-";

const LUGGAGE: &str = "at 1s luggage (3,1) to (4,2)";

fn without(names: &[&str]) -> String {
    names.iter().map(|name| format!("<saoms:loop name=\"{name}\" remove=\"true\"/>")).collect()
}

#[test]
fn a_robot_without_a_loop_is_told_what_it_does_not_do() {
    for (name, message) in [
        ("PathFollowerMS", "nothing moves `Robot1`"),
        ("EventLuggageMS", "`Robot1` never takes waiting luggage"),
        ("GripperMS", "`Robot1` neither collects nor deposits luggage"),
        ("CollisionMS", "`Robot1` drives into other robots"),
        ("RobotListMS", "other robots do not know of `Robot1`"),
    ] {
        let found = told(LUGGAGE, "", [&without(&[name]), ""]);
        assert_eq!(found, [format!("{message}: it has no loop `{name}`")]);
    }
    // A robot that does not move does nothing else either.
    let found = told(LUGGAGE, "", [&without(&["PathFollowerMS", "GripperMS", "CollisionMS"]), ""]);
    assert_eq!(found, ["nothing moves `Robot1`: it has no loop `PathFollowerMS`"]);
    let found = told(LUGGAGE, "", ["", &without(&["GripperMS", "CollisionMS"])]);
    assert_eq!(found.len(), 2, "{found:?}");
}

#[test]
fn what_concerns_other_robots_matters_only_beside_them() {
    let loops = without(&["CollisionMS", "RobotListMS", "CriticalSituationMS"]);
    assert_eq!(told(&format!("{LUGGAGE}; at 9s breakdown 1"), "", [&loops, ALONE]), [""; 0]);
}

#[test]
fn help_matters_where_robots_break_or_work_in_shifts() {
    let loops = without(&["CriticalSituationMS"]);
    let message = "`Robot1` neither calls for help nor helps other robots: it has no loop `CriticalSituationMS`";
    assert_eq!(told(LUGGAGE, "", [&loops, ""]), [""; 0]);
    assert_eq!(told(&format!("{LUGGAGE}; at 9s breakdown 2"), "", [&loops, ""]), [message]);
    let shift = "<component name=\"Shift\"><implementation.rust class=\"saoms.Shift\"/><property name=\"ID\">Shift\
        </property><property name=\"period\">100ms</property><property name=\"work\">9s</property>\
        <reference name=\"tasks\" target=\"Robot2\"/></component>\n";
    let waits = "<property name=\"runOnStartup\">false</property>";
    assert_eq!(told(LUGGAGE, shift, [&loops, waits]), [message]);
}

#[test]
fn another_loop_may_do_the_work() {
    // The classic one has a gripper of its own.
    let classic = "<property name=\"policy\">classic</property>";
    assert_eq!(told(LUGGAGE, "", [classic, classic]), [""; 0]);
    let other = "<saoms:loop name=\"CollisionMS\" class=\"saoms.classic.CollisionMS\"/>";
    assert_eq!(told(LUGGAGE, "", [other, ""]), [""; 0]);
}
