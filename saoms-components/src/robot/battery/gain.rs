//! What the battery gains at the charger, by its level alone.

use std::time::Duration;

use saoms_api::{Context, Field, Time, warn};

use crate::grid::Block;
use crate::robot::RobotKnowledge;

/// Number of executions at the charger after which a battery that is no fuller gains nothing.
const PATIENCE: u32 = 5;
/// The least time of that where the hardware measures the battery, perhaps in whole percents: one takes 72 s where a
/// battery takes two hours.
const MEASURED_PATIENCE: Duration = Duration::from_secs(600);
/// Number of executions from one look for another charger to the next.
const LOOK_AGAIN: u32 = 20;
/// For how long a charger that gave nothing is not tried again, unless the robot stays there.
const TRY_AGAIN: Duration = Duration::from_secs(120);
/// Greatest number of chargers that a robot remembers to give nothing.
const MOST: usize = 64;

/// What the battery gains at the charger.
#[derive(Clone, Debug, Default, Field)]
pub(in crate::robot) struct Gain {
    /// Battery level in the last execution, in percent.
    level: f64,
    /// Number of executions without a gain, and their beginning.
    executions: u32,
    since: Time,
    /// Chargers that gave nothing.
    dead: Vec<DeadCharger>,
}

/// A charger that gave nothing.
#[derive(Clone, Copy, Debug, Field)]
struct DeadCharger {
    charger: Block,
    until: Time,
}

impl Gain {
    /// Notes the level of an execution. `None` while the battery gains or has none to gain, or it is too early to tell;
    /// true for the first time that it is known, and false now and then from then on.
    pub(in crate::robot) fn note(&mut self, knowledge: &RobotKnowledge, context: &Context<'_>) -> Option<bool> {
        let (charger, now, before) = (knowledge.charge_block, context.now(), self.level);
        self.level = knowledge.charge;
        if !knowledge.is_at_charger() || !knowledge.charging {
            self.executions = 0;
            return None;
        }
        if self.level > before || self.executions == 0 {
            if self.level > before && !self.dead.is_empty() {
                self.dead.retain(|one| one.charger != charger);
            }
            (self.executions, self.since) = (1, now);
            return None;
        }
        self.executions = self.executions.saturating_add(1);
        let is_measured = knowledge.hardware.measures_battery();
        if self.executions < PATIENCE || is_measured && now.since(self.since) < MEASURED_PATIENCE {
            return None;
        }
        let is_first = self.gives(charger, now);
        if !is_first && !self.executions.is_multiple_of(LOOK_AGAIN) {
            return None;
        }
        self.dead.retain(|one| one.charger != charger && one.until > now);
        if self.dead.len() == MOST {
            self.dead.remove(0);
        }
        self.dead.push(DeadCharger { charger, until: now + TRY_AGAIN });
        Some(is_first)
    }

    /// The same; the first time is said and counted, too.
    pub(in crate::robot) fn note_aloud(
        &mut self,
        knowledge: &RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Option<bool> {
        let is_first = self.note(knowledge, context)?;
        if is_first {
            let (charger, battery) = (knowledge.charge_block, knowledge.charge);
            context.count("chargers.without_gain", 1);
            warn!(context, "battery gains nothing at its charger at {charger}: it stays at {battery:.1} %");
        }
        Some(is_first)
    }

    /// False if a charger gave nothing not long ago.
    pub(in crate::robot) fn gives(&self, charger: Block, now: Time) -> bool {
        self.dead.iter().all(|one| one.charger != charger || one.until <= now)
    }
}
