//! Severities that composites and the command line set.

use expect_test::expect;
use saoms_lang::project::Project;
use saoms_tools::diagnostics::{json, sarif};
use serde_json::Value;

use crate::check::classes::registry;
use crate::check::support::{part, shown};

struct Found {
    /// True if the fleet can run.
    runs: bool,
    /// The reported diagnostics.
    told: String,
    json: Value,
    sarif: Value,
}

fn found(texts: &[&str], severities: &[&str]) -> Found {
    let project = Project::new().in_memory().severities(severities.iter().copied());
    let project = project.text("fleet.composite", texts[0]);
    let project = texts[1..].iter().fold(project, |project, text| project.other_text("fleet.composite", *text));
    let compilation = project.compile(&registry());
    assert_eq!(compilation.output.is_some(), !compilation.has_errors());
    let (all, sources) = (&compilation.diagnostics, &compilation.sources);
    Found {
        runs: compilation.output.is_some(),
        told: compilation.reported().map(|one| shown(one, sources)).collect(),
        json: json(all, sources).into(),
        sarif: serde_json::json!(sarif(all, sources, "1.0.0", None::<()>)),
    }
}

fn fleet(inside: &str) -> String {
    part("fleet", "xmlns:saoms=\"urn:saoms:1\"", inside)
}

fn of(inside: &str, severities: &[&str]) -> Found {
    found(&[&fleet(inside)], severities)
}

/// Two clocks that share an ID, which is a warning; and what the second one and the composite say about that.
fn clocks(second: &str, composite: &str) -> String {
    let clock = |name: &str, more: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"example.Clock\"/><property name=\"ID\">C</property><property name=\"period\">1</property>{more}</component>\n"
        )
    };
    clock("A", "") + &clock("B", second) + composite
}

fn severity(code: &str, level: &str) -> String {
    format!("<saoms:severity code=\"{code}\" level=\"{level}\" reason=\"because\"/>")
}

#[test]
fn the_element_counts_before_the_composite_and_that_before_the_command_line() {
    let warning = of(&clocks("", ""), &[]);
    expect![[r#"
        3:85-86 warning S4001: components `A` and `B` share the ID `C`
          2:85-86 the first
          help: give each its own ID: messages and reports name tasks by their ID
    "#]]
    .assert_eq(&warning.told);
    let error = of(&clocks("", &severity("S4001", "error")), &[]);
    assert!(!error.runs);
    expect![[r#"
        3:85-86 error S4001: components `A` and `B` share the ID `C`
          2:85-86 the first
          4:23-28 set to `error`: because
          help: give each its own ID: messages and reports name tasks by their ID
    "#]]
    .assert_eq(&error.told);
    let allowed = of(&clocks(&severity("S4001", "allow"), &severity("S4001", "error")), &["S4001=error"]);
    assert!(allowed.runs && !allowed.told.contains(" S4001: "), "{}", allowed.told);
    assert!(of(&clocks("", &severity("S4001", "note")), &["S4001=error"]).runs);
    let denied = of(&clocks("", ""), &["S4001 = error"]);
    assert!(!denied.runs);
    expect![[r#"
        3:85-86 error S4001: components `A` and `B` share the ID `C`
          2:85-86 the first
          help: give each its own ID: messages and reports name tasks by their ID
    "#]]
    .assert_eq(&denied.told);
    assert_eq!(of(&clocks("", ""), &["S4001=allow"]).told, "");
}

#[test]
fn a_severity_is_set_once_at_a_place() {
    let both = severity("S4001", "allow") + "\n" + &severity("S4001", "error");
    let within = of(&clocks(&both, ""), &[]);
    let options = of(&clocks("", ""), &["S4001=note", "S4001=error"]);
    assert!(!within.runs && !options.runs && !of(&clocks("", &both), &[]).runs);
    expect![[r#"
        4:23-28 error S2048: the severity of S4001 is set to `allow` and to `error`
          3:155-160 first set here
          help: keep one of them
        --severity:1:1-6 error S2048: the severity of S4001 is set to `note` and to `error`
          --severity:1:1-6 first set here
          help: keep one of them
        3:85-86 note S4001: components `A` and `B` share the ID `C`
          2:85-86 the first
          help: give each its own ID: messages and reports name tasks by their ID
    "#]]
    .assert_eq(&(within.told + &options.told));
    // What is inside another element may say something else.
    assert!(of(&clocks(&severity("S4001", "allow"), &severity("S4001", "note")), &[]).runs);
}

#[test]
fn reasons_are_in_the_output_for_machines() {
    let allowed = of(&clocks(&severity("S4001", "allow"), ""), &[]);
    let one = &allowed.json[0];
    assert_eq!((&one["severity"], &one["code"]), (&Value::from("warning"), &Value::from("S4001")));
    assert_eq!((&one["set"]["level"], &one["set"]["reason"]), (&Value::from("allow"), &Value::from("because")));
    let suppression = &allowed.sarif["runs"][0]["results"][0]["suppressions"][0];
    assert_eq!(
        (&suppression["kind"], &suppression["justification"]),
        (&Value::from("inSource"), &Value::from("because"))
    );
    let outside = of(&clocks("", ""), &["S4001=allow"]);
    assert_eq!(outside.sarif["runs"][0]["results"][0]["suppressions"][0]["kind"], "external");
    let error = of(&clocks("", &severity("S4001", "error")), &[]);
    assert_eq!(error.sarif["runs"][0]["results"][0]["properties"]["severityReason"], "because");
    assert_eq!(error.sarif["runs"][0]["results"][0]["level"], "error");
    let plain = of(&clocks("", ""), &[]);
    assert!(plain.json[0].get("set").is_none());
}

#[test]
fn options_have_reasons_too() {
    let allowed = of(&clocks("", ""), &["S4001=allow: one clock, two = faces"]);
    assert_eq!(allowed.told, "");
    assert_eq!(allowed.json[0]["set"]["reason"], "one clock, two = faces");
    let suppression = &allowed.sarif["runs"][0]["results"][0]["suppressions"][0];
    assert_eq!(
        (&suppression["kind"], &suppression["justification"]),
        (&Value::from("external"), &Value::from("one clock, two = faces"))
    );
    expect![[r#"
        3:85-86 note S4001: components `A` and `B` share the ID `C`
          2:85-86 the first
          --severity:1:1-6 set to `note`: two faces
          help: give each its own ID: messages and reports name tasks by their ID
    "#]]
    .assert_eq(&of(&clocks("", ""), &["S4001=note:two faces"]).told);
}

#[test]
fn an_option_that_a_composite_overrules_says_so() {
    let error = clocks("", &severity("S4001", "error"));
    expect![[r#"
        --severity:1:1-6 warning S2049: S4001 is not set to `allow`: a composite sets it to `error`, which takes precedence
          4:23-28 set here
          help: change it there, or leave the option out
        3:85-86 error S4001: components `A` and `B` share the ID `C`
          2:85-86 the first
          4:23-28 set to `error`: because
          help: give each its own ID: messages and reports name tasks by their ID
    "#]]
    .assert_eq(&of(&error, &["S4001=allow"]).told);
    assert!(!of(&error, &["S4001=error"]).told.contains("S2049"));
    assert_eq!(of(&clocks("", ""), &["S4010=error", "S2026=allow"]).told.matches("S2049").count(), 0);
}

#[test]
fn an_option_that_asks_for_more_than_a_composite_says_so_too() {
    let told = of(&clocks("", &severity("S4001", "allow")), &["S4001=error"]).told;
    expect![[r#"
        --severity:1:1-6 note S2049: S4001 is not set to `error`: a composite sets it to `allow`, which takes precedence
          4:23-28 set here
          help: change it there, or leave the option out
    "#]]
    .assert_eq(&told);
}

/// A finding in the second of two components is about the first as well.
#[test]
fn either_of_two_components_can_say_it() {
    let first = clocks("", "").replacen("</component>", &(severity("S4001", "allow") + "</component>"), 1);
    assert_eq!(of(&first, &[]).told, "");
    let both = clocks(&severity("S4001", "note"), "").replacen(
        "</component>",
        &(severity("S4001", "allow") + "</component>"),
        1,
    );
    assert!(of(&both, &[]).told.contains("note S4001"), "its own place counts first");
}

#[test]
fn errors_that_make_a_fleet_impossible_stay() {
    let found = of(
        &format!(
            "{}<component name=\"X\"><implementation.java class=\"example.Gsp\"/>{}</component>",
            severity("S3001", "allow"),
            severity("S3001", "warning")
        ),
        &[],
    );
    assert!(!found.runs);
    expect![[r#"
        2:110-121 error S3001: there is no class `example.Gsp`
          2:146-151 not set to `warning`
          help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
          help: its severity cannot be lowered: no fleet can run with this error
          fix: replace `example.Gsp` with `example.Gps` [2:110-121 "example.Gps"]
    "#]]
    .assert_eq(&found.told);
    // Two robots of one ID can run all the same.
    let robot = |name: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"example.Robot001\"/><property name=\"ID\">R</property><property name=\"period\">1</property><property name=\"number\">1</property></component>\n"
        )
    };
    let found = of(&format!("{}{}{}", robot("A"), robot("B"), severity("S3013", "warning")), &[]);
    assert!(found.runs);
    expect![[r#"
        3:88-89 warning S3013: components `A` and `B` have the same `ID` `R`
          2:88-89 the first
          4:23-28 set to `warning`: because
          help: give every robot its own `ID`
    "#]]
    .assert_eq(&found.told);
}

#[test]
fn what_is_wrong_with_severities_is_found() {
    expect![[r#"
        --severity:1:1-6 error S2048: `S4001` sets no severity
          help: write `--severity CODE=LEVEL` or `--severity 'CODE=LEVEL:REASON'`, with `allow`, `note`, `warning` or `error`
        --severity:1:1-7 error S2048: `S4001=` sets no severity
          help: write `--severity CODE=LEVEL` or `--severity 'CODE=LEVEL:REASON'`, with `allow`, `note`, `warning` or `error`
        --severity:1:7-13 error S2048: there is no severity `errror`
          help: write `--severity CODE=LEVEL` or `--severity 'CODE=LEVEL:REASON'`, with `allow`, `note`, `warning` or `error`
          fix: replace it with `error` [--severity:1:7-13 "error"]
        --severity:1:1-7 error S2048: there is no code `S40001`
          fix: replace `S40001` with `S0001` [--severity:1:1-7 "S0001"]
        --severity:1:1-1 error S2048: there is no code ``
          help: each diagnostic shows its code, and `saoms explain` lists them
        --severity:1:1-8 error S2048: there is no code `unwired`
          fix: replace `unwired` with `S2018` [--severity:1:1-8 "S2018"]
        2:23-27 error S2048: there is no code `S400`
          fix: replace `S400` with `S4001` [2:23-27 "S4001"]
        2:77-92 error S2048: there is no code `unused-property`
          fix: replace `unused-property` with `S2026` [2:77-92 "S2026"]
        2:101-105 error S1011: `level` is `deny`, expected `allow`, `note`, `warning` or `error`
          fix: replace it with `error` [2:101-105 "error"]
        3:2-16 error S1008: `saoms:severity` needs the attribute `reason`
          help: add `reason="..."` to it
        3:46-60 error S1008: `saoms:severity` needs the attribute `code`
          help: add `code="..."` to it
        3:75-84 error S1011: the attribute `reason` is empty
          help: write its value between the quotes
        4:118-126 error S1004: `severity` is an element of SAOMS: it has to be in the namespace `urn:saoms:1`
          help: write `<saoms:severity .../>`, and `xmlns:saoms="urn:saoms:1"` in the composite's start tag
          fix: replace `severity` with `saoms:severity` [4:118-126 "saoms:severity"]
    "#]].assert_eq(&of(
        r#"<saoms:severity code="S400" level="allow" reason="x"/><saoms:severity code="unused-property" level="deny" reason="x"/>
<saoms:severity code="S4001" level="allow"/><saoms:severity level="allow" reason=""/>
<component name="G"><implementation.java class="example.Gps"/><saoms:severity code="S2018" level="note" reason="x"/><severity code="S2018"/></component>"#,
        &["S4001", "S4001=", "S4001=errror", "S40001=error", "=allow", "unwired=note"],
    ).told);
    // Those of the wiring report match nothing where it is not asked for.
    assert_eq!(
        of(
            &format!(
                "{}<component name=\"G\"><implementation.java class=\"example.Gps\"/></component>",
                severity("S4010", "allow")
            ),
            &[]
        )
        .told,
        ""
    );
}

#[test]
fn composites_inside_say_it_for_themselves() {
    let inner = |more: &str| {
        part(
            "inner",
            "xmlns:saoms=\"urn:saoms:1\"",
            &format!(
                "<property name=\"p\">1</property><component name=\"G\"><implementation.java class=\"example.Gps\"/></component>{more}"
            ),
        )
    };
    let outer = |more: &str| {
        fleet(&format!(
            "<property name=\"p\">1</property><component name=\"I\"><implementation.composite name=\"t:inner\"/></component>{more}"
        ))
    };
    let allow = severity("S2026", "allow");
    let count = |outer: &str, inner: &str| found(&[outer, inner], &[]).told.matches("S2026").count();
    assert_eq!(count(&outer(""), &inner("")), 2);
    assert_eq!(count(&outer(""), &inner(&allow)), 1);
    assert_eq!(count(&outer(&allow), &inner("")), 0, "what is asked for speaks for the whole fleet");
}

/// Of a thousand of a kind, some are only counted: what is said of the others holds for them.
#[test]
fn severities_hold_for_what_is_only_counted() {
    let gps = "<component name=\"G{}\" odd=\"\"><implementation.java class=\"example.Gps\"/>odd</component>\n";
    let property =
        "<property xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\" name=\"p{}\" type=\"xsd:int\">odd</property>\n";
    let several = |of: &str, count: usize| (0..count).map(|at| of.replace("{}", &at.to_string())).collect::<String>();
    let text = several(gps, 1200) + &several(property, 5);
    let all = |level: &str| {
        let codes = ["S1007", "S1012", "S2042"];
        found(&[&fleet(&text)], &codes.map(|code| format!("{code}={level}")).each_ref().map(String::as_str))
    };
    assert!(!found(&[&fleet(&text)], &[]).runs);
    let notes = all("note");
    assert!(notes.runs && notes.told.contains("note S0008: 200 more of S1007"), "{}", notes.told);
    assert!(!notes.told.contains(" error "), "{}", notes.told);
    let allowed = all("allow");
    assert!(allowed.runs && !allowed.told.contains("S1007"), "{}", allowed.told);
}

#[test]
fn a_severity_without_its_prefix_is_told_and_not_what_it_is_about() {
    let severity = "<severity code=\"S4001\" level=\"allow\" reason=\"one dashboard for both\"/>";
    expect![[r#"
        3:134-142 error S1004: `severity` is an element of SAOMS: it has to be in the namespace `urn:saoms:1`
          help: write `<saoms:severity .../>`, and `xmlns:saoms="urn:saoms:1"` in the composite's start tag
          fix: replace `severity` with `saoms:severity` [3:134-142 "saoms:severity"]
    "#]]
    .assert_eq(&of(&clocks(severity, ""), &[]).told);
}

#[test]
fn an_element_of_saoms_that_stands_elsewhere_says_where_it_can() {
    let inside = severity("S2026", "allow");
    let looping = "<saoms:loop name=\"x\"/><saoms:interface.rust interface=\"y\"/>";
    expect![[r#"
        2:21-35 error S1005: `saoms:severity` is not allowed in `property`
          help: it is allowed in `composite`, `component`, `service`, `reference`, `wire` and `include`
        2:93-103 error S1005: `saoms:loop` is not allowed in `composite`
          help: it is allowed in `component`
        2:115-135 error S1005: `saoms:interface.rust` is not allowed in `composite`
          help: it is allowed in `service` and `reference`
    "#]]
    .assert_eq(&of(&format!("<property name=\"p\">{inside}</property>{looping}"), &[]).told);
}
