//! What is known of a vehicle and of its newest order, and what that means.

use std::time::{Duration, Instant};

use crate::messages::{ActionState, State};

/// Time after which a vehicle is asked again for its first state, and told again to stop.
pub(crate) const AGAIN: Duration = Duration::from_millis(200);

/// How an order goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Running,
    Done,
    /// Why it is not carried out; the vehicle may still move.
    Failed(String),
    /// It was cancelled, and the vehicle may still move.
    Stopping,
    /// It was cancelled, and the vehicle stands still.
    Cancelled,
}

/// The newest order: what a vehicle says of others does not count.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given {
    pub(crate) order: String,
    /// The node where it ends.
    pub(crate) target: String,
    /// Its action, if it has one.
    pub(crate) action: Option<String>,
    /// The action that cancels it, if that was given.
    pub(crate) cancel: Option<Cancel>,
}

/// The action that cancels an order.
#[derive(Clone, Debug)]
pub(crate) struct Cancel {
    id: String,
    /// When it is said, or said again: no broker keeps it for a vehicle that is away, or for one of ours.
    due: Instant,
}

/// What is known of a vehicle.
#[derive(Debug, Default)]
pub(crate) struct Known {
    /// What the vehicle said last.
    pub(crate) state: Option<State>,
    /// The newest order; none before the first one.
    pub(crate) given: Option<Given>,
    /// The number of stops so far.
    pub(crate) stops: u32,
    /// True while the broker is away.
    pub(crate) is_away: bool,
    /// Why the link was lost the last time.
    pub(crate) reason: String,
    /// Why what the vehicle says first is no state, until somebody has told it; nothing is kept after that.
    pub(crate) refused: Refused,
    /// True if the vehicle is to be asked for its state, which was not heard while the broker was away.
    pub(crate) wants_state: bool,
}

/// What is known of messages that are no states.
#[derive(Debug, Default)]
pub(crate) enum Refused {
    #[default]
    None,
    /// The first one: why it is none.
    Untold(String),
    Told,
}

impl Known {
    /// True if the vehicle says that it stands still, and carries out nothing of the newest order any more.
    pub(crate) fn stands(&self) -> bool {
        match (&self.given, &self.state) {
            (Some(given), Some(state)) => stands(given, state),
            (Some(_), None) => false,
            (None, _) => true,
        }
    }

    /// Takes a new order; false if the broker is away.
    pub(crate) fn give(&mut self, given: Given, stops: u32) -> Result<bool, String> {
        if self.stops != stops {
            return Err("it is stopped".to_owned());
        }
        if !self.is_away {
            self.given = Some(given);
        }
        Ok(!self.is_away)
    }

    /// The action that cancels the newest order, if it is to be said now: the same one, as long as the vehicle does not
    /// answer it.
    pub(crate) fn cancel_due(&mut self, now: Instant, new: impl FnOnce() -> String) -> Option<String> {
        let given = self.given.as_mut()?;
        let cancel = given.cancel.get_or_insert_with(|| Cancel { id: new(), due: now });
        if now < cancel.due || self.state.as_ref().is_some_and(|state| is_answered(&cancel.id, state)) {
            return None;
        }
        cancel.due = now + AGAIN;
        Some(cancel.id.clone())
    }
}

/// How an order goes, as the vehicle says it.
pub(crate) fn outcome(given: &Given, state: &State) -> Outcome {
    if given.cancel.is_none() {
        return progress(given, state);
    }
    match stands(given, state) {
        // It was over before.
        true if progress(given, state) == Outcome::Done => Outcome::Done,
        true => Outcome::Cancelled,
        false => Outcome::Stopping,
    }
}

/// The same for an order that was not cancelled.
fn progress(given: &Given, state: &State) -> Outcome {
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

/// True if the vehicle says that it stands still, and carries out nothing of an order any more that was cancelled.
fn stands(given: &Given, state: &State) -> bool {
    let is_answered = given.cancel.as_ref().is_some_and(|cancel| is_answered(&cancel.id, state));
    let is_idle = given.action.as_ref().and_then(|id| state.action(id)).is_none_or(ActionState::is_over);
    is_answered && is_idle && !state.driving
}

/// True if the vehicle has answered an action that cancels. One that it does not need it answers with an error, or with
/// a failed action.
fn is_answered(id: &str, state: &State) -> bool {
    state.action(id).is_some_and(ActionState::is_over) || state.errors.iter().any(|one| one.is_about("actionId", id))
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

    /// What cancels an order goes out again under its name until the vehicle has answered, and it is over only once the
    /// vehicle stands.
    #[test]
    fn an_order_is_cancelled_until_the_vehicle_says_that_it_stands() {
        let start = Instant::now();
        let at = |milliseconds| start + Duration::from_millis(milliseconds);
        let given = Given { order: "o2".to_owned(), target: "3-4".to_owned(), ..Given::default() };
        let mut known = Known { given: Some(given), ..Known::default() };
        let say = |known: &mut Known, now| known.cancel_due(now, || "c".to_owned());
        let outcome = |known: &Known| outcome(known.given.as_ref().unwrap(), known.state.as_ref().unwrap());
        assert_eq!(say(&mut known, at(0)).as_deref(), Some("c"));
        assert_eq!(say(&mut known, at(199)), None);
        assert_eq!(known.cancel_due(at(200), || "another".to_owned()).as_deref(), Some("c"));
        for (text, expected, is_said) in [
            (r#"{"orderId":"o2","nodeStates":[{}],"driving":true}"#, Outcome::Stopping, true),
            (r#"{"orderId":"o2","actionStates":[{"actionId":"c","actionStatus":"RUNNING"}]}"#, Outcome::Stopping, true),
            (
                r#"{"driving":true,"actionStates":[{"actionId":"c","actionStatus":"FINISHED"}]}"#,
                Outcome::Stopping,
                false,
            ),
            (r#"{"actionStates":[{"actionId":"c","actionStatus":"FINISHED"}]}"#, Outcome::Cancelled, false),
            (
                r#"{"errors":[{"errorReferences":[{"referenceKey":"actionId","referenceValue":"c"}]}]}"#,
                Outcome::Cancelled,
                false,
            ),
            (
                r#"{"orderId":"o2","lastNodeId":"3-4","actionStates":[{"actionId":"c","actionStatus":"FAILED"}]}"#,
                Outcome::Done,
                false,
            ),
        ] {
            known.state = Some(state(text));
            assert_eq!(outcome(&known), expected, "{text}");
            assert_eq!(known.stands(), expected != Outcome::Stopping, "{text}");
            known.given.as_mut().unwrap().cancel.as_mut().unwrap().due = start;
            assert_eq!(say(&mut known, at(1000)).is_some(), is_said, "{text}");
        }
    }

    /// It goes out when the broker is there again, but not after a stop.
    #[test]
    fn an_order_that_waits_for_the_broker_is_none_after_a_stop() {
        let mut known = Known { is_away: true, ..Known::default() };
        assert_eq!(known.give(Given::default(), 0), Ok(false));
        known.is_away = false;
        assert_eq!(known.give(Given::default(), 0), Ok(true));
        known.stops += 1;
        assert!(known.give(Given::default(), 0).is_err());
    }
}
