//! In place of `CollisionMS`, with either policy.

use saoms_api::{Context, Effector, Entry, Failure, Knowledge, Loop, LoopClass, Properties, record};
use saoms_components::grid::Block;
use saoms_components::messages::Position;

use crate::step::{Decision, Step};

/// What a composite can set.
#[derive(Debug, Properties)]
pub struct DistanceProperties {
    /// Distance that the robot keeps from robots with lower numbers.
    #[property(default = 2, range = 1.., unit = "blocks")]
    blocks: u32,
}

/// Waits while a robot with a lower number is near the block that the robot is about to enter, or while any other robot
/// holds or wants that block.
#[derive(Debug, LoopClass)]
#[looping(name = "own.Distance")]
pub struct Distance {
    #[properties]
    properties: DistanceProperties,
    #[senses]
    number: Entry<u32>,
    #[senses]
    next: Entry<Block>,
    #[senses]
    block: Entry<Block>,
    #[senses]
    wanted: Entry<Option<Block>>,
    #[senses]
    positions: Entry<Vec<Position>>,
    #[effects("stopAPeriod")]
    stops: Effector<bool>,
}

impl Loop for Distance {
    type Properties = DistanceProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Step<bool>;
    type Decision = Decision<bool>;

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Step<bool>>, Failure> {
        let (number, at, next) = (self.number.get(robot)?, self.block.get(robot)?, self.next.get(robot)?);
        // With `safe` a robot says what it wants before it goes there, with `classic` where it goes next.
        let ahead = self.wanted.get(robot)?.or(Some(next).filter(|next| *next != at));
        let other = match ahead {
            None => None,
            Some(ahead) => self.positions.get(robot)?.into_iter().find(|other| {
                let holds = [other.block, other.next].contains(&ahead) || other.wanted == ahead;
                holds || (other.robot < number && other.block.distance(ahead) < self.properties.blocks)
            }),
        };
        let stops = self.stops.get(robot)?;
        Ok(match other {
            Some(Position { robot, block, .. }) if !stops => {
                let why = record!(robot_near: "robot {robot} is near, at {block}", robot, block);
                Some(Step::new(why, record!(keeps_distance: "keeps its distance"), true))
            }
            None if stops => {
                Some(Step::new(record!(way_free: "its way is free"), record!(goes_on: "continues"), false))
            }
            _ => None,
        })
    }

    fn plan(
        &mut self,
        step: Step<bool>,
        _: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Decision<bool>>, Failure> {
        Ok(Some(step.decide()))
    }

    fn execute(
        &mut self,
        decision: Decision<bool>,
        robot: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.stops.set(robot, decision.act)
    }
}
