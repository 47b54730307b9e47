//! The tables of the history, and what stands in them. They stay as they are; a later version may add some.

use std::fmt;

use saoms_api::extension::{HistoryColumn, HistoryKind, HistoryRegistration, HistoryTable};

/// The version of the tables, which the database has as its `user_version`.
pub(crate) const VERSION: i64 = 1;

/// The mark by which a database is known as a history: `SAOM`.
pub(crate) const APPLICATION: i64 = 0x5341_4f4d;

/// A table of this crate.
pub(crate) struct OwnTable {
    pub(crate) name: &'static str,
    pub(crate) doc: &'static str,
    pub(crate) columns: &'static [OwnColumn],
    /// What follows the columns: the key by which the rows are stored.
    pub(crate) keys: &'static str,
}

/// A column, with its type in SQL and what it says.
pub(crate) struct OwnColumn(pub(crate) &'static str, pub(crate) &'static str, pub(crate) &'static str);

pub(crate) const OWN: &[OwnTable] = &[
    OwnTable {
        name: "runs",
        doc: "A run of a fleet, in one program",
        columns: &[
            OwnColumn("run", "INTEGER PRIMARY KEY", "its number in this history, from 1 on"),
            OwnColumn("name", "TEXT NOT NULL", "the name of its first composite"),
            OwnColumn("composites", "TEXT NOT NULL", "the files of its composites, as JSON"),
            OwnColumn("node", "TEXT", "the node, of a fleet in several programs"),
            OwnColumn("version", "TEXT NOT NULL", "the version of the program"),
            OwnColumn("clock", "TEXT NOT NULL", "`real` or `virtual`"),
            OwnColumn("seed", "TEXT NOT NULL", "the seed of all chance"),
            OwnColumn("began", "TEXT NOT NULL", "date and time of its begin, in UTC"),
            OwnColumn("ended", "TEXT", "the same of its end; empty while it runs, or if the program was killed"),
            OwnColumn("time_s", "REAL", "how long it took, in seconds of the run"),
            OwnColumn("status", "TEXT", "how it ended, as in its report: `done`, `incomplete`, `failed` ..."),
            OwnColumn(
                "state",
                "TEXT",
                "its state folder, by a name made by chance: runs with the same one go on from each other",
            ),
            OwnColumn(
                "goes_on_from_s",
                "REAL",
                "the time of the run from which it goes on from its state folder; empty if it began anew",
            ),
            OwnColumn(
                "undone_from_s",
                "REAL",
                "the time of the run from which a later run goes on: what this one did from then on, that one does again",
            ),
            OwnColumn(
                "lost",
                "INTEGER NOT NULL DEFAULT 0",
                "number of rows that could not be written, with all alerts and messages that were lost before",
            ),
        ],
        keys: "",
    },
    OwnTable {
        name: "components",
        doc: "A component of a run",
        columns: &[
            OwnColumn("run", "INTEGER NOT NULL", "the run"),
            OwnColumn("component", "TEXT NOT NULL", "its path, as `North/Gate`"),
            OwnColumn("id", "TEXT", "its `ID`"),
            OwnColumn("period_s", "REAL", "its period, in seconds"),
        ],
        keys: ", PRIMARY KEY (run, component)",
    },
    OwnTable {
        name: "records",
        doc: "A record of the journal: what a component saw, decided or did",
        columns: &[
            OwnColumn("run", "INTEGER NOT NULL", "the run"),
            OwnColumn("id", "INTEGER NOT NULL", "its number in the run"),
            OwnColumn("time_s", "REAL NOT NULL", "when, in seconds of the run"),
            OwnColumn("component", "TEXT NOT NULL", "the component that wrote it"),
            OwnColumn("loop", "TEXT", "the loop of the component"),
            OwnColumn("phase", "TEXT NOT NULL", "`symptom`, `decision` or `effect`"),
            OwnColumn("record", "TEXT", "its name, as `goes_on`, which stays when the text is reworded"),
            OwnColumn("entry", "TEXT", "the entry of the knowledge that changed; empty for all other records"),
            OwnColumn("text", "TEXT NOT NULL", "what it says"),
            OwnColumn(
                "data",
                "TEXT",
                "its values by name, as JSON: `data ->> 'NAME'`; of a change `before` and `after`",
            ),
            OwnColumn("cause", "INTEGER", "the record that it follows from"),
        ],
        keys: ", PRIMARY KEY (run, id)",
    },
    OwnTable {
        name: "alerts",
        doc: "What needed a person",
        columns: &[
            OwnColumn("run", "INTEGER NOT NULL", "the run"),
            OwnColumn("alert", "INTEGER NOT NULL", "its number in the run, from 1 on"),
            OwnColumn("kind", "TEXT NOT NULL", "its kind, as `assistance`"),
            OwnColumn("component", "TEXT", "the component; empty for the whole fleet"),
            OwnColumn("subject", "TEXT NOT NULL", "what it is about, where a component has several of a kind"),
            OwnColumn("text", "TEXT NOT NULL", "what is wrong, as it was said last"),
            OwnColumn("raised_s", "REAL NOT NULL", "when it began, in seconds of the run"),
            OwnColumn("over_s", "REAL", "when it was over; empty while it is not"),
        ],
        keys: ", PRIMARY KEY (run, alert)",
    },
    OwnTable {
        name: "reports",
        doc: "The report of a run that has ended, without the records",
        columns: &[
            OwnColumn("run", "INTEGER PRIMARY KEY", "the run"),
            OwnColumn("report", "TEXT NOT NULL", "the report as JSON: `report ->> '$.outcome.status'`"),
        ],
        keys: "",
    },
    OwnTable {
        name: "history",
        doc: "This history",
        columns: &[OwnColumn("id", "TEXT NOT NULL", "its name, made by chance: what copies it knows it by that")],
        keys: ", PRIMARY KEY (id)",
    },
];

/// What gives a history its name, unless it has one.
pub(crate) const NAME: &str =
    "INSERT INTO history (id) SELECT lower(hex(randomblob(16))) WHERE NOT EXISTS (SELECT 1 FROM history)";

impl OwnTable {
    pub(crate) fn statement(&self) -> String {
        let columns = self.columns.iter().map(|OwnColumn(name, kind, doc)| (*name, *kind, *doc));
        let rowid = if self.keys.is_empty() { "" } else { ", WITHOUT ROWID" };
        format!("{}{}) STRICT{rowid}", table_start(self.name, self.doc, columns), self.keys)
    }
}

/// The statement that makes a table up to its last column. It says what stands in the table and in each column, so that
/// whoever has the file alone knows it: SQLite keeps the comments of a statement.
fn table_start<'a>(name: &str, doc: &str, columns: impl Iterator<Item = (&'a str, &'a str, &'a str)>) -> String {
    let comment = |doc: &str| doc.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut text = format!("CREATE TABLE IF NOT EXISTS {name} (\n  -- {}\n", comment(doc));
    let mut columns = columns.peekable();
    while let Some((name, kind, doc)) = columns.next() {
        let comma = if columns.peek().is_some() { "," } else { "" };
        text.push_str(format!("  {name} {kind}{comma} -- {}", comment(doc)).trim_end_matches([' ', '-']));
        text.push('\n');
    }
    text
}

const fn kind(column: &HistoryColumn) -> &'static str {
    match column.kind {
        HistoryKind::Integer => "INTEGER",
        HistoryKind::Real => "REAL",
        HistoryKind::Text => "TEXT",
    }
}

/// What the columns say that all tables of crates of components have.
const RUN: &str = "the run";
const TIME: &str = "when, in seconds of the run";

/// The statements that make the table of a crate of components, and what finds its rows of a run: by their times, and
/// in the order in which they were written, which a program wants that goes on from them.
pub(crate) fn statements(table: &HistoryTable) -> [String; 3] {
    let columns = table.columns.iter().map(|column| (column.name, kind(column), column.doc));
    let columns = [("run", "INTEGER NOT NULL", RUN), ("time_s", "REAL NOT NULL", TIME)].into_iter().chain(columns);
    let name = table.name;
    [
        format!("{}) STRICT", table_start(name, table.doc, columns)),
        format!("CREATE INDEX IF NOT EXISTS {name}_of_run ON {name} (run, time_s)"),
        format!("CREATE INDEX IF NOT EXISTS {name}_as_written ON {name} (run)"),
    ]
}

/// A table of the history, for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableDoc {
    /// The name.
    pub name: &'static str,
    /// What a row is.
    pub doc: &'static str,
    /// The columns.
    pub columns: Vec<ColumnDoc>,
}

/// A column of a table, for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnDoc {
    /// The name.
    pub name: &'static str,
    /// `integer`, `real` or `text`.
    pub kind: String,
    /// What it says.
    pub doc: &'static str,
}

impl TableDoc {
    fn of(
        (name, doc): (&'static str, &'static str),
        columns: impl Iterator<Item = (&'static str, &'static str, &'static str)>,
    ) -> TableDoc {
        let column = |(name, kind, doc): (&'static str, &str, &'static str)| ColumnDoc {
            name,
            kind: kind.split(' ').next().unwrap_or_default().to_lowercase(),
            doc,
        };
        TableDoc { name, doc, columns: columns.map(column).collect() }
    }
}

/// The name of the table with its sentence, and a line for each column.
impl fmt::Display for TableDoc {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(formatter, "{}: {}", self.name, self.doc)?;
        let width = self.columns.iter().map(|column| column.name.len()).max().unwrap_or_default();
        for ColumnDoc { name, kind, doc } in &self.columns {
            writeln!(formatter, "{}", format!("  {name:width$}  {kind:7}  {doc}").trim_end())?;
        }
        Ok(())
    }
}

/// The tables of a history that this program writes.
///
/// ```
/// let tables = saoms_history::table_docs();
/// assert!(tables[0].to_string().starts_with("runs: A run of a fleet"));
/// ```
pub fn table_docs() -> Vec<TableDoc> {
    let own = OWN.iter().map(|own| {
        let columns = own.columns.iter().map(|OwnColumn(name, kind, doc)| (*name, *kind, *doc));
        TableDoc::of((own.name, own.doc), columns)
    });
    let others = HistoryRegistration::linked().into_iter().flat_map(|one| one.tables).map(|table| {
        let of_all = [("run", "INTEGER", RUN), ("time_s", "REAL", TIME)];
        let columns = table.columns.iter().map(|column| (column.name, kind(column), column.doc));
        TableDoc::of((table.name, table.doc), of_all.into_iter().chain(columns))
    });
    own.chain(others).collect()
}
