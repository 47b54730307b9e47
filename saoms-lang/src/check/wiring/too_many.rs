//! References that have more targets than they take.

use super::Wires;
use crate::check::contracts::offer::{ReferenceId, parts};
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::Multiplicity;
use crate::source::{Location, Text};

/// Replicas that are named.
const SHOWN: usize = 3;

impl<'f> Wires<'f, '_> {
    /// Reports a reference that takes one target and has several, at these places: the same place if one text stands
    /// for several. `is_again` says that all lead to one service.
    pub(super) fn too_many(
        &self,
        (member, name): ReferenceId<'_>,
        places: &[Location],
        is_again: bool,
        multiplicity: Multiplicity,
        severity: Severity,
        report: &mut Report<'_>,
    ) {
        let &[first, second, ..] = places else { return };
        let message = format!(
            "reference {} of component {} allows one target, found {}",
            quoted(name),
            quoted(&self.fleet.members[member].component.name),
            places.len()
        );
        let one = Diagnostic::new(&codes::TOO_MANY_TARGETS, second, message)
            .severity(severity)
            .rule(if multiplicity.is_required() { "ASM50040" } else { "ASM50039" });
        if first == second {
            let group = self.group_at((member, name), second);
            return report.push(match group {
                Some((text, members)) => self.one_of(text, members, member, one),
                None => one.help("it leads to several: keep one of them"),
            });
        }
        let one = one.label(first, "the first");
        report.push(match self.wire_instead((member, name), first, second) {
            _ if is_again => one.help("they lead to one service: keep one of them"),
            true => {
                one.help("keep one of them, or write `replace=\"true\"` at the wire, which then replaces the `target`")
            }
            false => one.help("keep one of them"),
        });
    }

    /// With the replicas one of which is probably meant by a text that names all of them.
    fn one_of(&self, text: &Text, members: &[usize], own: usize, one: Diagnostic) -> Diagnostic {
        let (component, _) = parts(text);
        let rest = &text[component.len()..];
        let own = &self.fleet.members[own];
        let one = one.help(format!("{} names all replicas, but the reference takes one target", quoted(component)));
        let scope = self.fleet.members[members[0]].scope;
        let mine = own.instance.map(|instance| component.replacen('*', &instance.index.to_string(), 1));
        let is_there = |name: &String| self.fleet.find(scope, name).is_some_and(|one| members.contains(&one));
        if mine.as_ref().is_some_and(is_there) {
            let meant = format!("{}{rest}", component.replacen('*', "${index}", 1));
            return one.replace(text, text.location, &meant);
        }
        let names = members.iter().take(SHOWN).map(|member| &self.fleet.members[*member].component.name);
        let names = names.map(|name| format!("{name}{rest}"));
        names.fold(one, |one, meant| one.replace(text, text.location, &meant))
    }

    /// The text of a group of replicas at this place among what a reference is given, here or around, and the replicas.
    fn group_at(&self, place: ReferenceId<'_>, at: Location) -> Option<(&'f Text, &[usize])> {
        let member = &self.fleet.members[place.0];
        let reference = member.component.reference(place.1);
        let targets = reference.into_iter().flat_map(|reference| &reference.targets);
        let own = targets.map(|text| (text, member.scope));
        let wires = self.wires_from(place).iter().map(|wire| (wire.target, wire.scope));
        let mut all = own.chain(wires).filter(|(text, _)| text.location == at);
        let found = all.find_map(|(text, scope)| Some((text, self.fleet.group(scope, parts(text).0)?)));
        let outer = || self.promoted.to.get(&place).into_iter().flatten();
        found.or_else(|| outer().find_map(|outer| self.group_at(*outer, at)))
    }

    /// True if the second of two targets is that of the only wire of a reference, which could count in place of the
    /// first.
    fn wire_instead(&self, place: ReferenceId<'_>, first: Location, second: Location) -> bool {
        let [wire] = self.wires_from(place) else { return false };
        let is_1_1 = self.fleet.members[place.0].composite.version.is_1_1();
        is_1_1 && !wire.is_replacing && wire.target.location == second && first != second
    }
}
