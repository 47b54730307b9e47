//! A fleet in several programs.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{sleep, spawn};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::namespace::Namespace;
use crate::boundary::build;
use crate::plugins::library;
use crate::support::{command, saoms_in};

/// Time for which something is waited for that has to happen.
const LONGEST: Duration = Duration::from_secs(180);

/// Components of tasks on the network at a url, with these properties beside their own.
pub(super) fn on_network(url: &str, more: Given<'_>, tasks: &[Task<'_>]) -> String {
    let components = tasks.iter().map(|(name, class, properties)| {
        let usual = [("ID", *name), ("period", "100"), ("url", url)];
        component(name, class, &[&usual, more, *properties].concat())
    });
    components.collect()
}

/// Properties of a component.
pub(super) type Given<'a> = &'a [(&'a str, &'a str)];

/// A component: its name, its class, and its properties beside those of each task.
pub(super) type Task<'a> = (&'a str, &'a str, Given<'a>);

/// The programs of a fleet, and the port of their broker. They are killed with it.
pub(super) struct Programs {
    folder: TempDir,
    transport: Transport,
    /// The port of the broker.
    pub(super) port: u16,
    /// Where they run that have a network of their own.
    namespace: Option<Namespace>,
    started: Mutex<Vec<Arc<Program>>>,
}

/// The transport of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Transport {
    Relay,
    Zenoh,
    /// At a broker of others.
    Mqtt,
    Stomp,
}

impl Transport {
    /// What stands before host and port in its urls.
    fn scheme(self) -> &'static str {
        match self {
            Transport::Relay => "relay://",
            Transport::Zenoh => "",
            Transport::Mqtt => "mqtt://",
            Transport::Stomp => "stomp://",
        }
    }

    fn library(self) -> PathBuf {
        library(match self {
            Transport::Relay => "saoms_relay",
            Transport::Zenoh => "saoms_zenoh",
            Transport::Mqtt => "saoms_mqtt",
            Transport::Stomp => "saoms_stomp",
        })
    }
}

/// A program that was started.
pub(super) struct Program {
    name: String,
    child: Mutex<Child>,
    pid: i32,
    /// What it has printed.
    printed: Arc<Mutex<String>>,
    /// The most memory that it was seen with, in bytes.
    memory: AtomicU64,
}

/// A port on which nobody listens.
pub(super) fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port()
}

/// A component with these properties.
pub(super) fn component(name: &str, class: &str, properties: Given<'_>) -> String {
    let properties = properties.iter().map(|(name, value)| format!("<property name=\"{name}\">{value}</property>"));
    let properties: String = properties.collect();
    format!("<component name=\"{name}\"><implementation.java class=\"{class}\"/>{properties}</component>\n")
}

impl Programs {
    pub(super) fn new() -> Programs {
        Programs::over(Transport::Relay)
    }

    pub(super) fn over(transport: Transport) -> Programs {
        let folder = tempfile::tempdir().unwrap();
        Programs { folder, transport, port: free_port(), namespace: None, started: Mutex::default() }
    }

    /// Programs on a network of their own, whose link can be taken down.
    pub(super) fn within(namespace: Namespace, transport: Transport) -> Programs {
        let mut programs = Programs::over(transport);
        programs.namespace = Some(namespace);
        programs
    }

    /// Takes the link of their own network down, or up again.
    pub(super) fn set_link(&self, is_up: bool) {
        self.namespace.as_ref().unwrap().set_link(is_up);
    }

    /// The most memory that a program was seen with, in bytes.
    pub(super) fn most_memory(&self) -> u64 {
        self.started.lock().unwrap().iter().map(|one| one.memory.load(Ordering::SeqCst)).max().unwrap_or_default()
    }

    /// The folder of the composites.
    pub(super) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// The address of the network at this port.
    pub(super) fn url(&self, port: u16) -> String {
        format!("{}127.0.0.1:{port}", self.transport.scheme())
    }

    /// Starts the broker.
    pub(super) fn broker(&self) -> Arc<Program> {
        let transport = if self.transport == Transport::Relay { "relay" } else { "" };
        let address = [("IP", "127.0.0.1"), ("transport", transport), ("port", &self.port.to_string())];
        self.start("broker", &component("Broker", "unibg.robotics.tca.MessageBrokerImpl", &address))
    }

    /// Starts a program with these components, on the network at this port.
    pub(super) fn tasks(&self, name: &str, port: u16, tasks: &[Task<'_>]) -> Arc<Program> {
        self.start(name, &on_network(&self.url(port), &[], tasks))
    }

    /// Starts a program with these components.
    pub(super) fn start(&self, name: &str, components: &str) -> Arc<Program> {
        self.start_with(name, components, |_| {})
    }

    /// The same, with more for its command.
    pub(super) fn start_with(
        &self,
        name: &str,
        components: &str,
        configure: impl FnOnce(&mut Command),
    ) -> Arc<Program> {
        let file = self.write_composite(name, components);
        self.run_with(name, &["run", &file], configure)
    }

    /// Writes a composite of these components. Gives its file.
    pub(super) fn write_composite(&self, name: &str, components: &str) -> String {
        let composite = format!(
            "<composite xmlns=\"http://www.osoa.org/xmlns/sca/1.0\" targetNamespace=\"http://launch\" \
             name=\"{name}\">\n{components}</composite>\n"
        );
        let file = format!("{name}.composite");
        self.write(&file, &composite);
        file
    }

    /// Writes a file that programs can name.
    pub(super) fn write(&self, file: &str, text: &str) {
        fs::write(self.folder.path().join(file), text).unwrap();
    }

    /// Reads a file that a program wrote.
    pub(super) fn read(&self, file: &str) -> String {
        fs::read_to_string(self.folder.path().join(file)).unwrap()
    }

    /// Runs a command where the files of the programs are.
    pub(super) fn saoms(&self, arguments: &[&str]) -> Output {
        saoms_in(self.folder.path(), arguments)
    }

    /// The socket at which operators reach a program.
    pub(super) fn socket(&self, program: &Program) -> PathBuf {
        let sockets = fs::read_dir(self.folder.path().join("saoms")).unwrap();
        let end = format!("-{}.sock", program.pid());
        sockets.map(|entry| entry.unwrap().path()).find(|path| path.to_string_lossy().ends_with(&end)).unwrap()
    }

    /// Starts a program with these arguments.
    pub(super) fn run(&self, name: &str, arguments: &[&str]) -> Arc<Program> {
        self.run_with(name, arguments, |_| {})
    }

    /// The same, with more for its command.
    pub(super) fn run_with(
        &self,
        name: &str,
        arguments: &[&str],
        configure: impl FnOnce(&mut Command),
    ) -> Arc<Program> {
        let mut run = command(&[arguments, &["--grace", "10s"]].concat());
        run.current_dir(self.folder.path()).env("XDG_RUNTIME_DIR", self.folder.path());
        for library in [self.transport.library(), build::library("numbers")] {
            run.arg("--plugin").arg(library);
        }
        configure(&mut run);
        let run = match &self.namespace {
            Some(namespace) => namespace.inside(&run),
            None => run,
        };
        self.watch(name, run)
    }

    /// Starts a program that is not the command, where the files of the programs are.
    pub(super) fn other(&self, name: &str, mut program: Command) -> Arc<Program> {
        program.current_dir(self.folder.path());
        self.watch(name, program)
    }

    fn watch(&self, name: &str, mut run: Command) -> Arc<Program> {
        let mut child = run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let printed = Arc::<Mutex<String>>::default();
        let (out, err) = (child.stdout.take().unwrap(), child.stderr.take().unwrap());
        for pipe in [Box::new(out) as Box<dyn Read + Send>, Box::new(err)] {
            let printed = Arc::clone(&printed);
            spawn(move || {
                for line in BufReader::new(pipe).lines() {
                    *printed.lock().unwrap() += &(line.unwrap() + "\n");
                }
            });
        }
        let pid = i32::try_from(child.id()).unwrap();
        let (name, memory) = (name.to_owned(), AtomicU64::new(0));
        let program = Arc::new(Program { name, child: Mutex::new(child), pid, printed, memory });
        self.started.lock().unwrap().push(Arc::clone(&program));
        program
    }

    /// Waits until a program says this.
    #[track_caller]
    pub(super) fn until(&self, program: &Program, text: &str) {
        self.wait(&format!("`{}` does not say `{text}`", program.name), || program.printed().contains(text));
    }

    /// Waits for the end of a program, and holds it to an exit code.
    #[track_caller]
    pub(super) fn ends(&self, program: &Program, code: i32) {
        self.wait(&format!("`{}` does not end", program.name), || program.has_ended());
        let status = program.child.lock().unwrap().wait().unwrap();
        self.wait("what it said last is read", || Arc::strong_count(&program.printed) == 1);
        assert_eq!(status.code(), Some(code), "`{}` ends: {status}\n{}", program.name, self.printed());
    }

    /// Ends a program that may have ended by itself.
    #[track_caller]
    pub(super) fn stop(&self, program: &Program) {
        program.reaches(libc::SIGTERM);
        self.wait(&format!("`{}` does not end", program.name), || program.has_ended());
        let code = program.child.lock().unwrap().wait().unwrap().code();
        assert!(matches!(code, Some(0 | 130)), "`{}` ends: {code:?}\n{}", program.name, self.printed());
    }

    /// Ends the broker, which has no end of its own, and holds all programs to having said nothing that is wrong.
    #[track_caller]
    pub(super) fn end(&self, broker: &Program) {
        self.end_without(broker, &["wrong:", "panicked", "are lost"]);
    }

    /// Ends the broker, and holds all programs to having said none of this.
    #[track_caller]
    pub(super) fn end_without(&self, broker: &Program, signs: &[&str]) {
        broker.signal(libc::SIGTERM);
        self.ends(broker, 130);
        let printed = self.printed();
        for sign in signs {
            assert!(!printed.contains(sign), "`{sign}`\n{printed}");
        }
    }

    /// Waits until this is so.
    #[track_caller]
    pub(super) fn wait(&self, what: &str, is: impl Fn() -> bool) {
        let begin = Instant::now();
        while !is() {
            assert!(begin.elapsed() < LONGEST, "{what}\n{}", self.printed());
            self.started.lock().unwrap().iter().for_each(|program| program.note_memory());
            sleep(Duration::from_millis(10));
        }
    }

    /// What all programs have printed.
    pub(super) fn printed(&self) -> String {
        let started = self.started.lock().unwrap();
        started.iter().map(|program| format!("--- {}\n{}", program.name, program.printed())).collect()
    }
}

impl Drop for Programs {
    fn drop(&mut self) {
        for program in self.started.lock().unwrap().iter() {
            let mut child = program.child.lock().unwrap();
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

impl Program {
    /// What it has printed.
    pub(super) fn printed(&self) -> String {
        self.printed.lock().unwrap().clone()
    }

    /// Its number in the system.
    pub(super) fn pid(&self) -> i32 {
        self.pid
    }

    /// Notes how much memory it has had at most.
    fn note_memory(&self) {
        // It may have ended.
        let Ok(status) = fs::read_to_string(format!("/proc/{}/status", self.pid)) else { return };
        let most = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.strip_suffix("kB")?.trim().parse().ok());
        self.memory.fetch_max(most.unwrap_or(0_u64) << 10, Ordering::SeqCst);
    }

    fn has_ended(&self) -> bool {
        self.child.lock().unwrap().try_wait().unwrap().is_some()
    }

    /// Sends a signal to it, which has not ended.
    #[track_caller]
    pub(super) fn signal(&self, signal: i32) {
        assert!(self.reaches(signal), "`{}` has ended:\n{}", self.name, self.printed());
    }

    /// Sends a signal to it; false if it has ended.
    fn reaches(&self, signal: i32) -> bool {
        let mut child = self.child.lock().unwrap();
        // SAFETY: no pointers; the process was not waited for to its end, and nobody else waits for it meanwhile.
        child.try_wait().unwrap().is_none() && unsafe { libc::kill(self.pid, signal) } == 0
    }

    /// Kills it, as a crash or a loss of power ends it.
    #[track_caller]
    pub(super) fn kill(&self) {
        self.signal(libc::SIGKILL);
        let _ = self.child.lock().unwrap().wait();
    }
}
