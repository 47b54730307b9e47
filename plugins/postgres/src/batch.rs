use std::collections::BTreeMap;

use saoms_api::extension::HistoryValue;

use crate::server::Positions;
use crate::table::Row;

/// The number of rows that are read at once, and the number and size from which on a batch is full.
pub(crate) const PAGE: usize = 1_000;
const ROWS: usize = 5_000;
const BYTES: usize = 8_000_000;

/// Rows that are brought in one transaction, with how far they reach.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    /// By the number of the table.
    pub(crate) rows: BTreeMap<usize, Vec<Row>>,
    pub(crate) positions: Positions,
    /// The number of rows in which something was replaced.
    pub(crate) replaced: u64,
    /// The number of records before its positions that were removed from the file before they were brought.
    pub(crate) missed: u64,
    count: usize,
    bytes: usize,
}

impl Batch {
    pub(crate) fn push(&mut self, table: usize, row: Row) {
        let texts = row.iter().map(|value| if let HistoryValue::Text(text) = value { text.len() } else { 0 });
        self.bytes += texts.sum::<usize>();
        self.count += 1;
        self.rows.entry(table).or_default().push(row);
    }

    pub(crate) fn is_full(&self) -> bool {
        self.count >= ROWS || self.bytes >= BYTES
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0 && self.positions.is_empty()
    }
}
