//! Rule: the sides that a world gives are not those of its map.

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::areas;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5014",
        name: "map-size",
        meaning: "A world has a map, and a `width` or `height` that differs from the size of the map: the size of \
            the map is used.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    for area in areas(fleet).filter(|area| area.properties.map.is_some()) {
        let values = fleet.components()[area.index].values;
        let (width, height) = (area.properties.width, area.properties.height);
        let sides = [("width", width, area.map.width(), "columns"), ("height", height, area.map.height(), "rows")];
        for (name, said, drawn, what) in sides {
            if said == drawn || values.iter().all(|(given, _)| given != name) {
                continue;
            }
            let message = format!("`{name}` is {said}, but the map has {drawn} {what}: the size of the map is used");
            findings.push(
                Finding::new(Place::property(name).in_component(area.index), message)
                    .label(Place::property("map").in_component(area.index), "the map")
                    .help(format!("remove `{name}`, or correct the map")),
            );
        }
    }
    findings
}
