//! The properties of composites, and the options that set them.

use expect_test::expect;

use crate::check::support::{faults, faults_of, fleet, nested, outcome, part, shown};
use crate::check::values::properties::robot;

#[test]
fn sources_lead_to_composite_properties() {
    expect![""].assert_eq(&faults(&format!(
        r#"<property name="speed">2</property>
<property name="where"><value><place xmlns="urn:x"><x>3</x><y>4</y></place></value></property>
<property name="many" many="true"><value>1</value><value>2</value></property>
<property name="nothing"/>
{}"#,
        robot(
            r#"<property name="speed" source="$speed"/>
<property name="charger" source="$where/p:place" xmlns:p="urn:x"/>
<property name="number" source="$where/*[local-name()='place']/x"/>
<property name="stops" source="$many"/>
<property name="delay" source="$nothing">5</property>
<property name="grace" source="$nothing"/>"#
        )
    )));
    expect![[r#"
        2:24-29 error S3007: property `speed`: `quick` is not a number: expected a number from 0.0 to 2.5 [m/s]
          9:32-38 used here as `speed`
          help: `speed`: How fast it drives; the default is `1.0`
        3:55-58 error S3008: property `number`: `300` is out of range: expected a whole number from 1 to 99
          10:33-47 used here as `number`
          help: `number`: The number of the robot
        6:17-21 error S2025: the property `must` of the composite needs a value
          help: write it in the file, or give `--set must=...`
        7:17-22 error S2003: the composite has two properties `speed`
          2:17-22 the first
          help: give each its own name
        11:41-47 error S2023: there is no part `plaice`; the parts are `place`
          fix: replace `plaice` with `place` [11:41-47 "place"]
        12:39-47 error S2023: this is not a step of a path
          help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
        13:33-37 error S2024: the composite has no property `sped`
          fix: replace `sped` with `speed` [13:33-37 "speed"]
        14:32-37 error S2023: `speed` does not name a property of the composite
          help: write `$name` without braces, or `$name/part` for a part of a complex property
          fix: insert `$` [14:32-37 "$speed"]
        15:38-40 error S2023: the property has a simple value: there are no parts in it
        16:33-35 error S2023: `/x` does not name a property of the composite
          help: write `$name` without braces, or `$name/part` for a part of a complex property
        19:33-41 error S3006: the property `period` has no value: its source has no value
          5:17-24 declared here, without a value
          help: write it in the file, or give `--set nothing=...`
    "#]].assert_eq(&faults(&format!(
        r#"<property name="speed">quick</property>
<property name="where"><value><place xmlns="urn:x"><x>300</x><y/></place></value></property>
<property name="unused">1</property>
<property name="nothing"/>
<property name="must" mustSupply="true"/>
<property name="speed">2</property>
{}
<component name="S"><implementation.java class="example.Robot"/><property name="ID">S</property>
<property name="period" source="$nothing"/><property name="number" source="$must"/><property name="speed" source="$speed"/></component>"#,
        robot(
            r#"<property name="speed" source="$speed"/>
<property name="number" source="$where/place/x"/>
<property name="charger" source="$where/plaice"/>
<property name="awake" source="$where/place[x]"/>
<property name="stops" source="$sped"/>
<property name="delay" source="speed"/>
<property name="grace" source="$speed/x"/>
<property name="colour" source="/x"/>"#
        )
    )));
}

#[test]
fn settings_take_the_place_of_composite_properties() {
    let text = fleet(&format!(
        r#"<property name="speed" mustSupply="true"/>
{}"#,
        robot(r#"<property name="speed" source="$speed"/>"#)
    ));
    expect![""].assert_eq(&faults_of(&[&text], &["speed=2.5"]));
    expect![[r#"
        --set:1:8-9 error S3008: property `speed`: `3` is out of range: expected a number from 0.0 to 2.5 [m/s]
          4:32-38 used here as `speed`
          help: `speed`: How fast it drives; the default is `1.0`
        --set:1:1-5 error S2029: no composite has a property `sped`
          fix: replace `sped` with `speed` [--set:1:1-5 "speed"]
        --set:1:1-6 error S2028: `speed` is set twice
          --set:1:1-6 first set here
          help: keep one of them
        --set:1:1-6 error S2027: `speed` is not a setting: `=` is missing
          help: write `--set NAME=VALUE` with the name of a composite property
        --set:1:1-3 error S2027: there is no name before the `=`
          help: write `--set NAME=VALUE` with the name of a composite property
        --set:1:1-6 error S2028: `speed` is set twice
          --set:1:1-6 first set here
          help: keep one of them
    "#]]
    .assert_eq(&faults_of(&[&text], &["speed= 3", "sped=1", "speed=1", "speed", "=1", "speed ="]));
    let period = r#"<property name="period">1</property><component name="C"><implementation.java class="example.Clock"/>
<property name="ID">C</property><property name="period" source="$period"/></component>"#;
    expect![[r#"
        --set:1:8-12 error S3007: property `period`: `soon` is not a duration: expected a duration from 100us to 24h (in ms, or with a unit: ns, us, ms, s, min, h)
          3:65-72 used here as `period`
          help: `period`: From one due execution to the next; a number without a unit is in ms
    "#]]
    .assert_eq(&faults_of(&[&fleet(period)], &["period=soon"]));
    let none = fleet(&robot(""));
    expect![[r#"
        --set:1:1-6 error S2029: no composite has a property `speed`
          help: declare it: `<property name="...">...</property>` in the composite
    "#]]
    .assert_eq(&faults_of(&[&none], &["speed=2.5"]));
}

#[test]
fn values_are_the_elements_that_properties_are_typed_by() {
    let place = r#"<p:place xmlns:p="urn:x"><x xmlns="">3</x><y xmlns="">4</y></p:place>"#;
    let typed = |name: &str| format!(r#"<property name="{name}" element="p:place" xmlns:p="urn:x">{place}</property>"#);
    let count = r#"<property name="count" element="p:n" xmlns:p="urn:x"><p:n>7</p:n></property>"#;
    let own = robot(&typed("charger"));
    let by_source = format!(
        "{}{count}{}",
        typed("where"),
        robot(r#"<property name="charger" source="$where"/><property name="number" source="$count"/>"#)
    );
    let by_paths = format!(
        "{}{}",
        typed("where"),
        robot(
            r#"<property name="charger" source="$where/place" xmlns:p="urn:x"/><property name="number" source="$where/x"/>"#
        )
    );
    for inside in [own, by_source, by_paths] {
        assert_eq!(faults(&inside), "");
        assert!(outcome(&[&fleet(&inside)], &[]).starts_with("R "), "{inside}");
    }
    let wrong = robot(&typed("charger").replace(">3<", ">three<"));
    expect![[r#"
        3:97-102 error S3007: property `charger.x`: `three` is not a whole number: expected a whole number from -2147483648 to 2147483647
    "#]]
    .assert_eq(&faults(&wrong));
    expect![[r#"
        2:17-18 warning S2026: no component uses the property `a` of the composite
          help: remove it, or use its value in a component with `source="$a"`
        3:17-18 warning S2026: no component uses the property `b` of the composite
          help: remove it, or use its value in a component with `source="$b"`
        4:17-18 warning S2026: no component uses the property `c` of the composite
          help: remove it, or use its value in a component with `source="$c"`
        5:17-18 warning S2026: no component uses the property `d` of the composite
          help: remove it, or use its value in a component with `source="$d"`
        6:17-18 warning S2026: no component uses the property `e` of the composite
          help: remove it, or use its value in a component with `source="$e"`
        7:17-18 warning S2026: no component uses the property `f` of the composite
          help: remove it, or use its value in a component with `source="$f"`
        9:2-10 error S3006: the property `charger.x` is missing: expected a whole number from -2147483648 to 2147483647
    "#]]
    .assert_eq(&faults(&format!(
        r#"<property name="a" element="p:place" xmlns:p="urn:x"><x xmlns="">3</x><y xmlns="">4</y></property>
<property name="b" element="p:place" xmlns:p="urn:x"><place>3</place></property>
<property name="c" element="p:place" xmlns:p="urn:x">3</property>
<property name="d" element="p:place" xmlns:p="urn:x"><p:place/><p:place/></property>
<property name="e" element="p:place" xmlns:p="urn:x" many="true"><p:place/><p:place/></property>
<property name="f" element="place" xmlns:p="urn:x"><value><p:place/></value></property>
{}"#,
        robot(r#"<property name="charger" element="p:place" xmlns:p="urn:x"><y xmlns="">4</y></property>"#)
    )));
}

/// Wherever a value comes from, it is held to the type of the property.
#[test]
fn values_from_outside_are_of_the_type_of_the_property() {
    let inside = robot(r#"<property name="speed" source="$speed"/>"#);
    let typed = format!(
        "<property name=\"speed\" type=\"xsd:int\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\">1</property>\n{inside}"
    );
    expect![""].assert_eq(&faults_of(&[&fleet(&typed)], &["speed=2"]));
    expect![[r#"
        --set:1:7-10 error S2042: the property `speed` has the type `xsd:int`: found `1.5`, expected a whole number of 32 bits
          2:30-37 the type
          help: change the value, or the type
    "#]]
    .assert_eq(&faults_of(&[&fleet(&typed)], &["speed=1.5"]));
    let outer = part(
        "outer",
        "",
        "<property name=\"slow\">0.5</property><component name=\"A\"><implementation.composite name=\"t:inner\"/><property name=\"speed\">1.5</property></component>
<component name=\"B\"><implementation.composite name=\"t:inner\"/><property name=\"speed\" source=\"$slow\"/></component>",
    );
    expect![[r#"
        2:23-26 error S2042: the property `speed` has the type `xsd:int`: found `0.5`, expected a whole number of 32 bits
          inner:2:30-37 the type
          help: change the value, or the type
        2:122-125 error S2042: the property `speed` has the type `xsd:int`: found `1.5`, expected a whole number of 32 bits
          inner:2:30-37 the type
          help: change the value, or the type
        3:18-19 error S3013: `A` and `B` are uses of one composite in one site, and both have a component `R`
          2:54-55 the first
          help: give each its own site, such as `saoms:site="B"`: IDs need to differ only within a site; to let them work together, give their components IDs of their own by a property of the composite
    "#]]
    .assert_eq(&outcome(&[&outer, &part("inner", "", &typed)], &[]));
}

#[test]
fn types_that_xml_schema_does_not_have_are_told_with_the_nearest() {
    let property = |of: &str| {
        let property = format!(
            "<property name=\"speed\" type=\"{of}\" xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\" xmlns:own=\"urn:own\">1</property>"
        );
        faults(&format!("{property}\n{}", robot(r#"<property name="speed" source="$speed"/>"#)))
    };
    expect![[r#"
        2:30-37 error S2050: XML Schema has no type `itn`
          fix: replace `xsd:itn` with `xsd:int` [2:30-37 "xsd:int"]
    "#]]
    .assert_eq(&property("xsd:itn"));
    expect![[r#"
        2:30-38 error S2050: XML Schema has no type `bool`
          fix: replace `xsd:bool` with `xsd:boolean` [2:30-38 "xsd:boolean"]
    "#]]
    .assert_eq(&property("xsd:bool"));
    assert_eq!(property("own:itn") + &property("xsd:unsignedByte"), "");
}

/// A composite may be there for components of others, where classes are taken as given.
#[test]
fn a_value_that_a_component_has_to_give_is_awaited_of_one_that_is_not_seen() {
    let inside = r#"<property name="pace" mustSupply="true"/>
<component name="R"><implementation.java class="other.R"/><property name="speed" source="$pace"/></component>"#;
    let inner = part("inner", "", inside);
    let outer = r#"<component name="A"><implementation.composite name="t:inner"/></component>"#;
    let outer = part("outer", "", outer);
    let found = |texts: &[&str], assume_classes| {
        let (_, diagnostics, sources) = nested(texts, &[], assume_classes);
        let found = diagnostics.iter().filter(|one| one.code.id == "S2025");
        found.map(|one| shown(one, &sources)).collect::<String>()
    };
    expect![[r#"
        2:17-21 warning S2025: the property `pace` of the composite needs a value
          help: write it in the file, or give `--set pace=...`
          help: where the composite implements a component, that component gives the value
    "#]]
    .assert_eq(&found(&[&inner], true));
    expect![[r#"
        2:17-21 error S2025: the property `pace` of the composite needs a value
          help: write it in the file, or give `--set pace=...`
    "#]]
    .assert_eq(&found(&[&inner], false));
    expect![[r#"
        2:18-19 error S2025: component `A` must give a value to the property `pace` of its composite
          inner:2:17-21 declared here, without a value
          help: add `<property name="pace">...</property>`
    "#]]
    .assert_eq(&found(&[&outer, &inner], true));
}

#[test]
fn many_values_may_be_a_list_of_its_type() {
    let of = |text: &str| {
        faults(&format!(
            r#"<property name="p" type="xsd:int" many="true" xmlns:xsd="http://www.w3.org/2001/XMLSchema">{text}</property>
{}"#,
            robot("")
        ))
    };
    assert!(!of("1 2\t3").contains("S2042"));
    assert!(
        of("<value>1</value><value/>").contains("error S2042: the property `p` has the type `xsd:int`: found nothing")
    );
    assert!(of("1 2 x").contains("error S2042: the property `p` has the type `xsd:int`: found `1 2 x`"));
}

/// Each of many that takes all of many values would be the square of what the file has.
#[test]
fn sources_of_many_values_have_a_limit() {
    let inside = format!(
        r#"<property name="all" many="true">{}</property>
<component name="Robot${{index}}" saoms:count="100" xmlns:saoms="urn:saoms:1"><implementation.java class="example.Robot"/><property name="charger" source="$all"/></component>"#,
        "<value>1</value>".repeat(41_000)
    );
    let found = faults(&inside);
    let limit = "error S2035: the components take more than 4000000 values by `source`";
    assert_eq!(found.matches(limit).count(), 1, "{found}");
}

/// Each of many that takes a long text has it.
#[test]
fn sources_of_long_texts_have_a_limit() {
    let inside = format!(
        r#"<property name="long">{}</property>
<component name="Robot${{index}}" saoms:count="100" xmlns:saoms="urn:saoms:1"><implementation.java class="example.Robot"/><property name="charger" source="$long"/></component>"#,
        "1".repeat(1_000_000)
    );
    let found = faults(&inside);
    let limit = "error S2035: the components take more than 64 MB of text by `source`";
    assert_eq!(found.matches(limit).count(), 1, "{}", found.len());
}
