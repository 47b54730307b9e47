use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use saoms_api::host::{PropertyValue, Registration};
use saoms_api::{Class, Component, Context, Failure, Message, Properties, Publisher, Topic};
use saoms_lang::assembly::{Assembly, ComponentSpec, TaskProperties};
use saoms_lang::registry::Registry;

use super::{spawn_timer, watchdog};
use crate::schedule::change;
use crate::schedule::os::clock::Clock;
use crate::schedule::settings::Settings;
use crate::schedule::shared::Shared;

/// The ends of the test: `REACHED` is told what the fleet has reached, which then waits for `GO_ON`.
static REACHED: Mutex<Option<Sender<&str>>> = Mutex::new(None);
static GO_ON: Mutex<Option<Receiver<()>>> = Mutex::new(None);

/// Tells the test, and waits until it has an answer or is gone.
fn reach(place: &'static str) {
    let _ = REACHED.lock().unwrap().as_ref().unwrap().send(place);
    let _ = GO_ON.lock().unwrap().as_ref().unwrap().recv();
}

/// A message that waits for the test when it is dropped.
#[derive(Clone, Debug, Message)]
struct Parcel {
    waits: bool,
}

impl Drop for Parcel {
    fn drop(&mut self) {
        if std::mem::take(&mut self.waits) {
            reach("between two executions");
        }
    }
}

const PARCELS: Topic<Parcel> = Topic::state("PARCELS");

#[derive(Properties)]
struct Nothing {}

/// The timer drops its first message after its execution.
#[derive(Class)]
#[class(name = "sender", periodic, publishes(PARCELS))]
struct Sends(Publisher<Parcel>);

impl Component for Sends {
    type Properties = Nothing;

    fn new(_: Nothing) -> Result<Self, Failure> {
        Ok(Sends(Publisher::default()))
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.0 = context.publish(&PARCELS)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.send(&self.0, Parcel { waits: context.execution() == 0 })?;
        context.send(&self.0, Parcel { waits: false })
    }
}

/// Blocks in its first execution.
#[derive(Class)]
#[class(name = "blocks", periodic)]
struct Blocks;

impl Component for Blocks {
    type Properties = Nothing;

    fn new(_: Nothing) -> Result<Self, Failure> {
        Ok(Blocks)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.execution() == 0 {
            reach("blocked");
        }
        Ok(())
    }
}

fn component(path: &str, registry: &Registry) -> ComponentSpec {
    let values = [("ID", path), ("period", "1h")].map(|(name, value)| (name.into(), PropertyValue::from(value)));
    ComponentSpec {
        path: path.to_owned(),
        site: Default::default(),
        node: Default::default(),
        fault_node: Default::default(),
        class: Arc::clone(registry.get(path).unwrap()),
        library: None,
        values: Vec::new(),
        written: Default::default(),
        task: Some(TaskProperties::from_values(&values).unwrap()),
        references: Vec::new(),
        loops: Arc::default(),
        web: Box::default(),
    }
}

/// A fleet may have started before its timer runs, which then executes before it has ever slept; the spare thread may
/// look just between two executions.
#[test]
fn code_that_blocks_in_the_first_batch_is_noticed() {
    let (reached, has_reached) = channel();
    let (go_on, goes_on) = channel();
    *REACHED.lock().unwrap() = Some(reached);
    *GO_ON.lock().unwrap() = Some(goes_on);
    let mut registry = Registry::new();
    registry.add(Registration::of::<Sends>()).unwrap();
    registry.add(Registration::of::<Blocks>()).unwrap();
    let shared = Arc::new(Shared::new(Settings::default().checked(), Clock::real(), Vec::new()));
    let components = ["sender", "blocks"].map(|path| component(path, &registry)).into();
    change::start(&shared, Assembly { components, ..Assembly::default() }).unwrap();
    spawn_timer(&shared, 0).unwrap();
    let within = Duration::from_secs(10);
    assert_eq!(has_reached.recv_timeout(within), Ok("between two executions"));
    shared.pulse.watch_from(0);
    watchdog::spawn(&shared).unwrap();
    // The spare thread looks, and decides until when it sleeps.
    while !shared.pulse.unwatched(0, 0) {
        thread::sleep(Duration::from_millis(1));
    }
    go_on.send(()).unwrap();
    assert_eq!(has_reached.recv_timeout(within), Ok("blocked"));
    let begin = Instant::now();
    while shared.lock().roles.timer == 0 {
        assert!(begin.elapsed() < within, "nobody has noticed that `blocks` does not return");
        thread::sleep(Duration::from_millis(1));
    }
    drop(go_on);
    shared.stop.store(true, Ordering::SeqCst);
    shared.timer.wake();
}
