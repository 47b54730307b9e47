//! Options of a check, and values of composite properties from outside: from the command line and the environment.

use std::ffi::OsString;

use crate::check::SeveritySetting;
use crate::diagnostic::{Diagnostic, Diagnostics, codes, quoted};
use crate::model::Contribution;
use crate::source::{Sources, Span, Text};

/// The name of the source texts of environment variables, each `NAME=VALUE`.
pub(crate) const ENVIRONMENT: &str = "environment";

/// Options of a check.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Values of composite properties that count in place of those in the files.
    pub settings: Vec<Setting>,
    /// True if the settings are those of several fleets: one of a property that is not there is then a note.
    pub shared_settings: bool,
    /// Environment variables that composite properties can take their values from.
    pub variables: Vec<Variable>,
    /// Severities that count where composites say nothing else.
    pub severities: Vec<SeveritySetting>,
    /// True if what the registry does not know is taken as given: classes, and implementations of other kinds. There is
    /// no assembly then when a component has such a one.
    pub assume_classes: bool,
    /// True if the wiring of the fleet is judged as a whole, too: topics without another end, queues that overflow.
    pub wiring: bool,
    /// True if the code of plugins is left alone: what their constructors would say about values is not known then.
    pub without_plugin_code: bool,
    /// True if the fleet is to start: a library whose code must not run is an error then.
    pub is_to_start: bool,
    /// The node that is to run.
    pub node: Option<Text>,
}

impl Options {
    /// The value of an environment variable.
    pub(crate) fn variable(&self, name: &str) -> Option<&Text> {
        self.variables.iter().find(|variable| variable.name == name).map(|variable| &variable.value)
    }
}

/// A value of a composite property that counts in place of the one in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The name of the composite property.
    pub name: Text,
    /// Its value.
    pub value: Text,
}

impl Setting {
    /// Reads `NAME=VALUE`, the value of the option `option` (as `--set`). It becomes a source text of that name, so
    /// that diagnostics can point into it. `None`, and a diagnostic, when there is no `=` or no name.
    ///
    /// ```
    /// use saoms_lang::{check::Setting, diagnostic::Diagnostics, source::Sources};
    ///
    /// let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    /// let setting = Setting::parse("--set", "speed=2.5", &mut sources, &mut diagnostics).unwrap();
    /// assert_eq!((setting.name.as_str(), setting.value.as_str()), ("speed", "2.5"));
    /// assert!(Setting::parse("--set", "speed", &mut sources, &mut diagnostics).is_none());
    /// assert!(diagnostics.has_errors());
    /// ```
    pub fn parse(option: &str, text: &str, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<Self> {
        let file = sources.add(option, text);
        let found = text.split_once('=').filter(|(name, _)| !name.trim().is_empty());
        let Some((name, value)) = found else {
            let message = match text.find('=') {
                None => format!("{} is not a setting: `=` is missing", quoted(text)),
                Some(_) => "there is no name before the `=`".to_owned(),
            };
            let place = Span::new(0, text.len() as u32).in_file(file);
            let help = format!("write `{option} NAME=VALUE` with the name of a composite property");
            diagnostics.push(Diagnostic::new(&codes::SETTING_MALFORMED, place, message).help(help));
            return None;
        };
        Some(Self { name: Text::part_of(file, text, name), value: Text::part_of(file, text, value) })
    }
}

/// An environment variable that a composite property names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: Text,
}

impl Variable {
    /// The variables that the composite properties of a contribution name, as far as `get` has a value for them. Each
    /// becomes a source text called `environment`, so that diagnostics can point into it. One that is no text in UTF-8
    /// is reported where it is named.
    ///
    /// ```
    /// use saoms_lang::check::Variable;
    /// use saoms_lang::{diagnostic::Diagnostics, load::load_file, model::Contribution, source::Sources};
    ///
    /// let text = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1"
    ///     name="fleet" targetNamespace="urn:fleet">
    ///   <property name="robots" saoms:env="ROBOTS">10</property></composite>"#;
    /// let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    /// let file = sources.add("fleet.composite", text);
    /// let fleet = Contribution::of(load_file(file, &sources, &mut diagnostics).into_iter().collect());
    /// let get = |name: &str| (name == "ROBOTS").then(|| "40".into());
    /// let all = Variable::read(&fleet, get, &mut sources, &mut diagnostics);
    /// assert_eq!(all[0].value.as_str(), "40");
    /// ```
    pub fn read(
        contribution: &Contribution,
        get: impl Fn(&str) -> Option<OsString>,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        for named in contribution.composites().iter().flat_map(|one| &one.properties).filter_map(|one| one.env()) {
            if all.iter().any(|known| known.name == named.as_str()) {
                continue;
            }
            // What no variable can be called has none.
            let Some(value) = get(named).filter(|_| !named.contains(['=', '\0'])) else { continue };
            let Ok(value) = value.into_string() else {
                let message = format!("the environment variable {} is not text in UTF-8", quoted(named));
                let one = Diagnostic::new(&codes::SETTING_MALFORMED, named.location, message);
                diagnostics.push(one.help("the value of a property is a text in UTF-8"));
                continue;
            };
            let file = sources.add(ENVIRONMENT, format!("{named}={value}"));
            let shown = sources.get(file).text();
            let value = Text::part_of(file, shown, &shown[named.len() + 1..]);
            all.push(Self { name: named.to_string(), value });
        }
        all
    }
}
