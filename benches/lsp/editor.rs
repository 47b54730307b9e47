//! An editor with one file open.

use std::env;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

use serde_json::{Value, json};

use crate::common::{Outcome, RESULTS};

pub(crate) struct Editor {
    server: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    uri: String,
    next: i32,
    opened: Instant,
}

impl Editor {
    /// Starts a server and opens a file with this text.
    pub(crate) fn open(text: &str) -> Outcome<Self> {
        let folder = Path::new(RESULTS).join("lsp");
        fs::create_dir_all(&folder)?;
        let file = env::current_dir()?.join(folder).join("fleet.composite");
        fs::write(&file, text)?;
        let mut server = Command::new(env!("CARGO_BIN_EXE_saoms"))
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let input = server.stdin.take().ok_or("no input")?;
        let output = BufReader::new(server.stdout.take().ok_or("no output")?);
        let uri = format!("file://{}", file.display());
        let mut editor = Self { server, input, output, uri, next: 0, opened: Instant::now() };
        editor.ask("initialize", &json!({ "capabilities": {} }))?;
        editor.tell("initialized", &json!({}))?;
        let document = json!({ "uri": editor.uri, "languageId": "saoms", "version": 0, "text": text });
        editor.opened = Instant::now();
        editor.tell("textDocument/didOpen", &json!({ "textDocument": document }))?;
        Ok(editor)
    }

    /// Waits for the first diagnostics; returns the time since the file was opened, in ms.
    pub(crate) fn diagnostics(&mut self) -> Outcome<f64> {
        while self.read()?["method"] != "textDocument/publishDiagnostics" {}
        Ok(milliseconds(self.opened))
    }

    /// Types `typed`, waits for the diagnostics of the new text, and undoes it; returns the time to the diagnostics, in
    /// ms.
    pub(crate) fn check(&mut self, text: &str, at: usize, typed: &str) -> Outcome<f64> {
        let (start, end) = places(text, at, typed.len());
        let begun = Instant::now();
        self.change(&start, &start, typed)?;
        self.shown()?;
        let took = milliseconds(begun);
        self.change(&start, &end, "")?;
        // The next check must not wait for this one.
        self.shown()?;
        Ok(took)
    }

    /// Waits for the diagnostics of the current text.
    fn shown(&mut self) -> Outcome<()> {
        let version = self.next;
        loop {
            let message = self.read()?;
            let is_shown = message["method"] == "textDocument/publishDiagnostics";
            if is_shown && message["params"]["version"] == version {
                return Ok(());
            }
        }
    }

    /// Sends a request about a position; returns the time until the response, in ms.
    pub(crate) fn question(&mut self, method: &str, text: &str, at: usize) -> Outcome<f64> {
        let (place, _) = places(text, at, 0);
        let document = json!({ "uri": self.uri });
        let context = json!({ "includeDeclaration": true });
        // Each request takes the parameters that it knows.
        let asked = json!({ "textDocument": document, "position": place, "newName": "Another", "context": context });
        let begun = Instant::now();
        let answer = self.ask(method, &asked)?;
        let took = milliseconds(begun);
        if answer["result"].is_null() {
            return Err(format!("{method} has no answer: {answer}").into());
        }
        Ok(took)
    }

    /// Types `typed`, requests completions, and undoes it; returns the time from typing to the response, in ms.
    pub(crate) fn complete(&mut self, text: &str, at: usize, typed: &str) -> Outcome<f64> {
        let (start, end) = places(text, at, typed.len());
        let begun = Instant::now();
        self.change(&start, &start, typed)?;
        let asked = json!({ "textDocument": { "uri": self.uri }, "position": end });
        let answer = self.ask("textDocument/completion", &asked)?;
        let took = milliseconds(begun);
        if answer["result"]["items"].as_array().is_none_or(Vec::is_empty) {
            return Err(format!("nothing can be written at {start}: {answer}").into());
        }
        self.change(&start, &end, "")?;
        Ok(took)
    }

    pub(crate) fn close(mut self) -> Outcome<()> {
        self.ask("shutdown", &Value::Null)?;
        self.tell("exit", &Value::Null)?;
        self.server.wait()?;
        Ok(())
    }

    fn change(&mut self, start: &Value, end: &Value, text: &str) -> Outcome<()> {
        self.next += 1;
        let change = json!({ "range": { "start": start, "end": end }, "text": text });
        let document = json!({ "uri": self.uri, "version": self.next });
        self.tell("textDocument/didChange", &json!({ "textDocument": document, "contentChanges": [change] }))
    }

    fn tell(&mut self, method: &str, params: &Value) -> Outcome<()> {
        self.write(&json!({ "jsonrpc": "2.0", "method": method, "params": params }))
    }

    fn ask(&mut self, method: &str, params: &Value) -> Outcome<Value> {
        self.next += 1;
        let id = self.next;
        self.write(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }))?;
        loop {
            let message = self.read()?;
            if message["id"] == id {
                return Ok(message);
            }
        }
    }

    fn write(&mut self, message: &Value) -> Outcome<()> {
        let text = message.to_string();
        write!(self.input, "Content-Length: {}\r\n\r\n{text}", text.len())?;
        Ok(self.input.flush()?)
    }

    fn read(&mut self) -> Outcome<Value> {
        let mut length = 0;
        loop {
            let mut line = String::new();
            if self.output.read_line(&mut line)? == 0 {
                return Err("the server is gone".into());
            }
            match line.strip_prefix("Content-Length: ") {
                Some(value) => length = value.trim().parse()?,
                None if line.trim().is_empty() => break,
                None => {}
            }
        }
        let mut bytes = vec![0; length];
        self.output.read_exact(&mut bytes)?;
        Ok(serde_json::from_slice(&bytes)?)
    }
}

/// A position in an ASCII text, and the position `length` characters after it.
fn places(text: &str, at: usize, length: usize) -> (Value, Value) {
    let before = &text[..at];
    let line = before.matches('\n').count();
    let column = at - before.rfind('\n').map_or(0, |found| found + 1);
    let place = |column: usize| json!({ "line": line, "character": column });
    (place(column), place(column + length))
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
