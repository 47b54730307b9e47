//! Entries that no loop serves any more, because a loop that did was replaced by one that declares less.

use super::Planned;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::registry::LoopDeclaration;

/// Warns of loops that declare to effect or to sense less than those that they replace, where no other loop does it.
pub(super) fn check(class: &ClassIndex<'_>, loops: &[Planned<'_>], report: &mut Report<'_>) {
    let present: Vec<&LoopDeclaration> = loops.iter().filter_map(|one| Some(one.class?.declaration())).collect();
    let knowledge = class.class.declaration().knowledge.iter();
    let effectors: Vec<&String> =
        knowledge.flat_map(|all| &all.entries).filter(|entry| entry.effector).map(|entry| &entry.name).collect();
    let is_effected = |entry: &String| present.iter().any(|one| one.effects.contains(entry));
    let is_sensed = |entry: &String| present.iter().any(|one| one.senses.contains(entry));
    // Who senses what the component itself measures is missed by nobody.
    let is_said = |entry: &String| effectors.contains(&entry) || is_effected(entry);
    for one in loops {
        let (Some(old), Some(new), Some(element)) = (one.replaced, one.class, one.element) else { continue };
        let is_own = |entry: &&String| old.declaration().entries.iter().any(|own| own.name == **entry);
        let (senses, effects) = (&old.declaration().senses, &old.declaration().effects);
        let effects = effects.iter().filter(|entry| !is_effected(entry) && !is_own(entry));
        let senses = senses.iter().filter(|entry| !is_sensed(entry) && is_said(entry) && !is_own(entry));
        let place = element.class.as_ref().map_or(element.name.location, |class| class.location);
        for (verb, entries, results) in [
            ("effects", effects.collect::<Vec<_>>(), ["stays as it is", "stay as they are"]),
            ("senses", senses.collect(), ["has no effect", "have no effect"]),
        ] {
            if entries.is_empty() {
                continue;
            }
            let names = list(entries.iter().map(|entry| entry.as_str()));
            let (old, new) = (quoted(old.name()), quoted(new.name()));
            let message = format!("no loop {verb} {names} any more: {new} replaces {old}, which does");
            let diagnostic = Diagnostic::new(&codes::LOOP_UNSERVED, place, message);
            let (what, result, it) = match entries.len() {
                1 => ("the entry", results[0], "it"),
                _ => ("these entries", results[1], "them"),
            };
            report.push(diagnostic.help(format!(
                "{what} {result}; let {new} serve {it} and declare `{verb}(...)`, or add a loop that does"
            )));
        }
    }
}
