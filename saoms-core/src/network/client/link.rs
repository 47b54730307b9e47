//! The link of a program to the others of a network.

use super::member::Member;
use crate::network::Fleet;

/// The kind of alerts of links.
const LINK: &str = "link";

/// The link to the other programs.
#[derive(Debug, Default)]
pub(super) struct Link {
    /// Since when the transport says that it is down.
    down: Option<u64>,
    /// True if it counts as lost.
    is_lost: bool,
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
}
