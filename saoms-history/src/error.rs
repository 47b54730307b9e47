use std::fmt;
use std::path::PathBuf;

/// A history that cannot be opened, or a question that it cannot answer.
#[derive(Debug)]
pub enum HistoryError {
    /// There is no file.
    Missing {
        /// The path.
        path: PathBuf,
    },
    /// The file is no database, or one of another program.
    Foreign {
        /// The path.
        path: PathBuf,
    },
    /// The history is of a later version of this program.
    Version {
        /// The path.
        path: PathBuf,
        /// The version of its tables.
        version: i64,
    },
    /// A table of a crate of components was made by another version of that crate, without a column that this one has.
    Table {
        /// The path.
        path: PathBuf,
        /// The table.
        table: String,
        /// The column.
        column: String,
    },
    /// The question is no question: it would change the history.
    Writes,
    /// There are several questions, or none.
    NoQuestion,
    /// The question is wrong.
    Question {
        /// What SQLite says.
        message: String,
    },
    /// The database refuses something.
    Database {
        /// The path.
        path: PathBuf,
        /// What SQLite says.
        message: String,
    },
}

impl fmt::Display for HistoryError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            HistoryError::Missing { path } => write!(
                formatter,
                "there is no history at `{}`: `saoms run FILE --history {}` writes one",
                path.display(),
                path.display()
            ),
            HistoryError::Foreign { path } => write!(
                formatter,
                "`{}` is no history of a fleet: name another file, or one that does not exist",
                path.display()
            ),
            HistoryError::Version { path, version } => write!(
                formatter,
                "the tables of `{}` are of version {version}, and this program knows those up to version {}: use the \
                 version of SAOMS that wrote it, or name another file",
                path.display(),
                crate::tables::VERSION
            ),
            HistoryError::Table { path, table, column } => write!(
                formatter,
                "the table `{table}` of `{}` has no column `{column}`, which this program writes: name another file",
                path.display()
            ),
            HistoryError::Writes => formatter
                .write_str("this would change the history, which can only be asked: begin with `select` or `with`"),
            HistoryError::NoQuestion => formatter.write_str("expected one question in SQL, as `select * from runs`"),
            HistoryError::Question { message } => write!(formatter, "the question cannot be answered: {message}"),
            HistoryError::Database { path, message } => {
                write!(formatter, "the history `{}` cannot be used: {message}", path.display())
            }
        }
    }
}

impl std::error::Error for HistoryError {}
