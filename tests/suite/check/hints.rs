//! What the checker proposes for mistakes of new users, seen in the output of `saoms check`.

use std::fs;

use crate::support::{empty_folder, saoms_in};

const HALL: &str = include_str!("../../../composites/hall.composite");
const HANGAR: &str = include_str!("../../../composites/hangar.composite");

/// Checks a fleet that has these files, of which the composite `fleet.composite` is the first. The lines with
/// messages and help come back.
fn told(test: &str, files: &[(&str, &str)]) -> Vec<String> {
    told_of(test, files, &["fleet.composite"])
}

/// Checks these composites of a folder with these files.
pub(super) fn told_of(test: &str, files: &[(&str, &str)], checked: &[&str]) -> Vec<String> {
    let folder = empty_folder(&format!("hints/{test}"));
    for (name, text) in files {
        fs::create_dir_all(folder.join(name).parent().unwrap()).unwrap();
        fs::write(folder.join(name), text).unwrap();
    }
    let output = saoms_in(&folder, &[&["check"], checked].concat());
    let text = String::from_utf8(output.stderr).unwrap();
    let is_told =
        |line: &str| line.starts_with("error[") || line.starts_with("warning[") || line.starts_with("= help:");
    text.lines().map(str::trim).filter(|line| is_told(line)).map(str::to_owned).collect()
}

/// The fleet of the README after a replacement.
fn hall(from: &str, to: &str) -> String {
    assert!(HALL.contains(from), "{from}");
    HALL.replacen(from, to, 1)
}

/// Checks that there is one diagnostic, with this code and this help.
pub(super) fn assert_hint(test: &str, told: &[String], code: &str, help: &str) {
    let count = told.iter().filter(|line| !line.starts_with('=')).count();
    assert_eq!(count, 1, "{test}: {told:#?}");
    assert!(told[0].contains(code), "{test}: {told:#?}");
    assert!(told.iter().any(|line| line.contains(help)), "{test}: {told:#?}");
}

#[test]
fn what_was_probably_meant_is_proposed() {
    let map = |rows: &str| format!(r#""saoms.World"/><property name="map">{rows}</property>"#);
    for (test, from, to, code, help) in [
        (
            "scenario file",
            "at 1s luggage (3,1) to (3,10)",
            "scenario.txt",
            "S3014",
            "write `file=\"scenario.txt\"` in place of the value",
        ),
        ("map file", "\"saoms.World\"/>", &map("maps/map.txt"), "S3014", "write `file=\"maps/map.txt\"` in place of"),
        ("random", "(3,10)", "radnom", "S3014", "replace `radnom` with `random`"),
        ("on", "at 1s", "on 1s", "S3014", "replace `on` with `at`"),
        ("times", "1s luggage", "1s 10 luggage", "S3014", "replace `10` with `10 times`"),
        (
            "class file",
            "\"saoms.World\"",
            "\"saoms.World.class\"",
            "S3001",
            "replace `saoms.World.class` with `saoms.World`",
        ),
        ("number", "\"saoms.Robot\"", "\"robot.Robot999\"", "S3001", "replace `robot.Robot999` with `saoms.Robot`"),
        ("short number", "\"saoms.Robot\"", "\"robot.Robot12\"", "S3001", "replace `robot.Robot12` with `saoms.Robot`"),
        ("minutes", "\"100ms\"", "\"10m\"", "S3007", "replace `10m` with `10min`"),
        ("milliseconds", "\"100ms\"", "\"10m\"", "S3007", "replace `10m` with `10ms`"),
        (
            "attribute",
            "\"Robot7\">",
            "\"Robot7\" world=\"World\">",
            "S1007",
            "`<reference name=\"world\" target=\"World\"/>`",
        ),
        (
            "outside",
            "</component>\n</composite>",
            "</component><reference name=\"world\" target=\"World\"/></composite>",
            "S1008",
            "move it into that component",
        ),
        (
            "git open",
            "    <property name=\"ID\" value=\"Master\"/>",
            "<<<<<<< HEAD\n<property name=\"ID\" value=\"Master\"/>",
            "S0101",
            "keep one version",
        ),
        (
            "git",
            "    <property name=\"ID\" value=\"Master\"/>",
            "<<<<<<< HEAD\n<property name=\"ID\" value=\"Master\"/>\n=======\n<property name=\"ID\" value=\"M\"/>\n>>>>>>> x",
            "S0101",
            "keep one version, and remove the lines",
        ),
        ("one wall", r#""saoms.World"/>"#, &map("....\n.X..\n"), "S3014", "replace `X` with `@`"),
        (
            "walls",
            r#""saoms.World"/>"#,
            &map("....\n.##.\n.#..\n"),
            "(in this row and 1 more)",
            "replace each `#` with `@`",
        ),
    ] {
        assert_hint(test, &told(test, &[("fleet.composite", &hall(from, to))]), code, help);
    }
}

/// An inner composite, and an outer one around it with something more.
fn nested(inner: &str, more: &str) -> [(&'static str, String); 2] {
    let root = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:t="urn:t" targetNamespace="urn:t""#;
    let outer = format!(
        "{root} name=\"fleet\"><component name=\"A\"><implementation.composite name=\"t:inner\"/></component>{more}\
         </composite>\n"
    );
    [("inner.composite", format!("{root} name=\"inner\">{inner}</composite>\n")), ("fleet.composite", outer)]
}

/// The components of the fleet of the README: the robot, and what is before it.
fn parts() -> (String, String) {
    let inside = HALL.split_once("\"urn:hall\">").unwrap().1.replace("</composite>", "");
    let (others, robot) = inside.split_once("<component name=\"Robot7\">").unwrap();
    (format!("<component name=\"Robot7\">{robot}"), others.to_owned())
}

/// A composite with replicated robots, the composite around it, and their table, after replacements in the first two.
fn replicated(inner: &[[&str; 2]], outer: &[[&str; 2]], table: &str) -> [(&'static str, String); 3] {
    let after = |text: &str, edits: &[[&str; 2]]| {
        edits.iter().fold(text.to_owned(), |text, [from, to]| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        })
    };
    [
        ("inner.composite", after(include_str!("hints/inner.composite"), inner)),
        ("fleet.composite", after(include_str!("hints/fleet.composite"), outer)),
        ("robots.csv", table.to_owned()),
    ]
}

/// The messages and help for such a fleet.
fn told_of_replicas(test: &str, inner: &[[&str; 2]], outer: &[[&str; 2]], table: &str) -> Vec<String> {
    let files = replicated(inner, outer, table);
    told(test, &files.each_ref().map(|(name, text)| (*name, text.as_str())))
}

#[test]
fn one_fault_of_replicas_is_told_once() {
    const ID: &str = r#"<property name="ID">Robot${index:02}</property>"#;
    const SCENARIO: &str = r#"<property name="scenario">
      at 1s luggage (3,1) to (9,4)
      at 2s breakdown Robot02
    </property>"#;
    const TABLE: &str = "index,battery\n1,60\n";
    assert_eq!(told_of_replicas("right", &[], &[], TABLE), [""; 0]);
    for (test, inner, outer, table, code, help) in [
        (
            "same ID",
            [ID, r#"<property name="ID">Robot</property>"#],
            ["A", "A"],
            TABLE,
            "S3013",
            "with `Robot${index}`",
        ),
        (
            "same ID by index",
            [ID, r#"<property name="ID">Robot0${index - index}</property>"#],
            ["A", "A"],
            TABLE,
            "S3013",
            "`${index}` is different for each",
        ),
        (
            "same number",
            [ID, &format!("{ID}<property name=\"number\">1</property>")],
            ["A", "A"],
            TABLE,
            "S3013",
            "replace `1` with `${index}`",
        ),
        (
            "misspelt property",
            ["World", "World"],
            [r#"name="robots" source"#, r#"name="robot" source"#],
            TABLE,
            "S3004",
            "replace `robot` with `robots`",
        ),
        (
            "reference outside",
            [
                "<reference name=\"world\" target=\"World\"/>\n  </component>",
                "</component>\n  <reference name=\"world\" target=\"World\"/>",
            ],
            ["A", "A"],
            TABLE,
            "S1008",
            "a reference of the composite has a `promote`",
        ),
        (
            "git in table",
            ["World", "World"],
            ["A", "A"],
            "index,battery\n<<<<<<< HEAD\n1,60\n=======\n1,70\n>>>>>>> other\n",
            "S2047",
            "keep one version, and remove the lines",
        ),
        (
            "table as scenario",
            [SCENARIO, r#"<property name="scenario" file="robots.csv"/>"#],
            ["A", "A"],
            "index,battery\n1,60\n2,70\n",
            "S3014",
            "name the table with `saoms:overrides`",
        ),
        (
            "site",
            ["Robot02", "Robot04"],
            ["</composite>", B],
            TABLE,
            "site `B` has no robot 4",
            "the robots are `Robot01`, `Robot02`",
        ),
        (
            "one site twice",
            ["World", "World"],
            [
                "</composite>",
                &B.replace("name=\"B\" saoms:site=\"B\"", "name=\"B\" saoms:site=\"N\"").replace(
                    "</composite>",
                    "  <component name=\"C\" saoms:site=\"N\"><implementation.composite name=\"w:inner\"/></component>
</composite>",
                ),
            ],
            TABLE,
            "`B` and `C` are both in the site `N`, and both have a component `World`",
            "give each its own `saoms:site`",
        ),
        ("zeros", ["Robot02", "Robot2"], ["A", "A"], TABLE, "S5005", "replace `Robot2` with `Robot02`"),
        (
            "minutes-of-an-event",
            ["at 2s", "at 10m"],
            ["A", "A"],
            TABLE,
            "expected `10min`, for minutes, or `10ms`",
            "replace `10m` with `10min`",
        ),
        (
            "charger",
            ["${index}</property>\n    <reference", "${index / 2 + 1}</property>\n    <reference"],
            ["A", "A"],
            TABLE,
            "S5003",
            "move the charger of one robot",
        ),
    ] {
        let told = told_of_replicas(test, &[inner], &[outer], table);
        assert_hint(test, &told, code, help);
        assert!(told.iter().all(|line| !line.contains("both take this value from here")), "{test}: {told:#?}");
    }
}

#[test]
fn a_cell_of_a_table_of_two_is_told_once() {
    let (_, robots) = include_str!("hints/inner.composite").split_once("  <component name=\"Robot${").unwrap();
    let more = format!(
        "  <component name=\"Robot${{{}</composite>",
        robots.replace("</composite>", "").replace("index:02", "index + 10:02").replace("chargeX\">0", "chargeX\">1")
    );
    let told = told_of_replicas("shared", &[["</composite>", &more]], &[], "index,battery\n1,abc\n");
    assert_hint("shared", &told, "(in `A/Robot01`, index 1, and in 1 more)", "Battery level");
}

#[test]
fn a_charger_is_shown_in_the_table_that_it_comes_from() {
    let same_row = [["chargeY\">${index}", "chargeY\">1"]];
    let files = replicated(&same_row, &[], "index,chargeX\n1,2\n2,2\n3,3\n");
    let folder = empty_folder("hints/charger");
    files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
    let text = String::from_utf8(saoms_in(&folder, &["check", "fleet.composite"]).stderr).unwrap();
    let is_shown = text.contains("error[S5003]") && text.contains("--> robots.csv:3:3");
    assert!(is_shown && text.contains("- the first robot"), "{text}");
}

/// A second site, with fewer robots.
const B: &str = "  <component name=\"B\" saoms:site=\"B\">
    <implementation.composite name=\"w:inner\"/>
    <property name=\"robots\">2</property>
  </component>
</composite>";

#[test]
fn a_robot_in_another_composite_than_the_world_is_not_given_a_target() {
    let (robot, others) = parts();
    let robot = robot.replace(r#"<reference name="world" target="World"/>"#, "");
    let told = |test, [inner, outer]: [(&str, String); 2]| told(test, &[(inner.0, &inner.1), (outer.0, &outer.1)]);
    for (test, files, help) in [
        (
            "inner world",
            nested(&others, &robot),
            "add `<reference name=\"world\" target=\"A\"/>` to `Robot7`, and let `A` promote the service `hardware` of `World`",
        ),
        (
            "inner robot",
            nested(&robot, &others),
            "add `<reference name=\"world\" target=\"World\"/>` to `A`, and let `A` promote the reference `world` of `Robot7`",
        ),
        ("both", nested(&format!("{others}{robot}"), ""), "<reference name=\"world\" target=\"World\"/>"),
    ] {
        assert_hint(test, &told(test, files), "S5009", help);
    }
    let again = r#"<component name="B"><implementation.composite name="t:inner"/></component>"#;
    let all = told("twice", nested(&others, again));
    assert!(all.iter().any(|line| line.contains("both take this value from here")), "{all:#?}");
    // Of two composites, both uses are where to act.
    let [(_, inner), (outer_name, outer)] = nested(&robot, &robot);
    let all = told("other", [("inner.composite", inner), (outer_name, outer)]);
    assert!(all.iter().any(|line| line.contains("or make `A` a site of its own with `saoms:site`")), "{all:#?}");
}

#[test]
fn a_property_of_the_composite_in_the_wrong_form_is_told_once() {
    let tick = "<property name=\"tick\">100ms</property>\n  <component name=\"World\"";
    for (test, written, code, help) in [
        ("value", "value=\"$tick\"", "S3007", "write `source=\"$tick\"`"),
        ("braces", "source=\"${tick}\"", "S2023", "replace `${tick}` with `$tick`"),
    ] {
        let fleet = HANGAR.replace("<component name=\"World\"", tick);
        let robots = fleet.find("saoms:count").unwrap();
        let (before, robots) = fleet.split_at(robots);
        let robots = robots.replacen("name=\"period\" value=\"500ms\"", &format!("name=\"period\" {written}"), 1);
        let table = include_str!("../../../composites/hangar.csv");
        let told = told(test, &[("fleet.composite", &format!("{before}{robots}")), ("hangar.csv", table)]);
        assert_hint(test, &told, code, help);
    }
}

#[test]
fn robots_of_one_id_are_told_before_those_that_are_missing() {
    let fleet = HANGAR.replace("<property name=\"ID\">Robot${index:02}", "<property name=\"ID\">Robot01");
    let fleet = fleet.replace("at 10s landing 8", "at 10s breakdown 2");
    let table = include_str!("../../../composites/hangar.csv");
    let told = told("one id", &[("fleet.composite", &fleet), ("hangar.csv", table)]);
    assert_hint("one id", &told, "S3013", "replace `Robot01` with `Robot${index:02}`");
}

#[test]
fn a_file_in_place_of_a_name_is_told_the_name() {
    let (robot, others) = parts();
    let [(_, inner), (_, outer)] = nested(&format!("{others}{robot}"), "");
    for (test, name, meant) in [
        ("file", "t:inner.composite", "t:inner"),
        ("other name", "t:building", "t:inner"),
        ("plain", "building", "t:inner"),
    ] {
        let outer = outer.replace("t:inner", name);
        let file = if test == "file" { "inner.composite" } else { "building.composite" };
        let told = told(test, &[(file, &inner), ("fleet.composite", &outer)]);
        assert_hint(test, &told, "S2031", &format!("replace `{name}` with `{meant}`"));
    }
}

#[test]
fn composites_that_are_inside_of_one_another_are_checked_as_one_fleet() {
    let (robot, others) = parts();
    let [inner, outer] = nested(&format!("{others}{robot}"), "");
    let files = [(inner.0, inner.1.as_str()), (outer.0, &outer.1)];
    for checked in [&["fleet.composite", "inner.composite"], &["inner.composite", "fleet.composite"]] {
        assert_eq!(told_of("together", &files, checked), [""; 0]);
    }
}

#[test]
fn a_table_whose_index_is_not_in_front_is_told_once() {
    let table = "battery,index\n60,7\n50,13\n";
    let told = told("column", &[("fleet.composite", HANGAR), ("hangar.csv", table)]);
    assert_hint("column", &told, "S2047", "move the column `index` to the front of each line");
}

#[test]
fn a_name_with_a_blank_is_not_proposed() {
    let told = told("blank", &[("fleet.composite", &hall("name=\"World\"", "name=\"Wor ld\""))]);
    assert!(!told.concat().contains("with `Wor ld`"), "{told:#?}");
}

#[test]
fn what_makes_the_work_too_long_for_a_battery_is_shown() {
    let folder = empty_folder("hints/handling");
    let slow = "\"saoms.World\"/><property name=\"handlingTime\">3s</property>";
    fs::write(folder.join("fleet.composite"), hall("\"saoms.World\"/>", slow)).unwrap();
    let text = String::from_utf8(saoms_in(&folder, &["check", "fleet.composite"]).stderr).unwrap();
    assert!(
        text.contains("error[S5006]") && text.contains("-- collecting or depositing takes 30 executions"),
        "{text}"
    );
}

#[test]
fn times_are_no_cause_where_a_battery_counts_blocks_alone() {
    let folder = empty_folder("hints/blocks");
    let slow = "\"saoms.World\"/><property name=\"moveTime\">3s</property>";
    for (energy, label) in [
        ("<property name=\"discharge\">5</property>", Some("-- a move takes 30 executions")),
        ("<property name=\"dischargePerBlock\">40</property><property name=\"chargePerSecond\">2</property>", None),
        (
            "<property name=\"dischargePerSecond\">4</property><property name=\"chargePerSecond\">2</property>",
            Some("-- a move takes 3 s"),
        ),
    ] {
        let text = hall("\"saoms.World\"/>", slow).replace("\"saoms.Robot\"/>", &format!("\"saoms.Robot\"/>{energy}"));
        fs::write(folder.join("fleet.composite"), text).unwrap();
        let text = String::from_utf8(saoms_in(&folder, &["check", "fleet.composite"]).stderr).unwrap();
        assert!(text.contains("error[S5006]") && text.contains(" % of a battery"), "{text}");
        match label {
            Some(label) => assert!(text.contains(label), "{text}"),
            None => assert!(!text.contains("a move takes"), "{text}"),
        }
    }
}

#[test]
fn a_task_property_of_a_passive_class_is_to_be_removed() {
    let broker = "<component name=\"B\"><implementation.rust class=\"saoms.MessageBroker\"/><property name=\"ID\" \
                  value=\"B\"/></component></composite>";
    let told = told("passive", &[("fleet.composite", &hall("</composite>", broker))]);
    assert_hint("passive", &told, "S3004", "`saoms.MessageBroker` is passive: it is never executed");
    assert_eq!(told.len(), 2, "{told:#?}");
}

#[test]
fn components_in_different_sites_are_told_theirs() {
    let site = |name: &str| {
        let component = format!("<component name=\"{name}\"");
        hall(&component, &format!("{component} xmlns:saoms=\"urn:saoms:1\" saoms:site=\"N\""))
    };
    for (test, name, code, help) in [
        (
            "master",
            "Master",
            "S5008",
            "`Master` is in the site `N`, but the scenario is in no site: remove `saoms:site`",
        ),
        ("scenario", "Environment", "S5008", "`Master` is in no site, but the scenario is in the site `N`: remove"),
        ("robot", "Robot7", "S5008", "`Robot7` is in the site `N`, but this luggage is in no site: remove"),
        ("world", "World", "S5008", "`World` is in the site `N`, but this luggage is in no site: remove"),
    ] {
        assert_hint(test, &told(test, &[("fleet.composite", &site(name))]), code, help);
        // What topics have another name for it is no mistake of its own.
        assert_hint(
            test,
            &told_of(test, &[("fleet.composite", &site(name))], &["--wiring", "fleet.composite"]),
            code,
            help,
        );
    }
    let renamed = hall(
        "<component name=\"Master\">",
        "<component name=\"Master\"><property name=\"topicRename\">ETOPIC,ETOPIC_2</property>",
    );
    let told_of = |test, files: &[(&str, &str)]| told_of(test, files, &["--wiring", "fleet.composite"]);
    let all = told_of("one rename", &[("fleet.composite", &renamed)]);
    assert_hint("one rename", &all, "S5008", "remove the pair `ETOPIC,ETOPIC_2`");
    let both = ["World", "Environment"].iter().fold(renamed, |text, name| {
        let component = format!("<component name=\"{name}\">");
        text.replace(&component, &format!("{component}<property name=\"topicRename\">ETOPIC,E2</property>"))
    });
    let all = told_of("two renames", &[("fleet.composite", &both)]);
    assert_hint("two renames", &all, "S5008", "replace `ETOPIC_2` with `E2`");
    let (robot, _) = parts();
    let other = robot.replace("name=\"Robot7\"", "name=\"Robot8\" xmlns:saoms=\"urn:saoms:1\" saoms:site=\"N\"");
    let other =
        other.replace("Robot7", "Robot8").replace("<reference", "<property name=\"chargeX\">2</property><reference");
    let told = told("one robot", &[("fleet.composite", &hall("</composite>", &format!("{other}</composite>")))]);
    assert_hint("one robot", &told, "S5012", "remove `saoms:site` there");
}
