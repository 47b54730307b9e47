//! Slips of the pen in what targets, wires and promotions name.

use expect_test::expect;

use crate::check::mistakes::slips::{GPS, of, robot};
use crate::check::support::{nested, outcome, part, shown};

#[test]
fn a_target_of_nothing_is_told() {
    let inside = robot("R", "<property name=\"number\">1</property>\n<reference name=\"gps\" target=\" \"/>");
    expect![[r#"
        4:23-33 warning S1011: `target` names nothing
          help: name a component, or remove `target`
        R (example.Robot) ID=Text("R") number=Integer(1) gps->
    "#]]
    .assert_eq(&of(&inside));
    let needed = "<component name=\"N\"><implementation.java class=\"example.Navigator\"/>\n<reference name=\"wheels\" target=\"\"/></component>";
    expect![[r#"
        3:18-24 error S2018: reference `wheels` of component `N` is not wired to a service
          help: give it a target with the interface `example.Wheels`: `<reference name="wheels" target="..."/>`
    "#]]
    .assert_eq(&of(needed));
}

#[test]
fn targets_are_written_as_sca_writes_them() {
    let conductor = |target: &str| {
        let found = of(&format!(
            "{GPS}\n<component name=\"H\"><implementation.java class=\"example.Gps\"/></component>\n<component name=\"C\"><implementation.java class=\"example.Conductor\"/><reference name=\"gps\" target=\"{target}\"/></component>"
        ));
        found
            .lines()
            .filter(|line| !line.starts_with(|c: char| c.is_ascii_uppercase()))
            .fold(String::new(), |all, line| all + line + "\n")
    };
    expect![[r#"
        4:99-102 error S2011: there is no component `G,H`
          help: separate several names with blanks
          fix: replace `G,H` with `G H` [4:99-102 "G H"]
    "#]]
    .assert_eq(&conductor("G,H"));
    expect![[r#"
        4:99-101 error S2011: there is no component `G,`
          help: separate several names with blanks
          fix: replace `G,` with `G` [4:99-101 "G"]
    "#]]
    .assert_eq(&conductor("G, H"));
    expect![[r#"
        4:99-101 error S2011: there is no component `G;`
          help: separate several names with blanks
          fix: replace `G;` with `G` [4:99-101 "G"]
        4:102-103 error S2011: there is no component `X`
          help: the components are `G` and `H`
    "#]]
    .assert_eq(&conductor("G; X"));
    expect![[r#"
        4:99-109 error S2011: there is no component `G#position`
          help: write the name of a service after `/`
          fix: replace `G#position` with `G/position` [4:99-109 "G/position"]
    "#]]
    .assert_eq(&conductor("G#position"));
    expect![[r#"
        4:99-109 error S2011: there is no component `G.position`
          help: write the name of a service after `/`
          fix: replace `G.position` with `G/position` [4:99-109 "G/position"]
        4:110-121 error S2011: there is no component `H::position`
          help: write the name of a service after `/`
          fix: replace `H::position` with `H/position` [4:110-121 "H/position"]
    "#]]
    .assert_eq(&conductor("G.position H::position"));
    expect![[r#"
        4:99-101 error S2010: `/G` has the wrong form
          fix: replace `/G` with `G` [4:99-101 "G"]
        4:102-104 error S2010: `H/` has the wrong form
          fix: replace `H/` with `H` [4:102-104 "H"]
    "#]]
    .assert_eq(&conductor("/G H/"));
    expect![[r#"
        4:99-102 error S2011: there is no component `a.b`
          help: the components are `G` and `H`
    "#]]
    .assert_eq(&conductor("a.b"));
}

#[test]
fn a_wire_the_wrong_way_round_is_told_once() {
    let robot = robot("R", "<property name=\"number\">1</property>");
    let twins = "<component name=\"C\"><implementation.java class=\"example.Twins\"/></component>";
    expect![[r#"
        5:15-16 error S2016: this wire is reversed: `C` offers a service, and `R/gps` is a reference
          fix: swap `source` and `target` [5:15-16 "R/gps"] [5:26-31 "C"]
        5:15-16 error S2015: component `C` offers no service with the interface `example.Positions`
          help: it offers `left` (example.Wheels), `right` (example.Wheels)
    "#]]
    .assert_eq(&of(&format!("{twins}\n{robot}\n<wire source=\"C\" target=\"R/gps\"/>")));
    expect![[r#"
        5:15-25 error S2016: this wire is reversed: `G/position` offers a service, and `R/gps` is a reference
          fix: swap `source` and `target` [5:15-25 "R/gps"] [5:35-40 "G/position"]
    "#]]
    .assert_eq(&of(&format!("{GPS}\n{robot}\n<wire source=\"G/position\" target=\"R/gps\"/>")));
}

#[test]
fn a_reference_of_a_composite_is_promoted_by_it() {
    let inner = part("inner", "", &robot("R", "<property name=\"number\">1</property>"));
    let outer = part(
        "outer",
        "",
        &format!(
            "{GPS}\n<component name=\"I\"><implementation.composite name=\"t:inner\"/><reference name=\"gps\" target=\"G\"/></component>"
        ),
    );
    expect![[r#"
        3:80-83 error S2006: composite `inner` has no reference `gps`
          inner:1:115-120 the composite
          help: a composite has only the references that it promotes: write `<reference name="gps" promote="COMPONENT/reference"/>` in it
    "#]].assert_eq(&outcome(&[&outer, &inner], &[]));
}

/// A composite that is not found may wire anything.
#[test]
fn beside_an_include_that_leads_nowhere_no_reference_lacks_a_target() {
    let navigator = "<component name=\"N\"><implementation.java class=\"example.Navigator\"/></component>";
    let fleet = part("fleet", "", &format!("<include name=\"t:C\"/>\n{navigator}"));
    let wires = part("c", "", &format!("<wire source=\"N/wheels\" target=\"R\"/>{}", robot("R", "")));
    expect![[r#"
        2:16-19 error S2030: there is no composite `C` in the namespace `urn:t`
          help: name the file of that composite in the command as well
          fix: replace `t:C` with `t:c` [2:16-19 "t:c"]
    "#]]
    .assert_eq(&outcome(&[&fleet, &wires], &[]));
    let (_, given, sources) = nested(&[&fleet.replace("example.Nav", "other.Nav"), &wires], &[], true);
    let given: String = given.iter().map(|one| shown(one, &sources)).collect();
    assert!(!given.contains("S2018"), "{given}");
}

/// A composite that promotes a receiver, and a fleet of one component of it and a receiver of its own.
fn with_unit(inside: &str) -> String {
    let unit = part("unit", "", &format!("<service name=\"where\" promote=\"G/position\"/>{GPS}"));
    let fleet = part(
        "fleet",
        "",
        &format!("<component name=\"U\"><implementation.composite name=\"t:unit\"/></component>\n{inside}"),
    );
    outcome(&[&fleet, &unit], &[])
        .lines()
        .filter(|line| !line.ends_with("->"))
        .fold(String::new(), |all, line| all + line + "\n")
}

#[test]
fn what_is_inside_is_named_by_what_is_promoted() {
    let target = |target: &str| {
        with_unit(&robot(
            "R",
            &format!("<property name=\"number\">1</property>\n<reference name=\"gps\" target=\"{target}\"/>"),
        ))
    };
    let said = ["U/G/position", "U.G/position", "U.G", "U/N"].map(target).concat();
    expect![[r#"
        5:33-34 error S2012: component `U` has no service `G`
          help: `G` is inside `U`: use what the composite of `U` promotes
          fix: replace `U/G/position` with `U/where` [5:31-43 "U/where"]
        5:31-34 error S2011: there is no component `U.G`
          help: `G` is inside `U`: use what the composite of `U` promotes
          fix: replace `U.G/position` with `U/where` [5:31-43 "U/where"]
        5:31-34 error S2011: there is no component `U.G`
          help: `G` is inside `U`: use what the composite of `U` promotes
          fix: replace `U.G` with `U/where` [5:31-34 "U/where"]
        5:33-34 error S2012: component `U` has no service `N`
          help: its services are `where`
          fix: replace `N` with `where` [5:33-34 "where"]
    "#]]
    .assert_eq(&said);
    let own = robot("R", "<property name=\"number\">1</property>\n<reference name=\"gps\" autowire=\"true\"/>");
    expect![[r#"
        6:18-21 error S2019: autowire finds several services for reference `gps` of component `R`
          help: name one as its `target`: `U/where` and `G/position`
    "#]]
    .assert_eq(&with_unit(&format!("{GPS}\n{own}")));
    expect![[r#"
        3:15-27 error S2010: `U/G/position` has the wrong form
          help: `G` is inside `U`: use what the composite of `U` promotes; it promotes no reference of `G`
    "#]]
    .assert_eq(&with_unit("<wire source=\"U/G/position\" target=\"U\"/>"));
}

/// The diagnostics of navigators that each take the wheels of one robot, beside two robots that are replicas.
fn navigators(attributes: &str, inside: &str) -> String {
    let robots = "<component name=\"R${index}\" saoms:count=\"2\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">R${index}</property><property name=\"number\">1</property><property name=\"period\">1</property></component>";
    of(&format!(
        "{robots}\n<component name=\"{attributes}><implementation.java class=\"example.Navigator\"/>\n{inside}"
    ))
}

#[test]
fn one_of_replicas_is_taken_where_all_are_named() {
    let by_target = "<reference name=\"wheels\" target=\"R*/move\"/></component>";
    expect![[r#"
        4:34-41 error S2017: reference `wheels` of component `N` allows one target, found 2
          help: `R*` names all replicas, but the reference takes one target
          fix: replace `R*/move` with `R1/move` [4:34-41 "R1/move"]
          fix: replace `R*/move` with `R2/move` [4:34-41 "R2/move"]
    "#]]
    .assert_eq(&navigators("N\"", by_target));
    expect![[r#"
        4:34-41 error S2017: reference `wheels` of component `N1` allows one target, found 2 (index 1, and in 1 more)
          help: `R*` names all replicas, but the reference takes one target
          fix: replace `R*/move` with `R${index}/move` [4:34-41 "R${index}/move"]
    "#]]
    .assert_eq(&navigators("N${index}\" saoms:count=\"2\"", by_target));
    expect![[r#"
        4:34-41 error S2017: reference `wheels` of component `N2` allows one target, found 2 (index 2, and in 1 more)
          help: `R*` names all replicas, but the reference takes one target
          fix: replace `R*/move` with `R${index}/move` [4:34-41 "R${index}/move"]
    "#]]
    .assert_eq(&navigators("N${index}\" saoms:from=\"2\" saoms:count=\"2\"", by_target));
    let by_wire = "</component>\n<wire source=\"N/wheels\" target=\"R*\"/>";
    expect![[r#"
        5:33-35 error S2017: reference `wheels` of component `N` allows one target, found 2
          help: `R*` names all replicas, but the reference takes one target
          fix: replace `R*` with `R1` [5:33-35 "R1"]
          fix: replace `R*` with `R2` [5:33-35 "R2"]
    "#]]
    .assert_eq(&navigators("N\"", by_wire));
}

#[test]
fn a_wire_can_count_in_place_of_a_target() {
    let wired = |target: &str, wires: &str| {
        navigators("N\"", &format!("<reference name=\"wheels\" target=\"{target}\"/></component>\n{wires}"))
    };
    let other = "<wire source=\"N/wheels\" target=\"R2\"/>";
    expect![[r#"
        5:33-35 error S2017: reference `wheels` of component `N` allows one target, found 2
          4:34-36 the first
          help: keep one of them, or write `replace="true"` at the wire, which then replaces the `target`
    "#]]
    .assert_eq(&wired("R1", other));
    expect![[r#"
        5:33-35 error S2017: reference `wheels` of component `N` allows one target, found 2
          4:34-36 the first
          help: they lead to one service: keep one of them
    "#]]
    .assert_eq(&wired("R2", other));
    // It counts in place of the `target` alone.
    let replacing = other.replace("/>", " replace=\"true\"/>");
    expect![[r#"
        5:85-87 error S2017: reference `wheels` of component `N` allows one target, found 2
          5:33-35 the first
          help: keep one of them
    "#]]
    .assert_eq(&wired("R1", &format!("{replacing}<wire source=\"N/wheels\" target=\"R1\"/>")));
    let twice = format!("{other}<wire source=\"N/wheels\" target=\"R1\"/>");
    expect![[r#"
        5:33-35 error S2017: reference `wheels` of component `N` allows one target, found 3
          4:34-36 the first
          help: keep one of them
    "#]]
    .assert_eq(&wired("R1", &twice));
}

#[test]
fn of_names_that_are_equally_near_none_is_meant_rather_than_another() {
    let robots = |count: usize, inside: &str| {
        let robot = |name: &str| robot(name, "<property name=\"number\">1</property>");
        let robots: String = (1..=count).map(|number| robot(&format!("R{number}"))).collect();
        of(&format!("{robots}\n{inside}"))
    };
    let navigator = "<component name=\"N\"><implementation.java class=\"example.Navigator\"/><reference name=\"wheels\" target=\"R9\"/></component>";
    expect![[r#"
        5:102-104 error S2011: there is no component `R9`
          fix: replace `R9` with `R1` [5:102-104 "R1"]
          fix: replace `R9` with `R2` [5:102-104 "R2"]
    "#]]
    .assert_eq(&robots(2, navigator));
    expect![[r#"
        7:102-104 error S2011: there is no component `R9`
          help: the components are `R1`, `R2`, `R3` and `R4`
    "#]]
    .assert_eq(&robots(4, navigator));
}
