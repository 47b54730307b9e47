//! A program that wants to see the messages of topics.

use std::fmt::Write;
use std::sync::{Arc, Mutex};

use saoms_api::Message;
use saoms_api::host::TopicDeclaration;
use saoms_core::observe::{Observer, Occurrence, RunEvent, SentMessage};
use saoms_core::schedule::{RunningFleet, Settings};

use crate::actor::Words;
use crate::fleet::{assembly, run, simulated, unindent};

/// Writes down the words on one topic, and what is logged, in the order of the events.
struct Reader {
    topic: &'static str,
    told: Mutex<String>,
}

impl Observer for Reader {
    fn event(&self, event: &RunEvent) {
        if let Occurrence::Log { .. } = event.what {
            writeln!(self.told.lock().unwrap(), "{event}").unwrap();
        }
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        name == self.topic && declared.schema == Words::SCHEMA
    }

    fn message(&self, sent: &SentMessage) {
        let header = sent.message.header();
        let words = sent.message.get::<Words>().unwrap();
        writeln!(
            self.told.lock().unwrap(),
            "[{}] {} says {} on {}",
            header.sent,
            sent.component,
            words.text,
            sent.topic
        )
        .unwrap();
    }
}

fn read(topic: &'static str, fleet: &str, settings: Settings) -> (String, Option<String>) {
    let reader = Arc::new(Reader { topic, told: Mutex::default() });
    let report = RunningFleet::start(assembly(fleet), settings, vec![reader.clone()]).unwrap().run_to_end();
    let told = reader.told.lock().unwrap();
    (told.clone(), report.trace_hash)
}

const FLEET: &str = "A actor period=10 publishes=TALK first=[say begins] each=[0: say one; 2: say two] last=[say ends]
     B actor period=10 delay=5 publishes=[TALK TABLE] rename=TALK/elsewhere each=[say unheard; put 1 2]
     C actor period=10 subscribes=TALK each=[hear]";

#[test]
fn wanted_topics_are_told_in_order_from_the_first_message_to_the_last() {
    let (told, _) = read("TALK", FLEET, simulated(30));
    let expected = "[0.000 s] A says begins on TALK
         [0.000 s] A says one on TALK
         [0.000 s] C: hears [begins, one]
         [0.010 s] C: hears []
         [0.020 s] A says two on TALK
         [0.020 s] C: hears [two]
         [0.030 s] A says ends on TALK";
    assert_eq!(told.trim(), unindent(expected), "\n{told}");
}

#[test]
fn topics_are_known_by_their_new_names() {
    let (told, _) = read("elsewhere", FLEET, simulated(10));
    assert!(told.contains("[0.005 s] B says unheard on elsewhere\n"), "{told}");
    assert!(!told.contains("A says"), "{told}");
}

#[test]
fn being_watched_changes_nothing() {
    let (_, watched) = read("TALK", FLEET, simulated(100));
    let (report, _) = run(FLEET, simulated(100));
    assert_eq!(watched, report.trace_hash);
}
