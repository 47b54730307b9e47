//! Rule: a wire between nodes is one over which components can call.

use saoms_api::extension::RemoteProxy;
use saoms_api::host::format_duration;

use super::place;
use crate::check::component::ComponentCheck;
use crate::check::contracts::offer::Provider;
use crate::check::fleet::{Fleet, Member};
use crate::check::report::Report;
use crate::check::web::Web;
use crate::check::wiring::Wiring;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::registry::ReferenceDeclaration;

/// Reports wires between components of different nodes that cannot be called over.
pub(super) fn check(fleet: &Fleet<'_>, checks: &[ComponentCheck<'_>], wiring: &Wiring, report: &mut Report<'_>) {
    for (caller, references) in wiring.iter().enumerate() {
        let (member, Some(class)) = (&fleet.members[caller], fleet.class_of(caller)) else { continue };
        report.about(member);
        for (declared, targets) in class.references.iter().zip(references) {
            let is_apart = |provider: &&Provider| {
                let other = &fleet.members[provider.member];
                other.node != member.node && !other.node.is_empty() && !member.node.is_empty()
            };
            let mut apart = targets.iter().flatten().filter(is_apart);
            let Some((provider, (why, help))) =
                apart.find_map(|provider| Some((provider, refusal(fleet, checks, caller, declared, provider)?)))
            else {
                continue;
            };
            let other = &fleet.members[provider.member];
            let written = member.component.reference(&declared.name);
            let at = written.map_or(member.component.name.location, |one| one.name.location);
            let message = format!(
                "{} is in node {}, and its reference {} leads to {} in node {}: {why}",
                quoted(member.path()),
                quoted(&member.node),
                quoted(&declared.name),
                quoted(other.path()),
                quoted(&other.node)
            );
            let one = Diagnostic::new(&codes::WIRE_BETWEEN_NODES, at, message);
            report.push(one.label(place(fleet, other), "the node of its target").help(help));
        }
    }
    report.about_all();
}

/// Reports deadlines of references through which no call waits for another node.
pub(super) fn unused_deadlines(fleet: &Fleet<'_>, wiring: &Wiring, web: &Web, report: &mut Report<'_>) {
    for (caller, member) in fleet.members.iter().enumerate() {
        for written in &member.component.references {
            let Some(deadline) = &written.deadline else { continue };
            let Some(why) = no_wait(fleet, (wiring, web), caller, &written.name) else { continue };
            report.about(member);
            let message = format!("the deadline of {} has no effect: {why}", format_duration(deadline.value));
            let one = Diagnostic::new(&codes::CALL_DEADLINE_UNUSED, deadline.location, message);
            report.push(one.help(
                "remove it, or give it to the reference of the component that calls another node or a web server",
            ));
        }
    }
    report.about_all();
}

/// Why no call through a reference of a component waits for another node; `None` where one does, or where what is wrong
/// with the reference is told.
fn no_wait(fleet: &Fleet<'_>, (wiring, web): (&Wiring, &Web), caller: usize, reference: &str) -> Option<String> {
    let member = &fleet.members[caller];
    let Some(class) = fleet.class_of(caller) else {
        return (!member.runs()).then(|| "the component is a composite, and makes no calls itself".to_owned());
    };
    let place = class.references.iter().position(|one| one.name == reference)?;
    if web.targets.contains_key(&(caller, place)) {
        return None;
    }
    let (declared, targets) = (class.references[place], &wiring[caller][place]);
    let targets = targets.as_ref().filter(|targets| !targets.is_empty())?;
    if RemoteProxy::of(&declared.interface.name).is_some() {
        return Some(format!("calls of {} wait for no answer", quoted(&declared.interface.name)));
    }
    let is_here = |provider: &Provider| fleet.members[provider.member].node == member.node;
    let are_here = targets.iter().all(is_here);
    are_here.then(|| format!("the reference {} leads to no component of another node", quoted(reference)))
}

/// Why a component cannot call one of another node, and what to do.
fn refusal(
    fleet: &Fleet<'_>,
    checks: &[ComponentCheck<'_>],
    caller: usize,
    declared: &ReferenceDeclaration,
    provider: &Provider,
) -> Option<(String, String)> {
    let (class, other) = (fleet.class_of(caller)?, fleet.class_of(provider.member)?);
    let url = |member: usize| checks[member].task.as_ref().and_then(|task| task.url.as_deref());
    let (own, theirs) = (url(caller), url(provider.member));
    let together = || "put both into one node".to_owned();
    if other.services[provider.service].is_of_host() {
        return Some(("the tasks of other programs cannot be scheduled".to_owned(), together()));
    }
    if !class.class.declaration().apart && RemoteProxy::of(&declared.interface.name).is_none() {
        let name = quoted(class.class.name());
        return Some((
            format!("a call between programs waits for its answer, and class {name} is not `apart`"),
            "put both into one node, or call from a class that declares `apart`: components of different nodes also \
             exchange messages of topics"
                .to_owned(),
        ));
    }
    // What is wrong with its properties is told.
    if !checks[caller].is_sound() || !checks[provider.member].is_sound() {
        return None;
    }
    match (own, theirs) {
        (Some(own), Some(theirs)) if own != theirs => Some((
            format!("their `url` is {} and {}, which are two networks", quoted(own), quoted(theirs)),
            "give both the same text: a network is named by it".to_owned(),
        )),
        (None, _) => {
            let member: &Member<'_> = &fleet.members[caller];
            let address = theirs.map_or_else(
                || "the address of a message broker, such as `localhost:61616`".to_owned(),
                |url| format!("the value {}", quoted(url)),
            );
            Some(match checks[caller].task.is_some() {
                true => (
                    format!("{} has no `url`, over which it could call", quoted(member.path())),
                    format!("give it the property `url` with {address}"),
                ),
                false => ("a passive component has no `url`, over which it could call".to_owned(), together()),
            })
        }
        _ => None,
    }
}
