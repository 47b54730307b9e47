use std::fmt;
use std::io;
use std::path::PathBuf;

/// A file that is no recording, or cannot be read or written.
#[derive(Debug)]
pub enum RecordingError {
    /// The file is no recording.
    Foreign {
        /// The path.
        path: PathBuf,
    },
    /// The system refuses to read or write it.
    Io {
        /// The path.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// It cannot be put into the form of such a file, or its form is not one that this program knows.
    Form {
        /// The path.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
}

impl fmt::Display for RecordingError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RecordingError::Foreign { path } => write!(
                formatter,
                "`{}` is no recording: `saoms run FILE --record FILE.mcap` writes one, in the format MCAP",
                path.display()
            ),
            RecordingError::Io { path, error } => write!(formatter, "`{}`: {error}", path.display()),
            RecordingError::Form { path, message } => write!(formatter, "`{}`: {message}", path.display()),
        }
    }
}

impl std::error::Error for RecordingError {}
