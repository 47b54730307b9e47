//! Time of a composite from its text to the first execution of all its components, and its memory. See
//! `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;
use std::process;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use clap::Parser;
use saoms_api::{Class, Component, Context, Failure};
use saoms_core::schedule::Settings;
use serde::{Deserialize, Serialize};

use common::composite::{Airport, Composite, Phases, Task, airport};
use common::{Outcome, child, deploy, median, memory, verdict};

/// Measures load, check, start and first execution of composites, and their memory.
#[derive(Parser)]
#[command(name = "cargo bench --bench load --")]
struct Arguments {
    /// Number of measurements of each case.
    #[arg(long, default_value_t = 5)]
    rounds: u32,
    /// Numbers of components.
    #[arg(long, value_delimiter = ',', default_value = "1000,10000")]
    sizes: Vec<u32>,
    /// Measure one case, for the process that started this one.
    #[arg(long, hide = true)]
    inside: Option<String>,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Maximum time of 1000 components to their first execution, in ms; proportional for more components.
const GOAL_MS: f64 = 50.0;
/// Maximum memory of an idle component, in kB.
const GOAL_KB: f64 = 4.0;
/// Longer than the measurement, so that nothing is executed twice.
const PERIOD: Duration = Duration::from_secs(60);

/// Executions of [`Idle`] that are still to come.
static AWAITED: AtomicU32 = AtomicU32::new(0);
static ALL_EXECUTED: OnceLock<Instant> = OnceLock::new();

/// Does nothing.
#[derive(Class)]
#[class(name = "bench.Idle", periodic)]
struct Idle;

impl Component for Idle {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Self)
    }

    fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        if AWAITED.fetch_sub(1, Ordering::Relaxed) == 1 {
            ALL_EXECUTED.get_or_init(Instant::now);
        }
        Ok(())
    }
}

/// Content of the composite.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Case {
    /// Components that do nothing, to which the goals apply.
    Idle(u32),
    /// An airport with this number of robots.
    Robots(u32),
}

/// Result of a process: times in ms, memory in kB.
#[derive(Serialize, Deserialize)]
struct Measured {
    load: f64,
    check: f64,
    start: f64,
    /// Time from the end of the start to the last first execution; unknown for robots.
    first_executions: f64,
    /// Additional memory since before the text was read.
    resident: f64,
    peak: f64,
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench load`");
        return Ok(());
    }
    if let Some(case) = &arguments.inside {
        return child::tell(&serde_json::from_str::<Case>(case)?.measure()?);
    }
    let mut page = format!("From the text of a composite to its first executions. {}.\n\n", common::description());
    writeln!(page, "| | load ms | check ms | start ms | first executions ms | together ms | | kB each | | most MB |")?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")?;
    let few = measure(Case::Idle(1), arguments.rounds)?;
    let few = median(few.iter().map(|one| one.resident)).unwrap_or(f64::NAN);
    let mut raw = Vec::new();
    for kind in [Case::Idle, Case::Robots] {
        for case in arguments.sizes.iter().map(|size| kind(*size)) {
            let rounds = measure(case, arguments.rounds)?;
            case.row(&mut page, &rounds, few)?;
            raw.push((case, rounds));
        }
    }
    common::write("load", &page, &raw)
}

fn measure(case: Case, rounds: u32) -> Outcome<Vec<Measured>> {
    eprintln!("{case:?}");
    (0..rounds).map(|_| child::run(&case)).collect()
}

impl Case {
    /// Adds a row to the table. A fleet of one component takes `few` kB, which are not counted as memory of components.
    fn row(self, page: &mut String, rounds: &[Measured], few: f64) -> std::fmt::Result {
        let middle = |figure: fn(&Measured) -> f64| median(rounds.iter().map(figure)).unwrap_or(f64::NAN);
        let together = middle(|one| one.load + one.check + one.start + one.first_executions);
        let resident = middle(|one| one.resident) - few;
        let (name, each, time, memory) = match self {
            Case::Idle(size) => {
                let each = resident / f64::from(size);
                let in_time = together <= GOAL_MS * f64::from(size) / 1000.0;
                (format!("{size} idle components"), each, verdict(in_time), verdict(each <= GOAL_KB))
            }
            Case::Robots(size) => (format!("{size} robots"), resident / f64::from(size), "", ""),
        };
        writeln!(
            page,
            "| {name} | {:.1} | {:.1} | {:.1} | {:.1} | {together:.1} | {time} | {each:.1} | {memory} | {:.1} |",
            middle(|one| one.load),
            middle(|one| one.check),
            middle(|one| one.start),
            middle(|one| one.first_executions),
            middle(|one| one.peak) / 1024.0,
        )
    }

    fn composite(self) -> String {
        match self {
            Case::Robots(size) => airport(Airport::new(size, PERIOD, Phases::Spread), Duration::ZERO),
            Case::Idle(size) => {
                let mut composite = Composite::new();
                for number in 0..size {
                    let name = format!("Component{number:05}");
                    let task = Task { class: "bench.Idle", name, period: PERIOD, delay: Duration::ZERO };
                    composite.add(&task, &[]);
                }
                composite.finish()
            }
        }
    }

    fn measure(self) -> Outcome<Measured> {
        if let Case::Idle(size) = self {
            AWAITED.store(size, Ordering::Relaxed);
        }
        let text = self.composite();
        let before = memory(process::id())?.resident_kb as f64 - text.len() as f64 / 1024.0;
        let deploy::Checked { assembly, load, check } = deploy::checked(text)?;
        let begin = Instant::now();
        let fleet = deploy::start(assembly, Settings::default())?;
        let started = Instant::now();
        let mut executed = started;
        if let Case::Idle(_) = self {
            while ALL_EXECUTED.get().is_none() {
                thread::sleep(Duration::from_millis(1));
            }
            executed = ALL_EXECUTED.get().copied().unwrap_or(started);
        }
        let after = memory(process::id())?;
        fleet.handle().stop();
        deploy::finish(fleet)?;
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        Ok(Measured {
            load: ms(load),
            check: ms(check),
            start: ms(started - begin),
            // The first of them may be over before the start is.
            first_executions: ms(executed.saturating_duration_since(started)),
            resident: after.resident_kb as f64 - before,
            peak: after.peak_kb as f64,
        })
    }
}
