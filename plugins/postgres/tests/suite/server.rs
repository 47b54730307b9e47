//! A PostgreSQL server in a temporary folder, with a socket there.

use std::fs;
use std::os::unix::fs::chown;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use postgres::{Client, NoTls};
use tempfile::TempDir;

/// The time within which something has to happen.
pub(crate) const PATIENCE: Duration = Duration::from_secs(120);

pub(crate) struct Server {
    folder: TempDir,
    programs: PathBuf,
    /// The user that runs it: PostgreSQL refuses root.
    owner: Option<(u32, u32)>,
    options: Vec<String>,
    running: Option<Child>,
}

impl Server {
    /// A server with a database `fleet`, at a socket alone; `None` if the test is to be skipped.
    pub(crate) fn start() -> Option<Server> {
        Server::start_with(&["listen_addresses="], "", |_| {})
    }

    /// The same with options, lines before others in `pg_hba.conf`, and what is done in its data folder before.
    #[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
    pub(crate) fn start_with(options: &[&str], access: &str, prepare: impl FnOnce(&Path)) -> Option<Server> {
        let Some(programs) = programs() else {
            let missing = "PostgreSQL is not installed (apt-get install postgresql)";
            assert!(std::env::var("SAOMS_PEERS").as_deref() != Ok("required"), "{missing}");
            println!("skipped: {missing}");
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        let owner = (number(&["-u"]) == 0).then(|| (number(&["-u", "postgres"]), number(&["-g", "postgres"])));
        if let Some((user, group)) = owner {
            chown(folder.path(), Some(user), Some(group)).unwrap();
        }
        let options = options.iter().map(|&option| option.to_owned()).collect();
        let mut server = Server { folder, programs, owner, options, running: None };
        let data = server.data();
        let mut made = server.program("initdb");
        made.args(["--auth=trust", "--username=postgres", "--encoding=UTF8", "--locale=C", "--no-sync", "--pgdata"]);
        let made = made.arg(&data).output().unwrap();
        assert!(made.status.success(), "{made:?}");
        let rules = data.join("pg_hba.conf");
        let all = format!("{access}\n{}", fs::read_to_string(&rules).unwrap());
        fs::write(&rules, all).unwrap();
        prepare(&data);
        server.go_on();
        server.client("postgres").batch_execute("CREATE DATABASE fleet").unwrap();
        Some(server)
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    fn program(&self, name: &str) -> Command {
        let mut command = Command::new(self.programs.join(name));
        command.current_dir(self.folder.path()).env_clear().env("PATH", "/usr/bin:/bin");
        if let Some((user, group)) = self.owner {
            command.uid(user).gid(group);
        }
        command
    }

    /// Starts it, and waits until it answers.
    pub(crate) fn go_on(&mut self) {
        let mut command = self.program("postgres");
        command.arg("-D").arg(self.data()).arg("-k").arg(self.folder.path()).args(["-c", "fsync=off"]);
        for option in &self.options {
            command.args(["-c", option]);
        }
        let log = fs::File::options().create(true).append(true).open(self.folder.path().join("log")).unwrap();
        self.running = Some(command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(log).spawn().unwrap());
        let begun = Instant::now();
        while let Err(error) = self.connect("postgres") {
            let log = || fs::read_to_string(self.folder.path().join("log")).unwrap_or_default();
            assert!(begun.elapsed() < PATIENCE, "{error}\n{}", log());
            sleep(Duration::from_millis(20));
        }
    }

    /// Starts it with other options.
    pub(crate) fn go_on_with(&mut self, options: &[&str]) {
        self.options = options.iter().map(|&option| option.to_owned()).collect();
        self.go_on();
    }

    /// Ends it; its clients are sent away.
    pub(crate) fn stop(&mut self) {
        let Some(mut running) = self.running.take() else { return };
        signal(&running, libc::SIGINT);
        running.wait().unwrap();
    }

    fn connect(&self, database: &str) -> Result<Client, postgres::Error> {
        let mut config = postgres::Config::new();
        config.host_path(self.folder.path()).user("postgres").dbname(database);
        if let Some(port) = self.options.iter().find_map(|option| option.strip_prefix("port=")) {
            config.port(port.parse().unwrap());
        }
        config.connect(NoTls)
    }

    pub(crate) fn client(&self, database: &str) -> Client {
        self.connect(database).unwrap()
    }

    /// The url of the database `fleet`.
    pub(crate) fn url(&self) -> String {
        format!("postgres:///fleet?host={}&user=postgres", self.folder.path().display())
    }

    /// The program that brings a history here.
    pub(crate) fn copier(&self, file: &Path, more: &[&str]) -> Command {
        let mut command = copier();
        command.arg(file).args(["--to", &self.url()]).args(more);
        command
    }

    /// Brings a history once.
    pub(crate) fn bring(&self, file: &Path, more: &[&str]) -> String {
        let output = self.copier(file, more).output().unwrap();
        let (code, text) = outcome(&output);
        assert_eq!(code, 0, "{text}");
        text
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(mut running) = self.running.take() {
            signal(&running, libc::SIGQUIT);
            let _ = running.wait();
        }
    }
}

/// The program under test, in an environment without passwords.
pub(crate) fn copier() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saoms-postgres"));
    for variable in ["PGPASSWORD", "PGPASSFILE", "HOME"] {
        command.env_remove(variable);
    }
    command
}

/// The exit code and all that was written.
pub(crate) fn outcome(output: &Output) -> (i32, String) {
    let text = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned()).concat();
    (output.status.code().unwrap_or(-1), text)
}

pub(crate) fn signal(child: &Child, signal: i32) {
    // SAFETY: no pointers; the child was not waited for, so that its number is its own.
    unsafe { libc::kill(i32::try_from(child.id()).unwrap(), signal) };
}

/// The programs of the newest PostgreSQL.
fn programs() -> Option<PathBuf> {
    let versions = fs::read_dir("/usr/lib/postgresql").into_iter().flatten().flatten();
    let mut found: Vec<(u32, PathBuf)> = versions
        .filter_map(|entry| Some((entry.file_name().to_str()?.parse().ok()?, entry.path().join("bin"))))
        .filter(|(_, programs)| programs.join("initdb").is_file() && programs.join("postgres").is_file())
        .collect();
    found.sort();
    found.pop().map(|(_, programs)| programs)
}

/// What `id` says.
fn number(arguments: &[&str]) -> u32 {
    let output = Command::new("id").args(arguments).output().unwrap();
    String::from_utf8_lossy(&output.stdout).trim().parse().unwrap()
}
