//! What outlives a crash of a component: what it keeps, and what it saves after each execution; and properties that
//! change while it runs.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Saved, Time};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::registry::Registry;

use crate::actor::{Actor, TALK, Words};
use crate::fleet::{Diary, assembly_of, outcome, real, simulated, unindent};

#[derive(Clone, Debug, Message)]
struct State {
    count: u32,
}

/// Counts in steps, keeps the number, and can go on from it.
#[derive(Class)]
#[class(name = "counter", periodic, saves)]
struct Counter {
    /// Step of the count.
    #[property(default = 1, range = 1..=10, live)]
    step: u32,
    /// Executions that fail, by numbers with blanks around them.
    #[property(default = "")]
    fails: String,
    /// Executions that panic.
    #[property(default = "")]
    panics: String,
    /// True if it refuses to restore its state.
    #[property(default = false)]
    forgets: bool,
    #[publishes(TALK)]
    words: Publisher<Words>,
    count: u32,
}

impl Component for Counter {
    type Properties = Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let line = format!("starts, kept {:?}", context.kept());
        context.info(line);
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.count += self.step;
        let now = format!(" {} ", context.now().as_nanos() / 1_000_000);
        context.keep(1, &[0])?;
        context.keep(1, &self.count.to_le_bytes()[..1])?;
        context.keep(2, &[7, 7][..self.count as usize % 3])?;
        context.send(&self.words, Words { text: format!("{}", self.count) })?;
        if self.fails.contains(&now) {
            return Err("it was told to".into());
        }
        assert!(!self.panics.contains(&now), "it was told to"); // PANIC
        context.info(format!("counts {}, kept {:?}", self.count, context.kept()));
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&State { count: self.count }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        if self.forgets {
            return Err("it has no memory".into());
        }
        self.count = saved.read::<State>()?.map_or(0, |state| state.count);
        Ok(())
    }
}

/// Refuses every change of its property but one.
#[derive(Class)]
#[class(name = "stubborn", periodic)]
struct Stubborn {
    /// Its mood.
    #[property(default = 1, live)]
    mood: u32,
    /// What cannot change.
    #[property(default = 1)]
    age: u32,
}

impl Component for Stubborn {
    type Properties = Own<Self>;

    fn update(&mut self, properties: Own<Self>) -> Result<(), Failure> {
        match properties.mood {
            7 => self.mood = 7,
            8 => panic!("not eight"),
            other => return Err(Failure::new(format!("{other} is no mood"))),
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.info(format!("mood {} at the age of {}", self.mood, self.age));
        Ok(())
    }
}

/// Waits in each execution, as code may that never runs on the timer.
#[derive(Class)]
#[class(name = "waiter", periodic, apart)]
struct Waiter {}

impl Component for Waiter {
    type Properties = ();

    fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        assert_ne!(thread::current().name(), Some("saoms-timer"), "it runs on the timer");
        thread::sleep(Duration::from_millis(5));
        Ok(())
    }
}

pub(crate) fn start(fleet: &str, settings: Settings) -> (RunningFleet, Arc<Diary>) {
    let mut registry = Registry::new();
    for class in [
        Registration::of::<Actor>(),
        Registration::of::<Counter>(),
        Registration::of::<Stubborn>(),
        Registration::of::<Waiter>(),
    ] {
        registry.add(class).unwrap();
    }
    let diary = Arc::new(Diary::default());
    (RunningFleet::start(assembly_of(fleet, &registry), settings, vec![diary.clone()]).unwrap(), diary)
}

#[track_caller]
fn check(fleet: &str, milliseconds: u64, expected: &str) {
    let (fleet, diary) = start(fleet, simulated(milliseconds));
    let report = fleet.run_to_end();
    let panics = include_str!("kept.rs").lines().position(|line| line.ends_with("// PANIC")).unwrap() + 1;
    let expected = unindent(expected).replace("LINE", &panics.to_string());
    assert_eq!(format!("{}{}", diary.lines(), outcome(&report)), expected);
}

#[test]
fn a_restart_goes_on_from_the_last_execution_that_did_not_fail() {
    check(
        "A counter period=10 restart=5/3 fails=[ 20 ] panics=[ 35 ]
         B actor period=5 subscribes=TALK each=[hear]",
        50,
        "[0.000 s] A: starts, kept {}
         [0.000 s] A: counts 1, kept {}
         [0.000 s] B: hears []
         [0.005 s] B: hears [1]
         [0.010 s] A: counts 2, kept {1: [1], 2: [7]}
         [0.010 s] B: hears []
         [0.015 s] B: hears [2]
         [0.020 s] A: failed and is restarted in 5ms: it was told to (messages of this execution that are not sent: 1)
         [0.020 s] B: hears []
         [0.025 s] A: starts, kept {1: [2], 2: [7, 7]}
         [0.025 s] A: restarted (1), and continues
         [0.025 s] A: counts 3, kept {1: [2], 2: [7, 7]}
         [0.025 s] B: hears []
         [0.030 s] B: hears [3]
         [0.035 s] A: failed and is restarted in 10ms: panicked at saoms-core/tests/suite/kept.rs:LINE:9: it was told to (messages of this execution that are not sent: 1)
         [0.035 s] B: hears []
         [0.040 s] B: hears []
         [0.045 s] A: starts, kept {1: [3]}
         [0.045 s] A: restarted (2), and continues
         [0.045 s] A: counts 4, kept {1: [3]}
         [0.045 s] B: hears []
         Elapsed after 0.05 s",
    );
}

#[test]
fn a_state_that_cannot_be_restored_is_forgotten() {
    check(
        "A counter period=10 restart=5/3 fails=[ 10 ] forgets=true",
        30,
        "[0.000 s] A: starts, kept {}
         [0.000 s] A: counts 1, kept {}
         [0.010 s] A: failed and is restarted in 5ms: it was told to (messages of this execution that are not sent: 1)
         [0.015 s] A: starts, kept {1: [1], 2: [7]}
         [0.015 s] A: failed and is restarted in 10ms: could not start: could not continue with its saved state: it has no memory
         [0.025 s] A: starts, kept {1: [1], 2: [7]}
         [0.025 s] A: restarted (2)
         [0.025 s] A: counts 1, kept {1: [1], 2: [7]}
         Elapsed after 0.03 s",
    );
}

#[test]
fn who_is_scheduled_anew_begins_anew_and_knows_what_it_kept() {
    check(
        "A counter period=10 restart=5/3
         B actor period=100 delay=15 task=A each=[unschedule; schedule]",
        20,
        "[0.000 s] A: starts, kept {}
         [0.000 s] A: counts 1, kept {}
         [0.010 s] A: counts 2, kept {1: [1], 2: [7]}
         [0.015 s] A: starts, kept {1: [2], 2: [7, 7]}
         [0.015 s] A: counts 1, kept {1: [2], 2: [7, 7]}
         Elapsed after 0.02 s",
    );
}

#[test]
fn a_live_property_changes_between_two_executions_and_stays_through_a_restart() {
    let (fleet, diary) = start("A counter period=10 restart=5/3 fails=[ 30 ]", simulated(50));
    fleet.run_until(Time::from_nanos(15_000_000));
    let handle = fleet.handle();
    assert_eq!(handle.set("A", "step", "5"), Ok(()));
    fleet.run_until(Time::from_nanos(25_000_000));
    let refused = |property, value| handle.set("A", property, value).unwrap_err().to_string();
    assert_eq!(refused("step", "11"), "property `step`: `11` is out of range: expected a whole number from 1 to 10");
    assert_eq!(refused("stepp", "1"), "class `counter` has no property `stepp`: did you mean `step`?");
    let told = "property `fails` of class `counter` cannot change while the component runs: it can set `step`";
    assert_eq!(refused("fails", "1"), told);
    let unknown = handle.set("C", "step", "1").unwrap_err().to_string();
    assert!(unknown.starts_with("the fleet has no component `C`"), "{unknown}");
    let report = fleet.run_to_end();
    let counts: Vec<String> = diary.lines().lines().filter(|line| line.contains("counts")).map(str::to_owned).collect();
    let counts: Vec<&str> =
        counts.iter().map(|line| &line[line.find("counts").unwrap()..line.find(',').unwrap()]).collect();
    assert_eq!(counts, ["counts 1", "counts 2", "counts 7", "counts 12", "counts 17"], "{}", diary.lines());
    assert_eq!(report.outcome.reasons, Vec::<String>::new());
    let journal = serde_json::to_string(&report.journal).unwrap();
    assert!(journal.contains("set A step=5") && !journal.contains("step=11"), "{journal}");
}

#[test]
fn a_component_can_refuse_a_value_and_goes_on() {
    let (fleet, diary) = start("A stubborn period=10", simulated(30));
    fleet.run_until(Time::from_nanos(5_000_000));
    let refused = |value| fleet.handle().set("A", "mood", value).unwrap_err().to_string();
    assert_eq!(refused("3"), "component `A` refuses the value: 3 is no mood");
    assert!(refused("8").contains("component `A` refuses the value: panicked at"));
    fleet.run_until(Time::from_nanos(15_000_000));
    assert_eq!(fleet.handle().set("A", "mood", "7"), Ok(()));
    fleet.run_to_end();
    let expected = "[0.000 s] A: mood 1 at the age of 1\n[0.010 s] A: mood 1 at the age of 1\n[0.020 s] A: mood 7 at the age of 1\n";
    assert_eq!(diary.lines(), expected);
}

#[test]
fn a_value_is_set_in_real_time_while_the_component_executes() {
    let (fleet, _) = start("A counter period=1", real(10_000));
    for value in ["2", "3", "4"] {
        assert_eq!(fleet.handle().set("A", "step", value), Ok(()));
        thread::sleep(Duration::from_millis(5));
    }
    fleet.handle().stop();
    fleet.run_to_end();
}

#[test]
fn a_class_that_is_apart_and_who_calls_it_never_run_on_the_timer() {
    // A timer that is held up becomes a worker, and keeps its name: none is here, however busy the machine is.
    let settings = Settings { budget: Duration::from_secs(10), ..real(300) };
    let (fleet, diary) = start("A waiter period=10\nB actor period=2", settings);
    let report = fleet.run_to_end();
    assert_eq!(outcome(&report), "Elapsed after 0.3 s", "{}", diary.lines());
    let of = |name: &str| report.components.iter().find(|one| one.name == name).unwrap();
    assert_eq!(of("A").slow, 0, "it may wait");
    assert!(of("A").executions > 0 && of("B").executions > of("A").executions, "{:?}", report.components);
}
