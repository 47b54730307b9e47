//! Cost of a robot of the airport fleet in real time, and speed of a fleet in virtual time. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

mod case;
mod original;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;
use std::time::Duration;

use clap::Parser;
use serde::Serialize;

use case::{Case, Measured};
use common::composite::{Airport, Phases};
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
    #[arg(long, value_delimiter = ',', default_value = "10,100,1000,10000")]
    robots: Vec<u32>,
    /// Measure these alone.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "original,large,virtual")]
    parts: Vec<Part>,
    /// Measure one case, for the process that started this one.
    #[arg(long, hide = true)]
    inside: Option<String>,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// A part of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    /// Fleets of the original, in real time.
    Original,
    /// A large fleet in real time.
    Large,
    /// Fleets in virtual time.
    Virtual,
}

/// Time from one piece of luggage near a robot to the next, in the large fleet and in virtual time.
const LUGGAGE_EVERY: Duration = Duration::from_secs(40);
/// Virtual time before that which is measured, in seconds: all robots have entered the floor and begun to work.
const WARM_UP: u32 = 40;
/// Executions that are measured, at least.
const EXECUTIONS: u64 = 1_000_000;
/// Executions of robots per second and core in virtual time: of fleets of up to 100 robots, and of larger ones.
const GOAL_PER_SECOND: (f64, f64) = (1e6, 3e5);
/// Greatest ratio of what an execution costs in the largest fleet, to one in a fleet of so many robots.
const GOAL_RATIOS: [(u32, f64); 2] = [(100, 3.3), (1000, 1.5)];
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
    let mut all = Vec::new();
    for (part, measure) in [
        (Part::Original, in_real_time as fn(&mut String, &Arguments) -> Outcome<Vec<Rounds>>),
        (Part::Large, large),
        (Part::Virtual, in_virtual_time),
    ] {
        if arguments.parts.contains(&part) {
            all.push(measure(&mut page, &arguments)?);
        }
    }
    common::write("fleet", &page, &all)
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
        let airport = Airport::new(robots, Duration::from_millis(period_ms.into()), phases);
        let case = Case::Real { airport, seconds: arguments.seconds };
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

/// A fleet of 1,000 robots of 100 ms in real time: nothing may be missed.
fn large(page: &mut String, arguments: &Arguments) -> Outcome<Vec<Rounds>> {
    writeln!(page, "\n### 1,000 robots of 100 ms in real time\n")?;
    writeln!(page, "| zone | CPU us per robot execution | of a core | missed | | delivered | MB |")?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- | --- |")?;
    let mut all = Vec::new();
    for zone in [false, true] {
        let period = Duration::from_millis(100);
        let airport = Airport { zone, luggage_every: LUGGAGE_EVERY, ..Airport::new(1000, period, Phases::Spread) };
        let measured = Rounds::measure(Case::Real { airport, seconds: arguments.seconds.max(WARM_UP) }, 1)?;
        let missed: u64 = measured.rounds.iter().map(|one| one.missed).sum();
        let each = measured.middle(|one| one.cpu_s * 1e6 / one.executions);
        writeln!(
            page,
            "| {} | {each:.1} | {:.0} % | {missed} | {} | {} | {:.1} |",
            if zone { "yes" } else { "no" },
            each / 1e6 * 1000.0 / period.as_secs_f64() * 100.0,
            verdict(missed == 0),
            measured.middle(|one| one.delivered),
            measured.middle(|one| one.peak_mb),
        )?;
        all.push(measured);
    }
    Ok(all)
}

fn in_virtual_time(page: &mut String, arguments: &Arguments) -> Outcome<Vec<Rounds>> {
    writeln!(page, "\n### In virtual time\n")?;
    let empty = Rounds::measure(Case::Empty { tasks: 1000 }, arguments.rounds)?;
    writeln!(
        page,
        "An execution of 1000 empty tasks: {:.2} us.\n",
        empty.middle(|one| one.cpu_s * 1e6 / one.executions)
    )?;
    writeln!(
        page,
        "| robots | period | zone | us each | executions per CPU second | goal | | messages each | kB a robot |"
    )?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- | --- | --- | --- |")?;
    let mut all = vec![empty];
    let mut ratios = String::new();
    for (period, zone) in [(100, false), (100, true), (1000, false), (1000, true)] {
        let mut costs = Vec::new();
        for &robots in &arguments.robots {
            let period = Duration::from_millis(period);
            let airport =
                Airport { zone, luggage_every: LUGGAGE_EVERY, ..Airport::new(robots, period, Phases::Spread) };
            // Whole waves of luggage.
            let waves =
                EXECUTIONS.div_ceil(u64::from(robots) * (LUGGAGE_EVERY.as_millis() / period.as_millis()) as u64);
            let seconds = WARM_UP + u32::try_from(waves)? * LUGGAGE_EVERY.as_secs() as u32;
            let before = Rounds::measure(Case::Robots { airport, seconds: WARM_UP }, arguments.rounds)?;
            let whole = Rounds::measure(Case::Robots { airport, seconds }, arguments.rounds)?;
            let more = |figure: fn(&Measured) -> f64| whole.middle(figure) - before.middle(figure);
            let executions = more(|one| one.executions);
            let each = more(|one| one.cpu_s) * 1e6 / executions;
            let goal = if robots <= 100 { GOAL_PER_SECOND.0 } else { GOAL_PER_SECOND.1 };
            writeln!(
                page,
                "| {robots} | {} ms | {} | {each:.2} | {:.0} | {goal:.0} | {} | {:.1} | {:.0} |",
                period.as_millis(),
                if zone { "yes" } else { "no" },
                1e6 / each,
                verdict(1e6 / each >= goal),
                more(|one| one.received) / executions,
                whole.middle(|one| one.peak_mb) * 1024.0 / f64::from(robots),
            )?;
            costs.push((robots, each));
            all.extend([before, whole]);
        }
        let Some(&(largest, cost)) = costs.last() else { continue };
        for (robots, goal) in GOAL_RATIOS {
            if let Some((_, base)) = costs.iter().find(|(size, _)| *size == robots && robots < largest) {
                writeln!(
                    ratios,
                    "| {period} ms | {} | {robots} to {largest} | {:.2} | {goal} | {} |",
                    if zone { "yes" } else { "no" },
                    cost / base,
                    verdict(cost / base <= goal),
                )?;
            }
        }
    }
    writeln!(
        page,
        "\n| period | zone | robots | cost grows to | goal | |\n| --- | --- | --- | --- | --- | --- |\n{ratios}"
    )?;
    Ok(all)
}
