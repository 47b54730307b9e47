//! Cost of a robot of the airport fleet in real time, and speed of a fleet in virtual time. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

mod case;
mod original;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;

use clap::Parser;
use serde::Serialize;

use case::{Case, Measured};
use common::composite::Phases;
use common::{Outcome, child, median, verdict};
use original::ORIGINAL;

/// Measures the airport fleet in real and in virtual time.
#[derive(Parser)]
#[command(name = "cargo bench --bench fleet --")]
struct Arguments {
    /// Number of measurements of each case.
    #[arg(long, default_value_t = 3)]
    rounds: u32,
    /// Duration of a fleet in real time, in seconds.
    #[arg(long, default_value_t = 10)]
    seconds: u32,
    /// Fleets in virtual time, in robots.
    #[arg(long, value_delimiter = ',', default_value = "10,100,1000")]
    robots: Vec<u32>,
    /// Measure one case, for the process that started this one.
    #[arg(long, hide = true)]
    inside: Option<String>,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Executions of robots per second and core in virtual time.
const GOAL_PER_SECOND: f64 = 1e6;
/// Maximum memory of a fleet of ten robots, in MB.
const GOAL_MB: f64 = 50.0;

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench fleet`");
        return Ok(());
    }
    if let Some(case) = &arguments.inside {
        return child::tell(&serde_json::from_str::<Case>(case)?.measure()?);
    }
    let mut page = format!("The airport fleet. {}.\n", common::description());
    let real = in_real_time(&mut page, &arguments)?;
    let simulated = in_virtual_time(&mut page, &arguments)?;
    common::write("fleet", &page, &[real, simulated])
}

/// A case with the figures of all rounds.
#[derive(Serialize)]
struct Rounds {
    case: Case,
    rounds: Vec<Measured>,
}

impl Rounds {
    fn measure(case: Case, rounds: u32) -> Outcome<Self> {
        eprintln!("{case:?}");
        Ok(Self { case, rounds: (0..rounds).map(|_| child::run(&case)).collect::<Outcome<_>>()? })
    }

    /// The median of a figure.
    fn middle(&self, figure: fn(&Measured) -> f64) -> f64 {
        median(self.rounds.iter().map(figure)).unwrap_or(f64::NAN)
    }
}

fn in_real_time(page: &mut String, arguments: &Arguments) -> Outcome<Vec<Rounds>> {
    writeln!(page, "\n### In real time, beside the original\n")?;
    writeln!(
        page,
        "| robots x period | phases | CPU us per robot execution | original | share | goal | | MB | original | missed |"
    )?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")?;
    let mut all = Vec::new();
    let fleets = ORIGINAL.iter().flat_map(|fleet| [(fleet, Phases::Spread), (fleet, Phases::Together)]);
    for (original, phases) in fleets {
        let (robots, period_ms) = (original.robots, original.period_ms);
        let case = Case::Real { robots, period_ms, phases, seconds: arguments.seconds };
        let measured = Rounds::measure(case, arguments.rounds)?;
        let each = measured.middle(|one| one.cpu_s * 1e6 / one.executions);
        let (share, mb) = (each / original.cpu_us, measured.middle(|one| one.peak_mb));
        let met = share <= original.goal && (robots > 10 || mb <= GOAL_MB);
        let missed: u64 = measured.rounds.iter().map(|one| one.missed).sum();
        writeln!(
            page,
            "| {robots}x{period_ms}ms | {phases:?} | {each:.1} | {} | 1/{:.0} | 1/{:.0} | {} | {mb:.1} | {} | {missed} |",
            original.cpu_us,
            1.0 / share,
            1.0 / original.goal,
            verdict(met),
            original.memory_mb,
        )?;
        all.push(measured);
    }
    Ok(all)
}

fn in_virtual_time(page: &mut String, arguments: &Arguments) -> Outcome<Vec<Rounds>> {
    writeln!(page, "\n### In virtual time\n")?;
    writeln!(page, "| fleet | executions per CPU second | | us each | messages received each | delivered | MB |")?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- | --- |")?;
    let mut all = Vec::new();
    let fleets = arguments.robots.iter().map(|robots| Case::Robots { robots: *robots });
    for case in std::iter::once(Case::Empty { tasks: 1000 }).chain(fleets) {
        let measured = Rounds::measure(case, arguments.rounds)?;
        let per_second = measured.middle(|one| one.executions / one.cpu_s);
        let name = match case {
            Case::Empty { tasks } => format!("{tasks} empty tasks"),
            Case::Robots { robots } | Case::Real { robots, .. } => format!("{robots} robots"),
        };
        writeln!(
            page,
            "| {name} | {per_second:.0} | {} | {:.2} | {:.2} | {} | {:.1} |",
            verdict(per_second >= GOAL_PER_SECOND),
            1e6 / per_second,
            measured.middle(|one| one.received / one.executions),
            measured.middle(|one| one.delivered),
            measured.middle(|one| one.peak_mb),
        )?;
        all.push(measured);
    }
    Ok(all)
}
