//! Proposals from fleets in few lines and files beside them.

use std::collections::BTreeSet;
use std::fs;

use super::*;
use crate::editor::Workspace;
use crate::editor::testing::{scene_around, scene_at};

const REPLICATED: &str = "<property name=\"bots\">4</property><property name=\"my-name\"/><component name=\"R${|1}\" s:count=\"bots\" s:if=\"|2\" s:from=\"|3\">\
    <implementation.rust class=\"saoms.Robot\"/><property name=\"delay\">${10*|4}</property><property name=\"chargeX\" value=\"${|5\"/>\
    <property name=\"scenario\"><value>x ${index} $${|6}</value></property><reference name=\"world\" target=\"W${|7}\"/></component>\
    <component name=\"P\" s:if=\"|8\"><property name=\"a\">${|9}</property></component>";

#[test]
fn expressions_complete_with_properties_and_the_index() {
    let at = |place: char| {
        let marked = REPLICATED.replace(&format!("|{place}"), "\u{1}");
        let plain = ('1'..='9').fold(marked, |text, other| text.replace(&format!("|{other}"), ""));
        proposed(&composite(&plain.replace('\u{1}', "|")))
    };
    for place in ['1', '2', '4', '5', '7'] {
        assert_eq!(at(place), ["index", "bots"], "{place}");
    }
    // There is no index before there is a number of them, nor of what is not replicated.
    assert_eq!(at('3'), ["bots"]);
    assert_eq!(at('8'), ["bots"]);
    for place in ['6', '9'] {
        assert!(!at(place).contains(&"bots".to_owned()), "{place}");
    }
    let text = composite(&REPLICATED.replacen("${10*|4}", "${10*in|dex/2}", 1));
    let plain = ('1'..='9').fold(text, |text, other| text.replace(&format!("|{other}"), ""));
    assert_eq!(taken(&plain, "bots", false), plain.replace("in|dex", "bots"));
}

#[test]
fn what_saoms_adds_is_proposed_before_its_namespace_is_bound() {
    let unbound = |inside: &str| composite(inside).replace(" xmlns:s=\"urn:saoms:1\"", "");
    let declared = |inside: &str, label: &str| {
        let (scene, at) = scene(&unbound(inside), &[]);
        let found = complete(&scene, at).into_iter().find(|one| one.label == label).unwrap();
        let edit = found.also.unwrap();
        (edit.range, edit.text)
    };
    let declaration = (10..10, " xmlns:saoms=\"urn:saoms:1\"".to_owned());
    assert_eq!(declared("<component name=\"R\" cou|", "saoms:count"), declaration);
    assert_eq!(declared("<component name=\"R\"><|", "saoms:loop"), declaration);
    assert_eq!(declared("<|", "saoms:severity"), declaration);
    // Where the prefix is another one's, nothing can be proposed.
    let other = proposed(&unbound("<component xmlns:saoms=\"urn:x\" name=\"R\" |"));
    assert!(!other.iter().any(|label| label.contains(':')), "{other:?}");
    // The name comes before the number of replicas.
    assert_eq!(proposed(&unbound("<property name=\"n\"/><component name=\"R${|")), ["index", "n"]);
}

#[test]
fn types_are_those_of_xml_schema_with_the_prefix_of_the_file() {
    let bound = composite("<property xmlns:x=\"http://www.w3.org/2001/XMLSchema\" name=\"p\" type=\"|\"/>");
    assert_eq!(proposed(&bound)[..3], ["x:string", "x:int", "x:boolean"]);
    let (scene, at) = scene(&composite("<property name=\"p\" type=\"i|\"/>"), &[]);
    let found = complete(&scene, at).into_iter().find(|one| one.label == "xsd:int").unwrap();
    let edit = found.also.unwrap();
    assert_eq!(edit.text, " xmlns:xsd=\"http://www.w3.org/2001/XMLSchema\"");
    assert_eq!(edit.range, 10..10);
    let element = "<property name=\"p\" element=\"|\"><y:map xmlns:y=\"urn:y\"/></property>";
    assert_eq!(proposed(&composite(element)), ["y:map"]);
}

#[test]
fn values_of_composite_properties_are_as_they_are_used() {
    let used = |typed: &str| {
        proposed(&composite(&format!(
            "<property name=\"p\">{typed}</property>{ROBOT}<property name=\"overrun\" source=\"$p\"/></component>"
        )))
    };
    assert_eq!(used("|"), ["skip", "catchUp", "stop"]);
    assert_eq!(used("<value>|</value>"), ["skip", "catchUp", "stop"]);
    assert_eq!(proposed(&composite("<property name=\"p\" type=\"xsd:boolean\" value=\"|\"/>")), ["true", "false"]);
    let inner = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"inner\" targetNamespace=\"urn:f\">\
        <property name=\"how\"/><component name=\"R\"><implementation.rust class=\"saoms.Robot\"/><property name=\"overrun\" source=\"$how\"/></component></composite>";
    let uses = "<component name=\"I\"><implementation.composite name=\"inner\"/><property name=\"how\">|</property></component>";
    assert_eq!(proposed_among(&composite(uses), &[("inner.composite", inner)]), ["skip", "catchUp", "stop"]);
}

#[test]
fn files_beside_are_found_folder_by_folder() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("more")).unwrap();
    for name in ["a.txt", "b.csv", "more/c.csv", "libx.so", "f.composite", ".hidden", "d&e.txt"] {
        fs::write(folder.path().join(name), "").unwrap();
    }
    let labels = |inside: &str| {
        let marked = composite(inside);
        let at = marked.find('|').unwrap();
        let scene = scene_at(&folder.path().join("f.composite"), &marked.replacen('|', "", 1));
        let mut all = complete(&scene, at);
        all.sort_by_key(Proposal::order);
        all.into_iter().map(|one| one.label).collect::<Vec<_>>()
    };
    let property = |file: &str| labels(&format!("{ROBOT}<property name=\"scenario\" file=\"{file}\"/></component>"));
    assert_eq!(property("|"), ["a.txt", "b.csv", "more/"]);
    assert_eq!(property("more/|x.csv"), ["c.csv"]);
    assert_eq!(property("../nowhere/|"), [""; 0]);
    assert_eq!(labels("<component name=\"R${index}\" s:overrides=\"|\"/>"), ["b.csv", "more/"]);
    assert_eq!(
        labels("<component name=\"R\"><implementation.rust class=\"x.Y\" library=\"|\"/>"),
        ["libx.so", "more/"]
    );
}

#[test]
fn only_files_that_a_composite_may_name_are_proposed_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir_all(path("site/halls")).unwrap();
    fs::create_dir(path("open")).unwrap();
    for name in ["secret.csv", "open/a.csv", "site/b.csv", "site/halls/c.csv"] {
        fs::write(path(name), "index,period\n1,100ms\n").unwrap();
    }
    let hall = path("site/halls/f.composite");
    let found = |typed: &str, workspace: &mut Workspace| {
        let marked = composite(&format!("<component name=\"R${{index}}\" s:count=\"1\" s:overrides=\"{typed}|\"/>"));
        fs::write(&hall, marked.replacen('|', "", 1)).unwrap();
        let scene = scene_around(&hall, workspace);
        let read = scene.files.iter().any(|file| file.path.extension().is_some_and(|ending| ending == "csv"));
        let all = complete(&scene, marked.find('|').unwrap());
        (all.into_iter().map(|one| one.label).collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>().join(" "), read)
    };
    let told = |typed: &str, workspace: &mut Workspace| found(typed, workspace).0;
    let workspace = &mut Workspace::default();
    assert_eq!(told("", workspace), "c.csv");
    assert_eq!(told("../", workspace), "", "nothing says that it is of the contribution");
    assert!(!found("../b.csv", workspace).1 && found("c.csv", workspace).1);
    fs::write(
        path("site/sca-contribution.xml"),
        "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"/>",
    )
    .unwrap();
    workspace.refresh();
    assert_eq!(told("../", workspace), "b.csv halls/");
    assert_eq!(told("../../", workspace), "");
    assert_eq!(told(&format!("{}/", folder.path().display()), workspace), "");
    assert!(found("../b.csv", workspace).1 && !found("../../secret.csv", workspace).1);
    workspace.set_folders(&[path("open")]);
    assert_eq!(told("../../open/", workspace), "a.csv");
    assert_eq!(told("../../", workspace), "");
    assert_eq!(told("../../", &mut Workspace::new(true)), "open/ secret.csv site/");
}

#[test]
fn names_that_can_be_known_are_proposed() {
    let named = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"|\"/>";
    assert_eq!(proposed(named), ["fleet"]);
    let spaces = named.replace("name=\"|\"", "name=\"x\" targetNamespace=\"|\"");
    let others = [("e.composite", "<composite name=\"e\" targetNamespace=\"urn:e\"/>")];
    assert_eq!(proposed_among(&spaces, &others), ["urn:e"]);
    assert_eq!(proposed(&composite("<service name=\"|\" promote=\"R/lamp\"/>")), ["lamp"]);
    assert_eq!(proposed(&composite("<property name=\"max-speed\" s:env=\"|\"/>"))[0], "FLEET_MAX_SPEED");
    let root = |attribute: &str| composite("").replacen(" name=", &format!(" {attribute} name="), 1);
    assert_eq!(proposed(&root("s:alertTokenEnv=\"|\""))[0], "FLEET_ALERT_TOKEN");
    assert_eq!(proposed(&root("s:hangup=\"|\"")), ["end", "hold", "goOn"]);
    let attributes = proposed(&root("|"));
    for own in ["s:alertCommand", "s:alertTokenEnv", "s:alertUrl", "s:hangup", "s:lostLink"] {
        assert!(attributes.iter().any(|one| one == own), "{own}: {attributes:?}");
    }
    let bound = format!("{WORLD}{ROBOT}<reference name=\"world\"><binding.sca uri=\"|\"/></reference></component>");
    assert_eq!(proposed(&composite(&bound)), ["World"]);
}
