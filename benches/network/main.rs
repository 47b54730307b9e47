//! Messages between the programs of a network, beside bare Zenoh, mosquitto and ActiveMQ. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

mod bare;
mod brokers;
mod components;
mod fleet;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::env;
use std::fmt::Write as _;
use std::io::{BufRead as _, BufReader};
use std::net::TcpListener;
use std::process::{self, Child, Command, Stdio};
use std::sync::PoisonError;
use std::thread::sleep;
use std::time::Duration;

use clap::Parser;
use serde::{Deserialize, Serialize};

use brokers::Wire;
use common::{Outcome, child, cpu_time, median, memory, verdict};
use components::ARRIVALS;

/// Measures latency and throughput of messages of 128 bytes between programs, through a router or broker.
#[derive(Parser)]
#[command(name = "cargo bench --bench network --")]
struct Arguments {
    /// Number of measurements of each case.
    #[arg(long, default_value_t = 3)]
    rounds: u32,
    /// Duration in seconds for which messages are sent.
    #[arg(long, default_value_t = 5)]
    seconds: u32,
    /// Messages per second that are offered, for the throughput.
    #[arg(long, value_delimiter = ',', default_value = "50000,100000,200000,300000,500000,700000,1000000")]
    rates: Vec<u32>,
    /// The contenders; of brokers, those that are installed.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "zenoh,saoms,mosquitto,activemq")]
    contenders: Vec<Contender>,
    /// Numbers of sources and of sinks.
    #[arg(long, value_delimiter = ',', value_parser = shape, default_value = "1x1,1x10,10x10")]
    shapes: Vec<Shape>,
    /// One program of a case, for the process that started this one.
    #[arg(long, hide = true)]
    inside: Option<String>,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Who carries the messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
enum Contender {
    Saoms,
    Zenoh,
    Mosquitto,
    #[value(name = "activemq")]
    ActiveMq,
}

impl Contender {
    /// The words of its broker, if that is a program of others.
    fn wire(self) -> Option<Wire> {
        match self {
            Contender::Saoms | Contender::Zenoh => None,
            Contender::Mosquitto => Some(Wire::Mqtt),
            Contender::ActiveMq => Some(Wire::Stomp),
        }
    }
}

/// How many programs send, and how many receive all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
struct Shape {
    sources: u32,
    sinks: u32,
}

fn shape(text: &str) -> Result<Shape, String> {
    let numbers = text.split_once('x').and_then(|(first, second)| Some((first.parse().ok()?, second.parse().ok()?)));
    let (sources, sinks) = numbers.ok_or_else(|| format!("expected two numbers as `1x10`, found `{text}`"))?;
    Ok(Shape { sources, sinks })
}

/// What a program does.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Part {
    Router,
    /// Sends so many messages every millisecond.
    Source {
        messages: u32,
    },
    Sink,
}

/// One program of a case.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Program {
    contender: Contender,
    part: Part,
    port: u16,
    /// For how long messages are sent, in seconds.
    seconds: u32,
}

/// Time for programs to find each other, before and after the messages.
const MARGIN: Duration = Duration::from_secs(2);
/// Period of the sources.
const PERIOD: Duration = Duration::from_millis(1);
/// Greatest part of the latency of bare Zenoh.
const GOAL_LATENCY: f64 = 1.3;
/// Least number of messages in a second.
const GOAL_RATE: u32 = 500_000;

/// What a program has to say at its end.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Told {
    received: u64,
    p50_us: f64,
    p99_us: f64,
    cpu_s: f64,
    peak_mb: f64,
}

/// A case, measured.
#[derive(Clone, Copy, Debug, Serialize)]
struct Measured {
    contender: Contender,
    shape: Shape,
    /// Messages that all sources send in a second.
    offered: u32,
    received: u64,
    expected: u64,
    p50_us: f64,
    p99_us: f64,
    /// Processor time of all programs, for each message that arrives.
    cpu_us: f64,
    /// Memory of the router or broker, and the most of another program.
    router_mb: f64,
    peak_mb: f64,
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench network`");
        return Ok(());
    }
    if let Some(program) = &arguments.inside {
        return serde_json::from_str::<Program>(program)?.run();
    }
    let is_there = |contender: &Contender| contender.wire().is_none_or(Wire::is_installed);
    let contenders: Vec<Contender> = arguments.contenders.iter().copied().filter(is_there).collect();
    let mut paced = Vec::new();
    let mut bursts = Vec::new();
    for shape in &arguments.shapes {
        for round in 0..arguments.rounds {
            for contender in &contenders {
                eprintln!("{contender:?}, {shape:?}, each source 1,000 messages a second, round {}", round + 1);
                paced.push(measure(*contender, *shape, 1, arguments.seconds)?);
            }
        }
        for contender in &contenders {
            for rate in &arguments.rates {
                let messages = rate / 1_000 / shape.sources;
                if messages < 2 {
                    continue;
                }
                eprintln!("{contender:?}, {shape:?}, {rate} messages a second");
                let measured = measure(*contender, *shape, messages, arguments.seconds)?;
                bursts.push(measured);
                if measured.received < measured.expected {
                    break;
                }
            }
        }
    }
    common::write("network", &page(&paced, &bursts)?, &(paced, bursts))
}

/// Runs the programs of a case.
fn measure(contender: Contender, shape: Shape, messages: u32, seconds: u32) -> Outcome<Measured> {
    let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
    let program = |part| Program { contender, part, port, seconds };
    let mut router = match contender.wire() {
        Some(wire) => Running(wire.broker(port)?),
        None => program(Part::Router).start()?,
    };
    sleep(Duration::from_millis(500));
    let start = |part, count: u32| (0..count).map(|_| program(part).start()).collect::<Outcome<Vec<Running>>>();
    let sinks = start(Part::Sink, shape.sinks)?;
    let sources = start(Part::Source { messages }, shape.sources)?;
    let told = |all: Vec<Running>| all.into_iter().map(Running::told).collect::<Outcome<Vec<Told>>>();
    let (sources, sinks) = (told(sources)?, told(sinks)?);
    let router_cpu = cpu_time(router.0.id())?.as_secs_f64();
    let router_mb = memory(router.0.id())?.peak_kb as f64 / 1e3;
    router.0.kill()?;
    router.0.wait()?;
    let sent = u64::from(messages) * 1_000 * u64::from(seconds) * u64::from(shape.sources);
    let received = sinks.iter().map(|told| told.received).sum();
    let all = || sources.iter().chain(&sinks);
    let cpu_s = router_cpu + all().map(|told| told.cpu_s).sum::<f64>();
    let of_sinks = |what: fn(&Told) -> f64| median(sinks.iter().map(what)).unwrap_or(f64::NAN);
    Ok(Measured {
        contender,
        shape,
        offered: messages * 1_000 * shape.sources,
        received,
        expected: sent * u64::from(shape.sinks),
        p50_us: of_sinks(|told| told.p50_us),
        p99_us: of_sinks(|told| told.p99_us),
        cpu_us: cpu_s * 1e6 / received as f64,
        router_mb,
        peak_mb: all().map(|told| told.peak_mb).fold(0.0, f64::max),
    })
}

/// A program that runs.
struct Running(Child);

impl Running {
    fn told(mut self) -> Outcome<Told> {
        let output = self.0.stdout.take().ok_or("no output")?;
        let mut line = String::new();
        BufReader::new(output).read_line(&mut line)?;
        self.0.wait()?;
        Ok(serde_json::from_str(&line)?)
    }
}

impl Program {
    fn start(&self) -> Outcome<Running> {
        let mut command = Command::new(env::current_exe()?);
        command.args(["--bench", "--inside", &serde_json::to_string(self)?]);
        if self.contender == Contender::Saoms {
            // As the command does.
            command.env("ZENOH_RUNTIME", "(rx: (worker_threads: 1))");
        }
        Ok(Running(command.stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn()?))
    }

    fn run(&self) -> Outcome<()> {
        match self.contender {
            Contender::Zenoh => bare::run(self)?,
            Contender::Saoms => fleet::run(self)?,
            Contender::Mosquitto | Contender::ActiveMq => {
                self.contender.wire().map_or(Ok(()), |wire| wire.run(self))?;
            }
        }
        let mut arrivals = ARRIVALS.lock().unwrap_or_else(PoisonError::into_inner);
        arrivals.delays.sort_unstable();
        let delays = &arrivals.delays;
        let at = |part: f64| delays.get((delays.len() as f64 * part) as usize).map_or(0.0, |nanos| *nanos as f64 / 1e3);
        child::tell(&Told {
            received: delays.len() as u64,
            p50_us: at(0.5),
            p99_us: at(0.99),
            cpu_s: cpu_time(process::id())?.as_secs_f64(),
            peak_mb: memory(process::id())?.peak_kb as f64 / 1e3,
        })
    }
}

fn page(paced: &[Measured], bursts: &[Measured]) -> Result<String, std::fmt::Error> {
    let mut page = format!("Messages of 128 bytes between programs, through a router. {}.\n\n", common::description());
    writeln!(
        page,
        "| each source 1,000 a second | | p50 us | p99 us | CPU us each | MB of the router | of another | |"
    )?;
    writeln!(page, "| --- | --- | ---: | ---: | ---: | ---: | ---: | --- |")?;
    let mut seen = Vec::new();
    for Measured { contender, shape, .. } in paced {
        if seen.contains(&(*shape, *contender)) {
            continue;
        }
        seen.push((*shape, *contender));
        let of = |who| paced.iter().filter(move |one| one.contender == who && one.shape == *shape);
        let middle = |who, what: fn(&Measured) -> f64| median(of(who).map(what)).unwrap_or(f64::NAN);
        let own = |what| middle(*contender, what);
        let (p50, bare) = (own(|one| one.p50_us), middle(Contender::Zenoh, |one| one.p50_us));
        let goal = if *contender == Contender::Saoms && bare.is_finite() {
            format!("{:.2} of bare Zenoh, goal {GOAL_LATENCY}: {}", p50 / bare, verdict(p50 <= GOAL_LATENCY * bare))
        } else {
            String::new()
        };
        let (p99, cpu) = (own(|one| one.p99_us), own(|one| one.cpu_us));
        let (router, peak) = (own(|one| one.router_mb), own(|one| one.peak_mb));
        let Shape { sources, sinks } = shape;
        writeln!(
            page,
            "| {sources} to {sinks} | {contender:?} | {p50:.0} | {p99:.0} | {cpu:.1} | {router:.0} | {peak:.0} | {goal} |"
        )?;
    }
    writeln!(
        page,
        "\n| | messages a second | | received | p50 us | p99 us | CPU us each | MB of the router | of another | |"
    )?;
    writeln!(page, "| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |")?;
    for Measured { contender, shape, offered, received, expected, p50_us, p99_us, cpu_us, router_mb, peak_mb } in bursts
    {
        let part = *received as f64 / *expected as f64 * 100.0;
        let is_judged = *contender == Contender::Saoms && *offered == GOAL_RATE && shape.sinks == 1;
        let goal = if is_judged { verdict(received == expected) } else { "" };
        let Shape { sources, sinks } = shape;
        writeln!(
            page,
            "| {sources} to {sinks} | {offered} | {contender:?} | {part:.1} % | {p50_us:.0} | {p99_us:.0} | {cpu_us:.2} \
             | {router_mb:.0} | {peak_mb:.0} | {goal} |"
        )?;
    }
    Ok(page)
}
