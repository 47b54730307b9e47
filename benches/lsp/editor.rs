//! An editor with open files, of which one is typed into.

use std::env;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
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
    /// The time at which the last message was there: to parse it is no work of the server.
    came: Instant,
}

impl Editor {
    /// Starts a server with these files in a folder of their own, and opens all of them, the last one to type into.
    pub(crate) fn open(folder: &str, files: &[(String, String)]) -> Outcome<Self> {
        let folder = env::current_dir()?.join(RESULTS).join("lsp").join(folder);
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        fs::create_dir_all(&folder)?;
        let uri = |name: &str| format!("file://{}", folder.join(name).display());
        for (name, text) in files {
            fs::write(folder.join(name), text)?;
        }
        let mut server = Command::new(env!("CARGO_BIN_EXE_saoms"))
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let input = server.stdin.take().ok_or("no input")?;
        let output = BufReader::new(server.stdout.take().ok_or("no output")?);
        let (last, _) = files.last().ok_or("no file")?;
        let mut editor =
            Self { server, input, output, uri: uri(last), next: 0, opened: Instant::now(), came: Instant::now() };
        editor.ask("initialize", &json!({ "capabilities": {} }))?;
        editor.tell("initialized", &json!({}))?;
        editor.opened = Instant::now();
        for (name, text) in files {
            let document = json!({ "uri": uri(name), "languageId": "saoms", "version": 0, "text": text });
            editor.tell("textDocument/didOpen", &json!({ "textDocument": document }))?;
        }
        Ok(editor)
    }

    /// Waits for the first diagnostics of the file; returns the time since the files were opened, in ms.
    pub(crate) fn diagnostics(&mut self) -> Outcome<f64> {
        self.shown(0)?;
        Ok(self.milliseconds(self.opened))
    }

    /// Types `typed`, waits for the diagnostics of the new text, and undoes it; returns the time to the diagnostics, in
    /// ms.
    pub(crate) fn check(&mut self, text: &str, at: usize, typed: &str) -> Outcome<f64> {
        let (start, end) = places(text, at, typed.len());
        let begun = Instant::now();
        self.change(&start, &start, typed)?;
        self.shown(self.next)?;
        let took = self.milliseconds(begun);
        self.change(&start, &end, "")?;
        // The next check must not wait for this one.
        self.shown(self.next)?;
        Ok(took)
    }

    /// Waits for the diagnostics of the file in this version.
    fn shown(&mut self, version: i32) -> Outcome<()> {
        loop {
            let message = self.read()?;
            let is_shown = message["method"] == "textDocument/publishDiagnostics";
            let about = &message["params"];
            if is_shown && about["uri"] == self.uri && about["version"] == version {
                return Ok(());
            }
        }
    }

    /// Sends a request about a position; returns the time until the response, in ms. A response may be empty where
    /// `may_be_empty` says so.
    pub(crate) fn question(&mut self, method: &str, text: &str, at: usize, may_be_empty: bool) -> Outcome<f64> {
        let (place, _) = places(text, at, 0);
        // Each request takes the parameters that it knows.
        let asked = json!({
            "textDocument": { "uri": self.uri },
            "position": place,
            "positions": [place],
            "range": { "start": place, "end": place },
            "newName": "Another",
            "context": { "includeDeclaration": true, "diagnostics": [] },
            "options": { "tabSize": 2, "insertSpaces": true },
        });
        let begun = Instant::now();
        let answer = self.ask(method, &asked)?;
        let took = self.milliseconds(begun);
        // A name that cannot be changed is refused.
        let is_refused = answer["error"]["code"] == -32803;
        let is_empty = answer["result"].is_null() && (is_refused || answer["error"].is_null());
        if answer["result"].is_null() && !(may_be_empty && is_empty) {
            return Err(format!("{method} has no answer: {answer}").into());
        }
        Ok(took)
    }

    /// Types `typed`, requests completions, and undoes it; returns the time from typing to the response, in ms.
    pub(crate) fn complete(&mut self, text: &str, at: usize, typed: &str, may_be_empty: bool) -> Outcome<f64> {
        let (start, end) = places(text, at, typed.len());
        let begun = Instant::now();
        self.change(&start, &start, typed)?;
        let asked = json!({ "textDocument": { "uri": self.uri }, "position": end });
        let answer = self.ask("textDocument/completion", &asked)?;
        let took = self.milliseconds(begun);
        if answer["result"]["items"].as_array().is_none_or(|all| all.is_empty() && !may_be_empty) {
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

    /// The time from then to the last message, in ms.
    fn milliseconds(&self, since: Instant) -> f64 {
        self.came.duration_since(since).as_secs_f64() * 1e3
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
        self.came = Instant::now();
        Ok(serde_json::from_slice(&bytes)?)
    }
}

/// A position in a text, and the position `length` characters of ASCII after it.
fn places(text: &str, at: usize, length: usize) -> (Value, Value) {
    let before = &text[..at];
    let line = before.matches('\n').count();
    let column = before[before.rfind('\n').map_or(0, |found| found + 1)..].encode_utf16().count();
    let place = |column: usize| json!({ "line": line, "character": column });
    (place(column), place(column + length))
}
