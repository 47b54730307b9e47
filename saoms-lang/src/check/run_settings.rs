//! What the outermost composites say of the run: where alerts are delivered, what a lost terminal or link leads to, and
//! which node is the default.
//!
//! What composites inside others say has no effect, so that a composite that somebody else wrote sends nothing and runs
//! no command where it is used.

use std::collections::HashSet;
use std::path::Path;

use crate::assembly::{AlertCommand, AlertUrl, RunPolicy};
use crate::check::fleet::Fleet;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::Composite;
use crate::source::{Location, Sources};

/// Reports settings that have no effect or contradict each other.
pub(crate) fn check(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    let outermost = fleet.contribution.asked_for();
    let mut seen: HashSet<_> = outermost.iter().map(Composite::file).collect();
    let inner = fleet.units.iter().flat_map(|unit| &unit.composites).filter(|one| seen.insert(one.file()));
    for composite in inner {
        let Some(first) = composite.run.written.first() else { continue };
        let (has, them) = if composite.run.written.len() == 1 { ("has", "it") } else { ("have", "them") };
        let names = list(composite.run.written.iter().map(|one| one.as_str()));
        let message = format!("{names} {has} no effect: {} is inside another composite here", quoted(&composite.name));
        let outer = list(outermost.iter().take(1).map(|one| one.name.as_str()));
        let one = Diagnostic::new(&codes::INNER_RUN_SETTING, first.location, message);
        report.push(one.help(format!("write {them} in the start tag of the outermost composite, {outer}")));
    }
    let mut differ = |what: &str, values: Vec<(&Composite, String, Location)>| {
        let Some(((first, value, place), others)) = values.split_first() else { return };
        let Some((other, _, at)) = others.iter().find(|(_, other, _)| other != value) else { return };
        let message = format!("{} and {} disagree on {what}", quoted(&other.name), quoted(&first.name));
        let one = Diagnostic::new(&codes::RUN_SETTINGS_DIFFER, *at, message).label(*place, "the other value");
        report.push(one.help("give both the same value, or set it in only one of them: they form one fleet"));
    };
    let all = || outermost.iter();
    let urls = all().filter_map(|one| {
        let url = one.run.alert_url.as_ref()?;
        Some((one, format!("{:?} {:?}", url.value, one.run.token()), url.location))
    });
    differ("the address of alerts, or its token", urls.collect());
    let commands = all().filter_map(|one| {
        let command = one.run.alert_command.as_ref()?;
        Some((one, command.value.to_string(), command.location))
    });
    differ("the command for alerts", commands.collect());
    let hangups =
        all().filter_map(|one| Some((one, one.run.hangup?.value.name().to_owned(), one.run.hangup?.location)));
    differ("the effect of a lost terminal", hangups.collect());
    let links =
        all().filter_map(|one| Some((one, one.run.lost_link?.value.name().to_owned(), one.run.lost_link?.location)));
    differ("the effect of a lost link", links.collect());
    let nodes =
        all().filter_map(|one| one.run.default_node.as_ref().map(|node| (one, node.to_string(), node.location)));
    differ("the default node", nodes.collect());
}

/// The settings of a fleet without errors.
pub(crate) fn policy(fleet: &Fleet<'_>, sources: &Sources) -> RunPolicy {
    let all = || fleet.contribution.asked_for().iter();
    let url = all().find_map(|one| {
        let address = one.run.alert_url.as_ref()?.value.clone();
        Some(AlertUrl { address, token_env: one.run.token().map(str::to_owned) })
    });
    let command = all().find_map(|one| {
        let path = Path::new(sources.get(one.file()).path());
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Some(AlertCommand { line: one.run.alert_command.as_ref()?.value.to_string(), folder })
    });
    let hangup = all().find_map(|one| one.run.hangup).map(|one| one.value);
    let lost_link = all().find_map(|one| one.run.lost_link).map(|one| one.value);
    RunPolicy { alert_url: url, alert_command: command, hangup: hangup.unwrap_or_default(), lost_link }
}
