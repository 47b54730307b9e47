//! What a program waits for when its run has ended: that others receive what they lack.

use std::time::{Duration, Instant};

use saoms_api::Level;
use saoms_api::host::format_duration;

use super::Member;
use crate::network::Fleet;

/// Time for which programs that are there and make no progress are waited for, at least, and at most once a signal has
/// ended the run.
const HASTE: Duration = Duration::from_secs(5);
/// Time after which it is told that programs are waited for which are there.
const SHORT: Duration = Duration::from_secs(2);

/// Why the end is waited with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// No work is left, and the run goes on.
    Agreed,
    /// The run has ended for another reason.
    Over,
    /// A signal has ended it.
    InHaste,
}

/// How long the end has been waited with.
#[derive(Debug)]
pub(in crate::network::client) struct Linger {
    /// When others received something last, or the run ended.
    since: Instant,
    /// Number of messages that they lacked then.
    lacked: u64,
    /// True if a signal has ended the run.
    is_in_haste: bool,
}

impl Linger {
    pub(in crate::network::client) fn begin<F: Fleet>(member: &Member<F>) -> Linger {
        Linger { since: Instant::now(), lacked: u64::MAX, is_in_haste: member.fleet.is_interrupted() }
    }
}

impl<F: Fleet> Member<F> {
    /// True while others may still receive what they lack, and are waited for.
    pub(in crate::network::client) fn lingers(&mut self, linger: &mut Linger) -> bool {
        if self.exchange.is_complete() && !self.exchange.awaits_answers() && self.unsent.is_empty() {
            return false;
        }
        if !linger.is_in_haste && self.fleet.is_interrupted() {
            return false;
        }
        let lacked = self.exchange.awaited().iter().map(|(_, count, _)| count).sum();
        if lacked < linger.lacked {
            *linger = Linger { since: Instant::now(), lacked, ..*linger };
        }
        let passed = linger.since.elapsed();
        let end = if linger.is_in_haste { End::InHaste } else { End::Over };
        self.tell_awaited(end, passed > SHORT);
        let is_there = self.exchange.awaits_answers() || self.exchange.awaited().iter().any(|(.., is_there)| *is_there);
        passed <= self.longest(end, is_there)
    }

    /// Time for which programs are waited for that make no progress.
    fn longest(&self, end: End, are_there: bool) -> Duration {
        match (end, are_there) {
            (End::InHaste, true) => HASTE,
            (End::InHaste, false) => self.linger.min(HASTE),
            // Who is there is about to receive what it lacks, however short others are waited for.
            (_, true) => self.linger.max(HASTE),
            (_, false) => self.linger,
        }
    }

    /// Tells once for whom the end is waited with: programs that give no sign of life, or all of them.
    pub(super) fn tell_awaited(&mut self, end: End, also_those_there: bool) {
        if self.has_told_awaited {
            return;
        }
        let awaited = self.exchange.awaited();
        let are_there = awaited.iter().all(|(.., is_there)| *is_there);
        let lacking: Vec<String> = awaited
            .into_iter()
            .filter(|(.., is_there)| also_those_there || !is_there)
            .map(|(name, count, is_there)| {
                let away = if is_there { "" } else { ", which gives no sign of life," };
                format!("program `{name}`{away} has not received {count} messages")
            })
            .collect();
        if lacking.is_empty() {
            return;
        }
        self.has_told_awaited = true;
        let longest = self.longest(end, are_there);
        let (why, what_is_that) = match end {
            End::Agreed => ("no work is left", ", the time of `--linger`"),
            End::Over if longest == self.linger => ("the run has ended", " without progress, the time of `--linger`"),
            End::Over | End::InHaste => ("the run has ended", " without progress"),
        };
        let text = format!(
            "{why}, but {}: this program waits for it up to {}{what_is_that}; Ctrl-C ends it before",
            lacking.join(", and "),
            format_duration(longest)
        );
        self.fleet.tell(Level::Warning, text);
    }
}
