//! Names, files, services and references, promotions.

use expect_test::expect;

use crate::check::support::{faults, faults_of, fleet, fleet_1_0};

const GPS: &str = r#"<component name="G"><implementation.java class="example.Gps"/></component>"#;

#[test]
fn names_are_unique_across_files() {
    expect![[r#"
        3:18-19 error S2002: there are two components `G`
          2:18-19 the first
          fix: remove the second: both are the same, word for word [3:1-75 ""]
        4:18-19 error S2002: there are two components `G`
          2:18-19 the first
          fix: remove the second: both are the same, word for word [4:1-75 ""]
    "#]]
    .assert_eq(&faults(&format!("{GPS}\n{GPS}\n{GPS}")));
    let one = fleet_1_0(GPS);
    let other = one.replace("name=\"fleet\"", "name=\"other\"");
    expect![[r#"
        more.composite:2:18-19 error S2002: there are two components `G`
          2:18-19 the first
          help: files given together form one fleet: for two fleets, run the command once for each file
          fix: remove the second: both are the same, word for word [more.composite:2:1-75 ""]
    "#]]
    .assert_eq(&faults_of(&[&one, &other], &[]));
    expect![[r#"
        more.composite:1:84-89 error S2001: there are two composites `fleet` in one namespace
          1:84-89 the first
          help: give each its own name; was one file given twice?
    "#]]
    .assert_eq(&faults_of(&[&one, &fleet_1_0("")], &[]));
}

#[test]
fn interfaces_are_named_as_java_or_as_rust() {
    let navigator = |interface: &str| {
        faults(&format!(
            r#"<component name="N"><implementation.rust class="example.Navigator"/><service name="position">{interface}</service>
<reference name="wheels" target="T/left"/></component><component name="T"><implementation.rust class="example.Twins"/></component>"#
        ))
    };
    assert_eq!(navigator(r#"<interface.java interface="example.Positions"/>"#), "");
    assert_eq!(navigator(r#"<interface.rust interface="example.Positions"/>"#), "");
    assert_eq!(navigator(r#"<interface.rust xmlns="urn:saoms:1" interface="example.Positions"/>"#), "");
    expect![[r#"
        2:121-137 error S2007: the interface of `position` is `example.Positions`, not `example.Position`
          fix: replace `example.Position` with `example.Positions` [2:121-137 "example.Positions"]
    "#]]
    .assert_eq(&navigator(r#"<interface.rust interface="example.Position"/>"#));
}

#[test]
fn services_and_references_are_those_of_the_class() {
    expect![[r#"
        3:16-19 error S2005: class `example.Robot001` has no service `mov`
          fix: replace `mov` with `move` [3:16-19 "move"]
        4:49-62 error S2007: the interface of `move` is `example.Wheels`, not `example.Wheel`
          fix: replace `example.Wheel` with `example.Wheels` [4:49-62 "example.Wheels"]
        5:16-20 error S2004: component `R` has two services `move`
          4:16-20 the first
          help: keep one of them
        6:94-104 warning S2009: `binding.ws` is not supported: the service can be called only inside this program
          help: remove it; to reach other machines, use `binding.rest`, or topics and the `url` of a message broker
        7:18-21 error S2006: class `example.Robot001` has no reference `GPS`
          fix: replace `GPS` with `gps` [7:18-21 "gps"]
        8:37-41 error S2008: the multiplicity `0..n` of `gps` is wider than `0..1` in class `example.Robot001`
          help: it can be `0..1` or `1..1`
        8:44-58 error S2007: the interface of `gps` is `example.Positions`, which this element cannot name
          help: write `<interface.java interface="example.Positions"/>`, or leave it out
        11:51-55 error S2008: the multiplicity `0..1` of `wheels` is wider than `1..1` in class `example.Navigator`
          help: leave `multiplicity` out: `1..1` is the default
        13:16-29 error S2005: class `example.Navigator` has no service `TaskInterface`
          help: its services are `position`
    "#]].assert_eq(&faults(
        r#"<component name="R"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period">1</property>
<service name="mov"/>
<service name="move"><interface.java interface="example.Wheel"/></service>
<service name="move"/>
<service name="TaskInterface"><interface.java interface="unibg.robotics.tca.TaskInterface"/><binding.ws uri="http://x"/></service>
<reference name="GPS"/>
<reference name="gps" multiplicity="0..n"><interface.wsdl interface="http://x#wsdl.interface(Y)"/><binding.sca/></reference>
</component>
<component name="N"><implementation.java class="example.Navigator"/>
<reference name="wheels" target="R" multiplicity="0..1"/>
<reference name="task" multiplicity="1..1" target="R"/>
<service name="TaskInterface"/></component>"#,
    ));
}

#[test]
fn promotions_have_to_exist() {
    expect![[r#"
        3:30-37 error S2021: component `G` has no service `positon`
          fix: replace `positon` with `position` [3:30-37 "position"]
        4:28-29 error S2011: there is no component `H`
          help: the components are `G`, `N` and `T`
        5:28-40 error S2010: `G/position/x` has the wrong form
          help: write `component` or `component/name`
        6:16-17 error S2003: the composite has two services `a`
          2:16-17 the first
          help: give each its own name
        6:28-29 error S2021: component `T` has several services: name the one to promote
          help: write `T/` and one of `left` and `right`
        7:18-19 warning S2022: reference `r` of the composite is not wired to a service: calls through it fail
          help: wire the component's reference inside the composite: a composite that runs by itself has nothing around it
        7:38-46 error S2007: reference `r` of the composite promotes references with the interfaces `example.Positions` and `example.Wheels`
          7:30-37 the first
          help: promote each with its own reference: no service has both interfaces
        7:49-54 error S2021: component `N` has no reference `whels`
          fix: replace `whels` with `wheels` [7:49-54 "wheels"]
        8:30-31 error S2021: component `T` has no references to promote
    "#]]
    .assert_eq(&faults(&format!(
        r#"<service name="a" promote="G"/>
<service name="b" promote="G/positon"/>
<service name="c" promote="H/position"/>
<service name="d" promote="G/position/x"/>
<service name="a" promote="T"/>
<reference name="r" promote="G/other N/wheels N/whels"/>
<reference name="s" promote="T"/>
{GPS}
<component name="N"><implementation.java class="example.Navigator"/></component>
<component name="T"><implementation.java class="example.Twins"/></component>"#
    )));
    expect![[r#"
        2:30-31 error S2011: there is no component `X`
        2:51-52 error S2003: the composite has two references `a`
          2:18-19 the first
          help: give each its own name
        2:63-64 error S2011: there is no component `X`
    "#]]
    .assert_eq(&faults_of(&[&fleet(r#"<reference name="a" promote="X"/><reference name="a" promote="X"/>"#)], &[]));
}

#[test]
fn attributes_of_the_other_version_are_told() {
    let inside = r#"<component name="R" constrainingType="x"><implementation.java class="example.Robot"/><property name="ID" value="R"/>
<property name="period" value="100"/><property name="number">1</property><service name="TaskInterface"><interface.java interface="unibg.robotics.tca.TaskInterface" remotable="false"/></service></component>
<wire source="N/other" target="R" replace="true"/>"#;
    expect![[r#"
        2:106-111 warning S1014: `value` of `property` is an attribute of SCA 1.1, but this file is of SCA 1.0
          help: SAOMS reads it, other programs may not: change the file to SCA 1.1
          help: or write the value as text inside
        3:165-174 warning S1014: `remotable` of `interface.java` is an attribute of SCA 1.1, but this file is of SCA 1.0
          help: SAOMS reads it, other programs may not: change the file to SCA 1.1
        4:15-16 error S2011: there is no component `N`
          help: the components are `R`
        4:35-42 warning S1014: `replace` of `wire` is an attribute of SCA 1.1, but this file is of SCA 1.0
          help: SAOMS reads it, other programs may not: change the file to SCA 1.1
    "#]]
    .assert_eq(&faults_of(&[&fleet_1_0(inside)], &[]));
    expect![[r#"
        2:21-37 error S1007: `component` has no attribute `constrainingType`
          help: remove it: only SCA 1.0 has this attribute
        4:15-16 error S2011: there is no component `N`
          help: the components are `R`
    "#]]
    .assert_eq(&faults_of(&[&fleet(inside)], &[]));
}
