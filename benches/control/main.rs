//! A fleet in real time with and without clients of its control. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

mod clients;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use clap::Parser;
use saoms_control::Client;
use serde::Serialize;
use serde_json::Value;

use clients::{Asked, Clients};
use common::composite::{Phases, airport};
use common::{Outcome, cpu_time, memory, verdict};

/// Measures a fleet of 100 robots of 100 ms with and without clients.
#[derive(Parser)]
#[command(name = "cargo bench --bench control --")]
struct Arguments {
    /// Number of measurements, each with and without clients.
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
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Time before a measurement, in which the fleet comes to its pace.
const WARM_UP: Duration = Duration::from_secs(2);
/// Time after which a client that reads nothing is dropped, and more.
const DROPPED: Duration = Duration::from_secs(13);

/// A measurement.
#[derive(Serialize)]
struct Measured {
    has_clients: bool,
    executions: u64,
    missed: u64,
    /// The greatest of all components, in microseconds.
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
        "| clients | executions | missed | latest p99 us | CPU s | MB | peak MB | answers | slowest ms | events | dropped | lost |"
    )?;
    writeln!(page, "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")?;
    let mut all = Vec::new();
    for round in 0..arguments.rounds {
        // Forwards in one round and backwards in the next.
        let without_first = round % 2 == 0;
        for has_clients in [!without_first, without_first] {
            eprintln!("round {}: {} clients", round + 1, if has_clients { "with" } else { "without" });
            let measured = measure(&arguments, has_clients)?;
            writeln!(
                page,
                "| {} | {} | {} | {} | {:.2} | {:.1} | {:.1} | {} | {:.0} | {} | {} | {} |",
                if has_clients { "yes" } else { "no" },
                measured.executions,
                measured.missed,
                measured.late_p99_us,
                measured.cpu_s,
                measured.resident_mb,
                measured.peak_mb,
                measured.asked.answers,
                measured.asked.slowest_ms,
                measured.asked.events,
                measured.dropped,
                measured.lost,
            )?;
            all.push(measured);
        }
    }
    let missed =
        |has_clients| -> u64 { all.iter().filter(|one| one.has_clients == has_clients).map(|one| one.missed).sum() };
    let (with, without) = (missed(true), missed(false));
    writeln!(page, "\nMissed with clients {with}, without {without}: {}.", verdict(with <= without))?;
    common::write("control", &page, &all)
}

/// Runs the fleet once, as the command does.
fn measure(arguments: &Arguments, has_clients: bool) -> Outcome<Measured> {
    let folder = tempfile::tempdir()?;
    let lasting = Duration::from_secs(arguments.seconds) + WARM_UP + DROPPED;
    let composite = airport(arguments.robots, Duration::from_millis(100), Phases::Spread, lasting);
    fs::write(folder.path().join("load.composite"), composite)?;
    let (socket, report) = (folder.path().join("fleet.sock"), folder.path().join("report.json"));
    let mut run = Command::new(env!("CARGO_BIN_EXE_saoms"));
    run.current_dir(folder.path()).args(["run", "load.composite", "--stay", "--quiet", "--short-report"]);
    run.args(["--control", "fleet.sock", "--report", "report.json"]).stdout(Stdio::null());
    let mut child = run.spawn()?;
    let client = Client::new(&socket);
    while client.description().is_err() {
        sleep(Duration::from_millis(10));
    }
    sleep(WARM_UP);
    let (before, start) = (counts(&client)?, cpu_time(child.id())?);
    let clients =
        has_clients.then(|| Clients::start(&socket, arguments.followers, arguments.stuck, arguments.requests));
    let begun = Instant::now();
    sleep(Duration::from_secs(arguments.seconds).saturating_sub(begun.elapsed()));
    let (after, cpu) = (counts(&client)?, cpu_time(child.id())?);
    let resident = memory(child.id())?;
    let asked = match clients {
        Some(clients) => {
            sleep(DROPPED);
            clients.end()
        }
        None => Asked::default(),
    };
    let metrics = client.request("GET", "/metrics", "")?.text()?;
    let metric = |name: &str| metrics.lines().find_map(|line| line.strip_prefix(name)?.trim().parse().ok());
    client.request("POST", "/v1/down", "")?;
    child.wait()?;
    Ok(Measured {
        has_clients,
        executions: after.0 - before.0,
        missed: after.1 - before.1,
        late_p99_us: latest(&report)?,
        cpu_s: (cpu - start).as_secs_f64(),
        resident_mb: resident.resident_kb as f64 / 1e3,
        peak_mb: resident.peak_kb as f64 / 1e3,
        asked,
        dropped: metric("saoms_control_dropped_total").unwrap_or(f64::NAN),
        lost: metric("saoms_control_lost_total").unwrap_or(f64::NAN),
    })
}

/// Executions of all components, and those that were missed.
fn counts(client: &Client) -> Outcome<(u64, u64)> {
    let answer = client.request("GET", "/v1/status", "")?.json()?;
    let components = answer["status"]["components"].as_array().cloned().unwrap_or_default();
    let sum = |field: &str| components.iter().filter_map(|one| one[field].as_u64()).sum();
    Ok((sum("executions"), sum("missed")))
}

/// The greatest lateness of a component that 99 of 100 of its executions do not exceed.
fn latest(report: &Path) -> Outcome<u64> {
    let report: Value = serde_json::from_slice(&fs::read(report)?)?;
    let components = report["components"].as_array().cloned().unwrap_or_default();
    Ok(components.iter().filter_map(|one| one["late_us"]["p99"].as_u64()).max().unwrap_or(0))
}
