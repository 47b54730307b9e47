//! Tips beside the errors of the parser of command lines: what is probably meant.

use std::path::Path;

use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use saoms_api::rule::nearest;

use super::{Arguments, QUOTED, command_name};

/// Adds tips to an error of the parser.
pub(super) fn add(error: &mut clap::Error) {
    match error.kind() {
        ErrorKind::InvalidSubcommand => of_command(error),
        ErrorKind::UnknownArgument => of_option(error),
        ErrorKind::MissingRequiredArgument => {
            if let Some(text) = taken_by_option() {
                tip(error, text);
            }
        }
        ErrorKind::ArgumentConflict => {
            tip(error, "one of them has no effect beside the other: leave one out".to_owned());
        }
        _ => {}
    }
}

fn tip(error: &mut clap::Error, text: String) {
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![text.into()]));
}

fn word(error: &clap::Error, kind: ContextKind) -> Option<String> {
    match error.get(kind) {
        Some(ContextValue::String(word)) => Some(word.clone()),
        _ => None,
    }
}

/// Tips for an unknown command.
fn of_command(error: &mut clap::Error) {
    let Some(word) = word(error, ContextKind::InvalidSubcommand) else { return };
    if word.len() > QUOTED {
        return;
    }
    if command_name() == "new" {
        // What the parser finds similar is no path.
        if error.get(ContextKind::SuggestedSubcommand).is_none() || word.contains('.') {
            error.remove(ContextKind::SuggestedSubcommand);
            tip(error, of_new(&word));
        }
    } else if Path::new(&word).exists() || word.ends_with(".composite") {
        // Whoever names a composite alone wants to run it.
        error.remove(ContextKind::SuggestedSubcommand);
        tip(error, format!("to run a composite, write `saoms run {word}`"));
    } else if let Some(meant) = other_name(&word) {
        error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(vec![meant.to_owned()]));
    } else if word == "version" {
        tip(error, "`saoms --version` prints the version".to_owned());
    } else if error.get(ContextKind::SuggestedSubcommand).is_none()
        && let Some(meant) = meant_command(&word)
    {
        error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(vec![meant]));
    }
}

/// Tips for an unknown option, the most exact one last.
fn of_option(error: &mut clap::Error) {
    let Some(word) = word(error, ContextKind::InvalidArg) else { return };
    if let Some(own) = meant_option(&word) {
        error.remove(ContextKind::Suggested);
        // It shows the option that is most like the word, not the one that is meant.
        error.remove(ContextKind::Usage);
        error.insert(ContextKind::SuggestedArg, ContextValue::String(own.to_owned()));
    } else if ["-o", "--output"].contains(&word.as_str()) {
        tip(error, "this command writes to standard output: add `> FILE` to write to a file".to_owned());
    }
    let is_version = ["-v", "-V"].contains(&word.as_str()) && std::env::args().any(|written| written == word);
    let version = is_version.then(|| "`saoms --version` prints the version".to_owned());
    let tips = [as_setting(error, &word), of_others(&word), as_command(&word), with_one_dash(&word), version];
    if let Some(text) = tips.into_iter().flatten().last() {
        tip(error, text);
    }
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
    let all = Arguments::command();
    let sets = all.find_subcommand(command_name())?.get_arguments().any(|one| one.get_long() == Some("set"));
    let is_free = error.get(ContextKind::SuggestedArg).is_none();
    (sets && is_free).then(|| format!("a property of the composite is set with `--set {name}=...`"))
}

/// The option that has another name in other programs.
fn meant_option(option: &str) -> Option<&'static str> {
    match (command_name().as_str(), option) {
        ("run", "--time" | "--duration" | "--until" | "--timeout" | "--limit") => Some("--for"),
        ("run", "--simulate" | "--simulation" | "--sim" | "--fast") => Some("--virtual"),
        ("run", "--out" | "--json") => Some("--report"),
        ("run", "--verbose" | "--debug") => Some("--log-level"),
        ("check", "--json" | "--sarif") => Some("--format"),
        ("check" | "run" | "expand", "--param" | "--property" | "--define" | "--arg") => Some("--set"),
        _ => None,
    }
}

/// The command that has another name in other programs.
fn other_name(word: &str) -> Option<&'static str> {
    match word {
        "validate" | "lint" | "verify" | "compile" | "build" => Some("check"),
        "sim" | "chaos" | "fuzz" => Some("simulate"),
        "launch" | "exec" | "up" | "play" => Some("run"),
        "format" => Some("fmt"),
        "init" | "create" | "generate" => Some("new"),
        "list" | "ls" => Some("ps"),
        "classes" | "plugins" => Some("components"),
        "draw" | "plot" => Some("graph"),
        "kill" | "shutdown" => Some("down"),
        _ => None,
    }
}

/// Help for `saoms new` without the kind of what is to be made.
fn of_new(word: &str) -> String {
    let path = match word {
        "fleet" | "project" | "simulation" | "." | ".." => "my-site",
        "component" | "loop" | "class" => {
            return format!("a {word} is made in a plugin: write `saoms new plugin my-{word}`");
        }
        word => word.strip_suffix(".composite").unwrap_or(word),
    };
    let composite = if word.ends_with(".composite") { word } else { "hall.composite" };
    format!(
        "say what to make: `saoms new site {path}` is a small fleet, `saoms new composite {composite}` a \
         single composite"
    )
}

/// Help where the composite was taken as the value of the option before it.
fn taken_by_option() -> Option<String> {
    let arguments: Vec<String> = std::env::args().skip(2).collect();
    let is_file = |word: &str| !word.starts_with('-') && (word.ends_with(".composite") || Path::new(word).exists());
    let pair =
        arguments.windows(2).find(|pair| pair[0].starts_with("--") && !pair[0].contains('=') && is_file(&pair[1]));
    let [option, file] = pair? else { return None };
    Some(format!("`{file}` was taken as the value of `{option}`: write that value, and the composite after it"))
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
