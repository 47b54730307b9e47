//! Components and loops that pass luggage on to each other, and leave records.

use saoms_api::host::{DynLoop, Registration};
use saoms_api::{
    Class, Component, Context, Extras, Failure, Knowledge, Loop, LoopClass, Loops, Message, Properties, Publisher,
    Record, Subscription, Topic, record,
};
use saoms_lang::assembly::Assembly;
use saoms_lang::registry::Registry;

use crate::actor::{Echo, EchoReference};
use crate::fleet::assembly_of;

/// A piece of luggage that waits.
#[derive(Clone, Debug, PartialEq, Message)]
struct Request {
    piece: u32,
}

/// Taker of the piece.
#[derive(Clone, Debug, PartialEq, Message)]
struct Taken {
    piece: u32,
}

const REQUESTS: Topic<Request> = Topic::event("REQUESTS");
const TAKEN: Topic<Taken> = Topic::event("TAKEN");

/// Times at which pieces appear.
#[derive(Clone, Properties)]
struct GateProperties {
    /// In which executions.
    #[property(default = 2)]
    every: u64,
}

/// Asks for help: the root of every chain.
#[derive(Class)]
#[class(name = "gate", periodic, publishes(REQUESTS), subscribes(TAKEN))]
struct Gate {
    every: u64,
    requests: Publisher<Request>,
    taken: Subscription<Taken>,
}

impl Component for Gate {
    type Properties = GateProperties;

    fn new(properties: GateProperties) -> Result<Self, Failure> {
        Ok(Gate { every: properties.every, requests: Publisher::default(), taken: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.requests = context.publish(&REQUESTS)?;
        self.taken = context.subscribe(&TAKEN)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for (header, taken) in context.receive(&self.taken).with_headers() {
            context.because(header.cause);
            context.effect(record!("strikes piece {piece} off its list", piece = taken.piece));
        }
        if context.execution() % self.every == 1 {
            let piece = u32::try_from(context.execution() / self.every).unwrap_or(0) + 1;
            context.because(saoms_api::Cause::default());
            context.symptom(record!("piece {piece} waits at {place}", piece, place = (3, 1)));
            context.send(&self.requests, Request { piece })?;
        }
        Ok(())
    }
}

const FIRST: Topic<Request> = Topic::event("FIRST");

/// Passes messages on, and has no opinion.
#[derive(Class)]
#[class(name = "relay", periodic, publishes(REQUESTS), subscribes(FIRST))]
struct Relay {
    requests: Publisher<Request>,
    heard: Subscription<Request>,
}

impl Component for Relay {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Relay { requests: Publisher::default(), heard: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.heard = context.subscribe(&FIRST)?;
        self.requests = context.publish(&REQUESTS)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for (header, request) in context.receive(&self.heard).with_headers() {
            context.because(header.cause);
            context.send(&self.requests, request.clone())?;
        }
        Ok(())
    }
}

/// Knowledge of a robot.
#[derive(Default, Knowledge)]
#[knowledge(name = "test.Mind")]
struct Mind {
    piece: Option<(u32, saoms_api::Cause)>,
    #[entry]
    charge: i64,
    /// The piece that was announced to others.
    #[entry(effector)]
    told: u32,
    #[extras]
    extras: Extras,
}

/// Takes what waits.
#[derive(Default, LoopClass)]
#[looping(name = "test.Jobs", effects("told"))]
struct JobLoop {
    heard: Subscription<Request>,
    taken: Publisher<Taken>,
}

impl Loop for JobLoop {
    type Properties = ();
    type Knowledge = Mind;
    type Symptom = Record;
    type Decision = Record;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(JobLoop::default())
    }

    fn initialize(&mut self, _: &mut Mind, context: &mut Context<'_>) -> Result<(), Failure> {
        self.heard = context.subscribe(&REQUESTS)?;
        self.taken = context.publish(&TAKEN)?;
        Ok(())
    }

    fn monitor(&mut self, mind: &mut Mind, context: &mut Context<'_>) -> Result<(), Failure> {
        if let Some((header, request)) = context.receive(&self.heard).with_headers().last() {
            mind.piece = Some((request.piece, header.cause));
        }
        Ok(())
    }

    fn analyze(&mut self, mind: &mut Mind, context: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        let Some((piece, cause)) = mind.piece else { return Ok(None) };
        context.because(cause);
        Ok(Some(record!("hears of piece {piece}", piece)))
    }

    fn plan(&mut self, _: Record, mind: &mut Mind, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok((mind.charge > 0).then(|| record!("takes it")))
    }

    fn execute(&mut self, _: Record, mind: &mut Mind, context: &mut Context<'_>) -> Result<(), Failure> {
        if let Some((piece, _)) = mind.piece
            && std::mem::replace(&mut mind.told, piece) != piece
        {
            context.send(&self.taken, Taken { piece })?;
        }
        context.effect(record!("goes on"));
        Ok(())
    }
}

/// Finds the battery low, and can do nothing about it.
#[derive(Default, LoopClass)]
#[looping(name = "test.Battery")]
struct BatteryLoop;

impl Loop for BatteryLoop {
    type Properties = ();
    type Knowledge = Mind;
    type Symptom = Record;
    type Decision = Record;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(BatteryLoop)
    }

    fn monitor(&mut self, mind: &mut Mind, _: &mut Context<'_>) -> Result<(), Failure> {
        mind.charge -= 1;
        Ok(())
    }

    fn analyze(&mut self, mind: &mut Mind, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok((mind.charge <= 2).then(|| record!("{charge} left", charge = mind.charge)))
    }

    fn plan(&mut self, _: Record, _: &mut Mind, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(record!("would charge")))
    }

    fn execute(&mut self, _: Record, _: &mut Mind, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }
}

/// Properties of a robot.
#[derive(Clone, Properties)]
struct RobotProperties {
    /// Number of executions that the battery lasts.
    #[property(default = 1000)]
    charge: i64,
    /// In which execution it fails.
    #[property(default = 1_000_000)]
    fails: u64,
}

/// Adapts itself by two loops.
#[derive(Class)]
#[class(name = "robot", periodic, publishes(TAKEN), subscribes(REQUESTS))]
struct Robot {
    properties: RobotProperties,
    mind: Mind,
    loops: Loops,
}

impl Component for Robot {
    type Properties = RobotProperties;

    fn new(properties: RobotProperties) -> Result<Self, Failure> {
        let loops: [(String, Box<dyn DynLoop>); 2] =
            [("Battery".to_owned(), Box::new(BatteryLoop)), ("Jobs".to_owned(), Box::new(JobLoop::default()))];
        let mind = Mind { charge: properties.charge, ..Mind::default() };
        Ok(Robot { properties, mind, loops: Loops::of(loops) })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.initialize(&mut self.mind, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.monitor(&mut self.mind, context)?;
        self.loops.adapt(&mut self.mind, context)?;
        if context.execution() == self.properties.fails {
            return Err(Failure::new("breaks down"));
        }
        Ok(())
    }
}

/// Asks another.
#[derive(Class)]
#[class(name = "asker", periodic, reference("peer": Echo, optional), reference("task": saoms_api::TaskInterface, optional))]
struct Asker {
    peer: EchoReference,
}

impl Component for Asker {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Asker { peer: EchoReference::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.peer = context.reference("peer")?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.symptom(record!("does not know"));
        context.decision(record!("asks"));
        self.peer.echo(context, String::new())?;
        Ok(())
    }
}

/// Answers.
#[derive(Class)]
#[class(name = "helper", passive, service("echo": Echo))]
struct Helper;

impl Component for Helper {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Helper)
    }
}

impl Echo for Helper {
    fn echo(&mut self, context: &mut Context<'_>, text: String) -> Result<String, Failure> {
        context.effect(record!("answers"));
        Ok(text)
    }
}

/// The record that a speaker writes.
#[derive(Clone, Properties)]
struct SpeakerProperties {
    /// `plain`, `reworded`, `other-id`, `other-value`, or `plain-text` and `other-text` of records without an id.
    record: String,
}

/// Writes one record in each execution.
#[derive(Class)]
#[class(name = "speaker", periodic)]
struct Speaker {
    record: String,
}

impl Component for Speaker {
    type Properties = SpeakerProperties;

    fn new(properties: SpeakerProperties) -> Result<Self, Failure> {
        Ok(Speaker { record: properties.record })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.symptom(match &*self.record {
            "plain" => record!(low_battery: "has {battery} % left", battery = 34),
            "reworded" => record!(low_battery: "battery is at {level} %", level = 34),
            "other-id" => record!(empty_battery: "has {battery} % left", battery = 34),
            "other-value" => record!(low_battery: "has {battery} % left", battery = 35),
            "plain-text" => record!("has {battery} % left", battery = 34),
            "other-text" => record!("battery is at {battery} %", battery = 34),
            other => return Err(Failure::new(format!("there is no record `{other}`"))),
        });
        Ok(())
    }
}

/// A fleet of them.
pub(super) fn fleet(text: &str) -> Assembly {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Gate>()).unwrap();
    registry.add(Registration::of::<Relay>()).unwrap();
    registry.add(Registration::of::<Robot>()).unwrap();
    registry.add(Registration::of::<Asker>()).unwrap();
    registry.add(Registration::of::<Helper>()).unwrap();
    registry.add(Registration::of::<Speaker>()).unwrap();
    assembly_of(text, &registry)
}
