//! One report of the reports of all nodes of a fleet.

use std::collections::BTreeSet;
use std::fmt;

use saoms_api::Time;
use serde_json::{Map, Value};

use super::{NodeReport, Outcome, PartOfFleet, RunReport, RunStatus, Votes};
use crate::adaptation::{Adaptations, Samples};
use crate::journal::{ComponentName, Journal};

/// Why reports cannot be joined. Reports have their places in the list, from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MergeError {
    /// It is not the report of a node.
    NoNode {
        /// The report.
        report: usize,
    },
    /// It is of another fleet than the first one.
    OtherFleet {
        /// The report.
        report: usize,
    },
    /// It is of the same node as an earlier one.
    Twice {
        /// The earlier report.
        first: usize,
        /// The report.
        report: usize,
        /// The node.
        node: String,
    },
}

impl MergeError {
    /// The same with the names of the reports.
    pub fn named(&self, name: impl Fn(usize) -> String) -> String {
        match self {
            MergeError::NoNode { report } => {
                format!(
                    "{} is not the report of a node, as `saoms run --node NAME --report FILE` writes it",
                    name(*report)
                )
            }
            MergeError::OtherFleet { report } => format!(
                "{} is of another fleet than {}: their composites have other components, classes, sites or nodes",
                name(*report),
                name(0)
            ),
            MergeError::Twice { first, report, node } => {
                format!("{} and {} are both of node `{node}`", name(*first), name(*report))
            }
        }
    }
}

impl fmt::Display for MergeError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.named(|place| format!("report {}", place + 1)))
    }
}

impl std::error::Error for MergeError {}

/// Joins the reports of nodes of one fleet. Times are those since the first of their programs began.
///
/// # Errors
/// One is not of a node, of another fleet, or of the same node as another one.
pub fn merge(reports: Vec<RunReport>) -> Result<RunReport, MergeError> {
    let parts = parts(&reports)?;
    let began = parts.iter().map(|part| part.began_us).min().unwrap_or(0);
    let offsets: Vec<u64> = parts.iter().map(|part| (part.began_us - began).saturating_mul(1000)).collect();
    let nodes: Vec<NodeReport> = reports.iter().zip(&parts).zip(&offsets).map(node_report).collect();
    let outcome = outcome(&nodes, &parts);
    let has_adaptation = reports.iter().any(|report| report.adaptation.is_some());
    let (mut sections, mut votes) = (Map::new(), Votes::default());
    let (mut components, mut journals) = (Vec::new(), Vec::new());
    let (mut seed, mut periods, mut standstill) = (None, 0, None);
    for ((report, part), offset) in reports.into_iter().zip(&parts).zip(offsets) {
        join(&mut sections, report.sections);
        seed.get_or_insert(report.seed);
        periods += report.periods;
        components.extend(report.components);
        votes.done += report.votes.done;
        votes.open.extend(report.votes.open);
        votes.given_up.extend(report.votes.given_up);
        standstill = standstill.or(report.standstill);
        let number = part.nodes.iter().position(|node| *node == part.node).unwrap_or(0);
        journals.push((number, offset, report.journal));
    }
    let journal = Journal::of_nodes(journals);
    let adaptation = has_adaptation.then(|| {
        let mut adaptations = Adaptations::default();
        for component in &components {
            let name = ComponentName {
                name: component.name.to_string(),
                id: component.id.as_ref().map(ToString::to_string),
                period_us: None,
            };
            adaptations.join(&name);
        }
        journal.entries().iter().for_each(|entry| adaptations.take(entry));
        adaptations.report(&Samples::new(Vec::new()))
    });
    Ok(RunReport {
        seed: seed.unwrap_or(0),
        time_s: nodes.iter().map(|node| node.began_s + node.time_s).fold(0.0, f64::max),
        periods,
        sections,
        components,
        journal,
        adaptation,
        votes,
        standstill,
        outcome,
        trace_hash: None,
        recording: None,
        part: parts.into_iter().next().map(|first| PartOfFleet { node: String::new(), began_us: began, ..first }),
        nodes,
    })
}

/// The part of the fleet that each report is about.
fn parts(reports: &[RunReport]) -> Result<Vec<PartOfFleet>, MergeError> {
    let mut parts: Vec<PartOfFleet> = Vec::new();
    for (place, report) in reports.iter().enumerate() {
        let part = report.part.clone().filter(|part| !part.node.is_empty());
        let part = part.ok_or(MergeError::NoNode { report: place })?;
        if parts.first().is_some_and(|first| first.fleet != part.fleet) {
            return Err(MergeError::OtherFleet { report: place });
        }
        if let Some(first) = parts.iter().position(|known| known.node == part.node) {
            return Err(MergeError::Twice { first, report: place, node: part.node });
        }
        parts.push(part);
    }
    Ok(parts)
}

fn node_report(((report, part), offset): ((&RunReport, &PartOfFleet), &u64)) -> NodeReport {
    NodeReport {
        node: part.node.clone(),
        seed: report.seed,
        began_s: Time::from_nanos(*offset).as_secs_f64(),
        time_s: report.time_s,
        outcome: report.outcome.clone(),
    }
}

/// The worst outcome of all; without the report of a node not all of it is known.
fn outcome(nodes: &[NodeReport], parts: &[PartOfFleet]) -> Outcome {
    let mut reasons = Vec::new();
    for NodeReport { node, outcome, .. } in nodes {
        reasons.extend(outcome.reasons.iter().map(|reason| format!("node `{node}`: {reason}")));
    }
    let mut status = nodes.iter().map(|node| node.outcome.status).max().unwrap_or(RunStatus::Done);
    let known: BTreeSet<&str> = parts.iter().map(|part| part.node.as_str()).collect();
    let all = parts.first().map_or(&[][..], |part| &part.nodes);
    let missing: Vec<String> =
        all.iter().filter(|node| !known.contains(node.as_str())).map(|node| format!("`{node}`")).collect();
    if !missing.is_empty() {
        status = status.max(RunStatus::Incomplete);
        let noun = if missing.len() == 1 { "node" } else { "nodes" };
        reasons.push(format!("the report of {noun} {} is not among these", missing.join(", ")));
    }
    Outcome { status, reasons }
}

/// Joins sections: counts are added; of values that differ, all are kept.
fn join(all: &mut Map<String, Value>, more: Map<String, Value>) {
    for (name, value) in more {
        let Some(known) = all.get_mut(&name) else {
            all.insert(name, value);
            continue;
        };
        let sum = known.as_i64().zip(value.as_i64()).map(|(one, other)| one.saturating_add(other));
        match (&mut *known, value) {
            (Value::Object(known), Value::Object(value)) => join(known, value),
            (Value::Array(known), Value::Array(value)) => known.extend(value),
            (_, _) if sum.is_some() => *known = sum.into(),
            (known, value) if *known == value => {}
            (Value::Array(known), value) => known.push(value),
            (known, value) => *known = Value::Array(vec![known.take(), value]),
        }
    }
}
