use crate::host::{SharedMessage, TopicDeclaration};

/// What a crate of components adds to the history of a fleet: rows of its own tables, from the messages of the fleet.
///
/// Messages are those that were sent, before any fault acts on their ways; they come in the order in which they were
/// sent.
pub trait RunHistory: Send {
    /// True if the messages of a topic are needed, which its publishers declare so and call `name` after renaming.
    /// Asked before the first message of the topic.
    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool;

    /// Takes in a message that a component sent on such a topic, and gives the rows that follow from it; `component` is
    /// the path of the component.
    fn message(&mut self, topic: &str, component: &str, message: &SharedMessage) -> Vec<HistoryRow>;

    /// Takes in a row that an earlier program wrote of what this one goes on with, with its time in seconds of the run:
    /// before the first message, the rows of each table in the order in which they were written. They are read one by
    /// one, as many as there are: what is kept of them should not grow with what is over.
    fn goes_on(&mut self, time_s: f64, row: &HistoryRow) {
        let _ = (time_s, row);
    }
}

/// A table of the history. Each of its rows also has the number of the run, `run`, and the time of the message that it
/// follows from, `time_s`, in seconds of the run.
///
/// Tables and columns stay as they are: people and programs ask for them by name. A later version may add some.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HistoryTable {
    /// The name, which is one of SQL without quotes: `deliveries`.
    pub name: &'static str,
    /// What a row is, in a sentence.
    pub doc: &'static str,
    /// The columns, behind `run` and `time_s`.
    pub columns: &'static [HistoryColumn],
}

/// A column of a table of the history. Each may be empty (`NULL`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HistoryColumn {
    /// The name, which is one of SQL without quotes: `asked_s`.
    pub name: &'static str,
    /// What its values are.
    pub kind: HistoryKind,
    /// What it says, with its unit.
    pub doc: &'static str,
}

/// Kinds of values in the history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HistoryKind {
    /// Whole numbers.
    Integer,
    /// Numbers.
    Real,
    /// Texts.
    Text,
}

/// A row of a table of the history.
#[derive(Clone, Debug, PartialEq)]
pub struct HistoryRow {
    /// The place of the table in the [registration](HistoryRegistration).
    pub table: usize,
    /// A value for each column of the table, in their order. Missing ones are empty, others are ignored.
    pub values: Vec<HistoryValue>,
}

/// A value in the history.
#[derive(Clone, Debug, PartialEq)]
pub enum HistoryValue {
    /// Nothing.
    Null,
    /// A whole number.
    Integer(i64),
    /// A number.
    Real(f64),
    /// A text.
    Text(String),
}

impl<T: Into<HistoryValue>> From<Option<T>> for HistoryValue {
    fn from(value: Option<T>) -> HistoryValue {
        value.map_or(HistoryValue::Null, Into::into)
    }
}

impl From<u32> for HistoryValue {
    fn from(value: u32) -> HistoryValue {
        HistoryValue::Integer(value.into())
    }
}

impl From<i32> for HistoryValue {
    fn from(value: i32) -> HistoryValue {
        HistoryValue::Integer(value.into())
    }
}

impl From<f64> for HistoryValue {
    fn from(value: f64) -> HistoryValue {
        HistoryValue::Real(value)
    }
}

impl From<&str> for HistoryValue {
    fn from(value: &str) -> HistoryValue {
        HistoryValue::Text(value.to_owned())
    }
}

/// The registration of tables of the history.
#[derive(Clone, Copy, Debug)]
pub struct HistoryRegistration {
    /// The tables.
    pub tables: &'static [HistoryTable],
    /// Makes the state of one run.
    pub new: fn() -> Box<dyn RunHistory>,
}

inventory::collect!(HistoryRegistration);

impl HistoryRegistration {
    /// The tables that are linked into this program, by the name of the first one.
    pub fn linked() -> Vec<&'static HistoryRegistration> {
        let mut all: Vec<&HistoryRegistration> = inventory::iter::<HistoryRegistration>().collect();
        all.sort_by_key(|one| one.tables.first().map(|table| table.name));
        all
    }
}
