//! A robot that does what every robot does, and tells how far it has driven.

use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Topic, info};
use saoms_components::grid::Block;
use saoms_components::robot::Robot;

/// The way of a robot.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(key = "robot")]
pub struct Way {
    /// Number of the robot.
    pub robot: u32,
    /// Number of blocks that it has driven.
    pub blocks: u64,
}

/// The newest way of each robot.
pub const WAY: Topic<Way> = Topic::state("WAY").optional();

/// A robot that tells how far it has driven.
#[derive(Debug, Class)]
#[class(name = "my_plugin.MyPlugin", periodic)]
pub struct MyPlugin {
    /// The robot that ships: its properties, topics and loops are those of this class, too.
    #[extends]
    robot: Robot,
    /// Number of blocks after which it tells its way again.
    #[property(default = 5, range = 1.., unit = "blocks")]
    every: u64,
    #[publishes(WAY)]
    way: Publisher<Way>,
    block: Option<Block>,
    blocks: u64,
}

impl Component for MyPlugin {
    type Properties = Own<Self>;

    // What is not written here, as `initialize` and `shutdown`, is that of the robot.
    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.robot.execute(context)?;
        let (robot, block) = (self.robot.knowledge().number, self.robot.knowledge().block);
        let has_moved = self.block.replace(block).is_some_and(|before| before != block);
        self.blocks += u64::from(has_moved);
        if has_moved && self.blocks.is_multiple_of(self.every) {
            info!(context, "has driven {} blocks", self.blocks);
            context.send(&self.way, Way { robot, blocks: self.blocks })?;
        }
        Ok(())
    }
}

saoms_api::plugin! {
    classes: [MyPlugin],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<MyPlugin>(&[("ID", "Robot1")]);
    }
}
