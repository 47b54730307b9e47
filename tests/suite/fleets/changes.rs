//! A running airport is changed again and again, and every third change is made to fail: no robots collide, no luggage
//! is lost, and what does not change misses nothing.
//!
//! `SAOMS_CHANGES=2000` makes it a long one, and `SAOMS_SEED` another one.

mod gauges;
mod leaving;
mod wish;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::thread::{scope, sleep};
use std::time::Duration;

use saoms_api::host::cdr;
use saoms_api::{Chance, Time};
use saoms_components::messages::{ENVIRONMENT, EnvironmentEvent, Fault};
use saoms_core::observe::InvariantWatch;
use saoms_core::report::RunStatus;
use saoms_core::schedule::{
    ChangeOptions, ChangeWithdrawal, InjectedContent, Injection, PlannedChanges, RunningFleet, Settings,
};
use saoms_lang::assembly::Assembly;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_tools::diagnostics::human_of;
use serde_json::json;

use gauges::{How, plant};
use wish::{KINDS, Kind, Planted, Step, Wish};

/// Number of changes, unless `SAOMS_CHANGES` says another one.
const CHANGES: usize = 200;

/// A time that all periods divide, in milliseconds.
const STEP: u64 = 400;

fn compiled(text: &str, registry: &Registry) -> Assembly {
    let compilation = Project::new().text("airport.composite", text).in_memory().compile(registry);
    let shown = human_of(&compilation);
    compilation.output.unwrap_or_else(|| panic!("{shown}\n{text}"))
}

/// The executions of each component, those that it missed, and its period in milliseconds.
fn executions(fleet: &RunningFleet) -> BTreeMap<String, (u64, u64, Option<u64>)> {
    let status = fleet.handle().status();
    let all = status.components.into_iter();
    all.map(|one| {
        (one.report.name.into(), (one.report.executions, one.report.missed, one.period_ms.map(|ms| ms as u64)))
    })
    .collect()
}

fn touched(plan: &PlannedChanges) -> BTreeSet<String> {
    let members = plan.added.iter().chain(&plan.removed).map(|one| one.component.clone());
    let replaced = plan.replaced.iter().map(|one| one.component.clone());
    members.chain(replaced).chain(plan.set.iter().map(|one| one.component.clone())).collect()
}

/// Lets time pass until a component whose code had hung executes again; gives that time.
fn goes_on(fleet: &RunningFleet, name: &str, mut now: u64) -> u64 {
    let before = executions(fleet)[name].0;
    for _ in 0..10_000 {
        now += STEP;
        fleet.run_until(Time::from_nanos(now * 1_000_000));
        if executions(fleet)[name].0 > before {
            return now;
        }
        sleep(Duration::from_millis(1));
    }
    panic!("{name} does not go on");
}

#[test]
fn an_airport_that_changes_again_and_again_loses_nothing() {
    let number = |name: &str| std::env::var(name).ok().and_then(|number| number.parse::<u32>().ok());
    let changes = number("SAOMS_CHANGES").map_or(CHANGES, |changes| changes as usize);
    let seed = u64::from(number("SAOMS_SEED").unwrap_or(24));
    let registry = Registry::linked().unwrap();
    let mut chance = Chance::new(seed);
    let pieces = changes / 2;
    let mut present = Wish::first();
    let watch = Arc::new(InvariantWatch::default());
    let assembly = |wish: &Wish| compiled(&wish.composite(pieces), &registry);
    // Of the machine: a change waits for code that hangs for so long.
    let grace = Duration::from_secs(1);
    let settings = Settings { limit: Some(Duration::from_secs(100_000)), grace, ..Settings::simulated(seed) };
    let fleet = RunningFleet::start(assembly(&present), settings, vec![watch.clone()]).unwrap();
    let handle = fleet.handle();
    let hold = handle.hold();
    let (mut now, mut history) = (0, Vec::new());
    let mut made: BTreeMap<Kind, (u32, u32)> = BTreeMap::new();
    let mut steps: BTreeMap<Step, u32> = BTreeMap::new();
    for change in 0..changes {
        now += STEP * (1 + chance.below(6));
        fleet.run_until(Time::from_nanos(now * 1_000_000));
        let (before, since) = (executions(&fleet), now);
        // Each kind as often as the others, and every third change of each fails.
        let kind = KINDS[change % KINDS.len()];
        let mut wanted = present.with(kind, &mut chance);
        wanted.failure = match change % 3 {
            0 => Some(Planted::drawn(&mut chance)),
            _ => (chance.below(8) == 0).then(Planted::of_removed),
        };
        let next = assembly(&wanted);
        let plan = handle.plan(&next);
        assert!(!plan.is_empty() && plan.refused.is_empty(), "{change}: {kind:?}: {plan:?}");
        let withdrawal = ChangeWithdrawal::default();
        plant(wanted.failure.map(|planted| (planted.how, withdrawal.clone())));
        let wait = Duration::from_secs(600);
        let options = ChangeOptions { wait, withdrawal, ..ChangeOptions::allowing_loss() };
        // Those that leave need time for it, which passes here.
        let result = scope(|scope| {
            let handle = handle.clone();
            let next = &next;
            let apply = scope.spawn(move || handle.apply(next, options));
            while !apply.is_finished() {
                if !plan.removed.is_empty() || kind == Kind::Class {
                    now += STEP;
                    fleet.run_until(Time::from_nanos(now * 1_000_000));
                }
                sleep(Duration::from_millis(1));
            }
            apply.join().unwrap()
        });
        plant(None);
        let told = || format!("change {change} after {since} ms, {kind:?}, {:?}: {result:?}", wanted.failure);
        let fails = wanted.failure.is_some_and(|planted| planted.step != Step::Shutdown);
        assert_eq!(result.is_err(), fails, "{}", told());
        if let Some(Planted { step, how, .. }) = wanted.failure {
            *steps.entry(step).or_default() += 1;
            let hung = match step {
                Step::Save => Some("Miser"),
                Step::Level => Some("Stubborn"),
                _ => None,
            };
            if let Some(name) = hung.filter(|_| how == How::Hangs) {
                now = goes_on(&fleet, name, now);
            }
        }
        history.push(told());
        let made = made.entry(kind).or_default();
        (made.0, made.1) = (made.0 + 1, made.1 + u32::from(result.is_err()));
        if result.is_ok() {
            present = wanted.clone();
            // Somebody takes it away: where it stands it would be in the way of others.
            for robot in plan.removed.iter().filter_map(|one| one.component.strip_prefix("Robot")) {
                let robot: u32 = robot.parse().unwrap();
                let gone = EnvironmentEvent::from(Fault::gone(robot));
                let content = InjectedContent::Bytes(cdr::encode(&gone));
                let (topic, text) = (ENVIRONMENT.name().to_owned(), format!("gone Robot{robot:03}"));
                handle.inject(Injection { topic, content, at: None, text }).unwrap();
            }
        }
        let left = handle.plan(&assembly(&present));
        assert!(left.is_empty(), "{}: {left:?}", told());
        now += STEP;
        fleet.run_until(Time::from_nanos(now * 1_000_000));
        let after = executions(&fleet);
        let touched = touched(&plan);
        for (name, (count, missed, period)) in after.iter().filter(|(name, _)| !touched.contains(*name)) {
            let (known, missed_before, _) = before.get(name).unwrap_or_else(|| panic!("{}: {name} is new", told()));
            assert_eq!(missed, missed_before, "{}: {name}", told());
            let expected = period.map_or(0, |period| (now - since) / period);
            assert_eq!(count - known, expected, "{}: {name} from {since} ms", told());
        }
    }
    drop(hold);
    let report = fleet.run_to_end();
    // One that was removed and failed in its end fails the run, which goes on to its end.
    let shutdowns = steps.get(&Step::Shutdown).copied().unwrap_or(0) as usize;
    let status = if shutdowns > 0 { RunStatus::Failed } else { RunStatus::Done };
    assert_eq!(report.outcome.status, status, "{:?}, {:?}", report.outcome, report.sections);
    let reasons = &report.outcome.reasons;
    assert!(reasons.iter().all(|reason| reason.contains("`Quitter`")) && reasons.len() <= shutdowns, "{reasons:?}");
    let violations = watch.violations();
    let violations = violations.iter().map(|one| format!("[{}] {}: {}", one.at, one.invariant, one.text));
    let violations: Vec<String> = violations.collect();
    assert!(violations.is_empty(), "{}\nafter\n{}", violations.join("\n"), history.join("\n"));
    let luggage = report.sections.get("luggage").unwrap();
    assert_eq!((&luggage["delivered"], &luggage["given_up"]), (&luggage["requested"], &0.into()), "{luggage}");
    assert_eq!(luggage["requested"], 2 * pieces, "{luggage}");
    let collisions = report.sections.get("collisions").unwrap();
    assert_eq!(*collisions, json!({"vertex": 0, "swap": 0}));
    let failed: u32 = made.values().map(|(_, failed)| failed).sum();
    assert!(3 * failed as usize >= changes, "{failed} of {changes} failed");
    if changes >= CHANGES {
        assert!(made.len() == KINDS.len() && made.values().all(|(all, _)| *all >= 20), "{made:?}");
        assert!(made.values().all(|(_, failed)| *failed >= 6) && steps.len() == 7, "{made:?}, {steps:?}");
    }
}
