use super::marked::{defined, found, renamed};
use crate::editor::navigate::{DefinitionTarget, definition};
use crate::editor::symbols::{DocumentSymbol, document_symbols};
use crate::editor::testing::{composite, scene_in, scene_of};

const INNER: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="inner" targetNamespace="urn:f">
  <property name="size">3</property>
  <service name="lamp" promote="L/TaskInterface"/>
  <component name="L"><implementation.java class="saoms.Robot"/><property name="number" source="$size"/></component>
</composite>"#;

#[test]
fn definitions_are_found_across_files_and_wires() {
    let others = [("inner.composite", INNER)];
    let goes = |inside: &str, expected: &[&str]| {
        assert_eq!(defined(&composite(inside), &others), expected, "{inside}");
    };
    let two = r#"<component name="Ä"/><component name="B"><reference name="r" target="Ä"/></component>"#;
    goes(&two.replace("target=\"Ä", "target=\"Ä|"), &["fleet.composite:2:18 Ä"]);
    goes(r#"<component name="A"/><wire source="A|/r" target="B"/>"#, &["fleet.composite:2:18 A"]);
    // A part that only the class knows is where its component is, or where that says something about it.
    goes(r#"<component name="A"/><wire source="A/r|" target="B"/>"#, &["fleet.composite:2:18 A"]);
    goes(
        r#"<component name="A"><reference name="r"/></component><wire source="A/r|" target="B"/>"#,
        &["fleet.composite:2:38 r"],
    );
    goes(r#"<include name="inn|er"/>"#, &["inner.composite:1:75 inner"]);
    goes(r#"<include name="inner"/><wire source="x" target="L|"/>"#, &["inner.composite:4:20 L"]);
    let uses = r#"<component name="I"><implementation.composite name="inner"/>"#;
    goes(&uses.replace("inner", "inner|"), &["inner.composite:1:75 inner"]);
    goes(&format!("{uses}<property name=\"|size\">4</property></component>"), &["inner.composite:2:19 size"]);
    goes(&format!("{uses}</component><wire source=\"x\" target=\"I/lamp|\"/>"), &["inner.composite:3:18 lamp"]);
    goes(&format!("{uses}<service name=\"lamp|\"/></component>"), &["inner.composite:3:18 lamp"]);
    goes(
        r#"<property name="p"/><component name="A"><property name="q" source="$|p/part"/>"#,
        &["fleet.composite:2:17 p"],
    );
    goes(r#"<component name="A"/><service name="s" promote="A|"/>"#, &["fleet.composite:2:18 A"]);
    goes(r#"<component name="A"/><wire source="nowhere|" target="B"/>"#, &[]);
    goes(
        r#"<component name="A"><reference name="r"><binding.sca uri="A|/s"/></reference></component>"#,
        &["fleet.composite:2:18 A"],
    );
    goes(
        r#"<component name="R${index:03}" s:count="3"/><wire source="R002|/r" target="B"/>"#,
        &["fleet.composite:2:18 R${index:03}"],
    );
    goes(
        r#"<component name="A"><s:loop name="new" class="x.Y"/><s:loop name="b" after="new|"/></component>"#,
        &["fleet.composite:2:35 new"],
    );
    let up = INNER.replace("L/TaskInterface", "L|/TaskInterface");
    assert_eq!(defined(&up, &[]), ["fleet.composite:4:20 L"]);
}

#[test]
fn references_are_all_that_mean_the_same() {
    let outer = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="outer" targetNamespace="urn:f"><include name="inner"/><wire source="x" target="L"/></composite>"#;
    // This one has an `L` of its own.
    let other = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="other" targetNamespace="urn:f"><component name="L"/><wire source="x" target="L"/></composite>"#;
    let found = |marked: &str, with_definition| {
        found(marked, &[("outer.composite", outer), ("other.composite", other)], with_definition)
    };
    let marked = INNER.replace("name=\"L\"", "name=\"L|\"");
    assert_eq!(found(&marked, true), ["fleet.composite:4:20 L", "fleet.composite:3:33 L", "outer.composite:1:154 L"]);
    assert_eq!(found(&marked, false).len(), 2);
    let marked = INNER.replace("name=\"inner\"", "name=\"inner|\"");
    assert_eq!(found(&marked, false), ["outer.composite:1:121 inner"]);
    let marked = INNER.replace("\"saoms.Robot\"", "\"saoms.Robot|\"");
    assert_eq!(found(&marked, false).len(), 1);
}

#[test]
fn a_component_is_renamed_wherever_it_is_meant() {
    let text = r#"<component name="Alt"><implementation.java class="x.Alt"/></component>
<component name="Altes"><reference name="r" target="Ander Alt/s"/><reference name="q"><binding.sca uri="Alt"/></reference></component>
<service name="s" promote="Alt/s"/><reference name="r" promote="Altes/r Alt/r"/>
<wire source="Alt/r" target="Alt"/> <!-- Alt -->"#;
    let marked = composite(&text.replacen("promote=\"Alt", "promote=\"Al|t", 1));
    let other = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="outer" targetNamespace="urn:f"><include name="fleet"/><wire source="Alt" target="Altes"/></composite>"#;
    let all = renamed(&marked, &[("outer.composite", other)], "Neu-ä").unwrap();
    let expected = r#"<component name="Neu-ä"><implementation.java class="x.Alt"/></component>
<component name="Altes"><reference name="r" target="Ander Neu-ä/s"/><reference name="q"><binding.sca uri="Neu-ä"/></reference></component>
<service name="s" promote="Neu-ä/s"/><reference name="r" promote="Altes/r Neu-ä/r"/>
<wire source="Neu-ä/r" target="Neu-ä"/> <!-- Alt -->"#;
    assert_eq!(all, [composite(expected), other.replace("\"Alt\"", "\"Neu-ä\"")]);
}

#[test]
fn other_names_of_a_composite_are_renamed_too() {
    let parameter =
        composite(r#"<property name="p|"/><component name="A"><property name="p" source="$p/x"/></component>"#);
    let expected =
        composite(r#"<property name="q"/><component name="A"><property name="p" source="$q/x"/></component>"#);
    assert_eq!(renamed(&parameter, &[], "q").unwrap(), [expected]);
    let uses = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:f="urn:f" name="u" targetNamespace="urn:u"><include name="f:fleet"/></composite>"#;
    let all =
        renamed(&composite("").replace("name=\"fleet", "name=\"fl|eet"), &[("u.composite", uses)], "port").unwrap();
    assert_eq!(all[1], uses.replace("f:fleet", "f:port"));
    let replicas =
        composite(r#"<component name="R${index:03}|" s:count="2"/><wire source="R001/r" target="R${index:03}"/>"#);
    assert_eq!(
        renamed(&replicas, &[], "Cart${index:03}").unwrap(),
        [composite(
            r#"<component name="Cart${index:03}" s:count="2"/><wire source="Cart001/r" target="Cart${index:03}"/>"#
        )]
    );
    assert!(renamed(&replicas, &[], "Cart").unwrap_err().contains("names replicas"));
    // `R001` would be `Cart01`, or another one.
    let other = renamed(&replicas, &[], "Cart${index:02}").unwrap_err();
    assert!(other.contains("`R001` is one of the replicas"), "{other}");
}

#[test]
fn what_names_all_replicas_leads_to_them_and_is_renamed() {
    let text = |name: &str, target: &str, other: &str| {
        composite(&format!(
            r#"<component name="{name}" s:count="2"/><wire source="{target}/r" target="A"/><wire source="{other}/r" target="{target}/s"/>"#
        ))
    };
    let marked = text("R${index:03}", "R*", "B").replacen("R*", "R*|", 1);
    assert_eq!(defined(&marked, &[]), ["fleet.composite:2:18 R${index:03}"]);
    let expected = text("Cart${index}", "Cart*", "B");
    assert_eq!(renamed(&marked, &[], "Cart${index}").unwrap(), [expected], "no single replica is named");
    assert!(renamed(&marked, &[], "Cart").unwrap_err().contains("names replicas"));
    let two = text("R${row}x${index}", "R*x*", "R1x22").replacen("R*x*", "R*x|*", 1);
    assert_eq!(defined(&two, &[]), ["fleet.composite:2:18 R${row}x${index}"]);
    let refused = renamed(&two, &[], "C${row}x${index}").unwrap_err();
    assert!(refused.contains("`R1x22` is one of the replicas"), "{refused}");
}

#[test]
fn what_a_reference_of_a_composite_targets_is_around_it() {
    let inner = |target: &str| {
        composite(&format!(
            r#"<component name="W"/><component name="R"/><reference name="r" promote="R/w" target="{target}"/>"#
        ))
    };
    let outer = |name: &str, world: &str| {
        format!(
            r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="{name}" targetNamespace="urn:f"><component name="{world}"/><component name="F"><implementation.composite name="fleet"/></component></composite>"#
        )
    };
    let one = outer("one", "W");
    let marked = inner("W|/s");
    assert_eq!(defined(&marked, &[("one.composite", &one)]), ["one.composite:1:121 W"]);
    assert_eq!(defined(&marked, &[]), [""; 0]);
    let all = renamed(&marked, &[("one.composite", &one)], "Site").unwrap();
    assert_eq!(all, [inner("Site/s"), outer("one", "Site")]);
    // The one inside is another one.
    let all = renamed(&inner("W").replacen("\"W\"", "\"W|\"", 1), &[("one.composite", &one)], "In").unwrap();
    assert_eq!(all, [inner("W").replacen("\"W\"", "\"In\"", 1), one.clone()]);
    // With another name it would be unresolved in the other composite.
    let others = [("one.composite", one.as_str()), ("two.composite", &outer("two", "W"))];
    let refused = renamed(&marked, &others, "Site").unwrap_err();
    assert!(refused.contains("in `two.composite`"), "{refused}");
}

#[test]
fn names_in_files_beside_composites_lead_to_what_they_mean() {
    let fleet = composite(
        r#"<property name="bots">2</property><component name="H${index}" s:count="2" s:overrides="h.csv"><implementation.composite name="hall"/><property name="text" file="t.txt"/></component>"#,
    );
    let hall = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="hall" targetNamespace="urn:f"><property name="size"/></composite>"#;
    let others = [("fleet.composite", fleet.as_str()), ("hall.composite", hall)];
    let goes = |name: &str, marked: &str| {
        let (scene, at) = scene_in(name, marked, &others);
        definition(&scene, at)
            .into_iter()
            .map(|goal| match goal {
                DefinitionTarget::Range(place) => scene.files[place.file].text[place.start..place.end].to_owned(),
                DefinitionTarget::File(path) => path.display().to_string(),
            })
            .collect::<Vec<String>>()
    };
    assert_eq!(goes("h.csv", "name,si|ze\nH1,3\n"), ["size"]);
    assert_eq!(goes("h.csv", "name,size\nH|1,3\n"), ["H${index}"]);
    assert_eq!(goes("h.csv", "name,size\nH1,|3\n"), [""; 0]);
    assert_eq!(goes("t.txt", "of ${bo|ts}"), ["bots"]);
}

#[test]
fn what_cannot_be_renamed_says_why() {
    let text = composite(r#"<component name="A|"/><component name="B"/>"#);
    let refused = |marked: &str, name: &str| renamed(marked, &[], name).unwrap_err();
    assert_eq!(refused(&text, "B"), "the name `B` is already used");
    assert!(refused(&text, "").contains("cannot be a name"));
    assert!(refused(&text, "a/b").contains("cannot be a name"));
    assert!(refused(&text, "a<b").contains("cannot be a name"));
    let class = composite(r#"<component name="A"><implementation.java class="x.|Y"/></component>"#);
    assert_eq!(refused(&class, "z"), "the name of the class `x.Y` is defined in its code");
    assert_eq!(refused(&composite("<|component/>"), "z"), "there is no name here");
    let lost = composite(r#"<wire source="A|" target="B"/>"#);
    assert!(refused(&lost, "z").contains("not defined"));
    assert_eq!(renamed(&text, &[], "A").unwrap(), [text.replace('|', "")], "the same name is no fault");
}

#[test]
fn the_outline_has_every_part() {
    let scene = scene_of(INNER, &[]);
    let mut lines = Vec::new();
    let mut left: Vec<(usize, DocumentSymbol)> =
        document_symbols(scene.file()).into_iter().map(|one| (0, one)).collect();
    while let Some((depth, one)) = left.pop() {
        lines.push(format!("{}{} {}", "  ".repeat(depth), one.name, one.detail));
        left.extend(one.children.into_iter().rev().map(|inner| (depth + 1, inner)));
    }
    let expected = ["inner urn:f", "  size property", "  lamp service", "  L saoms.Robot", "    number $size"];
    assert_eq!(lines, expected);
    // Also while it is being typed.
    assert_eq!(document_symbols(scene_of("<composite name='a'><component name='", &[]).file())[0].children.len(), 1);
}
