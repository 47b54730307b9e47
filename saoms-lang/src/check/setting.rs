//! Values of composite properties from the command line.

use crate::diagnostic::{Diagnostic, Diagnostics, codes, quoted};
use crate::source::{Located, Sources, Span, Text};

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
        let piece = |start: usize, piece: &str| {
            let trimmed = piece.trim();
            let start = start + piece.find(trimmed).unwrap_or(0);
            let span = Span::new(start as u32, (start + trimmed.len()) as u32);
            Located::new(trimmed.into(), span.in_file(file))
        };
        let found = text.split_once('=').filter(|(name, _)| !name.trim().is_empty());
        let Some((name, value)) = found else {
            let message = match text.find('=') {
                None => format!("{} sets nothing: there is no `=`", quoted(text)),
                Some(_) => "there is no name before the `=`".to_owned(),
            };
            let place = Span::new(0, text.len() as u32).in_file(file);
            let help = format!("write `{option} NAME=VALUE` with the name of a composite property");
            diagnostics.push(Diagnostic::new(&codes::SETTING_MALFORMED, place, message).help(help));
            return None;
        };
        Some(Self { name: piece(0, name), value: piece(name.len() + 1, value) })
    }
}
