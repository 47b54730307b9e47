//! Composites that are there several times, or are given what they need from outside.

use std::fs;

use expect_test::expect;
use saoms_lang::project::Project;

use crate::check::support::{compiled_in, outcome, part};
use crate::check::unfolding::fleets::fleet;

/// Writes files into a folder, checks the first of them, and gives what is wrong without that folder's name.
fn found(files: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let project = Project::new().file(folder.path().join(files[0].0));
    let (assembly, found) = compiled_in(folder.path(), &project);
    let numbers = assembly.into_iter().flat_map(|assembly| assembly.components).map(|one| {
        let number = one.values.iter().find(|(name, _)| name == "number").map(|(_, value)| value.clone());
        format!("{} {number:?}\n", one.path)
    });
    found + &numbers.collect::<String>()
}

/// A value that a component gives the composite that it implements counts for expressions as for sources, however it is
/// given.
#[test]
fn expressions_inside_of_composites_take_what_sources_lead_to() {
    let hall = part(
        "hall",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="count">7</property><property name="open">false</property>
<component name="G${index}" saoms:count="count" saoms:if="open"><implementation.java class="example.Gps"/></component>"#,
    );
    let outer = |given: &str| {
        fleet(&format!(
            r#"<property name="halls"><hall id="a" xmlns=""><count>1</count><open>true</open></hall><hall id="b" xmlns=""><count>2</count><open>true</open></hall></property>
<component name="Hall"><implementation.composite name="t:hall"/>{given}</component>"#
        ))
    };
    let both = |count: &str, open: &str| {
        let given = format!(r#"<property name="count" source="{count}"/><property name="open" source="{open}"/>"#);
        outcome(&[&outer(&given), &hall], &[])
    };
    expect![[r#"
        Hall/G1 (example.Gps) other->
        Hall/G2 (example.Gps) other->
    "#]]
    .assert_eq(&both("$halls/hall[@id='b']/count", "$halls/hall[1]/open"));
    expect![[r#"
        3:96-114 error S2023: `count($halls/hall)` is not the path of a property
          help: a `source` is `$name`, `$name[2]`, or a path from there, `$name/step/step`: write a step as `name` or `*`, `name[2]`, `name[last()]`, `name[part='value']` or `name[@attribute='value']`, and at the end `@attribute` or `text()`
    "#]]
    .assert_eq(&both("count($halls/hall)", "$halls/hall[count=2]/open"));
    expect![[r#"
        3:103-116 error S2023: no part here has the attribute `id` with the value `c`: its values are `a` and `b`
        3:156-160 error S2024: the composite has no property `hals`
          fix: replace `hals` with `halls` [3:156-160 "halls"]
    "#]]
    .assert_eq(&both("$halls/hall[@id='c']/count", "$hals"));
    expect![[r#"
        hall:3:42-47 error S2045: the property `count` has no simple value
          help: give the property one simple value, or use a part of the value, as with `source="$name/part"`
        hall:3:59-63 error S2045: the property `open` has no simple value (in `G1`, index 1)
          help: give the property one simple value, or use a part of the value, as with `source="$name/part"`
    "#]]
    .assert_eq(&both("$halls", "$halls/hall/open"));
    expect![[r#"
        2:17-22 warning S2026: no component uses the property `halls` of the composite
          help: remove it, or use its value in a component with `source="$halls"`
        hall:3:42-47 error S2045: the property `count` has no simple value
          help: give the property one simple value, or use a part of the value, as with `source="$name/part"`
    "#]]
    .assert_eq(&outcome(
        &[&outer(r#"<property name="count"><a xmlns="">1</a></property><property name="open">true</property>"#), &hall],
        &[],
    ));
    // Through a composite in between, and with the numbers of replicas.
    let wing = part(
        "wing",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="halls"/>
<component name="Hall${index}" saoms:count="2"><implementation.composite name="t:hall"/><property name="count" source="$halls/hall[${index}]/count"/><property name="open">true</property></component>"#,
    );
    let through = outer("").replace("t:hall\"/>", "t:wing\"/><property name=\"halls\" source=\"$halls\"/>");
    expect![[r#"
        Hall/Hall1/G1 (example.Gps) other->
        Hall/Hall2/G1 (example.Gps) other->
        Hall/Hall2/G2 (example.Gps) other->
    "#]]
    .assert_eq(&outcome(&[&through, &wing, &hall], &[]));
}

/// A composite that is there several times has one table: each of its lines may be about a replica in one of them.
#[test]
fn lines_of_tables_are_about_a_replica_in_any_of_the_places_of_a_composite() {
    let hall = part(
        "hall",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="first">1</property>
<component name="R${index}" saoms:count="2" saoms:from="first" saoms:overrides="table.csv"><implementation.java class="example.Robot"/>
<property name="ID">R${index}</property><property name="period">1</property><property name="number">${index}</property></component>"#,
    );
    let halls = fleet(
        r#"<component name="A"><implementation.composite name="t:hall"/></component>
<component name="B"><implementation.composite name="t:hall"/><property name="first">11</property></component>"#,
    );
    let with = |table: &str| found(&[("a.composite", &halls), ("hall.composite", &hall), ("table.csv", table)]);
    expect![[r#"
        table.csv:4:1-2 warning S2047: there is no replica `7`
          help: use an index from 1 to 2
        table.csv:5:1-2 error S2047: there is no replica `x`
          help: use an index from 1 to 2
    "#]]
    .assert_eq(&with("index,number\n1,5\n12,6\n7,7\nx,8\n"));
    expect![[r#"
        A/R1 Some(Integer(5))
        A/R2 Some(Integer(2))
        B/R11 Some(Integer(11))
        B/R12 Some(Integer(6))
    "#]]
    .assert_eq(&with("name,number\nR1,5\nR12,6\n"));
}

/// A line about a replica that the condition leaves out has no effect, as one about a replica that does not exist.
#[test]
fn lines_of_tables_about_replicas_that_a_condition_leaves_out_are_told() {
    let hall = part(
        "hall",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<property name="gap">2</property>
<component name="R${index}" saoms:count="3" saoms:if="index != gap" saoms:overrides="table.csv"><implementation.java class="example.Robot"/>
<property name="ID">R${index}</property><property name="period">1</property><property name="number">${index}</property></component>"#,
    );
    let halls = |second: &str| {
        fleet(&format!(
            r#"<component name="A" saoms:site="A"><implementation.composite name="t:hall"/></component>
<component name="B" saoms:site="B"><implementation.composite name="t:hall"/><property name="gap">{second}</property></component>"#
        ))
    };
    let with = |second: &str, table: &str| {
        let halls = halls(second);
        found(&[("a.composite", &halls), ("hall.composite", &hall), ("table.csv", table)])
    };
    expect![[r#"
        table.csv:3:1-2 warning S2047: the condition leaves out the replica `2`
          hall.composite:3:55-67 false for it
          help: change the condition, or remove the row
        A/R1 Some(Integer(5))
        A/R3 Some(Integer(3))
        B/R1 Some(Integer(5))
        B/R3 Some(Integer(3))
    "#]]
    .assert_eq(&with("2", "index,number\n1,5\n2,6\n"));
    expect![[r#"
        table.csv:2:1-3 warning S2047: the condition leaves out the replica `R2`
          hall.composite:3:55-67 false for it
          help: change the condition, or remove the row
        table.csv:3:1-3 error S2047: two rows are for the replica `R2`
          table.csv:2:1-3 the first
          help: merge them
    "#]]
    .assert_eq(&with("2", "name,number\nR2,6\nR2,7\n"));
    // It is about a replica of the other one.
    expect![[r#"
        A/R1 Some(Integer(5))
        A/R3 Some(Integer(3))
        B/R1 Some(Integer(5))
        B/R2 Some(Integer(6))
    "#]]
    .assert_eq(&with("3", "index,number\n1,5\n2,6\n"));
}

/// A mistake outside of a composite is reported there, and not again for each replica inside that takes the value.
#[test]
fn what_replicas_have_from_outside_is_told_once() {
    let hall = part(
        "hall",
        "xmlns:saoms=\"urn:saoms:1\"",
        r#"<reference name="gps" promote="R*/gps" multiplicity="0..1"/>
<component name="R${index}" saoms:count="3"><implementation.java class="example.Robot"/>
<property name="ID">R${index}</property><property name="period">1</property><property name="number">${index}</property></component>"#,
    );
    let halls = fleet(
        r#"<component name="A"><implementation.composite name="t:hall"/><reference name="gps" target="Gsp"/></component>
<component name="Gps"><implementation.java class="example.Gps"/></component>"#,
    );
    expect![[r#"
        2:92-95 error S2011: there is no component `Gsp`
          fix: replace `Gsp` with `Gps` [2:92-95 "Gps"]
    "#]]
    .assert_eq(&outcome(&[&halls, &hall], &[]));
}

/// Settings are for the outermost composite: those of others have their values from the components that they implement.
#[test]
fn a_setting_of_a_property_inside_is_told_with_who_gives_it() {
    let hall = part(
        "hall",
        "",
        r#"<property name="count">7</property>
<component name="R"><implementation.java class="example.Robot"/><property name="ID">R</property><property name="period">1</property><property name="number" source="$count"/></component>"#,
    );
    let outer = fleet(r#"<component name="Hall"><implementation.composite name="t:hall"/></component>"#);
    expect![[r#"
        --set:1:1-6 error S2029: the outermost composite has no property `count`
          help: the inner composite `hall` has this property, and component `Hall` gives it a value: take the value from a property of the outermost composite there, `<property name="count" source="$..."/>`, and set that property
    "#]].assert_eq(&outcome(&[&outer, &hall], &["count=3"]));
}
