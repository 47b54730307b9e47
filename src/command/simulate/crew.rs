//! The processes of a simulation: each runs the seeds that it is given, so that a crash costs one seed, not all.

use std::env;
use std::io::{self, BufRead, BufReader, IsTerminal, Write};
use std::ops::RangeInclusive;
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use super::ending::{Shared, share, wait_for};
use super::one::{RunSeed, SeedResult, Simulation};
use super::{Side, SimulateArguments};
use crate::output::{eprint, has_failed, print_json_line};

/// Runs the seeds that come on standard input, one a line; each result is a line of JSON.
pub(super) fn work(simulation: &Simulation) {
    for line in io::stdin().lock().lines() {
        let Some(seed) = line.ok().and_then(|line| line.trim().parse().ok()) else { return };
        print_json_line(&simulation.run(seed));
        if has_failed() {
            return;
        }
    }
}

/// A process that runs seeds.
struct Worker {
    child: Shared,
    seeds: ChildStdin,
    results: BufReader<ChildStdout>,
}

impl Worker {
    /// Starts a process with the same arguments, for one of the fleets.
    fn start(side: Side) -> io::Result<Worker> {
        let mut command = Command::new(env::current_exe()?);
        command
            .args(env::args_os().skip(1))
            .args(["--worker", side.word()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        let mut child = command.spawn()?;
        let missing = || io::Error::other("it has no pipe");
        let seeds = child.stdin.take().ok_or_else(missing)?;
        let results = BufReader::new(child.stdout.take().ok_or_else(missing)?);
        Ok(Worker { child: share(child), seeds, results })
    }

    /// Runs a seed; `None` if the process does not answer any more.
    fn run(&mut self, seed: u64) -> Option<RunSeed> {
        writeln!(self.seeds, "{seed}").ok()?;
        let mut line = String::new();
        self.results.read_line(&mut line).ok()?;
        serde_json::from_str(&line).ok()
    }

    /// Ends the process; gives how it ended.
    fn end(self) -> String {
        drop(self.seeds);
        wait_for(&self.child)
    }
}

/// Runs all seeds of a fleet, and gives them in their order.
///
/// # Errors
/// No process can be started.
pub(super) fn run(
    arguments: &SimulateArguments,
    side: Side,
    seeds: RangeInclusive<u64>,
) -> Result<Vec<RunSeed>, String> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let jobs = arguments.jobs.map_or(cores, usize::from).min(usize::try_from(arguments.seeds).unwrap_or(usize::MAX));
    let (next, results) = (AtomicU64::new(0), Mutex::new(Vec::new()));
    let progress = Progress::new(arguments.seeds);
    let first = *seeds.start();
    let crew = || -> Result<(), String> {
        let start =
            || Worker::start(side).map_err(|error| format!("a process for the seeds cannot be started: {error}"));
        let mut worker = start()?;
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            if place >= arguments.seeds {
                worker.end();
                return Ok(());
            }
            let seed = first.saturating_add(place);
            let run = match worker.run(seed) {
                Some(run) => run,
                None => {
                    let how = std::mem::replace(&mut worker, start()?).end();
                    SeedResult::failed(seed, format!("the process that ran it ended: {how}")).into()
                }
            };
            progress.note(&run.result);
            results.lock().unwrap_or_else(PoisonError::into_inner).push(run);
        }
    };
    thread::scope(|scope| {
        let all: Vec<_> = (0..jobs).map(|_| scope.spawn(crew)).collect();
        let ended = all.into_iter().map(|one| one.join().unwrap_or_else(|_| Err("a thread panicked".to_owned())));
        // All are waited for.
        ended.collect::<Vec<_>>().into_iter().collect::<Result<Vec<()>, String>>()
    })?;
    progress.end();
    let mut results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.sort_unstable_by_key(|run| run.result.seed);
    Ok(results)
}

/// How far the simulation is, on standard error.
struct Progress {
    seeds: u64,
    is_terminal: bool,
    state: Mutex<(u64, u64)>,
}

impl Progress {
    fn new(seeds: u64) -> Progress {
        Progress { seeds, is_terminal: io::stderr().is_terminal(), state: Mutex::new((0, 0)) }
    }

    fn note(&self, result: &SeedResult) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.0 += 1;
        state.1 += u64::from(!result.is_clean());
        let (done, failing) = *state;
        let step = (self.seeds / 10).max(1);
        if self.is_terminal {
            let mut standard = io::stderr().lock();
            // A line that is lost is no loss.
            let _ = write!(standard, "\r{done} of {} seeds, {failing} with violations", self.seeds);
            let _ = standard.flush();
        } else if done.is_multiple_of(step) {
            eprint(&format!("{done} of {} seeds, {failing} with violations\n", self.seeds));
        }
    }

    fn end(&self) {
        if self.is_terminal {
            eprint("\n");
        }
    }
}
