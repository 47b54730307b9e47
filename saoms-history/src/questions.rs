use std::path::Path;
use std::time::Duration;

use rusqlite::types::ValueRef;
use rusqlite::{Connection, OpenFlags};
use saoms_api::extension::HistoryValue;

use crate::HistoryError;
use crate::writer::{Value, check, refused};

/// A history that is asked, also while a fleet writes it.
#[derive(Debug)]
pub struct Questions {
    connection: Connection,
}

/// The answer to a question.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The names of the columns.
    pub columns: Vec<String>,
    /// The rows, with a value for each column. Bytes are texts here; those that are no UTF-8 are replaced.
    pub rows: Vec<Vec<HistoryValue>>,
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
        Ok(Questions { connection })
    }

    /// Asks a question in SQL.
    ///
    /// # Errors
    /// It is no question, or wrong.
    pub fn ask(&self, question: &str) -> Result<Answer, HistoryError> {
        self.ask_with(question, &[])
    }

    /// Asks a question in SQL with a value for each `?`.
    ///
    /// # Errors
    /// It is no question, or wrong.
    pub fn ask_with(&self, question: &str, values: &[HistoryValue]) -> Result<Answer, HistoryError> {
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
        let values = rusqlite::params_from_iter(values.iter().map(Value));
        let mut found = statement.query(values).map_err(wrong)?;
        let mut rows = Vec::new();
        while let Some(row) = found.next().map_err(wrong)? {
            rows.push(
                (0..count).map(|column| row.get_ref(column).map(value)).collect::<Result<_, _>>().map_err(wrong)?,
            );
        }
        Ok(Answer { columns, rows })
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

pub(crate) fn value(value: ValueRef<'_>) -> HistoryValue {
    match value {
        ValueRef::Null => HistoryValue::Null,
        ValueRef::Integer(value) => HistoryValue::Integer(value),
        ValueRef::Real(value) => HistoryValue::Real(value),
        ValueRef::Text(text) | ValueRef::Blob(text) => HistoryValue::Text(String::from_utf8_lossy(text).into_owned()),
    }
}
