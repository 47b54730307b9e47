//! The session: who is asked what, in which order.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::io::{self, Write};
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender};

use lsp_server::{ErrorCode, Message, Notification, Request, RequestId};
use lsp_types::notification::{
    self as notice, DidChangeTextDocument, DidChangeWatchedFiles, DidChangeWorkspaceFolders, DidCloseTextDocument,
    DidOpenTextDocument, DidSaveTextDocument, Notification as _, PublishDiagnostics,
};
use lsp_types::{MessageType, PublishDiagnosticsParams, ShowMessageParams, Uri, WorkspaceFolder};
use saoms_api::host::contain::contained;
use saoms_tools::editor::{ClassCache, EditorDiagnostic, Scene, Workspace};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::value::{RawValue, to_raw_value};
use serde_json::{Value, json};

use super::capabilities::{Client, capabilities, watchers};
use super::check::{Job, Outcome};
use super::diagnostics::diagnostic;
use super::documents::Documents;
use super::rpc::{self, Incoming};
use super::uri;
use crate::Exit;

/// An event of a session.
#[derive(Debug)]
pub(super) enum Event {
    /// Something came in.
    Incoming(Incoming),
    /// The input ended.
    Closed,
    /// A check came to its end.
    Checked(Outcome),
}

/// The phase of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    New,
    Running,
    ShutDown,
}

/// A fault of a request: a code of the protocol and what to say.
#[derive(Debug)]
pub(super) struct Refusal(pub(super) ErrorCode, pub(super) String);

/// The answer to a request. A long one is written once, and not made into a tree before.
#[derive(Serialize)]
struct Reply {
    jsonrpc: &'static str,
    id: RequestId,
    #[serde(skip_serializing_if = "Option::is_none")]
    result: Option<Box<RawValue>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<Value>,
}

/// A session.
pub(super) struct Server<W> {
    output: W,
    state: State,
    pub(super) client: Client,
    pub(super) documents: Documents,
    pub(super) workspace: Workspace,
    pub(super) classes: Arc<ClassCache>,
    jobs: Sender<Job>,
    newest: Arc<AtomicU64>,
    /// The diagnostics by file as they were shown last, with the URI and the version that they were shown for.
    pub(super) shown: BTreeMap<PathBuf, PublishedDiagnostics>,
}

/// The diagnostics that are shown of a file.
#[derive(Debug)]
pub(super) struct PublishedDiagnostics {
    uri: String,
    version: Option<i32>,
    pub(super) all: Arc<Vec<EditorDiagnostic>>,
}

impl PublishedDiagnostics {
    /// True if it was found in this version of the text.
    pub(super) fn is_of(&self, version: i32) -> bool {
        self.version == Some(version)
    }
}

impl<W: Write> Server<W> {
    pub(super) fn new(
        output: W,
        workspace: Workspace,
        classes: Arc<ClassCache>,
        jobs: Sender<Job>,
        newest: Arc<AtomicU64>,
    ) -> Self {
        Self {
            output,
            state: State::New,
            client: Client::default(),
            documents: Documents::default(),
            workspace,
            classes,
            jobs,
            newest,
            shown: BTreeMap::new(),
        }
    }

    /// Goes on until the editor ends the session, or goes away.
    pub(super) fn run(mut self, events: &Receiver<Event>) -> Exit {
        let mut waiting: VecDeque<Event> = VecDeque::new();
        loop {
            let event = match waiting.pop_front() {
                Some(event) => event,
                None => match events.recv() {
                    Ok(event) => event,
                    Err(_) => return Exit::Failed,
                },
            };
            // What came in the meantime may say that an answer is not wanted any more.
            waiting.extend(events.try_iter());
            let went = match event {
                Event::Closed => return Exit::Failed,
                Event::Checked(outcome) => self.publish(outcome),
                Event::Incoming(Incoming::Malformed(answer)) => rpc::write(&mut self.output, &answer),
                Event::Incoming(Incoming::Message(Message::Request(request))) => {
                    let is_cancelled = waiting.iter().any(|later| cancels(later, &request.id));
                    self.request(request, is_cancelled)
                }
                Event::Incoming(Incoming::Message(Message::Notification(notification))) => {
                    if notification.method == notice::Exit::METHOD {
                        let done = self.state == State::ShutDown;
                        return if done { Exit::Done } else { Exit::Failed };
                    }
                    self.notified(notification)
                }
                // Answers of the editor to the request to watch files.
                Event::Incoming(Incoming::Message(Message::Response(_))) => Ok(()),
            };
            // An editor that cannot be written to is gone.
            if went.is_err() {
                return Exit::Failed;
            }
        }
    }

    fn request(&mut self, request: Request, is_cancelled: bool) -> io::Result<()> {
        let refuse = |code, text: &str| Err(Refusal(code, text.to_owned()));
        let answer = match (self.state, request.method.as_str()) {
            _ if is_cancelled => refuse(ErrorCode::RequestCanceled, "the request was cancelled"),
            (State::New, "initialize") => {
                self.client = Client::of(&request.params);
                self.state = State::Running;
                written(&capabilities())
            }
            (State::New, _) => refuse(ErrorCode::ServerNotInitialized, "`initialize` has to come first"),
            (State::ShutDown, _) => refuse(ErrorCode::InvalidRequest, "the session is shut down"),
            (State::Running, "initialize") => refuse(ErrorCode::InvalidRequest, "the session is initialized already"),
            (State::Running, "shutdown") => {
                self.state = State::ShutDown;
                written(&Value::Null)
            }
            // A fault of ours costs one answer, and not the session.
            (State::Running, _) => contained(|| self.answer(&request.method, request.params))
                .unwrap_or_else(|failure| Err(Refusal(ErrorCode::InternalError, failure.to_string()))),
        };
        let (result, error) = match answer {
            Ok(result) => (Some(result), None),
            Err(Refusal(code, text)) => (None, Some(json!({ "code": code as i32, "message": text }))),
        };
        rpc::write(&mut self.output, &Reply { jsonrpc: "2.0", id: request.id, result, error })?;
        self.log_plugin_faults()
    }

    fn notified(&mut self, notification: Notification) -> io::Result<()> {
        if self.state != State::Running {
            return Ok(());
        }
        match notification.method.as_str() {
            notice::Initialized::METHOD if self.client.watches_files => {
                let asked = json!({ "jsonrpc": "2.0", "id": "watch", "method": "client/registerCapability", "params": watchers() });
                rpc::write(&mut self.output, &asked)?;
            }
            DidOpenTextDocument::METHOD => {
                if let Some(one) = read::<notice::DidOpenTextDocument>(notification) {
                    let one = one.text_document;
                    self.documents.open(one.uri.as_str().to_owned(), one.version, one.text);
                    self.changed(true);
                }
            }
            DidChangeTextDocument::METHOD => {
                if let Some(one) = read::<notice::DidChangeTextDocument>(notification) {
                    let about = one.text_document;
                    self.documents.change(about.uri.as_str(), about.version, one.content_changes);
                    self.changed(false);
                }
            }
            DidCloseTextDocument::METHOD => {
                if let Some(one) = read::<notice::DidCloseTextDocument>(notification) {
                    self.documents.close(one.text_document.uri.as_str());
                    self.changed(true);
                }
            }
            DidSaveTextDocument::METHOD | DidChangeWatchedFiles::METHOD => {
                self.changed(true);
            }
            DidChangeWorkspaceFolders::METHOD => {
                if let Some(one) = read::<notice::DidChangeWorkspaceFolders>(notification) {
                    let path = |folder: &WorkspaceFolder| uri::path(folder.uri.as_str());
                    let gone: Vec<PathBuf> = one.event.removed.iter().filter_map(path).collect();
                    self.client.folders.retain(|folder| !gone.contains(folder));
                    self.client.folders.extend(one.event.added.iter().filter_map(path));
                    self.workspace.set_folders(&self.client.folders);
                }
            }
            // Others need not be understood.
            _ => {}
        }
        Ok(())
    }

    /// Asks for a check of all that is open; files may have come or gone.
    fn changed(&mut self, looks_anew: bool) {
        if looks_anew {
            self.workspace.refresh();
        }
        let open = self.documents.texts().clone();
        self.workspace.set_open(open.clone());
        self.workspace.set_folders(&self.client.folders);
        let generation = self.newest.fetch_add(1, Ordering::Relaxed) + 1;
        // Where the thread is gone, the session is about to end.
        let _ = self.jobs.send(Job { generation, open, looks_anew });
    }

    /// Shows what a check found, and takes back what is not there any more.
    fn publish(&mut self, outcome: Outcome) -> io::Result<()> {
        if outcome.generation != self.newest.load(Ordering::Relaxed) {
            return Ok(());
        }
        let open: HashMap<PathBuf, (String, i32)> =
            self.documents.iter().map(|(uri, one)| (one.path.clone(), (uri.to_owned(), one.version))).collect();
        let mut files = outcome.files;
        // Files that were shown, or are open, and have no fault now.
        for path in self.shown.keys().chain(open.keys()) {
            files.entry(path.clone()).or_default();
        }
        for (path, all) in files {
            let (uri, version) = match open.get(&path) {
                Some((uri, version)) => (uri.clone(), Some(*version)),
                None => (uri::uri(&path), None),
            };
            let before = self.shown.remove(&path);
            if let Some(before) = before.as_ref().filter(|before| before.uri != uri) {
                self.show(&before.uri, None, &[])?;
            }
            let is_equal = |known: &Arc<Vec<EditorDiagnostic>>| Arc::ptr_eq(known, &all) || *known == all;
            let is_same = before.is_some_and(|one| one.uri == uri && one.version == version && is_equal(&one.all));
            if !is_same {
                self.show(&uri, version, &all)?;
            }
            if version.is_some() || !all.is_empty() {
                self.shown.insert(path, PublishedDiagnostics { uri, version, all });
            }
        }
        self.log_plugin_faults()
    }

    fn show(&mut self, uri: &str, version: Option<i32>, all: &[EditorDiagnostic]) -> io::Result<()> {
        let Ok(uri) = Uri::from_str(uri) else { return Ok(()) };
        let diagnostics = all.iter().map(diagnostic).collect();
        self.notify(PublishDiagnostics::METHOD, PublishDiagnosticsParams { uri, diagnostics, version })
    }

    /// Says what is wrong with plugins, once.
    fn log_plugin_faults(&mut self) -> io::Result<()> {
        for problem in self.classes.new_problems() {
            let typ = if problem.is_error { MessageType::ERROR } else { MessageType::WARNING };
            let message = format!("saoms: {}", problem.text);
            self.notify(notice::ShowMessage::METHOD, ShowMessageParams { typ, message })?;
        }
        Ok(())
    }

    fn notify(&mut self, method: &str, params: impl Serialize) -> io::Result<()> {
        let params = serde_json::to_value(params).unwrap_or_default();
        rpc::write(&mut self.output, &json!({ "jsonrpc": "2.0", "method": method, "params": params }))
    }

    /// The scene of a document that is open.
    pub(super) fn scene(&mut self, uri: &Uri) -> Result<Scene, Refusal> {
        let path = match self.documents.get(uri.as_str()) {
            Some(document) => document.path.clone(),
            None => {
                let text = format!("`{}` is not open", uri.as_str());
                return Err(Refusal(ErrorCode::InvalidParams, text));
            }
        };
        let around = self.workspace.around(&path);
        let libraries = around.file().map(|file| file.libraries().to_vec()).unwrap_or_default();
        Ok(Scene::new(around, self.classes.of(&path, &libraries)))
    }
}

/// An answer as it is sent.
pub(super) fn written(answer: &impl Serialize) -> Result<Box<RawValue>, Refusal> {
    to_raw_value(answer).map_err(|error| Refusal(ErrorCode::InternalError, error.to_string()))
}

fn read<N: notice::Notification>(notification: Notification) -> Option<N::Params>
where
    N::Params: DeserializeOwned,
{
    // A notification has no answer, so a malformed one cannot be reported.
    serde_json::from_value(notification.params).ok()
}

fn cancels(later: &Event, id: &RequestId) -> bool {
    let Event::Incoming(Incoming::Message(Message::Notification(notification))) = later else { return false };
    let is_meant = |one: &Value| serde_json::to_value(id).is_ok_and(|wanted| *one == wanted);
    notification.method == notice::Cancel::METHOD && notification.params.get("id").is_some_and(is_meant)
}
