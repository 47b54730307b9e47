//! The classes that the tests' composites name.

use std::time::Duration;

use saoms_api::extension::{Access, Router, RouterClass, TlsPaths, Topics, submit};
use saoms_api::host::Registration;
use saoms_api::{
    Class, Component, Context, Failure, Finding, Message, Place, Properties, PropertyField, Secret, TaskInterface,
    Topic, interface,
};
use saoms_lang::registry::Registry;

/// All of them, and one that waits for answers.
pub(crate) fn with_surveyor() -> Registry {
    let mut registry = registry();
    registry.add(Registration::of::<Surveyor>()).unwrap();
    registry
}

/// All of them.
pub(crate) fn registry() -> Registry {
    let mut registry = Registry::new();
    let all = [
        Registration::of::<Robot>(),
        Registration::of::<Navigator>(),
        Registration::of::<Gps>(),
        Registration::of::<OldGps>(),
        Registration::of::<Twins>(),
        Registration::of::<Clock>(),
        Registration::of::<Broker>(),
        Registration::of::<Shouter>(),
        Registration::of::<Tracker>(),
        Registration::of::<Fragile>(),
        Registration::of::<Reader>(),
        Registration::of::<Board>(),
        Registration::of::<Conductor>(),
        Registration::of::<Dispatcher>(),
        Registration::of::<Picker>(),
    ];
    for one in all {
        registry.add(one).unwrap();
    }
    crate::check::events::add(&mut registry);
    crate::check::loop_classes::add(&mut registry);
    registry
}

#[derive(Clone, Debug, Message)]
pub(crate) struct Position {
    x: i32,
    y: i32,
}

#[derive(Clone, Debug, Message)]
#[message(name = "Position")]
pub(crate) struct OtherPosition {
    x: f64,
    y: f64,
}

#[derive(Clone, Debug, Message)]
pub(crate) struct Order {
    block: u32,
}

const POSITION: Topic<Position> = Topic::state("POSTOPIC");
const ORDERS: Topic<Order> = Topic::event("ORDERS");
const SHOUTED: Topic<Position> = Topic::event("POSTOPIC");
const TRACKED: Topic<OtherPosition> = Topic::state("TRACKS");

#[interface(name = "example.Wheels")]
pub(crate) trait Wheels {
    fn r#move(&mut self, context: &mut Context<'_>, blocks: u32) -> Result<bool, Failure>;
}

#[interface(name = "example.Positions")]
pub(crate) trait Positions {
    fn position(&mut self, context: &mut Context<'_>) -> Result<i32, Failure>;
}

mod old {
    use super::*;

    #[interface(name = "example.Positions")]
    pub(crate) trait OldPositions {
        fn position(&mut self, context: &mut Context<'_>) -> Result<f64, Failure>;
    }
}
use old::OldPositions;

macro_rules! component {
    ($name:ident, $properties:ty) => {
        impl Component for $name {
            type Properties = $properties;

            fn new(_: $properties) -> Result<Self, Failure> {
                Ok($name)
            }
        }
    };
}

macro_rules! offers {
    ($name:ident, $interface:ident, $operation:ident($($argument:ident: $of:ty),*) -> $reply:ty) => {
        impl $interface for $name {
            fn $operation(&mut self, _: &mut Context<'_>, $($argument: $of),*) -> Result<$reply, Failure> {
                Err(Failure::new("never called"))
            }
        }
    };
}

#[derive(Debug, PropertyField)]
pub(crate) enum Colour {
    Red,
    Blue,
}

#[derive(Properties)]
#[expect(dead_code, reason = "never executed")]
pub(crate) struct Block {
    x: i32,
    #[property(default = 0, range = 0..=10)]
    y: i32,
}

#[derive(Properties)]
#[expect(dead_code, reason = "never executed")]
pub(crate) struct RobotProperties {
    /// The robot's name.
    #[property(name = "ID", unique = "robot", required_text)]
    id: String,
    /// The number of the robot.
    #[property(range = 1..=99)]
    number: u8,
    /// How fast it drives.
    #[property(default = 1.0, range = 0.0..=2.5, unit = "m/s")]
    speed: f64,
    #[property(default = "blue")]
    colour: Colour,
    #[property(default = true)]
    awake: bool,
    /// Where it charges.
    charger: Option<Block>,
    stops: Vec<u16>,
    #[property(default = "10ms")]
    grace: Duration,
}

/// Drives around.
#[derive(Class)]
#[class(
    name = "example.Robot",
    periodic,
    reacts,
    publishes(POSITION),
    subscribes(POSITION, ORDERS),
    service("move": Wheels),
    reference("gps": Positions, optional),
    also("example.Robot001", number = 1),
    also("robot.Robot001", number = 1),
    also("robot.Robot002", number = 2)
)]
pub(crate) struct Robot;

impl Component for Robot {
    type Properties = RobotProperties;

    fn new(properties: RobotProperties) -> Result<Self, Failure> {
        if properties.speed > 2.0 && matches!(properties.colour, Colour::Red) {
            return Err(Failure::new("a red robot drives at most 2 m/s"));
        }
        if properties.speed == 1.25 {
            return Err(Finding::new(Place::property("speed"), "nobody drives at 1.25 m/s").into());
        }
        Ok(Self)
    }
}

offers!(Robot, Wheels, r#move(_blocks: u32) -> bool);

/// Tells robots where to go.
#[derive(Class)]
#[class(
    name = "example.Navigator",
    passive,
    service("position": Positions),
    reference("wheels": Wheels),
    reference("task": TaskInterface, optional)
)]
pub(crate) struct Navigator;

component!(Navigator, ());
offers!(Navigator, Positions, position() -> i32);

#[derive(Class)]
#[class(name = "example.Gps", passive, service("position": Positions), reference("other": Positions, optional))]
pub(crate) struct Gps;

component!(Gps, ());
offers!(Gps, Positions, position() -> i32);

/// Waits for answers.
#[derive(Class)]
#[class(
    name = "example.Surveyor",
    periodic,
    apart,
    reference("gps": Positions),
    reference("task": TaskInterface, optional)
)]
pub(crate) struct Surveyor;

component!(Surveyor, ());

#[derive(Class)]
#[class(name = "example.OldGps", passive, service("position": OldPositions))]
pub(crate) struct OldGps;

component!(OldGps, ());
offers!(OldGps, OldPositions, position() -> f64);

#[derive(Class)]
#[class(name = "example.Twins", passive, service("left": Wheels), service("right": Wheels))]
pub(crate) struct Twins;

component!(Twins, ());
offers!(Twins, Wheels, r#move(_blocks: u32) -> bool);

/// Does nothing, periodically.
#[derive(Class)]
#[class(name = "example.Clock", periodic)]
pub(crate) struct Clock;

component!(Clock, ());

#[derive(Properties)]
pub(crate) struct BrokerProperties {
    #[property(name = "IP", required_text)]
    address: String,
    #[property(range = 1..=65535)]
    port: u16,
    transport: Option<String>,
    user: Option<String>,
    password: Option<Secret>,
    password_file: Option<String>,
    users: Option<String>,
    /// A user and the topic that this one reads, with a blank between.
    access: Vec<String>,
    tls_certificate: Option<String>,
    tls_key: Option<String>,
    #[property(default = false)]
    unprotected: bool,
}

submit! {
    RouterClass {
        class: "example.Broker",
        router: |values| {
            let given = BrokerProperties::from_values(values)?;
            let transport = given.transport.map(|name| format!("{name}://")).unwrap_or_default();
            let access = given.access.iter().filter_map(|text| text.split_once(' ')).map(|(user, topic)| Access {
                user: user.to_owned(),
                reads: Topics::Some(vec![topic.to_owned()]),
                ..Access::default()
            });
            Ok(Router {
                url: format!("{transport}{}:{}", given.address, given.port),
                access: access.collect(),
                user: given.user,
                password: given.password,
                password_file: given.password_file,
                users: given.users,
                tls: TlsPaths { ca: None, certificate: given.tls_certificate, key: given.tls_key },
                is_unprotected: given.unprotected,
            })
        },
    }
}

#[derive(Class)]
#[class(name = "example.Broker", passive, also("unibg.robotics.tca.MessageBrokerImpl"))]
pub(crate) struct Broker;

component!(Broker, BrokerProperties);

/// Uses the robots' topic for events.
#[derive(Class)]
#[class(name = "example.Shouter", periodic, publishes(SHOUTED))]
pub(crate) struct Shouter;

component!(Shouter, ());

/// Has other ideas of a position.
#[derive(Class)]
#[class(name = "example.Tracker", periodic, publishes(TRACKED))]
pub(crate) struct Tracker;

component!(Tracker, ());

/// Gives orders.
#[derive(Class)]
#[class(name = "example.Dispatcher", periodic, publishes(ORDERS))]
pub(crate) struct Dispatcher;

component!(Dispatcher, ());

/// Takes orders.
#[derive(Class)]
#[class(name = "example.Picker", periodic, subscribes(ORDERS))]
pub(crate) struct Picker;

component!(Picker, ());

/// Tells any number of robots where to go.
#[derive(Class)]
#[class(name = "example.Conductor", passive, reference("wheels": Wheels, optional, many), reference("gps": Positions, many))]
pub(crate) struct Conductor;

component!(Conductor, ());

/// Panics when somebody makes one.
#[derive(Class)]
#[class(name = "example.Fragile", passive)]
pub(crate) struct Fragile;

impl Component for Fragile {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        panic!("do not touch")
    }
}

#[derive(Properties)]
pub(crate) struct ReaderProperties {
    /// What it reads.
    words: Vec<String>,
    /// What it reads aloud.
    title: Option<String>,
}

/// Knows all words but those that begin with `b`.
#[derive(Class)]
#[class(name = "example.Reader", passive)]
pub(crate) struct Reader;

impl Component for Reader {
    type Properties = ReaderProperties;

    fn new(properties: ReaderProperties) -> Result<Self, Failure> {
        let words = properties.words.iter().enumerate().map(|(value, text)| ("words", value, text));
        let mut findings: Vec<Finding> = Vec::new();
        for (property, value, text) in words.chain(properties.title.iter().map(|text| ("title", 0, text))) {
            for word in text.split_whitespace().filter(|word| word.starts_with('b')) {
                let start = word.as_ptr() as usize - text.as_ptr() as usize;
                let place = Place::property(property).part(value, start..start + word.len());
                let mut finding = Finding::new(place, format!("cannot read `{word}`"));
                if word == "b&" {
                    finding = finding.instead("a&").help("begin at the begin");
                }
                if let Some(first) = findings.first() {
                    finding = finding.label(first.place().clone(), "the first");
                }
                findings.push(finding);
            }
        }
        if findings.is_empty() { Ok(Self) } else { Err(Failure::of_findings(findings)) }
    }
}

#[derive(Properties)]
pub(crate) struct BoardProperties {
    #[property(default = 8, range = 1..=100)]
    width: u32,
    #[property(default = 8, range = 1..=100)]
    height: u32,
    /// Where its marks are: `x,y`.
    marks: Vec<String>,
    label: Option<String>,
}

/// Has marks that lie on it.
#[derive(Class)]
#[class(name = "example.Board", periodic)]
pub(crate) struct Board;

impl Component for Board {
    type Properties = BoardProperties;

    fn new(properties: BoardProperties) -> Result<Self, Failure> {
        let BoardProperties { width, height, marks, label } = properties;
        let judge = |text: &String| {
            let (x, y) = text.split_once(',').ok_or("is no mark")?;
            let (x, y): (u32, u32) = (x.parse().map_err(|_| "has no column")?, y.parse().map_err(|_| "has no row")?);
            if x < width && y < height { Ok(()) } else { Err("is beside the board") }
        };
        let judged = marks.iter().enumerate().map(|(place, text)| (place, text, judge(text)));
        let mut findings: Vec<Finding> = judged
            .filter_map(|(place, text, judged): (usize, &String, Result<(), &str>)| {
                let place = Place::property("marks").part(place, 0..text.len());
                Some(Finding::new(place, format!("`{text}` {}", judged.err()?)))
            })
            .collect();
        if label.as_deref() == Some("dark") {
            findings.push(Finding::new(Place::property("label"), "it is too dark"));
        }
        if findings.is_empty() { Ok(Self) } else { Err(Failure::of_findings(findings)) }
    }
}
