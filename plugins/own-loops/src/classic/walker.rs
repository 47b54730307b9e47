//! In place of `PathFollowerMS`.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Publisher, Record, record};
use saoms_components::grid::Block;
use saoms_components::messages::CriticalKind;
use saoms_components::messages::{
    CRITICAL_SITUATION, CriticalSituation, EVENT_LUGGAGE, EventLuggage, POSITION, Position, Priority,
};
use saoms_components::robot::{Job, JobEnd};

use crate::gripper::tell;
use crate::step::{Decision, Step};

/// Drives along y first, uses the gripper at the ends of a job, and charges: as the manual's robots, which announce a
/// block in one execution and enter it in the next one.
#[derive(Debug, Default, LoopClass)]
#[looping(name = "own.classic.Walker")]
pub struct ClassicWalker {
    #[publishes(POSITION)]
    positions: Publisher<Position>,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[publishes(CRITICAL_SITUATION)]
    situations: Publisher<CriticalSituation>,
    #[senses]
    number: Entry<u32>,
    #[senses]
    block: Entry<Block>,
    #[senses]
    charge_block: Entry<Block>,
    #[senses]
    job: Entry<Option<Job>>,
    #[senses]
    has_luggage: Entry<bool>,
    #[senses("stopAPeriod")]
    stops: Entry<bool>,
    #[senses]
    moving: Entry<bool>,
    #[senses]
    handling: Entry<bool>,
    #[senses]
    critical: Entry<bool>,
    #[effects]
    drive: Effector<Option<Block>>,
    #[effects]
    grip: Effector<bool>,
    #[effects]
    next: Effector<Block>,
    #[effects]
    untold: Effector<Option<JobEnd>>,
    #[effects]
    busy: Effector<bool>,
    #[effects("reachingCharge")]
    reaching: Effector<bool>,
    #[effects("readyToGoUnderCharge")]
    ready: Effector<bool>,
    #[effects]
    in_charge: Effector<bool>,
    #[effects]
    asleep: Effector<bool>,
    #[effects]
    relieved: Effector<bool>,
}

/// What it can do.
#[derive(Debug)]
pub enum Act {
    /// Tell the others how a job ended.
    Tell(JobEnd),
    /// Collect or deposit.
    Grip,
    /// Enter the block that was announced.
    Enter(Block),
    /// Announce the next block on the way.
    Announce(Block),
    /// Charge: it is at its charger.
    Charge,
}

impl ClassicWalker {
    /// Where the robot goes, and whether that is its charger.
    fn goal(&self, robot: &dyn Knowledge) -> Result<Option<(Block, bool)>, Failure> {
        if let Some(job) = self.job.get(robot)?
            && self.busy.get(robot)?
        {
            return Ok(Some((if self.has_luggage.get(robot)? { job.to } else { job.from }, false)));
        }
        let charger = self.charge_block.get(robot)?;
        Ok(self.ready.get(robot)?.then_some((charger, true)))
    }

    /// Its message about a block that it enters next.
    fn position(&self, robot: &dyn Knowledge, next: Block) -> Result<Position, Failure> {
        let (robot, block) = (self.number.get(robot)?, self.block.get(robot)?);
        Ok(Position { robot, block, next, wanted: next, priority: Priority { rank: 0, robot } })
    }
}

impl Loop for ClassicWalker {
    type Properties = ();
    type Knowledge = dyn Knowledge;
    type Symptom = Step<Act>;
    type Decision = Decision<Act>;

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<Act>>, Failure> {
        let (block, next) = (self.block.get(robot)?, self.next.get(robot)?);
        let step = |what: Record, act| Step::new(record!(is_at: "is at {block}", block), what, act);
        if let Some(end) = self.untold.get(robot)? {
            return Ok(Some(step(record!(tells_own_end_of_job: "tells that its job is over"), Act::Tell(end))));
        }
        let works = self.moving.get(robot)? || self.handling.get(robot)?;
        if works || self.critical.get(robot)? || self.stops.get(robot)? {
            return Ok(None);
        }
        if next != block {
            return Ok(Some(step(record!(moves_to: "moves to {to}", to = next), Act::Enter(next))));
        }
        Ok(self.goal(robot)?.map(|(goal, is_charger)| match (goal == block, is_charger) {
            (true, true) => step(record!(charges: "charges"), Act::Charge),
            (true, false) => step(record!(uses_gripper: "uses its gripper"), Act::Grip),
            (false, _) => {
                let next = block.step_y_first(goal);
                step(record!(announces_next_block: "announces that it goes to {next}", next), Act::Announce(next))
            }
        }))
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
            Act::Tell(end) => {
                self.untold.set(robot, None)?;
                tell(end, (number, block), self.luggage, context)
            }
            Act::Grip => self.grip.set(robot, true),
            Act::Enter(next) => {
                self.drive.set(robot, Some(next))?;
                let position = self.position(robot, next)?;
                context.send(&self.positions, position)
            }
            Act::Announce(next) => {
                self.next.set(robot, next)?;
                let homeward = self.goal(robot)?.is_some_and(|(_, is_charger)| is_charger);
                self.reaching.set(robot, homeward)?;
                let position = self.position(robot, next)?;
                context.send(&self.positions, position)
            }
            Act::Charge => {
                self.reaching.set(robot, false)?;
                self.ready.set(robot, false)?;
                for effector in [&self.in_charge, &self.asleep, &self.busy] {
                    effector.set(robot, true)?;
                }
                if self.relieved.get(robot)? {
                    return self.relieved.set(robot, false);
                }
                let situation = CriticalSituation {
                    critical: number,
                    block,
                    from: block,
                    to: block,
                    kind: CriticalKind::Idle,
                    ..CriticalSituation::default()
                };
                context.send(&self.situations, situation)
            }
        }
    }
}
