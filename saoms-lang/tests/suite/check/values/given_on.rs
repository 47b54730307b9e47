//! Values that composites pass to those inside of them, as expressions and components there take them.

use std::ffi::OsString;

use expect_test::expect;
use saoms_lang::project::Project;

use crate::check::support::{compiled, outcome, part, told};
use crate::check::unfolding::fleets::fleet;

/// A composite whose expression and whose robot take the same property.
fn hall(property: &str) -> String {
    part(
        "hall",
        "xmlns:saoms=\"urn:saoms:1\" xmlns:x=\"urn:x\"",
        &format!(
            r#"{property}
<component name="G${{index}}" saoms:count="n"><implementation.java class="example.Gps"/></component>
<component name="R"><implementation.java class="example.Robot"/><property name="ID">R</property><property name="period">1</property><property name="number" source="$n"/></component>"#
        ),
    )
}

/// The result inside of a composite with these properties, where the component says this.
fn taken(property: &str, outside: &str, given: &str) -> String {
    let outer = part(
        "outer",
        "xmlns:x=\"urn:x\"",
        &format!("{outside}<component name=\"H\"><implementation.composite name=\"t:hall\"/>{given}</component>"),
    );
    outcome(&[&outer, &hall(property)], &[])
}

#[test]
fn expressions_take_what_is_in_an_element() {
    let one = r#"<property name="e" element="x:e"><x:e>2</x:e></property>"#;
    let two = r#"<property name="e" element="x:e" many="true"><x:e>1</x:e><x:e>2</x:e></property>"#;
    let ways = [
        ("", r#"<property name="n" element="x:n"><x:n>2</x:n></property>"#),
        (one, r#"<property name="n" source="$e"/>"#),
        (two, r#"<property name="n" source="$e[2]"/>"#),
    ];
    for (outside, given) in ways {
        expect![[r#"
            H/G1 (example.Gps) other->
            H/G2 (example.Gps) other->
            H/R (example.Robot) ID=Text("R") number=Integer(2) gps->
        "#]]
        .assert_eq(&taken("<property name=\"n\"/>", outside, given));
    }
    expect![[r#"
        H/G1 (example.Gps) other->
        H/G2 (example.Gps) other->
        H/R (example.Robot) ID=Text("R") number=Integer(2) gps->
    "#]]
    .assert_eq(&taken("<property name=\"n\" element=\"x:n\"><x:n>2</x:n></property>", "", ""));
}

/// A component that names a property with nothing in it gives nothing.
#[test]
fn a_property_that_has_to_be_given_a_value_is_not_given_one_by_a_source_without() {
    let must = "<property name=\"n\" mustSupply=\"true\"/>";
    expect![[r#"
        2:115-123 error S2025: component `H` must give a value to the property `n` of its composite: its source has no value
          hall:2:17-18 declared here, without a value
          2:17-24 declared here, without a value
          help: write it in the file, or give `--set nothing=...`
    "#]]
    .assert_eq(&taken(must, "<property name=\"nothing\"/>", "<property name=\"n\" source=\"$nothing\"/>"));
    expect![[r#"
        2:78-79 error S2025: component `H` must give a value to the property `n` of its composite
          hall:2:17-18 declared here, without a value
          help: write the value inside
    "#]]
    .assert_eq(&taken(must, "", "<property name=\"n\"/>"));
    // Also where no component takes it.
    let unused = part(
        "hall",
        "",
        "<property name=\"n\" mustSupply=\"true\"/><component name=\"G\"><implementation.java class=\"example.Gps\"/></component>",
    );
    let outer =
        fleet("<component name=\"H\"><implementation.composite name=\"t:hall\"/><property name=\"n\"/></component>");
    expect![[r#"
        2:78-79 error S2025: component `H` must give a value to the property `n` of its composite
          hall:2:17-18 declared here, without a value
          help: write the value inside
        hall:2:17-18 warning S2026: no component uses the property `n` of the composite
          help: remove it, or use its value in a component with `source="$n"`
    "#]]
    .assert_eq(&outcome(&[&outer, &unused], &[]));
}

/// The environment comes behind what a component says, for expressions and components alike.
#[test]
fn a_variable_counts_where_a_component_gives_nothing() {
    let hall = hall("<property name=\"n\" saoms:env=\"N\">4</property>");
    let of = |given: &str, value: &str| {
        let outer = fleet(&format!(
            "<property name=\"nothing\"/><component name=\"H\"><implementation.composite name=\"t:hall\"/>{given}</component>"
        ));
        let value = OsString::from(value);
        let project = Project::new().in_memory().environment(move |_| Some(value.clone()));
        let project = project.text("outer", outer.as_str()).other_text("hall", hall.as_str());
        let (assembly, diagnostics, sources) = compiled(&project);
        let components = assembly.into_iter().flat_map(|assembly| assembly.components);
        told(&diagnostics, &sources)
            + &components.map(|one| format!("{} {:?}\n", one.path, one.values)).collect::<String>()
    };
    expect![[r#"
        H/G1 []
        H/G2 []
        H/R [("ID", Text("R")), ("number", Integer(2))]
    "#]]
    .assert_eq(&of("<property name=\"n\" source=\"$nothing\"/>", "2"));
    expect![[r#"
        2:17-24 warning S2026: no component uses the property `nothing` of the composite
          help: remove it, or use its value in a component with `source="$nothing"`
        H/G1 []
        H/G2 []
        H/G3 []
        H/R [("ID", Text("R")), ("number", Integer(3))]
    "#]]
    .assert_eq(&of("<property name=\"n\">3</property>", "2"));
    expect![[r#"
        2:17-24 warning S2026: no component uses the property `nothing` of the composite
          help: remove it, or use its value in a component with `source="$nothing"`
        hall:3:42-43 error S2045: found the text `x`, expected a whole number
          environment:1:3-4 the value of `n`
          help: `docs/fleets.md` describes expressions
        environment:1:3-4 error S3007: property `number`: `x` is not a whole number: expected a whole number from 1 to 99
          hall:4:165-167 used here as `number`
          help: `number`: The number of the robot
    "#]].assert_eq(&of("<property name=\"n\"/>", "x"));
}

/// The value of each composite is found once, and what is in it: this would take for ever otherwise.
#[test]
fn long_values_are_given_on_through_many_composites() {
    const MANY: usize = 8_000;
    let docks: String =
        (1..=MANY).map(|place| format!("<dock id=\"d{place}\"><column>{place}</column></dock>")).collect();
    let outer = part(
        "outer",
        "xmlns:saoms=\"urn:saoms:1\"",
        &format!(
            r#"<property name="docks"><docks xmlns="">{docks}</docks></property>
<component name="W${{index}}" saoms:count="{MANY}"><implementation.composite name="t:wing"/><property name="docks" source="$docks"/><property name="nr">${{index}}</property></component>"#
        ),
    );
    let wing = part(
        "wing",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="docks"/><property name="nr"/>
<component name="H${index}" saoms:count="1"><implementation.composite name="t:hall"/><property name="column" source="$docks[1]/dock[@id='d${nr}']/column"/></component>"#,
    );
    let hall = part(
        "hall",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="column"/><component name="G" saoms:if="column == 1234"><implementation.java class="example.Gps"/></component>"#,
    );
    expect![[r#"
        W1234/H1/G (example.Gps) other->
    "#]]
    .assert_eq(&outcome(&[&outer, &wing, &hall], &[]));
}

/// A value that a component gives has to be right although nothing inside takes it.
#[test]
fn what_nobody_takes_is_held_to_its_type() {
    const SCHEMA: &str = "xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\"";
    let inner = part(
        "inner",
        SCHEMA,
        r#"<property name="p" type="xsd:int"/><component name="G"><implementation.java class="example.Gps"/></component>"#,
    );
    let given = |value: &str| {
        let outer = format!(
            r#"<property name="n" type="xsd:string">1</property><component name="K"><implementation.composite name="t:inner"/>{value}</component>"#
        );
        outcome(&[&part("outer", SCHEMA, &outer), &inner], &[])
    };
    expect![[r#"
        2:17-18 warning S2026: no component uses the property `n` of the composite
          help: remove it, or use its value in a component with `source="$n"`
        2:131-134 error S2042: the property `p` has the type `xsd:int`: found `abc`, expected a whole number of 32 bits
          inner:2:26-33 the type
          help: change the value, or the type
        inner:2:17-18 warning S2026: no component uses the property `p` of the composite
          help: remove it, or use its value in a component with `source="$p"`
    "#]]
    .assert_eq(&given(r#"<property name="p">abc</property>"#));
    expect![[r#"
        2:140-141 error S2024: the composite has no property `m`
          help: its properties are `n`
        inner:2:17-18 warning S2026: no component uses the property `p` of the composite
          help: remove it, or use its value in a component with `source="$p"`
    "#]]
    .assert_eq(&given(r#"<property name="p" source="$m"/>"#));
    expect![[r#"
        inner:2:17-18 warning S2026: no component uses the property `p` of the composite
          help: remove it, or use its value in a component with `source="$p"`
        K/G (example.Gps) other->
    "#]]
    .assert_eq(&given(r#"<property name="p" source="$n"/>"#));
}
