//! Likely meanings of values and unresolved names: each is reported once, also for replicas, with what to write.

use expect_test::expect;

use crate::check::mistakes::slips::{GPS, of, robot};
use crate::check::support::{faults_of, outcome, part};

/// The diagnostics of three halls of two robots: with the declarations of the component that a hall implements, and the
/// property of the hall.
fn halls(given: &str, property: &str) -> String {
    let namespaces = "xmlns:saoms=\"urn:saoms:1\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\"";
    let robots = "<component name=\"Robot${index}\" saoms:count=\"2\"><implementation.java class=\"example.Robot\"/><property name=\"period\">1</property>\n<property name=\"ID\">R${hall * 10 + index}</property>\n<property name=\"number\">${hall * 10 + index}</property></component>";
    let reference = "<reference name=\"gps\" promote=\"Robot*/gps\"/>";
    let hall = part("hall", namespaces, &format!("{property}\n{reference}\n{robots}"));
    let component = format!(
        "<component name=\"Hall${{index}}\" saoms:count=\"3\"><implementation.composite name=\"t:hall\"/>\n{given}</component>"
    );
    let fleet = part("fleet", namespaces, &format!("{GPS}\n{component}"));
    outcome(&[&fleet, &hall], &[])
}

#[test]
fn one_mistake_in_replicas_of_composites_is_told_once() {
    let must = "<property name=\"hall\" type=\"xsd:int\" mustSupply=\"true\"/>";
    let wired = "<reference name=\"gps\" target=\"G\"/>";
    let right = "<property name=\"hall\">${index}</property>";
    expect![[r#"
        4:17-20 error S3004: composite `hall` has no property `hal` (in `Hall1`, index 1, and in 2 more)
          fix: replace `hal` with `hall` [4:17-20 "hall"]
    "#]]
    .assert_eq(&halls(&format!("{}{wired}", right.replace("hall", "hal")), must));
    expect![[r#"
        3:18-30 error S2025: component `Hall1` must give a value to the property `hall` of its composite (index 1, and in 2 more)
          hall:2:17-21 declared here, without a value
          help: add `<property name="hall">...</property>`
    "#]].assert_eq(&halls(wired, must));
    expect![[r#"
        4:72-74 error S2011: there is no component `Gg` (in `Hall1`, index 1, and in 2 more)
          fix: replace `Gg` with `G` [4:72-74 "G"]
    "#]]
    .assert_eq(&halls(&format!("{right}<reference name=\"gps\" target=\"Gg\"/>"), must));
    // A property without a value is reported where an expression first uses it.
    expect![[r#"
        hall:5:24-28 error S2045: the property `hall` has no value (in `Robot1`, index 1)
          help: write it in the file, or give it with `--set`, or in the component that the composite implements
    "#]]
    .assert_eq(&halls(wired, "<property name=\"hall\" type=\"xsd:int\"/>"));
}

#[test]
fn the_index_is_meant_by_what_looks_like_it() {
    let replicas = |number: &str| {
        of(&format!(
            "<component name=\"R${{index}}\" saoms:count=\"2\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">R${{index}}</property><property name=\"period\">1</property>\n<property name=\"number\">{number}</property></component>"
        ))
    };
    let said = ["$index", "index", "{index}", "i", "${idx}"].map(replicas).concat();
    expect![[r#"
        3:25-31 error S3007: property `number`: `$index` is not a whole number: expected a whole number from 1 to 99 (in `R1`, index 1, and in 1 more)
          help: `number`: The number of the robot
          fix: replace `$index` with `${index}` [3:25-31 "${index}"]
        3:25-30 error S3007: property `number`: `index` is not a whole number: expected a whole number from 1 to 99 (in `R1`, index 1, and in 1 more)
          help: `number`: The number of the robot
          fix: replace `index` with `${index}` [3:25-30 "${index}"]
        3:25-32 error S3007: property `number`: `{index}` is not a whole number: expected a whole number from 1 to 99 (in `R1`, index 1, and in 1 more)
          help: `number`: The number of the robot
          fix: replace `{index}` with `${index}` [3:25-32 "${index}"]
        3:25-26 error S3007: property `number`: `i` is not a whole number: expected a whole number from 1 to 99 (in `R1`, index 1, and in 1 more)
          help: `number`: The number of the robot
          fix: replace `i` with `${index}` [3:25-26 "${index}"]
        3:27-30 error S2045: the composite has no property `idx` (in `R1`, index 1, and in 1 more)
          fix: replace `idx` with `index` [3:27-30 "index"]
    "#]].assert_eq(&said);
    // Not where nothing is counted.
    expect![[r#"
        3:25-31 error S3007: property `number`: `$index` is not a whole number: expected a whole number from 1 to 99
          help: `${index}` is only for replicas: give the component a `saoms:count`
          help: `number`: The number of the robot
    "#]]
    .assert_eq(&of(&robot("R", "<property name=\"number\">$index</property>")));
    let promoted = "<service name=\"s\" promote=\"R${index}/gps\"/>";
    expect![[r#"
        3:28-37 error S2011: there is no component `R${index}`
          help: the components are `G`
    "#]]
    .assert_eq(&of(&format!("{GPS}\n{promoted}")));
}

#[test]
fn no_component_is_told_to_name_itself() {
    let reference = "<reference name=\"gps\" target=\"Robot\"/>";
    expect![[r#"
        3:18-24 error S3006: component `Robots` needs the property `number`
          help: add `<property name="number">...</property>`: a whole number from 1 to 99
        4:31-36 error S2011: there is no component `Robot`
          help: the components are `G`
    "#]]
    .assert_eq(&of(&format!("{GPS}\n{}", robot("Robots", reference))));
}

#[test]
fn a_source_that_leads_to_nothing_says_what_gives_it_a_value() {
    let with = |property: &str, source: &str| {
        let number = format!("<property name=\"number\" source=\"{source}\"/>");
        of(&format!("{property}\n{}", robot("R", &number)))
    };
    expect![[r#"
        4:33-35 error S3006: the property `number` has no value: its source has no value
          2:17-18 declared here, without a value
          help: write it in the file, give `--set n=...`, or set `N` in the environment
    "#]]
    .assert_eq(&with("<property name=\"n\" saoms:env=\"N\"/>", "$n"));
    let complex = "<property name=\"n\"><max at=\"1\">3</max></property>";
    expect![[r#"
        4:36-38 error S2023: there is no part `mx`; the parts are `max`
          fix: replace `mx` with `max` [4:36-38 "max"]
    "#]]
    .assert_eq(&with(complex, "$n/mx"));
    expect![[r#"
        4:40-42 error S2023: there is no attribute `a`; the attributes are `at`
          fix: replace `a` with `at` [4:41-42 "at"]
    "#]]
    .assert_eq(&with(complex, "$n/max/@a"));
}

#[test]
fn a_type_whose_prefix_means_nothing_is_told() {
    let with = |kind: &str| {
        let property = format!("<property name=\"n\" type=\"{kind}\">3</property>");
        of(&format!("{property}\n{}", robot("R", "<property name=\"number\" source=\"$n\"/>")))
    };
    expect![[r#"
        2:26-33 warning S2050: the prefix `xsd` of this type is not declared
          fix: declare it in the root element: `xmlns:xsd="http://www.w3.org/2001/XMLSchema"` [1:11-11 " xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\""]
        R (example.Robot) ID=Text("R") number=Integer(3) gps->
    "#]].assert_eq(&with("xsd:int"));
    expect![[r#"
        2:26-35 warning S2050: the prefix `my` of this type is not declared
          help: declare it: `xmlns:my="..."`
        R (example.Robot) ID=Text("R") number=Integer(3) gps->
    "#]]
    .assert_eq(&with("my:number"));
}

#[test]
fn a_type_of_xml_schema_without_its_prefix_is_told() {
    let with = |kinds: &[&str], attributes: &str| {
        let property = |(at, kind): (usize, &&str)| format!("<property name=\"n{at}\" type=\"{kind}\">3</property>\n");
        let properties: String = kinds.iter().enumerate().map(property).collect();
        let taken = (0..kinds.len()).map(|at| format!("${{n{at}}}"));
        let taken: String = taken.collect();
        let robot = robot(
            "R${index}",
            &format!("<property name=\"number\">1</property><property name=\"password\">{taken}</property>"),
        );
        let robot = robot.replacen("<component", "<component saoms:count=\"1\"", 1);
        outcome(&[&part("fleet", &format!("xmlns:saoms=\"urn:saoms:1\" {attributes}"), &(properties + &robot))], &[])
    };
    let schema = "xmlns:xs=\"http://www.w3.org/2001/XMLSchema\"";
    expect![[r#"
        2:27-30 warning S2050: the type `int` without a prefix is not a type of XML Schema
          fix: replace `int` with `xs:int` [2:27-30 "xs:int"]
        3:27-31 warning S2050: the type `bool` without a prefix is not a type of XML Schema
          fix: replace `bool` with `xs:boolean` [3:27-31 "xs:boolean"]
        4:27-33 warning S2050: the type `intger` without a prefix is not a type of XML Schema
          fix: replace `intger` with `xs:integer` [4:27-33 "xs:integer"]
        7:63-83 warning S4006: `password` is given without `user` (in `R1`, index 1)
          help: give both, or neither
        R1 (example.Robot) ID=Text("R1") number=Integer(1) gps->
    "#]]
    .assert_eq(&with(&["int", "bool", "intger", "Customer"], schema));
    expect![[r#"
        2:27-30 warning S2050: the type `int` without a prefix is not a type of XML Schema
          fix: replace `int` with `xsd:int`, and declare `xmlns:xsd="http://www.w3.org/2001/XMLSchema"` in the root element [2:27-30 "xsd:int"] [1:11-11 " xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\""]
        3:27-30 warning S2050: the type `int` without a prefix is not a type of XML Schema
          fix: replace `int` with `xsd:int` [3:27-30 "xsd:int"]
        5:63-73 warning S4006: `password` is given without `user` (in `R1`, index 1)
          help: give both, or neither
        R1 (example.Robot) ID=Text("R1") number=Integer(1) gps->
    "#]].assert_eq(&with(&["int", "int"], ""));
    expect![[r#"
        2:27-30 warning S2050: the type `int` without a prefix is not a type of XML Schema
          fix: replace `int` with `xs:int`, and declare `xmlns:xs="http://www.w3.org/2001/XMLSchema"` in the root element [2:27-30 "xs:int"] [1:11-11 " xmlns:xs=\"http://www.w3.org/2001/XMLSchema\""]
        4:63-68 warning S4006: `password` is given without `user` (in `R1`, index 1)
          help: give both, or neither
        R1 (example.Robot) ID=Text("R1") number=Integer(1) gps->
    "#]].assert_eq(&with(&["int"], "xmlns:xsd=\"urn:own\""));
}

#[test]
fn a_slip_in_the_name_of_a_type_is_no_other_type() {
    let outer = "<component name=\"In\"><implementation.composite name=\"t:inner\"/><property name=\"n\" type=\"xsd:interger\">3</property></component>";
    let inner = "<property name=\"n\" type=\"xsd:int\">1</property>";
    let inner = format!("{inner}\n{}", robot("R", "<property name=\"number\" source=\"$n\"/>"));
    let schema = "xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\"";
    expect![[r#"
        2:89-101 error S2050: XML Schema has no type `interger`
          fix: replace `xsd:interger` with `xsd:integer` [2:89-101 "xsd:integer"]
    "#]]
    .assert_eq(&outcome(&[&part("fleet", schema, outer), &part("inner", schema, &inner)], &[]));
}

#[test]
fn one_value_that_is_wrong_for_two_properties_is_told_once() {
    let outer = "<property name=\"n\" type=\"xsd:int\">many</property>\n<component name=\"In\"><implementation.composite name=\"t:inner\"/><property name=\"k\" source=\"$n\"/></component>";
    let inner = "<property name=\"k\" type=\"xsd:int\">1</property>";
    let inner = format!(
        "{inner}\n{}",
        robot("R", "<property name=\"number\">1</property><property name=\"password\" source=\"$k\"/>")
    );
    let schema = "xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\"";
    expect![[r#"
        2:35-39 error S2042: the property `k` has the type `xsd:int`: found `many`, expected a whole number of 32 bits
          inner:2:26-33 the type
          help: change the value, or the type
        2:35-39 warning S4006: `password` is given without `user`
          help: give both, or neither
    "#]]
    .assert_eq(&outcome(&[&part("fleet", schema, outer), &part("inner", schema, &inner)], &[]));
}

#[test]
fn what_comes_from_outside_is_told_where_it_was_given() {
    let inside = "<property name=\"n\" type=\"xsd:int\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\">4</property>";
    let fleet = crate::check::support::fleet(&format!("{inside}\n{GPS}"));
    expect![[r#"
        --set:1:3-3 error S2042: the property `n` has the type `xsd:int`: found nothing, expected a whole number of 32 bits
          2:26-33 the type
          help: change the value, or the type
        2:17-18 warning S2026: no component uses the property `n` of the composite
          help: remove it, or use its value in a component with `source="$n"`
    "#]].assert_eq(&faults_of(&[&fleet], &["n="]));
    // What cannot be read may declare it.
    expect![[r#"
        1:2-11 error S0103: the start tag of `composite` has no `>`
          1:11-11 the file ends here
    "#]]
    .assert_eq(&faults_of(&["<composite"], &["n=1"]));
}

#[test]
fn of_no_replicas_nothing_is_told_that_some_would_change() {
    let inside = format!(
        "<property name=\"site\">north</property>\n<component name=\"R${{index}}\" saoms:count=\"0\" saoms:if=\"site == 'north'\"><implementation.java class=\"example.Gps\"/></component>\n{GPS}"
    );
    expect![[r#"
        G (example.Gps) other->
    "#]]
    .assert_eq(&of(&inside));
}

#[test]
fn a_property_that_a_component_does_not_give_says_which() {
    let unit = part(
        "unit",
        "",
        &format!("<property name=\"who\"/>\n{}", robot("R", "<property name=\"number\" source=\"$who\"/>")),
    );
    let with = |given: &str| {
        let component = format!("<component name=\"U\"><implementation.composite name=\"t:unit\"/>{given}</component>");
        outcome(&[&part("fleet", "", &component), &unit], &[])
    };
    expect![[r#"
        unit:4:33-37 error S3006: the property `number` has no value: its source has no value
          unit:2:17-20 declared here, without a value
          2:18-19 this component gives no value
          help: add `<property name="who">...</property>` to the component `U`, which the composite implements
    "#]]
    .assert_eq(&with(""));
    expect![[r#"
        2:78-82 error S3004: composite `unit` has no property `whoo`
          fix: replace `whoo` with `who` [2:78-82 "who"]
    "#]]
    .assert_eq(&with("<property name=\"whoo\">1</property>"));
    expect![[r#"
        2:78-82 error S3004: composite `unit` has no property `whom`
          fix: replace `whom` with `who` [2:78-82 "who"]
        2:111-116 error S3004: composite `unit` has no property `other`
          help: its properties are `who`
    "#]]
    .assert_eq(&with("<property name=\"whom\" value=\"1\"/><property name=\"other\" value=\"1\"/>"));
}

#[test]
fn an_expression_that_nobody_reads_is_told() {
    let with = |title: &str| {
        let component = "<component name=\"R\"><implementation.java class=\"example.Reader\"/>";
        of(&format!(
            "<property name=\"n\">3</property>\n{component}<property name=\"title\">{title}</property></component>"
        ))
    };
    expect![[r#"
        3:89-93 warning S3017: `${...}` in `${n}` is not evaluated: the component has no `saoms:count`
          help: write `source="$n"` for the value of the property `n`
        R (example.Reader) title=Text("${n}")
    "#]]
    .assert_eq(&with("${n}"));
    expect![[r#"
        3:89-104 warning S3017: `${...}` in `reader ${n + 1}` is not evaluated: the component has no `saoms:count`
          help: give the component a `saoms:count`, or write the value itself
        R (example.Reader) title=Text("reader ${n + 1}")
    "#]]
    .assert_eq(&with("reader ${n + 1}"));
    expect![[r#"
        3:89-97 warning S3017: `${...}` in `${index}` is not evaluated: the component has no `saoms:count`
          help: give the component a `saoms:count`, or write the value itself
        R (example.Reader) title=Text("${index}")
    "#]]
    .assert_eq(&with("${index}"));
    // It may mean something to the class.
    expect![[r#"
        2:17-18 warning S2026: no component uses the property `n` of the composite
          help: remove it, or use its value in a component with `source="$n"`
        R (example.Reader) title=Text("${other}")
    "#]]
    .assert_eq(&with("${other}"));
}

/// `$name` is for sources: as a text it stands for itself.
#[test]
fn a_property_of_the_composite_in_a_text_is_told() {
    let with = |count: &str, title: &str| {
        let component = format!("<component name=\"R{count}><implementation.java class=\"example.Reader\"/>");
        let property = format!("<property name=\"title\" value=\"{title}\"/>");
        of(&format!("<property name=\"n\">3</property>\n{component}{property}</component>"))
    };
    expect![[r#"
        3:96-98 warning S3017: `$n` is a text here, not the value of the property `n`
          help: write `source="$n"` to take that value
        R (example.Reader) title=Text("$n")
    "#]]
    .assert_eq(&with("\"", "$n"));
    expect![[r#"
        3:120-122 warning S3017: `$n` is a text here, not the value of the property `n` (in `R1`, index 1, and in 1 more)
          help: write `source="$n"` to take that value
        R1 (example.Reader) title=Text("$n")
        R2 (example.Reader) title=Text("$n")
    "#]].assert_eq(&with("${index}\" saoms:count=\"2\"", "$n"));
    // It may mean something to the class.
    expect![[r#"
        2:17-18 warning S2026: no component uses the property `n` of the composite
          help: remove it, or use its value in a component with `source="$n"`
        R (example.Reader) title=Text("$other")
    "#]]
    .assert_eq(&with("\"", "$other"));
    expect![[r#"
        2:17-18 warning S2026: no component uses the property `n` of the composite
          help: remove it, or use its value in a component with `source="$n"`
        R (example.Reader) title=Text("3 $n")
    "#]]
    .assert_eq(&with("\"", "3 $n"));
}

#[test]
fn a_name_with_a_blank_is_told_once_wherever_it_is_used() {
    let robot = |target: &str| {
        let fleet = format!(
            "{}\n{}",
            GPS.replace("name=\"G\"", "name=\"G ps\""),
            robot("R", &format!("<property name=\"number\">1</property><reference name=\"gps\" target=\"{target}\"/>"))
        );
        of(&fleet)
    };
    for target in ["G ps", "Gps", "G"] {
        let found = robot(target);
        assert_eq!(found.matches(" error ").count(), 1, "{target}: {found}");
        assert!(found.contains("error S1011: `G ps` cannot be a name"), "{found}");
    }
    assert!(robot("Other").contains("S2011"), "another name is a mistake of its own");
}

#[test]
fn a_property_that_an_element_of_another_namespace_would_take_is_used() {
    let fleet = |taken: &str| {
        let robot = "<implementation.java class=\"example.Robot001\"/><property name=\"ID\">R1</property><property name=\"period\">1s</property>";
        let declared = "<property name=\"fast\">2</property><property name=\"slow\">1</property>";
        let component = format!(
            "{declared}<component name=\"R1\">{robot}<w:property name=\"speed\" source=\"{taken}\"/></component>"
        );
        outcome(&[&part("fleet", "xmlns:w=\"urn:w\"", &component)], &[])
    };
    for taken in ["$fast", "$fast/part", " $fast"] {
        let found = fleet(taken);
        assert!(found.contains("S1015") && found.contains("`slow`") && !found.contains("`fast`"), "{found}");
    }
    assert!(fleet("$faster").contains("`fast`"));
}

#[test]
fn a_property_of_the_composite_around_is_handed_in() {
    let robot = robot("R", "<property name=\"number\" source=\"$tick\"/>");
    let hall = part("hall", "", &format!("<property name=\"first\">1</property>{robot}"));
    let around = "<property name=\"tick\">1</property><component name=\"H\"><implementation.composite name=\"t:hall\"/><property name=\"first\">1</property></component>";
    let told = outcome(&[&part("fleet", "", around), &hall], &[]);
    expect![[r#"
        hall:3:34-38 error S2024: the composite has no property `tick`
          help: its properties are `first`
          help: properties of the outer composite are not visible here: declare `tick` here, and set it in the component
    "#]]
    .assert_eq(&told);
}
