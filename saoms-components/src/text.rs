//! Faults in property texts.

use std::fmt;
use std::ops::Range;

use saoms_api::{Finding, Place};

/// A fault in a part of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextFault {
    /// Byte range of the fault.
    pub bytes: Range<usize>,
    /// Message: what was found, and what was expected.
    pub message: String,
    /// Probable correction of the text in the range.
    pub instead: Option<String>,
    /// Help text.
    pub help: Option<String>,
}

impl TextFault {
    /// A fault in a byte range.
    pub fn new(bytes: Range<usize>, message: impl Into<String>) -> TextFault {
        TextFault { bytes, message: message.into(), instead: None, help: None }
    }

    /// A fault in a part of a text.
    pub(crate) fn of(text: &str, part: &str, message: impl Into<String>) -> TextFault {
        TextFault::new(bytes(text, part), message)
    }

    /// The fault of a text that is the name of a file, where the contents are expected.
    pub(crate) fn of_file_name(text: &str) -> Option<TextFault> {
        let name = text.trim();
        let (stem, ending) = name.rsplit_once('.').filter(|_| !name.contains(char::is_whitespace))?;
        let is_name = !stem.is_empty()
            && (3..=8).contains(&ending.len())
            && ending.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit());
        is_name.then(|| {
            TextFault::of(text, name, format!("found the file name `{name}`, expected the contents of a file"))
                .help(format!("write `file=\"{name}\"` in place of the value: the property is then read from the file"))
        })
    }

    /// Adds the probable correction.
    #[must_use]
    pub fn instead(self, meant: Option<impl Into<String>>) -> TextFault {
        TextFault { instead: meant.map(Into::into), ..self }
    }

    /// Adds a help text.
    #[must_use]
    pub fn help(self, text: impl Into<String>) -> TextFault {
        TextFault { help: Some(text.into()), ..self }
    }

    /// The fault as a finding about a value of a property.
    pub(crate) fn finding(self, property: &str, value: usize) -> Finding {
        let mut finding = Finding::new(Place::property(property).part(value, self.bytes), self.message);
        if let Some(instead) = self.instead {
            finding = finding.instead(instead);
        }
        match self.help {
            Some(help) => finding.help(help),
            None => finding,
        }
    }
}

impl fmt::Display for TextFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl std::error::Error for TextFault {}

/// Byte range of a part within its text.
pub(crate) fn bytes(text: &str, part: &str) -> Range<usize> {
    let start = (part.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize).min(text.len());
    start..(start + part.len()).min(text.len())
}
