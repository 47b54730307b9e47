//! Messages from outside a running fleet.

use std::sync::{Arc, Mutex};

use saoms_api::Time;
use saoms_api::host::cdr;
use saoms_core::observe::{Observer, SentMessage};
use saoms_core::report::RunStatus;
use saoms_core::schedule::{Handle, InjectError, InjectedContent, Injection, RunningFleet, Settings};
use serde_json::{Value, json};

use crate::actor::Words;
use crate::fleet::{assembly, outcome, simulated, start, unindent};

fn at(milliseconds: u64) -> Time {
    Time::from_nanos(milliseconds * 1_000_000)
}

fn say(handle: &Handle, topic: &str, content: Value, time: Option<u64>) -> Result<(), InjectError> {
    let text = format!("somebody says {content}");
    handle.inject(Injection {
        topic: topic.to_owned(),
        content: InjectedContent::Fields(content),
        at: time.map(at),
        text,
    })
}

const FLEET: &str = "A actor period=10 publishes=TALK each=[1: say mine]
     B actor period=10 subscribes=[TALK TABLE] each=[hear-from; read]";

/// Events and trace hash of a run with these messages from outside.
fn run(words: &[(&str, Option<u64>)]) -> (String, String) {
    let (fleet, diary) = start(FLEET, simulated(30));
    let fleet = fleet.unwrap();
    for (word, time) in words {
        say(&fleet.handle(), "TALK", json!({ "text": word }), *time).unwrap();
    }
    let report = fleet.run_to_end();
    (diary.lines(), report.trace_hash.unwrap())
}

#[test]
fn messages_take_effect_at_their_time_before_those_who_are_due_then() {
    let words = [("now", None), ("then", Some(20)), ("soon", Some(12)), ("late", Some(30))];
    let (told, hash) = run(&words);
    let expected = "[0.000 s] B: hears [now by 4294967295 at 0.000 s]
         [0.000 s] B: reads []
         [0.010 s] B: hears [mine by 0 at 0.010 s]
         [0.010 s] B: reads []
         [0.020 s] B: hears [soon by 4294967295 at 0.012 s, then by 4294967295 at 0.020 s]
         [0.020 s] B: reads []";
    assert_eq!(told.trim(), unindent(expected));
    assert_eq!(run(&words), (told, hash.clone()));
    assert_ne!(run(&words[..1]).1, hash);
    assert_ne!(run(&[("now", None), ("then", Some(20)), ("sooN", Some(12))]).1, hash);
}

#[test]
fn messages_wait_for_room_in_the_queues_of_their_readers() {
    let (fleet, diary) = start("A actor period=10 queue=4 subscribes=[TALK] each=[hear]", simulated(200));
    let fleet = fleet.unwrap();
    for number in 0..20 {
        say(&fleet.handle(), "TALK", json!({ "text": format!("word{number}") }), Some(15)).unwrap();
    }
    let report = fleet.run_to_end();
    assert_eq!(report.outcome.status, RunStatus::Elapsed, "{:?}", report.outcome);
    let told = diary.lines();
    let places: Vec<usize> = (0..20).map(|number| told.find(&format!("word{number}")).unwrap()).collect();
    assert!(places.is_sorted(), "in their order: {told}");
}

#[test]
fn messages_that_wait_for_room_come_before_those_that_are_due_later() {
    let (fleet, diary) = start("A actor period=10 queue=4 subscribes=[TALK] each=[hear]", simulated(200));
    let fleet = fleet.unwrap();
    say(&fleet.handle(), "TALK", json!({ "text": "later" }), Some(25)).unwrap();
    for number in 0..12 {
        say(&fleet.handle(), "TALK", json!({ "text": format!("word{number}") }), Some(15)).unwrap();
    }
    fleet.run_to_end();
    let told = diary.lines();
    assert!(told.find("word11").unwrap() < told.find("later").unwrap(), "{told}");
}

#[test]
fn messages_are_checked_against_the_schema_of_their_topic() {
    let (fleet, _) = start(FLEET, simulated(30));
    let fleet = fleet.unwrap();
    let refused = |topic: &str, content: Value| say(&fleet.handle(), topic, content, None).unwrap_err().to_string();
    assert_eq!(refused("TALKS", json!({})), "the fleet has no topic `TALKS`; did you mean `TALK`?");
    assert_eq!(refused("other", json!({})), "the fleet has no topic `other`; its topics are: TALK, TABLE");
    assert_eq!(
        refused("TALK", json!({ "txt": "a" })),
        "topic `TALK`: this is not a message `Words`: `Words` has no field `txt`; did you mean `text`?"
    );
    assert_eq!(
        refused("TALK", json!({ "text": 7 })),
        "topic `TALK`: this is not a message `Words`: field `text`: found 7, expected a text"
    );
    let bytes = |bytes| {
        let (topic, text) = ("TALK".to_owned(), String::new());
        fleet.handle().inject(Injection { topic, content: InjectedContent::Bytes(bytes), at: None, text })
    };
    assert_eq!(bytes(cdr::encode(&Words { text: "fine".to_owned() })), Ok(()));
    assert!(matches!(bytes(vec![1, 2, 3]), Err(InjectError::Content { .. })));
    let handle = fleet.handle();
    fleet.run_to_end();
    assert_eq!(say(&handle, "TALK", json!({ "text": "a" }), None), Err(InjectError::Ending));
}

#[test]
fn a_state_topic_keeps_messages_from_outside_under_their_keys() {
    let (fleet, diary) = start(FLEET, simulated(20));
    let fleet = fleet.unwrap();
    for (key, value) in [(1, 1), (2, 2), (1, 3)] {
        say(&fleet.handle(), "TABLE", json!({ "key": key, "value": value }), None).unwrap();
    }
    fleet.run_to_end();
    assert!(diary.lines().contains("B: reads [2=2, 1=3]"), "{}", diary.lines());
}

#[derive(Default)]
struct Reader(Mutex<Vec<String>>);

impl Observer for Reader {
    fn wants_topic(&self, _: &str, _: &saoms_api::host::TopicDeclaration<'_>) -> bool {
        true
    }

    fn message(&self, sent: &SentMessage) {
        self.0.lock().unwrap().push(format!("{} on {}", sent.component, sent.topic));
    }
}

#[test]
fn messages_from_outside_are_observed_and_in_the_journal() {
    let reader = Arc::new(Reader::default());
    let fleet = RunningFleet::start(assembly(FLEET), simulated(10), vec![reader.clone()]).unwrap();
    say(&fleet.handle(), "TALK", json!({ "text": "a" }), Some(5)).unwrap();
    let report = fleet.run_to_end();
    assert_eq!(*reader.0.lock().unwrap(), ["(outside) on TALK"]);
    let entries: Vec<_> = report.journal.entries().iter().map(ToString::to_string).collect();
    assert_eq!(entries, [r#"0.005 s (outside) - symptom: somebody says {"text":"a"}"#]);
    assert_eq!((report.journal.records, report.journal.loops[0].symptoms), (1, 1));
}

#[test]
fn a_run_does_not_end_while_messages_are_to_come() {
    let fleet = "A actor period=10 subscribes=TALK each=[0: done; hear]";
    let (fleet, _) = start(fleet, simulated(10_000));
    let fleet = fleet.unwrap();
    say(&fleet.handle(), "TALK", json!({ "text": "a" }), Some(55)).unwrap();
    let report = fleet.run_to_end();
    // Three periods after the message.
    assert_eq!(outcome(&report), "Done after 0.085 s");
}

#[test]
fn a_run_does_not_end_while_somebody_holds_it() {
    let (fleet, _) = start("A actor period=5 delay=300 each=[0: done]", Settings::default());
    let fleet = fleet.unwrap();
    let hold = fleet.handle().hold();
    fleet.run_until(at(360));
    drop(hold);
    let report = fleet.run_to_end();
    assert_eq!(report.outcome.status, RunStatus::Done);
    assert!(report.time_s >= 0.36, "{}", report.time_s);
}
