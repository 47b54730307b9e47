//! The hardware of a robot: its wheels and its gripper. A robot of the fleet calls it through its reference `world`.
//!
//! The calls must not wait: `begin` starts an action, and `poll` returns its progress in each period of the robot. Here
//! the hardware is simulated, by counting; replace that by the calls of your motors.

use saoms_api::{Class, Component, Context, Failure, Own, info};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, ActionKind, Area, Hardware, Progress};

/// The driver of one robot.
#[derive(Debug, Class)]
#[class(name = "my_plugin.MyPlugin", passive, service("hardware": Hardware))]
pub struct MyPlugin {
    /// Number of periods that a move from one block to the next takes.
    #[property(default = 3, range = 1..=1000)]
    move_periods: u32,
    block: Block,
    /// The running action, and the number of periods that are left.
    running: Option<(Action, u32)>,
}

impl Component for MyPlugin {
    type Properties = Own<Self>;
}

impl Hardware for MyPlugin {
    fn enter(&mut self, _: &mut Context<'_>, _: u32, _: String, block: Block) -> Result<Block, Failure> {
        self.block = block;
        Ok(block)
    }

    fn area(&mut self, _: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(Area::from(&Map::new(11, 11)))
    }

    fn begin(&mut self, _: &mut Context<'_>, _: u32, action: Action) -> Result<Progress, Failure> {
        let periods = if action.kind == ActionKind::Move { self.move_periods } else { 1 };
        self.running = Some((action, periods));
        Ok(Progress::Running)
    }

    fn poll(&mut self, context: &mut Context<'_>, _: u32) -> Result<Progress, Failure> {
        match &mut self.running {
            Some((action, periods)) if *periods <= 1 => {
                match action.kind {
                    ActionKind::Move => self.block = action.block,
                    // Deliveries are counted by the component that can confirm them: here, the hardware.
                    ActionKind::Deposit => context.count("luggage.delivered", 1),
                    ActionKind::Collect => {}
                }
                info!(context, "{:?} at {} is done", action.kind, self.block);
                self.running = None;
                Ok(Progress::Done)
            }
            Some((_, periods)) => {
                *periods -= 1;
                Ok(Progress::Running)
            }
            None => Ok(Progress::Done),
        }
    }

    fn cancel(&mut self, _: &mut Context<'_>, _: u32) -> Result<(), Failure> {
        self.running = None;
        Ok(())
    }

    fn retire(&mut self, _: &mut Context<'_>, _: u32) -> Result<Block, Failure> {
        self.running = None;
        Ok(self.block)
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
        saoms_testkit::comply::<MyPlugin>(&[]);
    }
}
