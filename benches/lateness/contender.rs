//! The contenders, and how each is started.

use std::env;
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use saoms_core::schedule::Settings;

use crate::common::Outcome;
use crate::probe::Plan;
use crate::run::{self, Run};
use crate::{cyclictest, interval, saoms};

/// One way to start tasks periodically.
pub(crate) struct Contender {
    /// Name on the command line.
    pub(crate) name: &'static str,
    /// Name in the tables.
    pub(crate) title: &'static str,
    kind: Kind,
    /// True if it runs unless others are asked for.
    pub(crate) usual: bool,
}

enum Kind {
    Cyclictest {
        fifo: bool,
        tuned: bool,
    },
    Java {
        mode: &'static str,
    },
    /// A process of this program, so that processor time and memory are the contender's own.
    Inside(fn(&Plan) -> Outcome<()>),
}

/// Maximum number of threads. Beyond it, thread creation dominates the measurement, and the process or the machine can
/// run out of threads.
const MOST_THREADS: u32 = 2000;

/// All contenders, in the order of the tables.
pub(crate) const ALL: &[Contender] = &[
    Contender {
        name: "cyclictest-fifo",
        title: "cyclictest, SCHED_FIFO",
        kind: Kind::Cyclictest { fifo: true, tuned: true },
        usual: true,
    },
    Contender {
        name: "cyclictest-fifo-untuned",
        title: "cyclictest, SCHED_FIFO, processor idle states left alone",
        kind: Kind::Cyclictest { fifo: true, tuned: false },
        usual: false,
    },
    Contender {
        name: "saoms-fifo",
        title: "SAOMS, SCHED_FIFO (`--realtime`)",
        kind: Kind::Inside(|plan| saoms::run(plan, Settings { realtime: true, ..Settings::default() })),
        usual: true,
    },
    Contender {
        name: "cyclictest",
        title: "cyclictest, normal priority",
        kind: Kind::Cyclictest { fifo: false, tuned: true },
        usual: true,
    },
    Contender {
        name: "saoms",
        title: "SAOMS, normal priority, timer slack 1 ns",
        kind: Kind::Inside(|plan| {
            saoms::run(plan, Settings { timer_slack: Duration::from_nanos(1), ..Settings::default() })
        }),
        usual: true,
    },
    Contender {
        name: "saoms-50us",
        title: "SAOMS, normal priority, timer slack 50 us (default)",
        kind: Kind::Inside(|plan| saoms::run(plan, Settings::default())),
        usual: true,
    },
    Contender { name: "tokio", title: "tokio `interval`", kind: Kind::Inside(interval::run), usual: true },
    Contender {
        name: "java-per-task",
        title: "Java, a ScheduledThreadPool(1) per task",
        kind: Kind::Java { mode: "per-task" },
        usual: true,
    },
    Contender { name: "java-pool", title: "Java, one pool of 2", kind: Kind::Java { mode: "pool" }, usual: true },
];

impl Contender {
    /// Reason why the contender cannot run on this machine, if there is one.
    pub(crate) fn unavailable(&self) -> Option<String> {
        let (tool, package) = match self.kind {
            Kind::Cyclictest { .. } => ("cyclictest", "Debian package rt-tests"),
            Kind::Java { .. } => ("javac", "a JDK"),
            Kind::Inside(_) => return None,
        };
        let paths = env::var_os("PATH").unwrap_or_default();
        let found = env::split_paths(&paths).any(|folder| folder.join(tool).is_file());
        (!found).then(|| format!("`{tool}` is not installed ({package})"))
    }

    /// Measures the contender once.
    pub(crate) fn run(&self, plan: &Plan) -> Outcome<Run> {
        let thread_per_task = matches!(self.kind, Kind::Cyclictest { .. } | Kind::Java { mode: "per-task" });
        if thread_per_task && plan.size.tasks > MOST_THREADS {
            return Err(format!("a thread per task: not run with more than {MOST_THREADS}").into());
        }
        match self.kind {
            Kind::Cyclictest { fifo, tuned } => cyclictest::run(plan, fifo, tuned),
            Kind::Java { mode } => run::run(java(plan, mode)?, plan),
            Kind::Inside(_) => run::run(again(plan, self.name)?, plan),
        }
    }

    /// Runs the contender in this process.
    pub(crate) fn be(&self, plan: &Plan) -> Outcome<()> {
        match self.kind {
            Kind::Inside(run) => run(plan),
            _ => Err(format!("contender `{}` is another program", self.name).into()),
        }
    }
}

/// Compiled first: a source file run by `java` leaves the compiler in the measured process.
fn java(plan: &Plan, mode: &str) -> Outcome<Command> {
    let classes = Path::new(crate::common::RESULTS).join("java");
    let source = "benches/lateness/Lateness.java";
    let changed = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
    if changed(&classes.join("Lateness.class")) < changed(Path::new(source)) {
        fs::create_dir_all(&classes)?;
        let status = Command::new("javac").arg("-d").arg(&classes).arg(source).status()?;
        if !status.success() {
            return Err(format!("javac could not compile {source}").into());
        }
    }
    let mut command = Command::new("java");
    command.arg("-cp").arg(&classes).args(["Lateness", mode, &plan.size.tasks.to_string()]);
    command.args([plan.size.period, plan.warm_up, plan.measured].map(|time| time.as_nanos().to_string()));
    Ok(command)
}

fn again(plan: &Plan, name: &str) -> Outcome<Command> {
    let mut command = Command::new(env::current_exe()?);
    command.args(["--bench", "--inside", name, "--sizes", &plan.size.to_string()]);
    command.args(["--warm-up", &plan.warm_up.as_secs_f64().to_string()]);
    command.args(["--seconds", &plan.measured.as_secs_f64().to_string()]);
    Ok(command)
}
