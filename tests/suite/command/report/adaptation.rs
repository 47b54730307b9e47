//! Adaptation measured, as users see it.

use std::fs;

use expect_test::expect_file;
use roxmltree::Document;
use serde_json::Value;

use crate::support::{empty_folder, project, saoms, saoms_in, stdout, text};

/// The lines of a table, from the one that begins with `event` to an empty one.
fn table(output: &str) -> String {
    let lines = output.lines().skip_while(|line| !line.starts_with("event ")).take_while(|line| !line.is_empty());
    lines.map(|line| format!("{line}\n")).collect()
}

#[test]
fn the_page_shows_the_table_of_the_airport() {
    let folder = empty_folder("adaptation-airport");
    let report = folder.join("report.json");
    let run = ["run", "composites/airport.composite", "--virtual", "--report", report.to_str().unwrap()];
    let table = table(&stdout(&saoms(&run)));
    let page = project("docs/adaptation.md");
    // The rows between the command and the end of the block.
    let (before, rest) = page.split_once("--timeline docs/airport-timeline.svg\n").unwrap();
    let (_, after) = rest.split_once("```").unwrap();
    let expected = format!("{before}--timeline docs/airport-timeline.svg\n{table}```{after}");
    expect_file!["../../../../docs/adaptation.md"].assert_eq(&expected);
    let report: Value = serde_json::from_slice(&fs::read(report).unwrap()).unwrap();
    let kinds = report["adaptation"]["kinds"].as_array().unwrap();
    let breakdown = kinds.iter().find(|kind| kind["kind"] == "robot_breaks_down").unwrap();
    let events = report["adaptation"]["events"].as_array().unwrap();
    let event = events.iter().find(|event| event["kind"] == "robot_breaks_down").unwrap();
    assert_eq!(breakdown["settle_s"]["p50"], event["settle_s"], "{breakdown}");
    assert!(event["settle_s"].as_f64() > event["detect_s"].as_f64(), "{event}");
}

#[test]
fn the_page_shows_the_timeline_of_the_airport() {
    let run = ["run", "composites/airport.composite", "--virtual", "--quiet", "--timeline", "-"];
    let drawn = stdout(&saoms(&run));
    expect_file!["../../../../docs/airport-timeline.svg"].assert_eq(&drawn);
    let document = Document::parse(&drawn).unwrap();
    let of_class = |class: &str| {
        let nodes = document.descendants().filter(|node| node.attribute("class") == Some(class));
        nodes.map(|node| node.text().unwrap_or_default().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(of_class("heading"), ["finished per minute", "open", "robots", "battery, %"]);
    assert_eq!(of_class("guide").len(), 3, "a landing, a take-off and a breakdown");
    let tooltips = document.descendants().filter(|node| node.has_tag_name("title")).filter_map(|node| node.text());
    let told = "robot_breaks_down at 2.000 s, detected after 0.100 s, decided after 0.100 s, first effect after 0.100 s, settled after ";
    assert!(tooltips.into_iter().any(|text| text.starts_with(told)), "{drawn}");
}

#[test]
fn a_timeline_is_refused_before_the_run_where_it_cannot_be_written() {
    let folder = empty_folder("adaptation-refused");
    fs::write(folder.join("hall.composite"), project("composites/hall.composite")).unwrap();
    for (file, why) in [
        ("run.png", "the picture of `--timeline` is in SVG, but `run.png` ends with `.png`"),
        ("hall.composite", "hall.composite"),
        ("no/such/folder/run.svg", "no/such/folder"),
    ] {
        let output = saoms_in(&folder, &["run", "hall.composite", "--virtual", "--timeline", file]);
        assert_eq!(output.status.code(), Some(2), "{}", text(&output));
        assert!(text(&output).contains(why) && text(&output).contains("nothing was started"), "{}", text(&output));
    }
}

#[test]
fn a_fleet_of_which_nobody_says_anything_has_a_timeline_too() {
    let folder = empty_folder("adaptation-quiet");
    let fleet = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="a" targetNamespace="urn:a">
      <component name="World"><implementation.rust class="saoms.World"/>
        <property name="ID">World</property><property name="period">100</property></component></composite>"#;
    fs::write(folder.join("a&amp;b.composite"), fleet).unwrap();
    let run = ["run", "a&amp;b.composite", "--virtual", "--for", "5s", "--quiet", "--timeline", "run.svg"];
    assert!(saoms_in(&folder, &run).status.success());
    let drawn = fs::read_to_string(folder.join("run.svg")).unwrap();
    assert!(Document::parse(&drawn).is_ok_and(|one| one.root_element().attribute("width") == Some("960")), "{drawn}");
    assert!(!drawn.contains("NaN"), "{drawn}");
}

#[test]
fn nothing_is_measured_where_nobody_asks() {
    let output = stdout(&saoms(&["run", "composites/airport.composite", "--virtual"]));
    assert_eq!(table(&output), "", "{output}");
}

#[test]
fn a_landing_without_work_wakes_robots_needlessly() {
    let folder = empty_folder("adaptation-landing");
    let airport = project("composites/airport.composite");
    let (before, rest) = airport.split_once("at 1s landing 8").unwrap();
    let (_, after) = rest.split_once("at 2s breakdown Robot001").unwrap();
    let scenario = "at 1s landing 12
      then 300ms every 200ms 2 times luggage (7,0)..(10,10) to (1,0)..(4,10)";
    fs::write(folder.join("idle.composite"), format!("{before}{scenario}{after}")).unwrap();
    let output = saoms_in(&folder, &["run", "idle.composite", "--virtual", "--report", "report.json"]);
    let table = table(&text(&output));
    let landing = table.lines().find(|line| line.starts_with("airplane_lands ")).unwrap_or_default();
    assert_eq!(landing.split_whitespace().rev().nth(1), Some("4"), "{table}");
}

#[test]
fn faults_of_messages_and_components_are_events() {
    let folder = empty_folder("adaptation-faults");
    fs::write(folder.join("airport.composite"), project("composites/airport.composite")).unwrap();
    let faults = "at 1s for 2s lose 20 % on RLMSTOPIC\nat 2s crash Robot004 restart 1s\n";
    fs::write(folder.join("faults.txt"), faults).unwrap();
    let run = ["run", "airport.composite", "--virtual", "--faults", "faults.txt", "--short-report"];
    let output = saoms_in(&folder, &[&run[..], &["--report", "report.json"]].concat());
    let table = table(&text(&output));
    let row = |kind: &str| {
        let row = table.lines().find(|line| line.starts_with(kind)).unwrap_or_default();
        row.split_whitespace().map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(row("lose ")[..6], ["lose", "1", "-", "-", "-", "-"], "{table}");
    let crash = row("crash ");
    assert!(crash[2] != "-" && crash[4] != "-" && crash[5] != "-", "the others adapt to the failure: {table}");
    assert!(!table.contains("component_failed"), "{table}");
    let report: Value = serde_json::from_slice(&fs::read(folder.join("report.json")).unwrap()).unwrap();
    assert_eq!(report["adaptation"]["events"], serde_json::json!([]), "it is short");
}

/// The rows of a comparison, as words, and the result of the command.
fn compared(arguments: &[&str]) -> (Option<i32>, Vec<Vec<String>>, String) {
    let simulate = ["simulate", "composites/airport.composite", "--seeds", "4", "--for", "5min"];
    let output = saoms(&[&simulate[..], arguments].concat());
    let told = text(&output);
    let rows = told.lines().skip_while(|line| !line.starts_with("mean of runs"));
    let rows = rows.map(|line| {
        line.split("  ").map(str::trim).filter(|word| !word.is_empty()).map(str::to_owned).collect::<Vec<_>>()
    });
    let rows = rows.collect();
    (output.status.code(), rows, told)
}

#[test]
fn a_fleet_with_another_period_reacts_later() {
    let (code, rows, told) = compared(&["--against-set", "period=200"]);
    assert_eq!(code, Some(0), "{told}");
    assert!(told.contains("A: composites/airport.composite\n"), "{told}");
    assert!(told.contains("B: composites/airport.composite --set period=200\n"), "{told}");
    assert!(told.contains("runs                       done 4\n"), "{told}");
    let detect = rows.iter().find(|row| row[0] == "robot_breaks_down: detect, s").unwrap();
    let expected = ["0.100 ± 0.000", "0.200 ± 0.000", "0.100", "0.100 to 0.100", "4", "yes"];
    assert_eq!(detect[1..], expected, "{told}");
    let settle = rows.iter().find(|row| row[0] == "robot_breaks_down: settle, s").unwrap();
    assert!(settle[5] == "4" && settle[6] == "yes" && !settle[3].starts_with('-'), "{told}");
}

#[test]
fn one_pair_says_nothing_of_chance_and_what_nobody_brings_has_no_wait() {
    let simulate = ["simulate", "composites/airport.composite", "--seeds", "1", "--for", "3s"];
    let told = text(&saoms(&[&simulate[..], &["--against-set", "period=200"]].concat()));
    let rows: Vec<&str> = told.lines().skip_while(|line| !line.starts_with("mean of runs")).skip(1).collect();
    let rows: Vec<&&str> = rows.iter().filter(|row| row.contains(" \u{b1} ")).collect();
    assert!(rows.iter().any(|row| row.starts_with("pieces delivered ")), "{told}");
    assert!(rows.iter().all(|row| row.ends_with("  -") && !row.contains("wait of a piece")), "{told}");
}

#[test]
fn the_first_seed_leaves_room_for_the_others() {
    let output = saoms(&["simulate", "composites/airport.composite", "--first", "18446744073709551615"]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("--first <SEED>"), "{}", text(&output));
}

#[test]
fn a_fault_that_one_of_two_fleets_does_not_have_is_told_with_that_fleet() {
    let simulate = ["simulate", "composites/storm.composite", "--faults", "composites/storm.txt", "--seeds", "2"];
    let output = saoms(&[&simulate[..], &["--against", "composites/airport.composite"]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", text(&output));
    assert!(text(&output).contains("in the fleet of composites/airport.composite:\n"), "{}", text(&output));
}

#[test]
fn a_fleet_is_like_itself() {
    let (code, rows, told) = compared(&["--against", "composites/airport.composite"]);
    assert_eq!((code, rows.len()), (Some(0), 0), "{told}");
    assert!(told.contains("figures that are the same with each seed: ") && !told.contains("only one"), "{told}");
}

#[test]
fn two_composites_are_compared_by_what_both_have() {
    let simulate = ["simulate", "composites/airport.composite", "--seeds", "4", "--for", "5min", "--report", "json"];
    let told = stdout(&saoms(&[&simulate[..], &["--against", "composites/storm.composite"]].concat()));
    let report: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(report["fleets"]["b"], "composites/storm.composite", "{told}");
    assert_eq!(report["alone"].as_u64().map(|alone| alone > 0), Some(true), "it has no breakdown");
    let pieces =
        report["comparison"].as_array().unwrap().iter().find(|one| one["figure"] == "pieces delivered").unwrap();
    assert_eq!(pieces["difference"]["mean"], 10.0, "{pieces}");
    assert_eq!((&pieces["interval"], &pieces["is_beyond_chance"]), (&serde_json::json!([10.0, 10.0]), &true.into()));
    assert_eq!(report["b"]["seeds"], 4);
}

#[test]
fn a_comparison_with_what_is_wrong_starts_nothing() {
    for (arguments, why) in [
        (["--against", "none.composite"], "there is no such file"),
        (["--against-set", "perid=200"], "`perid`"),
        (["--against-set", "period"], "write `--against-set period=VALUE`"),
        (["--against", "-"], "which standard input cannot be"),
    ] {
        let (code, _, told) = compared(&arguments);
        assert_eq!(code, Some(2), "{told}");
        assert!(told.contains(why) && !told.contains("seeds, "), "{told}");
    }
}
