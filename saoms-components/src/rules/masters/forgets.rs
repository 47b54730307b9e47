//! Rule: a master that alone knows luggage forgets it when it fails.

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::master::{AssignmentPolicy, MasterEnvironment};

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5028",
        name: "forgetful-master",
        meaning: "A master assigns the luggage, so that it alone knows what no robot has, and has no `restart`: if it \
            fails or crashes, nobody brings that luggage any more.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let assigns = fleet.all::<MasterEnvironment>().filter_map(|(index, properties)| {
        let given = match (&properties.assignment, properties.zone) {
            (AssignmentPolicy::Robots, None) => return None,
            (AssignmentPolicy::Robots, Some(_)) => "zone",
            _ => "assignment",
        };
        (!fleet.components()[index].restarts).then_some((index, given))
    });
    let found = assigns.map(|(index, given)| {
        let path = fleet.components()[index].path;
        let message = format!("if `{path}` fails, nobody knows the luggage that waits: it has no `restart`");
        Finding::new(Place::property(given).in_component(index), message)
            .help("add `<property name=\"restart\">onFailure</property>`: it goes on with what waits then")
    });
    found.collect()
}
