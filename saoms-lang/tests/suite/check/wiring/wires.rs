//! Targets and wires.

use expect_test::expect;

use crate::check::support::{faults, faults_of, fleet, fleet_1_0, outcome, part};

/// A robot, a GPS and a pair of twins, and these.
fn with(inside: &str) -> String {
    format!(
        r#"{inside}
<component name="R"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period">1</property></component>
<component name="G"><implementation.java class="example.Gps"/><service name="position"><binding.sca name="b"/></service></component>
<component name="T"><implementation.java class="example.Twins"/></component>
<component name="O"><implementation.java class="example.OldGps"/></component>"#
    )
}

fn navigator(reference: &str) -> String {
    with(&format!(r#"<component name="N"><implementation.java class="example.Navigator"/>{reference}</component>"#))
}

#[test]
fn targets_lead_to_services() {
    for target in ["R", "R/move", "R/move/move", "T/left"] {
        let text = navigator(&format!(r#"<reference name="wheels" target="{target}"/>"#));
        assert_eq!(faults(&text), "", "{target}");
    }
    let all: String = [
        "Q", "r", "R/mve", "R/TaskInterface", "R/move/b", "T", "G", "G/position", "/move", "R//b", "R/move/b/c",
        "R T/left", "R R/move",
    ]
    .map(|target| {
        let text = navigator(&format!("\n<reference name=\"wheels\" target=\"{target}\"/>"));
        format!("{target}\n{}", faults(&text))
    })
    .concat();
    expect![[r#"
        Q
        3:34-35 error S2011: there is no component `Q`
          help: the components are `R`, `G`, `T` and `O`
        r
        3:34-35 error S2011: there is no component `r`
          fix: replace `r` with `R` [3:34-35 "R"]
        R/mve
        3:36-39 error S2012: component `R` has no service `mve`
          fix: replace `mve` with `move` [3:36-39 "move"]
        R/TaskInterface
        3:36-49 error S2015: service `TaskInterface` of component `R` has the interface `unibg.robotics.tca.TaskInterface`, and the reference needs `example.Wheels`
          fix: replace `TaskInterface` with `move` [3:36-49 "move"]
        R/move/b
        3:41-42 error S2013: service `move` of component `R` has no binding `b`
          help: its bindings are `move`
        T
        3:34-35 error S2014: component `T` has several services with the interface `example.Wheels`
          help: name one of `left` and `right`: `T/...`
        G
        3:34-35 error S2015: component `G` offers no service with the interface `example.Wheels`
          help: it offers `position` (example.Positions)
        G/position
        3:36-44 error S2015: service `position` of component `G` has the interface `example.Positions`, and the reference needs `example.Wheels`
          help: it offers `position` (example.Positions)
        /move
        3:34-39 error S2010: `/move` has the wrong form
          help: write `component`, `component/service` or `component/service/binding`, with no blank around the `/`
        R//b
        3:34-38 error S2010: `R//b` has the wrong form
          fix: replace `R//b` with `R/b` [3:34-38 "R/b"]
        R/move/b/c
        3:34-44 error S2010: `R/move/b/c` has the wrong form
          help: write `component`, `component/service` or `component/service/binding`
        R T/left
        3:36-42 error S2017: reference `wheels` of component `N` allows one target, found 2
          3:34-35 the first
          help: keep one of them
        R R/move
        3:36-42 error S2017: reference `wheels` of component `N` allows one target, found 2
          3:34-35 the first
          help: they lead to one service: keep one of them
    "#]].assert_eq(&all);
}

#[test]
fn bindings_of_targets() {
    let other = |target: &str| {
        with(&format!(
            r#"<component name="H"><implementation.java class="example.Gps"/>
<reference name="other" target="{target}"/></component>"#
        ))
    };
    assert_eq!(faults(&other("G/position/b")), "");
    expect![[r#"
        3:44-45 error S2013: service `position` of component `G` has no binding `c`
          help: its bindings are `b`
    "#]]
    .assert_eq(&faults(&other("G/position/c")));
    expect![[r#"
        3:35-43 error S2015: service `position` of component `O` has the interface `example.Positions`, and the reference needs `example.Positions`
          help: it offers the interface with other operations: its operation is `position() -> float64`, expected `position() -> int32`; build both components from one version
    "#]].assert_eq(&faults(&other("O/position")));
    expect![[r#"
        3:33-34 error S2015: component `O` offers no service with the interface `example.Positions`
          help: it offers the interface with other operations: its operation is `position() -> float64`, expected `position() -> int32`; build both components from one version
    "#]]
    .assert_eq(&faults(&other("O")));
    let by_binding = with(
        r#"<component name="N"><implementation.java class="example.Navigator"/>
<reference name="wheels"><binding.sca uri="R/mve"/></reference></component>
<component name="M"><implementation.java class="example.Navigator"/>
<reference name="wheels"><binding.ws uri="http://x"/></reference></component>"#,
    );
    expect![[r#"
        3:46-49 error S2012: component `R` has no service `mve`
          fix: replace `mve` with `move` [3:46-49 "move"]
        5:27-37 warning S2009: `binding.ws` is not supported: calls through it fail
          help: remove it; to reach other machines, use `binding.rest`, or topics and the `url` of a message broker
    "#]]
    .assert_eq(&faults(&by_binding));
}

#[test]
fn wires_of_composites() {
    let wire = |wires: &str| faults(&format!("{wires}\n{}", navigator("")));
    for wires in [
        r#"<wire source="N/wheels" target="R"/>"#,
        r#"<wire source="N/wheels" target="R/move" replace="true"/>"#,
        r#"<wire source="G" target="G2"/><wire source="N/wheels" target="T/right"/><component name="G2"><implementation.java class="example.Gps"/></component>"#,
    ] {
        assert_eq!(wire(wires), "", "{wires}");
    }
    expect![[r#"
        3:33-39 error S2017: reference `wheels` of component `N` allows one target, found 2
          2:33-39 the first
          help: keep one of them
        4:15-16 error S2016: component `N` has several references
          help: name one of `wheels` and `task`: `N/...`
        5:17-22 error S2016: component `N` has no reference `whels`
          fix: replace `whels` with `wheels` [5:17-22 "wheels"]
        6:15-16 error S2011: there is no component `M`
          help: the components are `N`, `R`, `G`, `T` and `O`
        7:15-16 error S2016: component `T` has no references
          help: a wire goes from a reference to a service
        8:15-25 error S2010: `N/wheels/x` has the wrong form
          help: write `component` or `component/name`
        9:32-33 error S2015: component `R` offers no service with the interface `example.Positions`
          help: it offers `move` (example.Wheels), `TaskInterface` (unibg.robotics.tca.TaskInterface)
    "#]]
    .assert_eq(&wire(
        r#"<wire source="N/wheels" target="T/left"/>
<wire source="N/wheels" target="R/move"/>
<wire source="N" target="R"/>
<wire source="N/whels" target="R"/>
<wire source="M/wheels" target="R"/>
<wire source="T" target="R"/>
<wire source="N/wheels/x" target="R"/>
<wire source="G/other" target="R"/>"#,
    ));
}

#[test]
fn a_reference_without_a_target() {
    let text = r#"<component name="N"><implementation.java class="example.Navigator"/></component>
<component name="M"><implementation.java class="example.Navigator"/>
<reference name="wheels"/></component>
<component name="L"><implementation.java class="example.Navigator"/>
<reference name="wheels" wiredByImpl="true"/></component>"#;
    expect![[r#"
        2:18-19 error S2018: reference `wheels` of component `N` is not wired to a service
          help: give it a target with the interface `example.Wheels`: `<reference name="wheels" target="..."/>`
        4:18-24 error S2018: reference `wheels` of component `M` is not wired to a service
          help: give it a target with the interface `example.Wheels`: `<reference name="wheels" target="..."/>`
    "#]]
    .assert_eq(&faults_of(&[&fleet(text)], &[]));
    expect![[r#"
        2:18-19 warning S2018: reference `wheels` of component `N` is not wired to a service
          help: give it a target with the interface `example.Wheels`: `<reference name="wheels" target="..."/>`
          help: without a target, calls through it fail
        4:18-24 warning S2018: reference `wheels` of component `M` is not wired to a service
          help: give it a target with the interface `example.Wheels`: `<reference name="wheels" target="..."/>`
          help: without a target, calls through it fail
    "#]]
    .assert_eq(&faults_of(&[&fleet_1_0(text)], &[]));
}

#[test]
fn circles_of_calls() {
    expect![[r#"
        5:34-35 error S2020: components call each other in a cycle: `R` -> `N` -> `R`
          3:31-32 `R` calls `N` through `gps`
          help: a call waits for its answer, and a component that waits cannot answer: remove one of the wires, or use a topic
        6:95-96 error S2020: component `G` is wired to itself: it would call while it is busy
          help: wire the reference to another component, or remove the target
    "#]].assert_eq(&faults(
        r#"<component name="R"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period">1</property>
<reference name="gps" target="N"/></component>
<component name="N"><implementation.java class="example.Navigator"/>
<reference name="wheels" target="R"/><reference name="task" target="R"/></component>
<component name="G"><implementation.java class="example.Gps"/><reference name="other" target="G"/></component>"#,
    ));
    let ring = |count: usize| -> String {
        let component = |number: usize| {
            format!(
                "<component name=\"G{number}\"><implementation.java class=\"example.Gps\"/><reference name=\"other\" target=\"G{}\"/></component>\n",
                (number + 1) % count
            )
        };
        (0..count).map(component).collect()
    };
    expect![[r#"
        11:96-98 error S2020: components call each other in a cycle: `G0` -> `G1` -> `G2` -> `G3` -> `G4` -> `G5` -> `G6` -> `G7` -> 2 more -> `G0`
          2:96-98 `G0` calls `G1` through `other`
          3:96-98 `G1` calls `G2` through `other`
          4:96-98 `G2` calls `G3` through `other`
          5:96-98 `G3` calls `G4` through `other`
          6:96-98 `G4` calls `G5` through `other`
          7:96-98 `G5` calls `G6` through `other`
          8:96-98 `G6` calls `G7` through `other`
          9:96-98 `G7` calls `G8` through `other`
          help: a call waits for its answer, and a component that waits cannot answer: remove one of the wires, or use a topic
    "#]].assert_eq(&faults(&ring(10)));
}

#[test]
fn autowire_finds_the_only_fitting_service() {
    let text = |autowire: &str, more: &str| {
        fleet(&format!(
            r#"<component name="N"><implementation.java class="example.Navigator"/>
<reference name="wheels" autowire="{autowire}"/></component>
{more}"#
        ))
    };
    let robot = r#"<component name="R"><implementation.java class="example.Robot001"/><property name="ID">R</property><property name="period">1</property></component>"#;
    let twins = r#"<component name="T"><implementation.java class="example.Twins"/></component>"#;
    assert_eq!(faults_of(&[&text("true", robot)], &[]), "");
    expect![[r#"
        3:18-24 error S2018: reference `wheels` of component `N` is not wired to a service
          help: give it a target with the interface `example.Wheels`: `<reference name="wheels" target="..."/>`
    "#]]
    .assert_eq(&faults_of(
        &[&text("false", robot).replace("targetNamespace", "autowire=\"true\" targetNamespace")],
        &[],
    ));
    expect![[r#"
        3:18-24 error S2019: autowire finds several services for reference `wheels` of component `N`
          help: name one as its `target`: `R/move`, `T/left` and `T/right`
    "#]]
    .assert_eq(&faults_of(&[&text("true", &format!("{robot}{twins}"))], &[]));
    expect![[r#"
        3:18-24 error S2018: reference `wheels` of component `N` is not wired to a service
          help: give it a target with the interface `example.Wheels`: `<reference name="wheels" target="..."/>`
          help: autowire finds no service with this interface
    "#]]
    .assert_eq(&faults_of(&[&text("true", "")], &[]));
}

#[test]
fn one_service_is_a_target_once_where_one_is_taken() {
    let wired = |of: &dyn Fn(&str) -> String, target: &str, wire: &str| {
        let inside = format!(
            r#"<component name="T"><implementation.java class="example.Robot"/><property name="ID">T</property><property name="period">1s</property><property name="number">1</property></component>
<component name="N"><implementation.java class="example.Navigator"/><reference name="wheels" target="{target}"/></component>
{wire}"#
        );
        faults_of(&[&of(&inside)], &[])
    };
    let again = r#"<wire source="N/wheels" target="T/move"/>"#;
    expect![[r#"
        3:109-115 error S2017: reference `wheels` of component `N` allows one target, found 2
          3:102-108 the first
          help: they lead to one service: keep one of them
    "#]]
    .assert_eq(&wired(&fleet, "T/move T/move", ""));
    expect![[r#"
        4:33-39 error S2017: reference `wheels` of component `N` allows one target, found 2
          3:102-108 the first
          help: they lead to one service: keep one of them
    "#]]
    .assert_eq(&wired(&fleet, "T/move", again));
    expect![[r#"
        4:33-39 warning S2017: reference `wheels` of component `N` allows one target, found 2
          3:102-108 the first
          help: they lead to one service: keep one of them
    "#]]
    .assert_eq(&wired(&fleet_1_0, "T/move", again));
    assert_eq!(wired(&fleet, "T/move", &again.replace("/>", " replace=\"true\"/>")), "");
}

#[test]
fn both_ends_of_a_wire_can_be_wrong() {
    expect![[r#"
        3:15-16 error S2011: there is no component `H`
          help: the components are `G`
        3:30-31 error S2011: there is no component `I`
          help: the components are `G`
        3:57-65 error S2010: `G/other/` has the wrong form
          fix: replace `G/other/` with `G/other` [3:57-65 "G/other"]
        3:77-82 error S2012: component `G` has no service `posit`
          help: its services are `position`
    "#]]
    .assert_eq(&faults(
        r#"<component name="G"><implementation.java class="example.Gps"/></component>
<wire source="H/gps" target="I/position"/><wire source="G/other/" target="G/posit"/>"#,
    ));
}

#[test]
fn autowire_that_finds_nothing_is_told_once() {
    let robots = "<component name=\"A\"><implementation.java class=\"example.Robot\"/><property name=\"ID\">A</property><property name=\"period\">1</property><property name=\"number\">1</property>\n<reference name=\"gps\"/></component>";
    let robots = format!(
        "{robots}\n{}",
        robots.replace("\"A\"", "\"B\"").replace(">A<", ">B<").replace(">1</property>\n", ">2</property>\n")
    );
    let of_composite = |more: &str| outcome(&[&part("fleet", "autowire=\"true\"", &format!("{robots}\n{more}"))], &[]);
    expect![[r#"
        1:132-136 warning S2018: autowire finds no service with the interface `example.Positions` for reference `gps` of component `A`
          help: the services beside it are those of `B` (example.Wheels), `B` (unibg.robotics.tca.TaskInterface)
          help: remove `autowire`, or add a component with that service
        A (example.Robot) ID=Text("A") number=Integer(1) gps->
        B (example.Robot) ID=Text("B") number=Integer(2) gps->
    "#]].assert_eq(&of_composite(""));
    expect![[r#"
        A (example.Robot) ID=Text("A") number=Integer(1) gps->G/position
        B (example.Robot) ID=Text("B") number=Integer(2) gps->G/position
        G (example.Gps) other->
    "#]]
    .assert_eq(&of_composite("<component name=\"G\"><implementation.java class=\"example.Gps\"/></component>"));
    let own = robots.replacen("name=\"gps\"", "name=\"gps\" autowire=\"true\"", 1);
    expect![[r#"
        3:33-37 warning S2018: autowire finds no service with the interface `example.Positions` for reference `gps` of component `A`
          help: the services beside it are those of `B` (example.Wheels), `B` (unibg.robotics.tca.TaskInterface)
          help: remove `autowire`, or add a component with that service
        A (example.Robot) ID=Text("A") number=Integer(1) gps->
        B (example.Robot) ID=Text("B") number=Integer(2) gps->
    "#]].assert_eq(&outcome(&[&part("fleet", "", &own)], &[]));
}
