//! The PostgreSQL server to which a history is brought.

mod found;
mod names;
mod rows;
mod setup;

use std::collections::HashMap;
use std::time::Duration;

use postgres::types::ToSql;
use postgres::{Client, Statement, Transaction};

use crate::address::Address;
use crate::batch::Batch;
use crate::gaps::Gaps;
use crate::problem::{Outcome, Problem, is_of_a_row, reason};
use crate::source::{Run, Source};
use crate::table::{Row, Table};
use names::quoted;
pub(crate) use rows::make_fit;
use setup::{ORIGIN, POSITIONS, Wanted};

/// How far tables were brought: by table and run, which is 0 for tables that are not brought by runs.
pub(crate) type Positions = HashMap<(String, i64), Position>;

/// How far a table was brought.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Position {
    /// The last record or row.
    pub(crate) last: i64,
    /// Records before it that were not there.
    pub(crate) gaps: Gaps,
}

/// A connection to the schema of a history.
pub(crate) struct Server {
    client: Client,
    /// Where the tables are, for people.
    place: String,
    schema: String,
    /// The number of batches that the schema has, as far as this connection knows.
    batches: i64,
    /// The statements that add rows, by the number of the table.
    inserts: HashMap<usize, Statement>,
}

/// What became of a batch.
#[derive(Debug, Default)]
pub(crate) struct Written {
    /// The number of rows that were added or changed, by the number of the table.
    pub(crate) rows: Vec<(usize, u64)>,
    /// The number of rows that the server refused.
    pub(crate) refused: u64,
    /// Why it refused the first of them.
    pub(crate) reason: Option<String>,
}

/// What a session is given: a transaction whose program is away holds no locks for long, and a backslash in a literal
/// is one, whatever the server is set to.
const SESSION: &str = "SET idle_in_transaction_session_timeout = '1min'; SET standard_conforming_strings = on";

/// The number of records that are removed at once.
const AT_ONCE: i64 = 20_000;

impl Server {
    /// Connects, and makes the tables that are missing.
    pub(crate) fn open(
        address: &Address,
        schema: &str,
        source: &Source,
        (tables, runs): (&[Table], &[Run]),
    ) -> Outcome<(Server, Positions)> {
        let mut client = address.connect()?;
        client.batch_execute(SESSION).map_err(|error| Problem::of(&address.shown, &error))?;
        Wanted { schema, database: &address.shown, source, tables, runs }.set_up(&mut client)?;
        let place = format!("the schema `{schema}` of {}", address.shown);
        let mut server = Server { client, place, schema: schema.to_owned(), batches: 0, inserts: HashMap::new() };
        let positions = server.positions().map_err(|error| Problem::of(&server.place, &error))?;
        Ok((server, positions))
    }

    /// How far tables were brought. Number and positions are of one moment: later batches of others are noticed.
    fn positions(&mut self) -> Result<Positions, postgres::Error> {
        let schema = quoted(&self.schema);
        let mut transaction = self.client.build_transaction();
        transaction = transaction.isolation_level(postgres::IsolationLevel::RepeatableRead).read_only(true);
        let mut transaction = transaction.start()?;
        self.batches = transaction.query_one(&format!("SELECT batches FROM {schema}.{ORIGIN}"), &[])?.get(0);
        let rows =
            transaction.query(&format!("SELECT table_name, run, position, gaps FROM {schema}.{POSITIONS}"), &[])?;
        let position = |row: postgres::Row| {
            let position = Position { last: row.get(2), gaps: Gaps::read(row.get(3)) };
            ((row.get(0), row.get(1)), position)
        };
        Ok(rows.into_iter().map(position).collect())
    }

    /// Adds the rows of a batch and how far they reach, all or nothing.
    pub(crate) fn write(&mut self, tables: &[Table], batch: &Batch) -> Outcome<Written> {
        match self.try_to_write(tables, batch) {
            Ok(Some(written)) => {
                self.batches += 1;
                Ok(written)
            }
            Ok(None) => Err(Problem::Overtaken),
            Err(error) => Err(Problem::of(&format!("rows cannot be brought to {}", self.place), &error)),
        }
    }

    fn try_to_write(&mut self, tables: &[Table], batch: &Batch) -> Result<Option<Written>, postgres::Error> {
        for (number, table) in tables.iter().enumerate() {
            if batch.rows.contains_key(&number) && !self.inserts.contains_key(&number) {
                self.inserts.insert(number, self.client.prepare(&rows::statement(&self.schema, table))?);
            }
        }
        let schema = quoted(&self.schema);
        let mut transaction = self.client.transaction()?;
        // Locks the row until the end: of two programs one comes first, and the other one finds another number.
        let next = format!("UPDATE {schema}.{ORIGIN} SET batches = batches + 1, at = now() WHERE batches = $1");
        if transaction.execute(&next, &[&self.batches])? != 1 {
            return Ok(None);
        }
        let mut written = Written::default();
        for (number, rows) in &batch.rows {
            let (Some(table), Some(insert)) = (tables.get(*number), self.inserts.get(number)) else { continue };
            let taken = add(&mut transaction, (insert, table), rows, &mut written)?;
            written.rows.push((*number, taken));
        }
        let (mut names, mut runs, mut positions, mut gaps) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for ((name, run), position) in &batch.positions {
            names.push(name.as_str());
            runs.push(*run);
            positions.push(position.last);
            gaps.push(position.gaps.to_string());
        }
        let reach = format!(
            "INSERT INTO {schema}.{POSITIONS} SELECT * FROM unnest($1::text[], $2::bigint[], $3::bigint[], $4::text[]) \
             ON CONFLICT (table_name, run) DO UPDATE SET position = excluded.position, gaps = excluded.gaps"
        );
        transaction.execute(&reach, &[&names, &runs, &positions, &gaps])?;
        transaction.commit()?;
        Ok(Some(written))
    }

    /// Removes records that are older than a time: by the end of their run, or by their own time in one that goes on.
    pub(crate) fn forget(&mut self, keep: Duration) -> Outcome<u64> {
        let schema = quoted(&self.schema);
        let old = "coalesce(runs.ended::timestamptz, runs.began::timestamptz + records.time_s * interval '1 s') \
                   < now() - $2 * interval '1 s'";
        // The oldest records of each run, as long as there are some: the others are not looked at.
        let delete = format!(
            "WITH oldest AS (SELECT run, id FROM {schema}.records WHERE run = $1 ORDER BY id LIMIT {AT_ONCE}) \
             DELETE FROM {schema}.records USING oldest, {schema}.runs \
             WHERE records.run = oldest.run AND records.id = oldest.id AND runs.run = records.run AND {old}"
        );
        let what = format!("old records cannot be removed from {}", self.place);
        let failed = |error: postgres::Error| Problem::of(&what, &error);
        let delete = self.client.prepare(&delete).map_err(failed)?;
        let mut removed = 0;
        let runs = self.client.query(&format!("SELECT run FROM {schema}.runs"), &[]).map_err(failed)?;
        for run in runs {
            loop {
                let run: i64 = run.get(0);
                let count = self.client.execute(&delete, &[&run, &keep.as_secs_f64()]).map_err(failed)?;
                removed += count;
                if count == 0 {
                    break;
                }
            }
        }
        Ok(removed)
    }
}

/// Adds rows to a table. If the server refuses them for what stands in one of them, halves of them are tried, so that
/// only that row is missing.
fn add(
    transaction: &mut Transaction<'_>,
    (insert, table): (&Statement, &Table),
    rows: &[Row],
    written: &mut Written,
) -> Result<u64, postgres::Error> {
    let columns = rows::columns(table, rows);
    let values: Vec<&(dyn ToSql + Sync)> = columns.iter().map(|column| &**column as &(dyn ToSql + Sync)).collect();
    let mut attempt = transaction.transaction()?;
    match attempt.execute(insert, &values) {
        Ok(count) => {
            attempt.commit()?;
            Ok(count)
        }
        Err(error) if is_of_a_row(&error) => {
            attempt.rollback()?;
            if rows.len() > 1 {
                let (first, second) = rows.split_at(rows.len() / 2);
                let of_first = add(transaction, (insert, table), first, written)?;
                return Ok(of_first + add(transaction, (insert, table), second, written)?);
            }
            written.refused += 1;
            written.reason.get_or_insert_with(|| format!("`{}`: {}", table.name, reason(&error)));
            Ok(0)
        }
        Err(error) => Err(error),
    }
}
