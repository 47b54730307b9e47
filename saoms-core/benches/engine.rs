//! Costs of the engine beside the components: `cargo bench -p saoms-core --bench engine`.
//!
//! In virtual time, on one core, the best of seven: ns per execution of an empty component, ns per delivery of a
//! message from `send` to `receive`, and bytes per idle component, and what the journal costs. A delivery is one
//! message that one reader has received; its cost is the time of a fleet that sends, less that of the same fleet when
//! it does not, the digest of the trace included.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use saoms_api::host::{DynLoop, PropertyValue, Registration};
use saoms_api::{
    Class, Component, Context, Extras, Failure, Field, Knowledge, Loop, LoopClass, Loops, Message, Own, Properties,
    Publisher, Record, Region, Subscription, Time, Topic, record,
};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::assembly::{Assembly, ComponentSpec, TaskProperties};
use saoms_lang::registry::Registry;

/// Position of a robot: the most frequent message of the airport's robots.
#[derive(Clone, Debug, PartialEq, Message)]
struct Position {
    robot: u32,
    x: i32,
    y: i32,
}

const EVENT: Topic<Position> = Topic::event("EVENT");
const STATE: Topic<Position> = Topic::state("STATE");

#[derive(Properties)]
struct Load {
    /// Number of messages to send in each execution.
    #[property(default = 0)]
    sends: u32,
    #[property(default = false)]
    receives: bool,
    #[property(default = false)]
    state: bool,
    /// Number of records to write in each execution.
    #[property(default = 0)]
    writes: u32,
    /// Number of loops with the same symptom and the same decision in each execution.
    #[property(default = 0)]
    loops: u32,
}

/// Sends and receives.
#[derive(Class)]
#[class(name = "load", periodic, publishes(EVENT, STATE), subscribes(EVENT, STATE))]
struct Robot {
    load: Load,
    publisher: Publisher<Position>,
    subscription: Subscription<Position>,
    sum: i64,
    mind: Mind,
    loops: Loops,
}

/// Four entries.
#[derive(Default, Knowledge)]
#[knowledge(name = "load.Mind")]
struct Mind {
    #[entry]
    x: i32,
    #[entry]
    y: i32,
    #[entry]
    busy: bool,
    #[entry]
    battery: f64,
    #[extras]
    extras: Extras,
}

/// Loop that finds the same symptom in each execution.
#[derive(LoopClass)]
#[looping(name = "load.Steady")]
struct Steady;

impl Loop for Steady {
    type Properties = ();
    type Knowledge = Mind;
    type Symptom = Record;
    type Decision = Record;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Steady)
    }

    fn analyze(&mut self, mind: &mut Mind, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(record!("has {battery} % left at {block}", battery = mind.battery, block = (mind.x, mind.y))))
    }

    fn plan(&mut self, _: Record, _: &mut Mind, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(record!("waits until it is charged")))
    }

    fn execute(&mut self, _: Record, _: &mut Mind, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }
}

impl Component for Robot {
    type Properties = Load;

    fn new(load: Load) -> Result<Self, Failure> {
        let steady = (0..load.loops).map(|number| (number.to_string(), Box::new(Steady) as Box<dyn DynLoop>));
        Ok(Robot {
            loops: Loops::of(steady),
            load,
            publisher: Publisher::default(),
            subscription: Subscription::default(),
            sum: 0,
            mind: Mind::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let topic = if self.load.state { &STATE } else { &EVENT };
        self.publisher = context.publish(topic)?;
        if self.load.receives {
            self.subscription = context.subscribe(topic)?;
        }
        self.loops.initialize(&mut self.mind, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for message in context.receive(&self.subscription) {
            self.sum += i64::from(message.x);
        }
        for number in 0..self.load.sends {
            context.send(&self.publisher, Position { robot: number, x: 1, y: 2 })?;
        }
        for number in 0..self.load.writes {
            context.effect(record!("moves to {block} for the piece {number}", block = (1, 2), number));
        }
        black_box(self.sum);
        self.loops.adapt(&mut self.mind, context)
    }
}

/// A block of a map.
#[derive(Clone, Copy, Debug, PartialEq, Field)]
#[field(pair)]
struct Block {
    x: i32,
    y: i32,
}

/// Position of a roamer.
#[derive(Clone, Debug, Message)]
#[message(place = "block")]
struct Roams {
    block: Block,
}

const ROAMS: Topic<Roams> = Topic::state("ROAMS");

/// Moves by a block in each execution, and sees those around it: one of 25 blocks has a roamer.
#[derive(Class)]
#[class(name = "roamer", periodic)]
struct Roamer {
    #[property(default = 0)]
    number: i32,
    /// Number of roamers side by side.
    #[property(default = 1)]
    side: i32,
    #[publishes(ROAMS)]
    publisher: Publisher<Roams>,
    #[subscribes(ROAMS)]
    others: Subscription<Roams>,
    seen: usize,
}

impl Component for Roamer {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.seen += context.receive(&self.others).count();
        let step = (context.execution() % 5) as i32;
        let block = Block { x: self.number % self.side * 5 + step, y: self.number / self.side * 5 };
        context.send(&self.publisher, Roams { block })?;
        black_box(self.seen);
        context.set_region(&self.others, Some(Region::around((block.x, block.y), 5)))
    }
}

/// Nanoseconds per execution of so many roamers.
fn roam(side: i32) -> Result<f64, Box<dyn std::error::Error>> {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Roamer>())?;
    let class = registry.get("roamer").ok_or("the class is registered")?;
    let count = side * side;
    let mut components = Vec::new();
    for number in 0..count {
        let task = [("ID", "roamer"), ("period", "1s")];
        let task = task.map(|(name, value)| (name.into(), PropertyValue::from(value)));
        let values = [("number", number), ("side", side)];
        components.push(ComponentSpec {
            path: format!("R{number}"),
            class: Arc::clone(class),
            site: Default::default(),
            node: Default::default(),
            fault_node: Default::default(),
            library: None,
            values: values.map(|(name, value)| (name.into(), PropertyValue::from(&*value.to_string()))).to_vec(),
            written: Default::default(),
            task: Some(TaskProperties::from_values(&task).map_err(|failure| failure.to_string())?),
            references: Vec::new(),
            loops: Arc::default(),
            web: Box::default(),
        });
    }
    let fleet =
        RunningFleet::start(Assembly { components, ..Assembly::default() }, Settings::simulated(0), Vec::new())?;
    let periods = (200_000 / count as u64).max(5);
    let mut best = f64::INFINITY;
    for round in 0..5 {
        let begin = Instant::now();
        fleet.run_until(Time::from_nanos((round + 1) * periods * 1_000_000_000));
        best = best.min(begin.elapsed().as_nanos() as f64 / (periods * count as u64) as f64);
    }
    Ok(best)
}

/// A fleet of equal periods.
struct Shape {
    senders: usize,
    receivers: usize,
    /// True if all components send and receive.
    all: bool,
    sends: u32,
    state: bool,
    writes: u32,
    loops: u32,
}

/// A fleet of components that do nothing.
const IDLE: Shape = Shape { senders: 0, receivers: 0, all: false, sends: 0, state: false, writes: 0, loops: 0 };

#[expect(clippy::print_stdout, reason = "a benchmark tells its result")]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    // First, while the process has no freed memory to reuse.
    let (before, count) = (resident(), 10_000);
    let fleet = start(&Shape { senders: count, all: true, ..IDLE })?;
    fleet.run_until(Time::from_nanos(5_000_000_000));
    println!("{:6.0} bytes per idle component, its assembly included", (resident() - before) / count as f64);
    drop(fleet);
    for count in [1, 10, 100, 1000, 10_000] {
        let shape = Shape { senders: count, ..IDLE };
        println!("{:6.1} ns per execution, {count} components", best([&shape])?[0] / count as f64);
    }
    let quiet = Shape { senders: 100, ..IDLE };
    let [writing, silent] = best([&Shape { writes: 16, ..quiet }, &quiet])?;
    println!("{:6.1} ns per record of the journal, 100 components", (writing - silent) / 1600.0);
    let [steady, silent] = best([&Shape { loops: 7, ..quiet }, &quiet])?;
    println!(
        "{:6.1} ns per execution of a loop that goes on as before, 100 components with 7 each",
        (steady - silent) / 700.0
    );
    let shapes = [
        ("1 -> 1", 1, 1, false),
        ("1 -> 10", 1, 10, false),
        ("1 -> 1000", 1, 1000, false),
        ("100 <-> 100", 100, 100, true),
    ];
    for (name, senders, receivers, all) in shapes {
        // A reader of a state topic gets only the newest message of each publisher.
        for (sends, state) in [(1, false), (16, false), (1, true)] {
            let shape = Shape { senders, receivers, all, sends, state, ..IDLE };
            let [busy, silent] = best([&shape, &Shape { sends: 0, ..shape }])?;
            let net = busy - silent;
            let kind = if state { "states" } else { "events" };
            let deliveries = (senders * receivers * sends as usize) as f64;
            println!("{:6.1} ns per delivery, {name}, {sends} {kind} in each execution", net / deliveries);
        }
    }
    for side in [10, 32, 100] {
        let time = roam(side)?;
        println!(
            "{time:6.0} ns per execution of a robot that moves and sees those within 5 blocks, {} robots",
            side * side
        );
    }
    Ok(())
}

/// Nanoseconds per period of each fleet: they run in turns, so that a drift of the machine falls on all alike, and the
/// best of seven rounds counts.
fn best<const COUNT: usize>(shapes: [&Shape; COUNT]) -> Result<[f64; COUNT], Box<dyn std::error::Error>> {
    let mut fleets = Vec::new();
    for shape in shapes {
        let components = if shape.all { shape.senders } else { shape.senders + shape.receivers };
        let per_period = components + shape.senders * shape.receivers * shape.sends as usize;
        let periods = (2_000_000 / per_period).max(20) as u64;
        fleets.push((start(shape)?, periods));
    }
    let mut best = [f64::INFINITY; COUNT];
    // The first round warms up.
    for round in 0..8 {
        for ((fleet, periods), best) in fleets.iter().zip(&mut best) {
            let begin = Instant::now();
            fleet.run_until(Time::from_nanos((round + 1) * periods * 1_000_000_000));
            let time = begin.elapsed().as_nanos() as f64 / *periods as f64;
            *best = if round == 0 { *best } else { best.min(time) };
        }
    }
    Ok(best)
}

fn start(shape: &Shape) -> Result<RunningFleet, Box<dyn std::error::Error>> {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Robot>())?;
    let class = registry.get("load").ok_or("the class is registered")?;
    let mut components = Vec::new();
    let count = if shape.all { shape.senders } else { shape.senders + shape.receivers };
    for number in 0..count {
        let task = [("ID", "load"), ("period", "1s"), ("queue", "100000")];
        let task = task.map(|(name, value)| (name.into(), PropertyValue::from(value)));
        let sends = if number < shape.senders { shape.sends } else { 0 };
        let receives = (shape.all && shape.receivers > 0) || number >= shape.senders;
        let values = [
            ("sends", sends.to_string()),
            ("receives", receives.to_string()),
            ("state", shape.state.to_string()),
            ("writes", shape.writes.to_string()),
            ("loops", shape.loops.to_string()),
        ];
        components.push(ComponentSpec {
            path: format!("Robot{number}"),
            class: Arc::clone(class),
            site: Default::default(),
            node: Default::default(),
            fault_node: Default::default(),
            values: values.map(|(name, value)| (name.into(), PropertyValue::from(value.as_str()))).to_vec(),
            written: Default::default(),
            task: Some(TaskProperties::from_values(&task).map_err(|failure| failure.to_string())?),
            library: None,
            references: Vec::new(),
            loops: std::sync::Arc::default(),
            web: Box::default(),
        });
    }
    Ok(RunningFleet::start(Assembly { components, ..Assembly::default() }, Settings::simulated(1), Vec::new())?)
}

/// The memory of this process, in bytes.
fn resident() -> f64 {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    statm.split(' ').nth(1).and_then(|pages| pages.parse::<f64>().ok()).unwrap_or(0.0) * 4096.0
}
