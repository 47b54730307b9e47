//! The wheels of a robot: hardware that takes several periods for a move, and can fail.
//!
//! A robot calls the [`Hardware`] at its reference `world`, and never waits: `begin` starts an action, `poll` returns
//! its progress in each period, `cancel` stops it. [`Drive`] is such hardware. It counts periods where a real one would
//! turn motors. It forwards to the world what only the world can decide: entering the next block, and handling luggage.

mod motor;

use saoms_api::{Chance, Class, Component, Context, Failure, Properties, warn};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, ActionKind, Area, Hardware, HardwareReference, Progress};

use motor::{Motor, Turn};

/// Properties of a drive.
#[derive(Debug, Properties)]
pub struct DriveProperties {
    /// Number of the robot's periods that a move takes.
    #[property(default = 3, range = 1..=1000, unit = "periods")]
    move_periods: u32,
    /// Probability that a move jams, so that the robot has to try again.
    #[property(default = 0.0, range = 0.0..=1.0, unit = "jams per move")]
    jams: f64,
    /// Numbers of the moves that always jam, counted from 1.
    jams_at: Vec<u32>,
    /// Number of moves after which it is worn out, so that every further move fails; by default never.
    wears_out_after: Option<u32>,
}

/// The wheels of one robot.
#[derive(Debug, Class)]
#[class(
    name = "drive.Drive",
    passive,
    service("hardware": Hardware)
)]
pub struct Drive {
    #[properties]
    properties: DriveProperties,
    /// The world. Without one, the drive has an area of 11 x 11 blocks for itself.
    #[reference]
    world: Option<HardwareReference>,
    robot: Option<u32>,
    block: Block,
    motor: Motor,
    /// The robot's action that the world is running.
    in_world: Option<Action>,
    /// Move for which the wheels have turned, and which the world has not begun yet.
    at_edge: Option<Action>,
}

impl Component for Drive {
    type Properties = DriveProperties;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.count("drive.jams", 0);
        Ok(())
    }
}

impl DriveProperties {
    /// True if the move with this number jams.
    fn jams(&self, number: u32, chance: &mut Chance) -> bool {
        let by_chance = chance.unit() < self.jams;
        by_chance || self.jams_at.contains(&number) || self.wears_out_after.is_some_and(|last| number > last)
    }
}

impl Drive {
    /// Starts the action in the world.
    fn begin_in_world(&mut self, context: &mut Context<'_>, robot: u32, action: Action) -> Result<Progress, Failure> {
        let progress = match self.world {
            Some(world) => world.begin(context, robot, action)?,
            None => Progress::Done,
        };
        self.in_world = (progress == Progress::Running).then_some(action);
        if progress == Progress::Done {
            self.arrive(action);
        }
        Ok(progress)
    }

    fn arrive(&mut self, action: Action) {
        if action.kind == ActionKind::Move {
            self.block = action.block;
        }
    }

    /// Stops the motor and the action in the world.
    fn stop(&mut self, context: &mut Context<'_>, robot: u32) -> Result<(), Failure> {
        self.motor.stop();
        self.at_edge = None;
        if let (Some(_), Some(world)) = (self.in_world, self.world) {
            world.cancel(context, robot)?;
            self.in_world = None;
        }
        Ok(())
    }
}

impl Hardware for Drive {
    fn enter(&mut self, context: &mut Context<'_>, robot: u32, name: String, block: Block) -> Result<Block, Failure> {
        if let Some(other) = self.robot.filter(|other| *other != robot) {
            return Err(Failure::new(format!("these are the wheels of robot {other}: give robot {robot} its own")));
        }
        self.block = match self.world {
            Some(world) => world.enter(context, robot, name, block)?,
            None => block,
        };
        self.robot = Some(robot);
        Ok(self.block)
    }

    fn area(&mut self, context: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(match self.world {
            Some(world) => world.area(context)?,
            None => Area::from(&Map::new(11, 11)),
        })
    }

    fn begin(&mut self, context: &mut Context<'_>, robot: u32, action: Action) -> Result<Progress, Failure> {
        if action.kind != ActionKind::Move {
            return self.begin_in_world(context, robot, action);
        }
        let DriveProperties { move_periods, .. } = self.properties;
        let jams = |number| self.properties.jams(number, context.chance());
        self.motor.start(action, move_periods, jams);
        Ok(Progress::Running)
    }

    fn poll(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Progress, Failure> {
        match self.motor.turn() {
            Turn::Goes => return Ok(Progress::Running),
            Turn::Jams(action, number) => {
                context.count("drive.jams", 1);
                warn!(context, "jams in move {number}, from {} to {}", self.block, action.block);
                return Ok(Progress::Failed);
            }
            Turn::Through(action) => self.at_edge = Some(action),
            Turn::Rests => {}
        }
        if let Some(action) = self.at_edge {
            // The world decides if the robot can enter the block. While it is busy the robot stays at the edge.
            let progress = self.begin_in_world(context, robot, action)?;
            self.at_edge = None;
            return Ok(progress);
        }
        let (Some(action), Some(world)) = (self.in_world, self.world) else { return Ok(Progress::Done) };
        let progress = world.poll(context, robot)?;
        if progress != Progress::Running {
            self.in_world = None;
        }
        if progress == Progress::Done {
            self.arrive(action);
        }
        Ok(progress)
    }

    fn cancel(&mut self, context: &mut Context<'_>, robot: u32) -> Result<(), Failure> {
        self.stop(context, robot)
    }

    fn retire(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Block, Failure> {
        self.motor.stop();
        (self.at_edge, self.in_world) = (None, None);
        // From now on other robots can reach the robot's block.
        Ok(match self.world {
            Some(world) => world.retire(context, robot)?,
            None => self.block,
        })
    }
}

saoms_api::plugin! {
    classes: [Drive],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<Drive>(&[("jams", "0.5")]);
    }
}
