//! Whatever an editor sends, it is answered, and the session goes on.

use proptest::prelude::*;
use serde_json::{Value, json};

use super::composite;
use super::editor::Editor;

/// The requests about a document, with all parameters that any of them takes.
const REQUESTS: [&str; 14] = [
    "hover", "completion", "definition", "references", "documentHighlight", "prepareRename", "rename",
    "documentSymbol", "linkedEditingRange", "codeAction", "foldingRange", "selectionRange", "documentLink",
    "formatting",
];

fn about(uri: &str, line: u32, character: u32) -> Value {
    let place = json!({ "line": line, "character": character });
    json!({
        "textDocument": { "uri": uri },
        "position": place,
        "positions": [place],
        "range": { "start": place, "end": place },
        "context": { "includeDeclaration": true, "diagnostics": [] },
        "newName": "other",
        "options": { "tabSize": 2, "insertSpaces": true },
    })
}

/// Asks everything about a place; each request has an answer, or a refusal that is no fault of the server.
fn ask_all(editor: &mut Editor, uri: &str, line: u32, character: u32) {
    for method in REQUESTS {
        let mut params = about(uri, line, character);
        if method == "completion" {
            params["context"] = json!({ "triggerKind": 1 });
        }
        let answer = editor.ask(&format!("textDocument/{method}"), params);
        let code = answer["error"]["code"].as_i64();
        // Invalid parameters, and a name that cannot be changed.
        assert!(matches!(code, None | Some(-32602 | -32803)), "{method} at {line}:{character} of {uri}: {answer}");
    }
}

/// A fleet with names, wires, expressions and characters of one to four bytes.
fn fleet() -> String {
    composite(
        "<!-- ü🤖 --><property name=\"ü\" type=\"xsd:int\">2</property>\r\n<component name=\"R🤖${index:03}\" \
         s:count=\"2 * ü\"><implementation.rust class=\"saoms.Robot\"/><property name=\"ID\" value=\"🤖\"/>\
         <property name=\"period\" source=\"$ü\"/></component>\r<component name=\"W\"><implementation.rust \
         class=\"saoms.World\"/></component>\n<wire source=\"🤖/x\" target=\"W\"/>",
    )
}

#[test]
fn malformed_messages_are_answered_and_the_session_goes_on() {
    let mut editor = Editor::started("malformed", &[]);
    let uri = editor.uri("fleet.composite");
    editor.open("fleet.composite", &fleet());
    let malformed = [
        "{",
        "[]",
        "null",
        "\u{feff}{}",
        "{\"jsonrpc\":\"2.0\",\"id\":{},\"method\":\"textDocument/hover\"}",
        "{\"jsonrpc\":\"2.0\",\"id\":null,\"method\":\"textDocument/hover\"}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"textDocument/didOpen\"}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"textDocument/didOpen\",\"params\":[[]]}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"textDocument/didChange\",\"params\":{\"textDocument\":7}}",
        "{\"jsonrpc\":\"2.0\",\"method\":\"workspace/didChangeWorkspaceFolders\",\"params\":{\"event\":{}}}",
        "{\"jsonrpc\":\"2.0\",\"id\":99999999999999,\"method\":\"textDocument/hover\"}",
        "{\"jsonrpc\":\"2.0\",\"id\":5,\"result\":{\"a\":[1]}}",
        &"[".repeat(100_000),
        &format!("{{\"id\":1,\"method\":\"x\",\"params\":{}{}}}", "{\"a\":".repeat(500), "}".repeat(500)),
    ];
    malformed.iter().for_each(|one| editor.raw(one));
    for method in REQUESTS {
        let method = format!("textDocument/{method}");
        for params in [Value::Null, json!([]), json!({}), json!({ "textDocument": { "uri": 1 } })] {
            assert_eq!(editor.ask(&method, params)["error"]["code"], -32602, "{method}");
        }
        let negative = json!({ "line": -1, "character": 1.5 });
        let mut params = about(&uri, 0, 0);
        (params["position"], params["positions"], params["range"]) = (negative.clone(), json!([negative]), negative);
        editor.ask(&method, params);
    }
    assert!(editor.ask("textDocument/hover", about(&uri, 0, 3))["result"].is_object());
    assert_eq!(editor.end(), 0);
}

#[test]
fn any_uri_is_a_document() {
    let mut editor = Editor::started("uris", &[]);
    let folder = editor.uri("").trim_end_matches('/').to_owned();
    let text = fleet();
    for uri in [
        format!("{folder}/none/../fleet.composite"),
        format!("{folder}/none/.."),
        format!("{folder}/%2e%2e/%2E"),
        format!("{folder}/%ff%fe.composite"),
        format!("{folder}/%c3/fleet.composite"),
        format!("{folder}/%00.composite"),
        format!("{folder}/?a#b"),
        format!("{}/x.composite", folder.replace("file:", "FILE:")),
        "file:///..".to_owned(),
        "file:///".to_owned(),
        "file://".to_owned(),
        "file:".to_owned(),
        "untitled:..".to_owned(),
        "untitled:%ff/..".to_owned(),
        "..".to_owned(),
        ".".to_owned(),
        "/".to_owned(),
        String::new(),
    ] {
        editor.open_uri(&uri, &text);
        assert!(!editor.diagnostics_of_uri(&uri).is_empty(), "{uri}");
        let hover = editor.ask("textDocument/hover", about(&uri, 0, 3));
        assert!(hover["result"].is_object(), "{uri}: {hover}");
        ask_all(&mut editor, &uri, 1, 30);
        editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
    }
    assert_eq!(editor.end(), 0);
}

#[test]
fn deep_and_long_texts_are_answered() {
    let nested = |open: &str, close: &str| composite(&format!("{}{}", open.repeat(20_000), close.repeat(20_000)));
    let robot = |given: String| {
        composite(&format!(
            "<!-- ü🤖 --><component name=\"R\"><implementation.java class=\"saoms.Robot\"/>{given}</component>"
        ))
    };
    let mut editor = Editor::started("deep-and-long", &[]);
    for (place, text) in [
        nested("<ä>", "</ä>"),
        nested("<component name=\"R\">", "</component>"),
        nested("<component name=\"R\">", ""),
        robot(format!("<reference name=\"world\" target=\"{}\"/>", "W🤖 ".repeat(10_000))),
        robot(format!("<property name=\"ID\" source=\"{}\"/>", "$x/ü[b='c']".repeat(10_000))),
    ]
    .into_iter()
    .enumerate()
    {
        let uri = editor.uri(&format!("{place}.composite"));
        editor.open_uri(&uri, &text);
        assert!(!editor.diagnostics_of_uri(&uri).is_empty());
        let lines: Vec<&str> = text.lines().collect();
        let (line, longest) = lines.iter().enumerate().max_by_key(|(_, one)| one.len()).unwrap();
        let end = longest.encode_utf16().count() as u32;
        for column in [end / 3, end / 2, end - 20] {
            ask_all(&mut editor, &uri, line as u32, column);
        }
        editor.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri } }));
    }
    assert_eq!(editor.end(), 0);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_uri_and_any_position_is_answered(
        uris in prop::collection::vec(
            "(file:|untitled:|FILE://h|)(/|\\.|\\.\\.|%2e|%ff|%C3%BC|%00|%|a|b\\.composite|\\?|#|\\[|::1|\\]|@|:|ü| |[!-~]){0,8}",
            1..4,
        ),
        places in prop::collection::vec((prop_oneof![0u32..6, any::<u32>()], prop_oneof![0u32..400, any::<u32>()]), 1..4),
    ) {
        let mut editor = Editor::started("any", &[]);
        let folder = editor.uri("").trim_end_matches('/').to_owned();
        // Those with a folder are beside this test.
        let uris = uris.iter().map(|uri| uri.strip_prefix("file:").map_or(uri.clone(), |path| format!("{folder}/a/b/c/{path}")));
        for uri in uris {
            let uri = uri.as_str();
            editor.open_uri(uri, &fleet());
            for &(line, character) in &places {
                ask_all(&mut editor, uri, line, character);
                let place = json!({ "line": line, "character": character });
                let change = json!({ "range": { "start": place, "end": { "line": character, "character": line } }, "text": "<" });
                let document = json!({ "uri": uri, "version": 2 });
                editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [change] }));
            }
        }
        assert_eq!(editor.end(), 0);
    }
}
