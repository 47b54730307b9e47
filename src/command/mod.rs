//! The command line: one file or folder per subcommand, with its options and what it does.

mod check;
mod completions;
mod components;
mod control;
mod expand;
mod explain;
mod fmt;
mod graph;
pub(crate) mod lsp;
mod man;
mod new;
mod query;
mod record;
mod replay;
mod report;
mod run;
mod schema;
mod signals;
mod simulate;
mod tips;
mod version;
mod view;
mod why;

use std::io::{self, Write};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser, Subcommand};
use saoms_api::host::is_invisible;

use crate::output::{eprint, has_failed, printed};
use crate::{Exit, guard};

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    failed, a check found a difference, or the output could not be written
  2    the input is wrong: a composite, a value, the command line; nothing was started
  3    `saoms plan` has found changes
  130  ended by Ctrl-C, SIGTERM or SIGHUP
The help of each command describes its own exit codes.";

/// Deploys a fleet of self-adaptive robots from composite files.
#[derive(Debug, Parser)]
#[command(name = "saoms", version, long_version = version::BUILD, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Run(Box<run::RunArguments>),
    Simulate(Box<simulate::SimulateArguments>),
    Check(check::CheckArguments),
    Explain(explain::ExplainArguments),
    Expand(expand::ExpandArguments),
    Fmt(fmt::FmtArguments),
    Graph(graph::GraphArguments),
    Why(why::WhyArguments),
    Report(report::ReportArguments),
    Query(query::QueryArguments),
    Record(record::RecordArguments),
    View(view::ViewArguments),
    Replay(replay::ReplayArguments),
    Ps(control::PsArguments),
    Status(control::StatusArguments),
    Top(control::TopArguments),
    Alerts(control::AlertsArguments),
    Logs(control::LogsArguments),
    Journal(control::JournalArguments),
    Send(control::SendArguments),
    Topic(control::TopicArguments),
    Start(control::StartArguments),
    Stop(control::StopArguments),
    Set(control::SetArguments),
    Plan(control::PlanArguments),
    Apply(control::ApplyArguments),
    Call(control::CallArguments),
    Pause(control::PauseArguments),
    Resume(control::ResumeArguments),
    Step(control::StepArguments),
    Speed(control::SpeedArguments),
    Estop(control::EmergencyStopArguments),
    Release(control::ReleaseArguments),
    Down(control::DownArguments),
    New(new::NewArguments),
    Schema(schema::SchemaArguments),
    Lsp(lsp::LspArguments),
    Components(components::ComponentsArguments),
    Completions(completions::CompletionsArguments),
    Man(man::ManArguments),
}

/// Parses the command line and executes its subcommand.
pub(crate) fn execute() -> Exit {
    match parsed().command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Simulate(arguments) => simulate::simulate(&arguments),
        Command::Check(arguments) => check::check(&arguments),
        Command::Explain(arguments) => explain::explain(&arguments),
        Command::Expand(arguments) => expand::expand(&arguments),
        Command::Fmt(arguments) => fmt::fmt(&arguments),
        Command::Graph(arguments) => graph::graph(&arguments),
        Command::Why(arguments) => why::why(&arguments),
        Command::Report(arguments) => report::report(&arguments),
        Command::Query(arguments) => query::query(&arguments),
        Command::Record(arguments) => record::record(&arguments),
        Command::View(arguments) => view::view(&arguments),
        Command::Replay(arguments) => replay::replay(&arguments),
        Command::Ps(arguments) => control::ps(&arguments),
        Command::Status(arguments) => control::status(&arguments),
        Command::Top(arguments) => control::top(&arguments),
        Command::Alerts(arguments) => control::alerts(&arguments),
        Command::Logs(arguments) => control::logs(&arguments),
        Command::Journal(arguments) => control::journal(&arguments),
        Command::Send(arguments) => control::send(&arguments),
        Command::Topic(arguments) => control::topic(&arguments),
        Command::Start(arguments) => control::start(&arguments),
        Command::Stop(arguments) => control::stop(&arguments),
        Command::Set(arguments) => control::set(&arguments),
        Command::Plan(arguments) => control::plan(&arguments),
        Command::Apply(arguments) => control::apply(&arguments),
        Command::Call(arguments) => control::call(&arguments),
        Command::Pause(arguments) => control::pause(&arguments),
        Command::Resume(arguments) => control::resume(&arguments),
        Command::Step(arguments) => control::step(&arguments),
        Command::Speed(arguments) => control::speed(&arguments),
        Command::Estop(arguments) => control::estop(&arguments),
        Command::Release(arguments) => control::release(&arguments),
        Command::Down(arguments) => control::down(&arguments),
        Command::New(arguments) => new::new(&arguments),
        Command::Schema(arguments) => schema::schema(&arguments),
        Command::Lsp(arguments) => lsp::lsp(&arguments),
        Command::Components(arguments) => components::components(&arguments),
        Command::Completions(arguments) => completions::completions(&arguments, Arguments::command()),
        Command::Man(arguments) => man::man(&arguments, Arguments::command()),
    }
}

/// True if the command of the command line has an option of this name.
pub(crate) fn is_option(name: &str) -> bool {
    let all = Arguments::command();
    let own = all.find_subcommand(command_name());
    own.is_some_and(|own| own.get_arguments().any(|one| one.get_long() == Some(name)))
}

/// The first word of the command line.
pub(crate) fn command_name() -> String {
    std::env::args().nth(1).unwrap_or_default()
}

/// The characters that a message of the parser quotes at most.
const QUOTED: usize = 100;

/// Shortens what a message of the parser quotes of the command line.
fn quote_little(error: &mut clap::Error) {
    for kind in [ContextKind::InvalidValue, ContextKind::InvalidArg, ContextKind::InvalidSubcommand] {
        let Some(ContextValue::String(word)) = error.get(kind) else { continue };
        if let Some((end, _)) = word.char_indices().nth(QUOTED) {
            let short = format!("{}…", &word[..end]);
            error.insert(kind, ContextValue::String(short));
            // A tip repeats it.
            error.remove(ContextKind::Suggested);
        }
    }
}

/// The parsed command line. A wrong one is reported and ends the process.
fn parsed() -> Arguments {
    Arguments::try_parse().unwrap_or_else(|mut error| {
        tips::add(&mut error);
        quote_little(&mut error);
        if error.use_stderr() {
            let plain = error.render().to_string();
            if plain.contains(|one| one != '\n' && is_invisible(one)) {
                eprint(&plain);
                guard::exit(error.exit_code());
            }
            guard::ends_by_itself();
            error.exit();
        }
        // Help and version; `-V` is one line.
        let is_long = error.kind() == ErrorKind::DisplayVersion && error.to_string().lines().count() > 1;
        let libraries = if is_long { version::libraries() } else { String::new() };
        printed(|output| {
            error.print().and_then(|()| io::stdout().flush())?;
            output.write_all(libraries.as_bytes())
        });
        guard::exit(if has_failed() { Exit::Failed } else { Exit::Done } as i32)
    })
}
