use expect_test::{Expect, expect};

use super::{Diagram, State, dot, mermaid, svg};
use saoms_lang::check::Occurrences;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;

fn diagram(content: &str) -> Diagram {
    let namespace = "http://docs.oasis-open.org/ns/opencsa/sca/200912";
    let text = format!("<composite xmlns='{namespace}' name='c' targetNamespace='urn:c'{content}</composite>");
    drawn(&Project::new().text("c.composite", text))
}

/// The diagram of the first of some composites that name each other.
fn together(texts: impl IntoIterator<Item = String>) -> Diagram {
    let mut texts = texts.into_iter();
    let project = Project::new().text("c.composite", texts.next().unwrap());
    drawn(&texts.fold(project, |project, text| project.other_text("c.composite", text)))
}

/// The diagram of a project in memory, whose classes are unknown.
fn drawn(project: &Project) -> Diagram {
    let loaded = project.clone().in_memory().load(&Registry::new());
    Diagram::of(&loaded.contribution, &loaded.registry, &Occurrences::default())
}

/// The edges of the flowchart, each a line.
fn edges(content: &str, expected: Expect) {
    let chart = mermaid(&diagram(content)).to_string();
    let edges = chart.lines().map(str::trim).filter(|line| line.contains("->"));
    expected.assert_eq(&edges.map(|line| format!("{line}\n")).collect::<String>());
}

#[test]
fn targets_wires_and_promotions_are_links() {
    edges(
        "><service name='in' promote='A/s'/>
        <component name='A'><implementation.java class='a.A'/><service name='s'/>
          <reference name='one' target='B/t C/u/binding'/><reference name='two'/></component>
        <component name='B'><implementation.java class='a.B'/><service name='t'/></component>
        <component name='C'><implementation.java class='a.C'/></component>
        <wire source='A/two' target='B'/><wire source='A/two' target='B/t'/><wire source='B' target='C'/>
        <reference name='out' promote='C/rest B'/>",
        expect![[r#"
            c0 -->|"one → t"| c1
            c0 -->|"one → u"| c2
            c0 -->|"two → t"| c1
            c1 -->|"u"| c2
            s0 -.->|"s"| c0
            c2 -.->|"rest"| r0
            c1 -.-> r0
        "#]],
    );
}

#[test]
fn a_wire_that_replaces_targets_is_drawn_in_their_place() {
    edges(
        "><component name='A'><implementation.java class='a.A'/>
          <reference name='one' target='B'/><reference name='two' target='B'/></component>
        <component name='B'><implementation.java class='a.B'/></component>
        <component name='C'><implementation.java class='a.C'/></component>
        <wire source='A/one' target='B/s'/><wire source='A/one' target='C' replace='true'/>
        <wire source='A/two' target='C' replace='false'/>",
        expect![[r#"
            c0 -->|"two"| c1
            c0 -->|"one → s"| c1
            c0 -->|"one"| c2
            c0 -->|"two"| c2
        "#]],
    );
}

#[test]
fn what_is_named_and_not_there_is_missing() {
    let diagram =
        diagram("><component name='A'><reference name='r' target='B/s'/></component><wire source='C/x' target='A'/>");
    let found: Vec<_> = diagram.components.iter().map(|one| (&*one.name, one.state)).collect();
    assert_eq!(found, [("A", State::Known), ("B", State::Missing), ("C", State::Missing)]);
    assert!(svg(&diagram).to_string().contains("the composite has no such component"));
}

#[test]
fn autowire_finds_services_of_the_same_interface() {
    let interface = "<interface.java interface='a.I'/>";
    edges(
        &format!(
            " autowire='true'><component name='A'><implementation.java class='a.A'/>
            <reference name='r'>{interface}</reference><reference name='n' multiplicity='0..n'>{interface}</reference>
            <reference name='o' autowire='false'>{interface}</reference></component>
            <component name='B'><implementation.java class='a.B'/><service name='s'>{interface}</service></component>
            <component name='C'><implementation.java class='a.C'/><service name='t'>{interface}</service></component>"
        ),
        expect![[r#"
            c0 -->|"r → s"| c1
            c0 -->|"n → s"| c1
            c0 -->|"n → t"| c2
        "#]],
    );
}

/// A promoted service has the interface of the inner one, so that autowire finds it, and is wired around its composite
/// alone.
#[test]
fn autowire_finds_what_composites_promote() {
    let interface = "<interface.java interface='a.I'/>";
    let texts = [
        "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='outer' targetNamespace='urn:c' xmlns:c='urn:c' autowire='true'>
            <component name='Caller'><implementation.composite name='c:calls'/></component>
            <component name='Hall'><implementation.composite name='c:serves'/></component>
            <component name='Plain'><implementation.java class='a.A'/><service name='t'>{interface}</service></component>
        </composite>",
        "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='calls' targetNamespace='urn:c' autowire='true'>
            <reference name='many' promote='A/r' multiplicity='0..n'/><reference name='one' promote='B'/>
            <component name='A'><implementation.java class='a.A'/><reference name='r' multiplicity='0..n'>{interface}</reference></component>
            <component name='B'><implementation.java class='a.A'/><reference name='r'>{interface}</reference></component>
            <component name='C'><implementation.java class='a.A'/><service name='inside'>{interface}</service></component>
        </composite>",
        "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='serves' targetNamespace='urn:c'>
            <service name='in' promote='S/s'/>
            <component name='S'><implementation.java class='a.A'/><service name='s'>{interface}</service></component>
        </composite>",
    ];
    let drawn = mermaid(&together(texts.map(|text| text.replace("{interface}", interface)))).to_string();
    let wires = drawn.lines().map(str::trim).filter(|line| line.contains("-->"));
    expect![[r#"
        c0_r0 -->|"many → in"| c1_s0
        c0_r0 -->|"many → t"| c2
        c0_r1 -->|"one → in"| c1_s0
    "#]]
    .assert_eq(&wires.map(|line| format!("{line}\n")).collect::<String>());
}

/// Each of many that may call each of many would be the square of what the file has.
#[test]
fn a_picture_has_a_part_of_very_many_wires_of_autowire_and_says_so() {
    let interface = "<interface.java interface='a.I'/>";
    let component = |place: usize| {
        format!(
            "<component name='c{place}'><service name='s'>{interface}</service><reference name='r' multiplicity='0..n'>{interface}</reference></component>"
        )
    };
    let diagram = diagram(&format!(" autowire='true'>{}", (0..200).map(component).collect::<String>()));
    assert_eq!((diagram.links.len(), diagram.left_out), (20_000, 200 * 199 - 20_000));
    for drawn in [svg(&diagram).to_string(), mermaid(&diagram).to_string(), dot(&diagram).to_string()] {
        assert!(drawn.contains("19800 wires are not drawn"));
    }
}

/// Each has a box, and takes many times what it takes in the file.
#[test]
fn a_picture_has_a_part_of_very_many_components_that_are_not_there_and_says_so() {
    let wire = |place: usize| format!("<wire source='A/r{place}' target='M{place}/s'/>");
    let wires: String = (0..2_500).map(wire).collect();
    let diagram = diagram(&format!("><component name='A'/>{wires}"));
    assert_eq!((diagram.links.len(), diagram.components.len(), diagram.left_out), (2_000, 2_001, 500));
    assert_eq!(diagram.components[0].references.len(), 2_000);
    assert!(mermaid(&diagram).to_string().contains("500 wires are not drawn"));
}

/// It runs beside the other one, and as a component of it.
#[test]
fn a_composite_that_is_named_beside_one_that_has_it_inside_is_drawn_twice() {
    let composite = |name: &str, content: &str| {
        format!(
            "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='{name}' targetNamespace='urn:c' xmlns:c='urn:c'>{content}</composite>"
        )
    };
    let both = [
        composite("outer", "<component name='I'><implementation.composite name='c:inner'/></component>"),
        composite("inner", "<component name='A'><implementation.java class='a.A'/></component>"),
    ];
    let project = both.into_iter().fold(Project::new(), |project, text| project.text("c.composite", text));
    let diagram = drawn(&project);
    let inside = diagram.components[0].inside.as_deref().unwrap();
    assert_eq!((inside.components[0].name.as_str(), diagram.components[1].name.as_str()), ("A", "A"));
}

/// Whatever names hold, the texts stay what they are.
#[test]
fn names_are_escaped() {
    let diagram = diagram(
        "><component name='&lt;a&gt; &amp; &quot;b&quot; | {c} \\ # ]]'><implementation.java class='x'/></component>",
    );
    let drawn = svg(&diagram).to_string();
    let document = roxmltree::Document::parse(&drawn).unwrap();
    let name = document.descendants().find(|node| node.attribute("class") == Some("name") && node.text() != Some("c"));
    assert_eq!(name.unwrap().text(), Some(&*diagram.components[0].name));
    assert!(dot(&diagram).to_string().contains(r#"label="\<a\> & \"b\" \| \{c\} \\ # ]]\nx""#), "{}", dot(&diagram));
    assert!(mermaid(&diagram).to_string().contains("#60;a#62; #38; #34;b#34; #124; {c} #92; #35; ]]<br/>x"));
}

#[test]
fn composites_are_drawn_inside_the_components_that_they_implement() {
    let composite = |name: &str, content: &str| {
        format!(
            "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='{name}' targetNamespace='urn:c' xmlns:c='urn:c'>{content}</composite>"
        )
    };
    let texts = [
        composite(
            "outer",
            "<include name='c:more'/><component name='Hall'><implementation.composite name='c:inner'/></component>
            <component name='Door'><implementation.java class='a.Door'/><reference name='r' target='Hall/light'/></component>",
        ),
        composite("inner", "<service name='light' promote='Lamp/on'/><component name='Lamp'><implementation.java class='a.Lamp'/></component>
            <component name='Again'><implementation.composite name='c:inner'/></component>"),
        composite("more", "<component name='Bell'><implementation.java class='a.Bell'/></component>"),
    ];
    let diagram = together(texts);
    expect![[r#"
        flowchart LR
          subgraph composite ["outer"]
          subgraph c0 ["Hall<br/>composite c:inner"]
            c0_c0("Lamp<br/>a.Lamp"):::unknown
            c0_c1("Again<br/>composite c:inner"):::component
          c0_s0>"light"]:::service
          end
          c0_s0 -.->|"on"| c0_c0
            c1("Door<br/>a.Door"):::unknown
            c2("Bell<br/>a.Bell"):::unknown
          end
          c1 -->|"r → light"| c0_s0
    "#]]
    .assert_eq(mermaid(&diagram).to_string().split("  classDef").next().unwrap());
    let drawn = svg(&diagram).to_string();
    let document = roxmltree::Document::parse(&drawn).unwrap();
    let names: Vec<_> = document
        .descendants()
        .filter(|node| node.attribute("class") == Some("name"))
        .filter_map(|node| node.text())
        .collect();
    assert_eq!(names, ["outer", "Hall", "inner", "Lamp", "Again", "Door", "Bell"]);
}

#[test]
fn replicas_are_one_component_that_all_their_names_lead_to() {
    edges(
        " xmlns:s='urn:saoms:1'><component name='Robot${index:02}' s:count='3'><service name='move'/><reference name='gps' target='Gps${ index }/position'/></component>
         <component name='Gps${index}' s:count='3'><service name='position'/></component>
         <component name='Master'><reference name='one' target='Robot02/move'/><reference name='all' target='Robot*/move'/><reference name='none' target='Robotx'/></component>",
        expect![[r#"
            c0 -->|"gps → position"| c1
            c2 -->|"one → move"| c0
            c2 -->|"all → move"| c0
            c2 -->|"none"| c3
        "#]],
    );
}
