//! Histories, and what stands in them and in PostgreSQL.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use postgres::Client;
use rusqlite::Connection;
use rusqlite::types::ValueRef;
use saoms_core::observe::WriterEvents;
use saoms_history::{History, HistoryRun};
use saoms_testkit::Fleet;
use serde_json::Value;

use crate::server::Server;

/// Who hears of a history that cannot be written.
struct Nobody;

impl WriterEvents for Nobody {
    fn fails(&self, _: &str) {}
    fn works(&self) {}
}

/// Adds a run of the airport, in virtual time.
pub(crate) fn airport(file: &Path, seed: u64) {
    let run = HistoryRun { name: "airport".to_owned(), version: "1".to_owned(), ..HistoryRun::default() };
    let history = Arc::new(History::open(file, run, None, Box::new(Nobody)).unwrap());
    Fleet::of_file("../../composites/airport.composite").run_with(seed, Duration::from_secs(60), history);
}

/// The tables of a history that has no runs.
pub(crate) fn empty(file: &Path) -> Connection {
    drop(History::open(file, HistoryRun::default(), None, Box::new(Nobody)).unwrap());
    let connection = Connection::open(file).unwrap();
    connection.busy_timeout(Duration::from_secs(20)).unwrap();
    connection
}

/// Begins a run by hand.
pub(crate) fn begin(history: &Connection, name: &str, began: &str) -> i64 {
    let insert =
        "INSERT INTO runs (name, composites, version, clock, seed, began) VALUES (?, '[]', '1', 'real', '1', ?)";
    history.execute(insert, [name, began]).unwrap();
    history.last_insert_rowid()
}

/// A history in the folder of a server with one run, which is written by hand: its file, its tables, and the run.
pub(crate) fn hall(server: &Server) -> (PathBuf, Connection, i64) {
    let file = server.path().join("h.db");
    let history = empty(&file);
    let run = begin(&history, "hall", "2026-01-01T00:00:00.000Z");
    (file, history, run)
}

/// Adds records with these numbers to a run.
pub(crate) fn records(history: &mut Connection, run: i64, ids: std::ops::RangeInclusive<i64>) {
    let transaction = history.transaction().unwrap();
    for id in ids {
        let insert = "INSERT INTO records (run, id, time_s, component, phase, record, text, data) \
                      VALUES (?1, ?2, ?2 / 10.0, 'Robot1', 'effect', 'moved', 'moved to ' || ?2, '{\"step\":' || ?2 || '}')";
        transaction.prepare_cached(insert).unwrap().execute([run, id]).unwrap();
    }
    transaction.commit().unwrap();
}

/// Each table with its rows in order, each value as text that tells its kind.
pub(crate) type Dump = BTreeMap<String, Vec<Vec<String>>>;

fn json(text: &str) -> String {
    fn plain(value: Value) -> Value {
        match value {
            Value::Number(number) => Value::from(number.as_f64()),
            Value::Array(values) => values.into_iter().map(plain).collect(),
            Value::Object(members) => members.into_iter().map(|(name, value)| (name, plain(value))).collect(),
            other => other,
        }
    }
    plain(serde_json::from_str(text).unwrap()).to_string()
}

const JSON: [&str; 3] = ["runs.composites", "records.data", "reports.report"];

pub(crate) fn of_sqlite(history: &Connection) -> Dump {
    let mut dump = Dump::new();
    let mut names = history.prepare("SELECT name FROM sqlite_schema WHERE type = 'table'").unwrap();
    let names: Vec<String> = names.query_map([], |row| row.get(0)).unwrap().map(Result::unwrap).collect();
    for name in names {
        let mut statement = history.prepare(&format!("SELECT * FROM {name}")).unwrap();
        let columns: Vec<String> = statement.column_names().map(|column| format!("{name}.{column}")).collect();
        let value = |(place, value): (usize, ValueRef<'_>)| match value {
            ValueRef::Null => "-".to_owned(),
            ValueRef::Integer(value) => format!("{value}"),
            ValueRef::Real(value) => format!("{value:?}"),
            ValueRef::Text(text) | ValueRef::Blob(text) => {
                let text = String::from_utf8(text.to_owned()).unwrap();
                if JSON.contains(&columns[place].as_str()) { json(&text) } else { format!("{text:?}") }
            }
        };
        let count = columns.len();
        let row = |row: &rusqlite::Row<'_>| {
            Ok((0..count).map(|place| value((place, row.get_ref(place).unwrap()))).collect::<Vec<_>>())
        };
        let mut rows: Vec<Vec<String>> = statement.query_map([], row).unwrap().map(Result::unwrap).collect();
        rows.sort();
        dump.insert(name, rows);
    }
    dump
}

pub(crate) fn of_postgres(client: &mut Client, schema: &str) -> Dump {
    let mut dump = Dump::new();
    let names = "SELECT tablename::text FROM pg_tables WHERE schemaname = $1 AND tablename NOT LIKE 'copied%'";
    for name in client.query(names, &[&schema]).unwrap() {
        let name: String = name.get(0);
        let columns = "SELECT string_agg(CASE data_type WHEN 'jsonb' THEN column_name || '::text' ELSE \
                       '\"' || column_name || '\"' END, ', ' ORDER BY ordinal_position) \
                       FROM information_schema.columns WHERE table_schema = $1 AND table_name = $2";
        let columns: String = client.query_one(columns, &[&schema, &name]).unwrap().get(0);
        let mut rows = Vec::new();
        for row in client.query(&format!("SELECT {columns} FROM \"{schema}\".\"{name}\""), &[]).unwrap() {
            let value = |place: usize| -> String {
                let column = &row.columns()[place];
                let value = match column.type_().name() {
                    "int8" => row.get::<_, Option<i64>>(place).map(|value| value.to_string()),
                    "float8" => row.get::<_, Option<f64>>(place).map(|value| format!("{value:?}")),
                    _ => row.get::<_, Option<String>>(place).map(|text| {
                        if JSON.contains(&format!("{name}.{}", column.name()).as_str()) {
                            json(&text)
                        } else {
                            format!("{text:?}")
                        }
                    }),
                };
                value.unwrap_or_else(|| "-".to_owned())
            };
            rows.push((0..row.len()).map(value).collect::<Vec<_>>());
        }
        rows.sort();
        dump.insert(name, rows);
    }
    dump
}

/// Compares all tables.
pub(crate) fn assert_same(history: &Connection, client: &mut Client, schema: &str) {
    let (sqlite, postgres) = (of_sqlite(history), of_postgres(client, schema));
    assert_eq!(sqlite.keys().collect::<Vec<_>>(), postgres.keys().collect::<Vec<_>>());
    for (name, rows) in &sqlite {
        let other = &postgres[name];
        assert_eq!(rows.len(), other.len(), "rows of `{name}`");
        if let Some((row, other)) = rows.iter().zip(other).find(|(row, other)| row != other) {
            panic!("`{name}`:\n{row:?}\n{other:?}");
        }
    }
}
