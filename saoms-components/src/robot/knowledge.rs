use std::time::Duration;

use saoms_api::{Cause, Context, Entries, Extras, Failure, Knowledge, Publisher, Time};

use crate::grid::Block;
use crate::hardware::Action;
use crate::messages::{
    Collision, CriticalKind, CriticalSituation, EventLuggage, LuggageStage, Position, Priority, RobotList,
};
use crate::validation::MessageValidator;

use super::actions::Outcome;
use super::hardware_client::HardwareClient;
use super::safe::{Energy, Leg, Traffic};
use super::tally::Tally;
use super::{Battery, Job, Lists, Routes};

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
    /// Time of the present execution.
    executed_at: Option<Time>,
    /// Time from the last execution to the present one.
    elapsed: Duration,
    /// What it did so far, for the report.
    pub(super) tally: Tally,
    /// Position of the robot.
    #[entry]
    pub block: Block,
    /// Block that the robot moves to next; the same as `block` if it does not move.
    #[entry(effector)]
    pub next: Block,
    /// Block of its charger.
    #[entry]
    pub charge_block: Block,
    /// Battery of the robot.
    pub battery: Battery,
    /// Battery level of the robot.
    #[entry(name = "battery", unit = "%")]
    pub(super) charge: f64,
    /// Battery level at which the robot charges after its job, even if the battery would last longer. No loop that
    /// ships changes it.
    #[entry(effector, unit = "%")]
    pub charge_at: f64,
    /// Luggage that the robot brings, or is interested in.
    #[entry]
    pub job: Option<Job>,
    /// State of the robot.
    #[entry(flatten)]
    pub variables: Variables,
    /// True if the robot broke and does nothing any more.
    pub shut_down: bool,
    /// Robot that it substitutes, if it was woken for that.
    pub stands_in_for: Option<u32>,
    /// True if it was sent to charge, so that it needs no substitute.
    pub relieved: bool,
    /// Validator of messages from other robots.
    pub(super) validator: MessageValidator,
    /// State of other robots, as they reported it.
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
    /// True if it offered to help another robot.
    pub(super) offers_help: bool,
    /// Reason why the robot cannot continue.
    pub(super) trouble: Option<Trouble>,
    /// Number of consecutive failures of the hardware.
    pub(super) failures: u32,
    /// Luggage that it delivered, or could not collect, and has not reported yet.
    pub(super) untold: Option<(Job, LuggageStage)>,
    /// True if it still holds luggage that it gave up, so that it cannot take any other.
    pub(super) is_loaded: bool,
    /// State of the energy management.
    pub(super) energy: Energy,
    /// The robots around it.
    pub(super) traffic: Traffic,
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
            executed_at: None,
            elapsed: Duration::ZERO,
            tally: Tally::default(),
            block: charge_block,
            next: charge_block,
            charge_block,
            charge: battery.percent(),
            battery,
            charge_at: 0.0,
            job: None,
            variables: Variables::default(),
            shut_down: false,
            stands_in_for: None,
            relieved: false,
            validator: MessageValidator::default(),
            lists: Lists::new(number),
            routes: Routes::default(),
            hardware: HardwareClient::default(),
            collisions: Publisher::default(),
            begun: Cause::default(),
            polled: None,
            offers_help: false,
            trouble: None,
            failures: 0,
            untold: None,
            is_loaded: false,
            energy: Energy::default(),
            traffic: Traffic::default(),
            leg: Leg::default(),
            extras: Extras::default(),
        }
    }

    /// True if it is at its charger.
    pub fn is_at_charger(&self) -> bool {
        self.block == self.charge_block && self.next == self.charge_block
    }

    /// What it waits for, if it takes no work by itself: nothing waits for it that it knows of. It may still charge.
    pub(super) fn waits_for(&self) -> Option<String> {
        if self.shut_down {
            return Some("assistance".to_owned());
        }
        if self.hardware.is_absent() {
            return Some("its world, which is not started".to_owned());
        }
        let Variables { transporter, healer, critical, .. } = self.variables;
        let has_work = self.job.is_some() || self.untold.is_some() || transporter || healer || critical;
        let knows_work = !self.lists.requests.open().is_empty() || !self.lists.helps.open().is_empty();
        let is_idle = self.hardware.has_entered() && self.block == self.next && self.trouble.is_none();
        (is_idle && !has_work && !knows_work && !self.offers_help).then(|| "luggage".to_owned())
    }

    /// Next destination of its job: the block where it collects, then the block where it deposits.
    pub fn destination(&self) -> Option<Block> {
        let job = self.job.as_ref().filter(|_| self.variables.busy)?;
        Some(if self.variables.has_luggage { job.to } else { job.from })
    }

    /// Notes the time of this execution.
    pub(super) fn note_time(&mut self, now: Time) {
        self.elapsed = self.executed_at.map_or(Duration::ZERO, |last| now.since(last));
        self.executed_at = Some(now);
    }

    /// Time from the last execution to the present one.
    pub(super) fn elapsed(&self) -> Duration {
        self.elapsed
    }

    /// Discharges the battery by the time since the last execution.
    pub(super) fn use_battery(&mut self) {
        self.battery.drain(self.elapsed);
        self.charge = self.battery.percent();
    }

    /// Discharges the battery by a move to the next block.
    pub(super) fn use_battery_to_drive(&mut self) {
        self.battery.drive();
        self.charge = self.battery.percent();
    }

    /// Charges the battery by the time since the last execution.
    pub(super) fn charge_battery(&mut self) {
        self.battery.charge(self.elapsed);
        self.charge = self.battery.percent();
    }

    /// Reports the outcome of a job. Luggage that this robot could not collect waits again for the others.
    pub(super) fn report_outcome(
        &mut self,
        luggage: Publisher<EventLuggage>,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let Some((job, stage)) = self.untold.take() else { return Ok(()) };
        context.send(&luggage, job.response(self.number, self.block, stage))?;
        if stage == LuggageStage::Refused {
            self.lists.requests.refuse(job.luggage);
            context.send(&luggage, EventLuggage::request(job.luggage, job.from, job.to))?;
        }
        Ok(())
    }

    /// Its position message if it wants no block beyond those that it holds.
    pub fn position(&self) -> Position {
        Position {
            robot: self.number,
            block: self.block,
            next: self.next,
            wanted: self.next,
            priority: Priority { rank: 0, robot: self.number },
        }
    }

    /// Kind of its critical situation.
    pub fn critical_kind(&self) -> CriticalKind {
        match self.job {
            Some(_) if self.variables.has_luggage => CriticalKind::CarriesLuggage,
            Some(_) => CriticalKind::OnTheWay,
            None => CriticalKind::Idle,
        }
    }

    /// Its request for a healer.
    pub fn situation(&self, kind: CriticalKind) -> CriticalSituation {
        let (luggage, from, to) = self.job.map_or((0, self.block, self.block), |job| (job.luggage, job.from, job.to));
        CriticalSituation {
            critical: self.number,
            block: self.block,
            luggage,
            from,
            to,
            kind,
            ..CriticalSituation::default()
        }
    }

    /// Its state message.
    pub fn robot(&self, active: bool) -> RobotList {
        RobotList {
            robot: self.number,
            active,
            battery: self.battery.percent(),
            in_charge: self.variables.in_charge,
            asleep: self.variables.asleep,
            charger: self.charge_block,
            period: self.period,
        }
    }
}

/// Reasons why a robot cannot continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// The robot broke down.
    Breakdown,
    /// The hardware fails repeatedly.
    Hardware,
    /// The battery is empty, away from a charger.
    Battery,
}

/// State of a robot, in the terms of the manual's table 6.27.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Entries)]
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
