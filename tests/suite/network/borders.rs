//! Zones and robots of several programs keep the borders of the zones: those of all change at one instant, or not at
//! all.

use std::fs;

use super::nodes::start;
use super::programs::Programs;
use crate::support::{code, root, stderr, stdout, text};

/// The airport in several programs, with two zones, the first of which has so many columns.
fn airport(columns: u32) -> String {
    let airport = fs::read_to_string(root().join("composites/airport-nodes.composite")).unwrap();
    let (before, zone) = airport.split_once("  <component name=\"Zone\"").unwrap();
    let (zone, after) = zone.split_once("</component>").unwrap();
    let zones = [(1, 0, columns), (2, columns, 11 - columns)].map(|(number, x, width)| {
        let value = |name: &str, value: u32| format!("    <property name=\"{name}\">{value}</property>\n");
        let values = [value("number", number), value("x", x), value("width", width)].concat();
        let zone = zone.replace(">Zone<", &format!(">Zone{number}<"));
        let zone = zone.replacen("    <property name=\"period\"", &format!("{values}    <property name=\"period\""), 1);
        format!("  <component name=\"Zone{number}\"{zone}</component>\n")
    });
    format!("{before}{}{after}", zones.concat())
}

#[test]
fn borders_of_zones_in_several_programs_are_refused_at_their_place() {
    let programs = Programs::new();
    programs.write("airport.composite", &airport(5));
    programs.write("other.composite", &airport(6));
    let (port, url) = (format!("port={}", programs.port), format!("url={}", programs.url(programs.port)));
    let given = ["--set", "host=127.0.0.1", "--set", &port, "--set", &url, "--set", "transport=relay"];
    for node in ["control", "traffic", "floor"] {
        let socket = format!("{node}.sock");
        start(&programs, "airport.composite", node, &[&given[..], &["--stay", "--control", &socket]].concat());
    }
    let ask = |command: &str, file: &str, node: &str| {
        let socket = format!("./{node}.sock");
        programs.saoms(&[&[command, file, "--fleet", &socket], &given[..]].concat())
    };
    let other = programs.read("other.composite");
    let line = 1 + other.lines().position(|line| line.contains("name=\"Zone1\"")).unwrap();
    // The zones run in the first program, robots that they grant their blocks in the second one.
    for (node, apart) in [("traffic", "Zone1"), ("floor", "Robot001")] {
        let expected = format!(
            "error: zones get other borders, all at one instant, but `{apart}` may be in another program than they are, \
             and hear of that later: end the run, and start it with the new composites\n  --> \
             other.composite:{line}:20\n"
        );
        programs.wait("it answers", || stdout(&ask("plan", "airport.composite", node)) == "nothing to do\n");
        for command in ["plan", "apply"] {
            let refused = ask(command, "other.composite", node);
            assert_eq!(code(&refused), 2, "{node}: {}", text(&refused));
            let end = if command == "apply" { "\nthe fleet is as it was\n" } else { "" };
            assert!(stderr(&refused).ends_with(&format!("{expected}{end}")), "{node}: {}", text(&refused));
        }
        assert_eq!(stdout(&ask("plan", "airport.composite", node)), "nothing to do\n");
    }
}
