//! A program that looks at a fleet now and then.

use std::fmt::Write;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, ReportValue, Time};
use saoms_core::observe::{FleetSample, Interest, Observer, Occurrence, RunEvent, SampleRate};
use saoms_core::report::RunReport;
use saoms_core::schedule::{ChangeOptions, Order, RunningFleet, Settings};
use saoms_core::status::ComponentStatus;
use saoms_lang::assembly::Assembly;
use saoms_lang::registry::Registry;
use serde_json::json;

use crate::actor::Entry;
use crate::fleet::{assembly, assembly_of, real, run, simulated, unindent};

/// Writes down what it sees each 10 ms: times, what components say, and the entries of tables.
#[derive(Default)]
struct Looks {
    every: Option<Duration>,
    most: Option<u32>,
    /// What it hears of the run.
    told: Mutex<Vec<String>>,
    seen: Mutex<String>,
}

impl Observer for Looks {
    fn interest(&self) -> Interest {
        let rate = SampleRate { every: self.every.unwrap_or(Duration::from_millis(10)), most: self.most };
        Interest { samples: Some(rate), ..Interest::NONE }
    }

    fn event(&self, event: &RunEvent) {
        if matches!(event.what, Occurrence::Note { .. } | Occurrence::Failed { .. }) {
            self.told.lock().unwrap().push(format!("{:?} {}", event.component, event.what));
        }
    }

    fn wants_state(&self, message: &str) -> bool {
        message == "Entry"
    }

    fn sample(&self, sample: &FleetSample) {
        let mut seen = self.seen.lock().unwrap();
        write!(seen, "[{}]", sample.time).unwrap();
        for one in &sample.status.components {
            let (name, state) = (&one.report.name, one.state.name());
            write!(seen, " {name} {state} {} {}", one.report.executions, json!(*one.values)).unwrap();
        }
        for topic in &sample.states {
            let entries = topic.retained.iter().map(|sent| {
                let Entry { key, value } = sent.message.get::<Entry>().unwrap();
                format!("{}:{key}={value}", sent.component)
            });
            write!(seen, " {} {:?}", topic.topic, entries.collect::<Vec<_>>()).unwrap();
        }
        writeln!(seen, "{}", if sample.is_last { " end" } else { "" }).unwrap();
    }
}

fn seen(fleet: &str, settings: Settings) -> (String, RunReport) {
    seen_at_most(None, fleet, settings)
}

fn seen_at_most(most: Option<u32>, fleet: &str, settings: Settings) -> (String, RunReport) {
    let looks = Arc::new(Looks { most, ..Looks::default() });
    let report = RunningFleet::start(assembly(fleet), settings, vec![looks.clone()]).unwrap().run_to_end();
    let seen = looks.seen.lock().unwrap().clone();
    (seen, report)
}

#[test]
fn a_fleet_is_sampled_after_what_is_due_and_before_its_components_shut_down() {
    let (seen, _) =
        seen("A actor period=10 publishes=TABLE each=[0: put 1 5; 2: put 1 6] last=[put 1 9]", simulated(35));
    let expected = "[0.000 s] A running 1 {\"waits\":\"\"} TABLE [\"A:1=5\"]
         [0.010 s] A running 2 {\"waits\":\"\"} TABLE [\"A:1=5\"]
         [0.020 s] A running 3 {\"waits\":\"\"} TABLE [\"A:1=6\"]
         [0.030 s] A running 4 {\"waits\":\"\"} TABLE [\"A:1=6\"]
         [0.035 s] A running 4 {\"waits\":\"\"} TABLE [\"A:1=6\"] end";
    assert_eq!(seen.trim(), unindent(expected), "\n{seen}");
}

#[test]
fn where_nothing_happens_nothing_is_sampled() {
    let (seen, report) = seen("A actor period=1000", simulated(2500));
    let times: Vec<&str> = seen.lines().filter_map(|line| line.split(' ').next()).collect();
    assert_eq!(times, ["[0.000", "[1.000", "[2.000", "[2.500"], "{seen}");
    assert_eq!(report.time_s, 2.5);
}

#[test]
fn a_long_run_is_sampled_less_and_less_often() {
    let (seen, _) = seen_at_most(Some(4), "A actor period=10", simulated(320));
    let times: Vec<&str> = seen.lines().filter_map(|line| line[1..].split(' ').next()).collect();
    let expected = ["0.000", "0.010", "0.020", "0.030", "0.040", "0.060", "0.080", "0.120", "0.160", "0.240", "0.320"];
    assert_eq!(times, expected, "{seen}");
}

#[test]
fn a_run_does_not_change_by_being_sampled() {
    for fleet in [
        "A actor period=7 publishes=TABLE each=[put 1 2] last=[put 1 3]\nB actor period=15 startup=false",
        "A actor period=10 waits=[parcels]",
        "E callee",
    ] {
        let (_, sampled) = seen(fleet, simulated(100));
        let (report, _) = run(fleet, simulated(100));
        assert_eq!(sampled.trace_hash, report.trace_hash);
        assert_eq!((sampled.time_s, &sampled.outcome), (report.time_s, &report.outcome), "{fleet}");
    }
}

#[test]
fn real_time_is_sampled_from_its_start_to_its_end() {
    let (seen, report) = seen("A actor period=5\nB actor period=5 each=[3: sleep 40]", real(200));
    assert!(seen.lines().count() > 5 && seen.starts_with("[0.00"), "{seen}");
    let last = seen.lines().last().unwrap();
    assert!(last.ends_with(" end") && last.contains("A running"), "{seen}");
    assert!(report.components[0].executions > 10);
}

#[test]
fn a_component_that_cannot_say_how_it_is_goes_on_as_if_nobody_had_asked() {
    for (says, why) in [("oops", "oops"), ("twice", "its status has `waits` twice")] {
        let fleet = format!("A actor period=10 says=[{says}]\nB actor period=10");
        let looks = Arc::new(Looks::default());
        let running = RunningFleet::start(assembly(&fleet), simulated(100), vec![looks.clone()]).unwrap();
        let sampled = running.run_to_end();
        let (report, _) = run(&fleet, simulated(100));
        assert_eq!((&sampled.outcome, sampled.trace_hash), (&report.outcome, report.trace_hash));
        assert_eq!((sampled.components[0].executions, sampled.components[0].failures), (10, 0));
        let told = looks.told.lock().unwrap();
        assert!(told.len() == 1 && told[0].contains("\"A\"") && told[0].contains(why), "{told:?}");
        let seen = looks.seen.lock().unwrap();
        assert!(seen.contains("[0.090 s] A running 10 {} B running 10 {\"waits\":\"\"}"), "{seen}");
    }
}

#[test]
fn a_person_who_asks_hears_that_a_component_cannot_say_how_it_is() {
    let looks = Arc::new(Looks::default());
    let fleet = assembly("A actor period=10 says=oops\nB actor period=10");
    let running = RunningFleet::start(fleet, simulated(1000), vec![looks.clone()]).unwrap();
    running.run_until(Time::START + Duration::from_millis(500));
    assert_eq!(running.handle().status().components[0].state.name(), "failed");
    assert_eq!(running.run_to_end().components[0].failures, 1);
}

#[test]
fn a_sample_in_a_long_pause_has_the_time_at_which_it_was_due() {
    let looks = Arc::new(Looks { every: Some(Duration::from_millis(1000)), ..Looks::default() });
    let fleet = assembly("A actor period=100000\nB actor period=100000 delay=100");
    let running = RunningFleet::start(fleet, simulated(100_200), vec![looks.clone()]).unwrap();
    // Who acts then has not acted yet.
    running.run_until(Time::START + Duration::from_millis(500));
    running.run_to_end();
    let seen = looks.seen.lock().unwrap();
    let lines: Vec<&str> = seen.lines().filter_map(|line| line.split(" {").next()).collect();
    assert_eq!(
        lines,
        ["[0.000 s] A running 1", "[1.000 s] A running 1", "[100.000 s] A running 2", "[100.200 s] A running 2"]
    );
}

/// Wants what those say who wait for parcels, and writes down when all have said what they say.
#[derive(Default)]
struct Picks(Mutex<Vec<Vec<Option<f64>>>>);

impl Observer for Picks {
    fn interest(&self) -> Interest {
        let rate = SampleRate { every: Duration::from_millis(10), most: None };
        Interest { samples: Some(rate), ..Interest::NONE }
    }

    fn wants_status(&self, component: &ComponentStatus) -> bool {
        component.values["waits"] == "parcels"
    }

    fn sample(&self, sample: &FleetSample) {
        self.0.lock().unwrap().push(sample.status.components.iter().map(|one| one.values_s).collect());
    }
}

#[test]
fn who_says_nothing_that_is_wanted_is_not_asked_again_until_somebody_asks() {
    let picks = Arc::new(Picks::default());
    let fleet = "A actor period=10 waits=[parcels]\nB actor period=10 waits=[nothing]";
    let running = RunningFleet::start(assembly(fleet), simulated(45), vec![picks.clone()]).unwrap();
    running.run_until(Time::from_nanos(25_000_000));
    // Observers are told by a thread of their own.
    let begun = Instant::now();
    while picks.0.lock().unwrap().len() < 3 && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(*picks.0.lock().unwrap(), [[Some(0.0), Some(0.0)], [Some(0.01), Some(0.0)], [Some(0.02), Some(0.0)]]);
    let asked = running.handle().status();
    assert_eq!(asked.components[1].values_s, Some(0.025));
    running.run_to_end();
    assert_eq!(picks.0.lock().unwrap().last().unwrap()[1], Some(0.025));
}

/// Waits for what its property says.
#[derive(Class)]
#[class(name = "waiter", periodic)]
struct Waiter {
    #[property(default = "nothing", live)]
    waits: String,
}

impl Component for Waiter {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        self.waits = properties.waits;
        Ok(())
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        ReportValue::named([("waits", self.waits.as_str().into())])
    }
}

fn waiter(waits: &str) -> Assembly {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Waiter>()).unwrap();
    assembly_of(&format!("A waiter period=10 waits={waits}"), &registry)
}

#[test]
fn who_has_other_values_is_asked_again() {
    for is_ordered in [false, true] {
        let picks = Arc::new(Picks::default());
        let running = RunningFleet::start(waiter("nothing"), simulated(95), vec![picks.clone()]).unwrap();
        running.run_until(Time::from_nanos(25_000_000));
        if is_ordered {
            let (component, property, value) = ("A".to_owned(), "waits".to_owned(), "parcels".to_owned());
            running.handle().order(Order::Set { component, property, value }, None).unwrap();
        } else {
            running.handle().apply(&waiter("parcels"), ChangeOptions::default()).unwrap();
        }
        running.run_to_end();
        let seen = picks.0.lock().unwrap();
        let said: Vec<Option<f64>> = seen.iter().map(|all| all[0]).collect();
        assert_eq!(said[..3], [Some(0.0); 3], "{said:?}");
        assert_eq!(said[6..9], [Some(0.06), Some(0.07), Some(0.08)], "{said:?}");
    }
}
