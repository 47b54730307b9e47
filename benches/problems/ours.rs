//! A problem solved by a fleet in virtual time.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use saoms_api::host::TopicDeclaration;
use saoms_components::messages::{
    ENVIRONMENT, EVENT_LUGGAGE, EnvironmentEvent, EventLuggage, LuggageStage, VISIT, Visit, is_visit,
};
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
    /// All that were visible; `None` for those that are done.
    shown: HashMap<u32, Option<Open>>,
    longest: Duration,
    last: Duration,
    finished: usize,
    /// When each robot that has tasks of its own did one last: it is shown the next one then.
    free: HashMap<u32, Duration>,
}

/// A task that is visible, and not done.
struct Open {
    since: Duration,
    /// The robot that alone may do it; 0 for any.
    owner: u32,
    /// The robot that has it now, and when it took it.
    taken: Option<(u32, Duration)>,
}

impl Tasks {
    fn show(&mut self, number: u32, owner: u32, since: Duration) {
        self.shown.entry(number).or_insert(Some(Open { since, owner, taken: None }));
    }

    /// How long a task was visible until a robot had it, or until now.
    fn wait(&self, open: &Open, now: Duration) -> Duration {
        let since = self.free.get(&open.owner).map_or(open.since, |free| open.since.max(*free));
        open.taken.map_or(now, |(_, taken)| taken).saturating_sub(since)
    }

    fn take(&mut self, number: u32, robot: u32, at: Duration) {
        if let Some(Some(open)) = self.shown.get_mut(&number) {
            open.taken = Some((robot, at));
        }
    }

    /// The next robot may have taken it already.
    fn release(&mut self, number: u32, robot: u32) {
        if let Some(Some(open)) = self.shown.get_mut(&number) {
            open.taken = open.taken.filter(|(other, _)| *other != robot);
        }
    }

    fn finish(&mut self, number: u32, at: Duration) {
        let Some(open) = self.shown.get_mut(&number).and_then(Option::take) else { return };
        self.longest = self.longest.max(self.wait(&open, at));
        if open.owner != 0 {
            self.free.insert(open.owner, at);
        }
        self.finished += 1;
        self.last = at;
    }
}

impl Observer for Watch {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn wants_topic(&self, name: &str, _: &TopicDeclaration<'_>) -> bool {
        [EVENT_LUGGAGE.name(), ENVIRONMENT.name(), VISIT.name()].contains(&name)
    }

    fn message(&self, sent: &SentMessage) {
        let at = sent.message.header().sent.since(saoms_api::Time::START);
        let mut tasks = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(event) = sent.message.get::<EnvironmentEvent>() {
            event.luggage.iter().for_each(|luggage| tasks.show(luggage.luggage, 0, at));
        }
        // Some responses could be read as visits, too.
        if let Some(visit) = sent.message.get::<Visit>().filter(|visit| is_visit(visit.visit)) {
            tasks.show(visit.visit, visit.robot, at);
        }
        let Some(said) = sent.message.get::<EventLuggage>() else { return };
        match said.stage {
            LuggageStage::Taken => tasks.take(said.luggage, said.robot, at),
            LuggageStage::Release => tasks.release(said.luggage, said.robot),
            LuggageStage::Delivered => tasks.finish(said.luggage, at),
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
    let waiting = tasks.shown.values().flatten().map(|open| tasks.wait(open, limit)).max();
    let collisions = &report.sections["collisions"];
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a run has fewer steps")]
    Ok(Solved {
        finished: tasks.finished,
        makespan: in_steps(tasks.last.saturating_sub(fleet.step)) as u32,
        longest_wait: in_steps(tasks.longest.max(waiting.unwrap_or_default())) as u32,
        collisions: ["vertex", "swap"].iter().filter_map(|kind| collisions[kind].as_u64()).sum(),
    })
}
