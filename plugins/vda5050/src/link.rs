//! The link to a vehicle: orders go out, and its states come in on a thread of the session.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use saoms_transport::mqtt::Mqtt;
use saoms_transport::{Listener, Message, Session, Settings, Transport};
use serde::Serialize;

use crate::known::{AGAIN, Given, Known, Outcome, Refused, outcome};
use crate::messages::{ActionOrder, Edge, Head, InstantActions, Node, Order, State, now};

/// The version of VDA 5050 that is spoken.
const VERSION: &str = "2.0.0";
/// The token of the only subscription.
const STATES: u64 = 1;

/// A vehicle, by the names that its topics have.
#[derive(Clone, Debug)]
pub(crate) struct Names {
    /// The first parts of its topics, such as `uagv/v2`.
    pub(crate) prefix: String,
    pub(crate) manufacturer: String,
    pub(crate) serial_number: String,
}

#[derive(Debug, Default)]
struct Shared {
    known: Mutex<Known>,
    changed: Condvar,
}

/// The link to a vehicle. It never waits but in [`stop`](Link::stop) and [`wait`](Link::wait).
pub(crate) struct Link {
    session: Session<Mqtt>,
    names: Names,
    shared: Arc<Shared>,
    /// A number that no order of an earlier start has.
    start: u128,
    orders: AtomicU32,
    headers: AtomicU32,
}

struct Hears(Arc<Shared>);

impl Listener for Hears {
    fn deliver(&self, _: u64, message: Message<'_>) -> bool {
        let read = serde_json::from_slice::<State>(message.message);
        let mut known = self.0.lock();
        match read {
            Ok(state) => {
                known.state = Some(state);
                self.0.changed.notify_all();
            }
            // What is no state says nothing.
            Err(error) if matches!(known.refused, Refused::None) => known.refused = Refused::Untold(error.to_string()),
            Err(_) => {}
        }
        true
    }

    fn link(&self, is_up: bool, reason: &str) {
        let mut known = self.0.lock();
        (known.is_away, known.wants_state) = (!is_up, is_up);
        if !is_up {
            reason.clone_into(&mut known.reason);
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until this is so; false if it is not in time.
    fn wait(&self, patience: Duration, is: impl Fn(&Known) -> bool) -> bool {
        let waited = self.changed.wait_timeout_while(self.lock(), patience, |known| !is(known));
        let (known, _) = waited.unwrap_or_else(PoisonError::into_inner);
        is(&known)
    }
}

impl Link {
    /// Joins the broker.
    pub(crate) fn open(settings: Settings, names: Names) -> Result<Link, String> {
        let shared = Arc::<Shared>::default();
        let session = Session::<Mqtt>::join(settings, Box::new(Hears(Arc::clone(&shared))));
        let session = session.map_err(|failure| failure.text)?;
        let start = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_millis();
        let (orders, headers) = (AtomicU32::default(), AtomicU32::default());
        let link = Link { session, names, shared, start, orders, headers };
        link.session.subscribe(&link.topic("state"), STATES).map_err(|failure| failure.text)?;
        Ok(link)
    }

    /// Asks the vehicle for its state.
    fn ask(&self) -> Result<(), String> {
        self.say_at_once(self.action("stateRequest", "state", "NONE"))
    }

    /// Asks the vehicle for its first state until it says it.
    ///
    /// # Errors
    /// It does not in time: why, as far as that is known.
    pub(crate) fn wait(&self, patience: Duration) -> Result<(), String> {
        let begin = Instant::now();
        while begin.elapsed() < patience {
            // A vehicle that has just started, too, may not hear the first question, and some cannot be said.
            let _ = self.ask();
            if self.shared.wait(AGAIN, |known| known.state.is_some()) {
                return Ok(());
            }
        }
        let known = self.shared.lock();
        Err(match &known.refused {
            Refused::Untold(why) => format!("what it says is no state: {why}"),
            _ if known.reason.is_empty() => "it does not say its state".to_owned(),
            _ => format!("it does not say its state: {}", known.reason),
        })
    }

    /// Why what the vehicle said is no state, the first time; `None` once that was told.
    pub(crate) fn refused(&self) -> Option<String> {
        let mut known = self.shared.lock();
        match std::mem::replace(&mut known.refused, Refused::Told) {
            Refused::Untold(why) => Some(why),
            before => {
                known.refused = before;
                None
            }
        }
    }

    /// Why the broker is away, while it is.
    pub(crate) fn trouble(&self) -> Option<String> {
        let known = self.shared.lock();
        known.is_away.then(|| known.reason.clone())
    }

    /// What the vehicle said last.
    pub(crate) fn state(&self) -> Option<State> {
        self.shared.lock().state.clone()
    }

    /// The number of stops so far.
    pub(crate) fn stops(&self) -> u32 {
        self.shared.lock().stops
    }

    /// Orders the way over these nodes, with an action at the last one. The order before is over. False: the broker is
    /// away, and the vehicle hears nothing. There is none if the vehicle was stopped after this number of stops.
    pub(crate) fn order(&self, mut nodes: Vec<Node>, action: Option<ActionOrder>, stops: u32) -> Result<bool, String> {
        let number = self.orders.fetch_add(1, Ordering::Relaxed) + 1;
        let id = format!("saoms-{}-{number}", self.start);
        let edges = nodes.windows(2).map(|pair| Edge {
            edge_id: format!("{}-{}", pair[0].node_id, pair[1].node_id),
            sequence_id: pair[0].sequence_id + 1,
            released: true,
            start_node_id: pair[0].node_id.clone(),
            end_node_id: pair[1].node_id.clone(),
            actions: Vec::new(),
        });
        let edges = edges.collect();
        let given = Given {
            order: id.clone(),
            target: nodes.last().map(|node| node.node_id.clone()).unwrap_or_default(),
            action: action.as_ref().map(|action| action.action_id.clone()),
            cancel: None,
        };
        if let (Some(last), Some(action)) = (nodes.last_mut(), action) {
            last.actions.push(action);
        }
        // Before it leaves: the vehicle may answer before this thread goes on.
        if !self.shared.lock().give(given, stops)? {
            return Ok(false);
        }
        let order = Order { head: self.head(), order_id: &id, order_update_id: 0, nodes, edges };
        self.say("order", &order).map(|()| true)
    }

    /// An action with a number of its own.
    pub(crate) fn action(&self, kind: &'static str, name: &str, blocking: &'static str) -> ActionOrder {
        let number = self.orders.fetch_add(1, Ordering::Relaxed) + 1;
        let action_id = format!("saoms-{}-{number}-{name}", self.start);
        ActionOrder { action_type: kind, action_id, blocking_type: blocking, action_parameters: Vec::new() }
    }

    /// How the newest order goes.
    pub(crate) fn outcome(&self) -> Outcome {
        let mut known = self.shared.lock();
        if std::mem::take(&mut known.wants_state) {
            // It is asked again when it is needed again.
            let _ = self.ask();
        }
        match (&known.given, &known.state) {
            (Some(given), Some(state)) => outcome(given, state),
            (None, _) => Outcome::Done,
            (_, None) => Outcome::Running,
        }
    }

    /// Cancels the newest order, and says so again from time to time, as often as this is called, until the vehicle
    /// answers. However many want it, it is one action.
    pub(crate) fn cancel(&self) {
        let mut action = self.action("cancelOrder", "cancel", "HARD");
        let id = self.shared.lock().cancel_due(Instant::now(), || action.action_id.clone());
        if let Some(id) = id {
            action.action_id = id;
            // What cannot be said now is said again.
            let _ = self.say_at_once(action);
        }
    }

    /// Cancels what runs, and waits until the vehicle says that it stands still; false if it does not.
    pub(crate) fn stop(&self, patience: Duration) -> bool {
        self.shared.lock().stops += 1;
        if self.outcome() == Outcome::Done && self.state().is_some_and(|state| !state.driving) {
            return true;
        }
        let begin = Instant::now();
        loop {
            self.cancel();
            let Some(rest) = patience.checked_sub(begin.elapsed()) else { return false };
            if self.shared.wait(rest.min(AGAIN), Known::stands) {
                return true;
            }
        }
    }

    fn head(&self) -> Head<'_> {
        Head {
            header_id: self.headers.fetch_add(1, Ordering::Relaxed),
            timestamp: now(),
            version: VERSION,
            manufacturer: &self.names.manufacturer,
            serial_number: &self.names.serial_number,
        }
    }

    fn say_at_once(&self, action: ActionOrder) -> Result<(), String> {
        self.say("instantActions", &InstantActions { head: self.head(), actions: vec![action] })
    }

    fn say(&self, what: &str, message: &impl Serialize) -> Result<(), String> {
        let text = serde_json::to_vec(message).map_err(|error| error.to_string())?;
        self.session.put(&self.topic(what), &text, &[], true).map_err(|failure| failure.text)
    }

    fn topic(&self, what: &str) -> String {
        let Names { prefix, manufacturer, serial_number } = &self.names;
        format!("{prefix}/{manufacturer}/{serial_number}/{what}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_keeps_a_state_away_is_known() {
        let shared = Arc::<Shared>::default();
        let hears = Hears(Arc::clone(&shared));
        let say = |text: &str| hears.deliver(STATES, Message { key: "", message: text.as_bytes(), attachment: b"" });
        assert!(say("[1]") && say("{"));
        assert!(matches!(&shared.lock().refused, Refused::Untold(why) if why.contains("line 1 column")));
        hears.link(false, "the broker is away");
        hears.link(true, "");
        let known = shared.lock();
        assert_eq!((known.is_away, &*known.reason), (false, "the broker is away"));
    }
}
