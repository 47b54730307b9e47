//! In place of `PathFollowerMS`.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Publisher, record};
use saoms_components::grid::Block;
use saoms_components::messages::{IMMOVABLE, POSITION, Position, Priority};
use saoms_components::robot::Job;

use crate::step::{Decision, Step};

/// Drives along y first and then along x, in an area without walls, and makes way for nobody.
///
/// As every robot with the policy `safe` it says which block it wants, and enters it in a later execution, if
/// `CollisionMS` does not stop it.
#[derive(Debug, Default, LoopClass)]
#[looping(name = "own.Straight", senses("inCharge", "positions"), effects("next"))]
pub struct Straight {
    said: Option<Position>,
    #[publishes(POSITION)]
    announced: Publisher<Position>,
    #[senses]
    number: Entry<u32>,
    #[senses]
    block: Entry<Block>,
    #[senses]
    next: Entry<Block>,
    #[senses]
    job: Entry<Option<Job>>,
    #[senses]
    busy: Entry<bool>,
    #[senses]
    has_luggage: Entry<bool>,
    #[senses]
    must_charge: Entry<bool>,
    #[senses]
    relieved: Entry<bool>,
    #[senses]
    transporter: Entry<bool>,
    #[senses]
    offers_help: Entry<bool>,
    #[senses]
    charge_block: Entry<Block>,
    #[senses("stopAPeriod")]
    stops: Entry<bool>,
    #[senses]
    critical: Entry<bool>,
    #[senses]
    moving: Entry<bool>,
    #[senses]
    handling: Entry<bool>,
    #[effects]
    drive: Effector<Option<Block>>,
    #[effects]
    wanted: Effector<Option<Block>>,
    #[effects("readyToGoUnderCharge")]
    ready: Effector<bool>,
    #[effects("reachingCharge")]
    reaching: Effector<bool>,
}

/// The next move.
#[derive(Debug)]
pub struct Act {
    drive: Option<Block>,
    position: Position,
    homeward: (bool, bool),
}

impl Straight {
    /// Where the robot goes; nowhere while it waits for the answers of others.
    fn goal(&self, robot: &dyn Knowledge) -> Result<Option<Block>, Failure> {
        let charger = self.charge_block.get(robot)?;
        if self.must_charge.get(robot)? {
            return Ok(Some(charger));
        }
        if let Some(job) = self.job.get(robot)?
            && self.busy.get(robot)?
        {
            return Ok(Some(if self.has_luggage.get(robot)? { job.to } else { job.from }));
        }
        let waits = self.transporter.get(robot)? || self.offers_help.get(robot)?;
        Ok((!waits).then_some(charger))
    }

    fn next_act(&self, robot: &dyn Knowledge) -> Result<Act, Failure> {
        let (block, next, charger) = (self.block.get(robot)?, self.next.get(robot)?, self.charge_block.get(robot)?);
        let goal = self.goal(robot)?;
        let is_bound = self.handling.get(robot)? || self.critical.get(robot)?;
        let can_go = !is_bound && !self.moving.get(robot)? && !self.stops.get(robot)?;
        let wanted = self.wanted.get(robot)?.filter(|wanted| *wanted != block);
        let drive = wanted.filter(|_| can_go && goal.is_some_and(|goal| goal != block));
        let at = drive.unwrap_or(next);
        let wanted = goal.filter(|_| !is_bound).map_or(at, |goal| at.step_y_first(goal));
        let (robot_number, wants) = (self.number.get(robot)?, wanted != at);
        let priority = if wants { Priority { rank: 1, robot: robot_number } } else { IMMOVABLE };
        let position = Position { robot: robot_number, block, next: at, wanted, priority };
        let homeward = self.must_charge.get(robot)? || self.relieved.get(robot)?;
        let reaching = homeward && goal == Some(charger) && at != charger;
        Ok(Act { drive, position, homeward: (homeward, reaching) })
    }
}

impl Loop for Straight {
    type Properties = ();
    type Knowledge = dyn Knowledge;
    type Symptom = Step<Act>;
    type Decision = Decision<Act>;

    fn initialize(&mut self, robot: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.goes_on() {
            // After a failure they know more than this loop yet does.
            return Ok(());
        }
        // The others have to know which blocks are held before the first robot moves.
        let position = self.next_act(robot)?.position;
        let position = Position { wanted: position.block, ..position };
        self.said = Some(position.clone());
        context.send(&self.announced, position)
    }

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<Act>>, Failure> {
        let act = self.next_act(robot)?;
        let flags = (self.ready.get(robot)?, self.reaching.get(robot)?);
        if act.drive.is_none() && self.said.as_ref() == Some(&act.position) && flags == act.homeward {
            return Ok(None);
        }
        let (block, wanted) = (act.position.block, act.position.wanted);
        let what = match act.drive {
            Some(to) => record!(moves_to: "moves to {to}", to),
            None => record!(announces_wanted_block: "announces that it wants {wanted}", wanted),
        };
        Ok(Some(Step::new(record!(is_at: "is at {block}", block), what, act)))
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
        let Act { drive, position, homeward } = decision.act;
        self.drive.set(robot, drive)?;
        self.wanted.set(robot, Some(position.wanted))?;
        self.ready.set(robot, homeward.0)?;
        self.reaching.set(robot, homeward.1)?;
        if self.said.as_ref() == Some(&position) {
            return Ok(());
        }
        self.said = Some(position.clone());
        context.send(&self.announced, position)
    }

    fn shutdown(&mut self, robot: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let (robot, block) = (self.number.get(robot)?, self.block.get(robot)?);
        let last = Position { robot, block, next: block, wanted: block, priority: IMMOVABLE };
        context.send(&self.announced, last)
    }
}
