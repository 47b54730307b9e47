use std::error::Error;

use postgres::error::SqlState;
use saoms_api::host::one_line;
use saoms_history::HistoryError;

/// Why rows are not brought.
#[derive(Debug)]
pub(crate) enum Problem {
    /// What was given is wrong, or the server refuses it: trying again helps nothing.
    Wrong(String),
    /// The server or the file cannot be used at present.
    Away(String),
    /// Another program has brought rows of the same history to the same schema meanwhile.
    Overtaken,
}

/// What comes of a server or a file.
pub(crate) type Outcome<T> = Result<T, Problem>;

/// Classes of errors of a server that can be over later: of the connection, of the state of a transaction (as at a
/// server that only reads until it takes over), of resources, of an operator, of the system, of two transactions, of
/// objects in use, of the server itself.
const PASSING: [&str; 8] = ["08", "25", "53", "57", "58", "40", "55", "XX"];

/// Classes of errors that are those of a row: data, constraints, limits, and what triggers say.
const OF_ROWS: [&str; 4] = ["22", "23", "54", "P0"];

/// Errors that are no answer of the server, by how they begin, but that trying again does not end.
const LASTING: [&str; 4] =
    ["error performing TLS handshake", "authentication error", "invalid configuration", "error serializing parameter"];

impl Problem {
    /// What a server did not do, with its reason.
    pub(crate) fn of(what: &str, error: &postgres::Error) -> Problem {
        let mut text = format!("{what}: {}", reason(error));
        if error.code() == Some(&SqlState::INSUFFICIENT_PRIVILEGE) {
            text.push_str(
                "; let its owner grant the user all rights to it, or name a schema of the user with `--schema`",
            );
        }
        let is_passing = match error.code() {
            Some(code) => is_in(code, &PASSING),
            None => {
                let text = error.to_string();
                !LASTING.iter().any(|start| text.starts_with(start))
            }
        };
        if is_passing { Problem::Away(text) } else { Problem::Wrong(text) }
    }
}

impl From<HistoryError> for Problem {
    fn from(error: HistoryError) -> Problem {
        let text = error.to_string();
        match error {
            HistoryError::Database { .. } | HistoryError::Question { .. } => Problem::Away(text),
            _ => Problem::Wrong(text),
        }
    }
}

fn is_in(code: &SqlState, classes: &[&str]) -> bool {
    classes.iter().any(|class| code.code().starts_with(class))
}

/// True if a server refuses a row for what stands in it.
pub(crate) fn is_of_a_row(error: &postgres::Error) -> bool {
    error.code().is_some_and(|code| is_in(code, &OF_ROWS))
}

/// What the server says, or what hinders the connection, on one line.
pub(crate) fn reason(error: &postgres::Error) -> String {
    if let Some(answer) = error.as_db_error() {
        let detail = answer.detail().map(|detail| format!(" ({detail})")).unwrap_or_default();
        return one_line(&format!("{}{detail}", answer.message())).into_owned();
    }
    let mut causes = vec![error.to_string()];
    let mut next = error.source();
    while let Some(cause) = next {
        causes.push(cause.to_string());
        next = cause.source();
    }
    one_line(&causes.join(": ")).into_owned()
}
