//! Problems of fleets on grids, solved by ours and by a reference. See `benches/README.md`.

#![expect(clippy::print_stderr, reason = "the progress of a long measurement is for the person who waits for it")]

mod assignment;
mod instances;
mod ours;
mod pibt;
mod reference;

#[allow(dead_code, unused_imports, reason = "each benchmark uses a part")]
#[path = "../common/mod.rs"]
mod common;

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::{fs, thread};

use clap::Parser;
use saoms_testkit::ProblemFleet;
use serde::Serialize;

use assignment::Assignment;
use common::Outcome;
use instances::{Instance, Source, instances};
use pibt::Occupation;

/// Solves problems of fleets, and prints a table beside the numbers of a reference and of others.
#[derive(Parser)]
#[command(name = "cargo bench --bench problems --")]
struct Arguments {
    /// A problem of the League of Robot Runners, in place of the table.
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Number of steps of that problem.
    #[arg(long, default_value_t = 1000)]
    steps: u32,
    /// Write the composite of that problem to this file, and run nothing.
    #[arg(long, requires = "problem")]
    composite: Option<PathBuf>,
    /// Folder with the data of others.
    #[arg(long, default_value = "../shared/fleet")]
    data: PathBuf,
    /// Number of seeds of problems with random luggage.
    #[arg(long, default_value_t = 20)]
    seeds: u64,
    /// Rows whose names contain this text alone.
    #[arg(long, default_value = "")]
    only: String,
    /// Which robot does which task, in the reference.
    #[arg(long, value_enum, default_value_t = Assignment::Hungarian)]
    assignment: Assignment,
    /// Which robot does which luggage in ours.
    #[arg(long, default_value = "optimal", value_parser = ["robots", "oldest", "optimal"])]
    ours: String,
    /// Without a zone: robots agree among themselves on who enters a block.
    #[arg(long)]
    safe: bool,
    /// Executions of each robot in a step.
    #[arg(long, default_value_t = 10)]
    executions: u32,
    /// Flag that Cargo passes to every benchmark.
    #[arg(long, hide = true)]
    bench: bool,
}

/// How a problem was solved.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct Solved {
    pub(crate) finished: usize,
    /// Step in which the last task was done.
    pub(crate) makespan: u32,
    /// Longest time from when a task was visible until a robot was on it, in steps.
    pub(crate) longest_wait: u32,
    pub(crate) collisions: u64,
}

/// A row of the table: one result for each seed.
#[derive(Serialize)]
struct Row {
    name: String,
    tasks: usize,
    ours: Vec<Solved>,
    following: Vec<Solved>,
    holding: Vec<Solved>,
}

impl Arguments {
    fn fleet(&self, steps: u32) -> ProblemFleet {
        let names = ["robots", "oldest", "optimal"];
        let assignment = names.into_iter().find(|name| *name == self.ours).unwrap_or(names[2]);
        ProblemFleet { executions: self.executions, steps, zone: !self.safe, assignment, ..ProblemFleet::default() }
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    if !arguments.bench {
        eprintln!("a benchmark is run with `cargo bench --bench problems`");
        return ExitCode::SUCCESS;
    }
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Outcome<()> {
    let rows = match &arguments.problem {
        Some(path) => {
            let problem = instances::read(path)?;
            if let Some(to) = &arguments.composite {
                return Ok(fs::write(to, problem.composite(&arguments.fleet(arguments.steps)))?);
            }
            let (name, source) = (path.display().to_string(), Source::File(path.clone()));
            vec![Instance { name, source, steps: arguments.steps, published: "-" }]
        }
        None => instances(&arguments.data, arguments.seeds),
    };
    let mut page = format!("Problems of fleets. {}.\n\n", common::description());
    writeln!(
        page,
        "| problem | unit | ours | longest wait | collisions | PIBT, both blocks held | ours / that | PIBT | published |"
    )?;
    writeln!(page, "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |")?;
    let mut all = Vec::new();
    for instance in rows.iter().filter(|one| one.name.contains(&arguments.only)) {
        eprintln!("{}", instance.name);
        let row = measure(instance, arguments)?;
        write_row(&mut page, instance, &row)?;
        all.push(row);
    }
    common::write("problems", &page, &all)
}

/// Solves a problem with each seed, the reference beside ours.
fn measure(instance: &Instance, arguments: &Arguments) -> Outcome<Row> {
    let assignment = &arguments.assignment;
    let Instance { name, source, steps, .. } = instance;
    let name = name.clone();
    let mut row = Row { name, tasks: 0, ours: Vec::new(), following: Vec::new(), holding: Vec::new() };
    for seed in 0..source.seeds() {
        let problem = source.problem(seed)?;
        row.tasks = problem.tasks.len();
        let reference = |occupation| reference::solve(&problem, (occupation, *assignment), *steps, seed);
        let (following, holding, ours) = thread::scope(|scope| {
            let both = scope.spawn(|| (reference(Occupation::Next), reference(Occupation::Both)));
            let ours = ours::solve(&problem, &arguments.fleet(*steps), seed);
            let both = both.join().map_err(|_| "the reference panicked")?;
            Outcome::Ok((both.0, both.1, ours?))
        })?;
        row.following.push(following);
        row.holding.push(holding);
        row.ours.push(ours);
    }
    Ok(row)
}

fn write_row(page: &mut String, instance: &Instance, row: &Row) -> Outcome<()> {
    let mean = |all: &[Solved], of: fn(&Solved) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    let is_finite = instance.source.is_finite();
    let figure = |all: &[Solved]| match is_finite {
        true => mean(all, |one| one.makespan.into()),
        false => mean(all, |one| one.finished as f64),
    };
    // Where not all was done, the time says nothing.
    let shown = |all: &[Solved]| {
        let undone = all.iter().filter(|one| is_finite && one.finished < row.tasks).count();
        match undone {
            0 => format!("{:.1}", figure(all)),
            _ => format!("{undone} of {} unfinished", all.len()),
        }
    };
    let ratio = figure(&row.ours) / figure(&row.holding);
    let ratio = if ratio.is_finite() { format!("{ratio:.3}") } else { "-".to_owned() };
    let unit = if is_finite { "steps to the last" } else { "done" };
    let longest = row.ours.iter().map(|one| one.longest_wait).max().unwrap_or(0);
    let collisions: u64 = row.ours.iter().map(|one| one.collisions).sum();
    writeln!(
        page,
        "| {} | {unit} | {} | {longest} | {collisions} | {} | {ratio} | {} | {} |",
        row.name,
        shown(&row.ours),
        shown(&row.holding),
        shown(&row.following),
        instance.published,
    )?;
    Ok(())
}
