//! Components and loops behave the same behind the boundary to plugins as without it.

use saoms_api::boundary::{class_table, loop_class_table, rule_table};
use saoms_api::host::contain::contained;
use saoms_api::host::present::Owner;
use saoms_api::host::{
    DynComponent, DynLoop, Invocation, LoopRegistration, PropertyValue, Registration, SharedMessage, SmolStr, TypedCall,
};
use saoms_api::rule::{ClassView, Code, ComponentView, FleetRule, FleetView, Severity};
use saoms_api::{
    CallError, Cause, Class, Component, Context, Effector, Entries, Entry, Extras, Failure, Field, Finding, Header,
    Knowledge, Level, Loop, LoopClass, Loops, Message, Place, Properties, Publisher, Record, ReportValue, Subscription,
    Time, Topic, Work, interface, record,
};
use saoms_core::plugin::{ImportedClass, ImportedLoopClass, ImportedRule};

use std::rc::Rc;
use std::time::Duration;

use super::host::FakeHost;

/// A measured value.
#[derive(Clone, Debug, Default, PartialEq, Message)]
#[message(key = "robot")]
struct Sample {
    robot: u32,
    values: Vec<f64>,
    text: String,
}

const SAMPLES: Topic<Sample> = Topic::state("SAMPLES");

/// Adds.
#[interface(name = "test.Adder")]
trait Adder {
    /// Adds two numbers, unless they are equal.
    fn add(&mut self, context: &mut Context<'_>, one: u32, other: u32) -> Result<u32, Failure>;
}

#[derive(Debug, Properties)]
#[expect(dead_code, reason = "the log shows them")]
struct Part {
    name: String,
    weight: Option<f64>,
}

#[derive(Debug, Properties)]
#[expect(dead_code, reason = "the log shows them")]
struct BusyProperties {
    /// The function in which it panics.
    #[property(default = "nowhere")]
    panics: String,
    parts: Vec<Part>,
    names: Vec<String>,
}

/// Does everything that a context offers.
#[derive(Debug, Class)]
#[class(name = "test.Busy", periodic, publishes(SAMPLES), subscribes(SAMPLES), service("adder": Adder), reference("adder": Adder))]
struct Busy {
    properties: BusyProperties,
    samples: Publisher<Sample>,
    heard: Subscription<Sample>,
    adder: AdderReference,
}

impl Busy {
    fn panic_in(&self, place: &str) {
        assert!(self.properties.panics != place, "no more of {place}");
    }

    fn find_busy(&self) -> Result<(), Failure> {
        match self.properties.panics.strip_prefix("finds busy ") {
            Some(provider) => Err(CallError::Busy { provider: provider.to_owned() }.into()),
            None => Ok(()),
        }
    }
}

impl Component for Busy {
    type Properties = BusyProperties;

    fn new(properties: BusyProperties) -> Result<Self, Failure> {
        assert!(properties.panics != "new", "no more of new");
        if properties.panics == "refuses" {
            return Err("property `panics`: refused".into());
        }
        if properties.panics == "finds" {
            let first = Finding::new(Place::property("names").part(1, 0..2), "one").help("a").help("b").instead("");
            return Err(Failure::of_findings(vec![
                first.label(Place::default(), "here"),
                Finding::new(Place::default(), "two"),
            ]));
        }
        let (samples, heard) = (Publisher::default(), Subscription::default());
        Ok(Busy { properties, samples, heard, adder: AdderReference::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.panic_in("initialize");
        self.samples = context.publish(&SAMPLES)?;
        self.heard = context.subscribe(&SAMPLES)?;
        self.adder = context.reference("adder")?;
        let (name, properties) = (context.name().to_owned(), format!("{:?}", self.properties));
        context.info(format_args!("{name} {properties} {}", context.is_wired(&self.adder)));
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.panic_in("execute");
        self.find_busy()?;
        let times = (context.now(), context.due(), context.execution(), context.period(), context.date());
        let (cancelled, random, cause) = (context.cancelled(), context.chance().next_u64(), context.cause());
        context.log(Level::Debug, format_args!("{times:?} {cancelled} {random} {cause:?}"));
        context.console(format_args!("{}", "é".repeat(300)));
        for (header, sample) in context.receive(&self.heard).with_headers() {
            context.info(format_args!("{header:?} {sample:?}"));
            context.send(&self.samples, Sample { robot: sample.robot + 1, ..sample.clone() })?;
        }
        let sum = self.adder.add(context, 2, 3);
        let refused = self.adder.add(context, 1, 1);
        context.info(format_args!("{sum:?} {refused:?}"));
        context.report(
            "a.b",
            ReportValue::Map(vec![
                ("list".to_owned(), ReportValue::List(vec![1.into(), 0.5.into(), "text".into(), ReportValue::Null])),
                ("map".to_owned(), ReportValue::Map(vec![("yes".to_owned(), true.into())])),
            ]),
        );
        let raised = (context.raise("fire size=2 to Hall\u{fc}"), context.raise("flood"));
        context.info(format_args!("{raised:?}"));
        context.alert("assistance", 7, "needs \u{e9}");
        context.alert("empty", "", "");
        context.alert_over("assistance", 7);
        context.count("a.c", -3);
        context.vote(Work::GivenUp);
        context.vote(Work::Done);
        context.effect(record!("drove {way} blocks to {to}, {done}", way = 3, to = (1, -2), done = true));
        Ok(())
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.panic_in("shutdown");
        context.send(&Publisher::default(), Sample::default())
    }

    fn waits_for(&self) -> Option<String> {
        self.panic_in("waits_for");
        Some("a sample, or two".to_owned())
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        self.panic_in("status");
        let list = ReportValue::List(vec![1.into(), (-0.5).into(), "a \"ü\"\n".into(), ReportValue::Null]);
        ReportValue::named([("list", list), ("level", 80.0.into()), ("on", true.into())])
    }
}

impl Adder for Busy {
    fn add(&mut self, _: &mut Context<'_>, one: u32, other: u32) -> Result<u32, Failure> {
        self.panic_in("add");
        self.find_busy()?;
        if one == other { Err("they are equal".into()) } else { Ok(one + other) }
    }
}

fn linked(values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
    Registration::of::<Busy>().construct(values)
}

fn imported(values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
    // SAFETY: the functions of the tables are this crate's own.
    unsafe { ImportedClass::new(&class_table::<Busy>(), "test") }.construct(values)
}

type Construct = fn(&[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure>;

fn values(panics: &str) -> Vec<(SmolStr, PropertyValue)> {
    let text = |text: &str| PropertyValue::from(text);
    let part =
        |name, weight| PropertyValue::Complex([("name".into(), text(name)), ("weight".into(), text(weight))].into());
    vec![
        ("panics".into(), text(panics)),
        ("parts".into(), PropertyValue::Many([part("arm", "1.5"), part("leg", "2")].into())),
        ("names".into(), PropertyValue::Many([text(""), text("ü")].into())),
    ]
}

/// Everything that the component does with its host, and what the host hears of it.
fn played(construct: Construct) -> String {
    let mut host = FakeHost::new();
    host.provider = Some((construct(&values("nowhere")).unwrap(), "adder"));
    let mut busy = construct(&values("nowhere")).unwrap();
    let mut results = vec![busy.initialize(&mut Context::new(&mut host, &[]))];
    let header = Header { sender: 9, sent: Time::from_nanos(7), cause: Cause(5) };
    let message = |robot| SharedMessage::new(header, Sample { robot, values: vec![0.5; 3], text: "text".to_owned() });
    for inboxes in [vec![vec![]], vec![vec![message(1), message(2)]], vec![vec![message(3)]], vec![]] {
        results.push(busy.execute(&mut Context::new(&mut host, &inboxes)));
    }
    let waits_for = busy.waits_for();
    assert_eq!(waits_for, Ok(Some("a sample, or two".to_owned())));
    let mut status = busy.status().unwrap();
    // Names of a JSON object have no order.
    status.sort_by(|one, other| one.0.cmp(&other.0));
    host.lines.push(format!("{status:?}"));
    results.push(busy.shutdown(&mut Context::new(&mut host, &[])));
    let sent: Vec<_> =
        host.sent.iter().map(|(place, message)| (*place, message.header(), message.key(), message.bytes())).collect();
    format!(
        "{results:#?} {sent:?} {:#?} {:#?} {:?} {:#?} {:?} {:?}",
        host.lines, host.report, host.votes, host.journal, host.published, host.subscribed
    )
}

#[test]
fn a_component_does_the_same_behind_the_boundary() {
    let expected = played(linked);
    assert!(expected.contains("drove 3 blocks to (1,-2), yes") && expected.contains("they are equal"), "{expected}");
    assert_eq!(played(imported), expected);
}

#[test]
fn panics_and_refusals_are_failures() {
    let failure = |panics: &str| imported(&values(panics)).map(drop).unwrap_err().to_string();
    assert_eq!(failure("refuses"), "property `panics`: refused");
    assert!(failure("new").ends_with("no more of new"), "{}", failure("new"));
    let finds = [linked, imported].map(|construct: Construct| construct(&values("finds")).map(drop).unwrap_err());
    assert_eq!(finds[0].findings().len(), 2);
    assert_eq!(finds[1], finds[0]);
    let mut host = FakeHost::new();
    let mut fails = |place: &str| {
        let mut busy = imported(&values(place)).unwrap();
        let mut context = Context::new(&mut host, &[]);
        // A panic goes on on this side, as that of linked code.
        let results = [
            contained(|| busy.initialize(&mut context)),
            contained(|| busy.execute(&mut context)),
            contained(|| busy.shutdown(&mut context)),
        ];
        results.into_iter().filter_map(Result::err).map(|failure| failure.to_string()).collect::<Vec<_>>()
    };
    for place in ["initialize", "execute", "shutdown"] {
        assert!(fails(place).iter().any(|failure| failure.ends_with(&format!("no more of {place}"))), "{place}");
    }
    let mut busy = imported(&values("add")).unwrap();
    let mut call = TypedCall::<(u32, u32), u32>::new(0, (1, 2));
    let mut invocation = Invocation { service: "adder", call: &mut call };
    let error = contained(|| busy.serve(&mut invocation, &mut Context::new(&mut host, &[]))).unwrap_err();
    assert!(error.message().ends_with("no more of add"), "{error}");
    let mut call = TypedCall::<(u32, u32), u32>::new(7, (1, 2));
    let error = busy.serve(&mut Invocation { service: "adder", call: &mut call }, &mut Context::new(&mut host, &[]));
    assert!(matches!(error, Err(CallError::Mismatch { .. })), "{error:?}");
}

#[test]
fn that_a_provider_is_busy_goes_through_executions_and_calls() {
    for construct in [linked, imported] as [Construct; 2] {
        let mut host = FakeHost::new();
        let mut busy = construct(&values("finds busy Wheels1")).unwrap();
        let failure = busy.execute(&mut Context::new(&mut host, &[])).unwrap_err();
        assert_eq!(failure.busy_provider(), Some("Wheels1"));
        assert_eq!(failure.message(), "component `Wheels1` is in the middle of an execution and cannot be called");
        let mut call = TypedCall::<(u32, u32), u32>::new(0, (1, 2));
        let mut invocation = Invocation { service: "adder", call: &mut call };
        let error = busy.serve(&mut invocation, &mut Context::new(&mut host, &[])).unwrap_err();
        assert_eq!(error, CallError::Busy { provider: "Wheels1".to_owned() });
    }
}

/// Knowledge of a lamp.
#[derive(Default, Knowledge)]
#[knowledge(name = "test.Lamp")]
struct LampKnowledge {
    /// Brightness.
    #[entry]
    brightness: f64,
    /// True if it is on.
    #[entry(effector)]
    is_on: bool,
    /// The last received text.
    #[entry]
    told: Vec<String>,
    #[extras]
    extras: Extras,
}

/// Memory of a dimmer.
#[derive(Default, Entries)]
struct Dimming {
    /// Number of times that it dimmed.
    #[entry]
    dimmed: u32,
    /// The colours it saw.
    #[entry]
    colours: Vec<Colour>,
}

#[derive(Clone, Debug, PartialEq, Field)]
struct Colour {
    red: u8,
}

#[derive(Properties)]
struct DimmerProperties {
    #[property(default = 10.0)]
    limit: f64,
    #[property(default = false)]
    panics: bool,
}

/// Switches a lamp off when it is bright.
#[derive(LoopClass)]
#[looping(name = "test.Dimmer", senses("brightness"), effects("isOn", "told"), entries(Dimming), subscribes(SAMPLES))]
struct Dimmer {
    properties: DimmerProperties,
    brightness: Entry<f64>,
    is_on: Effector<bool>,
    told: Effector<Vec<String>>,
    dimmed: Effector<u32>,
    samples: Subscription<Sample>,
    heard: usize,
}

impl Loop for Dimmer {
    type Properties = DimmerProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new(properties: DimmerProperties) -> Result<Self, Failure> {
        let (brightness, is_on, told, dimmed) = Default::default();
        Ok(Dimmer { properties, brightness, is_on, told, dimmed, samples: Subscription::default(), heard: 0 })
    }

    fn initialize(&mut self, knowledge: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.samples = context.subscribe(&SAMPLES)?;
        self.brightness = knowledge.entry("brightness")?;
        self.is_on = knowledge.effector("isOn")?;
        self.told = knowledge.effector("told")?;
        self.dimmed = knowledge.effector("dimmed")?;
        let failures = [
            knowledge.effector::<f64>("brightness").map(drop),
            knowledge.entry::<bool>("brightnes").map(drop),
            knowledge.entry::<bool>("brightness").map(drop),
        ];
        context.info(format_args!("{failures:?}"));
        Ok(())
    }

    fn monitor(&mut self, _: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        self.heard += context.receive(&self.samples).count();
        Ok(())
    }

    fn analyze(&mut self, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        assert!(!self.properties.panics, "too bright");
        let brightness = self.brightness.get(knowledge)?;
        let (heard, text) = (self.heard, format!("more than {}", self.properties.limit));
        let bright = || {
            record!(
                "{brightness} lx, {heard} heard, {text}, {long}",
                brightness,
                heard,
                text = &text,
                long = text.repeat(9)
            )
        };
        Ok((brightness > self.properties.limit).then(bright))
    }

    fn plan(
        &mut self,
        _: Record,
        knowledge: &mut dyn Knowledge,
        _: &mut Context<'_>,
    ) -> Result<Option<Record>, Failure> {
        Ok(self.is_on.get(knowledge)?.then(|| record!("switches it off")))
    }

    fn execute(&mut self, _: Record, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        let mut told = self.told.get(knowledge)?;
        told.push("off".to_owned());
        self.told.set(knowledge, told)?;
        let dimmed = self.dimmed.get(knowledge)? + 1;
        self.dimmed.set(knowledge, dimmed)?;
        self.is_on.set(knowledge, false)
    }
}

fn dimmed(dimmer: Box<dyn DynLoop>) -> String {
    let mut host = FakeHost::new();
    let mut lamp = LampKnowledge { brightness: 5.0, ..LampKnowledge::default() };
    let mut loops = Loops::of([("Dimmer".to_owned(), dimmer)]);
    let message =
        SharedMessage::new(Header { sender: 9, sent: Time::from_nanos(7), cause: Cause(5) }, Sample::default());
    let inboxes = [vec![message]];
    let mut results = vec![loops.initialize(&mut lamp, &mut Context::new(&mut host, &[]))];
    for (brightness, is_on) in [(5.0, true), (20.0, false), (20.0, true), (30.0, true)] {
        (lamp.brightness, lamp.is_on) = (brightness, is_on);
        let mut context = Context::new(&mut host, &inboxes);
        results.push(loops.monitor(&mut lamp, &mut context));
        results.push(loops.adapt(&mut lamp, &mut context));
    }
    let known: &dyn Knowledge = &lamp;
    let dimmed = known.entry::<u32>("dimmed").and_then(|dimmed| dimmed.get(known));
    let colours = known.entry::<Vec<Colour>>("colours").and_then(|colours| colours.get(known));
    results.push(loops.shutdown(&mut lamp, &mut Context::new(&mut host, &[])));
    format!("{results:?} {:#?} {:#?} {:?} {dimmed:?} {colours:?}", host.lines, host.journal, lamp.told)
}

#[test]
fn a_loop_does_the_same_behind_the_boundary() {
    let expected = dimmed(LoopRegistration::of::<Dimmer>().construct(&[]).unwrap());
    assert!(expected.contains("\"isOn: yes -> no\"") && expected.contains("Ok(2)"), "{expected}");
    assert!(expected.contains(&format!("more than 10, {}", "more than 10".repeat(9))), "{expected}");
    // SAFETY: the functions of the tables are this crate's own.
    let imported = unsafe { ImportedLoopClass::new(&loop_class_table::<Dimmer>(), "test") };
    assert_eq!(dimmed(imported.construct(&[]).unwrap()), expected);
    let panics = [("panics".into(), "true".into())];
    let text = dimmed(imported.construct(&panics).unwrap());
    assert!(text.contains("too bright"), "{text}");
}

/// Says all that it sees.
fn shown(fleet: &FleetView<'_>) -> Vec<Finding> {
    assert!(fleet.components().len() < 3, "too many");
    let place = Place::property("names").in_component(1).part(0, 3..4);
    let misses = fleet.misses::<Busy>();
    vec![
        Finding::new(place.clone(), format!("{:?} {misses}", fleet.components())).severity(Severity::Note),
        Finding::new(Place::component(0), "text").label(place, "more").help("help").instead("less"),
    ]
}

static SHOWN: FleetRule = FleetRule {
    code: Code { id: "X0001", name: "shown", meaning: "", severity: Severity::Warning, rule: None },
    judges_parts: true,
    prevents_start: false,
    check: shown,
};

#[test]
fn a_rule_finds_the_same_behind_the_boundary() {
    let values = values("nowhere");
    let class = ClassView {
        name: "test.Busy",
        declaration: Busy::DECLARATION,
        extends: vec!["{}", "{1}"],
        publishes: vec!["A", "B"],
        subscribes: Vec::new(),
        loops: vec!["test.Dimmer"],
        takes: Vec::new(),
    };
    let one = ComponentView {
        path: "hall/robot",
        class: Rc::new(class.clone()),
        values: &values,
        period: Some(Duration::from_millis(50)),
        starts: true,
        restarts: false,
        node: "",
        has_broker: true,
        renamed: &[("A", "a"), ("B", "b")],
        wires: &[("adder", 1)],
    };
    let class = Rc::new(ClassView { publishes: Vec::new(), ..class });
    let other = ComponentView {
        class,
        period: None,
        starts: false,
        has_broker: false,
        renamed: &[],
        values: &[],
        ..one.clone()
    };
    // SAFETY: the function of the table is this crate's own.
    let imported = unsafe { ImportedRule::new(rule_table(&SHOWN), Owner::of("rule", "test")) };
    for missing in
        [vec![], vec![Some(vec!["{}"])], vec![None, Some(vec!["{}"])], vec![Some(vec!["{}", Busy::DECLARATION])]]
    {
        let components = [one.clone(), other.clone()];
        let fleet = FleetView::new(&components).without(&missing);
        assert_eq!(imported.check(&fleet).unwrap(), shown(&fleet));
    }
    let components = [one.clone(), one.clone(), one];
    let failure = imported.check(&FleetView::new(&components)).unwrap_err();
    assert!(failure.message().ends_with("too many"), "{failure}");
}
