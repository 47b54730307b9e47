//! A real browser: Chromium without a window, over a pipe of its own (`--remote-debugging-pipe`): a command is a JSON
//! text and a zero byte, and so is what it answers or tells.

use std::fs;
use std::io::{BufRead, BufReader, PipeReader, PipeWriter, Write, pipe};
use std::os::fd::AsRawFd;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, sleep};
use std::time::Duration;

use serde_json::{Value, json};
use tempfile::TempDir;

/// Time for an answer of the browser, which a busy machine keeps waiting.
const PATIENCE: Duration = Duration::from_secs(120);
/// Looks at a page until it shows what is expected, and the time between two.
const LOOKS: usize = 1200;
const BETWEEN: Duration = Duration::from_millis(50);

/// What the browser answers if the page that was asked has been left meanwhile.
const LEFT: [&str; 2] = ["Inspected target navigated or closed", "Execution context was destroyed"];

/// Errors of a page that are told.
const MOST_ERRORS: usize = 3;

/// A browser with one page. When a test fails, the page is kept as a picture.
pub(crate) struct Browser {
    child: Child,
    to: PipeWriter,
    from: Receiver<Value>,
    number: u64,
    /// The page, once there is one.
    session: Option<String>,
    /// What went wrong in the page: exceptions, and what its policy refused.
    errors: Vec<String>,
    name: &'static str,
    _profile: TempDir,
}

impl Browser {
    /// Starts one for a test of this name; `None` if the test is to be skipped.
    pub(crate) fn start(name: &'static str) -> Option<Browser> {
        let profile = tempfile::tempdir().unwrap();
        let (their_input, to) = pipe().unwrap();
        let (from, their_output) = pipe().unwrap();
        let mut command = Command::new(chromium()?);
        command.args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run"]);
        command.args(["--disable-background-networking", "--disable-sync", "--remote-debugging-pipe"]);
        command.arg(format!("--user-data-dir={}", profile.path().display())).arg("about:blank");
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let (input, output) = (their_input.as_raw_fd(), their_output.as_raw_fd());
        // SAFETY: between fork and exec only `fcntl` and `dup2` are called, which are safe there.
        unsafe {
            command.pre_exec(move || {
                // It reads from 3 and writes to 4, where these may be themselves.
                let [input, output] = [input, output].map(|one| libc::fcntl(one, libc::F_DUPFD, 10));
                libc::dup2(input, 3);
                libc::dup2(output, 4);
                Ok(())
            });
        }
        let child = command.spawn().unwrap();
        drop((their_input, their_output));
        let from = told(from);
        let (number, session) = (0, None);
        let mut browser = Browser { child, to, from, number, session, errors: Vec::new(), name, _profile: profile };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let target = json!({"targetId": target["targetId"], "flatten": true});
        let session = browser.call("Target.attachToTarget", target)["sessionId"].as_str().unwrap().to_owned();
        browser.session = Some(session);
        for domain in ["Page", "Runtime", "Log"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        browser.be_screen(1280, 900);
        Some(browser)
    }

    /// Makes the screen so large, in pixels. A narrow one is that of a phone.
    pub(crate) fn be_screen(&mut self, width: u32, height: u32) {
        let screen = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500});
        self.call("Emulation.setDeviceMetricsOverride", screen);
    }

    /// Sets the colours that the system prefers: `light` or `dark`.
    pub(crate) fn prefer(&mut self, scheme: &str) {
        let features = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        self.call("Emulation.setEmulatedMedia", features);
    }

    /// Presses a key: `Tab`, `Enter`, or a letter.
    pub(crate) fn press(&mut self, key: &str) {
        let (code, text) = match key {
            "Tab" => (9, ""),
            "Enter" => (13, "\r"),
            letter => (letter.bytes().next().map_or(0, |byte| u32::from(byte.to_ascii_uppercase())), letter),
        };
        for kind in ["keyDown", "keyUp"] {
            let mut event = json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code});
            if kind == "keyDown" && !text.is_empty() {
                event["text"] = json!(text);
            }
            self.call("Input.dispatchKeyEvent", event);
        }
    }

    /// Presses Tab until this is true of the element with the focus, `focus`.
    #[track_caller]
    pub(crate) fn tab_to(&mut self, wanted: &str) {
        for _ in 0..200 {
            self.press("Tab");
            if self.value(&format!("((focus) => {wanted})(document.activeElement)")) == true {
                return;
            }
        }
        panic!("Tab never comes to an element of which `{wanted}` is true");
    }

    /// Carries out a command of the protocol.
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.try_call(method, parameters).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// The same; the error is that of the browser.
    fn try_call(&mut self, method: &str, parameters: Value) -> Result<Value, Value> {
        self.number += 1;
        let mut command = json!({"id": self.number, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            command["sessionId"] = json!(session);
        }
        let text = command.to_string() + "\0";
        self.to.write_all(text.as_bytes()).unwrap();
        loop {
            let mut told = self.from.recv_timeout(PATIENCE).unwrap_or_else(|error| panic!("{method}: {error}"));
            if told["id"] == self.number {
                return if told["error"].is_null() { Ok(told["result"].take()) } else { Err(told["error"].take()) };
            }
            self.note(&told);
        }
    }

    /// Notes what went wrong in the page.
    fn note(&mut self, told: &Value) {
        if self.errors.len() == MOST_ERRORS {
            return;
        }
        let parameters = &told["params"];
        match told["method"].as_str() {
            Some("Runtime.exceptionThrown") => self.errors.push(parameters["exceptionDetails"].to_string()),
            Some("Log.entryAdded") if is_mistake(&parameters["entry"]) => {
                self.errors.push(parameters["entry"].to_string());
            }
            _ => {}
        }
    }

    pub(crate) fn open(&mut self, url: &str) {
        self.call("Page.navigate", json!({"url": url}));
    }

    /// The value of an expression in the page, which may be a promise; `null` while the page changes.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let asked = json!({"expression": expression, "awaitPromise": true, "returnByValue": true});
        match self.try_call("Runtime.evaluate", asked) {
            Ok(mut told) => told["result"]["value"].take(),
            Err(error) if LEFT.iter().any(|left| error.to_string().contains(left)) => Value::Null,
            Err(error) => panic!("Runtime.evaluate: {error}"),
        }
    }

    /// Waits until an expression is true in the page.
    #[track_caller]
    pub(crate) fn until(&mut self, expression: &str) {
        for _ in 0..LOOKS {
            if self.value(expression) == true {
                return;
            }
            sleep(BETWEEN);
        }
        let text = self.value("document.body.innerText");
        panic!("`{expression}` is never true in the page:\n{}", text.as_str().unwrap_or_default());
    }

    /// Clicks the element of a selector once it is there and not disabled.
    #[track_caller]
    pub(crate) fn click(&mut self, selector: &str) {
        let found = format!("document.querySelector({})", json!(selector));
        self.until(&format!("!!{found} && !{found}.disabled && !{found}.hidden"));
        self.value(&format!("{found}.click()"));
    }

    /// Types into the field of a selector.
    #[track_caller]
    pub(crate) fn fill(&mut self, selector: &str, text: &str) {
        let found = format!("document.querySelector({})", json!(selector));
        self.until(&format!("!!{found}"));
        self.value(&format!("{found}.value = {}; {found}.dispatchEvent(new Event('input'))", json!(text)));
    }

    /// The text of the element of a selector.
    pub(crate) fn text(&mut self, selector: &str) -> String {
        let text = self.value(&format!("document.querySelector({})?.textContent", json!(selector)));
        text.as_str().unwrap_or_default().to_owned()
    }

    /// What went wrong in the page.
    pub(crate) fn errors(&mut self) -> Vec<String> {
        // What was told until now comes before the answer.
        self.value("1");
        self.errors.clone()
    }

    /// Keeps the page as a picture.
    pub(crate) fn keep(&mut self) -> PathBuf {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("screenshots");
        let file = folder.join(format!("{}.png", self.name));
        let picture = self.call("Page.captureScreenshot", json!({"format": "png"}));
        fs::create_dir_all(folder).unwrap();
        fs::write(&file, base64(picture["data"].as_str().unwrap())).unwrap();
        file
    }
}

impl Drop for Browser {
    #[expect(clippy::print_stdout, reason = "a test that fails says where its picture is")]
    fn drop(&mut self) {
        if thread::panicking() {
            let kept = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| self.keep()));
            println!("the page as it was: {}", kept.map_or("not kept".to_owned(), |file| file.display().to_string()));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// True for what the page did wrong. A server that is not there, or refuses, is no mistake of the page.
fn is_mistake(entry: &Value) -> bool {
    entry["level"] == "error" && entry["source"] != "network"
}

/// What the browser says, as it comes.
fn told(from: PipeReader) -> Receiver<Value> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        let texts = BufReader::new(from).split(0).map_while(Result::ok);
        for text in texts {
            if sender.send(serde_json::from_slice(&text).unwrap()).is_err() {
                return;
            }
        }
    });
    receiver
}

/// The program, or `None` if the test is to be skipped.
#[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
fn chromium() -> Option<PathBuf> {
    let named = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let usual = ["chromium", "chromium-browser", "google-chrome"].map(PathBuf::from);
    let found = named.into_iter().chain(usual).find(|program| super::succeeds(Command::new(program).arg("--version")));
    if found.is_none() {
        let missing = "there is no Chromium: install it, or name it in the environment variable CHROMIUM";
        assert!(std::env::var("SAOMS_PEERS").as_deref() != Ok("required"), "{missing}");
        println!("skipped: {missing}");
    }
    found
}

/// The bytes of a text in Base64.
fn base64(text: &str) -> Vec<u8> {
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits: Vec<u32> = text
        .bytes()
        .filter_map(|letter| letters.iter().position(|one| *one == letter))
        .map(|digit| digit as u32)
        .collect();
    let whole = |four: &[u32]| {
        let bits = four.iter().fold(0, |bits, digit| bits << 6 | digit) << (6 * (4 - four.len()));
        bits.to_be_bytes()[1..four.len()].to_vec()
    };
    digits.chunks(4).flat_map(whole).collect()
}

#[test]
fn base64_is_read() {
    assert_eq!(base64("aGFsbA=="), b"hall");
    assert_eq!(base64("aGFs"), b"hal");
    assert_eq!(base64("/+8="), [0xff, 0xef]);
}
