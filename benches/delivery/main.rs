//! Cost of the delivery of a message inside the process. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

mod components;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;
use std::process;
use std::sync::atomic::Ordering;
use std::time::Duration;

use clap::Parser;
use saoms_core::schedule::Settings;
use serde::Serialize;

use common::composite::{Composite, Task};
use common::{Outcome, cpu_time, deploy, median, verdict};
use components::RECEIVED;

/// Measures the processor time that the delivery of a message to a component takes.
#[derive(Parser)]
#[command(name = "cargo bench --bench delivery --")]
struct Arguments {
    /// Number of measurements of each case.
    #[arg(long, default_value_t = 5)]
    rounds: u32,
    /// Duration in seconds of the fleet's time.
    #[arg(long, default_value_t = 1)]
    seconds: u64,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

const PERIOD: Duration = Duration::from_millis(10);
/// Maximum cost of a delivery with ten receivers or more, in ns.
const GOAL: f64 = 50.0;

/// Numbers of senders and receivers on one topic.
#[derive(Clone, Copy, Serialize)]
struct Case {
    senders: u32,
    receivers: u32,
    /// Number of messages of a sender in each execution.
    messages: u32,
}

const CASES: [Case; 6] = [
    Case { senders: 1, receivers: 1, messages: 1 },
    Case { senders: 1, receivers: 1, messages: 1000 },
    Case { senders: 1, receivers: 10, messages: 1000 },
    Case { senders: 10, receivers: 10, messages: 100 },
    Case { senders: 1, receivers: 1000, messages: 1 },
    Case { senders: 1, receivers: 1000, messages: 100 },
];

#[derive(Serialize)]
struct Measured {
    case: Case,
    /// Processor time of a delivery in ns, the median of the rounds.
    real: f64,
    simulated: f64,
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench delivery`");
        return Ok(());
    }
    let mut measured = Vec::new();
    for case in CASES {
        eprintln!("{} to {}, {} messages", case.senders, case.receivers, case.messages);
        let limit = Some(Duration::from_secs(arguments.seconds));
        let middle = |settings: &Settings| {
            let rounds = (0..arguments.rounds).map(|_| case.measure(settings)).collect::<Outcome<Vec<f64>>>()?;
            median(rounds.into_iter()).ok_or("no rounds".into())
        };
        let real = middle(&Settings { limit, ..Settings::default() });
        let simulated: Outcome<f64> = middle(&Settings { limit, ..Settings::simulated(1) });
        measured.push(Measured { case, real: real?, simulated: simulated? });
    }
    common::write("delivery", &page(&measured)?, &measured)
}

impl Case {
    fn composite(&self) -> String {
        let mut composite = Composite::new();
        let mut add = |class, kind, number, properties: &[(&str, &str)]| {
            let name = format!("{kind}{number:04}");
            composite.add(&Task { class, name, period: PERIOD, delay: Duration::ZERO }, properties);
        };
        for number in 0..self.senders {
            add("bench.Sender", "Sender", number, &[("messages", &self.messages.to_string())]);
        }
        for number in 0..self.receivers {
            // Room for many executions of the senders: a receiver that starts late loses nothing.
            add("bench.Receiver", "Receiver", number, &[("queue", "100000")]);
        }
        composite.finish()
    }

    /// All processor time of the process from the fleet's start to its end, per delivery, in ns.
    fn measure(&self, settings: &Settings) -> Outcome<f64> {
        let assembly = deploy::checked(self.composite())?.assembly;
        RECEIVED.store(0, Ordering::Relaxed);
        let before = cpu_time(process::id())?;
        deploy::finish(deploy::start(assembly, settings.clone())?)?;
        let used = cpu_time(process::id())? - before;
        Ok(used.as_nanos() as f64 / RECEIVED.load(Ordering::Relaxed) as f64)
    }
}

fn page(measured: &[Measured]) -> Result<String, std::fmt::Error> {
    let mut page = format!("Delivery inside the process. {}.\n\n", common::description());
    writeln!(
        page,
        "| senders to receivers | messages per execution | ns in real time | ns in virtual time | goal: {GOAL} |"
    )?;
    writeln!(page, "| --- | --- | --- | --- | --- |")?;
    for Measured { case: Case { senders, receivers, messages }, real, simulated } in measured {
        let judged = *receivers >= 10 && *messages > 1;
        let verdict = if judged { verdict(*real <= GOAL) } else { "" };
        writeln!(page, "| {senders} to {receivers} | {messages} | {real:.0} | {simulated:.0} | {verdict} |")?;
    }
    Ok(page)
}
