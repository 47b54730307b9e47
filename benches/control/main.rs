//! A fleet in real time without a control, with one that nobody asks, with clients, a page, a state folder, a history
//! and a recording. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

mod clients;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;
use std::fs;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use clap::Parser;
use saoms_control::Client;
use serde::Serialize;
use serde_json::Value;

use clients::{Asked, Clients};
use common::composite::{Airport, Phases, airport};
use common::{Outcome, cpu_time, median, memory, verdict};

/// Measures a fleet of 100 robots of 100 ms with and without a control, its clients, and what it keeps.
#[derive(Parser)]
#[command(name = "cargo bench --bench control --")]
struct Arguments {
    /// Number of measurements of each load.
    #[arg(long, default_value_t = 3)]
    rounds: u32,
    /// Duration of a measurement in seconds.
    #[arg(long, default_value_t = 10)]
    seconds: u64,
    /// Number of robots.
    #[arg(long, default_value_t = 100)]
    robots: u32,
    /// Clients that follow the log or a topic as it grows.
    #[arg(long, default_value_t = 100)]
    followers: u32,
    /// Clients among these that read nothing.
    #[arg(long, default_value_t = 10)]
    stuck: u32,
    /// Requests of the status in a second.
    #[arg(long, default_value_t = 1000)]
    requests: u32,
    /// The loads.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = LOADS)]
    loads: Vec<Load>,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Time before a measurement, in which the fleet comes to its pace.
const WARM_UP: Duration = Duration::from_secs(2);
/// Time after which a client that reads nothing is dropped, and more.
const DROPPED: Duration = Duration::from_secs(13);

/// What runs beside the fleet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
enum Load {
    /// The fleet has no control (`--control none`).
    NoControl,
    /// Nobody asks.
    Unasked,
    /// `saoms top`, ten times as often as usual.
    Top,
    /// Clients that follow, read nothing, and ask.
    Clients,
    /// A page of the dashboard follows the stream.
    Page,
    /// The fleet keeps its state (`--state`).
    State,
    /// It writes its history (`--history`).
    History,
    /// It records what `saoms view` shows (`--report`).
    Recording,
    /// It records its messages, its journal and its log (`--record`).
    Messages,
    /// All of `Page`, `State`, `History` and `Recording`.
    All,
}

const LOADS: [Load; 10] = [
    Load::NoControl,
    Load::Unasked,
    Load::Top,
    Load::Clients,
    Load::Page,
    Load::State,
    Load::History,
    Load::Recording,
    Load::Messages,
    Load::All,
];

impl Load {
    fn name(self) -> &'static str {
        match self {
            Load::NoControl => "no control",
            Load::Unasked => "not asked",
            Load::Top => "`top`",
            Load::Clients => "clients",
            Load::Page => "page",
            Load::State => "state",
            Load::History => "history",
            Load::Recording => "recording",
            Load::Messages => "messages",
            Load::All => "page, state, history and recording",
        }
    }
}

/// A measurement.
#[derive(Serialize)]
struct Measured {
    load: Load,
    executions: u64,
    missed: u64,
    /// The median and the greatest of all components, in microseconds.
    late_p50_us: u64,
    late_p99_us: u64,
    cpu_s: f64,
    resident_mb: f64,
    peak_mb: f64,
    asked: Asked,
    /// Clients that the server dropped, and lines and messages that others missed.
    dropped: f64,
    lost: f64,
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench control`");
        return Ok(());
    }
    let mut page = format!("Clients of the control. {}.\n\n", common::description());
    writeln!(
        page,
        "{} robots x 100 ms, {} s; {} clients on events, {} of which read nothing, and {} requests of the status a second.\n",
        arguments.robots, arguments.seconds, arguments.followers, arguments.stuck, arguments.requests
    )?;
    writeln!(
        page,
        "| load | executions | missed | late p50 us | late p99 us | CPU s | MB | peak MB | answers | slowest ms | events | dropped | lost |"
    )?;
    writeln!(page, "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")?;
    let mut all = Vec::new();
    for round in 0..arguments.rounds {
        // Forwards in one round and backwards in the next.
        let order: Vec<Load> =
            if round % 2 == 0 { arguments.loads.clone() } else { arguments.loads.iter().rev().copied().collect() };
        for load in order {
            eprintln!("round {}: {}", round + 1, load.name());
            let measured = measure(&arguments, load)?;
            let Measured { executions, missed, late_p50_us, late_p99_us, cpu_s, resident_mb, peak_mb, .. } = measured;
            let (Asked { answers, slowest_ms, events }, dropped, lost) =
                (measured.asked, measured.dropped, measured.lost);
            writeln!(
                page,
                "| {} | {executions} | {missed} | {late_p50_us} | {late_p99_us} | {cpu_s:.2} | {resident_mb:.1} | {peak_mb:.1} | {answers} | {slowest_ms:.0} | {events} | {dropped} | {lost} |",
                load.name(),
            )?;
            all.push(measured);
        }
    }
    let missed = |load| -> u64 { all.iter().filter(|one| one.load == load).map(|one| one.missed).sum() };
    writeln!(page)?;
    let without = missed(Load::Unasked);
    for load in [Load::Clients, Load::All] {
        let with = missed(load);
        writeln!(page, "Missed with {} {with}, without {without}: {}.", load.name(), verdict(with <= without))?;
    }
    let resident =
        |load| median(all.iter().filter(|one| one.load == load).map(|one| one.resident_mb)).unwrap_or(f64::NAN);
    let more = resident(Load::Unasked) - resident(Load::NoControl);
    writeln!(
        page,
        "Memory of a control that nobody asks: {more:.1} MB (median), at most 3: {}.",
        verdict(more <= 3.0)
    )?;
    common::write("control", &page, &all)
}

/// Runs the fleet once, as the command does.
fn measure(arguments: &Arguments, load: Load) -> Outcome<Measured> {
    let folder = tempfile::tempdir()?;
    let lasting = Duration::from_secs(arguments.seconds) + WARM_UP + DROPPED;
    let composite = airport(Airport::new(arguments.robots, Duration::from_millis(100), Phases::Spread), lasting);
    fs::write(folder.path().join("load.composite"), composite)?;
    let (socket, report) = (folder.path().join("fleet.sock"), folder.path().join("report.json"));
    let command = || {
        let mut command = Command::new(env!("CARGO_BIN_EXE_saoms"));
        command.current_dir(folder.path()).stdout(Stdio::null());
        command
    };
    let mut run = command();
    run.args(["run", "load.composite", "--stay", "--quiet", "--report", "report.json"]);
    if load == Load::Messages {
        run.args(["--record", "run.mcap"]);
    }
    let is = |one| load == one || load == Load::All;
    if !is(Load::Recording) {
        run.arg("--short-report");
    }
    if is(Load::State) {
        run.args(["--state", "state"]);
    }
    if is(Load::History) {
        run.args(["--history", "history.db"]);
    }
    run.arg("--control");
    let mut child = run.arg(if load == Load::NoControl { "none" } else { "fleet.sock" }).spawn()?;
    sleep(WARM_UP);
    let start = cpu_time(child.id())?;
    let begun = Instant::now();
    let (mut clients, mut top) = (None, None);
    match load {
        Load::NoControl | Load::Unasked | Load::State | Load::History | Load::Recording | Load::Messages => {}
        Load::Top => {
            top = Some(command().args(["top", "--every", "100ms", "--fleet", "./fleet.sock"]).spawn()?);
        }
        Load::Clients => {
            clients = Some(Clients::start(&socket, arguments.followers, arguments.stuck, arguments.requests));
        }
        // It ends with the fleet.
        Load::Page | Load::All => clients::follow(&socket, "/v1/stream", &Arc::default()),
    }
    sleep(Duration::from_secs(arguments.seconds).saturating_sub(begun.elapsed()));
    let cpu = cpu_time(child.id())?;
    let resident = memory(child.id())?;
    let (mut asked, mut dropped, mut lost) = (Asked::default(), 0.0, 0.0);
    if let Some(clients) = clients {
        sleep(DROPPED);
        asked = clients.end();
        let metrics = Client::new(&socket).request("GET", "/metrics", "")?.text()?;
        let metric = |name: &str| metrics.lines().find_map(|line| line.strip_prefix(name)?.trim().parse().ok());
        dropped = metric("saoms_control_dropped_total").unwrap_or(f64::NAN);
        lost = metric("saoms_control_lost_total").unwrap_or(f64::NAN);
    }
    terminate(&child);
    child.wait()?;
    if let Some(mut top) = top {
        // It ends with the fleet.
        top.wait()?;
    }
    let report: Value = serde_json::from_slice(&fs::read(report)?)?;
    let of_components = |field: fn(&Value) -> Option<u64>| -> Vec<u64> {
        report["components"].as_array().into_iter().flatten().filter_map(field).collect()
    };
    let mut p50 = of_components(|one| one["late_us"]["p50"].as_u64());
    p50.sort_unstable();
    Ok(Measured {
        load,
        executions: of_components(|one| one["executions"].as_u64()).iter().sum(),
        missed: of_components(|one| one["missed"].as_u64()).iter().sum(),
        late_p50_us: p50.get(p50.len() / 2).copied().unwrap_or(0),
        late_p99_us: of_components(|one| one["late_us"]["p99"].as_u64()).into_iter().max().unwrap_or(0),
        cpu_s: (cpu - start).as_secs_f64(),
        resident_mb: resident.resident_kb as f64 / 1e3,
        peak_mb: resident.peak_kb as f64 / 1e3,
        asked,
        dropped,
        lost,
    })
}

/// Ends a fleet as the system does.
fn terminate(child: &Child) {
    if let Ok(pid) = libc::pid_t::try_from(child.id()) {
        // SAFETY: a signal to another process touches no memory of this one. The child was not waited for, so that its
        // number belongs to nobody else.
        unsafe { libc::kill(pid, libc::SIGTERM) };
    }
}
