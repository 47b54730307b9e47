//! Placement: which node runs which component, and what has to hold between components of different nodes.

pub(crate) mod fault_nodes;
mod topics;
mod wires;

use std::collections::BTreeSet;

use crate::check::component::ComponentCheck;
use crate::check::fleet::{Fleet, Member};
use crate::check::options::Options;
use crate::check::report::Report;
use crate::check::unfolding::members::not_a_node;
use crate::check::web::Web;
use crate::check::wiring::Wiring;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::{Location, Text};
use crate::syntax::is_local_name;

/// Checks the nodes of a fleet.
pub(crate) fn check(
    fleet: &Fleet<'_>,
    (checks, wiring, web): (&[ComponentCheck<'_>], &Wiring, &Web),
    options: &Options,
    report: &mut Report<'_>,
) {
    let defaults = fleet.contribution.asked_for().iter().filter_map(|one| one.run.default_node.as_ref());
    let wrong: Vec<&Text> = defaults.filter(|name| !is_local_name(name)).collect();
    wrong.iter().for_each(|name| report.push(not_a_node(name, name.location)));
    let nodes: BTreeSet<&str> =
        running(fleet).map(|member| member.node.as_str()).filter(|one| !one.is_empty()).collect();
    wanted(&nodes, options, report);
    wires::unused_deadlines(fleet, wiring, web, report);
    if nodes.is_empty() {
        return;
    }
    if wrong.is_empty() {
        nowhere(fleet, report);
    }
    wires::check(fleet, checks, wiring, report);
    topics::check(fleet, checks, report);
}

/// The components that are there in a run.
fn running<'f, 'a>(fleet: &'f Fleet<'a>) -> impl Iterator<Item = &'f Member<'a>> {
    fleet.members.iter().filter(|member| member.runs() && !member.is_absent && !member.is_partial)
}

/// Where the node of a component is written: at it, or at a component around it.
fn written(fleet: &Fleet<'_>, member: &Member<'_>) -> Option<Location> {
    let around = |member: &&Member<'_>| Some(&fleet.members[fleet.scopes[member.scope].owner?]);
    let mut all = std::iter::successors(Some(member), around);
    all.find_map(|one| one.component.node.as_ref()).map(|node| node.location)
}

/// The same, or else the component itself.
fn place(fleet: &Fleet<'_>, member: &Member<'_>) -> Location {
    written(fleet, member).unwrap_or(member.component.name.location)
}

/// Reports a node that is to run and that the fleet does not have.
fn wanted(nodes: &BTreeSet<&str>, options: &Options, report: &mut Report<'_>) {
    let Some(wanted) = options.node.as_ref().filter(|node| !nodes.contains(node.as_str())) else { return };
    let message = match nodes.is_empty() {
        false => format!("the fleet has no node {}", quoted(wanted)),
        true => "the fleet has no nodes: no component names one".to_owned(),
    };
    let known = ("its nodes are", nodes.iter().copied());
    let one = report.unknown(&codes::UNKNOWN_NODE, wanted.location, message, wanted, known);
    report.push(match nodes.is_empty() {
        false => one,
        true => one.help(format!(
            "write `saoms:node=\"{}\"` in the start tags of its components, or leave `--node` out",
            wanted.as_str()
        )),
    });
}

/// Reports components that are in no node although others are: no program would run them.
fn nowhere(fleet: &Fleet<'_>, report: &mut Report<'_>) {
    // Whose node has no name is told.
    let is_nowhere = |member: &&Member<'_>| member.node.is_empty() && written(fleet, member).is_none();
    let mut nowhere = running(fleet).filter(is_nowhere);
    let Some(first) = nowhere.next() else { return };
    let more = match nowhere.count() {
        0 => String::new(),
        1 => ", and so is another component".to_owned(),
        more => format!(", and so are {more} other components"),
    };
    let message = format!("{} is in no node{more}: no program would run it", quoted(first.path()));
    let mut one = Diagnostic::new(&codes::NODE_MISSING, first.component.name.location, message);
    if let Some(other) = running(fleet).find(|member| !member.node.is_empty()) {
        one = one.label(place(fleet, other), "others are in a node");
    }
    report.push(one.help(
        "give it a `saoms:node`, or name the node of all others in the start tag of the outermost composite: \
         `saoms:defaultNode=\"...\"`",
    ));
}
