//! Processor time and memory of `saoms check` for large composites. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;
mod texts;

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Parser;
use serde::Serialize;

use common::{Outcome, median, verdict};
use texts::{real, robots, unknown};

/// Measures the whole command on large composites, each run a process of its own.
#[derive(Parser)]
#[command(name = "cargo bench --bench check --")]
struct Arguments {
    /// Number of measurements of each case.
    #[arg(long, default_value_t = 5)]
    rounds: u32,
    /// The size of the large composites, in MB.
    #[arg(long, default_value_t = 5)]
    size: usize,
    /// A folder with composites of SCA 1.0, whose components make up one of the large ones.
    #[arg(long)]
    components: Option<PathBuf>,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Maximum processor time for 10,000 components with wires, in seconds.
const GOAL_WIRED: f64 = 0.5;
/// Maximum processor time for a MB of a large composite, in seconds.
const GOAL_MEGABYTE: f64 = 0.02;

/// A composite to check.
struct Case {
    name: &'static str,
    text: String,
    /// True if classes are taken as given.
    assumes: bool,
    /// Maximum processor time in seconds.
    goal: f64,
}

/// Measurements of a run.
#[derive(Serialize)]
struct Measured {
    seconds: f64,
    /// The part of it in the kernel, mainly for memory.
    system: f64,
}

fn main() -> Outcome<()> {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench check`");
        return Ok(());
    }
    let size = arguments.size * 1_000_000;
    let goal = size as f64 / 1e6 * GOAL_MEGABYTE;
    let mut cases = vec![
        Case {
            name: "10,000 robots, each with a `wire`",
            text: robots(usize::MAX, 10_000, true),
            assumes: false,
            goal: GOAL_WIRED,
        },
        Case { name: "robots", text: robots(size, usize::MAX, false), assumes: false, goal },
        Case { name: "components of 50 unknown classes", text: unknown(size), assumes: true, goal },
    ];
    let folder = Path::new(common::RESULTS).join("check");
    fs::create_dir_all(&folder)?;
    let path = folder.join("large.composite");
    if let Some(from) = &arguments.components {
        let text = real(from, size, |text| {
            fs::write(&path, text)?;
            Ok(checked(&path, true).is_ok())
        })?;
        cases.push(Case { name: "components of real composites", text, assumes: true, goal });
    }
    let mut page = format!("`saoms check`, processor time of one core. {}.\n\n", common::description());
    writeln!(page, "| | MB | bytes an element | s | of these system | MB/s | goal s | |")?;
    writeln!(page, "| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |")?;
    let mut raw = Vec::new();
    for Case { name, text, assumes, goal } in &cases {
        eprintln!("{name}");
        fs::write(&path, text)?;
        let rounds: Vec<Measured> = (0..arguments.rounds).map(|_| checked(&path, *assumes)).collect::<Outcome<_>>()?;
        fs::remove_file(&path)?;
        let middle = |figure: fn(&Measured) -> f64| median(rounds.iter().map(figure)).unwrap_or(f64::NAN);
        let (seconds, system) = (middle(|one| one.seconds), middle(|one| one.system));
        let (size, elements) = (text.len() as f64, text.matches('<').count() - text.matches("</").count());
        writeln!(
            page,
            "| {name} | {:.1} | {:.0} | {seconds:.2} | {system:.2} | {:.0} | {goal:.2} | {} |",
            size / 1e6,
            size / elements as f64,
            size / 1e6 / seconds,
            verdict(seconds <= *goal)
        )?;
        raw.push((*name, rounds));
    }
    common::write("check", &page, &raw)
}

/// Checks a composite, which must not have errors.
fn checked(path: &Path, assumes: bool) -> Outcome<Measured> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_saoms"));
    command.arg("check").args(assumes.then_some("--assume-classes")).arg(path);
    let before = children()?;
    let output = command.stderr(Stdio::null()).output()?;
    let after = children()?;
    let said = String::from_utf8_lossy(&output.stdout);
    if !said.contains("0 errors, 0 warnings") {
        return Err(format!("{}: {said}", path.display()).into());
    }
    Ok(Measured { seconds: after.0 + after.1 - before.0 - before.1, system: after.1 - before.1 })
}

/// The processor time of all processes that this one started and that have ended, in seconds: their own, and that of
/// the system for them.
fn children() -> io::Result<(f64, f64)> {
    // SAFETY: integers alone, for which all zeros are valid.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: `usage` is a valid place for the one value that the call writes.
    if unsafe { libc::getrusage(libc::RUSAGE_CHILDREN, &raw mut usage) } != 0 {
        return Err(io::Error::last_os_error());
    }
    let seconds = |time: libc::timeval| time.tv_sec as f64 + time.tv_usec as f64 / 1e6;
    Ok((seconds(usage.ru_utime), seconds(usage.ru_stime)))
}
