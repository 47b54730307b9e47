//! Questions to worlds, what robots left that are gone or have failed: the answer, or the news itself, may be lost.

use std::collections::BTreeMap;

use saoms_api::Context;

use super::MasterEnvironmentKnowledge;
use crate::messages::Fault;

/// Number of executions without an answer after which the master asks; it asks again after twice as many.
const ASKS_AFTER: u32 = 20;

/// Number of executions without an answer after which a person is told.
const TELLS_AFTER: u32 = 160;

/// The kind of alerts about robots of which no world says what they left.
const NO_ANSWER: &str = "removal_unknown";

/// Robots of which no world has said yet what they left.
#[derive(Debug, Default)]
pub(super) struct Unanswered {
    /// Number of executions since that is missing, by robot.
    waited: BTreeMap<u32, u32>,
    /// True if this component has asked about all robots that are out since it began.
    has_asked: bool,
}

impl Unanswered {
    /// What to ask in this execution. Tells a person of what is not answered, and when that is over.
    pub(super) fn due(&mut self, knowledge: &MasterEnvironmentKnowledge, context: &mut Context<'_>) -> Vec<Fault> {
        // Without a world nobody knows, and all luggage waits where it was to be collected.
        let has_world = knowledge.filter.area().is_some();
        let missing = if has_world { knowledge.open.unanswered() } else { BTreeMap::new() };
        self.waited.retain(|robot, _| {
            let lasts = missing.contains_key(robot);
            if !lasts {
                context.alert_over(NO_ANSWER, *robot);
            }
            lasts
        });
        let is_first = has_world && !std::mem::replace(&mut self.has_asked, has_world);
        let mut due: Vec<Fault> = is_first.then(Fault::any).into_iter().collect();
        for (robot, fault) in missing {
            let waited = self.waited.entry(robot).or_insert(0);
            *waited = waited.saturating_add(1);
            if waited.is_multiple_of(ASKS_AFTER) && (*waited / ASKS_AFTER).is_power_of_two() {
                due.push(fault);
            }
            // All masters of a site hear of a failure, and one of them tells.
            let tells = knowledge.speaks_for_all() || !knowledge.open.knows_failure(robot);
            if *waited == TELLS_AFTER && tells {
                let line = format_args!(
                    "waits for the world to say what robot {robot} left, and where: its luggage is not brought until \
                     then"
                );
                context.alert(NO_ANSWER, robot, line);
            }
        }
        due
    }

    /// The first robot of which a person was told.
    pub(super) fn first(&self) -> Option<u32> {
        self.waited.iter().find(|(_, waited)| **waited >= ASKS_AFTER).map(|(robot, _)| *robot)
    }
}
