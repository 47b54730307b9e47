//! The metrics of a fleet for Prometheus: one table, from which their text and their documentation are made.

#[cfg(test)]
mod tests;
mod text;

use std::collections::BTreeMap;
use std::sync::atomic::Ordering;

use saoms_core::report::{ComponentReport, LatenessSteps};
use saoms_core::status::{ComponentStatus, FleetMetrics, FleetPhase, TopicReaderStatus};
use serde_json::Value;
use text::{Number, Samples};

use crate::alerts::AlertCounts;
use crate::counts::{ClientCounts, LossCounts};
use crate::description::FleetDescription;

/// What the metrics are taken from.
pub(crate) struct Measured<'a> {
    pub(crate) description: &'a FleetDescription,
    pub(crate) fleet: &'a FleetMetrics,
    pub(crate) clients: &'a ClientCounts,
    pub(crate) losses: &'a LossCounts,
    pub(crate) alerts: AlertCounts,
}

/// A metric.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Its name.
    pub name: &'static str,
    /// `counter`, `gauge` or `histogram`.
    pub kind: &'static str,
    /// The names of its labels.
    pub labels: &'static [&'static str],
    /// What it is.
    pub help: &'static str,
    samples: fn(&Measured<'_>, &mut Samples<'_>),
}

macro_rules! metrics {
    ($($name:literal $kind:ident [$($label:literal)*] $help:literal $samples:expr;)*) => {
        &[$(Metric {
            name: $name,
            kind: stringify!($kind),
            labels: &[$($label),*],
            help: $help,
            samples: $samples,
        }),*]
    };
}

/// All metrics.
pub const METRICS: &[Metric] = metrics! {
    "saoms_fleet_info" gauge ["fleet" "version" "clock"]
        "1: the fleet's name, the version of the program, and its clock (real, virtual)."
        |measured, samples| {
            let FleetDescription { name, version, is_virtual, .. } = measured.description;
            let clock = if *is_virtual { "virtual" } else { "real" };
            samples.add(&[("fleet", name), ("version", version), ("clock", clock)], 1.0);
        };
    "saoms_start_time_seconds" gauge [] "Start of the fleet, in seconds since 1970."
        |measured, samples| samples.add(&[], measured.description.started as f64);
    "saoms_time_seconds" gauge [] "Time of the run by its own clock."
        |measured, samples| samples.add(&[], measured.fleet.status.time_s);
    "saoms_phase" gauge ["phase"] "1 for the phase of the fleet (starting, running, ending, ended), 0 for the others."
        |measured, samples| {
            for phase in [FleetPhase::Starting, FleetPhase::Running, FleetPhase::Ending, FleetPhase::Ended] {
                samples.add(&[("phase", phase.name())], f64::from(u8::from(measured.fleet.status.phase == phase)));
            }
        };
    "saoms_component_info" gauge ["component" "class" "state"]
        "1: the component's class and what it does (idle, starting, running, leaving, failed, abandoned)."
        |measured, samples| {
            for one in &measured.fleet.status.components {
                let ComponentReport { name, class, .. } = &one.report;
                samples.add(&[("component", name), ("class", class), ("state", one.state.name())], 1.0);
            }
        };
    "saoms_executions_total" counter ["component"] "Executions begun."
        |measured, samples| each(measured, samples, |one| one.report.executions);
    "saoms_missed_total" counter ["component"]
        "Executions that were left out, because the one before had not started in time."
        |measured, samples| each(measured, samples, |one| one.report.missed);
    "saoms_reactions_total" counter ["component"] "Reactions to messages."
        |measured, samples| each(measured, samples, |one| one.report.reactions);
    "saoms_deadline_misses_total" counter ["component"] "Executions that ended after their deadline."
        |measured, samples| each(measured, samples, |one| one.report.deadline_misses);
    "saoms_slow_total" counter ["component"] "Executions that took longer than the budget of the watchdog."
        |measured, samples| each(measured, samples, |one| one.report.slow);
    "saoms_busy_total" counter ["component"] "Executions that were skipped, because a component that it called was busy."
        |measured, samples| each(measured, samples, |one| one.report.busy);
    "saoms_failures_total" counter ["component"] "Failures, by an error or a panic."
        |measured, samples| each(measured, samples, |one| one.report.failures);
    "saoms_restarts_total" counter ["component"] "New instances that replaced a failed one."
        |measured, samples| each(measured, samples, |one| u64::from(one.report.restarts));
    "saoms_dropped_total" counter ["component"]
        "Messages that its queues could not hold, and messages of it that a state topic could not keep."
        |measured, samples| each(measured, samples, |one| one.report.dropped);
    "saoms_sent_total" counter ["component"] "Messages sent, each counted once however many readers it had."
        |measured, samples| each(measured, samples, |one| one.report.messages.sent);
    "saoms_received_total" counter ["component"] "Messages received."
        |measured, samples| each(measured, samples, |one| one.report.messages.received);
    "saoms_lateness_seconds" histogram ["component"]
        "Lateness of the starts of executions in real time; the sum is at most 1/16 off."
        lateness;
    "saoms_in_code_seconds" gauge ["component"] "Time for which a call to its code has not returned."
        |measured, samples| {
            for one in &measured.fleet.status.components {
                if let Some(time) = one.in_code_s {
                    samples.add(&[("component", &one.report.name)], time);
                }
            }
        };
    "saoms_queue_events" gauge ["component" "topic"] "Events that wait for the component."
        |measured, samples| queues(measured, samples, |queue| queue.waiting);
    "saoms_queue_limit_events" gauge ["component" "topic"] "Events that may wait for the component."
        |measured, samples| queues(measured, samples, |queue| queue.queue);
    "saoms_network_lost_total" counter ["network"]
        "Messages that were lost on their way between programs, each counted by the programs at both ends."
        |measured, samples| {
            for (url, lost) in &measured.fleet.networks {
                samples.add(&[("network", url)], *lost as f64);
            }
        };
    "saoms_component_value" gauge ["component" "name"] "A number that a component reports in `saoms status`."
        |measured, samples| {
            for one in &measured.fleet.status.components {
                let mut numbers = BTreeMap::new();
                one.values.iter().for_each(|(name, value)| numbers_of(name, value, &mut numbers));
                for (name, number) in numbers {
                    samples.add(&[("component", &one.report.name), ("name", &name)], number);
                }
            }
        };
    "saoms_report_value" gauge ["path"] "A number that components contribute to the report, under its path there."
        |measured, samples| {
            for (path, number) in &measured.fleet.numbers {
                samples.add(&[("path", path)], *number);
            }
        };
    "saoms_adaptations_total" counter ["component" "loop" "phase"]
        "Records of the journal by loop (empty outside all loops) and phase: symptom, decision, effect."
        adaptations;
    "saoms_alerts" gauge ["kind" "state"]
        "Alerts that are not over: those that wait for a person (waiting), and those that are acknowledged (acknowledged)."
        |measured, samples| {
            for (kind, [waiting, acknowledged, _]) in &measured.alerts.kinds {
                samples.add(&[("kind", kind), ("state", "waiting")], *waiting as f64);
                samples.add(&[("kind", kind), ("state", "acknowledged")], *acknowledged as f64);
            }
        };
    "saoms_alerts_total" counter ["kind"] "Alerts that were raised."
        |measured, samples| {
            for (kind, [.., raised]) in &measured.alerts.kinds {
                samples.add(&[("kind", kind)], *raised as f64);
            }
        };
    "saoms_alerts_undelivered_total" counter [] "Changes of alerts that were not delivered to the address or the command of the composite."
        |measured, samples| samples.add(&[], measured.alerts.undelivered as f64);
    "saoms_log_lost_total" counter [] "Lines that could not be written to the file of the log."
        |measured, samples| samples.add(&[], measured.losses.log_lines.load(Ordering::Relaxed) as f64);
    "saoms_history_lost_total" counter [] "Rows that could not be written to the history, with alerts and messages that were lost before."
        |measured, samples| samples.add(&[], measured.losses.history_rows.load(Ordering::Relaxed) as f64);
    "saoms_recording_lost_total" counter [] "Messages, records of the journal and lines of the log that the recording lacks."
        |measured, samples| samples.add(&[], measured.losses.recorded.load(Ordering::Relaxed) as f64);
    "saoms_control_clients" gauge [] "Clients that are connected."
        |measured, samples| samples.add(&[], measured.clients.open.load(Ordering::Relaxed) as f64);
    "saoms_control_refused_total" counter [] "Clients that were refused, because there were too many."
        |measured, samples| samples.add(&[], measured.clients.refused.load(Ordering::Relaxed) as f64);
    "saoms_control_denied_total" counter [] "Requests over the network without the token, or from another site."
        |measured, samples| samples.add(&[], measured.clients.denied.load(Ordering::Relaxed) as f64);
    "saoms_control_dropped_total" counter [] "Clients that were disconnected, because they did not read their answer."
        |measured, samples| samples.add(&[], measured.clients.dropped.load(Ordering::Relaxed) as f64);
    "saoms_control_lost_total" counter [] "Lines of the log and messages that clients missed, because they were too slow."
        |measured, samples| samples.add(&[], measured.clients.lost.load(Ordering::Relaxed) as f64);
};

/// A count of each component.
fn each(measured: &Measured<'_>, samples: &mut Samples<'_>, count: impl Fn(&ComponentStatus) -> u64) {
    for one in &measured.fleet.status.components {
        samples.add(&[("component", &one.report.name)], count(one) as f64);
    }
}

fn lateness(measured: &Measured<'_>, samples: &mut Samples<'_>) {
    for (component, steps) in &measured.fleet.lateness {
        for (bound, below) in LatenessSteps::BOUNDS.into_iter().zip(steps.below) {
            let bound = Number(bound as f64 / 1e6).to_string();
            samples.add_to("_bucket", &[("component", component), ("le", &bound)], below as f64);
        }
        samples.add_to("_bucket", &[("component", component), ("le", "+Inf")], steps.count as f64);
        samples.add_to("_sum", &[("component", component)], steps.sum_us as f64 / 1e6);
        samples.add_to("_count", &[("component", component)], steps.count as f64);
    }
}

/// A number of each queue. A component may read a topic in two ways.
fn queues(measured: &Measured<'_>, samples: &mut Samples<'_>, number: impl Fn(&TopicReaderStatus) -> Option<u64>) {
    let mut sums: BTreeMap<(&str, &str), u64> = BTreeMap::new();
    for (topic, queue) in &measured.fleet.queues {
        *sums.entry((&queue.component, topic)).or_default() += number(queue).unwrap_or_default();
    }
    for ((component, topic), sum) in sums {
        samples.add(&[("component", component), ("topic", topic)], sum as f64);
    }
}

fn adaptations(measured: &Measured<'_>, samples: &mut Samples<'_>) {
    let mut sums: BTreeMap<(&str, &str), [u64; 3]> = BTreeMap::new();
    for one in &measured.fleet.loops {
        let sum = sums.entry((&one.component, one.loop_name.as_deref().unwrap_or_default())).or_default();
        for (sum, more) in sum.iter_mut().zip([one.symptoms, one.decisions, one.effects]) {
            *sum += more;
        }
    }
    for ((component, name), counts) in sums {
        for (phase, count) in ["symptom", "decision", "effect"].into_iter().zip(counts) {
            samples.add(&[("component", component), ("loop", name), ("phase", phase)], count as f64);
        }
    }
}

/// Notes a value if it is a number, or true or false; those in an object have the names of both.
fn numbers_of(name: &str, value: &Value, numbers: &mut BTreeMap<String, f64>) {
    let number = match value {
        Value::Bool(value) => Some(f64::from(u8::from(*value))),
        Value::Number(value) => value.as_f64(),
        Value::Object(inner) => {
            inner.iter().for_each(|(inner, value)| numbers_of(&format!("{name}.{inner}"), value, numbers));
            None
        }
        Value::Null | Value::String(_) | Value::Array(_) => None,
    };
    if let Some(number) = number {
        numbers.entry(name.to_owned()).or_insert(number);
    }
}

/// All metrics as text.
pub(crate) fn text(measured: &Measured<'_>) -> String {
    let mut text = String::new();
    for metric in METRICS {
        (metric.samples)(measured, &mut Samples::of(&mut text, metric.name, metric.kind, metric.help));
    }
    text
}
