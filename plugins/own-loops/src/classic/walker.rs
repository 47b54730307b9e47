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
#[looping(
    name = "own.classic.Walker",
    senses("number", "block", "chargeBlock", "job", "hasLuggage", "stopAPeriod", "moving", "handling", "critical"),
    effects(
        "drive", "grip", "next", "untold", "busy", "reachingCharge", "readyToGoUnderCharge", "inCharge", "asleep",
        "relieved"
    ),
    publishes(POSITION, EVENT_LUGGAGE, CRITICAL_SITUATION)
)]
pub struct ClassicWalker {
    positions: Publisher<Position>,
    luggage: Publisher<EventLuggage>,
    situations: Publisher<CriticalSituation>,
    number: Entry<u32>,
    block: Entry<Block>,
    charge_block: Entry<Block>,
    job: Entry<Option<Job>>,
    has_luggage: Entry<bool>,
    stops: Entry<bool>,
    moving: Entry<bool>,
    handling: Entry<bool>,
    critical: Entry<bool>,
    drive: Effector<Option<Block>>,
    grip: Effector<bool>,
    next: Effector<Block>,
    untold: Effector<Option<JobEnd>>,
    busy: Effector<bool>,
    reaching: Effector<bool>,
    ready: Effector<bool>,
    in_charge: Effector<bool>,
    asleep: Effector<bool>,
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

    fn new((): ()) -> Result<Self, Failure> {
        Ok(ClassicWalker::default())
    }

    fn initialize(&mut self, robot: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.positions = context.publish(&POSITION)?;
        self.luggage = context.publish(&EVENT_LUGGAGE)?;
        self.situations = context.publish(&CRITICAL_SITUATION)?;
        self.number = robot.entry("number")?;
        self.block = robot.entry("block")?;
        self.charge_block = robot.entry("chargeBlock")?;
        self.job = robot.entry("job")?;
        for (entry, name) in [
            (&mut self.has_luggage, "hasLuggage"),
            (&mut self.stops, "stopAPeriod"),
            (&mut self.moving, "moving"),
            (&mut self.handling, "handling"),
            (&mut self.critical, "critical"),
        ] {
            *entry = robot.entry(name)?;
        }
        self.drive = robot.effector("drive")?;
        self.next = robot.effector("next")?;
        self.untold = robot.effector("untold")?;
        for (effector, name) in [
            (&mut self.grip, "grip"),
            (&mut self.busy, "busy"),
            (&mut self.reaching, "reachingCharge"),
            (&mut self.ready, "readyToGoUnderCharge"),
            (&mut self.in_charge, "inCharge"),
            (&mut self.asleep, "asleep"),
            (&mut self.relieved, "relieved"),
        ] {
            *effector = robot.effector(name)?;
        }
        Ok(())
    }

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
