//! A session without threads: all that happens is there from the start, in order.

use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::mpsc;

use lsp_server::{Message, Notification, Request};
use saoms_lang::source::OpenTexts;
use saoms_tools::editor::{CheckOptions, Checker, ClassCache, Workspace};
use serde_json::{Value, json};

use crate::Exit;
use crate::arguments::PluginArguments;
use crate::lsp::check::{Job, Outcome, check};
use crate::lsp::rpc::Incoming;
use crate::lsp::server::{Event, Server};
use crate::lsp::tests::composite;

const URI: &str = "file:///nowhere/fleet.composite";

fn ask(id: i32, method: &str, params: Value) -> Event {
    let request = Request { id: id.into(), method: method.to_owned(), params };
    Event::Incoming(Incoming::Message(Message::Request(request)))
}

fn notification(method: &str, params: Value) -> Event {
    let message = Notification { method: method.to_owned(), params };
    Event::Incoming(Incoming::Message(Message::Notification(message)))
}

fn open(text: &str) -> Event {
    let document = json!({ "uri": URI, "languageId": "saoms", "version": 1, "text": text });
    notification("textDocument/didOpen", json!({ "textDocument": document }))
}

fn change(version: i32, text: &str) -> Event {
    let document = json!({ "uri": URI, "version": version });
    notification("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [{ "text": text }] }))
}

fn fixes(id: i32) -> Event {
    let everywhere = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 99, "character": 0 } });
    let params = json!({ "textDocument": { "uri": URI }, "range": everywhere, "context": { "diagnostics": [] } });
    ask(id, "textDocument/codeAction", params)
}

fn classes() -> Arc<ClassCache> {
    Arc::new(ClassCache::new(PluginArguments { plugins: Vec::new() }))
}

/// The event of a check of this text.
fn checked(generation: u64, text: &str) -> Event {
    let mut checker = Checker::new(classes(), CheckOptions::default());
    let mut open = OpenTexts::default();
    let path = Path::new("/nowhere/fleet.composite");
    open.insert(path, text.to_owned());
    let outcomes = RefCell::new(Vec::new());
    let job = Job { generation, open, looks_anew: true };
    check(&mut checker, &job, &AtomicU64::new(generation), &|outcome| outcomes.borrow_mut().push(outcome));
    let outcome = outcomes.into_inner().pop().unwrap();
    Event::Checked(outcome)
}

/// The messages of the server to these events, a line each, and the end of the session.
fn session(events: Vec<Event>) -> (Vec<String>, Exit) {
    let (sender, receiver) = mpsc::channel();
    let (jobs, _asked) = mpsc::channel();
    let start = [ask(0, "initialize", json!({}))];
    start.into_iter().chain(events).for_each(|event| sender.send(event).unwrap());
    drop(sender);
    let mut output = Vec::new();
    let exit =
        Server::new(&mut output, Workspace::default(), classes(), jobs, Arc::new(AtomicU64::new(0))).run(&receiver);
    let output = String::from_utf8(output).unwrap();
    let all = output.split("Content-Length: ").skip(2);
    let said = all.map(|one| {
        let message: Value = serde_json::from_str(one.split_once("\r\n\r\n").unwrap().1).unwrap();
        match (message.get("id"), message.pointer("/params/diagnostics"), message.get("error")) {
            (Some(id), _, Some(error)) => format!("{id}: error {}", error["code"]),
            (Some(id), ..) => format!("{id}: {}", message["result"].as_array().map_or(0, Vec::len)),
            (None, Some(all), _) => {
                let codes: Vec<&str> =
                    all.as_array().unwrap().iter().map(|one| one["code"].as_str().unwrap()).collect();
                format!("shows {} of {}", codes.join(" "), message["params"]["version"])
            }
            _ => message.to_string(),
        }
    });
    (said.collect(), exit)
}

const WRONG: &str = "<component name=\"A\"><implementation.java class=\"saoms.Robto\"/></component>";
const RIGHT: &str = "<component name=\"A\"><implementation.java class=\"resources.robotEnvironment.GPS\"/></component>";

#[test]
fn fixes_are_those_of_the_text_as_it_is() {
    let (wrong, right) = (composite(WRONG), composite(RIGHT));
    let (said, exit) = session(vec![
        open(&wrong),
        fixes(1),
        checked(1, &wrong),
        fixes(2),
        change(2, &right),
        fixes(3),
        // It comes too late.
        checked(1, &wrong),
        checked(2, &right),
        ask(4, "shutdown", Value::Null),
        notification("exit", Value::Null),
    ]);
    assert_eq!(said, ["1: 0", "shows S3001 of 1", "2: 1", "3: 0", "shows  of 2", "4: 0"]);
    assert_eq!(exit, Exit::Done);
}

#[test]
fn what_was_shown_is_taken_back_when_its_file_is_closed() {
    let wrong = composite(WRONG);
    let nothing = Event::Checked(Outcome { generation: 2, files: std::collections::BTreeMap::new() });
    let (said, exit) = session(vec![
        open(&wrong),
        checked(1, &wrong),
        notification("textDocument/didClose", json!({ "textDocument": { "uri": URI } })),
        nothing,
        notification("exit", Value::Null),
    ]);
    assert_eq!(said, ["shows S3001 of 1", "shows  of null"]);
    assert_eq!(exit, Exit::Failed, "the session was not shut down");
}

#[test]
fn what_is_cancelled_in_time_is_not_answered() {
    let wrong = composite(WRONG);
    let (said, exit) = session(vec![
        open(&wrong),
        fixes(7),
        fixes(8),
        notification("$/cancelRequest", json!({ "id": 8 })),
        Event::Closed,
    ]);
    assert_eq!(said, ["7: 0", "8: error -32800"]);
    assert_eq!(exit, Exit::Failed);
}
