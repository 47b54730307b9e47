//! Composites of one network, in one program with virtual time: what is between them is a simulated link.

use std::fs;

use serde_json::Value;
use tempfile::TempDir;

use crate::support::{root, saoms_in, text};

/// The manual's two files, and a third one that gives their robots work.
const FILES: [&str; 3] = ["launchbroker.composite", "launchtasks.composite", "work.composite"];

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in &FILES[..2] {
        fs::copy(root().join("composites/manual").join(file), folder.path().join(file)).unwrap();
    }
    let task = |name: &str, class: &str, more: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"{class}\"/><property name=\"ID\">{name}</property>\
             <property name=\"period\">100</property><property name=\"url\">localhost:61616</property>{more}</component>\n"
        )
    };
    let scenario = "<property name=\"scenario\">at 3s luggage (1,1) to (2,1)\nat 3s luggage (1,2) to (2,2)</property>";
    let work = task("Environment", "saoms.Environment", scenario) + &task("Master", "saoms.MasterEnvironment", "");
    let work = format!(
        "<composite xmlns=\"http://www.osoa.org/xmlns/sca/1.0\" targetNamespace=\"http://launch\" name=\"work\">\n\
         {work}</composite>\n"
    );
    fs::write(folder.path().join(FILES[2]), work).unwrap();
    folder
}

/// Runs all files with these faults. Gives what is printed, and the report.
fn run(folder: &TempDir, faults: &str) -> (String, Value) {
    fs::write(folder.path().join("faults.txt"), faults).unwrap();
    let _ = fs::remove_file(folder.path().join("report.json"));
    let given = ["--virtual", "--for", "600s", "--seed", "1", "--faults", "faults.txt", "--report", "report.json"];
    let output = saoms_in(folder.path(), &[&["run"], &FILES[..], &given].concat());
    let report = fs::read_to_string(folder.path().join("report.json")).unwrap_or_else(|_| "null".to_owned());
    (text(&output), serde_json::from_str(&report).unwrap())
}

#[test]
fn composites_of_a_network_are_nodes_to_faults() {
    let folder = folder();
    let delivers = |faults: &str| {
        let (printed, report) = run(&folder, faults);
        assert_eq!(report["luggage"]["delivered"], 2, "{faults}: {printed}");
        report["time_s"].as_f64().unwrap()
    };
    let usual = delivers("");
    let slow = delivers("at 0s delay 3s from @launchtasks");
    assert!(slow > usual + 2.0, "{slow} s, and {usual} s without a fault");
    let cut = delivers("at 0s for 30s part @launchtasks from @work");
    assert!(cut > usual.max(30.0), "{cut} s, and {usual} s without a fault");
    // The robots of one composite hear each other as before.
    let (own, _) = run(&folder, "at 0s delay 3s from @launchtasks to @launchtasks");
    assert!(own.contains("no message takes this way"), "{own}");
    // A broker has no messages of its own.
    let (unknown, _) = run(&folder, "at 0s crash @launchbroker");
    assert!(unknown.contains("the fleet has no node `launchbroker`") && unknown.contains("@launchtasks"), "{unknown}");
}
