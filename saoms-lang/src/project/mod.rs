//! The one way from files to an [`Assembly`], or to the diagnostics that say why there is none.
//!
//! A [`Project`] says what is compiled and how; a [`Compilation`] holds the outcome. The command and the tools take the
//! steps between them through this module alone; tests of one step call that step alone.

mod classes;
mod compilation;
mod document;
mod each;
mod folder;
mod libraries;
mod load;
mod merge;
#[cfg(test)]
mod tests;

use std::ffi::OsString;
use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use crate::assembly::Assembly;
use crate::check::Occurrences;
use crate::contribution::Finder;
use crate::load::MAX_SIZE;
use crate::source::OpenTexts;

pub use classes::{ClassPath, Classes, LibraryResolver, PluginFault};
pub use compilation::Compilation;
pub use document::{Refused, composite_files, document};
pub use each::{Compilations, FleetOutput};
pub use load::{INPUT, Loaded, NODE, SET, SEVERITY, read};

/// The composites of a fleet, and how they are to be checked.
///
/// ```
/// use saoms_lang::project::Project;
/// use saoms_lang::registry::Registry;
///
/// let text = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet"
///     targetNamespace="urn:fleet">
///     <component name="Robot001"><implementation.java class="robot.Robot001"/></component>
/// </composite>"#;
/// let project = Project::new().text("fleet.composite", text).severity("S3001=warning:the class comes later");
/// let compilation = project.compile(&Registry::new());
/// assert!(compilation.output.is_none());
/// assert_eq!(compilation.diagnostics[0].message, "there is no class `robot.Robot001`");
/// ```
#[derive(Clone)]
pub struct Project {
    inputs: Vec<Input>,
    /// Composites that are not part of the fleet, but can be named by it: names and texts.
    others: Vec<(String, String)>,
    open: OpenTexts,
    allows_outside: bool,
    settings: Vec<String>,
    severities: Vec<String>,
    environment: Environment,
    max_size: u64,
    assume_classes: bool,
    wiring: bool,
    without_plugin_code: bool,
    is_to_start: bool,
    node: Option<String>,
    is_part: bool,
    in_memory: bool,
}

/// A composite of the fleet.
#[derive(Clone, Debug)]
enum Input {
    /// A file, a folder, or [`INPUT`].
    Path(PathBuf),
    Text {
        name: String,
        text: String,
    },
}

/// The values of environment variables.
type Environment = Arc<dyn Fn(&str) -> Option<OsString> + Send + Sync>;

impl Project {
    /// A project without a composite.
    pub fn new() -> Self {
        Self {
            inputs: Vec::new(),
            others: Vec::new(),
            open: OpenTexts::default().confined(true),
            allows_outside: false,
            settings: Vec::new(),
            severities: Vec::new(),
            environment: Arc::new(|_| None),
            max_size: MAX_SIZE,
            assume_classes: false,
            wiring: false,
            without_plugin_code: false,
            is_to_start: false,
            node: None,
            is_part: false,
            in_memory: false,
        }
    }

    /// Adds a composite file to the fleet. `-` is standard input; a folder means the fleet that runs in it.
    #[must_use]
    pub fn file(mut self, path: impl Into<PathBuf>) -> Self {
        self.inputs.push(Input::Path(path.into()));
        self
    }

    /// Adds several, as [`file`](Self::file) does one.
    #[must_use]
    pub fn files(mut self, paths: impl IntoIterator<Item = impl Into<PathBuf>>) -> Self {
        self.inputs.extend(paths.into_iter().map(|path| Input::Path(path.into())));
        self
    }

    /// Adds a composite in memory to the fleet, with the name that diagnostics have for it.
    #[must_use]
    pub fn text(mut self, name: impl Into<String>, text: impl Into<String>) -> Self {
        self.inputs.push(Input::Text { name: name.into(), text: text.into() });
        self
    }

    /// Adds a composite in memory that the fleet can name, but that is not part of it otherwise.
    #[must_use]
    pub fn other_text(mut self, name: impl Into<String>, text: impl Into<String>) -> Self {
        self.others.push((name.into(), text.into()));
        self
    }

    /// Looks for nothing on disk: the fleet names composites among the texts of the project alone, and no files of
    /// values.
    #[must_use]
    pub fn in_memory(self) -> Self {
        Self { in_memory: true, ..self }
    }

    /// Takes these texts in place of what their files hold on disk.
    #[must_use]
    pub fn open_texts(self, open: OpenTexts) -> Self {
        Self { open: open.confined(!self.allows_outside), ..self }
    }

    /// Reads whatever file a composite names. Without it, a file is read that was asked for, that is in the folder of
    /// such a one or in its contribution, or in a contribution that this one may import from: links count as what they
    /// lead to. What a composite of somebody else names could otherwise be any file of the user.
    #[must_use]
    pub fn allow_outside(self, allows_outside: bool) -> Self {
        Self { open: self.open.confined(!allows_outside), allows_outside, ..self }
    }

    /// Gives a composite property another value, as `NAME=VALUE`.
    #[must_use]
    pub fn set(mut self, setting: impl Into<String>) -> Self {
        self.settings.push(setting.into());
        self
    }

    /// Gives several, as [`set`](Self::set) does one.
    #[must_use]
    pub fn set_all(mut self, settings: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.settings.extend(settings.into_iter().map(Into::into));
        self
    }

    /// Gives diagnostics of a code another severity where composites say nothing else, as `CODE=LEVEL` or
    /// `CODE=LEVEL:REASON`.
    #[must_use]
    pub fn severity(mut self, severity: impl Into<String>) -> Self {
        self.severities.push(severity.into());
        self
    }

    /// Gives several, as [`severity`](Self::severity) does one.
    #[must_use]
    pub fn severities(mut self, severities: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.severities.extend(severities.into_iter().map(Into::into));
        self
    }

    /// Takes environment variables from this function, as [`std::env::var_os`]; without it there are none.
    #[must_use]
    pub fn environment(self, variable: impl Fn(&str) -> Option<OsString> + Send + Sync + 'static) -> Self {
        Self { environment: Arc::new(variable), ..self }
    }

    /// Refuses files of more bytes than this; [`MAX_SIZE`] unless it is set.
    #[must_use]
    pub fn max_size(self, max_size: u64) -> Self {
        Self { max_size, ..self }
    }

    /// Takes classes that the registry does not know as given, and implementations of other kinds. There is no assembly
    /// then when a component has such a one.
    #[must_use]
    pub fn assume_classes(self, assume_classes: bool) -> Self {
        Self { assume_classes, ..self }
    }

    /// Judges the wiring of the whole fleet, too: topics without another end, queues that overflow.
    #[must_use]
    pub fn wiring(self, wiring: bool) -> Self {
        Self { wiring, ..self }
    }

    /// Runs no code of plugins: what their constructors and rules would say about values is not known then.
    #[must_use]
    pub fn without_plugin_code(self) -> Self {
        Self { without_plugin_code: true, ..self }
    }

    /// Takes it that the fleet is to start: needing a library whose code must not run is an error.
    #[must_use]
    pub fn to_start(self) -> Self {
        Self { is_to_start: true, ..self }
    }

    /// Takes it that the fleet is to run in this node alone, which it has to have: see [`Assembly::at`]. All of it is
    /// checked.
    #[must_use]
    pub fn node(self, node: Option<String>) -> Self {
        Self { node, ..self }
    }

    /// Takes it that composites elsewhere may use those of the fleet: what these leave to their users is no fault.
    #[must_use]
    pub fn part(self, is_part: bool) -> Self {
        Self { is_part, ..self }
    }

    /// Loads the fleet and checks it. There is an assembly where there is no error.
    pub fn compile(&self, classes: &impl ClassPath) -> Compilation<Assembly> {
        self.load(classes).compile()
    }

    /// The numbers and topics of the components as far as they can be known, also where there are errors.
    pub fn census(&self, classes: &impl ClassPath) -> Compilation<Occurrences> {
        self.load(classes).census()
    }

    /// Loads the fleet.
    pub fn load(&self, classes: &impl ClassPath) -> Loaded {
        self.load_with(&mut self.finder(), classes)
    }

    /// A finder for the files that the fleet names. One finder for several projects with the same open texts looks at
    /// each file once.
    pub fn finder(&self) -> Finder {
        Finder::new(self.open.clone())
    }
}

impl Default for Project {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for Project {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.debug_struct("Project").field("inputs", &self.inputs).finish_non_exhaustive()
    }
}
