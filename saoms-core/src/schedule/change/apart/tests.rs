use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::host::{PropertyValue, Registration};
use saoms_api::{Class, Component, Context, Failure, Properties, Time};
use saoms_lang::assembly::{Assembly, ComponentSpec, TaskProperties};
use saoms_lang::registry::Registry;

use super::within;
use crate::schedule::component::body::Body;
use crate::schedule::os::clock::Clock;
use crate::schedule::settings::Settings;
use crate::schedule::shared::Shared;
use crate::schedule::{ChangeOptions, RunningFleet};

/// True while the system has no threads.
pub(super) static NO_THREADS: AtomicBool = AtomicBool::new(false);

/// The system is that of one test at a time.
static SYSTEM: Mutex<()> = Mutex::new(());

fn system() -> MutexGuard<'static, ()> {
    SYSTEM.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The loads that the first one has taken.
static TAKEN: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// Says that the change has been answered.
static ANSWERED: Mutex<Option<Receiver<()>>> = Mutex::new(None);

/// Takes another load, and the first one back once the change has been answered.
#[derive(Class)]
#[class(name = "mule", periodic)]
struct Mule {
    /// What it carries.
    #[property(default = 1, live)]
    load: u32,
    /// True if it refuses any other, at which time the system has no more threads.
    #[property(default = false)]
    refuses: bool,
}

impl Component for Mule {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        if self.refuses {
            NO_THREADS.store(true, Ordering::SeqCst);
            return Err(Failure::new("it is too heavy"));
        }
        if let Some(answered) = ANSWERED.lock().unwrap().as_ref().filter(|_| properties.load == 1) {
            answered.recv_timeout(Duration::from_secs(10)).unwrap();
        }
        self.load = properties.load;
        TAKEN.lock().unwrap().push(self.load);
        Ok(())
    }
}

fn mule(path: &str, load: &str, refuses: &str) -> ComponentSpec {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Mule>()).unwrap();
    let class = Arc::clone(registry.get("mule").unwrap());
    let values = [("load", load), ("refuses", refuses)].map(|(name, value)| (name.into(), PropertyValue::from(value)));
    let task = [("ID", path), ("period", "1ms")].map(|(name, value)| (name.into(), PropertyValue::from(value)));
    ComponentSpec {
        path: path.to_owned(),
        site: Default::default(),
        node: Default::default(),
        fault_node: Default::default(),
        class,
        library: None,
        values: values.into(),
        written: Default::default(),
        task: Some(TaskProperties::from_values(&task).unwrap()),
        references: Vec::new(),
        loops: Arc::default(),
        web: Box::default(),
    }
}

#[test]
fn a_panic_is_a_failure_at_once() {
    let _system = system();
    let shared = Arc::new(Shared::new(Settings::default().checked(), Clock::real(), Vec::new()));
    let body = || Box::new(Body::new(0, Arc::new(mule("A", "1", "false")), "A".into(), 0, Arc::default()));
    let limit = ("the code", Duration::from_secs(3600));
    let panics = |_: &mut Body, _: &Arc<Shared>| -> Result<(), Failure> { panic!("it stumbles") };
    let returned = within(&shared, limit, body(), panics, |_, _, _| {});
    let Ok((_, Err(failure))) = returned else { panic!("its thread is left behind") };
    assert!(failure.message().ends_with(": it stumbles"), "{failure}");
}

/// A fleet of two, with this load of the first one; the second one refuses any other.
fn of(load: &str, of_second: &str) -> Assembly {
    let components = vec![mule("A", load, "false"), mule("B", of_second, "true")];
    Assembly { components, ..Assembly::default() }
}

#[test]
fn values_are_taken_back_by_the_fleet_itself_where_there_is_no_thread_for_that() {
    let _system = system();
    let (tell, answered) = channel();
    *ANSWERED.lock().unwrap() = Some(answered);
    TAKEN.lock().unwrap().clear();
    let fleet = RunningFleet::start(of("1", "1"), Settings::default(), Vec::new()).unwrap();
    let error = fleet.handle().apply(&of("2", "2"), ChangeOptions::default()).unwrap_err();
    NO_THREADS.store(false, Ordering::SeqCst);
    assert_eq!(error.to_string(), "component `B` of class `mule` refuses its new values: it is too heavy");
    tell.send(()).unwrap();
    let begun = Instant::now();
    while *TAKEN.lock().unwrap() != [2, 1] {
        assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", TAKEN.lock().unwrap());
        sleep(Duration::from_millis(2));
    }
    let is_again = || fleet.handle().plan(&of("1", "1")).is_empty();
    assert!(is_again());
    fleet.handle().stop();
    fleet.run_to_end();
}

#[test]
fn values_of_another_change_are_not_overwritten_by_those_of_one_that_was_undone() {
    let _system = system();
    *ANSWERED.lock().unwrap() = None;
    let is_overtaken = || {
        TAKEN.lock().unwrap().clear();
        let settings = Settings { limit: Some(Duration::from_millis(50)), ..Settings::simulated(0) };
        let fleet = RunningFleet::start(of("1", "1"), settings, Vec::new()).unwrap();
        fleet.handle().apply(&of("2", "2"), ChangeOptions::default()).unwrap_err();
        NO_THREADS.store(false, Ordering::SeqCst);
        assert_eq!(fleet.handle().apply(&of("5", "1"), ChangeOptions::default()).unwrap().updated, ["A"]);
        fleet.run_until(Time::from_nanos(20_000_000));
        assert!(fleet.handle().plan(&of("5", "1")).is_empty());
        fleet.run_to_end();
        let taken = TAKEN.lock().unwrap();
        assert_eq!((taken.first(), taken.last()), (Some(&2), Some(&5)), "{taken:?}");
        taken.len() == 2
    };
    // The fleet takes the values back as soon as it can, which may be before the other change.
    assert!((0..1_000).any(|_| is_overtaken()), "the other change was never the first one");
}
