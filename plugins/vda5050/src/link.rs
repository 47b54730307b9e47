//! The link to a vehicle: orders go out, and its states come in on a thread of the session.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use saoms_transport::mqtt::Mqtt;
use saoms_transport::{Listener, Message, Session, Settings, Transport};
use serde::Serialize;

use crate::messages::{ActionOrder, Edge, Head, InstantActions, Node, Order, State, now};

/// The version of VDA 5050 that is spoken.
const VERSION: &str = "2.0.0";
/// Time after which a vehicle is asked again for its first state.
const AGAIN: Duration = Duration::from_millis(200);
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

/// How an order goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Running,
    Done,
    /// Why it is not carried out.
    Failed(String),
}

/// The newest order: what a vehicle says of others does not count.
#[derive(Clone, Debug, Default)]
struct Given {
    order: String,
    /// The node where it ends.
    target: String,
    /// Its action, if it has one.
    action: Option<String>,
    /// The action that cancels it, if that was given.
    cancel: Option<String>,
}

#[derive(Debug, Default)]
struct Shared {
    known: Mutex<Known>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Known {
    /// What the vehicle said last.
    state: Option<State>,
    /// The newest order; none before the first one.
    given: Option<Given>,
    /// True while the broker is away.
    is_away: bool,
    /// True if the vehicle is to be asked for its state, which was not heard while the broker was away.
    wants_state: bool,
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
        // What is no state says nothing.
        if let Ok(state) = serde_json::from_slice::<State>(message.message) {
            self.0.lock().state = Some(state);
            self.0.changed.notify_all();
        }
        true
    }

    fn link(&self, is_up: bool, _: &str) {
        let mut known = self.0.lock();
        (known.is_away, known.wants_state) = (!is_up, is_up);
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

    /// Asks the vehicle for its first state until it says it; false if it does not in time.
    pub(crate) fn wait(&self, patience: Duration) -> bool {
        let begin = Instant::now();
        while begin.elapsed() < patience {
            // A vehicle that has just started, too, may not hear the first question.
            let is_asked = self.ask().is_ok();
            if is_asked && self.shared.wait(AGAIN, |known| known.state.is_some()) {
                return true;
            }
        }
        false
    }

    /// What the vehicle said last.
    pub(crate) fn state(&self) -> Option<State> {
        self.shared.lock().state.clone()
    }

    /// Orders the way over these nodes, with an action at the last one. The order before is over. False: the broker is
    /// away, and the vehicle hears nothing.
    pub(crate) fn order(&self, mut nodes: Vec<Node>, action: Option<ActionOrder>) -> Result<bool, String> {
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
        let mut known = self.shared.lock();
        if known.is_away {
            return Ok(false);
        }
        // Before it leaves: the vehicle may answer before this thread goes on.
        known.given = Some(given);
        drop(known);
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

    /// Cancels the newest order, once however many want it.
    pub(crate) fn cancel(&self) -> Result<(), String> {
        let cancel = self.action("cancelOrder", "cancel", "HARD");
        match &mut self.shared.lock().given {
            Some(given) if given.cancel.is_none() => given.cancel = Some(cancel.action_id.clone()),
            _ => return Ok(()),
        }
        self.say_at_once(cancel)
    }

    /// Cancels what runs, and waits until the vehicle says that it stands still; false if it does not.
    pub(crate) fn stop(&self, patience: Duration) -> bool {
        if self.outcome() == Outcome::Done && self.state().is_some_and(|state| !state.driving) {
            return true;
        }
        let is_said = self.cancel().is_ok();
        is_said && self.shared.wait(patience, |known| known.given.as_ref().is_none_or(|given| stands(given, known)))
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

/// How an order goes, as the vehicle says it.
fn outcome(given: &Given, state: &State) -> Outcome {
    if let Some(error) =
        state.errors.iter().find(|one| one.is_about("orderId", &given.order) || one.error_level == "FATAL")
    {
        return Outcome::Failed(format!("{} {}", error.error_type, error.error_description).trim_end().to_owned());
    }
    if !["AUTOMATIC", "SEMIAUTOMATIC", ""].contains(&&*state.operating_mode) {
        return Outcome::Failed(format!("it is in mode {}", state.operating_mode));
    }
    if state.order_id != given.order {
        return Outcome::Running;
    }
    let action = given.action.as_ref().map(|id| state.action(id));
    match action {
        Some(Some(action)) if action.action_status == "FAILED" => {
            Outcome::Failed(format!("its action failed {}", action.result_description).trim_end().to_owned())
        }
        Some(action) if action.is_none_or(|action| action.action_status != "FINISHED") => Outcome::Running,
        _ if state.has_arrived() && state.last_node_id == given.target => Outcome::Done,
        _ => Outcome::Running,
    }
}

/// True if the vehicle says that it stands still, and carries out nothing of an order any more.
fn stands(given: &Given, known: &Known) -> bool {
    let (Some(state), Some(cancel)) = (&known.state, &given.cancel) else { return false };
    // It answers one that it does not need with an error, or with a failed action.
    let is_over = |status: &str| ["FINISHED", "FAILED"].contains(&status);
    let is_answered = state.action(cancel).is_some_and(|action| is_over(&action.action_status))
        || state.errors.iter().any(|one| one.is_about("actionId", cancel));
    let is_idle =
        given.action.as_ref().and_then(|id| state.action(id)).is_none_or(|action| is_over(&action.action_status));
    is_answered && is_idle && !state.driving
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(text: &str) -> State {
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn what_a_vehicle_says_decides_on_the_newest_order_alone() {
        let (order, target) = ("o2".to_owned(), "3-4".to_owned());
        let move_to = Given { order: order.clone(), target: target.clone(), ..Given::default() };
        let pick = Given { order, target, action: Some("a".to_owned()), cancel: None };
        let there = r#"{"orderId":"o2","lastNodeId":"3-4","nodeStates":[],"edgeStates":[],"driving":false,"#;
        for (given, text, expected) in [
            (&move_to, r#"{"orderId":"o1","lastNodeId":"3-4"}"#.to_owned(), "Running"),
            (&move_to, r#"{"orderId":"o2","lastNodeId":"2-4","nodeStates":[{}],"driving":true}"#.to_owned(), "Running"),
            (&move_to, r#"{"orderId":"o2","lastNodeId":"2-4"}"#.to_owned(), "Running"),
            (&move_to, format!("{there}\"operatingMode\":\"AUTOMATIC\"}}"), "Done"),
            (&move_to, format!("{there}\"operatingMode\":\"MANUAL\"}}"), "Failed(\"it is in mode MANUAL\")"),
            (&pick, format!("{there}\"actionStates\":[]}}"), "Running"),
            (&pick, format!(r#"{there}"actionStates":[{{"actionId":"a","actionStatus":"RUNNING"}}]}}"#), "Running"),
            (&pick, format!(r#"{there}"actionStates":[{{"actionId":"a","actionStatus":"FINISHED"}}]}}"#), "Done"),
            (
                &pick,
                format!(r#"{there}"actionStates":[{{"actionId":"a","actionStatus":"FAILED"}}]}}"#),
                "Failed(\"its action failed\")",
            ),
            (
                &move_to,
                r#"{"orderId":"o1","errors":[{"errorType":"orderError","errorLevel":"WARNING",
                    "errorReferences":[{"referenceKey":"orderId","referenceValue":"o2"}]}]}"#
                    .to_owned(),
                "Failed(\"orderError\")",
            ),
        ] {
            assert_eq!(format!("{:?}", outcome(given, &state(&text))), expected, "{text}");
        }
    }
}
