//! Components and loops whose fields say what they are: the same declarations, and no word twice.

use saoms_api::host::{Invocation, LoopRegistration, PropertyValue, Registration, TypedCall};
use saoms_api::{
    Adaptation, Class, Component, Context, Effector, Entries, Entry, Extras, Failure, Knowledge, LoopClass, Loops,
    Message, Own, Properties, Publisher, Saved, SimpleLoop, Subscription, Topic, info, interface, record, warn,
};

use super::host::FakeHost;

/// A count.
#[derive(Clone, Debug, PartialEq, Message)]
struct Count {
    number: u32,
}

const COUNT: Topic<Count> = Topic::state("COUNT");
const RESET: Topic<Count> = Topic::event("RESET");

/// The same count, for callers.
#[interface(name = "short.Numbers")]
impl Numbers for Counter {
    /// The number.
    fn number(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        Ok(self.number)
    }
}

/// Counts.
#[derive(Class)]
#[class(name = "short.Counter", periodic, service("numbers": Numbers))]
struct Counter {
    /// Added in each period.
    #[property(default = 1, range = 1..=100, unit = "steps")]
    step: u32,
    #[property]
    names: Vec<String>,
    #[publishes(COUNT)]
    count: Publisher<Count>,
    #[subscribes(RESET)]
    resets: Subscription<Count>,
    #[reference]
    other_numbers: NumbersReference,
    #[reference("spare")]
    optional: Option<NumbersReference>,
    #[reference("more", optional)]
    many: Vec<NumbersReference>,
    number: u32,
}

impl Component for Counter {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.number += self.step;
        let wired = (context.is_wired(&self.other_numbers), self.optional.is_some(), self.many.len());
        info!(context, "counts to {}, {wired:?}", self.number);
        context.info("counts");
        context.warn(format!("{} resets", context.receive(&self.resets).count()));
        warn!(context, "{:?}", self.names);
        context.console(format_args!("{}", self.number));
        context.send(&self.count, Count { number: self.number })
    }
}

/// The long form of the same.
mod long {
    use super::*;

    #[derive(Properties)]
    pub(super) struct CounterProperties {
        /// Added in each period.
        #[property(default = 1, range = 1..=100, unit = "steps")]
        _step: u32,
        _names: Vec<String>,
    }

    /// Counts.
    #[derive(Class)]
    #[class(
        name = "long.Counter",
        periodic,
        service("numbers": Numbers),
        publishes(COUNT),
        subscribes(RESET),
        reference("otherNumbers": Numbers),
        reference("spare": Numbers, optional),
        reference("more": Numbers, optional, many)
    )]
    pub(super) struct LongCounter;

    impl Component for LongCounter {
        type Properties = CounterProperties;

        fn new(_: CounterProperties) -> Result<Self, Failure> {
            Ok(LongCounter)
        }
    }

    impl Numbers for LongCounter {
        fn number(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
            Ok(7)
        }
    }
}

fn value(name: &str, text: &str) -> (saoms_api::host::SmolStr, PropertyValue) {
    (name.into(), PropertyValue::from(text))
}

#[test]
fn fields_declare_the_same_as_attributes_of_the_struct() {
    assert_eq!(
        Counter::DECLARATION,
        <long::LongCounter as Class>::DECLARATION.replace("\"_", "\"").replace("\"long.", "\"short.")
    );
}

#[test]
fn handles_are_bound_before_the_component_begins() {
    let values = [value("step", "5"), value("names", "one")];
    let mut counter = Registration::of::<Counter>().construct(&values).unwrap();
    let mut host = FakeHost::new();
    host.run(|context| counter.initialize(context)).unwrap();
    assert_eq!((host.published.join(" "), host.subscribed.join(" ")), ("COUNT".to_owned(), "RESET".to_owned()));
    host.run(|context| counter.execute(context)).unwrap();
    assert_eq!(host.sent[0].1.get::<Count>(), Some(&Count { number: 5 }));
    let lines =
        ["Info: counts to 5, (false, false, 0)", "Info: counts", "Warning: 0 resets", "Warning: [\"one\"]", "5"];
    assert_eq!(host.lines, lines);
    let mut call = TypedCall::<(), u32>::new(0, ());
    let mut invocation = Invocation { service: "numbers", call: &mut call };
    host.run(|context| counter.serve(&mut invocation, context)).unwrap();
    assert_eq!(call.into_reply(), Ok(5));
    let refused = Registration::of::<Counter>().construct(&[value("step", "500")]).err().unwrap();
    assert!(refused.message().contains("step"), "{refused}");
}

#[test]
fn references_without_targets_are_none_and_those_with_some_are_there() {
    let mut counter = Registration::of::<Counter>().construct(&[]).unwrap();
    let mut host = FakeHost::new();
    host.provider = Some((Registration::of::<Counter>().construct(&[]).unwrap(), "numbers"));
    host.run(|context| counter.initialize(context).and_then(|()| counter.execute(context))).unwrap();
    assert_eq!(host.lines[0], "Info: counts to 1, (true, true, 1)");
}

/// A counter that counts loudly, too, and does nothing else of its own.
#[derive(Class)]
#[class(name = "short.LoudCounter", periodic)]
struct LoudCounter {
    #[extends]
    counter: Remembering,
    /// How loudly.
    #[property(default = 5)]
    volume: u32,
    #[publishes(RESET)]
    resets: Publisher<Count>,
}

impl Component for LoudCounter {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.counter.execute(context)?;
        context.send(&self.resets, Count { number: self.volume })
    }
}

/// What is extended: it says each call.
#[derive(Class)]
#[class(name = "short.Remembering", periodic)]
struct Remembering {
    #[property(default = 3)]
    start: u32,
    #[publishes(COUNT)]
    count: Publisher<Count>,
}

impl Component for Remembering {
    type Properties = Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        info!(context, "starts");
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.send(&self.count, Count { number: self.start })
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        info!(context, "ends");
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Count { number: self.start }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        if let Some(Count { number }) = saved.read()? {
            self.start = number;
        }
        Ok(())
    }

    fn waits_for(&self) -> Option<String> {
        Some("a reset".to_owned())
    }
}

/// Extends it without a word.
#[derive(Class)]
#[class(name = "short.Silent", periodic)]
struct Silent {
    #[extends]
    counter: Remembering,
}

impl Component for Silent {
    type Properties = Own<Self>;
}

#[test]
fn what_an_extending_class_does_not_write_goes_to_what_it_extends() {
    for registration in [Registration::of::<LoudCounter>(), Registration::of::<Silent>()] {
        let mut counter = registration.construct(&[value("start", "8")]).unwrap();
        let mut host = FakeHost::new();
        host.run(|context| counter.initialize(context)).unwrap();
        host.run(|context| counter.execute(context)).unwrap();
        host.run(|context| counter.shutdown(context)).unwrap();
        assert_eq!(host.published[0], "COUNT", "bound once: {:?}", host.published);
        assert_eq!(host.published.iter().filter(|topic| *topic == "COUNT").count(), 1);
        assert_eq!(host.sent[0].1.get::<Count>(), Some(&Count { number: 8 }));
        assert_eq!(host.lines, ["Info: starts", "Info: ends"]);
        assert_eq!(counter.waits_for().unwrap().unwrap(), "a reset");
        let saved = counter.save().unwrap();
        assert_eq!(saved.read::<Count>().unwrap(), Some(Count { number: 8 }));
        counter.restore(&Saved::of(&Count { number: 2 })).unwrap();
        assert_eq!(counter.save().unwrap().read::<Count>().unwrap(), Some(Count { number: 2 }));
    }
    assert_eq!(<Own<LoudCounter> as Properties>::NAMES, ["start", "volume"]);
}

/// What a lamp knows.
#[derive(Default, Knowledge)]
#[knowledge(name = "short.Lamp")]
struct LampKnowledge {
    #[entry]
    brightness: f64,
    #[entry(effector)]
    is_on: bool,
    #[entry(effector)]
    colours: Vec<u8>,
    #[extras]
    extras: Extras,
}

/// Switches a lamp off when it is bright.
#[derive(LoopClass)]
#[looping(name = "short.Dimmer")]
struct Dimmer {
    /// Brightness at which it is bright.
    #[property(default = 10.0, unit = "lx")]
    limit: f64,
    #[senses]
    brightness: Entry<f64>,
    #[effects("isOn")]
    switch: Effector<bool>,
    #[effects]
    colours: Effector<Vec<u8>>,
    /// Number of times that it dimmed.
    #[entry(unit = "times", default = 2)]
    dimmed: Effector<u32>,
    #[publishes(COUNT)]
    count: Publisher<Count>,
}

impl SimpleLoop for Dimmer {
    type Properties = Own<Self>;

    fn adapt(&mut self, lamp: &dyn Knowledge, context: &mut Context<'_>) -> Result<Option<Adaptation>, Failure> {
        let brightness = self.brightness.get(lamp)?;
        if brightness <= self.limit {
            return Ok(None);
        }
        let bright = Adaptation::of(record!(bright: "it is bright: {brightness} lx", brightness));
        if !self.switch.get(lamp)? {
            return Ok(Some(bright));
        }
        let dimmed = self.dimmed.get(lamp)? + 1;
        context.send(&self.count, Count { number: dimmed })?;
        Ok(Some(
            bright
                .decides(record!(off: "switches it off"))
                .sets(&self.switch, false)
                .sets(&self.colours, vec![1, 2])
                .sets(&self.dimmed, dimmed),
        ))
    }
}

mod long_loop {
    use super::*;

    #[derive(Properties)]
    pub(super) struct DimmerProperties {
        /// Brightness at which it is bright.
        #[property(default = 10.0, unit = "lx")]
        _limit: f64,
    }

    #[derive(Entries)]
    struct Dimming {
        /// Number of times that it dimmed.
        #[entry(unit = "times")]
        dimmed: u32,
    }

    impl Default for Dimming {
        fn default() -> Self {
            Dimming { dimmed: 2 }
        }
    }

    /// Switches a lamp off when it is bright.
    #[derive(LoopClass)]
    #[looping(
        name = "long.Dimmer",
        senses("brightness"),
        effects("isOn", "colours"),
        entries(Dimming),
        publishes(COUNT)
    )]
    pub(super) struct LongDimmer;

    impl SimpleLoop for LongDimmer {
        type Properties = DimmerProperties;

        fn new(_: DimmerProperties) -> Result<Self, Failure> {
            Ok(LongDimmer)
        }

        fn adapt(&mut self, _: &dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Adaptation>, Failure> {
            Ok(None)
        }
    }
}

#[test]
fn fields_of_loops_declare_the_same_as_attributes() {
    assert_eq!(
        Dimmer::DECLARATION,
        <long_loop::LongDimmer as LoopClass>::DECLARATION.replace("\"_", "\"").replace("\"long.", "\"short.")
    );
}

/// A lamp: its loops are all that it does.
#[derive(Class)]
#[class(name = "short.Lamp", periodic, loops(Dimmer))]
struct Lamp {
    #[property(default = 1.0)]
    brightness: f64,
    #[knowledge]
    knowledge: LampKnowledge,
    #[loops]
    loops: Loops,
}

impl Component for Lamp {
    type Properties = Own<Self>;

    fn new(properties: Own<Self>) -> Result<Self, Failure> {
        let mut lamp = Self::made(properties)?;
        (lamp.knowledge.brightness, lamp.knowledge.is_on) = (lamp.brightness, true);
        Ok(lamp)
    }
}

#[test]
fn a_component_can_be_its_loops_alone_and_a_loop_one_function() {
    let mut host = FakeHost::new();
    static LOOPS: &[(&str, LoopRegistration)] = &[("Dimmer", LoopRegistration::of::<Dimmer>())];
    host.loops = LOOPS;
    let mut lamp = Registration::of::<Lamp>().construct(&[value("brightness", "20")]).unwrap();
    host.run(|context| lamp.initialize(context)).unwrap();
    for _ in 0..2 {
        host.run(|context| lamp.execute(context)).unwrap();
    }
    host.run(|context| lamp.shutdown(context)).unwrap();
    let journal = [
        "Symptom: it is bright: 20 lx", "Decision: switches it off", "isOn: yes -> no", "dimmed: 2 -> 3",
        "Symptom: it is bright: 20 lx",
    ];
    assert_eq!(host.journal, journal);
    assert_eq!(host.sent.len(), 1);
}
