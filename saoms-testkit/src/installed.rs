//! Fleets that the installed command runs.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;
use std::{env, fs};

use saoms_api::host::format_duration;
use serde_json::Value;

/// A fleet that the installed command `saoms` runs in virtual time, with the library of the package under test as its
/// plugin: what the tests of a plugin need, without building SAOMS for them.
///
/// The command is that of the variable `SAOMS`, or `saoms` in `PATH`. The library is the `cdylib` that `cargo test` has
/// built beside the test.
///
/// ```no_run
/// use std::time::Duration;
/// use saoms_testkit::Installed;
///
/// let run = Installed::fleet("fleet.composite").run(0, Duration::from_secs(10));
/// assert_eq!(run.log_of("Counter")[1], "counts to 4");
/// ```
#[derive(Clone, Debug)]
pub struct Installed {
    command: PathBuf,
    plugin: Option<PathBuf>,
    composite: PathBuf,
    settings: Vec<String>,
}

impl Installed {
    /// The fleet of a composite file; its path is relative to the package.
    ///
    /// # Panics
    /// The command is not installed; the message says how to install it.
    #[expect(clippy::panic, reason = "a test without its command has failed")]
    pub fn fleet(composite: impl Into<PathBuf>) -> Installed {
        let command = command(env::var_os("SAOMS").map(PathBuf::from), env::var_os("PATH").as_deref());
        let command = command.unwrap_or_else(|problem| panic!("{problem}"));
        Installed { command, plugin: library(), composite: composite.into(), settings: Vec::new() }
    }

    /// The same fleet with this library, or folder of libraries, as its plugin.
    #[must_use]
    pub fn plugin(self, path: impl Into<PathBuf>) -> Installed {
        Installed { plugin: Some(path.into()), ..self }
    }

    /// The same fleet with another value for a composite property, as `--set` gives it.
    #[must_use]
    pub fn set(mut self, name: &str, value: &str) -> Installed {
        self.settings.push(format!("{name}={value}"));
        self
    }

    /// Runs the fleet until it ends by itself or the time is over. Same seed, same run.
    ///
    /// # Panics
    /// With what the command says when the fleet does not start.
    #[expect(clippy::panic, reason = "a test that cannot start its fleet has failed")]
    pub fn run(&self, seed: u64, limit: Duration) -> InstalledRun {
        static RUNS: AtomicU32 = AtomicU32::new(0);
        let number = RUNS.fetch_add(1, Ordering::Relaxed);
        let file = env::temp_dir().join(format!("saoms-testkit-{}-{number}.json", std::process::id()));
        let mut run = self.start("run");
        run.args(["--virtual", "--seed", &seed.to_string(), "--for", &format_duration(limit)]);
        run.arg("--report").arg(&file);
        let output = self.output(run);
        let report = fs::read_to_string(&file).ok().and_then(|text| serde_json::from_str(&text).ok());
        // It is not there where the fleet did not start.
        let _ = fs::remove_file(&file);
        let Some(report) = report else { panic!("{}{}", text(&output.stdout), text(&output.stderr)) };
        InstalledRun { log: text(&output.stdout), errors: text(&output.stderr), report }
    }

    /// What the command reports about the fleet without running it, as people see it; empty if that is nothing.
    ///
    /// # Panics
    /// The command cannot be started.
    pub fn diagnostics(&self) -> String {
        text(&self.output(self.start("check")).stderr)
    }

    fn start(&self, subcommand: &str) -> Command {
        let mut command = Command::new(&self.command);
        command.arg(subcommand).arg(&self.composite);
        for setting in &self.settings {
            command.args(["--set", setting]);
        }
        if let Some(plugin) = &self.plugin {
            command.arg("--plugin").arg(plugin);
        }
        command
    }

    #[expect(clippy::panic, reason = "a test without its command has failed")]
    fn output(&self, mut command: Command) -> Output {
        command.output().unwrap_or_else(|error| panic!("`{}` cannot be started: {error}", self.command.display()))
    }
}

/// A run of an [`Installed`] fleet that has ended.
#[derive(Clone, Debug)]
pub struct InstalledRun {
    log: String,
    errors: String,
    report: Value,
}

impl InstalledRun {
    /// All that the command printed: lines of components and other events with their times, and the summary.
    pub fn log(&self) -> &str {
        &self.log
    }

    /// What the command wrote to standard error, such as warnings.
    pub fn errors(&self) -> &str {
        &self.errors
    }

    /// The lines of one component, by its path, without time and name.
    pub fn log_of(&self, component: &str) -> Vec<&str> {
        self.log.lines().filter_map(|line| line_of(line, component)).collect()
    }

    /// The texts that the loops of one component, or the component itself, left in the journal.
    pub fn journal_of(&self, component: &str) -> Vec<&str> {
        let records = self.report["journal"]["entries"].as_array().into_iter().flatten();
        let own = records.filter(|record| record["component"] == component);
        own.filter_map(|record| record["text"].as_str()).collect()
    }

    /// The report, as `saoms run --report` writes it.
    pub fn report(&self) -> &Value {
        &self.report
    }
}

/// What a line of the console says about a component, such as `    1.100 s  Robot7         collected luggage 1`.
fn line_of<'a>(line: &'a str, component: &str) -> Option<&'a str> {
    let (time, rest) = line.trim_start().split_once(" s  ")?;
    time.parse::<f64>().ok()?;
    let text = rest.strip_prefix(component)?;
    text.starts_with(' ').then(|| text.trim_start())
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The command, as the variables `SAOMS` and `PATH` say.
fn command(named: Option<PathBuf>, path: Option<&std::ffi::OsStr>) -> Result<PathBuf, String> {
    if let Some(named) = named.filter(|named| named.is_file()) {
        return Ok(named);
    }
    let folders = path.map(|path| env::split_paths(path).collect::<Vec<_>>()).unwrap_or_default();
    folders.iter().map(|folder| folder.join("saoms")).find(|program| program.is_file()).ok_or_else(|| {
        "the command `saoms`, which runs the fleets of this test, was not found: install it with `cargo install --path \
         FOLDER` (the folder of its sources), or say where it is: `SAOMS=PATH cargo test`"
            .to_owned()
    })
}

/// The library of the package under test, which Cargo has built beside the program of the test.
fn library() -> Option<PathBuf> {
    let package = env::var("CARGO_PKG_NAME").ok()?.replace('-', "_");
    let folder = env::current_exe().ok()?;
    let library = folder.parent().map(|folder: &Path| folder.join(format!("lib{package}.so")))?;
    library.is_file().then_some(library)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_those_of_the_component_that_is_asked_for() {
        let log =
            "    1.000 s  Robot7         takes luggage 1\n   12.500 s  Robot77        waits\n\ndone after 3.400 s: 1\n";
        let run = InstalledRun { log: log.to_owned(), errors: String::new(), report: Value::Null };
        assert_eq!(run.log_of("Robot7"), ["takes luggage 1"]);
        assert_eq!(run.log_of("Robot77"), ["waits"]);
        assert_eq!(run.log_of("done"), [""; 0]);
        assert_eq!(run.journal_of("Robot7"), [""; 0]);
    }

    #[test]
    fn the_command_is_found_or_its_absence_told() {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("saoms");
        let path = env::join_paths([Path::new("/nowhere"), folder.path()]).unwrap();
        assert!(command(None, Some(&path)).unwrap_err().contains("cargo install"));
        fs::write(&program, "").unwrap();
        assert_eq!(command(None, Some(&path)).unwrap(), program);
        assert_eq!(command(Some("/nowhere/saoms".into()), Some(&path)).unwrap(), program, "one that is gone");
        let other = folder.path().join("other");
        fs::write(&other, "").unwrap();
        assert_eq!(command(Some(other.clone()), Some(&path)).unwrap(), other);
    }
}
