//! Fleets as text: one component in a line, `NAME CLASS key=value key=[a value with blanks]`. Keys are task properties,
//! references (`peer=B` leads to B's `echo`, `task=B` to its `TaskInterface`), and the scripts of
//! [`actor`](crate::actor).

use std::fmt::Write;
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::Properties;
use saoms_api::host::{PropertyValue, Registration, parse_duration};
use saoms_core::observe::{Interest, Observer, Occurrence, RunEvent};
use saoms_core::report::{ComponentReport, RunReport};
use saoms_core::schedule::{RunningFleet, Settings, StartError};
use saoms_lang::assembly::{Assembly, ComponentSpec, Loss, Overrun, Restart, TaskProperties, Wire, WireTarget};
use saoms_lang::registry::Registry;

use crate::actor::{Actor, Callee};

/// The assembly of a text.
pub(crate) fn assembly(text: &str) -> Assembly {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Actor>()).unwrap();
    registry.add(Registration::of::<Callee>()).unwrap();
    assembly_of(text, &registry)
}

/// The assembly of a text whose classes are in this registry.
pub(crate) fn assembly_of(text: &str, registry: &Registry) -> Assembly {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let name = |line: &&str| line.split(' ').next().unwrap().to_owned();
    let names: Vec<String> = lines.iter().map(name).collect();
    let components = lines.iter().map(|line| component(line, registry, &names)).collect();
    Assembly { components, ..Assembly::default() }
}

fn component(line: &str, registry: &Registry, names: &[String]) -> ComponentSpec {
    let (path, rest) = line.split_once(' ').unwrap();
    let (class, rest) = rest.split_once(' ').unwrap_or((rest, ""));
    let class = Arc::clone(registry.get(class).unwrap());
    let task = [("ID", path), ("period", "100ms"), ("queue", "16")].map(|(name, value)| (name.into(), value.into()));
    let mut task = TaskProperties::from_values(&task).unwrap();
    let wire = |reference: &str, interface: &str| Wire {
        reference: reference.to_owned(),
        interface: interface.to_owned(),
        targets: Vec::new(),
        elsewhere: Box::default(),
        web: Box::default(),
        deadline: None,
    };
    let mut references = vec![wire("peer", "test.Echo"), wire("task", "unibg.robotics.tca.TaskInterface")];
    let mut values = Vec::new();
    for (key, value) in pairs(rest) {
        let duration = || parse_duration(value).unwrap();
        let target = |service: &str| {
            let component = names.iter().position(|name| name == value).unwrap();
            vec![WireTarget { component, service: service.to_owned() }]
        };
        match key {
            "period" => task.period = duration(),
            "delay" => task.delay = duration(),
            "minimum" => task.minimum = duration(),
            "trigger" => task.trigger.0.extend(value.split(' ').map(str::to_owned)),
            "deadline" => task.deadline = Some(duration()),
            "startup" => task.run_on_startup = value == "true",
            "interrupt" => task.may_interrupt_if_running = value == "true",
            "jms" => task.use_jms = value == "true",
            "queue" => task.queue = Some(value.parse().unwrap()),
            "loss" => task.loss = if value == "accept" { Loss::Accept } else { Loss::Fail },
            "overrun" => {
                task.overrun = match value {
                    "catchUp" => Overrun::CatchUp,
                    "stop" => Overrun::Stop,
                    _ => Overrun::Skip,
                }
            }
            "restart" => {
                let (backoff, limit) = value.split_once('/').unwrap();
                task.restart = Restart::OnFailure;
                task.restart_backoff = parse_duration(backoff).unwrap();
                task.restart_limit = limit.parse().unwrap();
            }
            "rename" => {
                let (old, new) = value.split_once('/').unwrap();
                task.topic_rename.0.push((old.to_owned(), new.to_owned()));
            }
            "peer" => references[0].targets = target("echo"),
            "task" => references[1].targets = target("TaskInterface"),
            script => values.push((script.into(), PropertyValue::from(value))),
        }
    }
    let task = class.declaration().is_periodic().then_some(task);
    ComponentSpec {
        path: path.to_owned(),
        class,
        site: Default::default(),
        node: Default::default(),
        fault_node: Default::default(),
        library: None,
        values,
        written: Default::default(),
        task,
        references,
        loops: std::sync::Arc::default(),
        web: Box::default(),
    }
}

fn pairs(mut text: &str) -> Vec<(&str, &str)> {
    let mut pairs = Vec::new();
    while let Some((key, rest)) = text.trim_start().split_once('=') {
        let (value, rest) = match rest.strip_prefix('[') {
            Some(rest) => rest.split_once(']').unwrap(),
            None => rest.split_once(' ').unwrap_or((rest, "")),
        };
        pairs.push((key, value));
        text = rest;
    }
    pairs
}

/// Remembers what happened.
#[derive(Default)]
pub(crate) struct Diary {
    pub(crate) events: Mutex<Vec<RunEvent>>,
}

impl Observer for Diary {
    fn event(&self, event: &RunEvent) {
        self.events.lock().unwrap().push(event.clone());
    }

    fn interest(&self) -> Interest {
        Interest { console: true, ..Interest::default() }
    }
}

impl Diary {
    /// The events as lines, without the starts and ends that every component has, and the faults of the test.
    pub(crate) fn lines(&self) -> String {
        let events = self.events.lock().unwrap();
        let told = events
            .iter()
            .filter(|event| !matches!(event.what, Occurrence::Started | Occurrence::Left | Occurrence::Fault { .. }));
        told.fold(String::new(), |mut text, event| {
            writeln!(text, "{event}").unwrap();
            text
        })
    }

    /// Waits until there is a line with this text: observers are told by a thread of their own.
    #[track_caller]
    pub(crate) fn until(&self, what: &str) {
        let begun = Instant::now();
        while !self.lines().contains(what) {
            assert!(begun.elapsed() < Duration::from_secs(20), "`{what}` is never told: {}", self.lines());
            sleep(Duration::from_millis(1));
        }
    }

    /// All events as lines.
    pub(crate) fn all_lines(&self) -> String {
        let events = self.events.lock().unwrap();
        events.iter().fold(String::new(), |mut text, event| {
            writeln!(text, "{event}").unwrap();
            text
        })
    }

    /// Number of events for which `is_such` holds.
    pub(crate) fn count(&self, is_such: impl Fn(&RunEvent) -> bool) -> usize {
        self.events.lock().unwrap().iter().filter(|event| is_such(event)).count()
    }
}

/// A run in virtual time for so many milliseconds.
pub(crate) fn simulated(milliseconds: u64) -> Settings {
    Settings { limit: Some(Duration::from_millis(milliseconds)), ..Settings::simulated(7) }
}

/// A run in real time for so many milliseconds.
pub(crate) fn real(milliseconds: u64) -> Settings {
    Settings { limit: Some(Duration::from_millis(milliseconds)), ..Settings::default() }
}

/// Starts the fleet of a text.
pub(crate) fn start(text: &str, settings: Settings) -> (Result<RunningFleet, StartError>, Arc<Diary>) {
    let diary = Arc::new(Diary::default());
    (RunningFleet::start(assembly(text), settings, vec![diary.clone()]), diary)
}

/// Runs the fleet of a text to its end.
pub(crate) fn run(text: &str, settings: Settings) -> (RunReport, Arc<Diary>) {
    let (fleet, diary) = start(text, settings);
    (fleet.unwrap().run_to_end(), diary)
}

/// Runs a fleet in virtual time and compares its record and its outcome.
#[track_caller]
pub(crate) fn check(fleet: &str, milliseconds: u64, expected: &str) {
    let (report, diary) = run(fleet, simulated(milliseconds));
    let mut told = diary.lines();
    writeln!(told, "{}", outcome(&report)).unwrap();
    assert_eq!(told.trim(), unindent(expected), "\n--- told:\n{told}");
}

/// Outcome of a run as text.
pub(crate) fn outcome(report: &RunReport) -> String {
    let mut text = format!("{:?} after {} s", report.outcome.status, report.time_s);
    for reason in &report.outcome.reasons {
        write!(text, "\n- {reason}").unwrap();
    }
    text
}

/// Part of a report about a component.
pub(crate) fn of<'a>(report: &'a RunReport, name: &str) -> &'a ComponentReport {
    report.components.iter().find(|component| component.name == name).unwrap()
}

/// A text without the blanks that indent it in the source.
pub(crate) fn unindent(text: &str) -> String {
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    lines.join("\n")
}
