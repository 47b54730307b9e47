//! Components that leave finish what they have begun.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{scope, sleep};
use std::time::{Duration, Instant};

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Time, Work};
use saoms_core::report::RunStatus;
use saoms_core::schedule::{ChangeError, ChangeOptions, ChangeWithdrawal, Changed, Order, RunningFleet, Speed};
use saoms_core::status::ComponentStatus;
use saoms_lang::assembly::Assembly;
use saoms_lang::registry::Registry;

use crate::actor::Actor;
use crate::fleet::{Diary, assembly_of, real, simulated};

/// Needs some more executions when it is to leave.
#[derive(Class)]
#[class(name = "worker", periodic)]
struct Worker {
    /// True if it is to leave.
    #[property(default = false, live)]
    leaving: bool,
    /// The executions that it needs to finish.
    #[property(default = 3)]
    needs: u32,
    /// True if it refuses to leave.
    #[property(default = false)]
    refuses: bool,
    left: u32,
}

impl Component for Worker {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if !self.leaving {
            return Ok(());
        }
        if self.left > 0 {
            self.left -= 1;
            context.vote(Work::Open);
            context.console(format_args!("finishes"));
        } else {
            context.vote(Work::Done);
        }
        Ok(())
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        if properties.leaving && self.refuses {
            return Err(Failure::new("it is at home here"));
        }
        (self.leaving, self.left) = (properties.leaving, properties.needs);
        Ok(())
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.console(format_args!("ends with {} left, leaving {}", self.left, self.leaving));
        Ok(())
    }
}

macro_rules! vehicle {
    ($name:ident, $class:literal) => {
        /// Says in each execution whether it is stopped.
        #[derive(Class)]
        #[class(name = $class, periodic)]
        struct $name {
            /// True if it is stopped.
            #[property(default = false, live)]
            stopped: bool,
            /// Its build.
            #[property(default = 1)]
            build: u32,
            /// Its speed.
            #[property(default = 1, live)]
            speed: u32,
        }

        impl Component for $name {
            type Properties = saoms_api::Own<Self>;

            fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                let $name { stopped, build, speed } = self;
                context.console(format_args!(
                    "build {build} {} at {speed}",
                    if *stopped { "is stopped" } else { "moves" }
                ));
                Ok(())
            }

            fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
                (self.stopped, self.speed) = (properties.stopped, properties.speed);
                Ok(())
            }
        }
    };
}

vehicle!(Cart, "cart");
vehicle!(Van, "van");

/// Fails once when it is to leave, and has more to finish then.
#[derive(Class)]
#[class(name = "crashing", periodic)]
struct Crashing {
    /// True if it is to leave.
    #[property(default = false, live)]
    leaving: bool,
    executions: u32,
}

impl Component for Crashing {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.executions += 1;
        if self.leaving && !CRASHED.swap(true, Ordering::Relaxed) {
            return Err(Failure::new("it stumbles"));
        }
        if self.leaving {
            context.vote(if self.executions > 3 { Work::Done } else { Work::Open });
            if self.executions == 4 {
                context.console(format_args!("has finished"));
            }
        }
        Ok(())
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        self.leaving = properties.leaving;
        Ok(())
    }
}

static CRASHED: AtomicBool = AtomicBool::new(false);

fn wanted(text: &str) -> Assembly {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Actor>()).unwrap();
    registry.add(Registration::of::<Worker>()).unwrap();
    registry.add(Registration::of::<Cart>()).unwrap();
    registry.add(Registration::of::<Van>()).unwrap();
    registry.add(Registration::of::<Crashing>()).unwrap();
    assembly_of(text, &registry)
}

fn started(text: &str) -> (RunningFleet, Arc<Diary>) {
    let diary = Arc::new(Diary::default());
    (RunningFleet::start(wanted(text), real(60_000), vec![diary.clone()]).unwrap(), diary)
}

fn apply(fleet: &RunningFleet, text: &str, wait: u64) -> Result<Changed, ChangeError> {
    let options = ChangeOptions { wait: Duration::from_millis(wait), ..ChangeOptions::default() };
    fleet.handle().apply(&wanted(text), options)
}

fn end(fleet: RunningFleet) {
    fleet.handle().stop();
    fleet.run_to_end();
}

/// Nothing would change: neither at once nor once the component B has heard that it stays.
#[track_caller]
fn is_again(fleet: &RunningFleet, text: &str) {
    let is_same = || {
        let plan = fleet.handle().plan(&wanted(text));
        assert!(plan.is_empty(), "{plan:?}");
    };
    is_same();
    let executions = || component(fleet, "B").report.executions;
    let (before, until) = (executions(), Instant::now() + Duration::from_secs(20));
    while executions() < before + 3 {
        assert!(Instant::now() < until, "B does not go on");
        sleep(Duration::from_millis(1));
    }
    is_same();
}

#[track_caller]
fn component(fleet: &RunningFleet, name: &str) -> ComponentStatus {
    fleet.handle().status().components.into_iter().find(|one| one.report.name == name).unwrap()
}

#[test]
fn one_that_leaves_finishes_first() {
    let (fleet, diary) = started("A actor period=1\nB worker period=1\nC worker period=1 startup=false");
    assert_eq!(apply(&fleet, "A actor period=1", 60_000).unwrap().removed, ["C", "B"]);
    end(fleet);
    let told = diary.lines();
    assert_eq!(told.matches("B: finishes").count(), 3, "{told}");
    assert!(told.contains("B: ends with 0 left, leaving true") && !told.contains("C: ends"), "{told}");
}

#[test]
fn one_that_does_not_finish_in_time_ends_all_the_same_and_is_told() {
    for wait in [0, 50] {
        let (fleet, diary) = started("A actor period=1\nB worker period=1 needs=1000000\nC worker period=1 needs=0");
        let changed = apply(&fleet, "A actor period=1", wait).unwrap();
        assert_eq!(changed.removed, ["C", "B"]);
        assert!(changed.unfinished.contains(&"B".to_owned()), "{changed:?}");
        assert!(wait == 0 || changed.unfinished == ["B"], "{changed:?}");
        end(fleet);
        let told = diary.lines();
        // It has heard that it leaves before it ends.
        assert!(told.contains(" left, leaving true") && !told.contains("leaving false"), "{told}");
    }
}

#[test]
fn one_that_did_not_finish_in_time_is_called_back_when_the_change_fails() {
    let before = "A actor period=1\nB worker period=1 needs=1000000";
    let (fleet, diary) = started(before);
    let error = apply(&fleet, "A actor period=1\nX actor period=1 first=[fail no room]", 50).unwrap_err();
    assert_eq!(error.to_string(), "component `X` of class `actor` could not start: no room");
    is_again(&fleet, before);
    end(fleet);
    assert!(diary.lines().contains(" left, leaving false"), "{}", diary.lines());
}

#[test]
fn who_has_finished_is_called_back_when_the_change_fails() {
    let before = "A actor period=1\nB worker period=1";
    let (fleet, diary) = started(before);
    let error = apply(&fleet, "A actor period=1\nX actor period=1 first=[fail no room]", 60_000).unwrap_err();
    assert_eq!(error.to_string(), "component `X` of class `actor` could not start: no room");
    is_again(&fleet, before);
    let report = {
        fleet.handle().stop();
        fleet.run_to_end()
    };
    let told = diary.lines();
    assert!(told.contains("B: finishes") && told.contains("B: ends with 3 left, leaving false"), "{told}");
    // Its vote was none about the run, which would have been done.
    assert_eq!(report.outcome.status, RunStatus::Interrupted);
}

#[test]
fn one_that_refuses_stays() {
    let before = "A actor period=1\nB worker period=1 refuses=true";
    let (fleet, _) = started(before);
    for wait in [60_000, 0] {
        let error = apply(&fleet, "A actor period=1", wait).unwrap_err();
        let expected = "component `B`: it does not leave: component `B` refuses the value: it is at home here";
        assert_eq!(error.to_string(), expected);
        is_again(&fleet, before);
    }
    end(fleet);
}

#[test]
fn in_virtual_time_others_wait_for_those_that_leave_by_the_time_of_the_run() {
    let text = "A actor period=10\nB worker period=10";
    let fleet = RunningFleet::start(wanted(text), simulated(100_000), vec![]).unwrap();
    let handle = fleet.handle();
    // Nobody lets time advance.
    fleet.run_until(Time::from_nanos(5_000_000));
    let stands = apply(&fleet, "A actor period=10", 60_000).unwrap_err().to_string();
    assert!(stands.ends_with("while the time of the run stands still"), "{stands}");
    scope(|scope| {
        let changed = scope.spawn(move || handle.apply(&wanted("A actor period=10"), ChangeOptions::default()));
        let mut now = 5;
        while !changed.is_finished() && now < 90_000 {
            now += 1;
            fleet.run_until(Time::from_nanos(now * 1_000_000));
            sleep(Duration::from_millis(1));
        }
        assert_eq!(changed.join().unwrap().unwrap().removed, ["B"]);
        assert_eq!(fleet.run_to_end().outcome.status, RunStatus::Elapsed);
    });
}

#[test]
fn at_a_slow_speed_time_does_not_stand_still() {
    let fleet =
        RunningFleet::start(wanted("A actor period=10\nB worker period=10 needs=1"), simulated(100_000), vec![]);
    let fleet = fleet.unwrap();
    fleet.run_until(Time::from_nanos(5_000_000));
    let handle = fleet.handle();
    // More than a second from one execution to the next one.
    handle.set_speed(Speed::Factor(0.007)).unwrap();
    let changed = scope(|scope| {
        let changed = scope.spawn(|| {
            let changed = handle.apply(&wanted("A actor period=10"), ChangeOptions::default());
            handle.stop();
            changed
        });
        fleet.run_until(Time::from_nanos(90_000_000_000));
        changed.join().unwrap()
    });
    assert_eq!(changed.unwrap().removed, ["B"]);
    fleet.run_to_end();
}

#[test]
fn a_run_that_pauses_is_not_waited_for() {
    let (fleet, _) = started("A actor period=1\nB worker period=1 needs=1000000");
    fleet.handle().pause().unwrap();
    let stands = apply(&fleet, "A actor period=1", 60_000).unwrap_err().to_string();
    assert!(stands.ends_with("while the time of the run stands still"), "{stands}");
    fleet.handle().resume().unwrap();
    end(fleet);
}

#[test]
fn whoever_asked_for_a_change_takes_it_back_while_others_finish() {
    let before = "A actor period=1\nB worker period=1 needs=1000000";
    let (fleet, diary) = started(before);
    let withdrawal = ChangeWithdrawal::default();
    let options = ChangeOptions { withdrawal: withdrawal.clone(), ..ChangeOptions::default() };
    let changed = scope(|scope| {
        let changed = scope.spawn(|| fleet.handle().apply(&wanted("A actor period=1"), options));
        while !diary.lines().contains("B: finishes") {
            sleep(Duration::from_millis(1));
        }
        withdrawal.withdraw();
        changed.join().unwrap()
    });
    assert_eq!(changed, Err(ChangeError::Withdrawn));
    is_again(&fleet, before);
    end(fleet);
}

#[test]
fn a_change_that_is_taken_back_while_a_component_initializes_is_undone() {
    let before = "A actor period=1\nB worker period=1";
    let (fleet, diary) = started(before);
    let withdrawal = ChangeWithdrawal::default();
    let options = ChangeOptions { withdrawal: withdrawal.clone(), ..ChangeOptions::default() };
    let changed = scope(|scope| {
        let next = "A actor period=1\nX actor period=1 first=[log begins; sleep 300] last=[log ends]";
        let changed = scope.spawn(|| fleet.handle().apply(&wanted(next), options));
        while !diary.lines().contains("X: begins") {
            sleep(Duration::from_millis(1));
        }
        withdrawal.withdraw();
        changed.join().unwrap()
    });
    assert_eq!(changed, Err(ChangeError::Withdrawn));
    diary.until("X: ends");
    is_again(&fleet, before);
    end(fleet);
}

/// Gives an order, lets time advance until it has taken effect, and says whether it did.
fn give(fleet: &RunningFleet, order: Order) -> bool {
    fleet.handle().order(order, None).unwrap().wait(Duration::from_secs(10)).is_ok()
}

fn emergency_stop() -> Order {
    Order::EmergencyStop { components: Vec::new(), by: None }
}

/// What becomes of a change in virtual time, in which something happens while a component finishes what it has begun.
fn meanwhile(
    before: &str,
    after: &str,
    happens: impl FnOnce(&RunningFleet),
) -> (RunningFleet, Arc<Diary>, Result<Changed, ChangeError>) {
    let diary = Arc::new(Diary::default());
    let fleet = RunningFleet::start(wanted(before), simulated(1_000_000), vec![diary.clone()]).unwrap();
    fleet.run_until(Time::from_nanos(5_000_000));
    let (handle, after) = (fleet.handle(), wanted(after));
    let changed = scope(|scope| {
        let changed = scope.spawn(move || handle.apply(&after, ChangeOptions::allowing_loss()));
        let mut happens = Some(happens);
        let mut now = 5;
        while !changed.is_finished() && now < 60_000 {
            now += 1;
            fleet.run_until(Time::from_nanos(now * 1_000_000));
            if diary.lines().contains("B: finishes")
                && let Some(happens) = happens.take()
            {
                happens(&fleet);
            }
            sleep(Duration::from_millis(1));
        }
        changed.join().unwrap()
    });
    let now = fleet.handle().progress().time.as_nanos();
    fleet.run_until(Time::from_nanos(now + 50_000_000));
    (fleet, diary, changed)
}

#[test]
fn an_emergency_stop_while_others_finish_holds_for_those_that_are_replaced() {
    let before = "B worker period=10 needs=20\nC cart period=10\nD cart period=10";
    let after = "C cart period=10 build=2\nD van period=10 build=3";
    let (fleet, diary, changed) = meanwhile(before, after, |fleet| assert!(give(fleet, emergency_stop())));
    let changed = changed.unwrap();
    assert_eq!((changed.removed.len(), changed.replaced.len(), changed.added.len()), (2, 1, 1), "{changed:?}");
    ["C: build 1 is stopped at 1", "C: build 2 is stopped at 1", "D: build 3 is stopped at 1"]
        .iter()
        .for_each(|one| diary.until(one));
    let told = diary.lines();
    assert!(!told.contains("build 2 moves") && !told.contains("build 3 moves"), "{told}");
    assert!(component(&fleet, "C").emergency_stop && component(&fleet, "D").emergency_stop);
    assert!(give(&fleet, Order::Release { components: Vec::new(), by: None }));
    let now = fleet.handle().progress().time.as_nanos();
    fleet.run_until(Time::from_nanos(now + 50_000_000));
    ["C: build 2 moves", "D: build 3 moves"].iter().for_each(|one| diary.until(one));
    end(fleet);
}

#[test]
fn an_emergency_stop_amid_a_change_of_class_that_is_undone_holds_for_the_present_one() {
    let before = "A actor period=1\nD cart period=1";
    let after =
        "A actor period=1\nD van period=1 build=2\nX actor period=1 first=[log begins; sleep 400; fail no room]";
    let (fleet, diary) = started(before);
    let given = |order: Order| fleet.handle().order(order, None).unwrap().wait(Duration::from_secs(10)).unwrap();
    let until = |what: &str| {
        let until = Instant::now() + Duration::from_secs(20);
        while !diary.lines().contains(what) {
            assert!(Instant::now() < until, "`{what}` is never told: {}", diary.lines());
            sleep(Duration::from_millis(1));
        }
    };
    scope(|scope| {
        let options = ChangeOptions::allowing_loss();
        let changed = scope.spawn(|| fleet.handle().apply(&wanted(after), options));
        until("X: begins");
        // It is the new one that hears of it.
        given(emergency_stop());
        assert!(changed.join().unwrap().is_err());
    });
    until("D: build 1 is stopped at 1");
    assert!(component(&fleet, "D").emergency_stop);
    let moves = |diary: &Diary| diary.lines().matches("D: build 1 moves").count();
    let before = moves(&diary);
    given(Order::Release { components: Vec::new(), by: None });
    let last = Instant::now() + Duration::from_secs(20);
    while moves(&diary) == before {
        assert!(Instant::now() < last, "it does not move again");
        sleep(Duration::from_millis(1));
    }
    assert!(!diary.lines().contains("build 2"), "{}", diary.lines());
    end(fleet);
}

#[test]
fn a_value_that_is_set_while_others_finish_is_not_lost() {
    let before = "B worker period=10 needs=20\nC cart period=10";
    let set = Order::Set { component: "C".to_owned(), property: "speed".to_owned(), value: "7".to_owned() };
    let (fleet, diary, changed) = meanwhile(before, "C cart period=10 build=2", |fleet| assert!(give(fleet, set)));
    assert_eq!(changed.unwrap_err().to_string(), "the fleet changed meanwhile: ask again");
    let told = diary.lines();
    assert!(told.contains("C: build 1 moves at 7") && !told.contains("build 2"), "{told}");
    assert!(!component(&fleet, "B").report.name.is_empty(), "it stays");
    end(fleet);
}

#[test]
fn one_that_fails_while_it_leaves_finishes_after_its_restart() {
    let (fleet, diary) = started("A actor period=1\nB crashing period=1 restart=20/3");
    assert_eq!(apply(&fleet, "A actor period=1", 60_000).unwrap().removed, ["B"]);
    end(fleet);
    let told = diary.lines();
    assert!(told.contains("it stumbles") && told.contains("B: has finished"), "{told}");
}

#[test]
fn a_second_change_is_refused_at_once_and_a_plan_is_made_meanwhile() {
    let before = "A actor period=1\nB worker period=1 needs=1000000";
    let (fleet, diary) = started(before);
    let handle = fleet.handle();
    scope(|scope| {
        let first = scope.spawn(|| apply(&fleet, "A actor period=1", 2_000));
        while !diary.lines().contains("B: finishes") {
            sleep(Duration::from_millis(1));
        }
        assert!(handle.plan(&wanted(before)).is_empty());
        let second = apply(&fleet, "A actor period=2", 60_000).unwrap_err();
        assert_eq!(second.to_string(), "another change of the fleet is being made: ask again");
        assert!(!first.is_finished(), "it was made meanwhile");
        first.join().unwrap().unwrap();
    });
    end(fleet);
}
