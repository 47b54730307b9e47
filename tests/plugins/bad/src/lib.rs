//! A plugin that misbehaves as its properties say.

mod acts;

use std::panic::panic_any;

use acts::{Nasty, act};
use saoms_api::{
    Class, Component, Context, Effector, Entry, Extras, Failure, Knowledge, Loop, LoopClass, Loops, Message,
    Properties, Publisher, Record, ReportValue, Saved, StopFunction, Subscription, Topic, interface, record,
};

/// A message.
#[derive(Clone, Debug, Message)]
pub struct Word {
    text: String,
}

/// A message that panics whenever one of it is dropped.
#[derive(Clone, Debug, Message)]
pub struct Grenade {
    armed: bool,
    pin: String,
}

impl Drop for Grenade {
    fn drop(&mut self) {
        if self.armed {
            panic_any(Nasty(2));
        }
    }
}

const WORDS: Topic<Word> = Topic::event("WORDS");
const GRENADES: Topic<Grenade> = Topic::event("GRENADES");
const NEWEST: Topic<Grenade> = Topic::state("NEWEST");
const SECRETS: Topic<Word> = Topic::event("SECRETS");

/// Can be called.
#[interface(name = "bad.Callee")]
pub trait Callee {
    /// Answers.
    fn call(&mut self, context: &mut Context<'_>) -> Result<u32, Failure>;
}

#[derive(Debug, Properties)]
pub struct ActorProperties {
    /// The operation in which it misbehaves.
    #[property(default = "")]
    at: String,
    /// The way it misbehaves.
    #[property(default = "panic")]
    does: String,
}

impl ActorProperties {
    fn act(&self, place: &str) -> Result<(), Failure> {
        if self.at != place {
            return Ok(());
        }
        act(&self.does, place)
    }
}

/// Does it in one of its functions.
#[derive(Debug, Class)]
#[class(name = "bad.Actor", periodic, publishes(WORDS, GRENADES, NEWEST), subscribes(WORDS, GRENADES, NEWEST), service("callee": Callee), reference("callee": Callee, optional))]
pub struct Actor {
    properties: ActorProperties,
    said: Publisher<Word>,
    heard: Subscription<Word>,
    thrown: (Publisher<Grenade>, Publisher<Grenade>),
    caught: (Subscription<Grenade>, Subscription<Grenade>),
    callee: CalleeReference,
}

impl Actor {
    /// Sends messages that cannot be dropped, and reads them.
    fn throw(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let armed = |caught: &Subscription<Grenade>| context.receive(caught).filter(|one| one.armed).count();
        let caught = armed(&self.caught.0) + armed(&self.caught.1);
        context.count("bad.caught", caught as i64);
        let grenade = || Grenade { armed: true, pin: "a text that is longer than the others".to_owned() };
        context.send(&self.thrown.0, grenade())?;
        context.send(&self.thrown.1, grenade())
    }

    /// Says numbers that are none.
    fn say_no_numbers(context: &mut Context<'_>) {
        for number in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, f64::MIN_POSITIVE / 2.0] {
            context.symptom(record!(odd: "sees {number} and {half}", number, half = number as f32));
            context.effect(record!(odd_effect: "does {number}", number));
            context.report(&format!("bad.odd.n{}", number.to_bits()), number);
        }
    }
}

impl Component for Actor {
    type Properties = ActorProperties;

    fn new(properties: ActorProperties) -> Result<Self, Failure> {
        properties.act("new")?;
        let (said, heard, callee) = Default::default();
        let (thrown, caught) = Default::default();
        Ok(Actor { properties, said, heard, thrown, caught, callee })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.act("initialize")?;
        self.said = context.publish(&WORDS)?;
        self.heard = context.subscribe(&WORDS)?;
        self.thrown = (context.publish(&GRENADES)?, context.publish(&NEWEST)?);
        self.caught = (context.subscribe(&GRENADES)?, context.subscribe(&NEWEST)?);
        self.callee = context.reference("callee")?;
        if self.properties.at == "undeclared" {
            context.publish(&SECRETS)?;
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.receive(&self.heard).count() > 0 {
            self.properties.act("receive")?;
        }
        if context.execution() == 3 {
            self.properties.act("execute")?;
        }
        if context.is_wired(&self.callee) && context.execution() > 1 {
            self.callee.call(context)?;
        }
        match &*self.properties.at {
            "message" => self.throw(context)?,
            "numbers" => Self::say_no_numbers(context),
            "alert" => {
                context.alert("jam", "left", "the left belt jams");
                context.alert("jam", "right", format_args!("the {} belt jams", "right"));
                context.alert_over("jam", "right");
            }
            _ => {}
        }
        context.count("bad.executions", 1);
        context.send(&self.said, Word { text: "word".to_owned() })
    }

    fn shutdown(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.act("shutdown")?;
        Ok(())
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        ReportValue::named([("most", f64::INFINITY.into()), ("none", f64::NAN.into())])
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        self.properties.act("save")?;
        Ok(Saved::default())
    }

    fn restore(&mut self, _: &Saved) -> Result<(), Failure> {
        self.properties.act("restore")?;
        Ok(())
    }
}

impl Callee for Actor {
    fn call(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        self.properties.act("serve")?;
        Ok(1)
    }
}

impl Drop for Actor {
    fn drop(&mut self) {
        let _ = self.properties.act("drop");
    }
}

/// Does it in a function that few classes have.
#[derive(Debug, Class)]
#[class(name = "bad.Motor", periodic, reacts, stops, saves, publishes(WORDS), subscribes(WORDS))]
pub struct Motor {
    properties: MotorProperties,
    said: Publisher<Word>,
    heard: Subscription<Word>,
}

#[derive(Debug, Properties)]
pub struct MotorProperties {
    #[property(flatten)]
    acts: ActorProperties,
    /// Can change.
    #[property(default = 0, live)]
    speed: u32,
}

impl Component for Motor {
    type Properties = MotorProperties;

    fn new(properties: MotorProperties) -> Result<Self, Failure> {
        Ok(Motor { properties, said: Publisher::default(), heard: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.said = context.publish(&WORDS)?;
        self.heard = context.subscribe(&WORDS)?;
        let acts = || (self.properties.acts.at.clone(), self.properties.acts.does.clone());
        let in_place = |(at, does): &(String, String), place: &str| if at == place { act(does, place) } else { Ok(()) };
        let (stops, beats) = (acts(), acts());
        let stop = StopFunction::new(move || in_place(&stops, "stop"));
        context.register_stop(stop.with_heartbeat(move |_| drop(in_place(&beats, "heartbeat"))))
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.properties.acts.at == "unsubscribe" && self.properties.speed == 0 {
            self.heard = Subscription::default();
        }
        match &*self.properties.acts.at {
            "unschedule" => context.unschedule()?,
            "raise" => context.raise("nothing")?,
            _ => {}
        }
        if context.execution() == 5 {
            self.properties.acts.act("late")?;
        }
        context.send(&self.said, Word { text: "word".to_owned() })
    }

    fn react(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.acts.act("react")
    }

    fn update(&mut self, properties: MotorProperties) -> Result<(), Failure> {
        self.properties.acts.act("update")?;
        self.properties = properties;
        Ok(())
    }

    fn waits_for(&self) -> Option<String> {
        self.properties.acts.act("waits_for").err().map(|failure| failure.to_string())
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        let _ = self.properties.acts.act("status");
        Vec::new()
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        self.properties.acts.act("save")?;
        Ok(Saved::default())
    }

    fn restore(&mut self, _: &Saved) -> Result<(), Failure> {
        self.properties.acts.act("restore")
    }
}

/// The knowledge of a lamp.
#[derive(Debug, Default, Knowledge)]
#[knowledge(name = "bad.Lamp")]
pub struct LampKnowledge {
    /// Its brightness.
    #[entry(effector)]
    brightness: u32,
    #[extras]
    extras: Extras,
}

/// Has loops.
#[derive(Class)]
#[class(name = "bad.Lamp", periodic, knowledge = LampKnowledge, loops(Switch))]
pub struct Lamp {
    knowledge: LampKnowledge,
    loops: Loops,
}

impl Component for Lamp {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Lamp { knowledge: LampKnowledge::default(), loops: Loops::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops = context.loops()?;
        self.loops.initialize(&mut self.knowledge, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.monitor(&mut self.knowledge, context)?;
        self.loops.adapt(&mut self.knowledge, context)
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.shutdown(&mut self.knowledge, context)
    }
}

/// Does it while its robot carries luggage.
#[derive(Debug, LoopClass)]
#[looping(name = "bad.Carrier")]
pub struct Carrier {
    #[properties]
    properties: ActorProperties,
    #[senses]
    has_luggage: Entry<bool>,
}

impl Loop for Carrier {
    type Properties = ActorProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn analyze(&mut self, robot: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        if self.has_luggage.get(robot)? {
            self.properties.act("carries")?;
        }
        Ok(None)
    }

    fn plan(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(None)
    }

    fn execute(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }
}

/// Does it in one of its phases.
#[derive(Debug, LoopClass)]
#[looping(name = "bad.Switch", effects("brightness"))]
pub struct Switch {
    properties: ActorProperties,
    brightness: Effector<u32>,
}

impl Loop for Switch {
    type Properties = ActorProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new(properties: ActorProperties) -> Result<Self, Failure> {
        properties.act("new")?;
        Ok(Switch { properties, brightness: Effector::default() })
    }

    fn initialize(&mut self, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.act("initialize")?;
        self.brightness = knowledge.effector("brightness")?;
        Ok(())
    }

    fn monitor(&mut self, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.act("monitor")?;
        Ok(())
    }

    fn analyze(&mut self, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        self.properties.act("analyze")?;
        Ok(Some(record!("it is dark")))
    }

    fn plan(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        self.properties.act("plan")?;
        Ok(Some(record!("switches it on")))
    }

    fn execute(&mut self, _: Record, knowledge: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.act("execute")?;
        let brighter = self.brightness.get(knowledge)? + 1;
        self.brightness.set(knowledge, brighter)
    }

    fn shutdown(&mut self, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.act("shutdown")?;
        Ok(())
    }
}

impl Drop for Switch {
    fn drop(&mut self) {
        let _ = self.properties.act("drop");
    }
}

saoms_api::plugin! {
    classes: [Actor, Lamp, Motor],
    loops: [Carrier, Switch],
}
