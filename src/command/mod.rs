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
mod report;
mod run;
mod schema;
mod why;

use std::io::{self, Write};
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser, Subcommand};
use saoms_api::host::is_invisible;
use saoms_api::rule::nearest;

use crate::output::{eprint, has_failed, printed};
use crate::{Exit, guard};

const EXIT_CODES: &str = "\
Exit codes:
  0    done
  1    failed, a check found a difference, or the output could not be written
  2    the input is wrong: a composite, a value, the command line; nothing was started
  130  ended by Ctrl-C, SIGTERM or SIGHUP
The help of each command describes its own exit codes.";

/// Deploys a fleet of self-adaptive robots from composite files.
#[derive(Debug, Parser)]
#[command(name = "saoms", version, after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Run(Box<run::RunArguments>),
    Check(check::CheckArguments),
    Explain(explain::ExplainArguments),
    Expand(expand::ExpandArguments),
    Fmt(fmt::FmtArguments),
    Graph(graph::GraphArguments),
    Why(why::WhyArguments),
    Report(report::ReportArguments),
    Ps(control::PsArguments),
    Status(control::StatusArguments),
    Top(control::TopArguments),
    Alerts(control::AlertsArguments),
    Logs(control::LogsArguments),
    Send(control::SendArguments),
    Topic(control::TopicArguments),
    Start(control::StartArguments),
    Stop(control::StopArguments),
    Set(control::SetArguments),
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
        Command::Check(arguments) => check::check(&arguments),
        Command::Explain(arguments) => explain::explain(&arguments),
        Command::Expand(arguments) => expand::expand(&arguments),
        Command::Fmt(arguments) => fmt::fmt(&arguments),
        Command::Graph(arguments) => graph::graph(&arguments),
        Command::Why(arguments) => why::why(&arguments),
        Command::Report(arguments) => report::report(&arguments),
        Command::Ps(arguments) => control::ps(&arguments),
        Command::Status(arguments) => control::status(&arguments),
        Command::Top(arguments) => control::top(&arguments),
        Command::Alerts(arguments) => control::alerts(&arguments),
        Command::Logs(arguments) => control::logs(&arguments),
        Command::Send(arguments) => control::send(&arguments),
        Command::Topic(arguments) => control::topic(&arguments),
        Command::Start(arguments) => control::start(&arguments),
        Command::Stop(arguments) => control::stop(&arguments),
        Command::Set(arguments) => control::set(&arguments),
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
    let command = std::env::args().nth(1).unwrap_or_default();
    let all = Arguments::command();
    let own = all.find_subcommand(command);
    own.is_some_and(|own| own.get_arguments().any(|one| one.get_long() == Some(name)))
}

/// Help for a command that is written as an option.
fn as_command(option: &str) -> Option<String> {
    let name = option.strip_prefix("--").filter(|_| std::env::args().nth(1).as_deref() == Some(option))?;
    let all = Arguments::command();
    all.find_subcommand(name).map(|_| format!("did you mean the command `saoms {name}`?"))
}

/// The command that is meant by a misspelt one of `saoms help`, for which the parser proposes none.
fn meant_command(word: &str) -> Option<String> {
    let all = Arguments::command();
    nearest(word, all.get_subcommands().map(clap::Command::get_name)).map(str::to_owned)
}

/// Help for an option that only other commands have.
fn of_others(option: &str) -> Option<String> {
    let name = option.strip_prefix("--")?;
    let all = Arguments::command();
    let has = |one: &&clap::Command| one.get_arguments().any(|argument| argument.get_long() == Some(name));
    let named: Vec<String> =
        all.get_subcommands().filter(has).map(|one| format!("`saoms {}`", one.get_name())).collect();
    (!named.is_empty()).then(|| format!("this option belongs to {}", named.join(", ")))
}

/// Help for an option that is probably a property of the composite: of a command that sets such, unless it is nearly
/// one of its own.
fn as_setting(error: &clap::Error, option: &str) -> Option<String> {
    let is_name = |name: &&str| name.len() <= QUOTED && name.chars().all(char::is_alphanumeric);
    let name = option.strip_prefix("--").filter(is_name)?;
    let command = std::env::args().nth(1)?;
    let all = Arguments::command();
    let sets = all.find_subcommand(&command)?.get_arguments().any(|one| one.get_long() == Some("set"));
    let is_free = error.get(ContextKind::SuggestedArg).is_none();
    (sets && is_free).then(|| format!("a property of the composite is set with `--set {name}=...`"))
}

/// The option of `saoms run` that has another name in other programs.
fn meant_option(option: &str) -> Option<&'static str> {
    std::env::args().nth(1).filter(|command| command == "run")?;
    match option {
        "--time" | "--duration" | "--until" | "--timeout" | "--limit" => Some("--for"),
        "--simulate" | "--simulation" | "--sim" | "--fast" => Some("--virtual"),
        _ => None,
    }
}

/// Help for an option with one dash, of which the parser names the first letter alone.
fn with_one_dash(letter: &str) -> Option<String> {
    let mut words = std::env::args().skip(1);
    let word = words.find(|word| word.starts_with(letter) && !word.starts_with("--"))?;
    let name = word.strip_prefix('-')?.split('=').next().filter(|name| name.len() > 1)?;
    let all = Arguments::command();
    let mut options = all.get_subcommands().flat_map(|one| one.get_arguments());
    options.any(|one| one.get_long() == Some(name)).then(|| format!("write `--{name}`"))
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
        // Whoever names a composite alone wants to run it.
        if error.kind() == ErrorKind::InvalidSubcommand
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand)
            && Path::new(word).exists()
        {
            let tip = format!("to run a composite, write `saoms run {word}`");
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        if error.kind() == ErrorKind::UnknownArgument
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg)
            && ["-o", "--output"].contains(&word.as_str())
        {
            let tip = "this command writes to standard output: add `> FILE` to write to a file".to_owned();
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        if error.kind() == ErrorKind::UnknownArgument
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg)
            && let Some(own) = meant_option(word)
        {
            error.remove(ContextKind::Suggested);
            // It shows the option that is most like the word, not the one that is meant.
            error.remove(ContextKind::Usage);
            error.insert(ContextKind::SuggestedArg, ContextValue::String(own.to_owned()));
        }
        if error.kind() == ErrorKind::UnknownArgument
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg)
            && let Some(tip) = as_setting(&error, word)
        {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        if error.kind() == ErrorKind::UnknownArgument
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg)
            && let Some(tip) = of_others(word)
        {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        if error.kind() == ErrorKind::UnknownArgument
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg)
            && let Some(tip) = as_command(word)
        {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        if error.kind() == ErrorKind::InvalidSubcommand
            && error.get(ContextKind::SuggestedSubcommand).is_none()
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand)
            && let Some(meant) = meant_command(word)
        {
            error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(vec![meant]));
        }
        if error.kind() == ErrorKind::UnknownArgument
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg)
            && let Some(tip) = with_one_dash(word)
        {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        if error.kind() == ErrorKind::UnknownArgument
            && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg)
            && ["-v", "-V"].contains(&word.as_str())
            && std::env::args().any(|written| written == *word)
        {
            let tip = "`saoms --version` prints the version".to_owned();
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        if error.kind() == ErrorKind::ArgumentConflict {
            let tip = "one of them has no effect beside the other: leave one out".to_owned();
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
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
        // Help and version.
        printed(|_| error.print().and_then(|()| io::stdout().flush()));
        guard::exit(if has_failed() { Exit::Failed } else { Exit::Done } as i32)
    })
}
