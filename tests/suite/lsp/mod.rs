//! The language server as an editor meets it: a real process, spoken to over its standard input and output.

mod beside;
mod disk;
mod editor;
mod hostile;
mod imported;
mod random;

use std::fs;

use serde_json::{Value, json};

use editor::Editor;

const OUTER: &str = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"outer\" targetNamespace=\"urn:f\" xmlns:tns=\"urn:f\">
  <include name=\"tns:inner\"/>
</composite>
";
const INNER: &str = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"inner\" targetNamespace=\"urn:f\">
  <component name=\"GPS\"><implementation.java class=\"resources.robotEnvironment.GPS\"/></component><!-- 🤖ü --><component name=\"Gps\"/>
</composite>
";

#[test]
fn diagnostics_follow_what_is_typed_in_every_file() {
    let mut editor = Editor::started("diagnostics", &[("outer.composite", OUTER), ("inner.composite", INNER)]);
    editor.open("outer.composite", OUTER);
    // Columns are in UTF-16 units: the robot is two, the umlaut one.
    let column = INNER.lines().nth(1).unwrap().split("<component name=\"Gps\"").next().unwrap();
    let column = column.encode_utf16().count() + 1;
    editor.wait_for("inner.composite", |all| all == [format!("S1010 1:{column}")]);
    // What is not saved counts, and what is mended is taken back.
    editor.open("inner.composite", INNER);
    let end = json!({ "line": 1, "character": column + 22 });
    let start = json!({ "line": 1, "character": column - 1 });
    editor.change("inner.composite", 2, json!([{ "range": { "start": start, "end": end }, "text": "" }]));
    editor.wait_for("inner.composite", <[String]>::is_empty);
    // Text that is no XML is reported, too, with what can be written there.
    editor.change(
        "outer.composite",
        2,
        json!([{ "text": "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"o\"><inc" }]),
    );
    editor.wait_for("outer.composite", |all| all.iter().any(|one| one.starts_with("S01")));
    let position = json!({ "line": 0, "character": 83 });
    let asked = json!({ "textDocument": { "uri": editor.uri("outer.composite") }, "position": position });
    let answer = editor.ask("textDocument/completion", asked);
    let labels: Vec<&str> =
        answer["result"]["items"].as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap()).collect();
    assert!(labels.contains(&"include"), "{labels:?}");
    let uri = editor.uri("outer.composite");
    editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
    // What is closed is as it is on disk.
    editor.wait_for("outer.composite", <[String]>::is_empty);
    assert_eq!(editor.end(), 0);
}

#[test]
fn what_is_malformed_or_unknown_is_answered() {
    let mut editor = Editor::new("malformed", &[]);
    assert_eq!(editor.ask("textDocument/hover", json!({}))["error"]["code"], -32002, "not initialized");
    editor.raw("{nonsense");
    let answer = editor.receive();
    assert_eq!((&answer["error"]["code"], &answer["id"]), (&json!(-32700), &Value::Null));
    editor.ask("initialize", json!({ "capabilities": 3 }));
    assert_eq!(editor.ask("initialize", json!({}))["error"]["code"], -32600, "a second time");
    assert_eq!(editor.ask("textDocument/nonsense", json!({}))["error"]["code"], -32601);
    assert_eq!(editor.ask("textDocument/completion", json!({ "position": 3 }))["error"]["code"], -32602);
    editor.tell("textDocument/didOpen", json!([1]));
    editor.tell("$/nonsense", json!(null));
    let nowhere = json!({ "textDocument": { "uri": "untitled:1" }, "position": { "line": 0, "character": 0 } });
    assert_eq!(editor.ask("textDocument/completion", nowhere)["error"]["code"], -32602);
    assert_eq!(editor.ask("shutdown", Value::Null)["result"], Value::Null);
    assert_eq!(editor.ask("textDocument/hover", json!({}))["error"]["code"], -32600, "shut down");
    editor.tell("exit", Value::Null);
    assert_eq!(editor.server.wait().unwrap().code(), Some(0));
}

#[test]
fn a_session_that_is_not_shut_down_fails() {
    let mut editor = Editor::started("exit", &[]);
    editor.tell("exit", Value::Null);
    assert_eq!(editor.server.wait().unwrap().code(), Some(1));
    let mut editor = Editor::started("gone", &[]);
    drop(editor.input.take());
    assert_eq!(editor.server.wait().unwrap().code(), Some(1));
}

/// A composite of 1.1 with this inside.
fn composite(inside: &str) -> String {
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"fleet\" targetNamespace=\"urn:f\">\n{inside}\n</composite>\n"
    )
}

#[test]
fn plugins_complete_and_explain_as_what_is_linked_in() {
    let text = composite(
        "<component name=\"G\">\n<implementation.rust class=\"hello.Greeter\"/>\n<property name=\"ID\">G</property>\n<property name=\"period\">1s</property>\n<property name=\"nam\">x</property>\n</component>",
    );
    let mut editor = Editor::new("plugin", &[("fleet.composite", &text)]);
    let library = std::env::current_exe().unwrap().with_file_name("libsaoms_hello.so");
    fs::create_dir(editor.folder.join("plugins")).unwrap();
    std::os::unix::fs::symlink(library, editor.folder.join("plugins/libhello.so")).unwrap();
    editor.ask("initialize", json!({ "capabilities": {} }));
    editor.tell("initialized", json!({}));
    editor.open("fleet.composite", &text);
    editor.wait_for("fleet.composite", |all| all == ["S3004 5:16"]);
    let at = |line: u32, character: u32| json!({ "textDocument": { "uri": editor.uri("fleet.composite") }, "position": { "line": line, "character": character } });
    let (class, name) = (at(2, 35), at(5, 18));
    let hover = editor.ask("textDocument/hover", class);
    let said = hover["result"]["contents"]["value"].as_str().unwrap();
    assert!(said.contains("logs a greeting") && said.contains("libhello.so"), "{said}");
    let proposed = editor.ask("textDocument/completion", name);
    let items = proposed["result"]["items"].as_array().unwrap();
    let own = items.iter().find(|item| item["label"] == "name").unwrap();
    assert_eq!(own["detail"], "a text, default `world`");
    assert!(own["documentation"]["value"].as_str().unwrap().contains("Name to greet."));
    assert_eq!(editor.end(), 0);
}

#[test]
fn what_is_wrong_is_mended_and_names_are_changed_in_all_files() {
    let text = composite(
        "  <component name=\"Rob\"><implementation.java class=\"saoms.Robto\"/></component>\n  <wire source=\"Rob/world\" target=\"Wrld\"/>",
    );
    let outer = composite("  <include name=\"fleet\"/>").replace("name=\"fleet\" t", "name=\"outer\" t");
    let mut editor = Editor::started("mend", &[("fleet.composite", &text), ("outer.composite", &outer)]);
    editor.open("fleet.composite", &text);
    editor.wait_for("fleet.composite", |all| all.iter().any(|one| one == "S3001 1:52"));
    let document = json!({ "uri": editor.uri("fleet.composite") });
    let range = json!({ "start": { "line": 1, "character": 54 }, "end": { "line": 1, "character": 54 } });
    let asked = json!({ "textDocument": document, "range": range, "context": { "diagnostics": [] } });
    let fixes = editor.ask("textDocument/codeAction", asked);
    let fix = &fixes["result"][0];
    assert_eq!(fix["title"], "Replace `saoms.Robto` with `saoms.Robot`");
    assert_eq!(fix["edit"]["changes"][editor.uri("fleet.composite")][0]["newText"], "saoms.Robot");
    let position = json!({ "line": 2, "character": 17 });
    let renamed = json!({ "textDocument": document, "position": position, "newName": "Robot" });
    let answer = editor.ask("textDocument/rename", renamed);
    assert_eq!(answer["result"]["changes"][editor.uri("fleet.composite")].as_array().unwrap().len(), 2);
    let refused = json!({ "textDocument": document, "position": position, "newName": "a/b" });
    assert_eq!(editor.ask("textDocument/rename", refused)["error"]["code"], -32803);
    // The layout is that of `saoms fmt`.
    editor.change("fleet.composite", 2, json!([{ "text": text.replace("  <wire", "<wire") }]));
    let options = json!({ "tabSize": 8, "insertSpaces": false });
    let formatted = editor.ask("textDocument/formatting", json!({ "textDocument": document, "options": options }));
    let laid_out = formatted["result"][0]["newText"].as_str().unwrap();
    assert!(laid_out.contains("\n  <wire source"), "{laid_out}");
    assert_eq!(editor.end(), 0);
}

#[test]
fn what_is_no_fault_here_is_allowed_with_a_reason_and_all_is_mended_at_once() {
    let text = composite(
        "  <component name=\"A\"><implementation.java class=\"saoms.Robto\"/></component>\n  <component name=\"B\" autowrie=\"true\"><implementation.java class=\"saoms.Master\"/></component>",
    );
    let mut editor = Editor::started("allow", &[("fleet.composite", &text)]);
    editor.open("fleet.composite", &text);
    editor.wait_for("fleet.composite", |all| all.len() == 3);
    let document = json!({ "uri": editor.uri("fleet.composite") });
    let mut actions = |line: u32, only: Value| {
        let range = json!({ "start": { "line": line, "character": 0 }, "end": { "line": line + 1, "character": 0 } });
        let context = json!({ "diagnostics": [], "only": only });
        let asked = json!({ "textDocument": document, "range": range, "context": context });
        let all = editor.ask("textDocument/codeAction", asked);
        all["result"].as_array().unwrap().clone()
    };
    let all = actions(2, json!(["quickfix"]));
    let titles: Vec<&str> = all.iter().map(|one| one["title"].as_str().unwrap()).collect();
    assert!(titles.contains(&"Allow S1007 in component `B`, with a reason"), "{titles:?}");
    assert!(titles.contains(&"Allow S1007 in this composite, with a reason"), "{titles:?}");
    // What cannot run is no matter of judgement.
    assert!(titles.iter().all(|title| !title.contains("S3001")), "{titles:?}");
    assert_eq!(actions(2, json!(["refactor"])), [json!(null); 0]);
    let all = actions(0, json!(["source"]));
    assert_eq!(all[0]["kind"], "source.fixAll");
    let uri = document["uri"].as_str().unwrap();
    assert_eq!(all[0]["edit"]["changes"][uri].as_array().unwrap().len(), 2, "of the third one, several names are near");
    assert_eq!(editor.end(), 0);
}

#[test]
fn one_fault_is_mended_where_all_are_asked_for() {
    let text =
        composite("  <component name=\"B\" autowrie=\"true\"><implementation.java class=\"saoms.World\"/></component>");
    let mut editor = Editor::started("one", &[("fleet.composite", &text)]);
    editor.open("fleet.composite", &text);
    editor.wait_for("fleet.composite", |all| all.iter().any(|one| one.contains("S1007")));
    let uri = editor.uri("fleet.composite");
    let mut kinds = |only: Value| -> Vec<String> {
        let start = json!({ "line": 0, "character": 0 });
        let asked = json!({ "textDocument": { "uri": uri }, "range": { "start": start, "end": start }, "context": { "diagnostics": [], "only": only } });
        let all = editor.ask("textDocument/codeAction", asked);
        let all = all["result"].as_array().unwrap().clone();
        all.iter().map(|one| one["kind"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(kinds(json!(["source.fixAll"])), ["source.fixAll"]);
    assert_eq!(kinds(json!(null)), [""; 0]);
    assert_eq!(editor.end(), 0);
}

#[test]
fn composites_and_components_of_all_files_are_found_by_name() {
    let mut editor = Editor::new("symbols", &[("inner.composite", INNER), ("outer.composite", OUTER)]);
    let folder = editor.uri("").trim_end_matches('/').to_owned();
    let folders = json!([{ "uri": folder, "name": "symbols" }]);
    editor.ask("initialize", json!({ "capabilities": {}, "workspaceFolders": folders }));
    editor.tell("initialized", json!({}));
    let mut found = |query: &str| -> Vec<String> {
        let answer = editor.ask("workspace/symbol", json!({ "query": query }));
        let all = answer["result"].as_array().unwrap().iter();
        all.map(|one| format!("{} in {}", one["name"].as_str().unwrap(), one["containerName"].as_str().unwrap()))
            .collect()
    };
    assert_eq!(found("gps"), ["GPS in inner", "Gps in inner"]);
    assert_eq!(found("outr"), ["outer in urn:f"]);
    assert_eq!(found("").len(), 4);
    assert_eq!(found("nothing"), [""; 0]);
    assert_eq!(editor.end(), 0);
}

#[test]
fn what_opens_something_asks_for_proposals() {
    let mut editor = Editor::new("triggers", &[]);
    let answer = editor.ask("initialize", json!({ "capabilities": {} }));
    let triggers = answer["result"]["capabilities"]["completionProvider"]["triggerCharacters"].clone();
    editor.tell("initialized", json!({}));
    // Each of these texts ends with what opens a place where something can be proposed.
    let robot = "<component name=\"R${index}\" s:count=\"2\"><implementation.rust class=\"saoms.Robot\"/>";
    let after = ["<", "</", "<reference ", "<property name=\"", "<property name='", "<property name=\"ID\">${"];
    for opening in after {
        let text =
            composite(&format!("{robot}{opening}")).replace("name=\"fleet\"", "xmlns:s=\"urn:saoms:1\" name=\"fleet\"");
        let column = robot.len() + opening.len();
        editor.open("fleet.composite", &text);
        let place = json!({ "textDocument": { "uri": editor.uri("fleet.composite") }, "position": { "line": 1, "character": column } });
        let found = editor.ask("textDocument/completion", place);
        assert!(!found["result"]["items"].as_array().unwrap().is_empty(), "{text}");
        let last = &opening[opening.len() - 1..];
        assert!(triggers.as_array().unwrap().iter().any(|one| one == last), "{last} in {triggers}");
        let uri = editor.uri("fleet.composite");
        editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
    }
    assert_eq!(editor.end(), 0);
}

#[test]
fn both_tags_of_an_element_are_typed_as_one() {
    let text = composite("<component name=\"A\"></component><wire source=\"A\"/>");
    let mut editor = Editor::started("linked", &[]);
    editor.open("fleet.composite", &text);
    let mut linked = |character: u32| {
        let at = json!({ "textDocument": { "uri": editor.uri("fleet.composite") }, "position": { "line": 1, "character": character } });
        editor.ask("textDocument/linkedEditingRange", at)["result"]["ranges"].clone()
    };
    let both = linked(3);
    assert_eq!(both, linked(26));
    assert_eq!((&both[0]["start"]["character"], &both[1]["start"]["character"]), (&json!(1), &json!(22)));
    assert_eq!(linked(38), Value::Null, "it has one tag");
    assert_eq!(linked(15), Value::Null, "no name of a tag");
    assert_eq!(editor.end(), 0);
}

#[test]
fn composites_are_checked_as_the_description_of_their_contribution_says() {
    let open = "<property name=\"size\" mustSupply=\"true\"/>\n<component name=\"GPS\"><implementation.java class=\"resources.robotEnvironment.GPS\"/></component>";
    let (library, first) = (composite(open).replace("\"fleet\"", "\"library\""), composite(open));
    let second = first.replace("\"fleet\"", "\"second\"").replace(" mustSupply=\"true\"", "");
    let description = "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:f=\"urn:f\"><deployable composite=\"f:fleet\"/><deployable composite=\"f:second\"/></contribution>";
    let mut editor = Editor::started(
        "contribution",
        &[
            ("fleet.composite", &first),
            ("second.composite", &second),
            ("library.composite", &library),
            ("sca-contribution.xml", description),
        ],
    );
    editor.open("fleet.composite", &first);
    editor.open("library.composite", &library);
    // Both deployables have a component of one name, and the value that is missing in what is only used by others is
    // theirs.
    let mut shown = std::collections::BTreeMap::new();
    while shown.len() < 3 {
        let message = editor.receive();
        let uri = message["params"]["uri"].as_str().unwrap_or_default().to_owned();
        if let Some(all) = message["params"]["diagnostics"].as_array() {
            let mut codes: Vec<&str> = all.iter().map(|one| one["code"].as_str().unwrap()).collect();
            codes.sort_unstable();
            shown.insert(uri.rsplit('/').next().unwrap().to_owned(), codes.join(" "));
        }
    }
    let expected =
        [("fleet.composite", "S2025 S2026"), ("library.composite", "S2026"), ("second.composite", "S2002 S2026")];
    assert_eq!(shown, expected.map(|(name, codes)| (name.to_owned(), codes.to_owned())).into());
    assert_eq!(editor.end(), 0);
}

#[test]
fn a_text_without_a_file_is_checked_and_completed() {
    let mut editor = Editor::started("untitled", &[]);
    let text = composite("<wrie/>");
    let uri = "untitled:Untitled-1";
    let document = json!({ "uri": uri, "languageId": "saoms", "version": 1, "text": text });
    editor.tell("textDocument/didOpen", json!({ "textDocument": document }));
    loop {
        let message = editor.receive();
        if message["params"]["uri"] == uri {
            let all = message["params"]["diagnostics"].as_array().unwrap();
            assert!(all.iter().any(|one| one["range"]["start"]["line"] == 1), "{all:?}");
            break;
        }
    }
    let position = json!({ "line": 1, "character": 3 });
    let answer = editor.ask("textDocument/completion", json!({ "textDocument": { "uri": uri }, "position": position }));
    assert_eq!(answer["result"]["items"][0]["label"], "wire");
    assert_eq!(editor.end(), 0);
}

#[test]
fn files_outside_the_folder_are_not_read() {
    let text = OUTER.replace(
        "<include name=\"tns:inner\"/>",
        "<component name=\"R\"><implementation.rust class=\"saoms.Robot\"/><property name=\"battery\" file=\"/etc/hostname\"/></component>",
    );
    let mut editor = Editor::started("outside", &[("outer.composite", &text)]);
    editor.open("outer.composite", &text);
    editor.wait_for("outer.composite", |all| all.iter().any(|one| one.starts_with("S0009")));
    assert_eq!(editor.end(), 0);
}
