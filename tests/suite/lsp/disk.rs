//! Files that come, go and move, with their line ends and marks, while an editor has some of them open.

use std::fs;

use serde_json::{Value, json};

use super::editor::Editor;
use super::{INNER, OUTER, composite};

fn watched(editor: &mut Editor, name: &str, change: u8) {
    let event = json!({ "uri": editor.uri(name), "type": change });
    editor.tell("workspace/didChangeWatchedFiles", json!({ "changes": [event] }));
}

#[test]
fn what_is_deleted_and_made_again_is_noticed() {
    let mut editor = Editor::started("deleted", &[("outer.composite", OUTER), ("inner.composite", INNER)]);
    editor.open("outer.composite", OUTER);
    editor.wait_for("inner.composite", |all| all.len() == 1);
    fs::remove_file(editor.folder.join("inner.composite")).unwrap();
    watched(&mut editor, "inner.composite", 3);
    // The include is unresolved.
    editor.wait_for("outer.composite", |all| all.len() == 1 && all[0].ends_with(" 1:17"));
    fs::write(editor.folder.join("inner.composite"), INNER).unwrap();
    watched(&mut editor, "inner.composite", 1);
    editor.wait_for("outer.composite", <[String]>::is_empty);
    assert_eq!(editor.end(), 0);
}

#[test]
fn an_include_that_is_not_saved_yet_counts() {
    let mut editor = Editor::started("unsaved", &[("outer.composite", OUTER)]);
    editor.open("outer.composite", OUTER);
    editor.wait_for("outer.composite", |all| all.len() == 1);
    let inner = INNER.replace("<component name=\"Gps\"/>", "");
    editor.open("inner.composite", &inner);
    editor.wait_for("outer.composite", <[String]>::is_empty);
    let place = json!({ "line": 1, "character": 19 });
    let at = json!({ "textDocument": { "uri": editor.uri("outer.composite") }, "position": place });
    let found = editor.ask("textDocument/definition", at);
    assert_eq!(found["result"][0]["uri"], editor.uri("inner.composite"));
    assert_eq!(editor.end(), 0);
}

#[test]
fn a_folder_that_is_renamed_takes_its_diagnostics_along() {
    let mut editor = Editor::started("renamed", &[]);
    let wrong = composite("<wire source=\"a\" target=\"b\"/>");
    fs::create_dir(editor.folder.join("old")).unwrap();
    fs::write(editor.folder.join("old/fleet.composite"), &wrong).unwrap();
    editor.open("old/fleet.composite", &wrong);
    editor.wait_for("old/fleet.composite", |all| !all.is_empty());
    let old = editor.uri("old/fleet.composite");
    fs::rename(editor.folder.join("old"), editor.folder.join("new")).unwrap();
    editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": old } }));
    editor.open("new/fleet.composite", &wrong);
    let (mut is_gone, mut is_there) = (false, false);
    while !(is_gone && is_there) {
        let message = editor.receive();
        let shown = &message["params"];
        let count = shown["diagnostics"].as_array().map_or(0, Vec::len);
        is_gone |= shown["uri"] == *old && count == 0;
        is_there |= shown["uri"].as_str().is_some_and(|uri| uri.contains("/new/")) && count > 0;
    }
    assert_eq!(editor.end(), 0);
}

#[test]
fn places_hold_with_any_line_ends_and_marks() {
    for (test, mark, end) in [("crlf", "", "\r\n"), ("cr", "", "\r"), ("mark", "\u{feff}", "\r\n")] {
        let inside = "<component name=\"🤖\"/> <wire source=\"🤖/r\" target=\"R\"/>";
        let text = format!("{mark}{}", composite(inside).replace('\n', end));
        let mut editor = Editor::started(test, &[]);
        editor.open("fleet.composite", &text);
        editor.wait_for("fleet.composite", |all| all.contains(&"S2011 1:51".to_owned()));
        // The robot is two units wide.
        let place = |character: u32| json!({ "line": 1, "character": character });
        let range = json!({ "start": place(51), "end": place(52) });
        editor.change("fleet.composite", 2, json!([{ "range": range, "text": "🤖" }]));
        editor.wait_for("fleet.composite", |all| !all.iter().any(|one| one.starts_with("S2011")));
        let document = json!({ "uri": editor.uri("fleet.composite") });
        let renamed = json!({ "textDocument": document, "position": place(53), "newName": "Ä" });
        let answer = editor.ask("textDocument/rename", renamed);
        let all = answer["result"]["changes"][editor.uri("fleet.composite")].as_array().unwrap().clone();
        let start = |one: &Value| one["range"]["start"]["character"].as_u64().unwrap();
        let mut starts: Vec<u64> = all.iter().map(start).collect();
        starts.sort_unstable();
        assert_eq!(starts, [17, 37, 51], "{test}");
        assert_eq!(editor.end(), 0);
    }
}

#[test]
fn what_is_cancelled_is_answered_once() {
    let mut editor = Editor::started("cancelled", &[]);
    editor.open("fleet.composite", &composite(""));
    let document = json!({ "uri": editor.uri("fleet.composite") });
    let at = json!({ "textDocument": document, "position": { "line": 1, "character": 0 } });
    let asked = json!({ "jsonrpc": "2.0", "id": "mine", "method": "textDocument/completion", "params": at });
    editor.raw(&asked.to_string());
    for id in [json!("mine"), json!("mine"), json!(77), Value::Null] {
        editor.tell("$/cancelRequest", json!({ "id": id }));
    }
    let first = loop {
        let message = editor.receive();
        if message["id"] == "mine" {
            break message;
        }
    };
    // In time, or too late.
    assert!(first["error"]["code"] == -32800 || first["result"].is_object(), "{first}");
    editor.raw(&json!({ "jsonrpc": "2.0", "id": "other", "method": "textDocument/documentSymbol", "params": { "textDocument": document } }).to_string());
    let next = loop {
        let message = editor.receive();
        if !message["id"].is_null() {
            break message;
        }
    };
    assert_eq!(next["id"], "other", "never both");
    assert_eq!(editor.end(), 0);
}
