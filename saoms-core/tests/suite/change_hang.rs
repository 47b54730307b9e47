//! Code of components that does not return while a fleet changes.

use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Message, Saved, StopFunction, Time};
use saoms_core::observe::Occurrence;
use saoms_core::report::RunStatus;
use saoms_core::schedule::{
    ChangeError, ChangeOptions, Changed, InjectedContent, Injection, Order, RunningFleet, Settings,
};
use saoms_lang::assembly::Assembly;
use saoms_lang::registry::Registry;

use crate::actor::{Actor, Callee};
use crate::fleet::{Diary, assembly_of, real, simulated};
use crate::stop::Wire;

#[derive(Clone, Debug, Default, Message)]
struct Count {
    executions: u32,
}

/// Takes its time for what its properties say.
#[derive(Class)]
#[class(name = "mule", periodic, saves)]
struct Mule {
    /// What it carries.
    #[property(default = 0, live)]
    load: u32,
    /// The milliseconds that it takes for each piece of another load.
    #[property(default = 0)]
    slow: u32,
    /// The milliseconds that it takes to save its state.
    #[property(default = 0)]
    saves: u32,
    executions: u32,
}

impl Component for Mule {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.executions += 1;
        context.console(format_args!("{} with {}", self.executions, self.load));
        Ok(())
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        if properties.load == 13 {
            return Err(Failure::new("it is too heavy"));
        }
        sleep(Duration::from_millis(u64::from(self.slow * properties.load)));
        self.load = properties.load;
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        sleep(Duration::from_millis(self.saves.into()));
        Ok(Saved::of(&Count { executions: self.executions }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.executions = saved.read::<Count>()?.unwrap_or_default().executions;
        Ok(())
    }
}

/// Lifts something with hardware that has a name.
#[derive(Class)]
#[class(name = "lift", periodic, stops)]
struct Lift {
    /// The name.
    #[property(default = "")]
    wire: String,
    /// What it carries: it takes something else once its hardware has been stopped.
    #[property(default = 0, live)]
    load: u32,
    /// True if it begins once its hardware has been stopped.
    #[property(default = false)]
    hangs: bool,
    /// The milliseconds that it takes to begin, or for another load, if nobody has to stop it.
    #[property(default = 0)]
    takes: u64,
}

impl Component for Lift {
    type Properties = saoms_api::Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let wire = Wire::of(&self.wire);
        context.register_stop(StopFunction::new(move || {
            wire.hear("stop");
            Ok(())
        }))?;
        sleep(Duration::from_millis(self.takes));
        if self.hangs {
            Wire::of(&self.wire).wait_for("stop");
            Wire::of(&self.wire).hear("stopped while it hangs");
        }
        Ok(())
    }

    fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        if self.takes > 0 {
            sleep(Duration::from_millis(self.takes));
            self.load = properties.load;
            return Ok(());
        }
        // It would be left behind after half a second.
        let is_stopped = (0..350).any(|_| {
            sleep(Duration::from_millis(1));
            Wire::of(&self.wire).count("stop") > 0
        });
        self.load = properties.load;
        if is_stopped { Ok(()) } else { Err(Failure::new("nobody stops it")) }
    }
}

fn wanted(text: &str) -> Assembly {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Actor>()).unwrap();
    registry.add(Registration::of::<Mule>()).unwrap();
    registry.add(Registration::of::<Lift>()).unwrap();
    registry.add(Registration::of::<Callee>()).unwrap();
    assembly_of(text, &registry)
}

fn started(text: &str) -> (RunningFleet, Arc<Diary>) {
    let diary = Arc::new(Diary::default());
    let settings = Settings { grace: Duration::from_millis(200), ..real(120_000) };
    (RunningFleet::start(wanted(text), settings, vec![diary.clone()]).unwrap(), diary)
}

fn apply(fleet: &RunningFleet, text: &str) -> Result<Changed, ChangeError> {
    fleet.handle().apply(&wanted(text), ChangeOptions::allowing_loss())
}

#[track_caller]
fn until(what: &str, is: impl Fn() -> bool) {
    let last = Instant::now() + Duration::from_secs(30);
    while !is() {
        assert!(Instant::now() < last, "{what}");
        sleep(Duration::from_millis(2));
    }
}

fn executions(fleet: &RunningFleet, name: &str) -> u64 {
    let components = fleet.handle().status().components;
    components.into_iter().find(|one| one.report.name == name).unwrap().report.executions
}

/// A component executes again.
#[track_caller]
fn goes_on(fleet: &RunningFleet, name: &str) {
    let before = executions(fleet, name);
    until("it does not go on", || executions(fleet, name) > before + 2);
}

#[track_caller]
fn is_again(fleet: &RunningFleet, text: &str) {
    let plan = fleet.handle().plan(&wanted(text));
    assert!(plan.is_empty(), "{plan:?}");
}

#[track_caller]
fn ends(fleet: RunningFleet) {
    fleet.handle().stop();
    let report = fleet.run_to_end();
    assert_eq!(report.outcome.status, RunStatus::Interrupted, "{:?}", report.outcome);
}

#[test]
fn one_that_does_not_initialize_in_time_is_left_behind() {
    let before = "A actor period=1";
    let (fleet, diary) = started(before);
    let next = "A actor period=1\nW actor period=1 last=[log ends]\nX actor period=1 publishes=TALK \
                first=[log begins; sleep 700; log is late; say hello]";
    let error = apply(&fleet, next).unwrap_err();
    let expected = "component `X` of class `actor` could not start: `initialize` has not returned within 200ms, and \
                    its thread is left behind";
    assert_eq!(error.to_string(), expected);
    is_again(&fleet, before);
    goes_on(&fleet, "A");
    diary.until("W: ends");
    // The next one of its path has nothing to do with it, also when that returns.
    let again = "A actor period=1\nX actor period=1 each=[2: log goes] publishes=TALK";
    assert_eq!(apply(&fleet, again).unwrap().added, ["X"]);
    until("it never returns", || diary.lines().contains("X: is late"));
    goes_on(&fleet, "X");
    is_again(&fleet, again);
    assert_eq!(apply(&fleet, before).unwrap().removed, ["X"]);
    ends(fleet);
}

#[test]
fn one_that_does_not_take_its_values_in_time_goes_on_with_those_that_it_had() {
    let before = "A mule period=1 load=1\nB mule period=1 load=1 slow=100\nC mule period=1";
    let (fleet, diary) = started(before);
    let error = apply(&fleet, "A mule period=1 load=2\nB mule period=1 load=12 slow=100\nC mule period=2").unwrap_err();
    let why = "`update` has not returned within 500ms, and its thread is left behind".to_owned();
    assert_eq!(error, ChangeError::NotNow { component: "B".to_owned(), why });
    is_again(&fleet, before);
    goes_on(&fleet, "A");
    goes_on(&fleet, "C");
    // Another change has to wait for it.
    let error = apply(&fleet, "A mule period=1 load=1\nC mule period=1").unwrap_err();
    assert_eq!(error.to_string(), "component `B`: its code has not returned yet");
    goes_on(&fleet, "B");
    is_again(&fleet, before);
    let told = diary.lines();
    assert!(!told.contains("with 12") && !told.contains("A: 1 with 2") && !told.contains("Failed"), "{told}");
    assert_eq!(apply(&fleet, "A mule period=1 load=1\nC mule period=1").unwrap().removed, ["B"]);
    ends(fleet);
}

#[test]
fn one_that_does_not_take_its_values_back_in_time_does_so_later() {
    let before = "A mule period=1 load=9 slow=100\nB mule period=1 load=1";
    let (fleet, diary) = started(before);
    // It takes the new value at once, and the old one slowly.
    let error = apply(&fleet, "A mule period=1 load=0 slow=100\nB mule period=1 load=13").unwrap_err();
    assert_eq!(error.to_string(), "component `B` of class `mule` refuses its new values: it is too heavy");
    goes_on(&fleet, "B");
    goes_on(&fleet, "A");
    is_again(&fleet, before);
    let told = diary.lines();
    let expected = "does not take back the values that it had: `update` has not returned within 500ms";
    assert!(told.contains(expected) && !told.contains("with 0"), "{told}");
    ends(fleet);
}

#[test]
fn one_that_does_not_save_its_state_in_time_goes_on() {
    let before = "A actor period=1\nB mule period=1 saves=700";
    let (fleet, _) = started(before);
    let error = apply(&fleet, "A actor period=1\nB mule period=2 saves=700").unwrap_err();
    let why = "`save` has not returned within 200ms, and its thread is left behind".to_owned();
    assert_eq!(error, ChangeError::NotNow { component: "B".to_owned(), why });
    is_again(&fleet, before);
    goes_on(&fleet, "A");
    goes_on(&fleet, "B");
    ends(fleet);
}

#[test]
fn one_that_is_removed_and_does_not_end_is_left_behind() {
    let (fleet, diary) = started("A actor period=1\nB actor period=1 last=[sleep 700; log ends]");
    assert_eq!(apply(&fleet, "A actor period=1").unwrap().removed, ["B"]);
    goes_on(&fleet, "A");
    assert_eq!(apply(&fleet, "A actor period=1\nB actor period=1").unwrap().added, ["B"]);
    until("it never ends", || diary.lines().contains("B: ends"));
    goes_on(&fleet, "B");
    fleet.handle().stop();
    let report = fleet.run_to_end();
    let expected = "component `B` was removed, and did not end: `shutdown` has not returned within 200ms, and its \
                    thread is left behind";
    assert_eq!(report.outcome.reasons, [expected], "{:?}", report.outcome);
}

#[test]
fn one_that_is_removed_and_whose_call_does_not_return_has_no_say_any_more() {
    for vote in ["open", "done"] {
        let diary = Arc::new(Diary::default());
        let settings = Settings { grace: Duration::from_millis(100), ..real(20_000) };
        let kept = "A actor period=1 subscribes=TALK each=[hear; 600+: done]";
        let text = format!(
            "{kept}\nP callee publishes=TALK called=[sleep 400; {vote}; say late; log is back]\n\
             R actor period=1 peer=P last=[ask me]"
        );
        let fleet = RunningFleet::start(wanted(&text), settings, vec![diary.clone()]).unwrap();
        assert_eq!(apply(&fleet, kept).unwrap().removed, ["R", "P"]);
        diary.until("P: is back");
        let report = fleet.run_to_end();
        assert!(report.components[0].executions > 600, "{vote}: it has ended before A said so");
        let why = ["R` was removed, and did not end: `shutdown` has not", "P` was removed, and did not end: a call"];
        let reasons = &report.outcome.reasons;
        assert!(
            reasons.len() == 2 && why.iter().zip(reasons).all(|(why, one)| one.contains(why)),
            "{vote}: {reasons:?}"
        );
        assert!(!diary.lines().contains("late"), "{}", diary.lines());
    }
}

#[test]
fn a_change_is_undone_although_one_that_began_does_not_end() {
    let before = "A actor period=1";
    let (fleet, diary) = started(before);
    let next = "A actor period=1\nX actor period=1 last=[sleep 700]\nY actor period=1 first=[fail no room]";
    let error = apply(&fleet, next).unwrap_err();
    assert_eq!(error.to_string(), "component `Y` of class `actor` could not start: no room");
    is_again(&fleet, before);
    goes_on(&fleet, "A");
    until("that it hangs is told", || {
        diary.lines().contains("could not shut down: `shutdown` has not returned within 200ms")
    });
    ends(fleet);
}

#[test]
fn what_is_left_behind_holds_nobody_up() {
    const READS: &str = "actor period=10 queue=4 subscribes=TALK";
    let both = format!("A {READS} each=[hear]\nB {READS} each=[hear]");
    for (what, before, next) in [
        ("one that joins", both.clone(), format!("{both}\nX {READS} first=[sleep 3000]")),
        ("one that takes over", both.clone(), both.replacen("each", "first=[sleep 3000] each", 1)),
        (
            "one that ends",
            format!("A {READS} each=[hear]\nB {READS} last=[sleep 3000] each=[hear]"),
            both[..both.find('\n').unwrap()].to_owned(),
        ),
    ] {
        let diary = Arc::new(Diary::default());
        let settings = Settings { grace: Duration::from_millis(200), ..simulated(400) };
        let fleet = RunningFleet::start(wanted(&before), settings, vec![diary.clone()]).unwrap();
        fleet.run_until(Time::from_nanos(5_000_000));
        assert_eq!(apply(&fleet, &next).is_ok(), what == "one that ends");
        for number in 0..20 {
            let content = InjectedContent::Fields(serde_json::json!({ "text": format!("word{number}") }));
            let (topic, text) = ("TALK".to_owned(), format!("word{number}"));
            fleet.handle().inject(Injection { topic, content, at: None, text }).unwrap();
        }
        let report = fleet.run_to_end();
        let told = diary.lines();
        let heard = |number: &usize| told.contains(&format!("word{number}"));
        let missing: Vec<usize> = (0..20).filter(|number| !heard(number)).collect();
        assert_eq!(missing, [0; 0], "{what}: {told}");
        let lost: Vec<_> = report.outcome.reasons.iter().filter(|reason| !reason.contains("was removed")).collect();
        assert!(lost.is_empty(), "{what}: {lost:?}");
    }
}

#[test]
fn what_is_left_behind_acts_on_nobody() {
    let before = "P callee called=[log serves]";
    let (fleet, diary) = started(&format!("{before}\nA actor period=1"));
    let next = "X actor period=1 peer=P first=[until-cancelled; count late 1; report said 1; ask for me; \
                publish-late; log goes on]";
    let error = apply(&fleet, &format!("{before}\nA actor period=1\n{next}")).unwrap_err();
    assert!(error.to_string().ends_with("and its thread is left behind"), "{error}");
    let why = "it did not return in time, and the change of the fleet has left it behind";
    until("it never asks", || diary.lines().contains(&format!("X: is told nothing: {why}")));
    goes_on(&fleet, "A");
    let told = diary.lines();
    assert!(!told.contains("P: serves") && !told.contains("X: goes on"), "{told}");
    fleet.handle().stop();
    let report = fleet.run_to_end();
    assert!(!report.sections.contains_key("late") && !report.sections.contains_key("said"), "{:?}", report.sections);
}

#[test]
fn hardware_is_stopped_while_code_hangs_in_a_change() {
    let (fleet, _) = started("A lift period=1 wire=hangs-in-change");
    let changed = apply(&fleet, "A lift period=1 wire=hangs-in-change load=1").unwrap();
    assert_eq!(changed.updated, ["A"]);
    ends(fleet);
    let (fleet, _) = started("A lift period=1 wire=left-behind");
    let error = apply(&fleet, "A lift period=1 wire=left-behind hangs=true").unwrap_err();
    assert!(error.to_string().ends_with("and its thread is left behind"), "{error}");
    Wire::of("left-behind").wait_for("stopped while it hangs");
    goes_on(&fleet, "A");
    // Both instances have been told, and the present one is not told again when the code of the other one returns.
    sleep(Duration::from_millis(100));
    assert!(Wire::of("left-behind").count("stop") <= 2);
    ends(fleet);
}

#[test]
fn code_of_a_change_does_not_hang_because_the_fleet_has_paused_for_long() {
    let diary = Arc::new(Diary::default());
    let before = "A lift period=400 takes=250 wire=in-a-pause";
    let fleet = RunningFleet::start(wanted(before), real(120_000), vec![diary.clone()]).unwrap();
    fleet.handle().pause().unwrap();
    // Longer than code may take.
    sleep(Duration::from_millis(1000));
    let after = "A lift period=400 takes=250 wire=in-a-pause load=1\nB lift period=400 takes=250 wire=in-a-pause";
    let changed = apply(&fleet, after).unwrap();
    assert_eq!((changed.updated, changed.added), (vec!["A".to_owned()], vec!["B".to_owned()]));
    let set = Order::Set { component: "A".to_owned(), property: "load".to_owned(), value: "2".to_owned() };
    fleet.handle().order(set, None).unwrap().wait(Duration::from_secs(20)).unwrap();
    fleet.handle().resume().unwrap();
    goes_on(&fleet, "A");
    assert_eq!(Wire::of("in-a-pause").count("stop"), 0);
    ends(fleet);
    assert_eq!(diary.count(|event| matches!(event.what, Occurrence::Hangs { .. })), 0, "{}", diary.lines());
}
