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
    assert_eq!(labels(&editor.ask("textDocument/completion", at(1, "r:hall"))), ["r:hall"], "what is exported");
    assert_eq!(labels(&editor.ask("textDocument/completion", at(2, "size"))), ["size"]);
    assert_eq!(labels(&editor.ask("textDocument/completion", at(4, "floor"))), ["floor"]);
    // Who else uses it is not known here.
    let mut rename = at(2, "size");
    rename["newName"] = json!("width");
    let refused = editor.ask("textDocument/rename", rename);
    assert!(refused["error"]["message"].as_str().unwrap().contains("another contribution"), "{refused}");
    // Where it is defined, all use of it is: that in contributions that import it as well.
    editor.open("robots/hall.composite", &inner);
    editor.wait_for("robots/hall.composite", |all| all == ["S2026 2:16"]);
    let hall = editor.uri("robots/hall.composite");
    let column = inner.lines().nth(2).unwrap().find("size").unwrap();
    let rename =
        json!({ "textDocument": { "uri": hall }, "position": { "line": 2, "character": column }, "newName": "width" });
    let edits = editor.ask("textDocument/rename", rename);
    let changes = edits["result"]["changes"].as_object().unwrap();
    let mut files: Vec<(String, usize)> =
        changes.iter().map(|(uri, edits)| (uri.clone(), edits.as_array().unwrap().len())).collect();
    files.sort();
    assert_eq!(files, [(uri.clone(), 1), (hall.clone(), 1)], "{edits}");
    // The composites there are none that this one can name.
    let naming = inner.replace("saoms.World", "").replace("implementation.rust class", "implementation.composite name");
    editor.change("robots/hall.composite", 2, json!([{ "text": naming }]));
    let column = naming.lines().nth(3).unwrap().find("name=\"\"").unwrap() + 6;
    let place = json!({ "textDocument": { "uri": hall }, "position": { "line": 3, "character": column } });
    let answer = editor.ask("textDocument/completion", place);
    assert!(!labels(&answer).iter().any(|one| one.contains("fleet")), "{answer}");
    assert_eq!(editor.end(), 0);
}
