//! In place of `EventLuggageMS`, with either policy.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, Publisher, record};
use saoms_components::grid::Block;
use saoms_components::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage};
use saoms_components::robot::{Job, WaitingLuggage};

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct ZoneProperties {
    /// First column of the robot's zone.
    #[property(default = 0)]
    from: i32,
    /// Last column.
    #[property(default = 1000)]
    to: i32,
}

/// Takes the luggage that waits in the robot's own zone at once, and leaves all other luggage to the others. No two
/// robots may have one zone.
#[derive(Debug, LoopClass)]
#[looping(
    name = "own.Zone",
    senses(
        "asleep", "inCharge", "critical", "healer", "mustCharge", "readyToGoUnderCharge", "relieved", "offersHelp",
        "handling", "loaded"
    )
)]
pub struct Zone {
    #[properties]
    zone: ZoneProperties,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[senses]
    number: Entry<u32>,
    #[senses]
    block: Entry<Block>,
    #[senses]
    requests: Entry<Vec<WaitingLuggage>>,
    #[senses]
    lasts: Entry<u32>,
    #[senses]
    charge_block: Entry<Block>,
    /// What keeps it from taking a job.
    otherwise: [Entry<bool>; 9],
    #[effects]
    job: Effector<Option<Job>>,
    #[effects]
    busy: Effector<bool>,
    #[effects]
    transporter: Effector<bool>,
}

/// What keeps the robot from taking a job.
const OTHERWISE: [&str; 9] = [
    "asleep", "critical", "healer", "mustCharge", "readyToGoUnderCharge", "relieved", "offersHelp", "handling",
    "loaded",
];

/// Executions that the battery has to last beyond a job.
const SPARE: u32 = 6;

/// What it can do.
#[derive(Debug)]
pub enum Act {
    /// Bring it.
    Take(Job),
    /// Leave it to the others.
    Refuse(Job),
}

impl Loop for Zone {
    type Properties = ZoneProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<Act>;
    type Decision = Decision<Act>;

    fn initialize(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        for (entry, name) in self.otherwise.iter_mut().zip(OTHERWISE) {
            *entry = robot.entry(name)?;
        }
        Ok(())
    }

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<Act>>, Failure> {
        let is_mine = |job: &Job| (self.zone.from..=self.zone.to).contains(&job.from.x);
        let requests = self.requests.get(robot)?;
        if let Some(other) = requests.iter().map(|request| request.job).find(|job| !is_mine(job)) {
            let (luggage, from) = (other.luggage, other.from);
            let why = record!(outside_of_zone: "luggage {luggage} waits at {from}, outside of its zone", luggage, from);
            return Ok(Some(Step::new(why, record!(leaves_it: "leaves it to others"), Act::Refuse(other))));
        }
        let mut is_free = !self.busy.get(robot)? && self.job.get(robot)?.is_none();
        for entry in &self.otherwise {
            is_free &= !entry.get(robot)?;
        }
        let Some(job) = requests.first().map(|request| request.job).filter(|_| is_free) else { return Ok(None) };
        let stops = [self.block.get(robot)?, job.from, job.to, self.charge_block.get(robot)?];
        let moves: u32 = stops.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
        if self.lasts.get(robot)? < moves.saturating_add(SPARE) {
            return Ok(None);
        }
        let (luggage, from) = (job.luggage, job.from);
        let why = record!(in_zone: "luggage {luggage} waits at {from}, in its zone", luggage, from);
        let takes = record!(takes_at_once: "takes luggage {luggage}", luggage);
        Ok(Some(Step::new(why, takes, Act::Take(job))))
    }

    fn plan(
        &mut self,
        step: Step<Act>,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Decision<Act>>, Failure> {
        Ok(Some(step.decide()))
    }

    fn execute(
        &mut self,
        decision: Decision<Act>,
        robot: &mut dyn Knowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let (number, block) = (self.number.get(robot)?, self.block.get(robot)?);
        match decision.act {
            Act::Take(job) => {
                self.job.set(robot, Some(job))?;
                self.busy.set(robot, true)?;
                self.transporter.set(robot, true)?;
                context.send(&self.luggage, job.response(number, block, LuggageStage::Taken))
            }
            Act::Refuse(job) => context.send(&self.luggage, job.response(number, block, LuggageStage::Refused)),
        }
    }
}
