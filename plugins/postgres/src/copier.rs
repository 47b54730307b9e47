//! What brings the rows of a history that a server lacks.

use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::time::Instant;

use saoms_api::extension::HistoryValue;

use crate::address::Address;
use crate::batch::{Batch, PAGE};
use crate::gaps::Gaps;
use crate::looks::Looks;
use crate::problem::Outcome;
use crate::server::{Position, Positions, Server, make_fit};
use crate::source::{Run, Source, integer};
use crate::stop::Stop;
use crate::table::{Growth, Row, Table};
use crate::totals::Totals;

/// A history on its way to a server. What the server has is what it says itself after each connection: after any
/// failure a new one takes the place of this.
pub(crate) struct Copier<'a> {
    source: &'a Source,
    server: Server,
    tables: Vec<Table>,
    tables_version: i64,
    positions: Positions,
    /// What was brought of rows that may change, as hashes of their contents by hashes of their keys, for each run that
    /// is not complete; run 0 has the tables that are not those of runs.
    known: HashMap<i64, HashMap<u64, u64>>,
    hasher: RandomState,
    batch: Batch,
    looks: Looks,
}

/// Whether there was time to bring all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct IsThrough(pub(crate) bool);

impl<'a> Copier<'a> {
    /// Connects to the server, and prepares its schema.
    pub(crate) fn begin(source: &'a Source, address: &Address, schema: &str) -> Outcome<Copier<'a>> {
        source.is_still_there()?;
        let tables_version = source.tables_version()?;
        let tables = source.tables()?;
        let runs = source.runs(&tables)?;
        let (server, positions) = Server::open(address, schema, source, (&tables, &runs))?;
        Ok(Copier {
            source,
            server,
            tables,
            tables_version,
            positions,
            known: HashMap::new(),
            hasher: RandomState::new(),
            batch: Batch::default(),
            looks: Looks::default(),
        })
    }

    /// True if the file has other tables than those that are brought.
    pub(crate) fn is_outdated(&self) -> Outcome<bool> {
        Ok(self.source.tables_version()? != self.tables_version)
    }

    pub(crate) fn server(&mut self) -> &mut Server {
        &mut self.server
    }

    /// Brings what is new, unless it is to stop meanwhile.
    pub(crate) fn pass(&mut self, stop: &Stop, totals: &mut Totals) -> Outcome<IsThrough> {
        self.source.is_still_there()?;
        // Runs come first: what is read later of one that has ended by now is all of it.
        let runs = self.source.runs(&self.tables)?;
        let is_complete = |run: i64| self.positions.get(&("runs".to_owned(), run)).is_some_and(|known| known.last == 1);
        let open = self.looks.choose(runs, is_complete, Instant::now());
        if self.bring_all(&open, stop, totals)? == IsThrough(false) {
            return Ok(IsThrough(false));
        }
        for run in open.iter().filter(|run| run.has_ended) {
            let all = Position { last: 1, ..Position::default() };
            self.batch.positions.insert(("runs".to_owned(), run.run), all);
            self.known.remove(&run.run);
        }
        self.flush(totals)?;
        self.looks.looked_at(&open);
        Ok(IsThrough(true))
    }

    /// True if there may be rows to bring though nothing was written since the last pass.
    pub(crate) fn is_due(&self) -> bool {
        self.looks.is_due(Instant::now())
    }

    fn bring_all(&mut self, open: &[Run], stop: &Stop, totals: &mut Totals) -> Outcome<IsThrough> {
        for (number, run) in steps(&self.tables, open) {
            let is_through = match self.tables[number].growth() {
                Growth::Changing => self.bring_changes(number, run, stop, totals)?,
                Growth::Records | Growth::Rows => self.bring_new(number, run, stop, totals)?,
            };
            if is_through == IsThrough(false) {
                return Ok(IsThrough(false));
            }
        }
        Ok(IsThrough(true))
    }

    /// Brings the rows of a table that were added or changed since they were brought.
    fn bring_changes(&mut self, number: usize, run: i64, stop: &Stop, totals: &mut Totals) -> Outcome<IsThrough> {
        let table = &self.tables[number];
        let key = table.key_names().collect::<Vec<_>>().join(", ");
        let places = vec!["?"; table.key.len()].join(", ");
        let of_run = (run != 0).then_some("run = ?");
        let mut last: Option<Vec<HistoryValue>> = None;
        loop {
            let table = &self.tables[number];
            let behind = last.as_ref().map(|_| format!("({key}) > ({places})"));
            let conditions: Vec<&str> = of_run.into_iter().chain(behind.as_deref()).collect();
            let question = question(table, None, &conditions, &key);
            let values = of_run.map(|_| HistoryValue::Integer(run)).into_iter();
            let values: Vec<HistoryValue> = values.chain(last.take().into_iter().flatten()).collect();
            let rows = self.source.ask(&question, &values)?;
            let is_last = rows.len() < PAGE;
            for row in rows {
                let table = &self.tables[number];
                let key: Vec<&HistoryValue> = table.key.iter().filter_map(|place| row.get(*place)).collect();
                let (key_hash, row_hash) =
                    (self.hash(number, &key), self.hash(number, &row.iter().collect::<Vec<_>>()));
                last = Some(key.into_iter().cloned().collect());
                if self.known.entry(run).or_default().insert(key_hash, row_hash) != Some(row_hash) {
                    self.looks.hear_changes(run, Instant::now());
                    self.push(number, row);
                }
            }
            if self.flush_if_full(stop, totals)? == IsThrough(false) {
                return Ok(IsThrough(false));
            }
            if is_last {
                return Ok(IsThrough(true));
            }
        }
    }

    /// Brings the rows of a table that stand behind those that were brought, and records that came late.
    fn bring_new(&mut self, number: usize, run: i64, stop: &Stop, totals: &mut Totals) -> Outcome<IsThrough> {
        let table = &self.tables[number];
        let is_of_run = table.growth() == Growth::Records;
        let (id, conditions): (&str, &[&str]) =
            if is_of_run { ("id", &["run = ?", "id BETWEEN ? AND ?"]) } else { ("rowid", &["rowid BETWEEN ? AND ?"]) };
        let question = question(table, Some(id), conditions, id);
        let place = (table.name.clone(), run);
        let known = self.positions.get(&place).cloned().unwrap_or_default();
        let mut position = known.clone();
        let late = position.gaps.ranges().to_vec();
        let behind = position.last.checked_add(1).map(|next| (next, i64::MAX));
        let mut is_first = position.last > 0;
        for (mut from, to) in late.into_iter().chain(behind) {
            loop {
                let of_run = is_of_run.then_some(run).into_iter();
                let values: Vec<HistoryValue> = of_run.chain([from, to]).map(HistoryValue::Integer).collect();
                let rows = self.source.ask(&question, &values)?;
                let is_last = rows.len() < PAGE;
                if is_of_run && !rows.is_empty() {
                    self.looks.hear_records(run, Instant::now());
                }
                for mut row in rows {
                    let next = row.pop().as_ref().and_then(integer).unwrap_or(from);
                    self.push(number, row);
                    from = next.saturating_add(1);
                    if next <= position.last {
                        position.gaps.close(next);
                        continue;
                    }
                    let was_removed = std::mem::take(&mut is_first) && self.was_removed((run, position.last), next)?;
                    if is_of_run && was_removed {
                        self.batch.missed += u64::try_from(next - position.last - 1).unwrap_or_default();
                        position.gaps = Gaps::default();
                    } else if is_of_run {
                        position.gaps.add(position.last + 1, next - 1);
                    }
                    position.last = next;
                }
                if position != known {
                    self.batch.positions.insert(place.clone(), position.clone());
                }
                if self.flush_if_full(stop, totals)? == IsThrough(false) {
                    return Ok(IsThrough(false));
                }
                if is_last {
                    break;
                }
            }
        }
        Ok(IsThrough(true))
    }

    /// True if the records before the next one were removed from the file before they were brought: then the last one
    /// that was is gone, too.
    fn was_removed(&self, (run, last): (i64, i64), next: i64) -> Outcome<bool> {
        let values = [run, last].map(HistoryValue::Integer);
        let question = "SELECT 1 FROM records WHERE run = ? AND id = ?";
        Ok(next > last + 1 && run != 0 && self.source.ask(question, &values)?.is_empty())
    }

    fn push(&mut self, number: usize, mut row: Row) {
        self.batch.replaced += u64::from(make_fit(&self.tables[number], &mut row));
        self.batch.push(number, row);
    }

    fn hash(&self, number: usize, values: &[&HistoryValue]) -> u64 {
        let mut hasher = self.hasher.build_hasher();
        hasher.write_usize(number);
        for value in values {
            match value {
                HistoryValue::Null => hasher.write_u8(0),
                HistoryValue::Integer(value) => {
                    hasher.write_u8(1);
                    hasher.write_i64(*value);
                }
                HistoryValue::Real(value) => {
                    hasher.write_u8(2);
                    hasher.write_u64(value.to_bits());
                }
                HistoryValue::Text(text) => {
                    hasher.write_u8(3);
                    hasher.write_usize(text.len());
                    hasher.write(text.as_bytes());
                }
            }
        }
        hasher.finish()
    }

    /// Brings a batch that is full; then it may be time to stop.
    fn flush_if_full(&mut self, stop: &Stop, totals: &mut Totals) -> Outcome<IsThrough> {
        if self.batch.is_full() {
            self.flush(totals)?;
            return Ok(IsThrough(!stop.is_asked()));
        }
        Ok(IsThrough(true))
    }

    fn flush(&mut self, totals: &mut Totals) -> Outcome<()> {
        let batch = std::mem::take(&mut self.batch);
        if batch.is_empty() {
            return Ok(());
        }
        let written = self.server.write(&self.tables, &batch)?;
        totals.add(&self.tables, &written, batch.replaced);
        totals.missed += batch.missed;
        self.positions.extend(batch.positions);
        Ok(())
    }
}

/// What is brought in which order: the number of a table, and a run or 0. Runs are there before what is theirs.
fn steps(tables: &[Table], open: &[Run]) -> Vec<(usize, i64)> {
    let numbers = |growth: Growth, is_of_runs: bool| {
        let tables = tables.iter().enumerate();
        let found = tables.filter(move |(_, table)| table.growth() == growth && table.is_of_runs() == is_of_runs);
        found.map(|(number, _)| number)
    };
    let mut steps: Vec<(usize, i64)> = numbers(Growth::Changing, false).map(|number| (number, 0)).collect();
    for run in open {
        let of_run = numbers(Growth::Changing, true).chain(numbers(Growth::Records, true));
        steps.extend(of_run.map(|number| (number, run.run)));
    }
    let rows = numbers(Growth::Rows, true).chain(numbers(Growth::Rows, false));
    steps.extend(rows.map(|number| (number, 0)));
    steps
}

/// The question for a page of a table.
fn question(table: &Table, behind: Option<&str>, conditions: &[&str], order: &str) -> String {
    let columns: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).chain(behind).collect();
    let conditions = if conditions.is_empty() { String::new() } else { format!("WHERE {} ", conditions.join(" AND ")) };
    format!("SELECT {} FROM {} {conditions}ORDER BY {order} LIMIT {PAGE}", columns.join(", "), table.name)
}
