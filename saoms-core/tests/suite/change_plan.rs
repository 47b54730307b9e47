//! What a change would do, and live values and losses of state in changes.

use std::sync::Arc;

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Message, Saved, Time};
use saoms_core::schedule::{ChangeError, ChangeOptions, Changed, RunningFleet};
use saoms_lang::assembly::Assembly;
use saoms_lang::registry::Registry;
use serde_json::{Value, json};

use crate::actor::{Actor, Callee};
use crate::fleet::{Diary, assembly_of, simulated};

#[derive(Clone, Debug, Default, Message)]
struct Count {
    executions: u32,
}

/// Counts its executions, and says them with its level.
#[derive(Class)]
#[class(name = "gauge", periodic, saves)]
struct Gauge {
    /// What it says.
    #[property(default = 1, live)]
    level: u32,
    /// A level that it refuses while it runs.
    #[property(default = 0)]
    refused: u32,
    executions: u32,
}

impl Component for Gauge {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.executions += 1;
        context.console(format_args!("{} at level {}", self.executions, self.level));
        Ok(())
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        let level = properties.level;
        if level == self.refused {
            return Err(Failure::new(format!("{level} is out of reach")));
        }
        self.level = level;
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Count { executions: self.executions }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.executions = saved.read::<Count>()?.unwrap_or_default().executions;
        Ok(())
    }
}

fn wanted(text: &str) -> Assembly {
    let mut registry = Registry::new();
    for class in [Registration::of::<Actor>(), Registration::of::<Callee>(), Registration::of::<Gauge>()] {
        registry.add(class).unwrap();
    }
    let mut assembly = assembly_of(text, &registry);
    // As the checker gives them, by their declarations.
    for spec in &mut assembly.components {
        let class = Arc::clone(&spec.class);
        for (name, value) in &mut spec.values {
            let declared = class.declaration().property(name).unwrap();
            *value = declared.check(value.as_text().unwrap().clone()).unwrap().into();
        }
    }
    assembly
}

fn started(text: &str) -> (RunningFleet, Arc<Diary>) {
    let diary = Arc::new(Diary::default());
    let fleet = RunningFleet::start(wanted(text), simulated(100), vec![diary.clone()]).unwrap();
    fleet.run_until(Time::from_nanos(15_000_000));
    (fleet, diary)
}

fn plan(fleet: &RunningFleet, text: &str) -> Value {
    let plan = fleet.handle().plan(&wanted(text));
    let mut told = json!(plan);
    assert_eq!(plan.is_empty(), ["added", "removed", "replaced", "set"].iter().all(|one| told[one] == json!([])));
    told.as_object_mut().unwrap().retain(|_, what| *what != json!([]));
    told
}

#[test]
fn a_plan_says_what_would_change_by_path_and_changes_nothing() {
    let text = "A gauge period=10 level=2\nB actor period=10 each=[number]\nC callee\nD actor peer=C";
    let (fleet, _) = started(text);
    assert_eq!(plan(&fleet, text), json!({}));
    let next = "A gauge period=10 level=3\nB actor period=20 each=[log x]\nE callee\nD gauge\nF gauge level=9";
    let told = plan(&fleet, next);
    let expected = json!({
        "added": [{"component": "E", "class": "callee"}, {"component": "F", "class": "gauge"}],
        "removed": [{"component": "C", "class": "callee"}],
        "replaced": [
            {"component": "B", "class": "actor", "state": "lost", "differences": [
                {"what": "each", "from": "number", "to": "log x"},
                {"what": "period", "from": "10ms", "to": "20ms"},
            ]},
            {"component": "D", "class": "gauge", "state": "lost", "differences": [
                {"what": "class", "from": "actor", "to": "gauge"},
            ]},
        ],
        "set": [{"component": "A", "what": "level", "from": "2", "to": "3"}],
        "wires_removed": ["D.peer -> C.echo"],
    });
    assert_eq!(told, expected, "\n{told:#}");
    // A fleet that did not do anything.
    assert_eq!(plan(&fleet, text), json!({}));
    assert_eq!(fleet.run_to_end().components.len(), 4);
}

#[test]
fn a_default_is_the_same_whether_it_is_written_or_not() {
    let (fleet, _) = started("A gauge period=10");
    assert_eq!(plan(&fleet, "A gauge period=10 level=1 refused=0"), json!({}));
}

#[test]
fn a_plan_compares_with_what_operators_have_set() {
    let (fleet, diary) = started("A gauge period=10 level=2");
    // In virtual time it waits for its instant.
    let set = saoms_core::schedule::Order::Set { component: "A".into(), property: "level".into(), value: "5".into() };
    fleet.handle().order(set, None).unwrap();
    fleet.run_until(Time::from_nanos(25_000_000));
    let planned = fleet.handle().plan(&wanted("A gauge period=10 level=2"));
    let told = plan(&fleet, "A gauge period=10 level=2");
    assert_eq!(told, json!({"set": [{"component": "A", "what": "level", "from": "5", "to": "2"}]}));
    assert_eq!(plan(&fleet, "A gauge period=10 level=5"), json!({}));
    let changed = fleet.handle().apply(&wanted("A gauge period=10 level=2"), ChangeOptions::default()).unwrap();
    assert_eq!(changed, Changed { updated: vec!["A".into()], plan: planned, ..Changed::default() });
    assert_eq!(plan(&fleet, "A gauge period=10 level=2"), json!({}));
    let report = fleet.run_to_end();
    // It was the same instance all the time, and has missed nothing.
    assert_eq!((report.components[0].executions, report.components[0].replaced), (10, 0));
    let told = diary.lines();
    for line in ["[0.020 s] A: 3 at level 5", "[0.025 s] A: has new values: level", "[0.030 s] A: 4 at level 2"] {
        assert!(told.contains(line), "{line}: {told}");
    }
}

#[test]
fn a_loss_of_state_has_to_be_allowed() {
    let (fleet, _) = started("A actor period=10 each=[number]\nB gauge period=10\nC actor startup=false");
    let next = "A actor period=10 each=[log x]\nB gauge period=20\nC actor startup=false each=[number]";
    let refused = fleet.handle().apply(&wanted(next), ChangeOptions::default()).unwrap_err();
    assert_eq!(refused, ChangeError::LosesState { unsaved: vec!["A".into()], anew: Vec::new() });
    assert_eq!(refused.to_string(), "the state of `A` would be lost: its class saves none");
    // One that does not run has none, and one that saves it keeps it.
    let next = "A actor period=10 each=[number]\nB gauge period=20\nC actor startup=false each=[number]";
    let states = plan(&fleet, next)["replaced"].as_array().unwrap().iter().map(|one| one["state"].clone()).collect();
    assert_eq!(Value::Array(states), json!(["kept", "none"]));
    assert!(fleet.handle().apply(&wanted(next), ChangeOptions::default()).is_ok());
    assert_eq!(plan(&fleet, next), json!({}));
    fleet.run_to_end();
}

#[test]
fn values_go_back_when_the_change_is_undone() {
    let before = "A gauge period=10 level=2\nB gauge period=10 level=2 refused=7\nC actor period=10 each=[number]";
    let (fleet, diary) = started(before);
    let next = "A gauge period=10 level=3\nB gauge period=10 level=7 refused=7\nC actor period=10 each=[number]
                D gauge period=10";
    let refused = fleet.handle().apply(&wanted(next), ChangeOptions::default()).unwrap_err();
    assert_eq!(refused.to_string(), "component `B` of class `gauge` refuses its new values: 7 is out of reach");
    assert_eq!(plan(&fleet, before), json!({}));
    let report = fleet.run_to_end();
    let executions: Vec<u64> = report.components.iter().map(|one| one.executions).collect();
    assert_eq!(executions, [10, 10, 10]);
    assert!(diary.lines().contains("[0.020 s] A: 3 at level 2"), "{}", diary.lines());
    assert!(!diary.lines().contains("level 3") && !diary.lines().contains("new values"), "{}", diary.lines());
}

#[test]
fn values_also_reach_a_component_that_does_not_run() {
    let (fleet, diary) = started("A gauge period=10 startup=false");
    let changed = fleet.handle().apply(&wanted("A gauge period=10 startup=false level=4"), ChangeOptions::default());
    assert_eq!(changed.unwrap().updated, ["A"]);
    fleet.handle().schedule("A").unwrap();
    fleet.run_to_end();
    assert!(diary.lines().contains("A: 1 at level 4"), "{}", diary.lines());
}

#[test]
fn a_component_of_another_site_ends_and_begins_there_anew() {
    let text = "A gauge period=10\nB actor period=10 peer=C publishes=OWN first=[own 1] last=[log ends]\nC callee\n\
                D actor period=10 subscribes=OWN each=[owns]";
    let at = |sites: &[(&str, &str)]| {
        let mut assembly = wanted(text);
        for (path, site) in sites {
            assembly.components.iter_mut().find(|one| one.path == *path).unwrap().site = (*site).into();
        }
        assembly
    };
    let diary = Arc::new(Diary::default());
    let fleet = RunningFleet::start(at(&[]), simulated(100), vec![diary.clone()]).unwrap();
    fleet.run_until(Time::from_nanos(15_000_000));
    let handle = fleet.handle();
    let moved = at(&[("A", "North"), ("B", "North"), ("C", "North")]);
    let plan = json!(handle.plan(&moved));
    let state = |place: usize| (plan["replaced"][place]["component"].clone(), plan["replaced"][place]["state"].clone());
    let states: Vec<_> = (0..3).map(state).collect();
    let lost = |name: &str| (json!(name), json!("lost"));
    assert_eq!(states, [lost("A"), lost("C"), lost("B")], "{plan:#}");
    let site = json!({"what": "site", "to": "North"});
    assert_eq!(plan["replaced"][0]["differences"], json!([site]), "{plan:#}");
    let refused = handle.apply(&moved, ChangeOptions::default()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the state of `A`, `C`, `B` would be lost: they begin anew in another class or site"
    );
    let changed = handle.apply(&moved, ChangeOptions::allowing_loss()).unwrap();
    assert_eq!(changed.added, ["A", "B", "C"]);
    assert_eq!(changed.removed.len(), 3, "{changed:?}");
    assert!(handle.plan(&moved).is_empty());
    // What the one that is gone had said stays where it was, as after each removal, and the new one speaks at its site.
    assert_eq!(handle.retained("North/OWN").unwrap().len(), 1);
    let report = fleet.run_to_end();
    let told = diary.lines();
    assert!(told.contains("[0.015 s] B: ends") && told.contains("D: reads [1]"), "{told}");
    assert_eq!(told.matches("A: 1 at level 1").count(), 2, "{told}");
    assert_eq!(report.components.iter().filter(|one| one.name == "A").count(), 2, "{report:?}");
}
