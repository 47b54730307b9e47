use saoms_api::{Context, Entries, Extras, Failure, Knowledge, Publisher};

use crate::grid::Block;
use crate::hardware::Action;
use crate::intake::Intake;
use crate::messages::{
    Collision, CriticalKind, CriticalSituation, EventLuggage, LuggageStage, Position, Priority, RobotList,
};

use super::actions::Outcome;
use super::hooks::Hooks;
use super::safe::{Energy, Leg, Traffic};
use super::{Battery, Job, Lists, Routes};

/// What a robot knows: about itself, its job, the others, and the area. Its loops share it.
#[derive(Debug, Knowledge)]
#[knowledge(name = "saoms.Robot")]
pub struct RobotKnowledge {
    /// Its name.
    #[entry]
    pub name: String,
    /// Its number.
    #[entry]
    pub number: u32,
    /// The time from one of its executions to the next, in microseconds.
    #[entry(unit = "us")]
    pub period: u64,
    /// Where it is.
    #[entry]
    pub block: Block,
    /// Where it moves next; the same as `block` while it does not.
    #[entry(effector)]
    pub next: Block,
    /// Where its charger is.
    #[entry]
    pub charge_block: Block,
    /// Its battery.
    pub battery: Battery,
    /// What is left in its battery.
    #[entry(name = "battery", unit = "%")]
    pub(super) charge: f64,
    /// It goes under charge after its job when so much or less is left, also where it would last longer. No loop that ships changes it.
    #[entry(effector, unit = "%")]
    pub charge_at: f64,
    /// What it brings, or would.
    #[entry]
    pub job: Option<Job>,
    /// Its state.
    #[entry(flatten)]
    pub variables: Variables,
    /// Whether it broke and does nothing any more.
    pub shut_down: bool,
    /// The robot for which it has to stand in, where somebody awaked it for that.
    pub stands_in_for: Option<u32>,
    /// Whether it was sent under charge, so that nobody has to stand in for it.
    pub relieved: bool,
    /// What it lets in of what others say.
    pub(super) intake: Intake,
    /// What it heard from others.
    pub lists: Lists,
    /// The area and the ways through it.
    pub routes: Routes,
    /// Its hardware.
    pub(super) hooks: Hooks,
    /// Where it tells of collisions that no world sees.
    pub(super) collisions: Publisher<Collision>,
    /// The hardware's action that was running when this execution started, and what became of it.
    pub(super) polled: Option<(Action, Outcome)>,
    /// Whether it said that it would help another robot.
    pub(super) offers_help: bool,
    /// What is broken.
    pub(super) trouble: Option<Trouble>,
    /// How often the hardware failed one after the other.
    pub(super) failures: u32,
    /// What it delivered, or could not collect, and did not tell yet.
    pub(super) untold: Option<(Job, LuggageStage)>,
    /// Whether it still holds luggage that it gave up, so that it cannot take any other.
    pub(super) is_loaded: bool,
    /// How long its battery lasts.
    pub(super) energy: Energy,
    /// Who is around it.
    pub(super) traffic: Traffic,
    /// Where it goes.
    pub(super) leg: Leg,
    #[extras]
    extras: Extras,
}

impl RobotKnowledge {
    /// What a robot knows that starts at its charger.
    pub fn new(name: String, number: u32, charge_block: Block, battery: Battery) -> RobotKnowledge {
        RobotKnowledge {
            name,
            number,
            period: 0,
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
            intake: Intake::default(),
            lists: Lists::new(number),
            routes: Routes::default(),
            hooks: Hooks::default(),
            collisions: Publisher::default(),
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

    /// Whether it stands at its charger.
    pub fn is_at_charger(&self) -> bool {
        self.block == self.charge_block && self.next == self.charge_block
    }

    /// Where its job leads next: first to where to collect, then to where to deposit.
    pub fn destination(&self) -> Option<Block> {
        let job = self.job.as_ref().filter(|_| self.variables.busy)?;
        Some(if self.variables.has_luggage { job.to } else { job.from })
    }

    /// Takes from the battery what an execution needs.
    pub(super) fn use_battery(&mut self) {
        self.battery.drain();
        self.charge = self.battery.percent();
    }

    /// Gives to the battery what an execution in charge gains.
    pub(super) fn charge_battery(&mut self) {
        self.battery.charge();
        self.charge = self.battery.percent();
    }

    /// Tells what became of luggage. What this robot could not collect waits again for the others.
    pub(super) fn tell(
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

    /// What it says about its position when it wants nothing but what it holds.
    pub fn position(&self) -> Position {
        Position {
            robot: self.number,
            block: self.block,
            next: self.next,
            wanted: self.next,
            priority: Priority { rank: 0, robot: self.number },
        }
    }

    /// What it is doing, in the terms of a critical situation.
    pub fn critical_kind(&self) -> CriticalKind {
        match self.job {
            Some(_) if self.variables.has_luggage => CriticalKind::CarriesLuggage,
            Some(_) => CriticalKind::OnTheWay,
            None => CriticalKind::Idle,
        }
    }

    /// Its request for a healer.
    pub fn situation(&self, kind: CriticalKind) -> CriticalSituation {
        let (luggage, from, to) =
            self.job.map_or((0, self.block, self.block), |job| (job.luggage, job.from, job.to));
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

    /// What it says about itself.
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

/// Why a robot cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// It broke down.
    Breakdown,
    /// Its hardware fails again and again.
    Hardware,
    /// Its battery is empty, with no charger there.
    Battery,
}

/// The state of a robot, in the terms of the manual's table 6.27.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Entries)]
pub struct Variables {
    /// It has a job, or may not take one.
    #[entry]
    pub busy: bool,
    /// It took an interest in luggage.
    #[entry]
    pub transporter: bool,
    /// It carries luggage.
    #[entry]
    pub has_luggage: bool,
    /// It stops for this period.
    #[entry(effector)]
    pub stop_a_period: bool,
    /// It goes to its charger after its present job.
    #[entry]
    pub ready_to_go_under_charge: bool,
    /// It is on the way to its charger.
    #[entry]
    pub reaching_charge: bool,
    /// It is at its charger, in charge.
    #[entry]
    pub in_charge: bool,
    /// It helps another robot, or would.
    #[entry]
    pub healer: bool,
    /// It takes no jobs until it awakes.
    #[entry]
    pub asleep: bool,
    /// It is broken, and shuts down.
    #[entry]
    pub critical: bool,
}
