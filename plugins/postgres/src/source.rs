//! The history that is read.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use saoms_api::extension::HistoryValue;
use saoms_history::{HistoryError, Questions};

use crate::problem::{Outcome, Problem};
use crate::table::{Column, Kind, Row, Table, docs};

/// A history that is read, also while fleets write it. Each question is a transaction of its own: a server that is
/// away for long does not keep the log of the file from being emptied.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) path: PathBuf,
    /// Its name, which is made by chance.
    pub(crate) id: String,
    questions: Questions,
    /// The device and the number of the file.
    place: (u64, u64),
}

/// A run of a history.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    pub(crate) run: i64,
    /// What runs as several runs, one after another: a composite, and the node of it.
    pub(crate) program: String,
    pub(crate) began: String,
    pub(crate) has_ended: bool,
}

impl Source {
    pub(crate) fn open(path: &Path) -> Outcome<Source> {
        let missing = || Problem::from(HistoryError::Missing { path: path.to_owned() });
        let place = place(path).ok_or_else(missing)?;
        let questions = Questions::open(path)?;
        let source = Source { path: path.to_owned(), id: String::new(), questions, place };
        let is_named = source.ask("SELECT 1 FROM sqlite_schema WHERE name = 'history'", &[])?;
        let id = if is_named.is_empty() { Vec::new() } else { source.ask("SELECT id FROM history", &[])? };
        match id.first().and_then(|row| row.first()) {
            Some(HistoryValue::Text(id)) => Ok(Source { id: id.clone(), ..source }),
            _ => Err(Problem::Wrong(format!(
                "the history `{}` has no name, as it was written by an earlier SAOMS: it gets one when \
                 `saoms run FILE --history {}` begins the next run",
                path.display(),
                path.display()
            ))),
        }
    }

    /// Refuses a path that leads to another file by now.
    pub(crate) fn is_still_there(&self) -> Outcome<()> {
        if place(&self.path) == Some(self.place) {
            return Ok(());
        }
        Err(Problem::Wrong(format!(
            "the history `{}` was removed or replaced while it was read: start again with the one that is meant",
            self.path.display()
        )))
    }

    /// The number of the version of the tables: it changes when tables are added or changed.
    pub(crate) fn tables_version(&self) -> Outcome<i64> {
        let rows = self.ask("SELECT schema_version FROM pragma_schema_version", &[])?;
        Ok(rows.first().and_then(|row| row.first()).and_then(integer).unwrap_or_default())
    }

    /// A number that changes when another program has written.
    pub(crate) fn data_version(&self) -> Outcome<i64> {
        let rows = self.ask("SELECT data_version FROM pragma_data_version", &[])?;
        Ok(rows.first().and_then(|row| row.first()).and_then(integer).unwrap_or_default())
    }

    /// The tables, in the order in which they were made.
    pub(crate) fn tables(&self) -> Outcome<Vec<Table>> {
        let question = "SELECT name, sql FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%' \
                        ORDER BY rowid";
        self.ask(question, &[])?.into_iter().map(|row| self.table(row)).collect()
    }

    fn table(&self, row: Row) -> Outcome<Table> {
        let mut texts = row.into_iter().map(text);
        let (name, statement) = (texts.next().unwrap_or_default(), texts.next().unwrap_or_default());
        let (doc, mut said) = docs(&name, &statement);
        let asked = [HistoryValue::Text(name.clone())];
        let found = self.ask("SELECT name, type, pk FROM pragma_table_info(?) ORDER BY cid", &asked)?;
        let (mut columns, mut key) = (Vec::new(), Vec::new());
        for (place, row) in found.into_iter().enumerate() {
            let part = row.get(2).and_then(integer).unwrap_or_default();
            let mut texts = row.into_iter().map(text);
            let (name, kind) = (texts.next().unwrap_or_default(), texts.next().unwrap_or_default());
            let doc = said.remove(&name).unwrap_or_default();
            if part > 0 {
                key.push((part, place));
            }
            columns.push(Column { kind: Kind::of(&kind, &doc), name, doc });
        }
        key.sort_unstable();
        let mut indexes = Vec::new();
        for row in self.ask("SELECT name FROM pragma_index_list(?) WHERE origin = 'c' ORDER BY name", &asked)? {
            let name = row.into_iter().next().map(text).unwrap_or_default();
            let asked = [HistoryValue::Text(name.clone())];
            let parts = self.ask("SELECT name FROM pragma_index_info(?) ORDER BY seqno", &asked)?;
            indexes.push((name, parts.into_iter().flatten().map(text).collect()));
        }
        Ok(Table { name, doc, columns, key: key.into_iter().map(|(_, place)| place).collect(), indexes })
    }

    /// All runs.
    pub(crate) fn runs(&self, tables: &[Table]) -> Outcome<Vec<Run>> {
        let Some(table) = tables.iter().find(|table| table.name == "runs") else { return Ok(Vec::new()) };
        // A file of an earlier SAOMS has no nodes.
        let has_nodes = table.columns.iter().any(|column| column.name == "node");
        let program = if has_nodes { "name || '@' || coalesce(node, '')" } else { "name" };
        let question = format!("SELECT run, {program}, began, ended IS NOT NULL FROM runs ORDER BY run");
        let rows = self.ask(&question, &[])?;
        let run = |row: Row| {
            let mut values = row.into_iter();
            let run = values.next().as_ref().and_then(integer)?;
            let (program, began) = (values.next().map(text)?, values.next().map(text)?);
            Some(Run { run, program, began, has_ended: values.next().as_ref().and_then(integer) == Some(1) })
        };
        Ok(rows.into_iter().filter_map(run).collect())
    }

    /// The rows that answer a question.
    pub(crate) fn ask(&self, question: &str, values: &[HistoryValue]) -> Outcome<Vec<Row>> {
        Ok(self.questions.ask_with(question, values)?.rows)
    }
}

fn place(path: &Path) -> Option<(u64, u64)> {
    fs::metadata(path).ok().map(|found| (found.dev(), found.ino()))
}

/// The number that a value is.
pub(crate) fn integer(value: &HistoryValue) -> Option<i64> {
    if let HistoryValue::Integer(value) = value { Some(*value) } else { None }
}

fn text(value: HistoryValue) -> String {
    if let HistoryValue::Text(text) = value { text } else { String::new() }
}
