//! The fleet of a program, and what it is on a network.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use saoms_api::Level;

use super::control::{ControlRequest, Reply};
use super::exchange::wire::{Request, Vote};
use super::exchange::{Arrived, Remembered};
use super::rights::Granted;

/// Messages of other programs for the fleet by their topics, none of which waits for another one.
pub type Undelivered = BTreeMap<Arc<str>, VecDeque<Arrived>>;

/// The fleet of a program, as its part of a network sees it.
pub trait Fleet: Send + 'static {
    /// True once its components are there: what they read was left at the port before.
    fn has_started(&self) -> bool;

    /// Takes messages of each topic from the front, as many as find room.
    fn deliver(&self, messages: &mut Undelivered);

    /// Serves a call of another program, or takes in a heartbeat. The answer of a call is left at the port.
    fn serve(&self, request: Request);

    /// A program gives no sign of life any more, or has ended: nothing goes on that it moved.
    fn misses(&self, program: &str);

    /// Whether it sees work left.
    fn vote(&self) -> Vote;

    /// Whether all programs of the network agree that no work is left: the run may end then.
    fn agree(&self, is_done: bool);

    /// Tells something about the network.
    fn tell(&self, level: Level, text: String);

    /// Counts messages that are lost for good, and remembers what was told of the first: the run fails.
    fn count_lost(&self, count: u64, text: &str);

    /// Ends the run as failed, for this reason.
    fn fail(&self, reason: String);

    /// True if a signal has come that ends the run: nobody waits any longer than necessary.
    fn is_interrupted(&self) -> bool;

    /// Tells a person that the link to the network is lost, or that a program gives no sign of life; without a text,
    /// that it is over.
    fn alert(&self, kind: &str, subject: &str, text: Option<String>);

    /// Carries out a request of an operator, and answers it later. Does not wait.
    fn control(&self, request: ControlRequest, reply: Reply);

    /// Marks the present moment.
    fn mark(&self);

    /// True once all that was delivered before the mark is executed and committed, or never will be.
    fn has_passed_mark(&self) -> bool;

    /// Changes what outlives the program, as a whole.
    fn remember(&self, changes: Vec<Remembered>);

    /// The link is lost: no other program was heard for the patience of this one.
    fn lose(&self);
}

/// What a program is on a network.
#[derive(Clone, Debug, Default)]
pub struct Membership {
    /// Where the network is.
    pub url: String,
    /// Of a network without a router, its other programs: the name of each, and where it listens.
    pub peers: Vec<(String, String)>,
    /// The user as which it has joined.
    pub user: Option<String>,
    /// Of the router: what it lets users do, if that is not everything.
    pub grants: Option<Granted>,
    /// The components that read each topic.
    pub readers: BTreeMap<String, Vec<String>>,
    /// True if components call others over the network.
    pub has_calls: bool,
}

impl Membership {
    pub(super) fn readers(&self, topic: &str) -> Vec<String> {
        self.readers.get(topic).cloned().unwrap_or_default()
    }
}
