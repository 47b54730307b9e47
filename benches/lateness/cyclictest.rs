//! The contender cyclictest (rt-tests): a thread per task, each in clock_nanosleep on absolute times.

use std::fs;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::common::{Outcome, RESULTS, memory};
use crate::probe::Plan;
use crate::run::{Run, Sample, limited};

/// Maximum lateness of its histogram, in us.
const RANGE_US: u64 = 20_000;
/// Each thread's histogram is locked memory, so many threads get shorter ones.
const RANGE_US_OF_MANY: u64 = 5_000;

/// Measures one run. `tuned` lets it keep the processors out of their idle states, which is its default.
pub(crate) fn run(plan: &Plan, fifo: bool, tuned: bool) -> Outcome<Run> {
    let size = plan.size;
    let result = Path::new(RESULTS).join("cyclictest.json");
    let range = if size.tasks > 100 { RANGE_US_OF_MANY } else { RANGE_US };
    let loops = (plan.lead() + plan.warm_up + plan.measured).as_nanos() / size.period.as_nanos();
    let mut command = Command::new("cyclictest");
    command.arg("--quiet").args(["--histfile", "/dev/null"]).arg(format!("--json={}", result.display()));
    command.arg(format!("--histogram={range}")).arg(format!("--threads={}", size.tasks));
    command.arg(format!("--interval={}", size.period.as_micros())).arg(format!("--loops={loops}"));
    // The start of thread i is moved by i times this much: phases spread evenly.
    command.arg(format!("--aligned={}", size.delay(1).as_micros()));
    if fifo {
        command.args(["--mlockall", "--priority=80"]);
    }
    if !tuned {
        command.arg("--default-system");
    }
    // SAFETY: between fork and exec the function makes two system calls and touches no memory of the parent.
    unsafe { command.pre_exec(small_stacks) };
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = command.spawn()?;
    let outcome = limited(&mut child, plan.total() * 3 + Duration::from_secs(30), |child| sample(child, plan));
    let status = child.wait()?;
    let mut run = outcome?;
    if !status.success() {
        let right = if fifo { "; SCHED_FIFO needs CAP_SYS_NICE" } else { "" };
        return Err(format!("ended with {status}{right}").into());
    }
    read(&result, &mut run)?;
    Ok(run)
}

/// The default of 8 MB per thread would be locked whole.
fn small_stacks() -> std::io::Result<()> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: `limit` is a valid place for the value that the call writes.
    if unsafe { libc::getrlimit(libc::RLIMIT_STACK, &raw mut limit) } != 0 {
        return Err(std::io::Error::last_os_error());
    }
    limit.rlim_cur = limit.rlim_max.min(256 << 10);
    // SAFETY: `limit` is a valid value to read.
    if unsafe { libc::setrlimit(libc::RLIMIT_STACK, &raw const limit) } != 0 {
        return Err(std::io::Error::last_os_error());
    }
    Ok(())
}

/// Samples the process well after its start and before it writes its histograms; its rate is known.
fn sample(child: &mut Child, plan: &Plan) -> Outcome<Run> {
    let mut run = Run::default();
    thread::sleep(plan.lead() + plan.warm_up / 2);
    let begin = Sample::take(child.id())?;
    thread::sleep(plan.measured.mul_f64(0.9));
    let end = Sample::take(child.id())?;
    run.memory = memory(child.id())?;
    let time = run.used(&begin, &end);
    let rate = f64::from(plan.size.tasks) / plan.size.period.as_secs_f64();
    run.executions = (rate * time.as_secs_f64()).round() as u64;
    Ok(run)
}

/// Reads the histograms of all threads from its JSON, in us.
fn read(result: &Path, run: &mut Run) -> Outcome<()> {
    let json: serde_json::Value = serde_json::from_slice(&fs::read(result)?)?;
    let threads = json["thread"].as_object().ok_or("cyclictest's JSON has no threads")?;
    for thread in threads.values() {
        let counts = thread["histogram"].as_object().ok_or("cyclictest's JSON has no histogram")?;
        let mut shown = 0;
        for (us, count) in counts {
            let count = count.as_u64().unwrap_or(0);
            run.latenesses.add(us.parse::<u64>()? * 1000, count);
            shown += count;
        }
        // Latenesses beyond its range are counted at the thread's maximum.
        let beyond = thread["cycles"].as_u64().unwrap_or(0).saturating_sub(shown);
        if beyond > 0 {
            run.latenesses.add(thread["max"].as_u64().unwrap_or(0) * 1000, beyond);
        }
    }
    Ok(())
}
