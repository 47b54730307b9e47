//! Nodes of a fleet, text in, text out.

use std::time::Duration;

use saoms_lang::assembly::Assembly;
use saoms_lang::project::Project;
use saoms_tools::expand::expanded;

use super::classes::{registry, with_surveyor};
use super::support::{compiled, part, run, told};

const OWN: &str = "xmlns:s=\"urn:saoms:1\"";
const DEFAULT: &str = "xmlns:s=\"urn:saoms:1\" s:defaultNode=\"control\"";

fn gps(name: &str, attributes: &str) -> String {
    format!("<component name=\"{name}\" {attributes}><implementation.java class=\"example.Gps\"/></component>\n")
}

fn picker(name: &str, attributes: &str, url: &str) -> String {
    let url = if url.is_empty() { String::new() } else { format!("<property name=\"url\">{url}</property>") };
    format!(
        "<component name=\"{name}\" {attributes}><implementation.java class=\"example.Picker\"/><property name=\"ID\">{name}\
         </property><property name=\"period\">1000</property>{url}</component>\n"
    )
}

fn dispatcher(attributes: &str, url: &str) -> String {
    picker("Dispatcher", attributes, url).replace("example.Picker", "example.Dispatcher")
}

fn inner(inside: &str) -> String {
    part("hall", OWN, inside)
}

fn hall(name: &str, attributes: &str) -> String {
    format!("<component name=\"{name}\" {attributes}><implementation.composite name=\"t:hall\"/></component>\n")
}

/// Each component with its node.
fn nodes(assembly: &Assembly) -> String {
    assembly.components.iter().map(|spec| format!("{}@{} ", spec.path, spec.node)).collect()
}

#[test]
fn a_node_holds_for_all_inside_unless_they_say_otherwise() {
    let inside = gps("Gps", "") + &gps("Own", "s:node=\"desk\"");
    let outer = gps("Clock", "") + &hall("North", "s:node=\"gate-a\"") + &hall("South", "");
    let project = Project::new().in_memory().text("fleet", part("fleet", DEFAULT, &outer));
    let whole = project.other_text("hall", inner(&inside)).compile(&registry());
    assert_eq!(whole.diagnostics.len(), 0);
    let text = expanded(&whole).unwrap();
    let assembly = whole.output.unwrap();
    assert_eq!(nodes(&assembly), "Clock@control North/Gps@gate-a North/Own@desk South/Gps@control South/Own@desk ");
    let counts: Vec<_> = assembly.nodes().into_iter().collect();
    assert_eq!(counts, [("control".into(), 2), ("desk".into(), 2), ("gate-a".into(), 1)]);
    // What `expand` writes has the same nodes.
    let (again, diagnostics, sources) = run(&[&text], &[]);
    assert_eq!(told(&diagnostics, &sources), "");
    assert_eq!(nodes(&again.unwrap()), nodes(&assembly));
}

#[test]
fn replicas_have_nodes_by_their_index() {
    let outer = "<property name=\"gate\">gate</property>\n".to_owned()
        + &gps("R${index}", "s:count=\"2\" s:node=\"${gate}-${index}\"")
        + &gps("Gps", "s:node=\"${gate}\"");
    let (assembly, diagnostics, sources) = run(&[&part("fleet", OWN, &outer)], &["gate=door"]);
    assert_eq!(told(&diagnostics, &sources), "");
    assert_eq!(nodes(&assembly.unwrap()), "R1@door-1 R2@door-2 Gps@door ");
}

#[test]
fn a_part_knows_the_components_of_other_nodes() {
    let wired = "<component name=\"Compass\" s:node=\"gate\"><implementation.java class=\"example.Gps\"/><reference name=\"other\" \
                 target=\"Gps\"/></component>";
    let outer = gps("Clock", "") + wired + &gps("Gps", "s:node=\"gate\"");
    let (assembly, diagnostics, sources) = run(&[&part("fleet", DEFAULT, &outer)], &[]);
    assert_eq!(told(&diagnostics, &sources), "");
    let gate = assembly.unwrap().at("gate");
    assert_eq!(nodes(&gate), "Compass@gate Gps@gate ");
    assert_eq!(gate.components[0].references[0].targets[0].component, 1);
    assert_eq!((gate.node.as_str(), gate.elsewhere[0].path.as_str()), ("gate", "Clock"));
    assert_eq!(gate.nodes().len(), 2);
}

/// A fleet that has a surveyor, as it is compiled, and what is told of it.
#[track_caller]
fn surveyed(inside: &str) -> (Option<Assembly>, String) {
    let project = Project::new().in_memory().text("fleet.composite", part("fleet", DEFAULT, inside));
    let whole = project.compile(&with_surveyor());
    let text = told(&whole.diagnostics, &whole.sources);
    (whole.output, text)
}

fn surveyor(url: &str, more: &str) -> String {
    let wired = format!("<reference name=\"gps\" target=\"Gps\"/>{more}</component>");
    let one = picker("Surveyor", "s:node=\"gate\"", url).replace("example.Picker", "example.Surveyor");
    one.replace("</component>", &wired)
}

#[test]
fn a_part_knows_the_services_of_other_nodes_that_it_calls() {
    let outer = surveyor("localhost:61616", "") + &gps("Gps", "");
    let (assembly, told) = surveyed(&outer);
    assert_eq!(told, "");
    for (node, [here, elsewhere]) in [("gate", ["Surveyor", "Gps"]), ("control", ["Gps", "Surveyor"])] {
        let part = assembly.clone().unwrap().at(node);
        assert_eq!((part.components[0].path.as_str(), part.elsewhere[0].path.as_str()), (here, elsewhere));
        let calls: Vec<_> = part.calls_over("localhost:61616").collect();
        let [(caller, end)] = calls[..] else { panic!("{calls:?}") };
        assert_eq!(
            (caller.path.as_str(), end.component.as_str(), end.service.as_str()),
            ("Surveyor", "Gps", "position")
        );
        assert_eq!((end.node.as_str(), caller.references[0].targets.len()), ("control", 0));
    }
    // In one program it is a wire as any other.
    assert_eq!(assembly.unwrap().calls_over("localhost:61616").count(), 0);
}

#[test]
fn a_reference_gives_its_calls_of_other_nodes_a_deadline() {
    let given = |deadline: &str, node: &str| {
        let outer = surveyor("localhost:61616", "") + &gps("Gps", node);
        outer.replace("target=\"Gps\"", &format!("target=\"Gps\" s:deadline=\"{deadline}\""))
    };
    let (assembly, told) = surveyed(&given("1min", ""));
    assert_eq!(told, "");
    assert_eq!(assembly.unwrap().components[0].references[0].deadline, Some(Duration::from_mins(1)));
    let project = Project::new().in_memory().text("fleet.composite", part("fleet", DEFAULT, &given("1min", "")));
    let alone = expanded(&project.compile(&with_surveyor())).unwrap();
    assert!(alone.contains("s:deadline=\"60s\""), "{alone}");
    let unused = surveyed(&given("1min", "s:node=\"gate\"")).1;
    let expected =
        "warning S2066: the deadline of 60s has no effect: the reference `gps` leads to no component of another node";
    assert!(unused.contains(expected), "{unused}");
    for (wrong, why) in [
        ("0", "no call is answered within no time"),
        ("soon", "`soon` is not a duration: expected a number of milliseconds"),
        ("-1s", "`-1s` is negative"),
        ("", "is empty"),
    ] {
        let told = surveyed(&given(wrong, "")).1;
        assert!(told.contains("`s:deadline`") && told.contains(why), "{wrong}: {told}");
    }
}

#[test]
fn a_cycle_of_calls_over_nodes_is_found() {
    let wired = |name: &str, node: &str, to: &str| {
        let reference = format!("<reference name=\"other\" target=\"{to}\"/></component>");
        gps(name, &format!("s:node=\"{node}\"")).replace("</component>", &reference)
    };
    let told = faults(OWN, &(wired("One", "gate", "Other") + &wired("Other", "control", "One")), None);
    assert!(told.contains("S2020: components call each other in a cycle: `One` -> `Other` -> `One`"), "{told}");
}

#[test]
fn a_component_calls_another_node_over_its_network() {
    expect_test::expect![[r#"
        2:184-187 error S2065: `Surveyor` is in node `gate`, and its reference `gps` leads to `Gps` in node `control`: `Surveyor` has no `url`, over which it could call
          3:18-21 the node of its target
          help: give it the property `url` with the address of a message broker, such as `localhost:61616`
    "#]].assert_eq(&surveyed(&(surveyor("", "") + &gps("Gps", ""))).1);
    let robot = |url: &str| {
        let one = picker("Robot", "", url).replace("example.Picker", "example.Robot");
        one.replace("<property name=\"period\">", "<property name=\"number\">1</property><property name=\"period\">")
    };
    let task = "<reference name=\"task\" target=\"Robot/TaskInterface\"/>";
    let near = gps("Gps", "s:node=\"gate\"");
    expect_test::expect![[r#"
        2:267-271 error S2065: `Surveyor` is in node `gate`, and its reference `task` leads to `Robot` in node `control`: the tasks of other programs cannot be scheduled
          4:18-23 the node of its target
          help: put both into one node
    "#]]
        .assert_eq(&surveyed(&(surveyor("localhost:61616", task) + &near + &robot("localhost:61616"))).1);
}

#[track_caller]
fn faults(attributes: &str, inside: &str, node: Option<&str>) -> String {
    let project = Project::new().in_memory().text("fleet.composite", part("fleet", attributes, inside));
    let (_, diagnostics, sources) = compiled(&project.node(node.map(str::to_owned)));
    told(&diagnostics, &sources)
}

#[test]
fn faults_of_nodes_are_told_at_their_place() {
    let two = gps("Clock", "s:node=\"gate-a\"") + &gps("Gps", "s:node=\"control\"");
    assert_eq!(faults(OWN, &two, Some("control")), "");
    expect_test::expect![[r#"
        1:1-7 error S2064: the fleet has no node `gate_a`
          fix: replace `gate_a` with `gate-a` [1:1-7 "gate-a"]
    "#]]
    .assert_eq(&faults(OWN, &two, Some("gate_a")));
    expect_test::expect![[r#"
        1:1-8 error S2064: the fleet has no node `kitchen`
          help: its nodes are `control` and `gate-a`
    "#]]
    .assert_eq(&faults(OWN, &two, Some("kitchen")));
    expect_test::expect![[r#"
        1:1-7 error S2064: the fleet has no nodes: no component names one
          help: write `saoms:node="gate-a"` in the start tags of its components, or leave `--node` out
    "#]]
    .assert_eq(&faults("", &gps("Clock", ""), Some("gate-a")));
    let some = gps("Clock", "s:node=\"gate-a\"") + &gps("Gps", "") + &gps("Compass", "");
    expect_test::expect![[r#"
        3:18-21 error S2063: `Gps` is in no node, and so is another component: no program would run it
          2:33-39 others are in a node
          help: give it a `saoms:node`, or name the node of all others in the start tag of the outermost composite: `saoms:defaultNode="..."`
    "#]].assert_eq(&faults(OWN, &some, None));
    assert_eq!(faults(DEFAULT, &some, None), "");
    // What follows from a wrong name is not told.
    let wrong = gps("Clock", "s:node=\"gate a\"") + &gps("Gps", "s:node=\"gate-b\"");
    expect_test::expect![[r#"
        2:33-39 error S1011: `gate a` is not the name of a node
          help: write a name such as `gate-a`: letters, digits, `-`, `_` and `.`, a letter or `_` first
    "#]]
    .assert_eq(&faults(OWN, &wrong, None));
    let wrong = DEFAULT.replace("control", "gate/a");
    expect_test::expect![[r#"
        1:159-165 error S1011: `gate/a` is not the name of a node
          help: write a name such as `gate-a`: letters, digits, `-`, `_` and `.`, a letter or `_` first
    "#]]
    .assert_eq(&faults(&wrong, &some, None));
}

#[test]
fn topics_of_several_nodes_need_one_network() {
    let both = |one: &str, other: &str| {
        faults(OWN, &(dispatcher("s:node=\"control\"", one) + &picker("Picker", "s:node=\"gate\"", other)), None)
    };
    assert_eq!(both("localhost:61616", "localhost:61616"), "");
    expect_test::expect![[r#"
        3:18-24 error S4019: `Picker` of node `gate` and `Dispatcher` of node `control` use topic `ORDERS`, but `Picker` has no `url`: they do not hear each other
          2:38-45 the other node
          help: give it the property `url` with the value `localhost:61616`
    "#]].assert_eq(&both("localhost:61616", ""));
    expect_test::expect![[r#"
        2:18-28 error S4019: `Dispatcher` of node `control` and `Picker` of node `gate` use topic `ORDERS`, but have no `url`: they do not hear each other
          3:34-38 the other node
          help: give both the property `url` with the address of a message broker, such as `localhost:61616`
        3:18-24 error S4019: `Picker` of node `gate` and `Dispatcher` of node `control` use topic `ORDERS`, but have no `url`: they do not hear each other
          2:38-45 the other node
          help: give both the property `url` with the address of a message broker, such as `localhost:61616`
    "#]].assert_eq(&both("", ""));
    expect_test::expect![[r#"
        3:182-197 error S4019: `Picker` of node `gate` and `Dispatcher` of node `control` use topic `ORDERS`, but their `url` is `127.0.0.1:61616` and `localhost:61616`: they do not hear each other
          2:38-45 the other node
          help: give both the same text: a network is named by it
    "#]].assert_eq(&both("localhost:61616", "127.0.0.1:61616"));
    // Two that read do not miss each other, nor do components of one node or of two sites.
    let readers = picker("One", "s:node=\"control\"", "") + &picker("Other", "s:node=\"gate\"", "");
    assert_eq!(faults(OWN, &readers, None), "");
    let sites = dispatcher("s:node=\"control\" s:site=\"North\"", "")
        + &picker("Picker", "s:node=\"gate\" s:site=\"South\"", "");
    assert_eq!(faults(OWN, &sites, None), "");
}
