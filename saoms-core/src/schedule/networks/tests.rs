#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use saoms_api::host::{Registration, cdr};
use saoms_api::{Class, Component, Context, Failure, Message, Publisher, Topic};
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;

use super::NetworkHooks;
use crate::network::control::{ControlRequest, Reply};
use crate::network::exchange::KeptEvent;
use crate::network::{FromRun, Port};
use crate::schedule::{Handle, RunningFleet, Settings};
use crate::store::Store;

#[derive(Clone, Debug, Default, PartialEq, Message)]
struct Word {
    number: u64,
}

const WORDS: Topic<Word> = Topic::event("WORDS");
const SAID: Topic<Word> = Topic::state("SAID");
const URL: &str = "net:1";
/// What they say in their shutdown.
const LAST: u64 = 1_000_000;

/// Keeps a number in each execution, and says it in an event and in a state.
#[derive(Class)]
#[class(name = "test.Talker", periodic)]
struct Talker {
    #[publishes(WORDS)]
    words: Publisher<Word>,
    #[publishes(SAID)]
    said: Publisher<Word>,
    number: u64,
}

impl Talker {
    fn say(&mut self, context: &mut Context<'_>, number: u64) -> Result<(), Failure> {
        context.keep(0, &number.to_le_bytes())?;
        context.send(&self.words, Word { number })?;
        context.send(&self.said, Word { number })?;
        Ok(())
    }
}

impl Component for Talker {
    type Properties = ();

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.number += 1;
        self.say(context, self.number)
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.say(context, LAST)
    }
}

/// A program that nobody asks.
struct Alone;

impl NetworkHooks for Alone {
    fn lose(&self) {}

    fn is_interrupted(&self) -> bool {
        false
    }

    fn control(&self, _request: ControlRequest, _reply: Reply) {}
}

/// Runs a fleet of talkers and does something meanwhile; gives what has left for the network.
fn run(folder: &Path, meanwhile: impl FnOnce(&Handle)) -> Vec<FromRun> {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Talker>()).unwrap();
    let talker = |name: &str| {
        format!(
            r#"<component name="{name}"><implementation.rust class="test.Talker"/><property name="ID">{name}</property>
            <property name="period">1</property></component>"#
        )
    };
    let fleet = format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
        {}{}</composite>"#,
        talker("A"),
        talker("B")
    );
    let compilation = Project::new().text("f.composite", fleet).compile(&registry);
    let mut fleet = compilation.output.unwrap_or_else(|| panic!("{:?}", compilation.diagnostics));
    fleet.components.iter_mut().for_each(|spec| spec.task.as_mut().unwrap().url = Some(URL.to_owned()));
    let store = Store::open(folder).unwrap();
    let port: Arc<Port> = Arc::default();
    let fleet = RunningFleet::start_with(fleet, Settings::default(), Vec::new(), |handle| {
        handle.use_store(store)?;
        handle.use_network(URL, &port, Alone);
        Ok(())
    });
    let fleet = fleet.unwrap();
    let handle = fleet.handle();
    meanwhile(&handle);
    handle.stop();
    fleet.run_to_end();
    port.take().from_run
}

/// Checks that nothing has left that is not in the folder.
fn check(folder: &Path, left: Vec<FromRun>) {
    let store = Store::open(folder).unwrap();
    let kept = |name: &str| {
        let bytes = store.contents().of(name).and_then(|entries| entries.get(&0));
        bytes.map_or(0, |bytes| u64::from_le_bytes(bytes[..].try_into().unwrap()))
    };
    let kept = BTreeMap::from([("A", kept("A")), ("B", kept("B"))]);
    let events = store.contents().of(&format!("(events)\n{URL}\n{}", WORDS.name())).unwrap();
    let (mut events_left, mut states_left) = (0, 0);
    for from_run in left {
        let FromRun::Message { component, is_state, number, message, .. } = from_run else { continue };
        let word: Word = cdr::decode(message.bytes()).unwrap();
        assert!(word.number <= kept[&*component], "{component} has said {} and kept {kept:?}", word.number);
        if is_state {
            states_left += 1;
        } else {
            events_left += 1;
            let event: KeptEvent = cdr::decode(&events[&number.unwrap()]).unwrap();
            let there = (event.component.as_str(), cdr::decode::<Word>(&event.bytes).unwrap());
            assert_eq!(there, (&*component, word), "event {number:?}");
        }
    }
    assert!(events_left > 5 && states_left > 5, "{events_left} {states_left}");
}

const PATIENCE: Duration = Duration::from_secs(10);

#[test]
fn nothing_leaves_over_a_network_that_is_not_in_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let left = run(folder.path(), |handle| {
        for _ in 0..20 {
            sleep(Duration::from_millis(10));
            handle.commit(PATIENCE).unwrap();
        }
    });
    check(folder.path(), left);
}

#[test]
fn nothing_leaves_over_a_network_when_the_end_of_a_run_is_not_kept() {
    let folder = tempfile::tempdir().unwrap();
    let mut together = None;
    let left = run(folder.path(), |handle| {
        sleep(Duration::from_millis(50));
        handle.commit(PATIENCE).unwrap();
        together = Some(handle.together());
        // They say more, which waits.
        sleep(Duration::from_millis(20));
    });
    check(folder.path(), left);
}
