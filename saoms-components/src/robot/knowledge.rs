use std::time::Duration;

use saoms_api::{Cause, Entries, Extras, Field, Knowledge, Publisher, Time};

use crate::grid::Block;
use crate::hardware::Action;
use crate::messages::{Collision, Lease, LuggageStage};
use crate::precedence::Conflict;
use crate::validation::MessageValidator;

use super::actions::Outcome;
use super::hardware_client::HardwareClient;
use super::job::lease::Leased;
use super::safe::{Energy, Leg, RESERVE, Traffic};
use super::strain::Strain;
use super::tally::Tally;
use super::zone_client::ZoneClient;
use super::{Battery, Job, Lists, Policy, Routes};

/// Knowledge of a robot about itself, its job, the other robots, and the area. Its loops share it.
#[derive(Debug, Knowledge)]
#[knowledge(name = "saoms.Robot")]
pub struct RobotKnowledge {
    /// Name of the robot.
    #[entry]
    pub name: String,
    /// Number of the robot.
    #[entry]
    pub number: u32,
    /// Period of the robot, in microseconds.
    #[entry(unit = "us")]
    pub period: u64,
    /// Rules by which it acts.
    pub(super) policy: Policy,
    /// Time of the present execution.
    pub(super) executed_at: Option<Time>,
    /// Time from the last execution to the present one.
    pub(super) elapsed: Duration,
    /// What it did so far, for the report.
    pub(super) tally: Tally,
    /// The robot for which it waits, and which of both goes first.
    pub(super) conflict: Option<Conflict>,
    /// Position of the robot.
    #[entry]
    pub block: Block,
    /// Block that the robot moves to next; the same as `block` if it does not move.
    #[entry(effector)]
    pub next: Block,
    /// Block that it wants to enter next; no block if it wants to stay.
    #[entry(effector, quiet)]
    pub wanted: Option<Block>,
    /// What its hardware is to do at the end of the execution.
    #[entry(flatten)]
    pub orders: Orders,
    /// Block of its charger.
    #[entry]
    pub charge_block: Block,
    /// Block of the charger that its properties give it.
    pub(super) given_charger: Block,
    /// True if they give it another one than its predecessor had: what is known of that is over.
    pub(super) has_new_charger: bool,
    /// Battery of the robot.
    pub battery: Battery,
    /// Battery level of the robot. It counts by itself; a loop that measures the battery sets it.
    #[entry(name = "battery", unit = "%")]
    pub(super) charge: f64,
    /// Faults that scenarios put into the battery and its chargers.
    pub(super) strain: Strain,
    /// Battery level when this execution began.
    pub(super) level_before: f64,
    /// True if the battery was not full, and gains in this execution.
    #[entry(quiet)]
    pub(super) charging: bool,
    /// Number of executions that the battery lasts while the robot drives.
    #[entry(quiet, unit = "executions")]
    pub(super) lasts: u32,
    /// Number of executions that the way to the charger takes. With `classic`, which knows no walls, the distance.
    #[entry(quiet, unit = "executions")]
    pub(super) way_home: u32,
    /// Battery level at which the robot charges after its job, even if the battery would last longer. No loop that
    /// ships changes it.
    #[entry(effector, unit = "%")]
    pub charge_at: f64,
    /// True if a loop set `readyToGoUnderCharge`: the robot then goes to its charger once it has no job. With `safe`,
    /// that entry is otherwise only a display.
    #[entry(quiet)]
    pub(super) asked_to_charge: bool,
    /// Number of executions that the battery has to last beyond the way to the charger.
    #[entry(quiet, unit = "executions")]
    pub reserve: u32,
    /// True if the robot has to go to its charger now, in spite of its job, or to stay there.
    #[entry(effector, quiet)]
    pub must_charge: bool,
    /// Luggage that the robot brings, or is interested in.
    #[entry]
    pub job: Option<Job>,
    /// Blocks that it still visits for its job, in this order; none if the job is luggage.
    #[entry(quiet)]
    pub stops: Vec<Block>,
    /// True if its job, or the last one, is to visit blocks.
    pub(super) visits: bool,
    /// State of the robot.
    #[entry(flatten)]
    pub variables: Variables,
    /// True if an operator stopped it: it gives no orders to its hardware until it is released.
    #[entry(quiet)]
    pub(super) stopped: bool,
    /// True if it is to leave the fleet: it sleeps once it has finished, and does not wake.
    pub(super) leaving: bool,
    /// True if the robot broke and does nothing any more.
    pub shut_down: bool,
    /// Robot that it substitutes, if it was woken for that.
    #[entry(quiet)]
    pub stands_in_for: Option<u32>,
    /// True if it was sent to charge, so that it needs no substitute.
    #[entry(quiet)]
    pub relieved: bool,
    /// True if it has to announce itself again: the others may take it for a robot that has failed.
    pub(super) says_again: bool,
    /// True if somebody took it off the floor.
    pub(super) gone: bool,
    /// Time of its first execution: a robot that was said to be gone before that is back.
    pub(super) began: Option<Time>,
    /// Validator of messages from other robots.
    pub(super) validator: MessageValidator,
    /// State of other robots, as they reported it.
    #[entry(flatten)]
    pub lists: Lists,
    /// The area and the ways through it.
    pub routes: Routes,
    /// Client of its hardware.
    pub(super) hardware: HardwareClient,
    /// Publisher of collisions, for fleets without a world.
    pub(super) collisions: Publisher<Collision>,
    /// Cause of the hardware's newest action: the decision of the loop that began it.
    pub(super) begun: Cause,
    /// The hardware's action that was running when this execution started, and its outcome.
    pub(super) polled: Option<(Action, Outcome)>,
    /// True if its wheels are moving it to `next`.
    #[entry(quiet)]
    pub(super) moving: bool,
    /// True if its gripper is working.
    #[entry(quiet)]
    pub(super) handling: bool,
    /// What its loops ask the hardware about themselves; the robot asks about the rest.
    pub(super) polling: Polling,
    /// True if it offered to help another robot.
    #[entry(quiet)]
    pub offers_help: bool,
    /// Reason why the robot cannot continue.
    #[entry(quiet)]
    pub trouble: Option<Trouble>,
    /// Number of consecutive failures of the hardware.
    pub(super) failures: u32,
    /// Luggage that it delivered, or could not collect, and has not reported yet.
    #[entry]
    pub untold: Option<JobEnd>,
    /// True if a master assigned the job.
    pub(super) is_assigned: bool,
    /// Number of executions for which it waits at the last block of a visit that it took by itself, until a master
    /// agrees that no other robot does it.
    pub(super) awaits_master: u32,
    /// Number of the component of the master that assigned it.
    pub(super) assigned_by: u32,
    /// Number of executions for which it waits for the next assignment before it goes home.
    pub(super) lingers: u32,
    /// True if it still holds luggage that it gave up, so that it cannot take any other.
    #[entry(quiet)]
    pub loaded: bool,
    /// True if `readyToGoUnderCharge` is set for a reason of the robot's own.
    pub(super) said_homeward: bool,
    /// State of the energy management.
    pub(super) energy: Energy,
    /// The luggage of its job, if it has that on a lease; and where it says so.
    pub(super) lease: Option<Box<Leased>>,
    pub(super) leases: Publisher<Lease>,
    /// The robots around it.
    pub(super) traffic: Traffic,
    /// Its passage through zones, where its site has zones.
    pub(super) zones: Option<Box<ZoneClient>>,
    /// The way to its current goal.
    pub(super) leg: Leg,
    #[extras]
    extras: Extras,
}

impl RobotKnowledge {
    /// Initial knowledge of a robot at its charger.
    pub fn new(name: String, number: u32, charge_block: Block, battery: Battery) -> RobotKnowledge {
        RobotKnowledge {
            name,
            number,
            period: 0,
            policy: Policy::Safe,
            executed_at: None,
            elapsed: Duration::ZERO,
            tally: Tally::default(),
            conflict: None,
            block: charge_block,
            next: charge_block,
            wanted: None,
            orders: Orders::default(),
            charge_block,
            given_charger: charge_block,
            has_new_charger: false,
            charge: battery.percent(),
            level_before: battery.percent(),
            battery,
            strain: Strain::default(),
            charging: false,
            lasts: 0,
            way_home: 0,
            charge_at: 0.0,
            asked_to_charge: false,
            reserve: RESERVE,
            must_charge: false,
            job: None,
            stops: Vec::new(),
            visits: false,
            variables: Variables::default(),
            stopped: false,
            leaving: false,
            shut_down: false,
            stands_in_for: None,
            relieved: false,
            says_again: false,
            gone: false,
            began: None,
            validator: MessageValidator::default(),
            lists: Lists::new(number),
            routes: Routes::default(),
            hardware: HardwareClient::default(),
            collisions: Publisher::default(),
            begun: Cause::default(),
            polled: None,
            moving: false,
            handling: false,
            polling: Polling::default(),
            offers_help: false,
            trouble: None,
            failures: 0,
            untold: None,
            is_assigned: false,
            awaits_master: 0,
            assigned_by: 0,
            lingers: 0,
            loaded: false,
            said_homeward: false,
            energy: Energy::default(),
            lease: None,
            leases: Publisher::default(),
            traffic: Traffic::default(),
            zones: None,
            leg: Leg::default(),
            extras: Extras::default(),
        }
    }

    /// Notes for which robot it waits in this execution. It waits since it began to wait for that one.
    pub(super) fn note_conflict(&mut self, conflict: Option<Conflict>) {
        let before = self.conflict.filter(|before| conflict.is_some_and(|now| now.waits_for == before.waits_for));
        let since = before.map(|before| before.since);
        self.conflict = conflict.map(|now| Conflict { since: since.unwrap_or(now.since), ..now });
    }

    /// True if it is at its charger.
    pub fn is_at_charger(&self) -> bool {
        self.block == self.charge_block && self.next == self.charge_block
    }

    /// True if it has finished what it had begun, and is where it can be left: it sleeps at its charger, is broken, or
    /// is not on the floor.
    pub(super) fn has_finished(&self) -> bool {
        if self.shut_down || self.gone || !self.hardware.has_entered() {
            return true;
        }
        let has_work = self.job.is_some() || self.untold.is_some() || self.variables.has_luggage || self.offers_help;
        self.variables.asleep && self.is_at_charger() && !has_work && self.hardware.running().is_none()
    }

    /// What it waits for, if it takes no work by itself: nothing waits for it that it knows of. It may still charge.
    pub(super) fn waits_for(&self) -> Option<String> {
        if self.shut_down {
            return Some("assistance".to_owned());
        }
        if self.waits_to_enter() {
            return Some(format!("a grant to enter the floor at {}", self.block));
        }
        if self.stopped {
            return Some("its release after a stop".to_owned());
        }
        if self.hardware.is_absent() {
            return Some("its world, which does not run".to_owned());
        }
        let Variables { transporter, healer, critical, .. } = self.variables;
        let has_work = self.job.is_some() || self.untold.is_some() || transporter || healer || critical;
        let knows_work = !self.lists.requests.open().is_empty() || !self.lists.helps.open().is_empty();
        // A charger that gives nothing may give something later.
        let is_idle =
            self.hardware.has_entered() && self.block == self.next && self.trouble.is_none() && !self.must_charge;
        (is_idle && !has_work && !knows_work && !self.offers_help).then(|| "luggage".to_owned())
    }

    /// Next destination of its job: the block where it collects, then the block where it deposits; or the next block
    /// that it visits.
    pub fn destination(&self) -> Option<Block> {
        let job = self.job.as_ref().filter(|_| self.variables.busy)?;
        if let Some(stop) = self.stops.first() {
            return Some(*stop);
        }
        Some(if self.variables.has_luggage { job.to } else { job.from })
    }
}

/// Orders to the hardware. The robot carries them out at the end of the execution in which a loop gives them: an order
/// that came to nothing has to be given again. The loops that ship call the hardware in the middle of the execution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Entries)]
pub struct Orders {
    /// Order to the wheels: the adjacent block to enter.
    #[entry(effector, quiet)]
    pub drive: Option<Block>,
    /// Order to the gripper: to collect the luggage of the job, or to deposit it if the robot carries it.
    #[entry(effector, quiet)]
    pub grip: bool,
}

/// What loops ask the hardware about.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Polling {
    /// Moves.
    pub(super) moves: bool,
    /// Collecting and depositing.
    pub(super) handling: bool,
}

/// The end of a job, for the other robots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct JobEnd {
    /// The job.
    pub job: Job,
    /// `Delivered`, or `Refused` if it could not be collected.
    pub stage: LuggageStage,
}

/// Reasons why a robot cannot continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub enum Trouble {
    /// The robot broke down.
    Breakdown,
    /// The hardware fails repeatedly.
    Hardware,
    /// The battery is empty, away from a charger.
    Battery,
}

/// State of a robot, in the terms of the manual's table 6.27.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Entries, Field)]
pub struct Variables {
    /// True if the robot has a job, or may not take one.
    #[entry]
    pub busy: bool,
    /// True if it took an interest in luggage.
    #[entry]
    pub transporter: bool,
    /// True if it carries luggage.
    #[entry]
    pub has_luggage: bool,
    /// True if it stops for this period.
    #[entry(effector)]
    pub stop_a_period: bool,
    /// True if it goes to its charger after its current job.
    #[entry]
    pub ready_to_go_under_charge: bool,
    /// True if it is on the way to its charger.
    #[entry]
    pub reaching_charge: bool,
    /// True if it is at its charger and charges.
    #[entry]
    pub in_charge: bool,
    /// True if it helps another robot, or offered that.
    #[entry]
    pub healer: bool,
    /// True if it takes no jobs until it is woken.
    #[entry]
    pub asleep: bool,
    /// True if it is broken and shuts down.
    #[entry]
    pub critical: bool,
}
