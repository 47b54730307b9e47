//! What a robot goes on with when a new build of it, or of one of its loops, takes its place.

use saoms_api::{Failure, Header, Message, Saved, Time};

use super::RobotKnowledge;
use crate::grid::Block;
use crate::messages::{CriticalSituation, EventLuggage};

/// What a robot without a job knows that nobody tells it again.
#[derive(Clone, Debug, Message)]
struct Memory {
    battery: f64,
    asleep: bool,
    relieved: bool,
    is_loaded: bool,
    charge_block: Block,
    luggage: Vec<EventLuggage>,
    critical: Vec<CriticalSituation>,
}

impl RobotKnowledge {
    /// Writes down what it goes on with. A robot in the middle of something cannot: its loops know more than is in here.
    pub(super) fn save(&self) -> Result<Saved, Failure> {
        if self.variables.critical {
            return Err("it is out of order".into());
        }
        if let Some(job) = self.job {
            return Err(Failure::new(format!("it brings luggage {}", job.luggage)));
        }
        let claims = self.variables.transporter || self.offers_help || self.untold.is_some();
        if claims || self.hooks.running().is_some() {
            return Err("it is in the middle of something".into());
        }
        let requests = self.lists.requests.open().iter().map(|request| request.job);
        let luggage = requests.map(|job| EventLuggage::request(job.luggage, job.from, job.to));
        let critical = self.lists.helps.open().iter().map(|help| help.situation.clone());
        Ok(Saved::of(&Memory {
            battery: self.battery.percent(),
            asleep: self.variables.asleep,
            relieved: self.relieved,
            is_loaded: self.is_loaded,
            charge_block: self.charge_block,
            luggage: luggage.collect(),
            critical: critical.collect(),
        }))
    }

    /// Goes on with that.
    pub(super) fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let Some(memory) = saved.read::<Memory>()? else { return Ok(()) };
        self.battery.set_percent(memory.battery);
        self.charge = self.battery.percent();
        (self.variables.asleep, self.variables.in_charge) = (memory.asleep, memory.asleep);
        (self.relieved, self.is_loaded) = (memory.relieved, memory.is_loaded);
        if memory.charge_block != self.charge_block {
            self.use_charger(memory.charge_block);
        }
        // They have waited for some time; how long does not matter.
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
