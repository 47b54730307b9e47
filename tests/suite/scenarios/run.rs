//! A run of a composite, and the facts in what its robots said.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use saoms_api::Time;
use saoms_core::observe::{Interest, Observer, Occurrence, RunEvent};
use saoms_core::report::RunReport;
use saoms_testkit::Fleet;

use crate::support::root;

/// A run that is over.
pub(crate) struct Run {
    pub(crate) report: RunReport,
    /// The messages, in order.
    lines: Vec<Line>,
}

/// A line of the console or, where `log` says so, of the log.
struct Line {
    time: Time,
    component: Arc<str>,
    log: bool,
    text: String,
}

/// Keeps the lines of a run.
#[derive(Default)]
struct Listener(Mutex<Vec<Line>>);

impl Observer for Listener {
    fn event(&self, event: &RunEvent) {
        let (log, text) = match &event.what {
            Occurrence::Console { text } => (false, text),
            Occurrence::Log { text, .. } | Occurrence::Alert { text: Some(text), .. } => (true, text),
            _ => return,
        };
        let component = event.component.clone().unwrap_or_default();
        let line = Line { time: event.time, component, log, text: text.clone() };
        self.0.lock().unwrap().push(line);
    }

    fn interest(&self) -> Interest {
        Interest { console: true, ..Interest::default() }
    }
}

/// One execution of a robot.
pub(crate) struct Execution<'a> {
    pub(crate) number: u64,
    pub(crate) time: Time,
    /// Its lines of the console after the first, without the robot's name.
    pub(crate) said: Vec<&'a str>,
    /// Its lines of the log.
    pub(crate) log: Vec<&'a str>,
}

impl Run {
    /// Runs a shipped composite in virtual time.
    pub(crate) fn of(composite: &str, limit: u64) -> Run {
        let path = root().join("composites").join(composite);
        Run::with(&Fleet::of_file(path), limit)
    }

    /// Runs a fleet in virtual time, for so many seconds at most.
    pub(crate) fn with(fleet: &Fleet, limit: u64) -> Run {
        let listener = Arc::new(Listener::default());
        let report = fleet.run_with(1, Duration::from_secs(limit), listener.clone());
        let lines = std::mem::take(&mut *listener.0.lock().unwrap());
        Run { report, lines }
    }

    /// The console as a whole, a line each.
    pub(crate) fn console(&self) -> Vec<&str> {
        self.lines.iter().filter(|line| !line.log).map(|line| line.text.as_str()).collect()
    }

    /// The log of a component, with times.
    pub(crate) fn log(&self, component: &str) -> Vec<String> {
        let of = |line: &&Line| line.log && &*line.component == component;
        self.lines.iter().filter(of).map(|line| format!("{} {}", line.time, line.text)).collect()
    }

    /// The whole log, as component and text.
    pub(crate) fn whole_log(&self) -> impl Iterator<Item = (&str, &str)> {
        self.lines.iter().filter(|line| line.log).map(|line| (&*line.component, line.text.as_str()))
    }

    /// The executions of a robot, in order.
    pub(crate) fn executions(&self, robot: &str) -> Vec<Execution<'_>> {
        let mut executions: Vec<Execution<'_>> = Vec::new();
        for line in self.lines.iter().filter(|line| &*line.component == robot) {
            if let Some(rest) = line.text.strip_prefix("Execution ") {
                let number = rest.split(' ').next().unwrap().parse().unwrap();
                executions.push(Execution { number, time: line.time, said: Vec::new(), log: Vec::new() });
            } else if let Some(execution) = executions.last_mut() {
                let text = line.text.strip_prefix(robot).unwrap_or(&line.text).trim_start_matches([' ', ':']);
                let to = if line.log { &mut execution.log } else { &mut execution.said };
                to.push(text);
            }
        }
        executions
    }

    /// One of them.
    pub(crate) fn execution(&self, robot: &str, number: u64) -> Execution<'_> {
        let found = self.executions(robot).into_iter().find(|execution| execution.number == number);
        found.unwrap_or_else(|| panic!("{robot} has no execution {number}"))
    }

    /// A value of the report.
    pub(crate) fn count(&self, section: &str, name: &str) -> i64 {
        self.report.sections[section][name].as_i64().unwrap()
    }
}
