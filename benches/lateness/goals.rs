//! The goals: ratios between contenders of one round, judged by their median over the rounds.

use std::fmt::Write as _;

use serde_json::{Value, json};

use crate::common::{median, verdict};
use crate::report::{Figure, cpu, p99};
use crate::rounds::{AtSize, Measured};

/// A goal: at a size, one contender's figure is at most `limit` times another's.
struct Goal {
    sizes: &'static [&'static str],
    figure: Figure,
    what: &'static str,
    subject: &'static str,
    reference: &'static str,
    limit: f64,
}

const GOALS: &[Goal] = &[
    Goal {
        sizes: &["10x100ms"],
        figure: p99,
        what: "p99",
        subject: "saoms-fifo",
        reference: "cyclictest-fifo",
        limit: 2.0,
    },
    Goal {
        sizes: &["100x10ms", "1000x10ms", "1000x100ms"],
        figure: p99,
        what: "p99",
        subject: "saoms-fifo",
        reference: "cyclictest-fifo",
        limit: 1.0,
    },
    Goal {
        sizes: &["10x100ms", "1000x10ms", "1000x100ms", "10000x100ms"],
        figure: p99,
        what: "p99",
        subject: "saoms",
        reference: "java-per-task",
        limit: 0.3,
    },
    Goal { sizes: &["100x10ms"], figure: p99, what: "p99", subject: "saoms", reference: "java-per-task", limit: 0.7 },
    Goal {
        sizes: &["10x100ms", "100x10ms", "1000x10ms", "1000x100ms", "10000x100ms"],
        figure: cpu,
        what: "CPU per execution",
        subject: "saoms-50us",
        reference: "java-pool",
        limit: 1.0,
    },
];

/// Result of a goal at one size.
struct Judged {
    size: String,
    goal: &'static Goal,
    /// One per round in which both ran.
    ratios: Vec<f64>,
}

fn judged(measured: &Measured) -> Vec<Judged> {
    let mut all = Vec::new();
    for at in &measured.sizes {
        let size = at.size.to_string();
        for goal in GOALS.iter().filter(|goal| goal.sizes.contains(&size.as_str())) {
            all.push(Judged { size: size.clone(), goal, ratios: ratios(at, goal) });
        }
    }
    all
}

fn ratios(at: &AtSize, goal: &Goal) -> Vec<f64> {
    let rounds = |name| at.results.iter().find(|result| result.contender.name == name).map(|found| &found.rounds);
    let (Some(subject), Some(reference)) = (rounds(goal.subject), rounds(goal.reference)) else {
        return Vec::new();
    };
    let pairs = subject.iter().zip(reference);
    pairs.filter_map(|(left, right)| Some((goal.figure)(left.as_ref()?) / (goal.figure)(right.as_ref()?))).collect()
}

/// Appends the table of goals to the page.
pub(crate) fn table(page: &mut String, measured: &Measured) -> std::fmt::Result {
    writeln!(page, "\n### Goals: median of the ratios per round\n")?;
    writeln!(page, "| size | ratio | median | lowest to highest | goal | |")?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- |")?;
    for Judged { size, goal, ratios } in judged(measured) {
        write!(page, "| {size} | {} of {} to {} ", goal.what, goal.subject, goal.reference)?;
        let Some(middle) = median(ratios.iter().copied()) else {
            writeln!(page, "| not measured | | {} | |", goal.limit)?;
            continue;
        };
        let lowest = ratios.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = ratios.iter().copied().fold(0.0, f64::max);
        let verdict = verdict(middle <= goal.limit);
        writeln!(page, "| {middle:.2} | {lowest:.2} to {highest:.2} | {} | {verdict} |", goal.limit)?;
    }
    Ok(())
}

/// The goals with the ratio of every round.
pub(crate) fn raw(measured: &Measured) -> Vec<Value> {
    let value = |judged: Judged| {
        json!({
            "size": judged.size,
            "figure": judged.goal.what,
            "subject": judged.goal.subject,
            "reference": judged.goal.reference,
            "limit": judged.goal.limit,
            "ratios": judged.ratios,
            "median": median(judged.ratios.iter().copied()),
        })
    };
    judged(measured).into_iter().map(value).collect()
}
