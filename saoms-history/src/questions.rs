use std::path::{Path, PathBuf};
use std::time::Duration;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, OpenFlags};

use crate::HistoryError;
use crate::writer::{check, refused};

/// A history that is asked, also while a fleet writes it.
#[derive(Debug)]
pub struct Questions {
    path: PathBuf,
    connection: Connection,
}

/// The answer to a question.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The rows, with a cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell of an answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// A text. Bytes that are no UTF-8 are replaced.
    Text(String),
}

/// Time for which a question waits for a program that repairs or ends the database.
const BUSY: Duration = Duration::from_secs(2);

impl Questions {
    /// Opens a history for reading.
    ///
    /// # Errors
    /// There is none at the path, or it cannot be read.
    pub fn open(path: &Path) -> Result<Questions, HistoryError> {
        if !path.exists() {
            return Err(HistoryError::Missing { path: path.to_owned() });
        }
        let of_database = |error: rusqlite::Error| refused(path, &error);
        // Who may only read leaves the files of the log behind. A file that cannot be written is opened for reading.
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection = Connection::open_with_flags(path, flags).map_err(of_database)?;
        connection.busy_timeout(BUSY).map_err(of_database)?;
        connection.pragma_update(None, "query_only", true).map_err(of_database)?;
        check(path, &connection)?;
        Ok(Questions { path: path.to_owned(), connection })
    }

    /// Asks a question in SQL.
    ///
    /// # Errors
    /// It is no question, or wrong.
    pub fn ask(&self, question: &str) -> Result<Answer, HistoryError> {
        let wrong = |error: rusqlite::Error| match error {
            rusqlite::Error::MultipleStatement => HistoryError::NoQuestion,
            error => HistoryError::Question { message: reason(&error) },
        };
        let mut statement = self.connection.prepare(question).map_err(wrong)?;
        if !statement.readonly() {
            return Err(HistoryError::Writes);
        }
        if statement.column_count() == 0 {
            return Err(HistoryError::NoQuestion);
        }
        let columns: Vec<String> = statement.column_names().map(str::to_owned).collect();
        let count = columns.len();
        let mut found = statement.query([]).map_err(wrong)?;
        let mut rows = Vec::new();
        while let Some(row) = found.next().map_err(wrong)? {
            rows.push((0..count).map(|column| row.get_ref(column).map(cell)).collect::<Result<_, _>>().map_err(wrong)?);
        }
        Ok(Answer { columns, rows })
    }

    /// The path of the history.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// What SQLite says, without the code.
fn reason(error: &rusqlite::Error) -> String {
    match error {
        rusqlite::Error::SqliteFailure(_, Some(text)) => text.clone(),
        rusqlite::Error::SqlInputError { msg, .. } => msg.clone(),
        error => error.to_string(),
    }
}

fn cell(value: ValueRef<'_>) -> Cell {
    match value {
        ValueRef::Null => Cell::Null,
        ValueRef::Integer(value) => Cell::Integer(value),
        ValueRef::Real(value) => Cell::Real(value),
        ValueRef::Text(text) | ValueRef::Blob(text) => Cell::Text(String::from_utf8_lossy(text).into_owned()),
    }
}
