//! Counts of start and end tags by name, to find out where tags are missing.

use std::collections::HashMap;

/// The tags of one name.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    /// Elements that are open.
    open: u32,
    /// Start tags that come, without those of empty elements.
    starts: u32,
    /// End tags that come.
    ends: u32,
}

/// The tags of a text by name, from the place on that is looked at.
#[derive(Debug, Default)]
pub(super) struct Counts<'a>(HashMap<&'a str, Count>);

impl<'a> Counts<'a> {
    /// Adds a start tag that comes.
    pub(super) fn add_start(&mut self, name: &'a str) {
        self.0.entry(name).or_default().starts += 1;
    }

    /// Adds an end tag that comes.
    pub(super) fn add_end(&mut self, name: &'a str) {
        self.0.entry(name).or_default().ends += 1;
    }

    /// A start tag was reached.
    pub(super) fn start(&mut self, name: &str) {
        if let Some(one) = self.0.get_mut(name) {
            one.starts = one.starts.saturating_sub(1);
        }
    }

    /// An end tag was reached.
    pub(super) fn end(&mut self, name: &str) {
        if let Some(one) = self.0.get_mut(name) {
            one.ends = one.ends.saturating_sub(1);
        }
    }

    /// An element was opened.
    pub(super) fn open(&mut self, name: &'a str) {
        self.0.entry(name).or_default().open += 1;
    }

    /// An element was closed.
    pub(super) fn close(&mut self, name: &str) {
        if let Some(one) = self.0.get_mut(name) {
            one.open = one.open.saturating_sub(1);
        }
    }

    fn get(&self, name: &str) -> Count {
        self.0.get(name).copied().unwrap_or_default()
    }

    /// True if an element of the name is open.
    pub(super) fn is_open(&self, name: &str) -> bool {
        self.get(name).open > 0
    }

    /// The number of missing end tags.
    pub(super) fn missing_ends(&self, name: &str) -> u32 {
        let Count { open, starts, ends } = self.get(name);
        (open + starts).saturating_sub(ends)
    }

    /// True if there are more end tags than elements, the one that was just reached included.
    pub(super) fn has_surplus_end(&self, name: &str) -> bool {
        let Count { open, starts, ends } = self.get(name);
        ends + 1 > open + starts
    }
}
