//! The replay of one component: what it does today with what it got then.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;
use saoms_api::host::one_line;
use saoms_api::rule::nearest;
use saoms_core::replay::{Difference, Replay, ReplayCounts, Side};
use saoms_core::tape::StepKind;
use saoms_lang::assembly::ComponentSpec;
use saoms_lang::diagnostic::Severity;
use saoms_lang::registry::Registry;
use saoms_recording::Part;
use serde_json::{Value, json};

use crate::Exit;
use crate::arguments::{FleetArguments, Format, PluginArguments};
use crate::command::record::{open, unreadable};
use crate::fleet::{DiagnosticReport, compiled};
use crate::output::{counted, displayed, eprint, eprint_coloured, print, print_json};
use crate::plugins::registry;

/// Options of `saoms replay` for a component.
#[derive(Clone, Debug, Args)]
pub(super) struct ComponentArguments {
    /// Run this component again, alone, and compare what it does: `saoms run --record FILE --record-component NAME` has
    /// recorded what it got and did
    #[arg(long, value_name = "NAME")]
    component: Option<String>,

    /// Give it the class, the values and the loops that it has in this composite, instead of those that it had; may be
    /// repeated
    #[arg(long = "composite", value_name = "FILE", requires = "component")]
    composites: Vec<PathBuf>,

    #[command(flatten)]
    plugins: PluginArguments,

    /// The format: for people, or a JSON object
    #[arg(long, value_enum, default_value_t = Format::Human, requires = "component")]
    format: Format,
}

/// Lines of a difference that are shown before and behind what differs.
const AROUND: usize = 3;

/// Replays a component, if one is named.
pub(super) fn replay(recordings: &[PathBuf], arguments: &ComponentArguments) -> Option<Exit> {
    let component = arguments.component.as_ref()?;
    Some(replayed(recordings, component, arguments).unwrap_or_else(|exit| exit))
}

fn replayed(recordings: &[PathBuf], component: &str, arguments: &ComponentArguments) -> Result<Exit, Exit> {
    let mut replay = match &arguments.composites[..] {
        [] => Replay::new(component, registry(&arguments.plugins)?),
        composites => {
            let (registry, spec) = in_composites(composites, component, &arguments.plugins)?;
            Replay::new(component, registry).with(spec)
        }
    };
    let mut first = None;
    for path in recordings {
        take(path, component, &mut replay, &mut first)?;
    }
    let counts = replay.counts();
    match arguments.format {
        Format::Json => print_json(&as_json(component, counts, first.as_ref())),
        Format::Human => print(&as_text(component, counts, first.as_ref())),
    }
    if first.is_none() {
        for end in &counts.ends {
            let (why, time) = (one_line(&end.why), end.time);
            eprint(&format!("warning: from {time} on nothing is replayed until the component starts anew: {why}\n"));
        }
    }
    Ok(match (counts.replayed, first) {
        (0, _) => Exit::WrongInput,
        (_, None) => Exit::Done,
        (_, Some(_)) => Exit::Failed,
    })
}

/// Takes the steps of a file.
fn take(path: &Path, component: &str, replay: &mut Replay, first: &mut Option<Difference>) -> Result<(), Exit> {
    let mut reader = open(path)?;
    let (mut others, mut is_there) = (BTreeSet::new(), false);
    while let Some(part) = reader.next_part().map_err(|error| unreadable(&error))? {
        let Part::Message(message) = part else { continue };
        match message.channel.taped_component() {
            Some(taped) if taped == component => {
                let Some(step) = message.step() else {
                    let path = displayed(path);
                    eprint(&format!("error: the tapes in `{path}` are of another version of saoms\n"));
                    return Err(Exit::WrongInput);
                };
                is_there = true;
                if let Some(difference) = replay.step(&step) {
                    first.get_or_insert(difference);
                }
            }
            Some(other) => drop(others.insert(other.to_owned())),
            None => {}
        }
    }
    if let Some(why) = reader.cut() {
        let (path, why) = (displayed(path), one_line(why));
        eprint(&format!("warning: `{path}` ends in the middle: {why}; what stands before is complete\n"));
    }
    if is_there {
        return Ok(());
    }
    let (path, name) = (displayed(path), one_line(component));
    let help = match nearest(component, others.iter().map(String::as_str)) {
        Some(near) => format!("did you mean `{near}`?"),
        None if others.is_empty() => format!("run again with `--record FILE --record-component {name}`"),
        None => {
            let others: Vec<String> = others.iter().map(|one| format!("`{}`", one_line(one))).collect();
            format!("it has those of {}", others.join(", "))
        }
    };
    eprint(&format!("error: `{path}` has no tape of `{name}`\n  = help: {help}\n"));
    Err(Exit::WrongInput)
}

/// The component in composites, with the classes of these. What is wrong with them is reported.
fn in_composites(
    composites: &[PathBuf],
    component: &str,
    plugins: &PluginArguments,
) -> Result<(Registry, ComponentSpec), Exit> {
    let fleet = FleetArguments {
        files: composites.to_vec(),
        settings: Vec::new(),
        severities: Vec::new(),
        plugins: plugins.clone(),
        allow_outside: false,
        max_size: 256_000_000,
    };
    let compilation = compiled(&fleet, |project, classes| project.to_start().compile(classes))?;
    let shown = DiagnosticReport::from(&compilation);
    eprint_coloured(&shown.human(Severity::Error));
    let Some(assembly) = &compilation.output else {
        eprint(&format!("\n{}: nothing to replay\n", counted(shown.count(Severity::Error), "error")));
        return Err(Exit::WrongInput);
    };
    let found = assembly.components.iter().find(|one| one.path == component);
    let Some(spec) = found else {
        let names = assembly.components.iter().map(|one| one.path.as_str());
        let near = nearest(component, names).map(|near| format!("; did you mean `{near}`?")).unwrap_or_default();
        eprint(&format!("error: the composite has no component `{}`{near}\n", one_line(component)));
        return Err(Exit::WrongInput);
    };
    Ok((compilation.registry.clone(), spec.clone()))
}

fn kind_name(kind: StepKind) -> &'static str {
    match kind {
        StepKind::Start => "start",
        StepKind::Execute => "execution",
        StepKind::React => "reaction",
        StepKind::Serve => "call",
        StepKind::Update => "update",
        StepKind::Shutdown => "shutdown",
        StepKind::Replaced => "replacement",
    }
}

/// What is done in the step, as `in its execution 12`.
fn place(difference: &Difference) -> String {
    let execution = difference.execution;
    match difference.kind {
        StepKind::Execute => format!("in its execution {execution}"),
        StepKind::React => format!("in a reaction before its execution {execution}"),
        StepKind::Serve => format!("in a call before its execution {execution}"),
        StepKind::Update => "when it takes new values".to_owned(),
        kind => format!("in its {}", kind_name(kind)),
    }
}

fn as_text(component: &str, counts: &ReplayCounts, first: Option<&Difference>) -> String {
    let name = one_line(component);
    let steps = counted(usize::try_from(counts.replayed).unwrap_or(usize::MAX), "step");
    let all = match counts.steps - counts.replayed {
        0 => steps,
        left_out => format!("{steps}, {left_out} left out,"),
    };
    let Some(first) = first else {
        return format!("{name}: {all} up to {}: it does what it did then\n", counts.time);
    };
    let mut text = format!("{name} does something else at {}, {} (`-` then, `+` now):\n", first.time, place(first));
    let differs = |(side, _): &(Side, String)| *side != Side::Both;
    let from = first.lines.iter().position(differs).unwrap_or(0).saturating_sub(AROUND);
    let to = first.lines.iter().rposition(differs).map_or(first.lines.len(), |last| last + 1 + AROUND);
    if from > 0 {
        text.push_str("    ...\n");
    }
    for (side, line) in first.lines.iter().take(to).skip(from) {
        let mark = match side {
            Side::Both => ' ',
            Side::Then => '-',
            Side::Now => '+',
        };
        text.push_str(&format!("  {mark} {}\n", one_line(line)));
    }
    if to < first.lines.len() {
        text.push_str("    ...\n");
    }
    let differing = counts.differing;
    text.push_str(&format!("{name}: {all} up to {}: {differing} differ\n", counts.time));
    text
}

fn as_json(component: &str, counts: &ReplayCounts, first: Option<&Difference>) -> Value {
    let line = |(side, text): &(Side, String)| {
        let side = match side {
            Side::Both => "both",
            Side::Then => "then",
            Side::Now => "now",
        };
        json!({ "when": side, "what": text })
    };
    let first = first.map(|first| {
        json!({
            "time_s": first.time.as_nanos() as f64 / 1e9,
            "execution": first.execution,
            "step": kind_name(first.kind),
            "lines": first.lines.iter().map(line).collect::<Vec<Value>>(),
        })
    });
    let ends = counts.ends.iter().map(|end| json!({ "time_s": end.time.as_nanos() as f64 / 1e9, "why": end.why }));
    json!({
        "component": component,
        "time_s": counts.time.as_nanos() as f64 / 1e9,
        "steps": counts.steps,
        "replayed": counts.replayed,
        "differing": counts.differing,
        "first": first,
        "ends": ends.collect::<Vec<Value>>(),
    })
}
