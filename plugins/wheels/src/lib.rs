//! Wheels and an arm behind a controller in the network: the driver that `docs/hardware.md` explains.

mod driver;

use std::sync::Arc;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Own, StopFunction, Time, warn};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, ActionKind, Area, Hardware, Progress};

use driver::{Driver, OrderState};

/// Time in which the controller has to confirm that the wheels stand still.
const STOP_PATIENCE: Duration = Duration::from_secs(2);

/// Wheels and an arm behind a controller in the network.
#[derive(Debug, Class)]
#[class(name = "wheels.Wheels", passive, stops, service("hardware": Hardware))]
pub struct Wheels {
    /// Where the controller listens, `host:port`.
    #[property(required_text)]
    address: String,
    /// Time after which an order without an answer has failed.
    #[property(default = "30s", range = "10ms"..="10min")]
    patience: Duration,
    block: Block,
    /// The action, when it began, and the number of its order.
    running: Option<(Action, Time, u64)>,
    driver: Option<Arc<Driver>>,
}

impl Component for Wheels {
    type Properties = Own<Self>;

    /// Starts the driver, and says how to stop the wheels from any thread, whatever this component does then.
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let driver = Driver::start(self.address.clone());
        let driver = Arc::new(driver.map_err(|error| Failure::new(format!("no thread for the driver: {error}")))?);
        let (stopped, alive, address) = (Arc::clone(&driver), Arc::clone(&driver), self.address.clone());
        self.driver = Some(driver);
        let stop = StopFunction::new(move || confirmed(stopped.stop(STOP_PATIENCE), &address));
        context.register_stop(stop.with_heartbeat(move |period| alive.alive(period)))
    }

    /// Waits until the wheels stand still. That nobody confirmed it is a failure: somebody has to look.
    fn shutdown(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        let Some(driver) = self.driver.take() else { return Ok(()) };
        confirmed(driver.stop(STOP_PATIENCE), &self.address)
    }
}

fn confirmed(stands_still: bool, address: &str) -> Result<(), Failure> {
    if stands_still {
        return Ok(());
    }
    Err(Failure::new(format!("the wheels may still turn: the controller at `{address}` did not confirm `stop`")))
}

impl Wheels {
    fn driver(&self) -> Result<&Driver, Failure> {
        self.driver.as_deref().ok_or_else(|| "the driver has ended".into())
    }
}

impl Hardware for Wheels {
    /// This robot has no eyes: it believes what it is told. One with a camera answers where it is.
    fn enter(&mut self, _: &mut Context<'_>, _: u32, _: String, block: Block) -> Result<Block, Failure> {
        self.block = block;
        Ok(block)
    }

    fn area(&mut self, _: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(Area::from(&Map::new(11, 11)))
    }

    fn begin(&mut self, context: &mut Context<'_>, _: u32, action: Action) -> Result<Progress, Failure> {
        let order = match action.kind {
            ActionKind::Move => {
                let (dx, dy) = (action.block.x - self.block.x, action.block.y - self.block.y);
                format!("move {dx} {dy}")
            }
            ActionKind::Collect => "collect".to_owned(),
            ActionKind::Deposit => "deposit".to_owned(),
        };
        let number = self.driver()?.order(&order);
        self.running = Some((action, context.now(), number));
        Ok(Progress::Running)
    }

    fn poll(&mut self, context: &mut Context<'_>, _: u32) -> Result<Progress, Failure> {
        let Some((action, begun, number)) = self.running else { return Ok(Progress::Done) };
        match self.driver()?.state(number) {
            OrderState::Running if context.now() - begun < self.patience => Ok(Progress::Running),
            OrderState::Done => {
                match action.kind {
                    ActionKind::Move => self.block = action.block,
                    // The summary of a run counts what the component that knows the truth counts: here, the hardware.
                    ActionKind::Deposit => context.count("luggage.delivered", 1),
                    ActionKind::Collect => {}
                }
                self.running = None;
                Ok(Progress::Done)
            }
            state => {
                let why = if state == OrderState::Failed { "the controller failed" } else { "no answer came" };
                warn!(context, "{why}: {:?} at {}", action.kind, self.block);
                self.running = None;
                // The order may still be carried out: it is not, after a stop.
                self.driver()?.order_stop();
                Ok(Progress::Failed)
            }
        }
    }

    fn cancel(&mut self, _: &mut Context<'_>, _: u32) -> Result<(), Failure> {
        self.running = None;
        self.driver()?.order_stop();
        Ok(())
    }

    fn retire(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Block, Failure> {
        self.cancel(context, robot)?;
        Ok(self.block)
    }
}

saoms_api::plugin! {
    classes: [Wheels],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<Wheels>(&[("address", "127.0.0.1:9"), ("patience", "10ms")]);
    }
}
