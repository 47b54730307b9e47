use std::fmt;

use crate::server::Written;
use crate::table::Table;

/// What was brought so far, and what was not.
#[derive(Debug, Default)]
pub(crate) struct Totals {
    /// The rows that were added or changed, by their table, in the order of the tables.
    rows: Vec<(String, u64)>,
    /// Rows in which something was replaced.
    replaced: u64,
    /// Rows that the server refused, and why the first of them.
    refused: u64,
    reason: Option<String>,
    /// Records that were removed from the file before they were brought.
    pub(crate) missed: u64,
    /// Records that were removed from the server.
    pub(crate) removed: u64,
    /// True if there is something that was not told.
    is_new: bool,
}

impl Totals {
    pub(crate) fn add(&mut self, tables: &[Table], written: &Written, replaced: u64) {
        for table in tables {
            if !self.rows.iter().any(|(name, _)| *name == table.name) {
                self.rows.push((table.name.clone(), 0));
            }
        }
        for (number, count) in &written.rows {
            let name = tables.get(*number).map(|table| table.name.as_str()).unwrap_or_default();
            if let Some((_, rows)) = self.rows.iter_mut().find(|(known, _)| known == name) {
                *rows += count;
                self.is_new |= *count > 0;
            }
        }
        self.replaced += replaced;
        self.refused += written.refused;
        self.is_new |= replaced > 0 || written.refused > 0;
        if self.reason.is_none() {
            self.reason.clone_from(&written.reason);
        }
    }

    /// True if no row was brought or refused.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.iter().all(|(_, rows)| *rows == 0) && self.refused == 0
    }

    /// True if rows were refused.
    pub(crate) fn has_refused(&self) -> bool {
        self.refused > 0
    }

    /// The line for people, if there is something new.
    pub(crate) fn news(&mut self) -> Option<String> {
        std::mem::take(&mut self.is_new).then(|| self.to_string())
    }
}

impl fmt::Display for Totals {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let brought: Vec<String> =
            self.rows.iter().filter(|(_, rows)| *rows > 0).map(|(name, rows)| format!("{name} {rows}")).collect();
        if brought.is_empty() {
            formatter.write_str("brought: nothing new")?;
        } else {
            write!(formatter, "brought: {}", brought.join(", "))?;
        }
        if self.replaced > 0 {
            write!(
                formatter,
                "; rows with characters that PostgreSQL does not take, which were replaced: {}",
                self.replaced
            )?;
        }
        if self.refused > 0 {
            let reason = self.reason.as_deref().unwrap_or_default();
            write!(formatter, "; refused: {}, the first in {reason}", self.refused)?;
        }
        if self.missed > 0 {
            write!(formatter, "; records that were removed from the file before: {}", self.missed)?;
        }
        if self.removed > 0 {
            write!(formatter, "; old records removed: {}", self.removed)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn news_are_told_once() {
        let table = |name: &str| Table {
            name: name.to_owned(),
            doc: String::new(),
            columns: Vec::new(),
            key: Vec::new(),
            indexes: Vec::new(),
        };
        let tables = ["runs", "records", "alerts"].map(table);
        let mut totals = Totals::default();
        assert_eq!((totals.to_string().as_str(), totals.news()), ("brought: nothing new", None));
        let reason = Some("`alerts`: no".to_owned());
        totals.add(&tables, &Written { rows: vec![(1, 5), (0, 1)], refused: 0, reason: None }, 0);
        assert_eq!(totals.news().as_deref(), Some("brought: runs 1, records 5"));
        totals.add(&tables, &Written { rows: vec![(1, 0)], refused: 0, reason: None }, 0);
        assert_eq!(totals.news(), None);
        totals.add(&tables, &Written { rows: vec![(2, 1)], refused: 2, reason }, 3);
        totals.missed = 4;
        totals.removed = 6;
        let expected = "brought: runs 1, records 5, alerts 1; rows with characters that PostgreSQL does not take, which were \
                        replaced: 3; refused: 2, the first in `alerts`: no; records that were removed from the file \
                        before: 4; old records removed: 6";
        assert_eq!(totals.news().as_deref(), Some(expected));
    }
}
