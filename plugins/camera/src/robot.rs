use saoms_api::{Class, Component, Context, Failure, Own, Publisher};
use saoms_components::robot::Robot;

use crate::picture::{CAMERA, CameraPicture, FLOOR, ROBOT, WALL};

/// A robot that brings luggage as any other, and publishes the pictures of its camera.
///
/// The manual's `Robot999` is one with its number, its charger and its battery set.
#[derive(Debug, Class)]
#[class(
    name = "camera.Robot",
    periodic,
    also("robot.Robot999", number = 999, chargeX = 0, chargeY = 1, discharge = 2.0)
)]
pub struct CameraRobot {
    #[extends]
    robot: Robot,
    /// Number of blocks that the camera sees in each direction.
    #[property(default = 2, range = 0..=20, unit = "blocks")]
    reach: u32,
    /// Number of executions from one picture to the next.
    #[property(default = 1, range = 1..)]
    every: u64,
    #[publishes(CAMERA)]
    camera: Publisher<CameraPicture>,
}

impl Component for CameraRobot {
    type Properties = Own<Self>;

    // The rest, such as `initialize` and `save`, is that of the robot: the camera has no state of its own.
    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.robot.execute(context)?;
        // A broken robot takes no pictures.
        if self.robot.knowledge().shut_down || !context.execution().is_multiple_of(self.every) {
            return Ok(());
        }
        context.send(&self.camera, self.snapshot())
    }
}

impl CameraRobot {
    /// The place for the calls of a real camera: this one draws the knowledge of the robot.
    fn snapshot(&self) -> CameraPicture {
        let robot = self.robot.knowledge();
        CameraPicture::take(robot.number, robot.block, self.reach, |block| {
            if block == robot.block || robot.lists.peers.on(block).is_some() {
                ROBOT
            } else if robot.routes.is_free(block) {
                FLOOR
            } else {
                WALL
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use saoms_components::grid::Block;
    use saoms_components::messages::{POSITION, Position};
    use saoms_testkit::Bench;

    use super::*;

    #[test]
    fn the_camera_sees_the_robots_around() -> Result<(), Failure> {
        let mut robot = Bench::of::<CameraRobot>(&[("ID", "Robot3"), ("reach", "1")])?;
        robot.start()?;
        let block = Block::new(1, 3);
        robot.deliver(&POSITION, Position { robot: 4, block, next: block, wanted: block, ..Position::default() });
        robot.execute()?;
        let pictures = robot.sent(&CAMERA);
        assert_eq!(pictures.len(), 1);
        assert_eq!((pictures[0].robot, pictures[0].block, pictures[0].others()), (3, Block::new(0, 3), 1));
        Ok(())
    }

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<CameraRobot>(&[("ID", "Robot3")]);
    }
}
