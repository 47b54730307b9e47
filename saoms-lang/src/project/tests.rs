//! Projects in memory.

use super::*;
use crate::registry::Registry;

const HEAD: &str = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1" targetNamespace="urn:t""#;

fn codes(project: &Project) -> Vec<String> {
    let found = project.compile(&Registry::new());
    found.reported().map(|one| format!("{} {}", one.code.id, found.sources.get(one.location.file).path())).collect()
}

#[test]
fn a_project_without_a_fault_compiles_to_an_assembly() {
    let project = Project::new().text("a", format!("{HEAD} name=\"a\"/>"));
    let compilation = project.compile(&Registry::new());
    assert!(compilation.output.is_some(), "{:?}", compilation.diagnostics);
    assert!(!compilation.has_errors());
    assert_eq!(compilation.first().unwrap().name, "a");
}

#[test]
fn settings_are_read_before_composites() {
    let project = Project::new().text("a", format!("{HEAD} name=\"a\"><x/></composite>")).set("speed").severity("x");
    assert_eq!(codes(&project), ["S2027 --set", "S2048 --severity", "S1004 a"]);
}

#[test]
fn the_environment_is_empty_unless_it_is_given() {
    let text = format!("{HEAD} name=\"a\"><property name=\"p\" mustSupply=\"true\" saoms:env=\"P\"/></composite>");
    let project = Project::new().text("a", text);
    assert!(project.compile(&Registry::new()).has_errors());
    let given = project.environment(|name| (name == "P").then(|| "1".into()));
    assert!(!given.compile(&Registry::new()).has_errors());
}

#[test]
fn a_part_may_leave_values_to_its_users() {
    let text = format!("{HEAD} name=\"a\"><property name=\"p\" mustSupply=\"true\"/></composite>");
    let project = Project::new().text("a", text);
    assert!(project.compile(&Registry::new()).has_errors());
    assert!(!project.part(true).compile(&Registry::new()).has_errors());
}

#[test]
fn other_texts_can_be_named() {
    let include = format!("{HEAD} xmlns:t=\"urn:t\" name=\"a\"><include name=\"t:b\"/></composite>");
    let project = Project::new().text("a", include);
    assert!(project.compile(&Registry::new()).has_errors());
    let project = project.other_text("b", format!("{HEAD} name=\"b\"/>"));
    let compilation = project.compile(&Registry::new());
    assert!(!compilation.has_errors(), "{:?}", compilation.diagnostics);
}

#[test]
fn open_texts_count_in_place_of_files() {
    let mut open = OpenTexts::default();
    let path = std::path::Path::new("/nowhere/a.composite");
    open.insert(path, format!("{HEAD} name=\"open\"/>"));
    let compilation = Project::new().file(path).open_texts(open).compile(&Registry::new());
    assert_eq!(compilation.first().unwrap().name, "open");
}
