//! Paths of a `source` into the value of a property.

use expect_test::expect;

use crate::check::support::{faults, fleet, nested, outcome, part, shown};
use crate::check::values::properties::robot;

/// The part of XPath that users need, and the diagnostics of the rest.
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
        $b/bays/bay[1]/x: Integer(3
        $b/bay[1]/x: Integer(3
        $b/p:bay[ 2 ]/p:x: Integer(5
        $b/child::bay[last()]/x/text(): Integer(8
        $b/bay[@id='b/c']/*: Integer(5
        $b/*[1]/*[2]: S3007: the property `number` has elements inside: expected a whole number from 1 to 99
        $b/bay[3]/text(): Integer(7
        $b/*[local-name()='bay'][2]/x: Integer(5
        $many[2]: Integer(2
        $many[last()]: Integer(2
        $b/bay[2]/y: S2023: there is no part `y`; the parts are `x`
        $b/bay[4]: S2023: there are 3 parts `bay`, counted from `[1]`: the last one is `bay[3]`
        $b/bay[0]/x: S2023: there are 3 parts `bay`, counted from `[1]`: the last one is `bay[3]`
        $b/bay/x: S3011: the property `number` allows one value, found 3
        $b/bay[@id='c']/x: S2023: no part here has the attribute `id` with the value `c`: its values are `a` and `b/c`
        $b/bay[@name='c']/x: S2023: no part here has the attribute `name` with the value `c`: no part has this attribute
        $b/bay/@di: S2023: there is no attribute `di`; the attributes are `id`
        $b/bay[2]/@id/x: S2023: an attribute has no parts
        $b/bay[1]/text(): S2023: there is no text here
        $b/bay[x=3]/x: Integer(3
        $b//x: S3011: the property `number` allows one value, found 3
        $b/bay/../x: S2023: this is not a step of a path
        $b/bay[1]x: S2023: this is not a step of a path
        $many[3]: S2023: the property has 2 values
        $many[a]: S2023: this is not a step of a path
        $many/x: S2023: the property has a simple value: there are no parts in it
        $many/value[2]: S2023: the property has a simple value: there are no parts in it; to get the second value of a property, write `$name[2]`
        $many/text(): S3011: the property `number` allows one value, found 2
        $many[2]/text(): Integer(2
        $b/bay/x[2]: S2023: there are 3 parts `x` in 3 elements, at most 1 per element, and `[...]` counts within each element
        ($b/bay/x)[2]: S2023: `($b/bay/x)[2]` is not the path of a property
        count($b/bay): S2023: `count($b/bay)` is not the path of a property
        concat($s, 'x'): S2023: `concat($s, 'x')` is not the path of a property
        $b/bay[x &gt; 3]/x: S2023: this is not a step of a path
        $b/bay[not(@id)]/x: S2023: this is not a step of a path
        $b/bay[1]/following-sibling::bay/x: S2023: this is not a step of a path
        ${s}: S2023: write the property's name without braces here
        $sa: S2024: the composite has no property `sa`
        s: S2023: `s` does not name a property of the composite
        'text': S2023: `'text'` does not name a property of the composite
        $s/x: S2023: the property has a simple value: there are no parts in it
        $b/: S2023: a step is missing: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
        $b[99999999999999999999999]: S2023: the property has one value
    "#]].assert_eq(&all);
    assert!(value("$b/bay[1]/@id", "colour").starts_with("S3009: property `colour`: `a` is not allowed"));
    assert!(value("$b/bays/@unit", "colour").starts_with("S3009: property `colour`: `m` is not allowed"));
    assert!(value("$b/@unit", "colour").starts_with("S3009: property `colour`: `m` is not allowed"));
}

#[test]
fn what_is_given_no_value_has_no_parts_either() {
    expect![""].assert_eq(&faults(&format!(
        r#"<property name="where" element="x:place" xmlns:x="urn:x"/>
{}"#,
        robot(r#"<property name="charger" source="$where/x"/><property name="grace" source="$where/y">5ms</property>"#)
    )));
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
        $c//b[w=11]/w: 3:101-108 error S2023: no part here contains a part `w` with the value `11`
        $c//v: 3:101-102 error S2023: there is no part `v`; the parts are `a`, `b` and `w`
        $c//: 3:100-101 error S2023: a step is missing: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
        $c///w: 3:100-101 error S2023: a step is missing: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
        $c/a/b[position()&lt;2]/w: 3:102-120 error S2023: this is not a step of a path
          help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
    "#]].assert_eq(&all);
    // Another program may understand more.
    let all: String =
        ["count($c/a/b)", "$c/a/b[position()&gt;1]/w", "$c/x"].iter().map(|source| of(source, true)).collect();
    expect![[r#"
        count($c/a/b): 3:97-110 warning S2023: `count($c/a/b)` is not the path of a property
          help: it is not checked: another program may understand it
        $c/a/b[position()&gt;1]/w: 3:102-120 warning S2023: this is not a step of a path
          help: it is not checked: another program may understand it
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
            R (example.Robot001) ID=Text("R") number=Integer(1) speed=Float(2.0) charger=Complex([("x", Integer(2)), ("y", Integer(4))]) gps->
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
                  help: `saoms components` lists the 25 classes of this program and its plugins; `--plugin PATH` adds the classes of a plugin
                2:113-128 error S2023: `concat($s, 'x')` is not the path of a property
                  help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
            "#]].assert_eq(&all),
            true => expect![[r#"
                2:113-128 warning S2023: `concat($s, 'x')` is not the path of a property
                  help: it is not checked: another program may understand it
            "#]].assert_eq(&all),
        }
    }
}

#[test]
fn each_of_many_groups_is_searched_for_its_parts() {
    let zone = |z: usize| format!("<zone id=\"z{z}\"><robot id=\"r{z}\"><speed>1.0{z:02}</speed></robot></zone>");
    let zones: String = (0..70).map(zone).collect();
    let taking = |z: usize| {
        let source = format!("$zones/zone[@id='z{z}']/robot[@id='r{z}']/speed");
        let one = robot(&format!("<property name=\"speed\" source=\"{source}\"/>"));
        one.replace("name=\"R\"", &format!("name=\"R{z}\"")).replace(">R<", &format!(">R{z}<"))
    };
    let robots: String = (0..70).map(taking).collect();
    let found = outcome(&[&fleet(&format!("<property name=\"zones\">{zones}</property>{robots}"))], &[]);
    for (z, line) in (0..).zip(found.lines()) {
        assert!(line.contains(&format!("speed=Float({:?})", 1.0 + f64::from(z) / 1000.0)), "{found}");
    }
    assert_eq!(found.lines().count(), 70, "{found}");
}

#[test]
fn a_path_has_a_limit_of_steps() {
    let path = |steps: usize| format!("$v{}", "/a[1]".repeat(steps));
    let deep = format!("<property name=\"v\">{}1{}</property>", "<a>".repeat(101), "</a>".repeat(101));
    let taking =
        |path: &str| faults(&(deep.clone() + &robot(&format!("<property name=\"speed\" source=\"{path}\"/>"))));
    assert!(!taking(&path(100)).contains("steps"));
    assert!(taking(&path(101)).contains("error S2023: a path has at most 100 steps"), "{}", taking(&path(101)));
}
