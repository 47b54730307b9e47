//! Faults in the texts of properties.

use std::fmt;
use std::ops::Range;

use saoms_api::{Finding, Place};

/// What is wrong with a part of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextFault {
    /// Which bytes of the text.
    pub bytes: Range<usize>,
    /// What was found, and what was expected.
    pub message: String,
    /// What probably is meant in their place.
    pub instead: Option<String>,
    /// What to do.
    pub help: Option<String>,
}

impl TextFault {
    /// A fault in these bytes.
    pub fn new(bytes: Range<usize>, message: impl Into<String>) -> TextFault {
        TextFault { bytes, message: message.into(), instead: None, help: None }
    }

    /// A fault in a part of a text.
    pub(crate) fn of(text: &str, part: &str, message: impl Into<String>) -> TextFault {
        TextFault::new(bytes(text, part), message)
    }

    /// The same fault with what probably is meant.
    #[must_use]
    pub fn instead(self, meant: Option<impl Into<String>>) -> TextFault {
        TextFault { instead: meant.map(Into::into), ..self }
    }

    /// The same fault with what to do.
    #[must_use]
    pub fn help(self, text: impl Into<String>) -> TextFault {
        TextFault { help: Some(text.into()), ..self }
    }

    /// What a constructor says about it, where the text is this value of the property.
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

/// Where in a text its part is.
pub(crate) fn bytes(text: &str, part: &str) -> Range<usize> {
    let start = (part.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize).min(text.len());
    start..(start + part.len()).min(text.len())
}
