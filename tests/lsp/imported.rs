//! Composites of other contributions, which a contribution imports.

use std::fs;

use serde_json::{Value, json};

use super::editor::Editor;

const SCA: &str = "http://docs.oasis-open.org/ns/opencsa/sca/200912";

fn labels(answer: &Value) -> Vec<&str> {
    answer["result"]["items"].as_array().unwrap().iter().map(|one| one["label"].as_str().unwrap()).collect()
}

#[test]
fn what_is_imported_is_completed_explained_and_found() {
    let mut editor = Editor::new("imported", &[]);
    for folder in ["fleet", "robots"] {
        fs::create_dir(editor.folder.join(folder)).unwrap();
    }
    let write = |name: &str, text: &str| fs::write(editor.folder.join(name), text).unwrap();
    let described = |inside: &str| format!("<contribution xmlns=\"{SCA}\">{inside}</contribution>");
    write("fleet/sca-contribution.xml", &described("<import namespace=\"urn:robots\"/>"));
    write("robots/sca-contribution.xml", &described("<export namespace=\"urn:robots\"/>"));
    let world = "<component name=\"W\"><implementation.rust class=\"saoms.World\"/><property name=\"ID\">W</property><property name=\"period\">1s</property></component>";
    let inner = format!(
        "<composite xmlns=\"{SCA}\" name=\"hall\" targetNamespace=\"urn:robots\">\n<service name=\"floor\" promote=\"W/hardware\"/>\n<property name=\"size\">3</property>\n{world}</composite>"
    );
    write("robots/hall.composite", &inner);
    write("robots/own.composite", &inner.replace("\"hall\"", "\"own\"").replace("urn:robots", "urn:inside"));
    let fleet = format!(
        "<composite xmlns=\"{SCA}\" xmlns:r=\"urn:robots\" name=\"fleet\" targetNamespace=\"urn:fleet\">\n<component name=\"Hall\"><implementation.composite name=\"r:hall\"/>\n<property name=\"size\">4</property></component>\n<component name=\"R1\"><implementation.rust class=\"saoms.Robot\"/><property name=\"ID\">R1</property><property name=\"period\">1s</property>\n<reference name=\"world\" target=\"Hall/floor\"/></component></composite>"
    );
    write("fleet/fleet.composite", &fleet);
    editor.ask("initialize", json!({ "capabilities": {} }));
    editor.tell("initialized", json!({}));
    editor.open("fleet/fleet.composite", &fleet);
    editor.wait_for("fleet/fleet.composite", |all| !all.iter().any(|one| one.starts_with("S20")));
    let uri = editor.uri("fleet/fleet.composite");
    let at = |line: u32, text: &str| {
        let column = fleet.lines().nth(line as usize).unwrap().find(text).unwrap();
        json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": column } })
    };
    // The name of the composite, its property and its service.
    let defined = |editor: &mut Editor, place: Value| {
        let found = editor.ask("textDocument/definition", place);
        let first = &found["result"][0];
        assert_eq!(first["uri"], editor.uri("robots/hall.composite"), "{found}");
        first["range"]["start"]["line"].as_i64().unwrap()
    };
    assert_eq!(defined(&mut editor, at(1, "r:hall")), 0);
    assert_eq!(defined(&mut editor, at(2, "size")), 2);
    assert_eq!(defined(&mut editor, at(4, "floor")), 1);
    let hover = editor.ask("textDocument/hover", at(2, "size"));
    assert!(hover["result"]["contents"]["value"].as_str().unwrap().contains("size"), "{hover}");
    assert_eq!(
        labels(&editor.ask("textDocument/completion", at(1, "r:hall"))),
        ["r:hall"],
        "what is exported"
    );
    assert_eq!(labels(&editor.ask("textDocument/completion", at(2, "size"))), ["size"]);
    assert_eq!(labels(&editor.ask("textDocument/completion", at(4, "floor"))), ["floor"]);
    // Who else uses it is not known here.
    let mut rename = at(2, "size");
    rename["newName"] = json!("width");
    let refused = editor.ask("textDocument/rename", rename);
    assert!(refused["error"]["message"].as_str().unwrap().contains("another contribution"), "{refused}");
    assert_eq!(editor.end(), 0);
}
