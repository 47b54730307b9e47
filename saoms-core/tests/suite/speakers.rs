//! Messages from outside in the name of a component of the fleet.

use std::sync::Arc;

use saoms_api::host::{Registration, cdr};
use saoms_api::{
    Cause, Class, Component, Context, Failure, Field, Header, Message, Properties, Publisher, Time, Topic, info,
};
use saoms_core::schedule::{InjectError, InjectedContent, Injection, Order, OrderError, RunningFleet};
use saoms_lang::registry::Registry;
use serde_json::{Value, json};

use crate::fleet::{Diary, assembly_of, simulated, unindent};

#[derive(Clone, Copy, Debug, Default, Field)]
enum Stage {
    #[default]
    Request,
    Answer,
}

/// A question, or the answer of the component with the number in `who`.
#[derive(Clone, Debug, Default, Message)]
#[message(speaker("who", unless(stage = "REQUEST"), instead = "send a request"))]
struct Said {
    who: u32,
    stage: Stage,
}

const SAID: Topic<Said> = Topic::event("SAID").optional();

#[derive(Clone, Properties)]
struct Number {
    /// Its name.
    #[property(required_text, speaker)]
    name: String,
    /// Its number; by default the digits at the end of its name.
    #[property(speaker)]
    number: Option<i64>,
}

/// Answers.
#[derive(Class)]
#[class(name = "test.Speaker", periodic)]
struct Speaker {
    #[publishes(SAID)]
    said: Publisher<Said>,
}

impl Component for Speaker {
    type Properties = Number;

    fn new(_: Number) -> Result<Self, Failure> {
        Ok(Speaker { said: Publisher::default() })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.send(&self.said, Said::default())
    }
}

/// Says which component has which number on its topic.
#[derive(Class)]
#[class(name = "test.Asker", periodic)]
struct Asker;

impl Component for Asker {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Asker)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let speaker = |number: u32| {
            let sender = context.speaker(&SAID, number)?;
            let header = Header { sender, sent: Time::START, cause: Cause::default() };
            Some(format!("{number} is {}", context.sender_name(header)?))
        };
        let known: Vec<String> = (0..10).filter_map(speaker).collect();
        info!(context, "{}", known.join(", "));
        Ok(())
    }
}

#[test]
fn components_know_who_has_a_number_on_a_topic() {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Speaker>()).unwrap();
    registry.add(Registration::of::<Asker>()).unwrap();
    // One that has not begun, one that speaks on another topic, and one with the number of another.
    let fleet = "A test.Speaker name=Speaker4 number=7
         B test.Speaker name=Speaker8
         C test.Speaker name=Speaker9 startup=false
         D test.Speaker name=Speaker1 rename=SAID/OTHER
         E test.Speaker name=Speaker8
         F test.Speaker name=nobody
         Y test.Asker
         Z test.Asker rename=SAID/OTHER";
    let diary = Arc::new(Diary::default());
    let fleet = RunningFleet::start(assembly_of(fleet, &registry), simulated(10), vec![diary.clone()]).unwrap();
    fleet.run_to_end();
    let expected = "[0.000 s] Y: 7 is A, 8 is B, 9 is C
        [0.000 s] Z: 1 is D";
    assert_eq!(unindent(&diary.lines()), unindent(expected));
}

fn start(text: &str) -> RunningFleet {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Speaker>()).unwrap();
    RunningFleet::start(assembly_of(text, &registry), simulated(30), vec![]).unwrap()
}

fn say(fleet: &RunningFleet, topic: &str, message: Value) -> Result<(), InjectError> {
    let order = Order::Publish { topic: topic.to_owned(), message };
    fleet.handle().order(order, None).map(drop).map_err(|error| match error {
        OrderError::Message(error) => error,
        other => panic!("{other}"),
    })
}

#[test]
fn nobody_outside_speaks_in_the_name_of_a_component() {
    let fleet = start(
        "A test.Speaker name=Speaker4 number=7
         B test.Speaker name=Speaker8
         C test.Speaker name=Speaker9 startup=false
         D test.Speaker name=Speaker1 rename=SAID/OTHER",
    );
    let answer = |who: i64| json!({"who": who, "stage": "ANSWER"});
    let words = |topic: &str, component: &str, number: i64| {
        format!(
            "topic `{topic}`: `who` is {number}, the number of component `{component}`: only that component can publish messages with this number; send a request"
        )
    };
    for (component, number) in [("A", 7), ("B", 8), ("C", 9)] {
        let refused = say(&fleet, "SAID", answer(number)).unwrap_err().to_string();
        assert_eq!(refused, words("SAID", component, number));
        assert_eq!(say(&fleet, "SAID", json!({"who": number, "stage": "REQUEST"})), Ok(()), "no answer");
        assert_eq!(say(&fleet, "OTHER", answer(number)), Ok(()), "it does not speak there");
    }
    assert_eq!(say(&fleet, "OTHER", answer(1)).unwrap_err().to_string(), words("OTHER", "D", 1));
    assert_eq!((say(&fleet, "SAID", answer(1)), say(&fleet, "SAID", answer(4))), (Ok(()), Ok(())));
    let bytes = cdr::encode(&Said { who: 8, stage: Stage::Answer });
    let (topic, content) = ("SAID".to_owned(), InjectedContent::Bytes(bytes));
    let refused = fleet.handle().inject(Injection { topic, content, at: None, text: String::new() });
    assert!(matches!(refused, Err(InjectError::Speaker { .. })), "{refused:?}");
    let topics = fleet.handle().topics();
    assert_eq!(topics[0].speakers, ["`who`, unless `stage` is `REQUEST`"]);
}
