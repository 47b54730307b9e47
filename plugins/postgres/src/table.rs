//! The tables that a history has, as its file says.

use std::collections::HashMap;

use saoms_api::extension::HistoryValue;
use saoms_history::table_docs;

/// A table of a history.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Table {
    pub(crate) name: String,
    /// What a row is; empty if the file does not say it.
    pub(crate) doc: String,
    pub(crate) columns: Vec<Column>,
    /// The places of the columns that tell rows apart; none in tables of crates of components.
    pub(crate) key: Vec<usize>,
    /// Names and columns of what finds rows faster.
    pub(crate) indexes: Vec<(String, Vec<String>)>,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) doc: String,
}

/// What stands in a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Integer,
    Real,
    Text,
    Json,
}

/// How new rows of a table are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Growth {
    /// Rows are only added, each behind the others.
    Rows,
    /// The same within each run, by the number of the record.
    Records,
    /// Rows are added and changed, while their run lasts.
    Changing,
}

/// A row, with a value for each column.
pub(crate) type Row = Vec<HistoryValue>;

impl Kind {
    /// The kind of a column, by its type in SQLite and what is said of it.
    pub(crate) fn of(declared: &str, doc: &str) -> Kind {
        match declared {
            "INTEGER" => Kind::Integer,
            "REAL" => Kind::Real,
            _ if doc.contains("as JSON") => Kind::Json,
            _ => Kind::Text,
        }
    }

    /// The type in PostgreSQL.
    pub(crate) fn in_postgres(self) -> &'static str {
        match self {
            Kind::Integer => "bigint",
            Kind::Real => "double precision",
            Kind::Text => "text",
            Kind::Json => "jsonb",
        }
    }
}

impl Table {
    pub(crate) fn growth(&self) -> Growth {
        match (self.name.as_str(), self.key.is_empty()) {
            (_, true) => Growth::Rows,
            ("records", false) => Growth::Records,
            _ => Growth::Changing,
        }
    }

    /// True if the rows are those of runs, each of which has several.
    pub(crate) fn is_of_runs(&self) -> bool {
        self.name != "runs" && self.columns.iter().any(|column| column.name == "run")
    }

    /// The names of the columns that tell rows apart.
    pub(crate) fn key_names(&self) -> impl Iterator<Item = &str> {
        self.key.iter().filter_map(|place| self.columns.get(*place)).map(|column| column.name.as_str())
    }
}

/// What is said of a table and, by their names, of its columns: in the comments of the statement that made it. A file
/// of an earlier SAOMS has none; what this program knows of its tables is taken then.
pub(crate) fn docs(name: &str, statement: &str) -> (String, HashMap<String, String>) {
    let mut doc = String::new();
    let mut columns = HashMap::new();
    for line in statement.lines().skip(1) {
        match line.trim().split_once("-- ") {
            Some(("", text)) => text.clone_into(&mut doc),
            Some((column, text)) => {
                let column = column.split_whitespace().next().unwrap_or_default();
                columns.insert(column.to_owned(), text.to_owned());
            }
            None => {}
        }
    }
    let own = table_docs().into_iter().find(|table| table.name == name).filter(|_| doc.is_empty());
    match own {
        Some(own) => {
            let columns = own.columns.iter().map(|column| (column.name.to_owned(), column.doc.to_owned()));
            (own.doc.to_owned(), columns.collect())
        }
        None => (doc, columns),
    }
}
