//! `saoms plan` and `saoms apply`: a running fleet becomes that of other files.

use std::fmt::Write;
use std::io::{self, IsTerminal};
use std::path::Path;
use std::time::Duration;

use clap::Args;
use saoms_api::host::one_line;
use saoms_control::ChangeRequest;
use saoms_lang::project::INPUT;
use serde_json::{Value, json};

use super::emergency::user;
use super::fleet::RunningFleetArguments;
use crate::Exit;
use crate::arguments::{FleetArguments, Format, duration};
use crate::command::signals::at_first_signal;
use crate::output::{eprint, eprint_coloured, eprint_json, print, print_json};

/// Time that the program of the fleet may take for a plan.
const PATIENCE: Duration = Duration::from_secs(120);

const PLAN_CODES: &str = "\
Exit codes:
  0  nothing would change
  1  standard output could not be written
  2  an error in a composite, a value or the command line; a file cannot be read, or a plugin cannot be used; the change
     cannot be made while the fleet runs; no fleet runs, or it is not clear which one is meant
  3  the fleet would change";

/// Show what would change if a running fleet became that of these composites
#[derive(Debug, Args)]
#[command(after_help = PLAN_CODES)]
pub(crate) struct PlanArguments {
    #[command(flatten)]
    composites: FleetArguments,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

const APPLY_CODES: &str = "\
Exit codes:
  0  the fleet is that of the composites now, or was before
  1  a component could not start, take its values or end: the fleet is as it was; or standard output could not be written
  2  an error in a composite, a value or the command line; a file cannot be read, or a plugin cannot be used; the change
     cannot be made while the fleet runs, or loses a state without `--allow-loss`; no fleet runs, or it is not clear
     which one is meant: the fleet is as it was
  130  ended by Ctrl-C, SIGTERM or SIGHUP: the fleet takes the change back, unless it has made it already";

/// Change a running fleet to that of these composites; what is the same goes on untouched
#[derive(Debug, Args)]
#[command(after_help = APPLY_CODES)]
pub(crate) struct ApplyArguments {
    #[command(flatten)]
    composites: FleetArguments,

    /// Also replace components whose state is lost, because their class saves none
    #[arg(long)]
    allow_loss: bool,

    /// The time of the run for which components that leave may finish what they have begun; then they end all the same,
    /// and others take over what they hand over
    #[arg(long, value_name = "DURATION", default_value = "60s", allow_hyphen_values = true, value_parser = duration)]
    wait: Duration,

    #[command(flatten)]
    fleet: RunningFleetArguments,
}

pub(crate) fn plan(arguments: &PlanArguments) -> Exit {
    let PlanArguments { composites, fleet } = arguments;
    match asked(fleet, composites, "/v1/plan", PATIENCE, |_| {}) {
        Ok(answer) => show(fleet, &answer),
        Err(exit) => exit,
    }
}

pub(crate) fn apply(arguments: &ApplyArguments) -> Exit {
    let ApplyArguments { composites, allow_loss, wait, fleet } = arguments;
    take_back_at_signals(fleet.format);
    // How long those that leave need in the time of the run, nobody knows here: its speed may be any.
    let answer = asked(fleet, composites, "/v1/apply", Duration::MAX, |request| {
        request.allow_loss = *allow_loss;
        request.by = user();
        request.wait_ms = Some(u64::try_from(wait.as_millis()).unwrap_or(u64::MAX));
    });
    match answer {
        Ok(answer) => show(fleet, &answer),
        Err(exit) => exit,
    }
}

/// Says at the first signal what becomes of the change, and ends: the fleet takes a change back when its client hangs
/// up.
fn take_back_at_signals(format: Format) {
    let handled = at_first_signal(move || {
        let message = "interrupted: the fleet takes the change back unless it has made it already, which `saoms plan` \
                       shows";
        match format {
            Format::Human => eprint(&format!("error: {message}\n")),
            Format::Json => eprint_json(&json!({"error": message})),
        }
    });
    if let Err(error) = handled {
        eprint(&format!("warning: a signal will end the command without a word of the change: {error}\n"));
    }
}

/// The answer of the fleet about these files.
fn asked(
    fleet: &RunningFleetArguments,
    composites: &FleetArguments,
    path: &str,
    patience: Duration,
    more: impl FnOnce(&mut ChangeRequest),
) -> Result<Value, Exit> {
    let FleetArguments { files, settings, severities, plugins, allow_outside, max_size } = composites;
    if files.iter().any(|file| file == Path::new(INPUT)) {
        let message = "the program of the fleet reads the files, which standard input of this command cannot be";
        return Err(fleet.refuse(message, Exit::WrongInput));
    }
    let folder = std::env::current_dir()
        .map_err(|error| fleet.refuse(&format!("the current folder cannot be found: {error}"), Exit::WrongInput))?;
    let mut request = ChangeRequest {
        folder,
        files: files.clone(),
        set: settings.clone(),
        severities: severities.clone(),
        plugins: plugins.plugins.clone(),
        allow_outside: *allow_outside,
        max_size: Some(*max_size),
        coloured: fleet.format == Format::Human && io::stderr().is_terminal(),
        allow_loss: false,
        wait_ms: None,
        by: None,
    };
    more(&mut request);
    let response = fleet.request_within(patience, "POST", path, &json!(request).to_string())?;
    response.json().map_err(|error| fleet.refuse(&error.to_string(), Exit::WrongInput))
}

/// Shows an answer, and gives the exit code that follows from it.
fn show(fleet: &RunningFleetArguments, answer: &Value) -> Exit {
    let plan = &answer["plan"];
    let failure = &answer["failure"];
    let refusals: Vec<String> = items(plan, "refused").map(refusal).collect();
    let uncommitted = answer["uncommitted"].as_str();
    match fleet.format {
        Format::Json => {
            let mut answer = answer.clone();
            // The diagnostics say it.
            answer.as_object_mut().map(|all| all.remove("text"));
            print_json(&answer);
        }
        Format::Human => {
            eprint_coloured(answer["text"].as_str().unwrap_or_default());
            texts(&answer["notes"]).for_each(|note| eprint(&format!("note: {}\n", one_line(note))));
            if !plan.is_null() {
                print(&words(plan, &answer["applied"]));
            }
            match failure["error"].as_str() {
                Some(_) if failure["refused"] == true && !refusals.is_empty() => {
                    eprint(&format!("{}{}", refusals.concat(), help(plan, failure)))
                }
                Some(error) => eprint(&format!("error: {}\n{}", one_line(error), help(plan, failure))),
                None if let Some(why) = uncommitted => {
                    eprint(&format!("error: the fleet has changed: {}\n", one_line(why)));
                }
                None => eprint(&refusals.concat()),
            }
        }
    }
    match (&answer["applied"], failure["refused"].as_bool()) {
        _ if uncommitted.is_some() => Exit::Failed,
        (_, Some(true)) => Exit::WrongInput,
        (_, Some(false)) => Exit::Failed,
        (Value::Bool(_), None) => Exit::Done,
        (_, None) if !refusals.is_empty() => Exit::WrongInput,
        (_, None) if is_empty(plan) => Exit::Done,
        (_, None) => Exit::Changes,
    }
}

fn texts(list: &Value) -> impl Iterator<Item = &str> {
    list.as_array().into_iter().flatten().filter_map(Value::as_str)
}

fn items<'v>(plan: &'v Value, name: &str) -> impl Iterator<Item = &'v Value> {
    plan[name].as_array().into_iter().flatten()
}

fn is_empty(plan: &Value) -> bool {
    ["added", "removed", "replaced", "set"].iter().all(|name| items(plan, name).next().is_none())
}

/// A reason why a change cannot be made, and where the component is written that it is about.
fn refusal(one: &Value) -> String {
    let place = one["at"].as_str().map(|at| format!("  --> {}\n", one_line(at))).unwrap_or_default();
    format!("error: {}\n{place}", one_line(one["reason"].as_str().unwrap_or_default()))
}

/// What helps against a failure.
fn help(plan: &Value, failure: &Value) -> String {
    let loses = items(plan, "replaced").any(|one| one["state"] == "lost");
    match failure["refused"].as_bool() {
        Some(true) if plan.is_null() => "\nnothing has changed\n".to_owned(),
        Some(true) if loses && items(plan, "refused").next().is_none() => {
            "  = help: allow that with `--allow-loss`\n\nnothing has changed\n".to_owned()
        }
        _ => "\nthe fleet is as it was\n".to_owned(),
    }
}

/// A plan in words: a line for each thing that changes, then the numbers.
fn words(plan: &Value, applied: &Value) -> String {
    let mut text = String::new();
    let name = |one: &Value, key: &str| one_line(one[key].as_str().unwrap_or_default()).into_owned();
    let mut line = |words: String| {
        let _ = writeln!(text, "{words}");
    };
    for one in items(plan, "added") {
        line(format!("+ {} ({})", name(one, "component"), name(one, "class")));
    }
    for one in items(plan, "removed") {
        line(format!("- {} ({})", name(one, "component"), name(one, "class")));
    }
    for one in items(plan, "replaced") {
        let state = match one["state"].as_str() {
            Some("kept") => ": keeps its state",
            Some("lost") => ": loses its state",
            _ => "",
        };
        line(format!("~ {} is replaced{state}", name(one, "component")));
        for difference in items(one, "differences") {
            line(format!("    {}", change(difference)));
        }
    }
    for one in items(plan, "set") {
        line(format!("= {} {}", name(one, "component"), change(one)));
    }
    for (key, sign) in [
        ("wires_added", "+ wire"),
        ("wires_removed", "- wire"),
        ("topics_added", "+ topic"),
        ("topics_removed", "- topic"),
        ("consequences", "~"),
    ] {
        texts(&plan[key]).for_each(|one| line(format!("{sign} {}", one_line(one))));
    }
    let counts = [("added", "added"), ("removed", "removed"), ("replaced", "replaced")];
    let mut counts: Vec<(usize, &str)> = counts.iter().map(|(key, what)| (items(plan, key).count(), *what)).collect();
    let mut set: Vec<String> = items(plan, "set").map(|one| name(one, "component")).collect();
    set.dedup();
    counts.push((set.len(), "set"));
    let counts = counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
    let counts: Vec<String> = counts.collect();
    let done = if *applied == Value::Bool(true) && !counts.is_empty() { "done: " } else { "" };
    let counts = if counts.is_empty() { "nothing to do".to_owned() } else { counts.join(", ") };
    let _ = writeln!(text, "{done}{counts}");
    text
}

/// `period: 10ms -> 20ms`.
fn change(one: &Value) -> String {
    let what = one_line(one["what"].as_str().unwrap_or_default()).into_owned();
    let side = |key: &str| one[key].as_str().map_or_else(|| "(none)".to_owned(), |text| one_line(text).into_owned());
    if one["from"].is_null() && one["to"].is_null() {
        what
    } else {
        format!("{what}: {} -> {}", side("from"), side("to"))
    }
}
