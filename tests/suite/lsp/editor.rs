//! An editor that speaks to a server of its own.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::Duration;

use serde_json::{Value, json};

use crate::support::{command, empty_folder};

/// The longest wait for an answer before the test is given up: a server that hangs must not delay other tests.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) struct Editor {
    pub(crate) server: Child,
    pub(crate) input: Option<ChildStdin>,
    messages: Receiver<Value>,
    pub(crate) folder: PathBuf,
    next: i64,
}

fn read(output: &mut BufReader<ChildStdout>) -> Option<Value> {
    let mut length = 0;
    loop {
        let mut line = String::new();
        if output.read_line(&mut line).ok()? == 0 {
            return None;
        }
        if let Some(value) = line.strip_prefix("Content-Length: ") {
            length = value.trim().parse().unwrap();
        } else if line.trim().is_empty() {
            break;
        }
    }
    let mut bytes = vec![0; length];
    output.read_exact(&mut bytes).ok()?;
    Some(serde_json::from_slice(&bytes).unwrap())
}

impl Editor {
    /// A server in a folder with these files, not yet initialized.
    pub(crate) fn new(test: &str, files: &[(&str, &str)]) -> Self {
        let folder = empty_folder(&format!("lsp/{test}"));
        for (name, text) in files {
            fs::write(folder.join(name), text).unwrap();
        }
        let mut server =
            command(&["lsp"]).current_dir(&folder).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let mut output = BufReader::new(server.stdout.take().unwrap());
        let (sender, messages) = mpsc::channel();
        thread::spawn(move || {
            while let Some(message) = read(&mut output) {
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let input = server.stdin.take();
        Self { server, input, messages, folder, next: 0 }
    }

    pub(crate) fn started(test: &str, files: &[(&str, &str)]) -> Self {
        let mut editor = Self::new(test, files);
        let answer = editor.ask("initialize", json!({ "capabilities": {} }));
        assert_eq!(answer["result"]["serverInfo"]["name"], "saoms");
        editor.tell("initialized", json!({}));
        editor
    }

    pub(crate) fn uri(&self, name: &str) -> String {
        format!("file://{}/{name}", fs::canonicalize(&self.folder).unwrap().display())
    }

    pub(crate) fn raw(&mut self, text: &str) {
        let input = self.input.as_mut().unwrap();
        write!(input, "Content-Length: {}\r\n\r\n{text}", text.len()).unwrap();
        input.flush().unwrap();
    }

    pub(crate) fn tell(&mut self, method: &str, params: Value) {
        self.raw(&json!({ "jsonrpc": "2.0", "method": method, "params": params }).to_string());
    }

    pub(crate) fn receive(&self) -> Value {
        self.messages.recv_timeout(PATIENCE).unwrap()
    }

    /// Asks, and gives the answer; what comes before it is left out.
    pub(crate) fn ask(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = self.next;
        self.raw(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }).to_string());
        loop {
            let message = self.receive();
            if message["id"] == id {
                return message;
            }
        }
    }

    pub(crate) fn open(&mut self, name: &str, text: &str) {
        self.open_uri(&self.uri(name), text);
    }

    pub(crate) fn open_uri(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "saoms", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    pub(crate) fn change(&mut self, name: &str, version: i32, changes: Value) {
        let document = json!({ "uri": self.uri(name), "version": version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Waits until the diagnostics that are shown for a file, by their codes and places, are as they should be.
    pub(crate) fn wait_for(&self, name: &str, is_expected: impl Fn(&[String]) -> bool) {
        let uri = self.uri(name);
        let mut last = Vec::new();
        loop {
            let message = self.messages.recv_timeout(PATIENCE);
            let message = message.map_err(|_| format!("{name} was shown with {last:?} last")).unwrap();
            if message["method"] == "textDocument/publishDiagnostics" && message["params"]["uri"] == *uri {
                let all = message["params"]["diagnostics"].as_array().unwrap();
                last = all.iter().map(shown).collect::<Vec<String>>();
                if is_expected(&last) {
                    return;
                }
            }
        }
    }

    /// The next diagnostics that are shown of a document.
    pub(crate) fn diagnostics_of_uri(&self, uri: &str) -> Vec<Value> {
        loop {
            let shown = &self.receive()["params"];
            if shown["uri"] == uri
                && let Some(all) = shown["diagnostics"].as_array()
            {
                return all.clone();
            }
        }
    }

    /// The diagnostics of a file in this version.
    pub(crate) fn diagnostics_of(&self, name: &str, version: i32) -> Value {
        let uri = self.uri(name);
        loop {
            let mut message = self.receive();
            let shown = &mut message["params"];
            if shown["uri"] == *uri && shown["version"] == version {
                return shown["diagnostics"].take();
            }
        }
    }

    /// Ends the session; the exit code.
    pub(crate) fn end(mut self) -> i32 {
        assert_eq!(self.ask("shutdown", Value::Null)["result"], Value::Null);
        self.tell("exit", Value::Null);
        self.server.wait().unwrap().code().unwrap()
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        // A failed test leaves the session open.
        drop(self.input.take());
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn shown(diagnostic: &Value) -> String {
    let start = &diagnostic["range"]["start"];
    format!("{} {}:{}", diagnostic["code"].as_str().unwrap(), start["line"], start["character"])
}
