use std::collections::HashMap;
use std::path::Path;
use std::time::Duration;

use rusqlite::types::{ToSql, ToSqlOutput, ValueRef};
use rusqlite::{Connection, OpenFlags, TransactionBehavior, params};
use saoms_api::extension::{HistoryRow, HistoryTable, HistoryValue};
use saoms_core::journal::JournalEntry;
use saoms_core::report::RunReport;

use crate::HistoryError;
use crate::history::HistoryRun;
use crate::questions::value;
use crate::retention::Retention;
use crate::tables::{APPLICATION, NAME, OWN, OwnColumn, VERSION, statements};

/// Time for which a statement waits for another program that writes.
const BUSY: Duration = if cfg!(test) { Duration::from_millis(20) } else { Duration::from_secs(2) };

/// The date and time of now, in UTC.
const NOW: &str = "strftime('%Y-%m-%dT%H:%M:%fZ', 'now')";

/// The part of a history that one run writes.
pub(crate) struct Writer {
    connection: Connection,
    run: i64,
    /// What adds a row to each table of a crate of components, by its name.
    inserts: HashMap<&'static str, String>,
    /// Which records are removed, if any are.
    retention: Option<Retention>,
}

/// The outcome of a statement.
pub(crate) type Written = Result<(), rusqlite::Error>;

/// A value as SQLite takes it.
pub(crate) struct Value<'a>(pub(crate) &'a HistoryValue);

impl ToSql for Value<'_> {
    fn to_sql(&self) -> rusqlite::Result<ToSqlOutput<'_>> {
        Ok(ToSqlOutput::Borrowed(match self.0 {
            HistoryValue::Null => ValueRef::Null,
            HistoryValue::Integer(value) => ValueRef::Integer(*value),
            HistoryValue::Real(value) => ValueRef::Real(*value),
            HistoryValue::Text(text) => ValueRef::Text(text.as_bytes()),
        }))
    }
}

/// Opens a history, and makes it where it is missing.
pub(crate) fn open(path: &Path, tables: &[&'static HistoryTable]) -> Result<Connection, HistoryError> {
    let of_database = |error: rusqlite::Error| refused(path, &error);
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let mut connection = Connection::open_with_flags(path, flags).map_err(of_database)?;
    connection.busy_timeout(BUSY).map_err(of_database)?;
    let has_tables = check(path, &connection)?;
    if !has_tables {
        connection.pragma_update(None, "application_id", APPLICATION).map_err(of_database)?;
        connection.pragma_update(None, "user_version", VERSION).map_err(of_database)?;
    }
    // A crash of the program loses nothing; one of the machine the last moments at most.
    connection.pragma_update(None, "journal_mode", "WAL").map_err(of_database)?;
    connection.pragma_update(None, "synchronous", "NORMAL").map_err(of_database)?;
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate).map_err(of_database)?;
    for own in OWN {
        transaction.execute(&own.statement(), []).map_err(of_database)?;
        // A file of an earlier version lacks some.
        let known = transaction.prepare(&format!("SELECT * FROM {} LIMIT 0", own.name)).map_err(of_database)?;
        let known: Vec<String> = known.column_names().map(str::to_owned).collect();
        for OwnColumn(column, kind, _) in own.columns.iter().filter(|one| !known.iter().any(|known| known == one.0)) {
            let add = format!("ALTER TABLE {} ADD COLUMN {column} {kind}", own.name);
            transaction.execute(&add, []).map_err(of_database)?;
        }
    }
    transaction.execute(NAME, []).map_err(of_database)?;
    for table in tables {
        for statement in statements(table) {
            transaction.execute(&statement, []).map_err(of_database)?;
        }
        let statement = transaction.prepare(&format!("SELECT * FROM {} LIMIT 0", table.name)).map_err(of_database)?;
        let names: Vec<&str> = statement.column_names().collect();
        if let Some(missing) = table.columns.iter().find(|column| !names.contains(&column.name)) {
            let (table, column) = (table.name.to_owned(), missing.name.to_owned());
            return Err(HistoryError::Table { path: path.to_owned(), table, column });
        }
    }
    transaction.commit().map_err(of_database)?;
    Ok(connection)
}

/// Whether a database is a history, or has nothing yet.
pub(crate) fn check(path: &Path, connection: &Connection) -> Result<bool, HistoryError> {
    let number = |name: &str| connection.pragma_query_value(None, name, |row| row.get::<_, i64>(0));
    let of_database = |error: rusqlite::Error| refused(path, &error);
    let application = number("application_id").map_err(of_database)?;
    let objects = connection.query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get::<_, i64>(0));
    let is_empty = objects.map_err(of_database)? == 0;
    match (application, number("user_version").map_err(of_database)?) {
        (APPLICATION, version) if version > VERSION => Err(HistoryError::Version { path: path.to_owned(), version }),
        (APPLICATION, _) => Ok(!is_empty),
        (0, 0) if is_empty => Ok(false),
        _ => Err(HistoryError::Foreign { path: path.to_owned() }),
    }
}

/// Why a database cannot be used.
pub(crate) fn refused(path: &Path, error: &rusqlite::Error) -> HistoryError {
    if error.sqlite_error_code() == Some(rusqlite::ErrorCode::NotADatabase) {
        return HistoryError::Foreign { path: path.to_owned() };
    }
    HistoryError::Database { path: path.to_owned(), message: error.to_string() }
}

/// What asks for the rows that earlier runs with the same state wrote to a table, in the order in which they were
/// written: such runs follow each other. `CROSS JOIN` has SQLite find the runs first: a history may have rows of many
/// more, and an index has those of a run in the order that is wanted, so that nothing is sorted.
pub(crate) fn earlier(table: &HistoryTable) -> String {
    let columns: String = table.columns.iter().map(|column| format!(", t.{}", column.name)).collect();
    format!(
        "SELECT t.time_s{columns} FROM runs own CROSS JOIN runs r ON r.state = own.state AND r.run < own.run \
         CROSS JOIN {} t ON t.run = r.run \
         WHERE own.run = ? AND (r.undone_from_s IS NULL OR t.time_s < r.undone_from_s) ORDER BY r.run, t.rowid",
        table.name
    )
}

impl Writer {
    /// Begins a run, whose records are removed at an age.
    pub(crate) fn begin(
        connection: Connection,
        tables: &[&'static HistoryTable],
        (run, keep): (&HistoryRun, Option<Duration>),
        (clock, seed): (&str, u64),
    ) -> Result<Writer, rusqlite::Error> {
        let HistoryRun { name, composites, node, version } = run;
        let composites = serde_json::Value::from(composites.as_slice()).to_string();
        let begin = format!(
            "INSERT INTO runs (name, composites, node, version, clock, seed, began) VALUES (?, ?, ?, ?, ?, ?, {NOW})"
        );
        connection.execute(&begin, params![name, composites, node, version, clock, seed.to_string()])?;
        let run = connection.last_insert_rowid();
        let inserts = tables.iter().map(|table| {
            let names: String = table.columns.iter().map(|column| format!(", {}", column.name)).collect();
            let places = ", ?".repeat(table.columns.len());
            (table.name, format!("INSERT INTO {} (run, time_s{names}) VALUES (?, ?{places})", table.name))
        });
        let (inserts, retention) = (inserts.collect(), keep.map(Retention::of));
        Ok(Writer { connection, run, inserts, retention })
    }

    /// A name by chance, which no other has.
    pub(crate) fn chance_name(&self) -> Result<String, rusqlite::Error> {
        self.connection.query_row("SELECT lower(hex(randomblob(16)))", [], |row| row.get(0))
    }

    /// The run has the state of this name, and goes on from there at a time, if it does.
    pub(crate) fn has_state(&mut self, state: &str, from_s: Option<f64>) -> Written {
        let transaction = self.connection.transaction()?;
        let change = "UPDATE runs SET state = ?, goes_on_from_s = ? WHERE run = ?";
        transaction.execute(change, params![state, from_s, self.run])?;
        if let Some(from_s) = from_s {
            let change = "UPDATE runs SET undone_from_s = min(coalesce(undone_from_s, ?1), ?1) \
                          WHERE state = ?2 AND run < ?3";
            transaction.execute(change, params![from_s, state, self.run])?;
        }
        transaction.commit()
    }

    /// Gives the rows that earlier runs with the same state wrote of what this one goes on with, and their times, one
    /// after the other in the order in which they were written: a history of years is not held in memory.
    pub(crate) fn each_earlier(
        &self,
        (place, table): (usize, &HistoryTable),
        mut take: impl FnMut(f64, &HistoryRow),
    ) -> Written {
        let mut statement = self.connection.prepare(&earlier(table))?;
        let mut rows = statement.query([self.run])?;
        while let Some(row) = rows.next()? {
            let values = (1..=table.columns.len()).map(|column| row.get_ref(column).map(value));
            let time_s = row.get(0)?;
            take(time_s, &HistoryRow { table: place, values: values.collect::<Result<_, _>>()? });
        }
        Ok(())
    }

    pub(crate) fn components<'a>(
        &mut self,
        components: impl Iterator<Item = (&'a str, Option<&'a str>, Option<f64>)>,
    ) -> Written {
        let transaction = self.connection.transaction()?;
        {
            let mut insert = transaction.prepare_cached(
                "INSERT OR IGNORE INTO components (run, component, id, period_s) VALUES (?, ?, ?, ?)",
            )?;
            for (component, id, period) in components {
                insert.execute(params![self.run, component, id, period])?;
            }
        }
        transaction.commit()
    }

    pub(crate) fn records(&mut self, entries: &[JournalEntry]) -> Written {
        let transaction = self.connection.transaction()?;
        {
            let mut insert = transaction.prepare_cached(
                "INSERT INTO records (run, id, time_s, component, loop, phase, record, entry, text, data, cause) \
                 VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
            )?;
            for entry in entries {
                let change = entry.is_change();
                let values = entry.record_values();
                let data = Some(values).filter(|values| !values.is_empty());
                let data = data.and_then(|values| serde_json::to_string(&values).ok());
                let number = |number: u64| i64::try_from(number).unwrap_or(i64::MAX);
                let cause = Some(number(entry.cause().0)).filter(|cause| *cause != 0);
                let name = entry.record_id();
                insert.execute(params![
                    self.run,
                    number(entry.id().0),
                    entry.time().as_secs_f64(),
                    entry.component(),
                    entry.loop_name(),
                    entry.phase().name(),
                    (!change).then_some(name),
                    change.then_some(name),
                    entry.text(),
                    data,
                    cause,
                ])?;
            }
        }
        if let Some(retention) = &mut self.retention {
            retention.remove(&transaction, self.run, entries)?;
        }
        transaction.commit()
    }

    /// Does not wait for other programs that write, until something is written again.
    pub(crate) fn is_patient(&self, is_patient: bool) {
        // Nothing but a pointer that is null can hinder it.
        let _ = self.connection.busy_timeout(if is_patient { BUSY } else { Duration::ZERO });
    }

    pub(crate) fn rows(&mut self, tables: &[HistoryTable], time_s: f64, rows: &[HistoryRow]) -> Written {
        let transaction = self.connection.transaction()?;
        for row in rows {
            let Some(table) = tables.get(row.table) else { continue };
            let Some(insert) = self.inserts.get(table.name) else { continue };
            let mut insert = transaction.prepare_cached(insert)?;
            let nothing = HistoryValue::Null;
            let places = 0..table.columns.len();
            let values: Vec<Value<'_>> = places.map(|place| Value(row.values.get(place).unwrap_or(&nothing))).collect();
            let of_all: [&dyn ToSql; 2] = [&self.run, &time_s];
            let values = of_all.into_iter().chain(values.iter().map(|value| value as &dyn ToSql));
            insert.execute(rusqlite::params_from_iter(values))?;
        }
        transaction.commit()
    }

    /// An alert began, or its text changed.
    pub(crate) fn alert(
        &mut self,
        (number, is_new): (i64, bool),
        (kind, component, subject): (&str, Option<&str>, &str),
        text: &str,
        time_s: f64,
    ) -> Written {
        if is_new {
            let insert = "INSERT INTO alerts (run, alert, kind, component, subject, text, raised_s) \
                          VALUES (?, ?, ?, ?, ?, ?, ?)";
            let values = params![self.run, number, kind, component, subject, text, time_s];
            self.connection.prepare_cached(insert)?.execute(values)?;
        } else {
            let change = "UPDATE alerts SET text = ? WHERE run = ? AND alert = ?";
            self.connection.prepare_cached(change)?.execute(params![text, self.run, number])?;
        }
        Ok(())
    }

    pub(crate) fn alert_over(&mut self, number: i64, time_s: f64) -> Written {
        let change = "UPDATE alerts SET over_s = ? WHERE run = ? AND alert = ?";
        self.connection.prepare_cached(change)?.execute(params![time_s, self.run, number])?;
        Ok(())
    }

    /// The number of rows that could not be written so far.
    pub(crate) fn lost(&mut self, lost: u64) -> Written {
        let lost = i64::try_from(lost).unwrap_or(i64::MAX);
        self.connection.execute("UPDATE runs SET lost = ? WHERE run = ?", params![lost, self.run])?;
        Ok(())
    }

    /// The run has ended.
    pub(crate) fn end(&mut self, report: &RunReport) -> Written {
        let report = report.without_records();
        let text = serde_json::to_value(&report).unwrap_or_default();
        let status = text.pointer("/outcome/status").and_then(serde_json::Value::as_str).unwrap_or_default();
        let transaction = self.connection.transaction()?;
        let change = format!("UPDATE runs SET ended = {NOW}, time_s = ?, status = ? WHERE run = ?");
        transaction.execute(&change, params![report.time_s, status, self.run])?;
        transaction.execute("INSERT INTO reports (run, report) VALUES (?, ?)", params![self.run, text.to_string()])?;
        transaction.commit()
    }
}
