//! A part of a fleet knows the components of the other nodes.

use std::sync::Arc;
use std::time::Duration;

use saoms_api::host::{Registration, cdr};
use saoms_api::{Class, Component, Context, Failure, Message, Publisher, Subscription, Time, Topic, info};
use saoms_core::network::control::{ControlRequest, Reply};
use saoms_core::network::exchange::Arrived;
use saoms_core::network::{Fleet, Port, Undelivered};
use saoms_core::schedule::{NetworkHooks, NetworkedFleet, RunningFleet, Settings};
use saoms_lang::registry::Registry;

use crate::fault::faults;
use crate::fleet::{Diary, assembly_of, simulated, unindent};

#[derive(Clone, Debug, Message)]
struct Word {
    number: u32,
}

const WORDS: Topic<Word> = Topic::event("WORDS");

/// Says whom it knows on its topic, and whom it heard.
#[derive(Debug, Class)]
#[class(name = "test.Gate", periodic)]
struct Gate {
    #[publishes(WORDS)]
    says: Publisher<Word>,
    #[subscribes(WORDS)]
    hears: Subscription<Word>,
}

impl Component for Gate {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Gate { says: Publisher::default(), hears: Subscription::default() })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let _ = self.says;
        let publishers = context.publishers(&WORDS);
        let heard: Vec<String> = context
            .receive(&self.hears)
            .with_headers()
            .map(|(header, word)| format!("{} of {}", word.number, context.sender_name(header).unwrap_or("nobody")))
            .collect();
        let header = |sender| saoms_api::Header { sender, sent: Time::START, cause: saoms_api::Cause::default() };
        let known: Vec<String> = publishers
            .iter()
            .map(|one| {
                let name = context.sender_name(header(one.sender)).unwrap_or("nobody");
                format!("{name}{}", if one.has_begun { "" } else { " (not begun)" })
            })
            .collect();
        info!(context, "knows {}; hears {}", known.join(", "), heard.join(", "));
        Ok(())
    }
}

/// Runs node `a` of a fleet, to which other programs say something after the first execution. Gives what A said.
fn told(settings: Settings, others: &[&str]) -> String {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Gate>()).unwrap();
    let mut fleet = assembly_of("A test.Gate\nB test.Gate\nC test.Gate startup=false", &registry);
    for (spec, node) in fleet.components.iter_mut().zip(["a", "b", "b"]) {
        spec.node = node.into();
        spec.task.as_mut().unwrap().url = Some("net:1".to_owned());
    }
    let diary = Arc::new(Diary::default());
    let port: Arc<Port> = Arc::default();
    let mut network: Option<NetworkedFleet> = None;
    let fleet = RunningFleet::start_with(fleet.at("a"), settings, vec![diary.clone()], |handle| {
        network = Some(handle.use_network("net:1", &port, Alone));
        Ok(())
    });
    let fleet = fleet.unwrap();
    fleet.run_until(Time::START + Duration::from_millis(50));
    let arrived = |component: &&str| Arrived {
        component: Arc::from(*component),
        to: String::new(),
        key: None,
        sent: 0,
        cause: 0,
        bytes: cdr::encode(&Word { number: 7 }),
        origin: 1,
        number: 1,
    };
    let mut messages = Undelivered::from([(Arc::from("WORDS"), others.iter().map(arrived).collect())]);
    network.unwrap().deliver(&mut messages);
    fleet.run_to_end();
    diary.lines()
}

#[test]
fn publishers_of_other_nodes_are_known_before_they_speak() {
    let expected = "[0.000 s] A: knows B, C (not begun); hears
        [0.100 s] A: knows B, C; hears 7 of C, 7 of B, 7 of Stranger, 7 of (outside)";
    let told = told(simulated(200), &["C", "B", "Stranger", "(outside) 1f"]);
    assert_eq!(unindent(&told), unindent(expected));
}

#[test]
fn faults_of_messages_act_on_those_of_other_nodes() {
    let settings = Settings { faults: faults(&["0 lose 100 % on WORDS from B"]), ..simulated(200) };
    let expected = "[0.000 s] A: knows B, C (not begun); hears
        [0.100 s] A: knows B, C; hears 7 of C, 7 of Stranger";
    assert_eq!(unindent(&told(settings, &["C", "B", "Stranger"])), unindent(expected));
}

/// A program that nobody asks.
struct Alone;

impl NetworkHooks for Alone {
    fn is_interrupted(&self) -> bool {
        false
    }

    fn lose(&self) {}

    fn control(&self, _request: ControlRequest, _reply: Reply) {}
}
