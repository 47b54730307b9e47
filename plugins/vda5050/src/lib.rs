//! Vehicles that take orders by VDA 5050 over MQTT, as the hardware of robots.
//!
//! The fleet decides, block by block, and so an order never leads further than to the next block: a vehicle whose fleet
//! was killed or is cut off stops there by itself. See the README of this plugin.

mod known;
mod link;
mod messages;

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Finding, Own, Place, Secret, StopFunction, Time, warn};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, ActionKind, Area, Hardware, Progress};
use saoms_transport::Settings;
use saoms_transport::mqtt::Mqtt;
use saoms_transport::tls::Files;

use known::Outcome;
use link::{Link, Names};
use messages::{Node, Parameter, Position, State};

/// Time in which a vehicle has to confirm that it stands still.
const STOP_PATIENCE: Duration = Duration::from_secs(2);
/// Time in which it says its first state, which it is asked for.
const STATE_PATIENCE: Duration = Duration::from_secs(2);
/// The kind of the alert about a vehicle that does not confirm that it stands still.
const MAY_MOVE: &str = "may_move";

/// A vehicle that takes orders by VDA 5050 2.0 over MQTT.
#[derive(Debug, Class)]
#[class(name = "vda5050.Vehicle", passive, stops, service("hardware": Hardware))]
pub struct Vehicle {
    /// The MQTT broker: `mqtt://host:port`, or `mqtts://host:port` with TLS.
    #[property(required_text)]
    broker: String,
    /// The user at the broker.
    #[property]
    user: Option<String>,
    /// The password of this user, or `$NAME` for the environment variable `NAME`.
    #[property]
    password: Option<Secret>,
    /// The path of a file (PEM) with the certificates of those who vouch for the broker.
    #[property]
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
    past: Past,
    link: Slot,
}

/// The action that runs.
#[derive(Clone, Copy, Debug)]
struct Running {
    action: Action,
    begun: Time,
    /// False while the broker is away, so that the vehicle has not heard of it.
    is_ordered: bool,
    /// The number of stops before it: one that comes after it ends it, even if the vehicle has not heard of it.
    stops: u32,
    /// Since when it is not wanted any more. It runs until the vehicle stands: before that, nobody knows where it will.
    given_up: Option<GivenUp>,
}

/// An action that is not wanted any more.
#[derive(Clone, Copy, Debug)]
struct GivenUp {
    since: Time,
    is_alerted: bool,
}

/// What a robot may ask again that has failed before it heard the answer.
#[derive(Debug, Default)]
struct Past {
    /// How the last action ended.
    last: Option<Progress>,
    /// The last action of the gripper that was done.
    handled: Option<Action>,
    /// True from `enter` to the first `poll`: a robot that begins an action meanwhile has begun anew.
    is_entered: bool,
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
            false => Err(Failure::new(may_move(name))),
        }
    }
}

fn may_move(name: &str) -> String {
    format!("vehicle {name} may still move: it did not confirm `cancelOrder`")
}

impl Component for Vehicle {
    type Properties = Own<Self>;

    fn new(properties: Own<Self>) -> Result<Vehicle, Failure> {
        let vehicle = Vehicle::made(properties)?;
        vehicle.judge()?;
        Ok(vehicle)
    }

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
        link.wait(STATE_PATIENCE).map_err(unreached)?;
        Ok(link)
    }

    /// Looks at the broker and the account, before anything starts.
    fn judge(&self) -> Result<(), Failure> {
        if self.user.is_some() != self.password.is_some() {
            return Err("`user` and `password` are given together, or not at all".into());
        }
        let account = self.user.clone().map(|user| (user, String::new()));
        let faults = Settings::new(self.broker.clone(), account, Files::default()).judge_url::<Mqtt>();
        let finding =
            |(setting, text)| Finding::new(Place::property(if setting == "url" { "broker" } else { setting }), text);
        match faults.is_empty() {
            true => Ok(()),
            false => Err(Failure::of_findings(faults.into_iter().map(finding).collect())),
        }
    }

    fn settings(&self) -> Result<Settings, Failure> {
        let account = match (&self.user, &self.password) {
            (Some(user), Some(password)) => {
                let password = password.resolve(|name| std::env::var(name).ok());
                let unset = |name: &str| Failure::new(format!("the environment variable `{name}` is not set"));
                Some((user.clone(), password.map_err(unset)?))
            }
            _ => None,
        };
        let tls = Files { ca: self.tls_ca.clone(), ..Files::default() };
        Ok(Settings::new(self.broker.clone(), account, tls))
    }

    /// Orders an action, unless the vehicle was stopped since this number of stops. False: the broker is away.
    fn order(&self, action: Action, stops: u32) -> Result<bool, Failure> {
        let link = self.link.get()?;
        let here = self.node(self.block, 0);
        let ordered = match action.kind {
            ActionKind::Move => link.order(vec![here, self.node(action.block, 2)], None, stops),
            ActionKind::Collect | ActionKind::Deposit => {
                let kind = if action.kind == ActionKind::Collect { "pick" } else { "drop" };
                let mut order = link.action(kind, kind, "HARD");
                let (load, at) = (action.luggage.to_string(), format!("{}-{}", action.block.x, action.block.y));
                order.action_parameters.push(Parameter { key: "loadId", value: load });
                order.action_parameters.push(Parameter { key: "stationName", value: at });
                link.order(vec![here], Some(order), stops)
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
    fn block_at(&self, (x, y): (f64, f64)) -> Block {
        let nearest = |metres: f64, origin: f64| ((metres - origin) / self.block_size).round() as i32;
        Block::new(nearest(x, self.origin_x), nearest(y, self.origin_y))
    }

    /// The block where the vehicle says to be: that nearest to its position, or else that of its last node.
    fn block_of(&self, state: &State) -> Option<Block> {
        if let Some(position) = state.position() {
            return Some(self.block_at(position));
        }
        let (x, y) = state.last_node_id.rsplit_once('-').and_then(|(x, y)| Some((x.parse().ok()?, y.parse().ok()?)))?;
        Some(Block::new(x, y))
    }

    /// How the running action goes; `Done` if none is running. One that has failed runs on until the vehicle stands.
    fn progress(&mut self, context: &mut Context<'_>) -> Result<Progress, Failure> {
        let Some(running @ Running { action, begun, .. }) = self.running else { return Ok(Progress::Done) };
        let link = self.link.get()?;
        if let Some(why) = link.refused() {
            warn!(context, "vehicle {}: what it says is no state: {why}", self.name());
        }
        if !running.is_ordered {
            return Ok(self.order_again(context, running));
        }
        let why = match link.outcome() {
            Outcome::Done => return Ok(self.end(context, action, Progress::Done)),
            Outcome::Cancelled => return Ok(self.stands(context, action, &link)),
            Outcome::Stopping => "it is stopped".to_owned(),
            Outcome::Failed(why) => why,
            Outcome::Running if running.given_up.is_none() && context.now() - begun < self.patience => {
                return Ok(Progress::Running);
            }
            Outcome::Running => {
                let trouble = link.trouble().map(|trouble| format!(": {trouble}"));
                format!("it does not carry the order out{}", trouble.unwrap_or_default())
            }
        };
        self.give_up(context, &why);
        link.cancel();
        self.alert_if_it_may_move(context);
        Ok(Progress::Running)
    }

    /// Orders an action of which the vehicle has not heard, so that it stands.
    fn order_again(&mut self, context: &mut Context<'_>, running: Running) -> Progress {
        let Running { action, begun, stops, given_up, .. } = running;
        if given_up.is_some() {
            return self.end(context, action, Progress::Failed);
        }
        let why = match self.order(action, stops) {
            Ok(is_ordered) if is_ordered || context.now() - begun < self.patience => {
                if let Some(running) = &mut self.running {
                    running.is_ordered = is_ordered;
                }
                return Progress::Running;
            }
            Ok(_) => "it cannot hear the order: the broker is away".to_owned(),
            Err(why) => why.to_string(),
        };
        warn!(context, "vehicle {}: {why}: {action}", self.name());
        self.end(context, action, Progress::Failed)
    }

    /// The running action is not wanted any more.
    fn give_up(&mut self, context: &mut Context<'_>, why: &str) {
        let name = self.name();
        let Some(Running { action, given_up: given_up @ None, .. }) = &mut self.running else { return };
        *given_up = Some(GivenUp { since: context.now(), is_alerted: false });
        warn!(context, "vehicle {name}: {why}: {action}");
    }

    /// Says once that somebody has to look.
    fn alert_if_it_may_move(&mut self, context: &mut Context<'_>) {
        let text = may_move(&self.name());
        let Some(given_up) = self.running.as_mut().and_then(|running| running.given_up.as_mut()) else { return };
        if !given_up.is_alerted && context.now() - given_up.since >= STOP_PATIENCE {
            given_up.is_alerted = true;
            context.alert(MAY_MOVE, "", text);
        }
    }

    /// The vehicle stands still after its action was cancelled: a move may have come to its end nevertheless.
    fn stands(&mut self, context: &mut Context<'_>, action: Action, link: &Link) -> Progress {
        if action.kind == ActionKind::Move {
            self.block = link.state().and_then(|state| self.block_of(&state)).unwrap_or(self.block);
            if self.block == action.block {
                return self.end(context, action, Progress::Done);
            }
        }
        self.end(context, action, Progress::Failed)
    }

    /// The running action is over.
    fn end(&mut self, context: &mut Context<'_>, action: Action, progress: Progress) -> Progress {
        if progress == Progress::Done {
            match action.kind {
                ActionKind::Move => self.block = action.block,
                // The summary of a run counts what the component that knows the truth counts: here, the hardware.
                ActionKind::Deposit => context.count("luggage.delivered", 1),
                ActionKind::Collect => {}
            }
            self.past.handled = Some(action).filter(|action| action.kind != ActionKind::Move).or(self.past.handled);
        }
        if self.running.take().and_then(|running| running.given_up).is_some_and(|given_up| given_up.is_alerted) {
            context.alert_over(MAY_MOVE, "");
        }
        self.past.last = Some(progress);
        progress
    }

    /// The answer to a robot that believes to be at a block: where it is not, it has to find out where it is.
    fn answer(&self, believed: Block, action: Action, progress: Progress) -> Result<Progress, Failure> {
        if progress == Progress::Running || [believed, action.block].contains(&self.block) {
            return Ok(progress);
        }
        let (name, here) = (self.name(), self.block);
        Err(Failure::new(format!("vehicle {name} was to {action}, and stands at {here}")))
    }
}

impl Hardware for Vehicle {
    /// The vehicle knows where it is; one that does not yet is believed to be where the robot expects it. The first
    /// time, this waits for its state, for some seconds at most: a robot begins at no place that is guessed.
    fn enter(&mut self, context: &mut Context<'_>, _: u32, _: String, block: Block) -> Result<Block, Failure> {
        if self.link.get().is_err() {
            if Settings::new(self.broker.clone(), None, Files::default()).is_unprotected::<Mqtt>() {
                let name = self.name();
                warn!(
                    context,
                    "orders to vehicle {name} go over the network without protection: who is on it can drive it"
                );
            }
            self.link.set(Some(self.reach()?));
        }
        self.past.is_entered = true;
        let position = self.link.get()?.state().and_then(|state| state.position());
        self.block = position.map_or(block, |position| self.block_at(position));
        Ok(self.block)
    }

    fn area(&mut self, _: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(Area::from(&Map::new(self.width, self.height)))
    }

    fn begin(&mut self, context: &mut Context<'_>, _: u32, action: Action) -> Result<Progress, Failure> {
        if std::mem::take(&mut self.past.is_entered) {
            // What a robot carries that has begun anew, it does not know.
            self.past.handled = None;
        }
        if self.running.is_some() {
            self.give_up(context, "another action begins");
            if self.progress(context)? == Progress::Running {
                return Ok(Progress::Failed);
            }
        }
        // Its robot did not hear that it is done.
        if self.past.handled == Some(action) {
            return Ok(Progress::Done);
        }
        let stops = self.link.get()?.stops();
        match self.order(action, stops) {
            Ok(is_ordered) => {
                self.running = Some(Running { action, begun: context.now(), is_ordered, stops, given_up: None });
                Ok(Progress::Running)
            }
            Err(why) => {
                warn!(context, "vehicle {} gets no order: {why}", self.name());
                self.past.last = Some(Progress::Failed);
                Ok(Progress::Failed)
            }
        }
    }

    fn poll(&mut self, context: &mut Context<'_>, _: u32) -> Result<Progress, Failure> {
        self.past.is_entered = false;
        let believed = self.block;
        match self.running.as_ref().map(|running| running.action) {
            Some(action) => {
                let progress = self.progress(context)?;
                self.answer(believed, action, progress)
            }
            None => Ok(self.past.last.unwrap_or(Progress::Done)),
        }
    }

    /// It runs until the vehicle stands, which `poll` looks at.
    fn cancel(&mut self, context: &mut Context<'_>, _: u32) -> Result<(), Failure> {
        self.give_up(context, "it is not wanted any more");
        self.progress(context).map(|_| ())
    }

    /// Waits until the vehicle stands: before that, nobody knows where it will.
    fn retire(&mut self, context: &mut Context<'_>, _: u32) -> Result<Block, Failure> {
        if let Some(Running { is_ordered, .. }) = self.running {
            self.give_up(context, "its robot is out of service");
            if is_ordered {
                self.link.stop(&self.name())?;
            }
            if self.progress(context)? == Progress::Running {
                return Err(Failure::new(may_move(&self.name())));
            }
        }
        self.past = Past::default();
        Ok(self.block)
    }

    fn battery(&mut self, _: &mut Context<'_>, _: u32) -> Result<Option<f64>, Failure> {
        let Ok(link) = self.link.get() else { return Ok(None) };
        Ok(link.state().and_then(|state| state.battery_state).and_then(|battery| battery.battery_charge))
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
