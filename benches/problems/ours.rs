//! A problem solved by a fleet in virtual time.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use saoms_api::host::TopicDeclaration;
use saoms_components::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
use saoms_core::observe::{Interest, Observer, SentMessage};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_testkit::{Problem, ProblemFleet};

use crate::Solved;
use crate::common::{Outcome, deploy};

/// What becomes of the tasks.
#[derive(Default)]
struct Watch(Mutex<Tasks>);

#[derive(Default)]
struct Tasks {
    /// When each task that no robot has taken was requested.
    waiting: HashMap<u32, Duration>,
    longest: Duration,
    last: Duration,
    finished: usize,
}

impl Observer for Watch {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn wants_topic(&self, name: &str, _: &TopicDeclaration<'_>) -> bool {
        name == EVENT_LUGGAGE.name()
    }

    fn message(&self, sent: &SentMessage) {
        let Some(event) = sent.message.get::<EventLuggage>() else { return };
        let at = sent.message.header().sent.since(saoms_api::Time::START);
        let mut tasks = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match event.stage {
            LuggageStage::Request if event.robot == 0 => _ = tasks.waiting.entry(event.luggage).or_insert(at),
            LuggageStage::Taken => {
                if let Some(since) = tasks.waiting.remove(&event.luggage) {
                    tasks.longest = tasks.longest.max(at - since);
                }
            }
            LuggageStage::Delivered => {
                tasks.finished += 1;
                tasks.last = at;
            }
            _ => {}
        }
    }
}

/// Runs the fleet of a problem for its number of steps at most.
pub(crate) fn solve(problem: &Problem, fleet: &ProblemFleet, seed: u64) -> Outcome<Solved> {
    let assembly = deploy::checked(problem.composite(fleet))?.assembly;
    // The tasks appear after the first step.
    let limit = fleet.step * (fleet.steps + 1);
    let settings = Settings { limit: Some(limit), ..Settings::simulated(seed) };
    let watch = Arc::new(Watch::default());
    let report = deploy::finish(RunningFleet::start(assembly, settings, vec![watch.clone()])?)?;
    let tasks = watch.0.lock().unwrap_or_else(PoisonError::into_inner);
    let in_steps = |time: Duration| time.div_duration_f64(fleet.step).ceil();
    let waiting = tasks.waiting.values().map(|since| limit.saturating_sub(*since)).max();
    let collisions = &report.sections["collisions"];
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a run has fewer steps")]
    Ok(Solved {
        finished: tasks.finished,
        makespan: in_steps(tasks.last.saturating_sub(fleet.step)) as u32,
        longest_wait: in_steps(tasks.longest.max(waiting.unwrap_or_default())) as u32,
        collisions: ["vertex", "swap"].iter().filter_map(|kind| collisions[kind].as_u64()).sum(),
    })
}
