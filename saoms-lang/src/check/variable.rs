//! Values of composite properties from the environment.

use std::ffi::OsString;

use crate::diagnostic::{Diagnostic, Diagnostics, codes, quoted};
use crate::model::Contribution;
use crate::source::{Sources, Span, Text};

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
    /// let text = r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet" targetNamespace="urn:fleet"
    ///     xmlns:saoms="urn:saoms:1"><property name="robots" saoms:env="ROBOTS">10</property></composite>"#;
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
                let message = format!("the environment variable {} is no text in UTF-8", quoted(named));
                let one = Diagnostic::new(&codes::SETTING_MALFORMED, named.location, message);
                diagnostics.push(one.help("the value of a property is a text in UTF-8"));
                continue;
            };
            let shown = format!("{named}={value}");
            let trimmed = value.trim();
            let start = shown.len() - value.len() + value.find(trimmed).unwrap_or(0);
            let span = Span::new(start as u32, (start + trimmed.len()) as u32);
            let value = trimmed.into();
            let file = sources.add("environment", shown);
            all.push(Self { name: named.to_string(), value: Text::new(value, span.in_file(file)) });
        }
        all
    }
}
