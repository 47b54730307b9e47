//! Lateness of a periodic start, beside cyclictest, tokio and Java's executors. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

mod contender;
mod cyclictest;
mod goals;
mod histogram;
mod interval;
mod probe;
mod report;
mod rounds;
mod run;
mod saoms;
mod size;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fs;
use std::time::Duration;

use clap::Parser;

use common::{Outcome, RESULTS};
use contender::Contender;
use probe::Plan;
use size::Size;

/// Measures how late a periodic task starts, beside other ways to start one.
#[derive(Parser)]
#[command(name = "cargo bench --bench lateness --")]
struct Arguments {
    /// Rounds; all contenders run forwards in one and backwards in the next (A B B A).
    #[arg(long, default_value_t = 5)]
    rounds: u32,
    /// Measured time of one run, in seconds.
    #[arg(long, default_value = "2.5", value_parser = seconds)]
    seconds: Duration,
    /// Time before the measurement, in seconds.
    #[arg(long, default_value = "1", value_parser = seconds)]
    warm_up: Duration,
    /// Sizes, as TASKSxPERIOD.
    #[arg(long, value_delimiter = ',', default_value = "10x100ms,100x10ms,1000x10ms,1000x100ms,10000x100ms")]
    sizes: Vec<Size>,
    /// Contenders by name; by default the usual ones.
    #[arg(long, value_delimiter = ',')]
    contenders: Vec<String>,
    /// Run this contender, for the driver.
    #[arg(long, hide = true)]
    inside: Option<String>,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench lateness`");
        return Ok(());
    }
    let plans: Vec<Plan> = arguments.sizes.iter().map(|size| plan(*size, &arguments)).collect();
    if let Some(name) = &arguments.inside {
        let plan = plans.first().ok_or("no size")?;
        return named(name)?.be(plan);
    }
    fs::create_dir_all(RESULTS)?;
    let contenders = chosen(&arguments.contenders)?;
    let measured = rounds::measure(&plans, &contenders, arguments.rounds);
    report::write(&measured)
}

fn plan(size: Size, arguments: &Arguments) -> Plan {
    Plan { size, warm_up: size.whole_periods(arguments.warm_up), measured: size.whole_periods(arguments.seconds) }
}

fn seconds(text: &str) -> Result<Duration, String> {
    let number = text.parse().ok().filter(|seconds: &f64| *seconds > 0.0);
    let time = number.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    time.ok_or_else(|| "expected seconds above 0, such as 2.5".to_owned())
}

fn named(name: &str) -> Outcome<&'static Contender> {
    contender::ALL.iter().find(|contender| contender.name == name).ok_or_else(|| {
        let known: Vec<&str> = contender::ALL.iter().map(|contender| contender.name).collect();
        format!("there is no contender `{name}`; there are {}", known.join(", ")).into()
    })
}

fn chosen(names: &[String]) -> Outcome<Vec<&'static Contender>> {
    let usual = || contender::ALL.iter().filter(|contender| contender.usual).collect();
    let wanted: Vec<_> = match names {
        [] => usual(),
        names => names.iter().map(|name| named(name)).collect::<Outcome<_>>()?,
    };
    let available = |contender: &&Contender| {
        let reason = contender.unavailable();
        if let Some(reason) = &reason {
            eprintln!("{} is skipped: {reason}", contender.name);
        }
        reason.is_none()
    };
    Ok(wanted.into_iter().filter(available).collect())
}
