//! State that a robot keeps when it, or one of its loops, is replaced by a new build.

use std::time::Duration;

use saoms_api::{Failure, Header, Message, Saved, Time};

use super::RobotKnowledge;
use super::tally::Tally;
use crate::grid::Block;
use crate::messages::{CriticalSituation, EventLuggage};

/// Knowledge of a robot without a job that no message repeats.
#[derive(Clone, Debug, Message)]
struct Memory {
    battery: f64,
    asleep: bool,
    relieved: bool,
    loaded: bool,
    charge_block: Block,
    luggage: Vec<EventLuggage>,
    critical: Vec<CriticalSituation>,
    delivered: u64,
    blocks: u64,
    waited_ns: u64,
}

impl RobotKnowledge {
    /// Saves the state. A robot in the middle of a job cannot be saved: its loops know more than this.
    pub(super) fn save(&self) -> Result<Saved, Failure> {
        if self.variables.critical {
            return Err("it is out of order".into());
        }
        if let Some(job) = self.job {
            return Err(Failure::new(format!("it brings luggage {}", job.luggage)));
        }
        let claims = self.variables.transporter || self.offers_help || self.untold.is_some();
        if claims || self.hardware.running().is_some() {
            return Err("it is not idle".into());
        }
        let requests = self.lists.requests.open().iter().map(|request| request.job);
        let luggage = requests.map(|job| EventLuggage::request(job.luggage, job.from, job.to));
        let critical = self.lists.helps.open().iter().map(|help| help.situation.clone());
        Ok(Saved::of(&Memory {
            battery: self.battery.percent(),
            asleep: self.variables.asleep,
            relieved: self.relieved,
            loaded: self.loaded,
            charge_block: self.charge_block,
            luggage: luggage.collect(),
            critical: critical.collect(),
            delivered: self.tally.delivered,
            blocks: self.tally.blocks,
            waited_ns: u64::try_from(self.tally.waited.as_nanos()).unwrap_or(u64::MAX),
        }))
    }

    /// Restores a saved state.
    pub(super) fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let Some(memory) = saved.read::<Memory>()? else { return Ok(()) };
        self.battery.set_percent(memory.battery);
        self.charge = self.battery.percent();
        (self.variables.asleep, self.variables.in_charge) = (memory.asleep, memory.asleep);
        let waited = Duration::from_nanos(memory.waited_ns);
        self.tally = Tally { delivered: memory.delivered, blocks: memory.blocks, waited };
        (self.relieved, self.loaded) = (memory.relieved, memory.loaded);
        if memory.charge_block != self.charge_block {
            self.use_charger(memory.charge_block);
        }
        // They have waited for an unknown time, which does not matter.
        let header = Header { sender: u32::MAX, sent: Time::START, cause: saoms_api::Cause::default() };
        for request in &memory.luggage {
            self.lists.requests.hear(request, header);
        }
        for situation in &memory.critical {
            self.lists.helps.hear(situation, header);
        }
        Ok(())
    }
}
