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
        6:17-21 error S2025: the property `must` of the composite has to be given a value
          help: write it in the file, or give `--set must=...`
        7:17-22 error S2003: the composite has two properties `speed`
          2:17-22 the first
          help: give each its own name
        11:41-47 error S2023: there is no part `plaice`; the parts are `place`
          fix: replace `plaice` with `place` [11:41-47 "place"]
        12:39-47 error S2023: no step of a path is written like this
          help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: steps are `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
        13:33-37 error S2024: the composite has no property `sped`
          fix: replace `sped` with `speed` [13:33-37 "speed"]
        14:32-37 error S2023: `speed` names no property of the composite
          help: write `$name`, or `$name/part` for a part of a complex property
          fix: insert `$` [14:32-37 "$speed"]
        15:38-40 error S2023: the property has a simple value: there are no parts in it
        16:33-35 error S2023: `/x` names no property of the composite
          help: write `$name`, or `$name/part` for a part of a complex property
        19:33-41 error S3006: the property `period` has no value: its source has none
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

/// What users need of XPath, and what is said of the rest.
#[test]
fn sources_are_paths() {
    let bays = r#"<bays xmlns="urn:x" unit="m"><bay id="a"><x>3</x><y>4</y></bay><bay id="b/c"><x>5</x></bay><bay> 7 <x> 8 </x></bay></bays>"#;
    let value = |source: &str, name: &str| {
        let own = robot(&format!("<property name=\"{name}\" source=\"{source}\"/>"));
        let many = "<property name=\"many\" many=\"true\"><value>1</value><value>2</value></property>";
        let text = format!("<property name=\"b\">{bays}</property>{many}<property name=\"s\">1</property>{own}");
        let found = outcome(&[&fleet(&text)], &[]);
        match found.lines().find(|line| line.contains(" error ")) {
            Some(error) => error.split(" error ").nth(1).unwrap().to_owned(),
            None => {
                let found = found.split(&format!("{name}=")).nth(1).unwrap_or("nothing").to_owned();
                found.split([')', '\n']).next().unwrap().to_owned()
            }
        }
    };
    let mut all = String::new();
    for source in [
        "$b/bays/bay[1]/x",
        "$b/bay[1]/x",
        "$b/p:bay[ 2 ]/p:x",
        "$b/child::bay[last()]/x/text()",
        "$b/bay[@id='b/c']/*",
        "$b/*[1]/*[2]",
        "$b/bay[3]/text()",
        "$b/*[local-name()='bay'][2]/x",
        "$many[2]",
        "$many[last()]",
        "$b/bay[2]/y",
        "$b/bay[4]",
        "$b/bay[0]/x",
        "$b/bay/x",
        "$b/bay[@id='c']/x",
        "$b/bay[@name='c']/x",
        "$b/bay/@di",
        "$b/bay[2]/@id/x",
        "$b/bay[1]/text()",
        "$b/bay[x=3]/x",
        "$b//x",
        "$b/bay/../x",
        "$b/bay[1]x",
        "$many[3]",
        "$many[a]",
        "$many/x",
        "$many/value[2]",
        "$many/text()",
        "$many[2]/text()",
        "$b/bay/x[2]",
        "($b/bay/x)[2]",
        "count($b/bay)",
        "concat($s, 'x')",
        "$b/bay[x &gt; 3]/x",
        "$b/bay[not(@id)]/x",
        "$b/bay[1]/following-sibling::bay/x",
        "${s}",
        "$sa",
        "s",
        "'text'",
        "$s/x",
        "$b/",
        "$b[99999999999999999999999]",
    ] {
        all += &format!("{source}: {}\n", value(source, "number"));
    }
    expect![[r#"
        $b/bays/bay[1]/x: Text("3"
        $b/bay[1]/x: Text("3"
        $b/p:bay[ 2 ]/p:x: Text("5"
        $b/child::bay[last()]/x/text(): Text("8"
        $b/bay[@id='b/c']/*: Text("5"
        $b/*[1]/*[2]: S3007: the property `number` has elements inside: expected a whole number from 1 to 99
        $b/bay[3]/text(): Text("7"
        $b/*[local-name()='bay'][2]/x: Text("5"
        $many[2]: Text("2"
        $many[last()]: Text("2"
        $b/bay[2]/y: S2023: there is no part `y`; the parts are `x`
        $b/bay[4]: S2023: there are 3 parts `bay`, from `[1]` on
        $b/bay[0]/x: S2023: there are 3 parts `bay`, from `[1]` on
        $b/bay/x: S3011: the property `number` takes one value, and here are 3
        $b/bay[@id='c']/x: S2023: no part here has `c` as its `id`: its values are `a` and `b/c`
        $b/bay[@name='c']/x: S2023: no part here has `c` as its `name`: none has it
        $b/bay/@di: S2023: there is no attribute `di`; the attributes are `id`
        $b/bay[2]/@id/x: S2023: an attribute has no parts
        $b/bay[1]/text(): S2023: there is no text here
        $b/bay[x=3]/x: Text("3"
        $b//x: S3011: the property `number` takes one value, and here are 3
        $b/bay/../x: S2023: no step of a path is written like this
        $b/bay[1]x: S2023: no step of a path is written like this
        $many[3]: S2023: the property has 2 values
        $many[a]: S2023: no step of a path is written like this
        $many/x: S2023: the property has a simple value: there are no parts in it
        $many/value[2]: S2023: the property has a simple value: there are no parts in it; the values of a property are `$name` itself, the second is `$name[2]`
        $many/text(): S3011: the property `number` takes one value, and here are 2
        $many[2]/text(): Text("2"
        $b/bay/x[2]: S2023: there are 3 parts `x` in 3 elements, at most 1 in each, and a place counts in each
        ($b/bay/x)[2]: S2023: `($b/bay/x)[2]` is no path from a property
        count($b/bay): S2023: `count($b/bay)` is no path from a property
        concat($s, 'x'): S2023: `concat($s, 'x')` is no path from a property
        $b/bay[x &gt; 3]/x: S2023: no step of a path is written like this
        $b/bay[not(@id)]/x: S2023: no step of a path is written like this
        $b/bay[1]/following-sibling::bay/x: S2023: no step of a path is written like this
        ${s}: S2023: names of properties stand without braces here
        $sa: S2024: the composite has no property `sa`
        s: S2023: `s` names no property of the composite
        'text': S2023: `'text'` names no property of the composite
        $s/x: S2023: the property has a simple value: there are no parts in it
        $b/: S2023: a step is missing: steps are `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
        $b[99999999999999999999999]: S2023: the property has one value
    "#]].assert_eq(&all);
    assert!(value("$b/bay[1]/@id", "colour").starts_with("S3009: property `colour`: `a` is not allowed"));
    assert!(value("$b/bays/@unit", "colour").starts_with("S3009: property `colour`: `m` is not allowed"));
    assert!(value("$b/@unit", "colour").starts_with("S3009: property `colour`: `m` is not allowed"));
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
          --set:1:1-6 first here
          help: keep one of them
        --set:1:1-6 error S2027: `speed` sets nothing: there is no `=`
          help: write `--set NAME=VALUE` with the name of a composite property
        --set:1:1-3 error S2027: there is no name before the `=`
          help: write `--set NAME=VALUE` with the name of a composite property
        --set:1:1-6 error S2028: `speed` is set twice
          --set:1:1-6 first here
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
        2:17-18 warning S2026: the property `a` of the composite is used by no component
          help: a component takes its value with `source="$a"`
        3:17-18 warning S2026: the property `b` of the composite is used by no component
          help: a component takes its value with `source="$b"`
        4:17-18 warning S2026: the property `c` of the composite is used by no component
          help: a component takes its value with `source="$c"`
        5:17-18 warning S2026: the property `d` of the composite is used by no component
          help: a component takes its value with `source="$d"`
        6:17-18 warning S2026: the property `e` of the composite is used by no component
          help: a component takes its value with `source="$e"`
        7:17-18 warning S2026: the property `f` of the composite is used by no component
          help: a component takes its value with `source="$f"`
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
        --set:1:7-10 error S2042: the property `speed` is of the type `xsd:int`: found `1.5`, expected a whole number of 32 bits
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
        2:23-26 error S2042: the property `speed` is of the type `xsd:int`: found `0.5`, expected a whole number of 32 bits
          inner:2:30-37 the type
          help: change the value, or the type
        2:122-125 error S2042: the property `speed` is of the type `xsd:int`: found `1.5`, expected a whole number of 32 bits
          inner:2:30-37 the type
          help: change the value, or the type
        inner:3:88-89 error S3013: components `A/R` and `B/R` have the same `ID` `R`
          help: every robot needs its own
          help: both have it from here: let each get its own from outside, by a property or an index
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

#[test]
fn what_is_given_no_value_has_no_parts_either() {
    expect![""].assert_eq(&faults(&format!(
        r#"<property name="where" element="x:place" xmlns:x="urn:x"/>
{}"#,
        robot(r#"<property name="charger" source="$where/x"/><property name="grace" source="$where/y">5ms</property>"#)
    )));
}

/// Where classes are taken as given, a composite may be there for components of others.
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
        2:17-21 warning S2025: the property `pace` of the composite has to be given a value
          help: write it in the file, or give `--set pace=...`
          help: as an implementation, it takes the value that its component gives it
    "#]]
    .assert_eq(&found(&[&inner], true));
    expect![[r#"
        2:17-21 error S2025: the property `pace` of the composite has to be given a value
          help: write it in the file, or give `--set pace=...`
    "#]]
    .assert_eq(&found(&[&inner], false));
    expect![[r#"
        2:18-19 error S2025: component `A` has to give the property `pace` of its composite a value
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
        of("<value>1</value><value/>")
            .contains("error S2042: the property `p` is of the type `xsd:int`: found nothing")
    );
    assert!(of("1 2 x").contains("error S2042: the property `p` is of the type `xsd:int`: found `1 2 x`"));
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
    let limit = "error S2035: sources come to more than 4000000 values";
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
    let limit = "error S2035: sources come to more than 64 MB of text";
    assert_eq!(found.matches(limit).count(), 1, "{}", found.len());
}

#[test]
fn paths_lead_to_any_depth_and_to_what_a_part_says() {
    let of = |source: &str, assume_classes: bool| {
        let inside = format!(
            "<property name='c' type='p:C' xmlns:p='urn:p'><a xmlns=''><b id='1'><w>10</w></b><b id='2'><w>20</w><w>21</w><b id='3'><w>30</w></b></b></a></property>
<component name='R'><implementation.java class='example.Reader'/><property name='words' source=\"{source}\"/></component>"
        );
        let (assembly, diagnostics, sources) = nested(&[&part("fleet", "", &inside)], &[], assume_classes);
        let told: String = diagnostics.iter().map(|one| shown(one, &sources)).collect();
        let values = assembly.map(|assembly| {
            let all = assembly.components[0].values.iter().map(|(_, value)| format!("{value:?}"));
            all.collect::<Vec<_>>().join(" ")
        });
        match values {
            Some(values) => format!("{source}: {values}\n"),
            None => format!("{source}: {told}"),
        }
    };
    let sources = [
        "$c//w", "$c//w[1]", "$c/a//b[2]/w[2]", "$c//b//w", "$c//b[@id=3]/w", "$c/a/b[w=10]/w",
        "$c/a/b[w='20']/w[position()=2]", "$c//w[position()=last()]", "$c//b/@id", "$c//b[w=11]/w", "$c//v", "$c//",
        "$c///w", "$c/a/b[position()<2]/w",
    ];
    let all: String = sources.iter().map(|source| of(&source.replace('<', "&lt;"), false)).collect();
    expect![[r#"
        $c//w: Many([Text("10"), Text("20"), Text("21"), Text("30")])
        $c//w[1]: Many([Text("10"), Text("20"), Text("30")])
        $c/a//b[2]/w[2]: Many([Text("21")])
        $c//b//w: Many([Text("10"), Text("20"), Text("21"), Text("30")])
        $c//b[@id=3]/w: Many([Text("30")])
        $c/a/b[w=10]/w: Many([Text("10")])
        $c/a/b[w='20']/w[position()=2]: Many([Text("21")])
        $c//w[position()=last()]: Many([Text("10"), Text("21"), Text("30")])
        $c//b/@id: Many([Text("1"), Text("2"), Text("3")])
        $c//b[w=11]/w: 3:101-108 error S2023: no part here has `11` as its part `w`
        $c//v: 3:101-102 error S2023: there is no part `v`; the parts are `a`, `b` and `w`
        $c//: 3:100-101 error S2023: a step is missing: steps are `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
        $c///w: 3:100-101 error S2023: a step is missing: steps are `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
        $c/a/b[position()&lt;2]/w: 3:102-120 error S2023: no step of a path is written like this
          help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: steps are `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
    "#]].assert_eq(&all);
    // Another program may understand more.
    let all: String =
        ["count($c/a/b)", "$c/a/b[position()&gt;1]/w", "$c/x"].iter().map(|source| of(source, true)).collect();
    expect![[r#"
        count($c/a/b): 3:97-110 warning S2023: `count($c/a/b)` is no path from a property
          help: another program may understand it: it is taken as given
        $c/a/b[position()&gt;1]/w: 3:102-120 warning S2023: no step of a path is written like this
          help: another program may understand it: it is taken as given
        $c/x: 3:100-101 error S2023: there is no part `x`; the parts are `a`
    "#]]
    .assert_eq(&all);
}

/// Values that are written beside each other are several, as those in `value` are.
#[test]
fn one_of_several_elements_is_asked_for_by_its_place() {
    let place = |x: u8| format!("<p:place xmlns=\"\"><x>{x}</x><y>4</y></p:place>");
    let beside = place(1) + &place(2);
    let listed = format!("<value>{}</value><value>{}</value>", place(1), place(2));
    for values in [beside, listed] {
        let all = format!(
            "<property name=\"places\" element=\"p:place\" many=\"true\" xmlns:p=\"urn:x\">{values}</property>{}",
            robot(
                "<property name=\"charger\" source=\"$places[2]\"/><property name=\"number\" source=\"$places[1]/x\"/><property name=\"speed\" source=\"$places[2]/x\"/>"
            )
        );
        expect![[r#"
            R (example.Robot001) ID=Text("R") number=Text("1") speed=Text("2") charger=Complex([("x", Text("2")), ("y", Text("4"))]) gps->
        "#]]
        .assert_eq(&outcome(&[&fleet(&all)], &[]));
    }
}

/// A composite of another program may have an XPath that is more than a path.
#[test]
fn a_source_that_is_no_path_says_what_paths_are() {
    let text = part(
        "fleet",
        "",
        "<property name=\"s\">1</property><component name=\"R\"><implementation.java class=\"x.Y\"/><property name=\"a\" source=\"concat($s, 'x')\"/></component>",
    );
    for assumes in [false, true] {
        let (_, found, sources) = nested(&[&text], &[], assumes);
        let all: String = found.iter().map(|one| shown(one, &sources)).collect();
        match assumes {
            false => expect![[r#"
                2:80-83 error S3001: there is no class `x.Y`
                  help: looked among the 21 classes of this program and its plugins, which `saoms components` lists; `--plugin PATH` adds those of a plugin
                2:113-128 error S2023: `concat($s, 'x')` is no path from a property
                  help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: steps are `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
            "#]].assert_eq(&all),
            true => expect![[r#"
                2:113-128 warning S2023: `concat($s, 'x')` is no path from a property
                  help: another program may understand it: it is taken as given
            "#]].assert_eq(&all),
        }
    }
}
