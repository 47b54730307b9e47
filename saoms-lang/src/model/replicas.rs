//! Components that stand for several.

use crate::source::{FileId, Text};

/// Replicas of a component.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replicas {
    /// `count`: an expression; how many there are. `None` when only the others are given, or a name that uses the
    /// index.
    pub count: Option<Text>,
    /// `from`: an expression; the index of the first.
    pub from: Option<Text>,
    /// `overrides`: the file of the table.
    pub overrides: Option<Text>,
    /// The content of that file; `None` until [`read_values`](crate::contribution::read_values), and where it cannot be
    /// read.
    pub table: Option<Table>,
}

/// A table of what differs from one replica to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The file.
    pub file: FileId,
    /// The heading of the first column: `index` or `name`.
    pub key: Text,
    /// The properties of the other columns.
    pub properties: Vec<Text>,
    /// The lines below the first.
    pub rows: Vec<Row>,
}

/// A line of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The replica that it is about.
    pub key: Text,
    /// A value for each property; `None` for a replica that has its own.
    pub values: Vec<Option<Text>>,
}
