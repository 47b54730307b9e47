//! Declarations of a composite about the loops of a component.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use saoms_api::Failure;
use saoms_api::host::{DynLoop, PropertyValue, SmolStr};
use saoms_lang::project::Project;
use saoms_lang::registry::LoopProvider;

use crate::check::classes::registry;
use crate::check::support::{faults_of, fleet, fleet_1_0, run};

const CART: &str = "<implementation.rust class=\"example.Cart\"/><property name=\"ID\">Cart</property><property name=\"period\">100</property>";

/// A composite with one cart, its loops from line 3.
fn cart(loops: &str) -> String {
    let text = fleet(&format!("<component name=\"Cart\">{CART}\n{}\n</component>", loops.trim()));
    text.replacen(" name=", " xmlns:saoms=\"urn:saoms:1\" name=", 1)
}

fn faults(loops: &str) -> String {
    faults_of(&[&cart(loops)], &[])
}

/// The loops of the component in a right composite, a line each.
fn loops(text: &str) -> String {
    let (assembly, diagnostics, sources) = run(&[text], &[]);
    let said: String = diagnostics.iter().map(|one| crate::check::support::shown(one, &sources)).collect();
    let assembly = assembly.unwrap_or_else(|| panic!("{said}"));
    let mut out = said;
    for one in assembly.components[0].loops.iter() {
        let _ = write!(out, "{} {}", one.name, one.class.name());
        one.values.iter().for_each(|(name, value)| _ = write!(out, " {name}={value:?}"));
        out.push('\n');
    }
    out
}

#[test]
fn a_component_has_the_loops_of_its_class() {
    let safe = "BatteryMS example.BatteryMS\nCollisionMS example.CollisionMS\nPathMS example.PathMS\n";
    assert_eq!(loops(&cart("")), safe);
    assert_eq!(loops(&cart("<property name=\"policy\">classic</property>")), "PathMS example.PathMS\n");
    let preset = cart("").replace("example.Cart\"", "example.ClassicCart\"");
    assert_eq!(loops(&preset), "PathMS example.PathMS\n");
}

#[test]
fn a_composite_adds_replaces_removes_moves_and_parametrises_loops() {
    let all = cart(
        "<saoms:loop name=\"Saver\" class=\"example.BatterySaver\" before=\"BatteryMS\"><property name=\"threshold\" value=\"50\"/></saoms:loop>
        <saoms:loop name=\"CollisionMS\" class=\"example.Courteous\" after=\"PathMS\"/>
        <saoms:loop name=\"BatteryMS\" remove=\"false\" after=\"CollisionMS\"/>",
    );
    assert_eq!(
        loops(&all),
        "PathMS example.PathMS\nCollisionMS example.Courteous\nSaver example.BatterySaver threshold=Float(50.0)\nBatteryMS example.BatteryMS\n"
    );
    let fewer = cart(
        "<saoms:loop name=\"BatteryMS\" remove=\"true\"/>
        <saoms:loop name=\"CollisionMS\"><property name=\"patience\">7</property></saoms:loop>
        <saoms:loop name=\"Saver\" class=\"example.BatterySaver\"><property name=\"threshold\" value=\"1\"/></saoms:loop>",
    );
    assert_eq!(
        loops(&fewer),
        "CollisionMS example.CollisionMS patience=Integer(7)\nPathMS example.PathMS\nSaver example.BatterySaver threshold=Float(1.0)\n"
    );
}

#[test]
fn a_loop_of_which_nothing_changes_is_told() {
    assert_eq!(
        faults("<saoms:loop name=\"BatteryMS\"/>\n<saoms:loop name=\"PathMS\" remove=\"false\"/>"),
        "3:2-12 warning S4510: this element has no effect: the component's class has the loop `BatteryMS` already
  help: remove it, or write what to change: `class`, `before`, `after`, `remove` or properties
4:2-12 warning S4510: this element has no effect: the component's class has the loop `PathMS` already
  help: remove it, or write what to change: `class`, `before`, `after`, `remove` or properties
"
    );
}

#[test]
fn the_name_of_a_loop_in_remove_is_told_once() {
    assert_eq!(
        faults("<saoms:loop remove=\"PathMS\"/>"),
        "3:21-27 error S1011: `remove` is `PathMS`, expected `true` or `false`
  fix: replace it with `name=\"PathMS\" remove=\"true\"` [3:13-28 \"name=\\\"PathMS\\\" remove=\\\"true\\\"\"]
"
    );
}

#[test]
fn values_of_loops_come_from_properties_of_the_composite() {
    let text = cart("<saoms:loop name=\"CollisionMS\"><property name=\"patience\" source=\"$patience\"/></saoms:loop>")
        .replacen("<component", "<property name=\"patience\">9</property><component", 1);
    assert!(loops(&text).contains("patience=Integer(9)\n"));
}

#[test]
fn names_of_loops_and_their_classes_are_known() {
    assert_eq!(
        faults(
            "<saoms:loop name=\"ColisionMS\"/>\n<saoms:loop name=\"Saver\" class=\"example.BatterySafer\" before=\"PathSM\"/>"
        ),
        "3:19-29 error S4501: component `Cart` has no loop `ColisionMS`
  help: to add a loop, name its class: `class=\"...\"`
  fix: replace `ColisionMS` with `CollisionMS` [3:19-29 \"CollisionMS\"]
4:33-53 error S3001: there is no loop class `example.BatterySafer`
  help: `saoms components` lists the 12 loops of this program and its plugins; `--plugin PATH` adds the loops of a \
  plugin
  fix: replace `example.BatterySafer` with `example.BatterySaver` [4:33-53 \"example.BatterySaver\"]
4:63-69 error S4501: component `Cart` has no loop `PathSM`
  fix: replace `PathSM` with `PathMS` [4:63-69 \"PathMS\"]
"
    );
    assert!(faults("<saoms:loop name=\"example.PathMS\"/>").contains("fix: replace `example.PathMS` with `PathMS`"));
    assert!(faults("<saoms:loop name=\"x\" class=\"example.Cart\"/>").contains("help: it is a component class"));
}

#[test]
fn what_is_said_of_a_loop_makes_sense() {
    assert_eq!(
        faults(
            "<saoms:loop name=\"PathMS\" remove=\"true\" class=\"example.Racer\"/>
<saoms:loop name=\"BatteryMS\"/><saoms:loop name=\"BatteryMS\"/>
<saoms:loop name=\"CollisionMS\" before=\"BatteryMS\" after=\"BatteryMS\"/>"
        ),
        "3:48-61 error S4503: the loop `PathMS` is removed, but has `class`
  3:35-39 removed here
  help: remove this, or keep the loop: a removed loop has no class, place or properties
4:49-58 error S4502: the loop `BatteryMS` is given twice
  4:19-28 first given here
  help: write everything about a loop in one element; two loops of the same class need different names
5:58-67 error S4503: the loop `CollisionMS` has both `before` and `after`
  5:40-49 the `before`
  help: keep either `before` or `after`
"
    );
}

#[test]
fn orders_lead_somewhere() {
    assert_eq!(
        faults("<saoms:loop name=\"PathMS\" after=\"BatteryMS\"/>\n<saoms:loop name=\"BatteryMS\" before=\"PathMS\"/>"),
        "4:38-44 error S4504: the order of the loops `PathMS` and `BatteryMS` is circular
  3:34-43 `PathMS` is placed beside `BatteryMS`
  help: place one of them before or after a loop that is not moved
"
    );
    assert_eq!(
        faults("<saoms:loop name=\"PathMS\" after=\"PathMS\"/>"),
        "3:34-40 error S4504: the loop `PathMS` is placed beside itself
  help: place one of them before or after a loop that is not moved
"
    );
    assert_eq!(
        faults("<saoms:loop name=\"PathMS\" after=\"BatteryMS\"/>\n<saoms:loop name=\"BatteryMS\" remove=\"true\"/>"),
        "3:34-43 error S4504: the loop `PathMS` is placed beside `BatteryMS`, which is removed
  4:19-28 removed here
  help: place it before or after another loop, or keep the removed loop
"
    );
}

#[test]
fn two_loops_cannot_change_one_effector() {
    assert_eq!(
        faults("<saoms:loop name=\"Racer\" class=\"example.Racer\" before=\"PathMS\"/>"),
        "3:33-46 error S4507: the loops `PathMS` and `Racer` both effect `next`
  help: `PathMS` is a loop of class `example.Cart`
  help: only one loop may change the effector `next`: replace `PathMS` with `name=\"PathMS\"`, or remove \
  it with `<saoms:loop name=\"PathMS\" remove=\"true\"/>`
"
    );
    assert_eq!(
        faults(
            "<saoms:loop name=\"PathMS\" class=\"example.Racer\"/>\n<saoms:loop name=\"Other\" class=\"example.Racer\" before=\"PathMS\"/>"
        ),
        "4:33-46 error S4507: the loops `PathMS` and `Other` both effect `next`
  3:34-47 effects `next` as well
  help: only one loop may change the effector `next`: replace `PathMS` with `name=\"PathMS\"`, or remove \
  it with `<saoms:loop name=\"PathMS\" remove=\"true\"/>`
"
    );
    assert_eq!(faults("<saoms:loop name=\"PathMS\" class=\"example.Racer\"/>"), "", "replaced");
}

#[test]
fn what_no_loop_serves_after_a_replacement_is_told() {
    let saver = |name: &str| {
        format!(
            "<saoms:loop name=\"{name}\" class=\"example.BatterySaver\"><property name=\"threshold\">1</property></saoms:loop>"
        )
    };
    assert_eq!(
        faults(&saver("CollisionMS")),
        "3:39-59 warning S4511: no loop effects `stopped` any more: `example.BatterySaver` replaces \
        `example.CollisionMS`, which does
  help: the entry stays as it is; let `example.BatterySaver` serve it and declare `effects(...)`, or add a loop that does
"
    );
    let racer = "<saoms:loop name=\"CollisionMS\" remove=\"true\"/>
<saoms:loop name=\"BatteryMS\" class=\"example.Courteous\"/>";
    let battery = "4:37-54 warning S4511: no loop effects `battery` any more: `example.Courteous` replaces \
        `example.BatteryMS`, which does
  help: the entry stays as it is; let `example.Courteous` serve it and declare `effects(...)`, or add a loop that does
";
    assert_eq!(faults(racer), battery, "nobody changes `busy`, which `BatteryMS` senses");
    assert_eq!(
        faults(&format!("{racer}{}", saver("Saver"))),
        format!(
            "{battery}4:37-54 warning S4511: no loop senses `busy` any more: `example.Courteous` replaces \
            `example.BatteryMS`, which does
  help: the entry has no effect; let `example.Courteous` serve it and declare `senses(...)`, or add a loop that does
"
        )
    );
    let other = "<saoms:loop name=\"Gives\" class=\"example.Courteous\"/>";
    assert_eq!(faults(&format!("{}{other}", saver("CollisionMS"))), "", "another loop serves it");
}

#[test]
fn loops_fit_the_component() {
    assert_eq!(
        faults(
            "<saoms:loop name=\"Boating\" class=\"example.Boating\"/>\n<saoms:loop name=\"Dreamer\" \
            class=\"example.Dreamer\"/>"
        ),
        "3:35-50 error S4505: the loop `Boating` works on the knowledge `example.Boat`, but component `Cart` has \
        `example.Cart`
  help: it is made for components of another class
4:35-50 error S4506: the loop `Dreamer` senses `batery`, but component `Cart` has no such entry
  help: the nearest entry is `battery`: is the loop made for another component?
4:35-50 error S4506: the loop `Dreamer` effects `mood`, but component `Cart` has no such entry
  help: the entries are `battery`, `busy`, `next` and `stopped`
"
    );
    assert_eq!(
        faults(
            "<saoms:loop name=\"Twin\" class=\"example.Twin\"/>\n<saoms:loop name=\"Radio\" class=\"example.Radio\"/>"
        ),
        "3:32-44 error S4508: the loop `Twin` adds the entry `busy`, which is there already
  help: class `example.Cart` declares it
4:33-46 error S4509: the loop `Radio` has the reference `wheels` with another interface
  help: class `example.Cart` declares the reference
"
    );
    let two =
        "<saoms:loop name=\"A\" class=\"example.BatterySaver\"><property name=\"threshold\">1</property></saoms:loop>";
    assert_eq!(
        faults(&format!("{two}\n{}", two.replace("\"A\"", "\"B\""))),
        "4:29-49 error S4508: the loop `B` adds the entry `saved`, which is there already
  3:29-49 `A` adds it as well
  help: keep one of them
"
    );
    let gps = fleet(
        "<component name=\"Gps\"><implementation.rust class=\"example.Gps\"/>\n<l:loop xmlns:l=\"urn:saoms:1\" name=\"x\" class=\"example.Racer\"/></component>",
    );
    assert_eq!(
        faults_of(&[&gps], &[]),
        "3:2-8 error S4505: class `example.Gps` has no loops
  help: loops work on the knowledge of a component, but this component declares none
"
    );
}

#[test]
fn properties_of_loops_are_checked_as_those_of_components() {
    assert_eq!(
        faults(
            "<saoms:loop name=\"CollisionMS\"><property name=\"patience\">0</property><property name=\"patiance\">1</property></saoms:loop>
<saoms:loop name=\"Saver\" class=\"example.BatterySaver\"/>"
        ),
        "3:58-59 error S3008: property `patience`: `0` is out of range: expected a whole number from 1 to 100 [executions]
  help: `patience`: How long to wait for others; the default is `3`
3:86-94 error S3004: loop `example.CollisionMS` has no property `patiance`
  help: `patience` is given already: remove one of the two
4:19-24 error S3006: loop `Saver` needs the property `threshold`
  help: add `<property name=\"threshold\">...</property>`: a number from 0.0 to 100.0 [%]
"
    );
    assert_eq!(
        faults("<saoms:loop name=\"CollisionMS\">\n<property name=\"patience\">60</property></saoms:loop>"),
        "4:27-29 error S3014: loop `CollisionMS`: property `patience`: 60 is too long for so short a reach
  help: `saoms components example.CollisionMS` describes its properties
"
    );
}

#[test]
fn topics_and_references_of_loops_are_those_of_the_component() {
    let renamed = "<property name=\"topicRename\">GIVEWAY,way</property>";
    assert_eq!(faults(renamed), "");
    assert!(faults(&format!("{renamed}<saoms:loop name=\"CollisionMS\" remove=\"true\"/>")).contains("S4003"));
    assert!(faults("<property name=\"useJMS\">false</property>").contains("S4004"));
    let talker = "<saoms:loop name=\"Talker\" class=\"example.Talker\"/>";
    let said = faults(talker);
    assert!(said.contains("S4009: component `Cart` subscribes to topic `GIVEWAY` as a state topic"), "{said}");
    assert!(said.contains("S2018"), "its reference is to be wired: {said}");
}

#[test]
fn a_loop_is_in_the_namespace_of_saoms() {
    let bare =
        fleet_1_0(&format!("<component name=\"Cart\">{CART}\n<loop name=\"PathMS\" remove=\"true\"/></component>"));
    assert_eq!(
        faults_of(&[&bare], &[]),
        "3:2-6 error S1004: `loop` is an element of SAOMS: it has to be in the namespace `urn:saoms:1`
  help: write `<saoms:loop .../>`, and `xmlns:saoms=\"urn:saoms:1\"` in the composite's start tag
  fix: replace `loop` with `saoms:loop` [1:11-11 \" xmlns:saoms=\\\"urn:saoms:1\\\"\"] [3:2-6 \"saoms:loop\"]
"
    );
    assert_eq!(
        faults("<loop name=\"PathMS\"></loop>"),
        "3:2-6 error S1004: `loop` is an element of SAOMS: it has to be in the namespace `urn:saoms:1`
  help: write `<saoms:loop .../>`, and `xmlns:saoms=\"urn:saoms:1\"` in the composite's start tag
  fix: replace `loop` with `saoms:loop` [3:2-6 \"saoms:loop\"] [3:23-27 \"saoms:loop\"]
"
    );
    assert_eq!(
        faults(
            "<saoms:loop name=\"CollisionMS\" befor=\"PathMS\"><saoms:property name=\"patience\" value=\"1\"/></saoms:loop>"
        ),
        "3:32-37 error S1007: `saoms:loop` has no attribute `befor`
  fix: replace `befor` with `before` [3:32-37 \"before\"]
3:48-62 error S1005: `saoms:property` is in the namespace of SAOMS
  help: write the properties of a loop as elements of SCA, as in a component
  fix: replace `saoms:property` with `property` [3:48-62 \"property\"]
"
    );
    assert!(faults("<other:loop xmlns:other=\"urn:other\"/>").is_empty(), "that of others is theirs");
}

/// A loop from another library, which is never run here.
#[derive(Debug)]
struct Foreign;

impl LoopProvider for Foreign {
    fn construct(&self, _: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
        Err("it is not built into this test".into())
    }

    fn origin(&self) -> Option<&Path> {
        Some(Path::new("/plugins/libcarts.so"))
    }
}

#[test]
fn a_loop_that_needs_the_struct_of_a_knowledge_does_not_work_in_components_of_another_library() {
    let found = |direct: &str| {
        let mut registry = registry();
        let declaration = format!(
            r#"{{"contract":1,"loop":"carts.Steers","knowledge":"example.Cart"{direct},"properties":[],"senses":[],"effects":["next"],"entries":[],"publishes":[],"subscribes":[],"references":[]}}"#
        );
        registry.add_loop_provided(&declaration, Arc::new(Foreign)).unwrap();
        let text = cart("<saoms:loop name=\"PathMS\" class=\"carts.Steers\"/>");
        let compiled = Project::new().text("t.composite", text).compile(&registry);
        compiled
            .reported()
            .map(|one| format!("{} {} {}\n", one.code.id, one.message, one.help.join("; ")))
            .collect::<String>()
    };
    assert_eq!(
        found(r#","direct":true"#),
        "S4505 the loop `PathMS` of the library `libcarts.so` needs the Rust struct of its knowledge, but that of component `Cart` is built into the program a loop for components of other libraries has `type Knowledge = dyn \
         Knowledge`, and reaches entries by name\n"
    );
    assert!(!found("").contains("S4505"), "entry by entry it works");
}
