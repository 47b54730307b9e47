use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use saoms_core::fault::TimedFault;
use saoms_core::observe::Observer;
use saoms_core::plugin::Search;
use saoms_core::report::RunReport;
use saoms_core::schedule::Settings;
use saoms_lang::project::{ClassPath, Classes, Compilation, Project};
use saoms_lang::registry::Registry;
use saoms_lang::source::{FileId, SourceFile};
use saoms_tools::diagnostics::human_of;

use crate::expected::{Checked, Found};
use crate::run::{Log, Run};
use crate::start::NotStartedCause;

/// A fleet under test: one or several composites, values for their properties, variables of the environment, and
/// severities.
///
/// The environment of the process is ignored, so that a test has the same result everywhere.
#[derive(Clone, Debug, Default)]
pub struct Fleet {
    composites: Vec<Composite>,
    settings: Vec<String>,
    variables: Vec<(String, String)>,
    severities: Vec<String>,
    pub(crate) faults: Vec<TimedFault>,
}

#[derive(Clone, Debug)]
enum Composite {
    File(PathBuf),
    Text(String),
}

impl Fleet {
    /// The fleet of a composite file.
    pub fn of_file(path: impl Into<PathBuf>) -> Fleet {
        Fleet::default().and_file(path)
    }

    /// The fleet of a composite that is given as text; its name in diagnostics is `text.composite`.
    pub fn of_text(text: impl Into<String>) -> Fleet {
        Fleet { composites: vec![Composite::Text(text.into())], ..Fleet::default() }
    }

    /// The same fleet with the components of a further file.
    #[must_use]
    pub fn and_file(mut self, path: impl Into<PathBuf>) -> Fleet {
        self.composites.push(Composite::File(path.into()));
        self
    }

    /// The same fleet with another value for a composite property, as `--set` gives it.
    #[must_use]
    pub fn set(mut self, name: &str, value: &str) -> Fleet {
        self.settings.push(format!("{name}={value}"));
        self
    }

    /// The same fleet with a variable of the environment, for composite properties with `saoms:env`. Of one that is
    /// given twice the last value counts.
    ///
    /// ```
    /// use saoms_testkit::Fleet;
    ///
    /// let fleet = Fleet::of_text(r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet"
    ///     targetNamespace="urn:fleet" xmlns:saoms="urn:saoms:1">
    ///   <property name="robots" mustSupply="true" saoms:env="ROBOTS"/></composite>"#);
    /// assert!(fleet.diagnostics().contains("S2025"), "it has to have a value");
    /// assert!(!fleet.with_variable("ROBOTS", "40").diagnostics().contains("S2025"));
    /// ```
    #[must_use]
    pub fn with_variable(mut self, name: &str, value: &str) -> Fleet {
        self.variables.retain(|(known, _)| known != name);
        self.variables.push((name.to_owned(), value.to_owned()));
        self
    }

    /// The same fleet with another severity for a code, as `--severity` gives it: `allow`, `note`, `warning` or
    /// `error`.
    ///
    /// ```
    /// use saoms_testkit::Fleet;
    ///
    /// let fleet = Fleet::of_text(r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet"
    ///   targetNamespace="urn:fleet">
    ///   <property name="unused">1</property>
    /// </composite>"#);
    /// assert!(fleet.diagnostics().starts_with("warning S2026"));
    /// assert_eq!(fleet.with_severity("S2026", "allow").diagnostics(), "");
    /// ```
    #[must_use]
    pub fn with_severity(mut self, code: &str, level: &str) -> Fleet {
        self.severities.push(format!("{code}={level}"));
        self
    }

    /// Diagnostics of the checker, a line each: `error S3001 5:32 there is no class ...`; empty if there are none.
    pub fn diagnostics(&self) -> String {
        let found = self.compiled();
        let mut text = String::new();
        for one in found.reported() {
            let place = found.sources.get(one.location.file).range(one.location.span).start;
            let (severity, code) = (one.severity.name(), one.code.id);
            let _ = writeln!(text, "{severity} {code} {}:{} {}", place.line, place.column, one.message);
        }
        text
    }

    /// Every text that was read, with its diagnostics.
    pub(crate) fn texts(&self) -> Vec<Checked> {
        let found = self.compiled();
        let text = |(id, file): (FileId, &SourceFile)| {
            let own = found.reported().filter(|one| one.location.file == id);
            let own = own.map(|one| Found {
                line: file.range(one.location.span).start.line,
                severity: one.severity.name(),
                code: one.code.id,
                message: one.message.clone(),
            });
            Checked { path: file.path().to_owned(), text: file.text().to_string(), found: own.collect() }
        };
        found.sources.iter().map(text).collect()
    }

    /// The single composite with everything resolved, as `saoms expand` writes it, for comparisons in tests.
    ///
    /// # Panics
    /// With all diagnostics when the composites have errors.
    #[expect(clippy::panic, reason = "a test whose fleet has errors has failed")]
    pub fn expanded(&self) -> String {
        let found = self.compiled();
        saoms_tools::expand::expanded(&found).unwrap_or_else(|| panic!("{}", human_of(&found)))
    }

    /// Diagnostics as they are shown to people, each with an excerpt of the text.
    pub fn shown(&self) -> String {
        human_of(&self.compiled())
    }

    /// Runs the fleet in virtual time, until it ends by itself or the time is over. Same seed, same run.
    ///
    /// # Panics
    /// With all diagnostics when the composites have errors, and with the component's words when one does not start.
    pub fn run(&self, seed: u64, limit: Duration) -> Run {
        let log = Arc::new(Log::default());
        let report = self.run_with(seed, limit, log.clone());
        Run::new(report, &log)
    }

    /// The same, with an observer of the run.
    ///
    /// # Panics
    /// As [`run`](Fleet::run).
    #[expect(clippy::panic, reason = "a test that cannot start its fleet has failed")]
    pub fn run_with(&self, seed: u64, limit: Duration, observer: Arc<dyn Observer>) -> RunReport {
        self.begin(seed, limit, observer).unwrap_or_else(|cause| panic!("{cause}"))
    }

    /// Runs the fleet to its end, unless it does not start.
    pub(crate) fn begin(
        &self,
        seed: u64,
        limit: Duration,
        observer: Arc<dyn Observer>,
    ) -> Result<RunReport, NotStartedCause> {
        let mut found = self.compiled();
        let Some(assembly) = found.output.take() else { return Err(NotStartedCause::Mistakes(human_of(&found))) };
        self.expect_faults_to_apply(&assembly);
        let settings = Settings { limit: Some(limit), faults: self.faults.clone(), ..Settings::simulated(seed) };
        let started = saoms_core::schedule::RunningFleet::start(assembly, settings, vec![observer]);
        Ok(started.map_err(NotStartedCause::Component)?.run_to_end())
    }

    fn compiled(&self) -> Compilation {
        let variables = self.variables.clone();
        let variable =
            move |name: &str| variables.iter().find(|(known, _)| known == name).map(|(_, value)| value.into());
        let project = Project::new().set_all(&self.settings).severities(&self.severities).environment(variable);
        let project = self.composites.iter().fold(project, |project, composite| match composite {
            Composite::File(path) => project.file(path),
            Composite::Text(text) => project.text("text.composite", text.trim_start()),
        });
        project.compile(&Linked)
    }
}

/// The classes that are linked in, and those of libraries that composites name.
struct Linked;

impl ClassPath for Linked {
    #[expect(clippy::panic, reason = "two linked classes of one name are a fault of the test's own build")]
    fn classes(&self, _: &[PathBuf]) -> Classes {
        let linked = Registry::linked().unwrap_or_else(|error| panic!("{error}"));
        Search { runs_all: true, ..Search::default() }.classes(linked)
    }
}
