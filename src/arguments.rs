//! Options that several subcommands have.

use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{Args, ValueEnum};
use saoms_api::host::{meant_duration, parse_duration, shorten};

use crate::command::is_option;

/// Options that describe a fleet.
#[derive(Clone, Debug, Args)]
pub(crate) struct FleetArguments {
    /// Composite files, `-` for standard input; several files form one fleet. A folder is a contribution: `check`
    /// checks all of it; the other commands use the composite that its `sca-contribution.xml` lists as deployable, or
    /// the only one that no other composite uses
    #[arg(required = true, value_name = "FILE", value_parser = PathBufValueParser::new().try_map(file))]
    pub(crate) files: Vec<PathBuf>,

    /// Set the value of a composite property; may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    pub(crate) settings: Vec<String>,

    /// Set the severity of a code to `allow`, `note`, `warning` or `error`, unless a composite sets it; may be repeated
    #[arg(long = "severity", value_name = "CODE=LEVEL[:REASON]")]
    pub(crate) severities: Vec<String>,

    #[command(flatten)]
    pub(crate) plugins: PluginArguments,

    /// Also read files outside the folders and contributions of the composites; without it, a composite from another
    /// person cannot read your files
    #[arg(long)]
    pub(crate) allow_outside: bool,

    /// Refuse larger files
    #[arg(long, value_name = "SIZE", default_value = "256MB", value_parser = parse_size)]
    pub(crate) max_size: u64,
}

/// Options that name plugins: the classes that are not linked into this program.
#[derive(Clone, Debug, Args)]
pub(crate) struct PluginArguments {
    /// Use the classes of this plugin, or of all plugins in this folder; may be repeated
    #[arg(long = "plugin", value_name = "PATH")]
    pub(crate) plugins: Vec<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    Human,
    Json,
}

/// A size in bytes, or with one of the units kB, MB and GB.
pub(crate) fn parse_size(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let scale = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "" | "b" => Some(1),
        "k" | "kb" => Some(1_000),
        "m" | "mb" => Some(1_000_000),
        "g" | "gb" => Some(1_000_000_000),
        _ => None,
    };
    let size = digits.trim().parse::<u64>().ok().zip(scale).and_then(|(number, scale)| number.checked_mul(scale));
    size.ok_or_else(|| "expected a number of bytes, or a number with one of the units kB, MB, GB".to_owned())
}

/// A duration; the message of a wrong one quotes a line of it at most.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    parse_duration(text).map_err(|mut message| {
        if let Some(meant) = meant_duration(text) {
            message.push_str(&format!("; write `{meant}`"));
        }
        shorten(&mut message);
        message
    })
}

/// A file; an option whose dashes are missing, or are those of a printed page, is refused.
fn file(path: PathBuf) -> Result<PathBuf, String> {
    let name = path.to_str().map(|text| text.trim_start_matches(['-', '–', '—', '−']).to_owned());
    match name.filter(|name| is_option(name) && !path.exists()) {
        Some(name) => Err(format!("there is no such file; write `--{name}` for the option")),
        None => match path.to_str().filter(|_| !path.exists()).and_then(as_option) {
            Some(option) => Err(format!("there is no such file; write `{option}`")),
            None => Ok(path),
        },
    }
}

/// The option that a word among the files lacks: of a value of a property, or of a picture to write.
fn as_option(word: &str) -> Option<String> {
    let is_name = |name: &str| name.starts_with(char::is_alphabetic) && name.chars().all(char::is_alphanumeric);
    if word.split_once('=').is_some_and(|(name, _)| is_name(name)) && is_option("set") {
        return Some(format!("--set {word}"));
    }
    let is_picture = [".svg", ".dot", ".mmd"].iter().any(|ending| word.ends_with(ending));
    (is_picture && is_option("output")).then(|| format!("--output {word}"))
}

/// A setting, which has to be one argument.
fn setting(text: &str) -> Result<String, String> {
    setting_of("--set", text)
}

/// The same for another option.
pub(crate) fn setting_of(option: &str, text: &str) -> Result<String, String> {
    match text.contains('=') {
        true => Ok(text.to_owned()),
        false => {
            let mut message = format!("found no `=`: write `{option} {text}=VALUE`, without blanks around `=`");
            shorten(&mut message);
            Err(message)
        }
    }
}
