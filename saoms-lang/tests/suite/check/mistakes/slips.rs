//! Slips of the pen: each is reported once, at its place, with what was probably meant.

use expect_test::expect;

use crate::check::support::{faults_of, fleet, nested, outcome, part, shown};
use crate::check::values::files::checked;

/// The diagnostics of a fleet with the prefix of SAOMS.
pub(crate) fn of(inside: &str) -> String {
    outcome(&[&part("fleet", "xmlns:saoms=\"urn:saoms:1\"", inside)], &[])
}

/// A robot of this name, with this besides what it needs.
pub(crate) fn robot(name: &str, inside: &str) -> String {
    format!(
        "<component name=\"{name}\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">{name}</property><property name=\"period\">1</property>\n{inside}</component>"
    )
}

pub(crate) const GPS: &str = "<component name=\"G\"><implementation.java class=\"example.Gps\"/></component>";

#[test]
fn the_nearest_class_comes_first() {
    let component = |class: &str| format!("<component name=\"C\"><implementation.java class=\"{class}\"/></component>");
    let fix = |class: &str| {
        let found = of(&component(class));
        found.lines().filter_map(|line| line.strip_prefix("  fix: ")?.split(" [").next()).collect::<Vec<_>>().join("\n")
    };
    expect!["replace `Robot` with `example.Robot`"].assert_eq(&fix("Robot"));
    expect!["replace `EXAMPLE.ROBOT` with `example.Robot`"].assert_eq(&fix("EXAMPLE.ROBOT"));
    expect![[r#"
        replace `saoms.Robot1` with `example.Robot`
        replace `saoms.Robot1` with `robot.Robot001`
        replace `saoms.Robot1` with `example.Robot001`"#]]
    .assert_eq(&fix("saoms.Robot1"));
    expect!["replace `MessageBroker` with `unibg.robotics.tca.MessageBrokerImpl`"].assert_eq(&fix("MessageBroker"));
    expect![[r#"
        2:49-66 error S3001: there is no class `example.BatteryMS`
          help: it is a loop: write `<saoms:loop name="..." class="example.BatteryMS"/>` in a component that has loops
    "#]]
    .assert_eq(&of(&component("example.BatteryMS")));
    let looping = "<component name=\"C\"><implementation.java class=\"example.Cart\"/><property name=\"ID\">C</property><property name=\"period\">1</property>\n<saoms:loop name=\"X\" class=\"example.Gps\"/></component>";
    expect![[r#"
        3:29-40 error S3001: there is no loop class `example.Gps`
          help: it is a component class: a component uses it with `<implementation.rust class="example.Gps"/>`
    "#]]
    .assert_eq(&of(looping));
}

#[test]
fn a_name_of_the_wrong_form_is_told_once() {
    let inside = format!(
        "<property name=\"awa ke\">true</property>\n{}",
        robot("R 1", "<property name=\"num ber\">1</property><reference name=\"g ps\"/>")
    );
    expect![[r#"
        2:17-23 error S1011: `awa ke` cannot be a name: it contains ` `
          help: remove it from the name: targets use `/` in `component/service`, and lists separate names with blanks
        3:18-21 error S1011: `R 1` cannot be a name: it contains ` `
          help: remove it from the name: targets use `/` in `component/service`, and lists separate names with blanks
        4:17-24 error S3004: class `example.Robot` has no property `num ber`
          fix: replace `num ber` with `number` [4:17-24 "number"]
        4:55-59 error S2006: class `example.Robot` has no reference `g ps`
          fix: replace `g ps` with `gps` [4:55-59 "gps"]
    "#]]
    .assert_eq(&of(&inside));
}

#[test]
fn a_property_with_a_path_for_a_name_is_told_once() {
    let inside = format!(
        "<property name=\"North/robots\">5</property>\n{}",
        robot("R1", "<property name=\"number\">1</property>")
    );
    expect![[r#"
        2:17-29 error S1011: `North/robots` cannot be a name: it contains `/`
          help: remove it from the name: targets use `/` in `component/service`, and lists separate names with blanks
    "#]]
    .assert_eq(&of(&inside));
}

#[test]
fn replicas_that_lack_their_index_get_it() {
    let replicas = |name: &str, id: &str, number: &str| {
        of(&format!(
            "<component name=\"{name}\" saoms:count=\"3\"><implementation.java class=\"example.Robot\"/>\n<property name=\"ID\">{id}</property><property name=\"period\">1</property><property name=\"number\">{number}</property></component>"
        ))
    };
    expect![[r#"
        3:21-32 error S3013: components `R1` and `R2` have the same `ID` `R{index:02}` (index 2, and in 1 more)
          help: give every robot its own `ID`
          fix: replace `R{index:02}` with `R${index:02}` [3:21-32 "R${index:02}"]
    "#]]
    .assert_eq(&replicas("R${index}", "R{index:02}", "${index}"));
    expect![[r#"
        2:18-26 error S2046: all replicas would have the name `R{index}`
          fix: replace `R{index}` with `R${index}` [2:18-26 "R${index}"] [3:21-29 "R${index}"]
    "#]]
    .assert_eq(&replicas("R{index}", "R{index}", "${index}"));
    expect![[r#"
        2:18-27 error S2046: all replicas would have the name `R$(index)`
          fix: replace `R$(index)` with `R${index}` [2:18-27 "R${index}"]
    "#]]
    .assert_eq(&replicas("R$(index)", "R${index}", "7"));
    expect![[r#"
        2:18-19 error S2046: all replicas would have the name `R`
          fix: replace `R` with `R${index}` [2:18-19 "R${index}"]
    "#]]
    .assert_eq(&replicas("R", "S", "${index}"));
    // The first one, copied: the others follow it. Another number is part of the name.
    for (written, meant) in
        [("R1", "R${index}"), ("R001", "R${index:03}"), ("R7", "R7${index}"), ("R21", "R21${index}")]
    {
        let told = replicas(written, "S", "${index}");
        assert!(told.contains(&format!("fix: replace `{written}` with `{meant}`")), "{told}");
    }
    expect![[r#"
        2:18-27 error S2046: `R${index}` is a name for replicas, but the number of replicas is missing
          help: add `saoms:count="..."` to the component
    "#]].assert_eq(&of("<component name=\"R${index}\"><implementation.java class=\"example.Robot\"/>\n<property name=\"ID\">R${index}</property><property name=\"period\">1</property><property name=\"number\">${index}</property></component>"));
    expect![[r#"
        2:31-36 error S2045: the composite has no property `index`
          help: give the component a `saoms:count`: `index` is the number of a replica
    "#]]
    .assert_eq(&of(
        "<component name=\"G\" saoms:if=\"index &lt; 3\"><implementation.java class=\"example.Gps\"/></component>",
    ));
}

/// Without their number no replicas can be made, so that something has to say so as an error.
#[test]
fn a_count_that_is_none_is_an_error() {
    let robots = |around: &str, count: &str, more: &str| {
        let robot = format!(
            "<component name=\"G${{index}}\" {count}><implementation.java class=\"example.Gps\"/></component>{more}"
        );
        outcome(&[&part("c", around, &robot)], &[])
    };
    expect![[r#"
        1:127-138 error S1013: unknown namespace `urn:saoms:0`: did you mean `urn:saoms:1`?
          help: its attribute `s:count` gives the number of replicas, which are missing without it
          fix: replace it with `urn:saoms:1` [1:127-138 "urn:saoms:1"]
    "#]]
    .assert_eq(&robots("xmlns:s='urn:saoms:0'", "s:count='3'", ""));
    expect![[r#"
        2:18-27 error S2046: `G${index}` is a name for replicas, but the number of replicas is missing
          help: add `saoms:count="..."` to the component
    "#]]
    .assert_eq(&robots("xmlns:s='urn:other'", "s:count='3'", ""));
    expect![[r#"
        2:29-34 error S1007: `component` has no attribute `count`
          help: write it with a prefix of the namespace `urn:saoms:1`: it is an attribute of SAOMS
          fix: replace `count` with `saoms:count` [1:11-11 " xmlns:saoms=\"urn:saoms:1\""] [2:29-34 "saoms:count"]
    "#]]
    .assert_eq(&robots("", "count='3'", ""));
    let allowed = "<s:severity xmlns:s='urn:saoms:1' code='S1007' level='allow' reason='tools put their own there'/>";
    expect![[r#"
        2:18-27 error S2046: `G${index}` is a name for replicas, but the number of replicas is missing
          help: add `saoms:count="..."` to the component
    "#]]
    .assert_eq(&robots("", "count='3'", allowed));
}

#[test]
fn a_component_that_is_pasted_again_is_told_once() {
    let one = robot("R", "<property name=\"number\">1</property>");
    expect![[r#"
        4:18-19 error S2002: there are two components `R`
          2:18-19 the first
          fix: remove the second: both are the same, word for word [4:1-5:49 ""]
    "#]]
    .assert_eq(&of(&format!("{one}\n{one}")));
    expect![[r#"
        4:18-19 error S2002: there are two components `R`
          2:18-19 the first
          help: give each its own name
    "#]]
    .assert_eq(&of(&format!("{one}\n{}", one.replace("\">1<", "\">2<"))));
}

#[test]
fn a_misspelt_root_is_read_on() {
    let text = fleet(&format!("{GPS}\n{GPS}"));
    let end = "</composite>";
    expect![[r#"
        1:2-10 error S1001: the root element is `compsite`, expected `composite`
          fix: replace `compsite` with `composite` [1:2-10 "composite"]
        3:18-19 error S2002: there are two components `G`
          2:18-19 the first
          fix: remove the second: both are the same, word for word [3:1-75 ""]
    "#]]
    .assert_eq(&faults_of(&[&text.replace("<composite", "<compsite")], &[]));
    expect![[r#"
        1:2-10 error S1001: the root element is `compsite`, expected `composite`
          fix: replace `compsite` with `composite` [1:2-10 "composite"] [4:3-11 "composite"]
        3:18-19 error S2002: there are two components `G`
          2:18-19 the first
          fix: remove the second: both are the same, word for word [3:1-75 ""]
    "#]]
    .assert_eq(&faults_of(&[&text.replace("<composite", "<compsite").replace(end, "</compsite>")], &[]));
    expect![[r#"
        3:18-19 error S2002: there are two components `G`
          2:18-19 the first
          fix: remove the second: both are the same, word for word [3:1-75 ""]
        4:1-12 error S0102: `</compsite>` found where `</composite>` is expected
          1:2-11 `composite` is open
          fix: replace it with `</composite>` [4:1-12 "</composite>"]
    "#]]
    .assert_eq(&faults_of(&[&text.replace(end, "</compsite>")], &[]));
}

#[test]
fn a_value_beside_a_source_counts_for_nothing() {
    let inside = |declared: &str| {
        format!(
            "<property name=\"p\">{declared}</property>\n{}",
            robot(
                "R",
                "<property name=\"number\" source=\"$p\" value=\"1\"/>\n<property name=\"delay\" source=\"$p\">1</property>\n<property name=\"awake\">true</property>"
            )
        )
    };
    expect![[r#"
        4:44-45 warning S3012: the property `number` is given a value beside its `source`
          4:33-35 this `source` is used
          help: keep one of the two: the value is ignored
        5:36-37 warning S3012: the property `delay` is given a value beside its `source`
          5:32-34 this `source` is used
          help: keep one of the two: the value is ignored
        R (example.Robot) ID=Text("R") number=Integer(5) awake=Boolean(true) gps->
    "#]]
    .assert_eq(&of(&inside("5")));
    // What counts until somebody gives one from outside.
    expect![[r#"
        R (example.Robot) ID=Text("R") number=Integer(1) awake=Boolean(true) gps->
    "#]]
    .assert_eq(&of(&inside("")));
}

#[test]
fn a_table_between_other_separators_is_told_once() {
    let inside = "<component xmlns:s=\"urn:saoms:1\" name=\"R${index}\" s:count=\"2\" s:overrides=\"r.csv\"><implementation.java class=\"example.Robot\"/>
<property name=\"ID\">R${index}</property><property name=\"period\">1</property><property name=\"number\">${index}</property></component>";
    let with = |table: &str| checked(inside, &[("r.csv", table.as_bytes())], 1 << 20).1;
    expect![[r#"
        r.csv:1:6-7 error S2047: the values of this table are separated by `;`, expected commas
          help: save it as comma-separated values; write a value that contains a comma between two `"`
    "#]]
    .assert_eq(&with("index;delay;awake\n1;60;\n2;;true\n"));
    expect![[r#"
        r.csv:1:7-8 error S2047: the values of this table are separated by tabs, expected commas
          help: save it as comma-separated values; write a value that contains a comma between two `"`
    "#]]
    .assert_eq(&with("\u{feff}\"name\"\tdelay\nR1\t60\n"));
    assert_eq!(with("index\n1\n"), "");
}

#[test]
fn quotes_of_word_processors_are_told() {
    let with = |component: &str| {
        faults_of(&[&fleet(&format!("{component}<implementation.java class=\"example.Gps\"/></component>"))], &[])
    };
    expect![[r#"
        2:17-20 error S0105: `“` is not a quote of XML: write values between two `"`
          fix: replace it with `"G"` [2:17-20 "\"G\""]
    "#]]
    .assert_eq(&with("<component name=“G”>"));
    expect![[r#"
        2:17-20 error S0105: `„` is not a quote of XML: write values between two `"`
          fix: replace it with `"G"` [2:17-20 "\"G\""]
    "#]]
    .assert_eq(&with("<component name=„G“>"));
    expect![[r#"
        2:19-20 error S0105: `”` does not close a value that starts with `"`
          2:17-18 the value starts here
          fix: replace `”` with `"` [2:19-20 "\""]
    "#]]
    .assert_eq(&with("<component name=\"G”>"));
    expect![[r#"
        2:17-20 error S0105: `“` is not a quote of XML: write values between two `"`
          fix: replace it with `"G"` [2:17-20 "\"G\""]
        2:31-35 warning S2018: autowire finds no service with the interface `example.Positions` for reference `other` of component `G`
          help: no component beside it has a service
          help: remove `autowire`, or add a component with that service
    "#]]
    .assert_eq(&with("<component name=“G\" autowire=\"true\">"));
    expect![[r#"
        2:19-20 error S0105: `”` does not close a value that starts with `"`
          2:17-18 the value starts here
          fix: replace `”` with `"` [2:19-20 "\""]
        2:31-35 warning S2018: autowire finds no service with the interface `example.Positions` for reference `other` of component `G`
          help: no component beside it has a service
          help: remove `autowire`, or add a component with that service
    "#]]
    .assert_eq(&with("<component name=\"G” autowire=\"true\">"));
    // They may stand in a value.
    assert_eq!(with("<component name=\"“G”\">"), "");
}

#[test]
fn truth_is_written_small() {
    let with = |condition: &str| {
        of(&format!(
            "<property name=\"a\">1</property>\n<component name=\"G\" saoms:if=\"{condition}\"><implementation.java class=\"example.Gps\"/></component>"
        ))
    };
    expect![[r#"
        3:31-35 error S2045: the composite has no property `True`
          fix: replace `True` with `true` [3:31-35 "true"]
    "#]]
    .assert_eq(&with("True"));
    expect![[r#"
        3:46-51 error S2045: the composite has no property `FALSE`
          fix: replace `FALSE` with `false` [3:46-51 "false"]
    "#]]
    .assert_eq(&with("a == 1 and not FALSE"));
    expect![[r#"
        3:31-34 error S2045: the composite has no property `yes`
          fix: replace `yes` with `true` [3:31-34 "true"]
    "#]]
    .assert_eq(&with("yes"));
}

#[test]
fn loops_are_taken_as_given_with_the_classes() {
    let cart = "<property name=\"f\">1</property><component name=\"C\"><implementation.java class=\"example.Cart\"/><property name=\"ID\">C</property><property name=\"period\">1</property>
<saoms:loop name=\"X\" class=\"other.Saver\" after=\"BatteryMS\"><property name=\"floor\" source=\"$f\"/></saoms:loop><saoms:loop name=\"PathMs\" remove=\"true\"/></component>";
    let text = part("fleet", "xmlns:saoms=\"urn:saoms:1\"", cart);
    let found = |assume_classes: bool| {
        let (_, found, sources) = nested(&[&text], &[], assume_classes);
        found.iter().map(|one| shown(one, &sources)).collect::<String>()
    };
    expect![[r#"
        3:29-40 error S3001: there is no loop class `other.Saver`
          help: `saoms components` lists the 12 loops of this program and its plugins; `--plugin PATH` adds the loops of a plugin
          fix: replace `other.Saver` with `example.BatterySaver` [3:29-40 "example.BatterySaver"]
        3:127-133 error S4501: component `C` has no loop `PathMs`
          fix: replace `PathMs` with `PathMS` [3:127-133 "PathMS"]
    "#]].assert_eq(&found(false));
    expect![[r#"
        3:127-133 error S4501: component `C` has no loop `PathMs`
          fix: replace `PathMs` with `PathMS` [3:127-133 "PathMS"]
    "#]]
    .assert_eq(&found(true));
}

#[test]
fn words_of_other_languages_are_told_once() {
    let with = |from: &str, to: &str| {
        let robot = robot("R", "<property name=\"number\">1</property><reference name=\"gps\" target=\"G\"/>");
        assert!(robot.contains(from), "{from}");
        let found = of(&format!("{GPS}\n{}", robot.replace(from, to)));
        found.lines().filter(|line| !line.contains(" (example.")).fold(String::new(), |all, line| all + line + "\n")
    };
    let class = "<implementation.java class=\"example.Robot\"/>";
    expect![[r#"
        3:22-36 error S1004: SCA 1.1 has no element `implementation`
          fix: replace `implementation` with `implementation.java` [3:22-36 "implementation.java"]
    "#]]
    .assert_eq(&with(class, "<implementation class=\"example.Robot\"/>"));
    expect![[r#"
        3:42-55 error S1012: unexpected text in `implementation.java`: it contains elements only
          help: name the class with the attribute `class`
    "#]]
    .assert_eq(&with(class, "<implementation.java>example.Robot</implementation.java>"));
    expect![[r#"
        3:42-46 error S1007: `implementation.java` has no attribute `name`
          fix: replace `name` with `class` [3:42-46 "class"]
    "#]]
    .assert_eq(&with(class, "<implementation.java name=\"example.Robot\"/>"));
    expect![[r#"
        3:98-103 error S1004: SCA 1.1 has no element `param`
          fix: replace `param` with `property` [3:98-103 "property"] [3:121-126 "property"]
    "#]]
    .assert_eq(&with("<property name=\"period\">1</property>", "<param name=\"period\">1</param>"));
    expect![[r#"
        4:52-55 error S2005: `gps` of class `example.Robot` is a reference, not a service
          fix: replace `service` with `reference` [4:38-45 "reference"]
    "#]]
    .assert_eq(&with("<reference name=\"gps\" target=\"G\"/>", "<service name=\"gps\" target=\"G\"/>"));
    expect![[r#"
        4:59-60 error S1012: unexpected text in `reference`: it contains elements only
          help: name the component that it calls with the attribute `target`
    "#]]
    .assert_eq(&with("<reference name=\"gps\" target=\"G\"/>", "<reference name=\"gps\">G</reference>"));
    expect![[r#"
        4:69-80 error S2012: component `G` has no service `whereabouts`
          help: its services are `position`
          fix: replace `whereabouts` with `position` [4:69-80 "position"]
    "#]]
    .assert_eq(&with("target=\"G\"", "target=\"G/whereabouts\""));
    expect![[r#"
        4:92-96 error S1007: `include` has no attribute `file`
          help: write the composite's `name` with the prefix of its `targetNamespace`, not the name of its file
    "#]]
    .assert_eq(&with("</component>", "</component><include file=\"part.composite\"/>"));
    expect![[r#"
        3:121-125 error S3007: property `period`: `0,5s` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          help: `period`: From one due execution to the next; a number without a unit is in ms
          fix: replace `0,5s` with `0.5s` [3:121-125 "0.5s"]
    "#]].assert_eq(&with("\">1</property>\n", "\">0,5s</property>\n"));
    expect![[r#"
        4:25-28 error S3007: property `number`: `3 m` is not a whole number: expected a whole number from 1 to 99
          help: `number`: The number of the robot
          fix: replace `3 m` with `3` [4:25-28 "3"]
    "#]]
    .assert_eq(&with("\">1</property><ref", "\">3 m</property><ref"));
}

#[test]
fn folders_stand_before_slashes() {
    let inside = robot("R", "<property name=\"number\" file=\"sub\\n.txt\"/>");
    let found = checked(&inside, &[("sub/n.txt", b"1")], 1 << 20).1;
    expect![[r#"
        3:31-40 error S0001: there is no such file
          help: separate folders with `/`: write `sub/n.txt`
    "#]]
    .assert_eq(&found);
    let beside = robot("R", "<property name=\"number\" file=\".\\n.txt\"/>");
    let found = checked(&beside, &[("n.txt", b"1")], 1 << 20).1;
    expect![[r#"
        3:31-38 error S0001: there is no such file
          help: separate folders with `/`: write `./n.txt`
    "#]]
    .assert_eq(&found);
}

#[test]
fn what_belongs_elsewhere_is_told_where() {
    let column = "<component name=\"R${index}\" saoms:count=\"1\" saoms:overrides=\"robots.csv\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">R</property><property name=\"period\">1</property><property name=\"speed\">1</property></component>";
    let column = column.replacen(' ', " xmlns:saoms=\"urn:saoms:1\" ", 1);
    let (_, column) = checked(&column, &[("robots.csv", b"index,Speed\n1,2\n")], 500);
    let said = [
        of("<property name=\"speed\" file=\"speed.txt\"/>"),
        of("<property name=\"speed\" saoms:env=\"$SPEED\">1</property>"),
        of("<property name=\"speed\" val=\"1\"/>"),
        of(&robot("R", "<property name=\"number\" saoms:env=\"N\">1</property>")),
        of(&format!("{GPS}\n<reference name=\"gps\" promote=\"G/position\"/>")),
        column,
    ];
    expect![[r#"
        2:17-22 warning S2026: no component uses the property `speed` of the composite
          help: remove it, or use its value in a component with `source="$speed"`
        2:24-28 error S1007: `property` has no attribute `file`
          help: only a property of a component has this attribute: write the value here
        2:17-22 warning S2026: no component uses the property `speed` of the composite
          help: remove it, or use its value in a component with `source="$speed"`
        2:35-41 error S1011: `$SPEED` is not a name of an environment variable: use letters, digits and `_`, and no digit first
          fix: replace it with `SPEED` [2:35-41 "SPEED"]
        2:17-22 warning S2026: no component uses the property `speed` of the composite
          help: remove it, or use its value in a component with `source="$speed"`
        2:24-27 error S1007: `property` has no attribute `val`
          fix: replace `val` with `value` [2:24-27 "value"]
        3:25-34 error S1007: `property` has no attribute `saoms:env`
          help: only a property of the composite has this attribute: take the value of such a property with `source`
        3:34-42 error S2021: component `G` has no reference `position`
          help: its references are `other`
          help: `position` is a service: promote it with `<service ...>`
        2:44-53 error S3006: component `R1` needs the property `number` (index 1)
          help: add `<property name="number">...</property>`: a whole number from 1 to 99
        robots.csv:1:7-12 error S3004: class `example.Robot` has no property `Speed` (in `R1`, index 1)
          fix: replace `Speed` with `speed` [robots.csv:1:7-12 "speed"]
    "#]].assert_eq(&said.concat());
}

#[test]
fn a_file_that_ends_too_early_is_closed_with_all_end_tags() {
    let whole = fleet(r#"<component name="A"><implementation.java class="example.Robot001"/>"#);
    let cut = whole.split("</composite>").next().unwrap();
    let found = faults_of(&[cut], &[]);
    assert_eq!(found.matches("error").count(), 1, "{found}");
    assert!(found.contains("add `</component></composite>` at the end"), "{found}");
}
