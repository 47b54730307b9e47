//! Vehicles that take orders by VDA 5050 over MQTT, as the hardware of robots.
//!
//! The fleet decides, block by block, and so an order never leads further than to the next block: a vehicle whose fleet
//! was killed or is cut off stops there by itself. See the README of this plugin.

mod link;
mod messages;

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Own, Secret, StopFunction, Time, warn};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, ActionKind, Area, Hardware, Progress};
use saoms_transport::Settings;
use saoms_transport::tls::Files;

use link::{Link, Names, Outcome};
use messages::{Node, Parameter, Position};

/// Time in which a vehicle has to confirm that it stands still.
const STOP_PATIENCE: Duration = Duration::from_secs(2);
/// Time in which it says its first state, which it is asked for.
const STATE_PATIENCE: Duration = Duration::from_secs(2);

/// A vehicle that takes orders by VDA 5050 2.0 over MQTT.
#[derive(Debug, Class)]
#[class(name = "vda5050.Vehicle", passive, stops, service("hardware": Hardware))]
pub struct Vehicle {
    /// The MQTT broker: `mqtt://host:port`, or `mqtts://host:port` with TLS.
    #[property(required_text)]
    broker: String,
    /// The user at the broker.
    user: Option<String>,
    /// The password of this user, or `$NAME` for the environment variable `NAME`.
    password: Option<Secret>,
    /// The path of a file (PEM) with the certificates of those who vouch for the broker.
    tls_ca: Option<String>,
    /// The first parts of the topics.
    #[property(default = "uagv/v2", required_text)]
    interface: String,
    /// The manufacturer, as the topics have it.
    #[property(required_text)]
    manufacturer: String,
    /// The serial number, as the topics have it.
    #[property(required_text)]
    serial_number: String,
    /// The map of the vehicle.
    #[property(default = "hall", required_text)]
    map_id: String,
    /// The size of a block.
    #[property(default = 1.0, range = 0.05..=100.0, unit = "m")]
    block_size: f64,
    /// Where the middle of the block (0,0) is on the map.
    #[property(default = 0.0, unit = "m")]
    origin_x: f64,
    /// The same.
    #[property(default = 0.0, unit = "m")]
    origin_y: f64,
    /// The width of the area.
    #[property(default = 11, range = 1..=1000, unit = "blocks")]
    width: u32,
    /// The height of the area.
    #[property(default = 11, range = 1..=1000, unit = "blocks")]
    height: u32,
    /// Time after which an order that is not carried out has failed.
    #[property(default = "60s", range = "10ms"..="10min")]
    patience: Duration,
    block: Block,
    running: Option<Running>,
    link: Slot,
}

/// The action that runs.
#[derive(Clone, Copy, Debug)]
struct Running {
    action: Action,
    begun: Time,
    /// False while the broker is away, so that the vehicle has not heard of it.
    is_ordered: bool,
}

/// The link, which the function that stops the vehicle shares.
#[derive(Clone, Default)]
struct Slot(Arc<Mutex<Option<Arc<Link>>>>);

impl fmt::Debug for Slot {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("Slot")
    }
}

impl Slot {
    fn set(&self, link: Option<Arc<Link>>) -> Option<Arc<Link>> {
        std::mem::replace(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner), link)
    }

    fn get(&self) -> Result<Arc<Link>, Failure> {
        let link = self.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
        link.ok_or_else(|| "there is no link to the vehicle: no robot has entered".into())
    }

    /// Stops the vehicle, if it was ever reached.
    fn stop(&self, name: &str) -> Result<(), Failure> {
        let Ok(link) = self.get() else { return Ok(()) };
        match link.stop(STOP_PATIENCE) {
            true => Ok(()),
            false => Err(Failure::new(format!("vehicle {name} may still move: it did not confirm `cancelOrder`"))),
        }
    }
}

impl Component for Vehicle {
    type Properties = Own<Self>;

    /// Says how to stop the vehicle from any thread.
    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let (slot, name) = (self.link.clone(), self.name());
        context.register_stop(StopFunction::new(move || slot.stop(&name)))
    }

    /// Waits until the vehicle stands still. That it did not confirm it is a failure: somebody has to look.
    fn shutdown(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        let stopped = self.link.stop(&self.name());
        self.link.set(None);
        stopped
    }
}

impl Vehicle {
    fn name(&self) -> String {
        format!("{}/{}", self.manufacturer, self.serial_number)
    }

    /// Joins the broker, and hears the first state of the vehicle.
    fn reach(&self) -> Result<Arc<Link>, Failure> {
        let name = self.name();
        let unreached =
            |why: String| Failure::new(format!("vehicle {name} cannot be reached at `{}`: {why}", self.broker));
        let names = Names {
            prefix: self.interface.clone(),
            manufacturer: self.manufacturer.clone(),
            serial_number: self.serial_number.clone(),
        };
        let link = Arc::new(Link::open(self.settings()?, names).map_err(unreached)?);
        match link.wait(STATE_PATIENCE) {
            true => Ok(link),
            false => Err(unreached("it does not say its state".to_owned())),
        }
    }

    fn settings(&self) -> Result<Settings, Failure> {
        let account = match (&self.user, &self.password) {
            (Some(user), Some(password)) => {
                let password = password.resolve(|name| std::env::var(name).ok());
                let unset = |name: &str| Failure::new(format!("the environment variable `{name}` is not set"));
                Some((user.clone(), password.map_err(unset)?))
            }
            (None, None) => None,
            _ => return Err("`user` and `password` are given together, or not at all".into()),
        };
        let tls = Files { ca: self.tls_ca.clone(), ..Files::default() };
        Ok(Settings::new(self.broker.clone(), account, tls))
    }

    /// Orders an action. False: the broker is away.
    fn order(&self, action: Action) -> Result<bool, Failure> {
        let link = self.link.get()?;
        let here = self.node(self.block, 0);
        let ordered = match action.kind {
            ActionKind::Move => link.order(vec![here, self.node(action.block, 2)], None),
            ActionKind::Collect | ActionKind::Deposit => {
                let kind = if action.kind == ActionKind::Collect { "pick" } else { "drop" };
                let mut order = link.action(kind, kind, "HARD");
                let (load, at) = (action.luggage.to_string(), format!("{}-{}", action.block.x, action.block.y));
                order.action_parameters.push(Parameter { key: "loadId", value: load });
                order.action_parameters.push(Parameter { key: "stationName", value: at });
                link.order(vec![here], Some(order))
            }
        };
        ordered.map_err(Failure::new)
    }

    /// A node in the middle of a block.
    fn node(&self, block: Block, sequence_id: u32) -> Node {
        let (x, y) = (
            f64::from(block.x).mul_add(self.block_size, self.origin_x),
            f64::from(block.y).mul_add(self.block_size, self.origin_y),
        );
        Node {
            node_id: format!("{}-{}", block.x, block.y),
            sequence_id,
            released: true,
            node_position: Position { x, y, map_id: self.map_id.clone() },
            actions: Vec::new(),
        }
    }

    /// The block at a position.
    fn block_at(&self, x: f64, y: f64) -> Block {
        let nearest = |metres: f64, origin: f64| ((metres - origin) / self.block_size).round() as i32;
        Block::new(nearest(x, self.origin_x), nearest(y, self.origin_y))
    }
}

impl Hardware for Vehicle {
    /// The vehicle knows where it is; one that does not yet is believed to be where the robot expects it. The first
    /// time, this waits for its state, for some seconds at most: a robot begins at no place that is guessed.
    fn enter(&mut self, _: &mut Context<'_>, _: u32, _: String, block: Block) -> Result<Block, Failure> {
        if self.link.get().is_err() {
            self.link.set(Some(self.reach()?));
        }
        let state = self.link.get()?.state().unwrap_or_default();
        self.block = match state.agv_position.filter(|position| position.position_initialized) {
            Some(position) => self.block_at(position.x, position.y),
            None => block,
        };
        Ok(self.block)
    }

    fn area(&mut self, _: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(Area::from(&Map::new(self.width, self.height)))
    }

    fn begin(&mut self, context: &mut Context<'_>, _: u32, action: Action) -> Result<Progress, Failure> {
        match self.order(action) {
            Ok(is_ordered) => {
                self.running = Some(Running { action, begun: context.now(), is_ordered });
                Ok(Progress::Running)
            }
            Err(why) => {
                warn!(context, "vehicle {} gets no order: {why}", self.name());
                Ok(Progress::Failed)
            }
        }
    }

    fn poll(&mut self, context: &mut Context<'_>, _: u32) -> Result<Progress, Failure> {
        let Some(Running { action, begun, is_ordered }) = self.running else { return Ok(Progress::Done) };
        let link = self.link.get()?;
        let outcome = match is_ordered {
            true => link.outcome(),
            false => match self.order(action) {
                Ok(is_ordered) => {
                    self.running = Some(Running { action, begun, is_ordered });
                    Outcome::Running
                }
                Err(why) => Outcome::Failed(why.to_string()),
            },
        };
        let why = match outcome {
            Outcome::Running if context.now() - begun < self.patience => return Ok(Progress::Running),
            Outcome::Running => "it does not carry the order out".to_owned(),
            Outcome::Done => {
                match action.kind {
                    ActionKind::Move => self.block = action.block,
                    // The summary of a run counts what the component that knows the truth counts: here, the hardware.
                    ActionKind::Deposit => context.count("luggage.delivered", 1),
                    ActionKind::Collect => {}
                }
                self.running = None;
                return Ok(Progress::Done);
            }
            Outcome::Failed(why) => why,
        };
        warn!(context, "vehicle {}: {why}: {:?} at {}", self.name(), action.kind, action.block);
        self.running = None;
        // The order may still be carried out: it is not, after this.
        link.cancel().map_err(Failure::new)?;
        Ok(Progress::Failed)
    }

    fn cancel(&mut self, _: &mut Context<'_>, _: u32) -> Result<(), Failure> {
        if self.running.take().is_some() {
            self.link.get()?.cancel().map_err(Failure::new)?;
        }
        Ok(())
    }

    fn retire(&mut self, context: &mut Context<'_>, robot: u32) -> Result<Block, Failure> {
        self.cancel(context, robot)?;
        Ok(self.block)
    }

    fn battery(&mut self, _: &mut Context<'_>, _: u32) -> Result<Option<f64>, Failure> {
        let Ok(link) = self.link.get() else { return Ok(None) };
        Ok(link.state().and_then(|state| state.battery_state).map(|battery| battery.battery_charge))
    }
}

saoms_api::plugin! {
    classes: [Vehicle],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<Vehicle>(&[
            ("broker", "mqtt://127.0.0.1:9"),
            ("manufacturer", "ACME"),
            ("serialNumber", "7"),
        ]);
    }
}
