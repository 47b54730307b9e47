//! The link of a program to the others of a network.

use saoms_api::Level;

use super::member::Member;
use crate::network::{Fleet, LINK};

/// Time after which a program says that none of its peers is there, in nanoseconds: those that are connect in it.
const ALONE: u64 = 2_000_000_000;
/// Peers that are named, at most.
const MOST_NAMED: usize = 8;

/// The link to the other programs.
#[derive(Debug, Default)]
pub(super) struct Link {
    /// Since when the transport says that it is down.
    down: Option<u64>,
    /// True if it counts as lost.
    is_lost: bool,
    /// True if it was told that none of the peers is there.
    has_told_alone: bool,
}

impl Link {
    /// The transport says whether it is there.
    pub(super) fn note(&mut self, is_up: bool, now: u64) {
        self.down = (!is_up).then(|| self.down.unwrap_or(now));
    }
}

impl<F: Fleet> Member<F> {
    /// Tells that the link is lost, and does what follows from that: it is down for the patience of this program, or
    /// none of the other programs is heard.
    pub(super) fn watch_link(&mut self, now: u64) {
        let is_down = self.link.down.is_some_and(|since| now.saturating_sub(since) > self.patience);
        let is_lost = is_down || self.exchange.hears_nobody();
        if std::mem::replace(&mut self.link.is_lost, is_lost) == is_lost {
            return;
        }
        let url = &self.membership.url;
        let text = format!("the link to the network `{url}` is lost: no other program is heard");
        self.fleet.alert(LINK, url, is_lost.then_some(text));
        if is_lost {
            self.fleet.lose();
        }
    }

    /// Tells once that none of the programs is there which the url of a network without a router names.
    pub(super) fn look_for_peers(&mut self, now: u64) {
        let peers = &self.membership.peers;
        if self.link.has_told_alone || peers.is_empty() || now < ALONE || !self.exchange.has_met_nobody() {
            return;
        }
        self.link.has_told_alone = true;
        let mut named: Vec<String> =
            peers.iter().take(MOST_NAMED).map(|(name, address)| format!("`{name}` at {address}")).collect();
        if let Some(more) = peers.len().checked_sub(MOST_NAMED).filter(|more| *more > 0) {
            named.push(format!("{more} more"));
        }
        let text = format!(
            "waits for the other programs of the network `{}`: none of them is there yet; it tries {}: start them, or correct \
             `url`, which is the same in all of them",
            self.membership.url,
            named.join(", ")
        );
        self.fleet.tell(Level::Warning, text);
    }
}
