//! Files beside composites, open in an editor.

use serde_json::json;

use super::composite;
use super::editor::Editor;

const TABLE: &str = "index,battery\n2,50\n";
const DESCRIPTION: &str = "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:f=\"urn:f\">\n<deployable composite=\"f:fleet\"/>\n</contribution>\n";

fn fleet() -> String {
    composite(
        "<component xmlns:s=\"urn:saoms:1\" name=\"R${index}\" s:count=\"2\" s:overrides=\"r.csv\"><implementation.rust class=\"saoms.Robot\"/>\n<property name=\"ID\">R${index}</property>\n<property name=\"period\">1s</property></component>",
    )
}

#[test]
fn tables_are_checked_as_part_of_the_composites_that_read_them() {
    let mut editor = Editor::started("table", &[("fleet.composite", &fleet()), ("r.csv", TABLE)]);
    editor.open("r.csv", TABLE);
    editor.wait_for("r.csv", <[String]>::is_empty);
    // What is not saved counts.
    let place = |line: u32, character: u32| json!({ "line": line, "character": character });
    let number = json!({ "start": place(1, 2), "end": place(1, 4) });
    editor.change("r.csv", 2, json!([{ "range": number, "text": "5000" }]));
    editor.wait_for("r.csv", |all| all == ["S3008 1:2"]);
    let at = json!({ "textDocument": { "uri": editor.uri("r.csv") }, "position": place(0, 8) });
    let hover = editor.ask("textDocument/hover", at.clone());
    let said = hover["result"]["contents"]["value"].as_str().unwrap();
    assert!(said.contains("[%]"), "{said}");
    let proposed = editor.ask("textDocument/completion", at);
    assert_eq!(proposed["result"]["items"][0]["label"], "battery");
    assert_eq!(editor.end(), 0);
}

#[test]
fn files_that_no_composite_reads_are_nobodys_fault() {
    let mut editor = Editor::started("stranger", &[("fleet.composite", &fleet()), ("r.csv", TABLE)]);
    editor.open("shopping.csv", "milk,bread\n1\n");
    editor.open("notes.txt", "<at 6s");
    editor.wait_for("notes.txt", <[String]>::is_empty);
    let at = json!({ "textDocument": { "uri": editor.uri("notes.txt") }, "position": { "line": 0, "character": 6 } });
    assert_eq!(editor.ask("textDocument/completion", at)["result"]["items"], json!([]));
    assert_eq!(editor.end(), 0);
}

#[test]
fn descriptions_are_checked_with_what_they_deploy() {
    let files =
        [("fleet.composite", fleet()), ("r.csv", TABLE.to_owned()), ("sca-contribution.xml", DESCRIPTION.to_owned())];
    let files = files.each_ref().map(|(name, text)| (*name, text.as_str()));
    let mut editor = Editor::started("description", &files);
    editor.open("sca-contribution.xml", DESCRIPTION);
    editor.wait_for("sca-contribution.xml", <[String]>::is_empty);
    let wrong = DESCRIPTION.replace("f:fleet", "f:flet");
    editor.change("sca-contribution.xml", 2, json!([{ "text": wrong }]));
    editor.wait_for("sca-contribution.xml", |all| all == ["S2051 1:23"]);
    assert_eq!(editor.end(), 0);
}
