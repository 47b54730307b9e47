use std::fmt;
use std::path::PathBuf;

/// Something wrong with the files of a [`Problem`](crate::Problem), and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProblemFault {
    /// The file.
    pub file: PathBuf,
    /// Line and column, both from 1; `None` if the file cannot be read.
    pub place: Option<(usize, usize)>,
    /// What was found, and what was expected.
    pub message: String,
    /// What to do.
    pub help: String,
}

impl ProblemFault {
    /// A fault at a byte of the text of a file.
    pub(super) fn at(file: &std::path::Path, text: &str, byte: usize, message: String, help: &str) -> ProblemFault {
        let before = &text[..byte.min(text.len())];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        ProblemFault { file: file.to_owned(), place: Some((line, column)), message, help: help.to_owned() }
    }
}

impl fmt::Display for ProblemFault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ProblemFault { file, place, message, help } = self;
        write!(formatter, "error: {message}\n --> {}", file.display())?;
        if let Some((line, column)) = place {
            write!(formatter, ":{line}:{column}")?;
        }
        write!(formatter, "\n  = help: {help}")
    }
}
