//! Wires that lead back to where they came from.
//!
//! A call runs inside the caller's execution. A component that is called back by the one it is calling is busy and
//! cannot answer, so such a circle of wires is a fault of the composite.

use crate::check::contracts::offer::Provider;
use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::source::Location;

/// At most this many wires of one circle are shown.
const SHOWN: usize = 8;

/// The wires of a fleet along which components call each other.
#[derive(Default)]
pub(crate) struct CallCycles<'f> {
    wires: Vec<Wire<'f>>,
}

struct Wire<'f> {
    member: usize,
    reference: &'f str,
    to: usize,
    place: Location,
}

impl<'f> CallCycles<'f> {
    /// Adds a wire, unless no circle can go through it: what the host serves for a component does not disturb the
    /// component, and one without references calls none.
    pub(crate) fn add(&mut self, member: usize, reference: &'f str, to: Provider, place: Location, fleet: &Fleet<'_>) {
        let ends = fleet
            .class_of(to.member)
            .is_some_and(|class| class.references.is_empty() || class.services[to.service].is_of_host());
        if !ends {
            self.wires.push(Wire { member, reference, to: to.member, place });
        }
    }

    /// Reports every circle at the wire that closes it.
    pub(crate) fn check(&self, fleet: &Fleet<'_>, report: &mut Report<'_>) {
        let edges: Vec<(usize, usize)> = self.wires.iter().map(|wire| (wire.member, wire.to)).collect();
        cycles(fleet.members.len(), &edges, |circle| self.report(circle, fleet, report));
    }

    fn report(&self, circle: &[usize], fleet: &Fleet<'_>, report: &mut Report<'_>) {
        let name = |member: usize| quoted(fleet.members[member].path());
        let Some(last) = circle.last().map(|wire| &self.wires[*wire]) else { return };
        if report.skip(&codes::CALL_CYCLE, Severity::Error, last.place) {
            return;
        }
        if circle.len() == 1 {
            let message = format!("component {} is wired to itself: it would call while it is busy", name(last.member));
            let one = Diagnostic::new(&codes::CALL_CYCLE, last.place, message);
            return report.push(one.help("wire the reference to another component, or remove the target"));
        }
        let mut names: Vec<String> = circle.iter().take(SHOWN).map(|wire| name(self.wires[*wire].member)).collect();
        if circle.len() > SHOWN {
            names.push(format!("{} more", circle.len() - SHOWN));
        }
        names.push(name(last.to));
        let message = format!("components call each other in a cycle: {}", names.join(" -> "));
        let mut one = Diagnostic::new(&codes::CALL_CYCLE, last.place, message)
            .at(format!("{} calls {}", name(last.member), name(last.to)))
            .help("a call waits for its answer, and a component that waits cannot answer: remove one of the wires, or use a topic");
        for wire in circle[..circle.len() - 1].iter().take(SHOWN).map(|wire| &self.wires[*wire]) {
            let text = format!("{} calls {} through {}", name(wire.member), name(wire.to), quoted(wire.reference));
            one = one.label(wire.place, text);
        }
        report.push(one);
    }
}

/// Finds the cycles among so many nodes that have these edges, each from a node to another one.
///
/// A cycle is the places of its edges in the order of walking it; there is one for each edge that leads back to where a
/// walk in order of the nodes came from: without all those there is no cycle. Time and space are linear in the graph;
/// all cycles together can have as many edges as its square, so that each is only lent to `found`.
pub(crate) fn cycles(nodes: usize, edges: &[(usize, usize)], mut found: impl FnMut(&[usize])) {
    #[derive(Clone, Copy, PartialEq)]
    enum State {
        New,
        /// On the path, at this place.
        Open(usize),
        Done,
    }
    let mut leaving: Vec<Vec<usize>> = vec![Vec::new(); nodes];
    for (edge, (from, _)) in edges.iter().enumerate() {
        leaving[*from].push(edge);
    }
    let mut states = vec![State::New; nodes];
    // Nodes from the start of a walk, each with its next edge, and the edges between them.
    let mut path: Vec<(usize, usize)> = Vec::new();
    let mut walked: Vec<usize> = Vec::new();
    for start in 0..nodes {
        if states[start] != State::New {
            continue;
        }
        path.push((start, 0));
        states[start] = State::Open(0);
        while let Some((node, next)) = path.last_mut() {
            let Some(&edge) = leaving[*node].get(*next) else {
                states[*node] = State::Done;
                path.pop();
                walked.pop();
                continue;
            };
            let to = edges[edge].1;
            *next += 1;
            match states[to] {
                State::New => {
                    states[to] = State::Open(path.len());
                    path.push((to, 0));
                    walked.push(edge);
                }
                State::Open(place) => {
                    walked.push(edge);
                    found(&walked[place..]);
                    walked.pop();
                }
                State::Done => {}
            }
        }
    }
}
