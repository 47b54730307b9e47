//! The driver's side of a run: start the process, sample it at the window's ends, read its latenesses.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use crate::common::{Busy, Memory, Outcome, cpu_time, memory};
use crate::histogram::Histogram;
use crate::probe::Plan;

/// Result of one run of one contender.
#[derive(Clone, Default)]
pub(crate) struct Run {
    pub(crate) latenesses: Histogram,
    /// Executions that were due in the window and did not start; unknown for cyclictest.
    pub(crate) missed: Option<u64>,
    /// Executions while the processor time was measured.
    pub(crate) executions: u64,
    pub(crate) cpu: Duration,
    pub(crate) memory: Memory,
    /// Usage of one core by other processes and the host, as a share of the time.
    pub(crate) others: f64,
    pub(crate) stolen: f64,
}

/// The state of a process and of the machine at one end of the window.
pub(crate) struct Sample {
    time: Instant,
    cpu: Duration,
    busy: Busy,
}

impl Sample {
    pub(crate) fn take(pid: u32) -> Outcome<Self> {
        Ok(Self { time: Instant::now(), cpu: cpu_time(pid)?, busy: Busy::now()? })
    }
}

impl Run {
    /// Sets the usage between two samples, and returns the time between them.
    pub(crate) fn used(&mut self, from: &Sample, to: &Sample) -> Duration {
        let time = to.time - from.time;
        self.cpu = to.cpu.saturating_sub(from.cpu);
        let others = to.busy.used_since(&from.busy).saturating_sub(self.cpu);
        self.others = others.as_secs_f64() / time.as_secs_f64();
        self.stolen = to.busy.stolen_since(&from.busy).as_secs_f64() / time.as_secs_f64();
        time
    }
}

/// Runs a contender that speaks the protocol of [`crate::probe::report`].
pub(crate) fn run(mut command: Command, plan: &Plan) -> Outcome<Run> {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn()?;
    let outcome = limited(&mut child, plan.total() * 3 + Duration::from_secs(30), |child| measure(child, plan));
    let status = child.wait()?;
    let run = outcome?;
    if !status.success() {
        return Err(format!("ended with {status}").into());
    }
    Ok(run)
}

/// Runs `work` with the child, which is killed if that takes longer than `limit` or fails.
pub(crate) fn limited<T>(
    child: &mut Child,
    limit: Duration,
    work: impl FnOnce(&mut Child) -> Outcome<T>,
) -> Outcome<T> {
    let pid = child.id().cast_signed();
    let (done, waiting) = mpsc::channel::<()>();
    let guard = thread::spawn(move || {
        let late = waiting.recv_timeout(limit) == Err(mpsc::RecvTimeoutError::Timeout);
        if late {
            // SAFETY: a plain system call; the child is not waited for before this thread has ended, so `pid` is its
            // own.
            unsafe { libc::kill(pid, libc::SIGKILL) };
        }
        late
    });
    let outcome = work(child);
    drop(done);
    let late = guard.join().unwrap_or(false);
    if late {
        return Err(format!("did not end within {limit:?}").into());
    }
    if outcome.is_err() {
        child.kill()?;
    }
    outcome
}

fn measure(child: &mut Child, plan: &Plan) -> Outcome<Run> {
    let pid = child.id();
    let output = child.stdout.take().ok_or("the contender has no output")?;
    let mut run = Run::default();
    let mut begin = None;
    let mut ended = false;
    for line in BufReader::new(output).lines() {
        let line = line?;
        let mut words = line.split_whitespace();
        let word = words.next();
        let mut number = || words.next().and_then(|word| word.parse::<u64>().ok()).unwrap_or(0);
        match word {
            Some("begin") => begin = Some((Sample::take(pid)?, number())),
            Some("end") => {
                let end = Sample::take(pid)?;
                let (begin, before) = begin.as_ref().ok_or("`end` without `begin`")?;
                run.used(begin, &end);
                run.executions = number() - before;
                run.memory = memory(pid)?;
                ended = true;
                drop(child.stdin.take());
            }
            Some("late") => run.latenesses.add(number(), number()),
            _ => {}
        }
    }
    if !ended {
        return Err(last_words(child).into());
    }
    run.missed = Some(plan.size.due_in(plan.measured).saturating_sub(run.latenesses.total()));
    Ok(run)
}

/// First line of the contender's standard error.
fn last_words(child: &mut Child) -> String {
    let mut text = String::new();
    if let Some(mut errors) = child.stderr.take() {
        let _ignored = errors.read_to_string(&mut text);
    }
    let line = text.lines().find(|line| !line.trim().is_empty());
    format!("ended early: {}", line.unwrap_or("without a word"))
}
