//! A plugin that misbehaves as its properties say.

use std::panic::panic_any;
use std::time::Duration;

use saoms_api::{
    Class, Component, Context, Effector, Extras, Failure, Knowledge, Loop, LoopClass, Loops, Message, Properties,
    Publisher, Record, Saved, Subscription, Topic, interface, record,
};

/// A message.
#[derive(Clone, Debug, Message)]
pub struct Word {
    text: String,
}

const WORDS: Topic<Word> = Topic::event("WORDS");
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

/// A payload whose drop panics, and so on.
struct Nasty(u32);

impl Drop for Nasty {
    fn drop(&mut self) {
        if self.0 > 0 {
            panic_any(Nasty(self.0 - 1));
        }
    }
}

impl ActorProperties {
    fn act(&self, place: &str) -> Result<(), Failure> {
        if self.at != place {
            return Ok(());
        }
        match &*self.does {
            "panic" => panic!("no more of {place}"),
            "nasty" => panic_any(Nasty(3)),
            "block" => std::thread::sleep(Duration::from_millis(300)),
            "never" => loop {
                std::thread::sleep(Duration::from_secs(1));
            },
            "fail" => return Err(format!("fails in {place}").into()),
            other => panic!("what is {other}?"),
        }
        Ok(())
    }
}

/// Does it in one of its functions.
#[derive(Debug, Class)]
#[class(name = "bad.Actor", periodic, publishes(WORDS), subscribes(WORDS), service("callee": Callee), reference("callee": Callee, optional))]
pub struct Actor {
    properties: ActorProperties,
    said: Publisher<Word>,
    heard: Subscription<Word>,
    callee: CalleeReference,
}

impl Component for Actor {
    type Properties = ActorProperties;

    fn new(properties: ActorProperties) -> Result<Self, Failure> {
        properties.act("new")?;
        let (said, heard, callee) = Default::default();
        Ok(Actor { properties, said, heard, callee })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.act("initialize")?;
        self.said = context.publish(&WORDS)?;
        self.heard = context.subscribe(&WORDS)?;
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
        context.count("bad.executions", 1);
        context.send(&self.said, Word { text: "word".to_owned() })
    }

    fn shutdown(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.properties.act("shutdown")?;
        Ok(())
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
    classes: [Actor, Lamp],
    loops: [Switch],
}
