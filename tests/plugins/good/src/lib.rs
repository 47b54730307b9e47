//! Does all as it should.

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Class, Component, Context, Failure, Finding, Message, Place, Properties, Publisher, Subscription, Topic, interface};

/// A measurement of a sender.
#[derive(Clone, Debug, Message)]
#[message(key = "number")]
pub struct Reading {
    number: u32,
    values: Vec<f64>,
    text: String,
}

const READINGS: Topic<Reading> = Topic::event("READINGS");

/// The map, as the world of the fleet says it; a type of this library's own with the same schema.
#[derive(Clone, Debug, Message)]
pub struct Area {
    width: u32,
    height: u32,
    blocked: Vec<u64>,
}

const AREA: Topic<Area> = Topic::state("AREATOPIC");

/// Doubles.
#[interface(name = "good.Doubler")]
pub trait Doubler {
    /// Twice the number.
    fn double(&mut self, context: &mut Context<'_>, number: u32) -> Result<u32, Failure>;
}

#[derive(Debug, Properties)]
pub struct SenderProperties {
    /// Written as `least to most`.
    #[property(default = "0 to 9")]
    limits: String,
}

/// Sends a reading in each period.
#[derive(Debug, Class)]
#[class(name = "good.Sender", periodic, publishes(READINGS), reference("doubler": Doubler, optional))]
pub struct Sender {
    readings: Publisher<Reading>,
    doubler: DoublerReference,
}

impl Component for Sender {
    type Properties = SenderProperties;

    fn new(properties: SenderProperties) -> Result<Self, Failure> {
        let limits = &properties.limits;
        let wrong = |part: &str, start| {
            part.parse::<u32>().err().map(|_| {
                let place = Place::property("limits").part(0, start..start + part.len());
                Finding::new(place, format!("found `{part}`, expected a number")).instead("1")
            })
        };
        let Some((least, most)) = limits.split_once(" to ") else {
            return Err("property `limits`: expected `least to most`".into());
        };
        let wrong: Vec<Finding> =
            [wrong(least, 0), wrong(most, limits.len() - most.len())].into_iter().flatten().collect();
        if !wrong.is_empty() {
            return Err(Failure::of_findings(wrong));
        }
        Ok(Sender { readings: Publisher::default(), doubler: DoublerReference::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.readings = context.publish(&READINGS)?;
        self.doubler = context.reference("doubler")?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let mut number = u32::try_from(context.execution()).unwrap_or(0);
        if context.is_wired(&self.doubler) {
            number = self.doubler.double(context, number)?;
        }
        let reading = Reading { number, values: vec![0.5; 14], text: "ü".to_owned() };
        context.send(&self.readings, reading)
    }
}

/// Counts readings.
#[derive(Debug, Class)]
#[class(name = "good.Reader", periodic, subscribes(READINGS, AREA), service("doubler": Doubler))]
pub struct Reader {
    readings: Subscription<Reading>,
    area: Subscription<Area>,
}

impl Component for Reader {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Reader { readings: Subscription::default(), area: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.readings = context.subscribe(&READINGS)?;
        self.area = context.subscribe(&AREA)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for reading in context.receive(&self.readings) {
            context.count("readings.heard", 1);
            context.count("readings.sum", i64::from(reading.number));
            if reading.values.iter().sum::<f64>() != 7.0 || reading.text != "ü" {
                return Err(format!("found {reading:?}").into());
            }
        }
        for area in context.receive(&self.area) {
            context.count("area.width", i64::from(area.width));
            context.count(
                "area.blocked",
                i64::from(area.blocked.iter().map(|row| row.count_ones()).sum::<u32>()),
            );
        }
        Ok(())
    }
}

impl Doubler for Reader {
    fn double(&mut self, _: &mut Context<'_>, number: u32) -> Result<u32, Failure> {
        Ok(2 * number)
    }
}

fn one_sender(fleet: &FleetView<'_>) -> Vec<Finding> {
    let senders: Vec<usize> = fleet.all::<Sender>().map(|(index, _)| index).collect();
    let [first, more @ ..] = &senders[..] else { return Vec::new() };
    more.iter()
        .map(|one| {
            Finding::new(Place::component(*one), "this is one more sender")
                .label(Place::component(*first), "the first")
                .help("keep one")
        })
        .collect()
}

static ONE_SENDER: FleetRule = FleetRule {
    code: Code {
        id: "X0001",
        name: "one-sender",
        meaning: "A fleet has several senders.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check: one_sender,
};

#[derive(Clone, Copy, Debug, saoms_api::Field)]
#[field(pair)]
struct Spot {
    x: i32,
    y: i32,
}

#[derive(Clone, Debug, Message)]
#[message(key = "number", place = "spot")]
struct Spotted {
    number: u32,
    spot: Spot,
}

const SPOTTED: Topic<Spotted> = Topic::state("SPOTTED");

/// Moves by a block in each execution, and sees itself within a block around (3,0).
#[derive(Class)]
#[class(name = "good.Spotter", periodic)]
pub struct Spotter {
    #[publishes(SPOTTED)]
    publisher: Publisher<Spotted>,
    #[subscribes(SPOTTED)]
    spotted: Subscription<Spotted>,
}

impl Component for Spotter {
    type Properties = ();

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.set_region(&self.spotted, Some(saoms_api::Region::around((3, 0), 1)))
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let seen: Vec<i32> = context.receive(&self.spotted).map(|message| message.spot.x).collect();
        let departed = context.departed(&self.spotted).to_vec();
        context.info(format!("sees {seen:?}, {departed:?}"));
        let spot = Spot { x: context.execution() as i32, y: 0 };
        context.send(&self.publisher, Spotted { number: 7, spot })
    }
}

#[derive(Clone, Debug, Message)]
struct Count {
    count: u32,
}

/// Counts in steps, keeps the number, and goes on from it after a failure.
#[derive(Class)]
#[class(name = "good.Keeper", periodic, saves)]
pub struct Keeper {
    /// Step of the count; 8 is refused.
    #[property(default = 1, range = 1..=10, live)]
    step: u32,
    /// The count at which it fails once.
    #[property(default = 0)]
    fails_at: u32,
    count: u32,
    has_failed: bool,
}

impl Component for Keeper {
    type Properties = saoms_api::Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.has_failed = !context.kept().is_empty();
        context.info(format!("kept {:?}", context.kept()));
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.count += self.step;
        if self.count == self.fails_at && !self.has_failed {
            return Err("once".into());
        }
        context.keep(7, &[self.count as u8, 0xff])?;
        context.keep(8, &[])?;
        context.info(format!("counts {}", self.count));
        Ok(())
    }

    fn update(&mut self, properties: saoms_api::Own<Self>) -> Result<(), Failure> {
        if properties.step == 8 {
            return Err("not eight".into());
        }
        self.step = properties.step;
        Ok(())
    }

    fn save(&mut self) -> Result<saoms_api::Saved, Failure> {
        Ok(saoms_api::Saved::of(&Count { count: self.count }))
    }

    fn restore(&mut self, saved: &saoms_api::Saved) -> Result<(), Failure> {
        self.count = saved.read::<Count>()?.map_or(0, |count| count.count);
        Ok(())
    }
}

saoms_api::plugin! {
    classes: [Sender, Reader, Keeper, Spotter],
    rules: [ONE_SENDER],
}
