//! State of a robot, for the one that takes its place: after a failure, or with a new build of it or of its loops.

pub(super) mod lasting;

use std::time::Duration;

use saoms_api::{Cause, Failure, Field, Message, Saved, SavedLoops, Time};

use super::Job;
use super::hardware_client::HardwareMemory;
use super::job::lease::Leased;
use super::knowledge::{JobEnd, RobotKnowledge, Trouble, Variables};
use super::lists::ListsMemory;
use super::routes::RoutesMemory;
use super::safe::{Energy, Leg, TrafficMemory};
use super::strain::Strain;
use super::tally::Tally;
use super::zone_client::ZoneMemory;
use crate::grid::Block;
use crate::validation::SpeakerMemory;

/// All that a robot knows, but what its properties say and what is measured anew in each execution.
#[derive(Clone, Debug, Message)]
struct Memory {
    executed_at: Option<Time>,
    tally: TallyMemory,
    block: Block,
    next: Block,
    wanted: Option<Block>,
    charge_block: Block,
    given_charger: Block,
    battery: BatteryMemory,
    strain: Strain,
    reserve: u32,
    must_charge: bool,
    job: Option<Job>,
    stops: Vec<Block>,
    visits: bool,
    variables: Variables,
    shut_down: bool,
    stands_in_for: Option<u32>,
    relieved: bool,
    speakers: SpeakerMemory,
    lists: ListsMemory,
    routes: RoutesMemory,
    hardware: HardwareMemory,
    begun: Cause,
    offers_help: bool,
    trouble: Option<Trouble>,
    failures: u32,
    untold: Option<JobEnd>,
    is_assigned: bool,
    assigned_by: u32,
    awaits_master: u32,
    lingers: u32,
    loaded: bool,
    said_homeward: bool,
    energy: Energy,
    lease: Option<Leased>,
    traffic: TrafficMemory,
    leg: Leg,
    zones: Option<ZoneMemory>,
    loops: SavedLoops,
}

#[derive(Clone, Copy, Debug, Field)]
struct TallyMemory {
    delivered: u64,
    blocks: u64,
    waited_ns: u64,
}

#[derive(Clone, Copy, Debug, Field)]
struct BatteryMemory {
    percent: f64,
    shown: f64,
    charging: bool,
    lasts: u32,
    way_home: u32,
    charge_at: f64,
    asked_to_charge: bool,
}

impl RobotKnowledge {
    /// The state of the robot, with that of its loops.
    pub(super) fn save(&self, loops: SavedLoops) -> Saved {
        let Tally { delivered, blocks, waited } = self.tally;
        let waited_ns = u64::try_from(waited.as_nanos()).unwrap_or(u64::MAX);
        Saved::of(&Memory {
            executed_at: self.executed_at,
            tally: TallyMemory { delivered, blocks, waited_ns },
            block: self.block,
            next: self.next,
            wanted: self.wanted,
            charge_block: self.charge_block,
            given_charger: self.given_charger,
            battery: BatteryMemory {
                percent: self.battery.percent(),
                shown: self.charge,
                charging: self.charging,
                lasts: self.lasts,
                way_home: self.way_home,
                charge_at: self.charge_at,
                asked_to_charge: self.asked_to_charge,
            },
            strain: self.strain.clone(),
            reserve: self.reserve,
            must_charge: self.must_charge,
            job: self.job,
            stops: self.stops.clone(),
            visits: self.visits,
            variables: self.variables,
            shut_down: self.shut_down,
            stands_in_for: self.stands_in_for,
            relieved: self.relieved,
            speakers: self.validator.memory(),
            lists: self.lists.memory(),
            routes: self.routes.memory(),
            hardware: self.hardware.memory(),
            begun: self.begun,
            offers_help: self.offers_help,
            trouble: self.trouble,
            failures: self.failures,
            untold: self.untold,
            is_assigned: self.is_assigned,
            assigned_by: self.assigned_by,
            awaits_master: self.awaits_master,
            lingers: self.lingers,
            loaded: self.loaded,
            said_homeward: self.said_homeward,
            energy: self.energy.clone(),
            lease: self.lease.as_deref().copied(),
            traffic: self.traffic.memory(),
            leg: self.leg,
            zones: self.zones.as_ref().and_then(|zones| zones.save()),
            loops,
        })
    }

    /// Restores a saved state, and gives back that of the loops.
    pub(super) fn restore(&mut self, saved: &Saved) -> Result<SavedLoops, Failure> {
        let Some(memory) = saved.read::<Memory>()? else { return Ok(SavedLoops::default()) };
        self.executed_at = memory.executed_at;
        let TallyMemory { delivered, blocks, waited_ns } = memory.tally;
        self.tally = Tally { delivered, blocks, waited: Duration::from_nanos(waited_ns) };
        (self.block, self.next, self.wanted) = (memory.block, memory.next, memory.wanted);
        self.has_new_charger = memory.given_charger != self.given_charger;
        if !self.has_new_charger {
            self.charge_block = memory.charge_block;
        }
        self.strain = memory.strain;
        self.battery.set_percent(memory.battery.percent);
        (self.charge, self.charging) = (memory.battery.shown, memory.battery.charging);
        (self.lasts, self.way_home) = (memory.battery.lasts, memory.battery.way_home);
        (self.charge_at, self.asked_to_charge) = (memory.battery.charge_at, memory.battery.asked_to_charge);
        (self.reserve, self.must_charge) = (memory.reserve, memory.must_charge);
        (self.job, self.variables, self.shut_down) = (memory.job, memory.variables, memory.shut_down);
        (self.stops, self.visits) = (memory.stops, memory.visits);
        (self.stands_in_for, self.relieved) = (memory.stands_in_for, memory.relieved);
        self.validator.restore(memory.speakers);
        self.lists.restore(memory.lists);
        self.routes.restore(&memory.routes);
        self.hardware.restore(memory.hardware);
        self.note_running();
        (self.begun, self.offers_help) = (memory.begun, memory.offers_help);
        (self.trouble, self.failures) = (memory.trouble, memory.failures);
        (self.untold, self.lingers) = (memory.untold, memory.lingers);
        (self.is_assigned, self.assigned_by) = (memory.is_assigned, memory.assigned_by);
        self.awaits_master = memory.awaits_master;
        (self.loaded, self.said_homeward) = (memory.loaded, memory.said_homeward);
        (self.energy, self.leg, self.lease) = (memory.energy, memory.leg, memory.lease.map(Box::new));
        self.traffic.restore(memory.traffic);
        if let (Some(zones), Some(memory)) = (&mut self.zones, memory.zones) {
            zones.restore(self.number, memory);
        }
        Ok(memory.loops)
    }
}
