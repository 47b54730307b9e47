//! Rules on the loops of a component together, reported at the exact places.

use std::path::Path;
use std::sync::Arc;

use super::Planned;
use crate::check::fleet::Member;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::registry::{LoopDeclaration, RegisteredLoop, Team, TeamFault};
use crate::source::Location;

/// Checks the loops of a component against each other; `false` where they do not fit.
pub(super) fn check(
    member: &Member<'_>,
    class: &ClassIndex<'_>,
    loops: &[Planned<'_>],
    report: &mut Report<'_>,
) -> bool {
    // What the class declares has been checked when it was registered.
    if member.component.loops.is_empty() {
        return true;
    }
    let declarations: Vec<&LoopDeclaration> = loops.iter().filter_map(|one| Some(one.class?.declaration())).collect();
    if declarations.len() < loops.len() {
        return false;
    }
    let team = Team::of(class.class.declaration(), declarations);
    let faults = team.faults();
    let diagnostics = TeamDiagnostics { member, class, loops, entries: team.entries() };
    for fault in &faults {
        report.push(diagnostics.diagnostic(fault));
    }
    let strangers = diagnostics.strangers();
    let fits = faults.is_empty() && strangers.is_empty();
    strangers.into_iter().for_each(|one| report.push(one));
    fits
}

struct TeamDiagnostics<'t, 'a> {
    member: &'t Member<'a>,
    class: &'t ClassIndex<'a>,
    loops: &'t [Planned<'a>],
    entries: Vec<&'t str>,
}

impl TeamDiagnostics<'_, '_> {
    /// The place of the loop in the composite: the class where it gives one, else the name.
    fn place(&self, at: usize) -> Option<Location> {
        let element = self.loops[at].element?;
        Some(element.class.as_ref().map_or(element.name.location, |class| class.location))
    }

    fn place_or_component(&self, at: usize) -> Location {
        self.place(at).unwrap_or(self.member.component.name.location)
    }

    /// Loops that work on the struct of the knowledge, where the class of the component comes from another library: its
    /// struct is another one, whatever its name. What the class itself has is built into its library.
    fn strangers(&self) -> Vec<Diagnostic> {
        let class = &self.class.class;
        let own = |name: &str| class.declaration().loops.all().any(|(_, list)| list.iter().any(|known| known == name));
        let is_stranger =
            |one: &Arc<RegisteredLoop>| one.declaration().direct && one.origin() != class.origin() && !own(one.name());
        let found = self.loops.iter().enumerate().filter(|(_, one)| one.class.is_some_and(is_stranger));
        found.map(|(at, _)| self.stranger(at)).collect()
    }

    fn stranger(&self, at: usize) -> Diagnostic {
        let (class, component) = (&self.class.class, quoted(&self.member.component.name));
        let origin = |path: Option<&Path>| match path.and_then(Path::file_name) {
            Some(file) => format!("the library {}", quoted(&file.to_string_lossy())),
            None => "the program".to_owned(),
        };
        let from = origin(self.loops[at].class.and_then(|one| one.origin()));
        let message = format!(
            "the loop {} of {from} needs the Rust struct of its knowledge, but that of component {component} is built into {}",
            self.name(at),
            origin(class.origin())
        );
        let one = Diagnostic::new(&codes::LOOP_KNOWLEDGE, self.place_or_component(at), message);
        one.help(
            "a loop for components of other libraries has `type Knowledge = dyn Knowledge`, and reaches entries by name",
        )
    }

    fn name(&self, at: usize) -> String {
        quoted(self.loops[at].name)
    }

    fn diagnostic(&self, fault: &TeamFault<'_>) -> Diagnostic {
        let component = quoted(&self.member.component.name);
        match *fault {
            TeamFault::Knowledge { at } => {
                let wanted = self.loops[at].class.and_then(|class| class.declaration().knowledge.as_deref());
                let known = self.class.class.declaration().knowledge.as_ref().map_or("", |known| &known.name);
                let (wanted, known) = (quoted(wanted.unwrap_or_default()), quoted(known));
                let message = format!(
                    "the loop {} works on the knowledge {wanted}, but component {component} has {known}",
                    self.name(at)
                );
                let one = Diagnostic::new(&codes::LOOP_KNOWLEDGE, self.place_or_component(at), message);
                one.help("it is made for components of another class")
            }
            TeamFault::UnknownEntry { at, entry, verb } => {
                let (name, wanted) = (self.name(at), quoted(entry));
                let message = format!("the loop {name} {verb} {wanted}, but component {component} has no such entry");
                let one = Diagnostic::new(&codes::UNKNOWN_ENTRY, self.place_or_component(at), message);
                one.help(match nearest(entry, self.entries.iter().copied()) {
                    Some(near) => {
                        format!("the nearest entry is {}: is the loop made for another component?", quoted(near))
                    }
                    None => format!("the entries are {}", list(self.entries.iter().copied())),
                })
            }
            TeamFault::EntryTaken { at, entry, by } => {
                let (name, entry) = (self.name(at), quoted(entry));
                let message = format!("the loop {name} adds the entry {entry}, which is there already");
                let one = Diagnostic::new(&codes::ENTRY_REPEATED, self.place_or_component(at), message);
                self.other(one, by, "adds it as well", "it")
            }
            TeamFault::Clash { at, entry, with } => self.clash(at, entry, with),
            TeamFault::Reference { at, reference, with } => {
                let (name, reference) = (self.name(at), quoted(reference));
                let message = format!("the loop {name} has the reference {reference} with another interface");
                let one = Diagnostic::new(&codes::LOOP_REFERENCE, self.place_or_component(at), message);
                self.other(one, with, "has it as well", "the reference")
            }
        }
    }

    /// Says which other loop has it, or that the class has.
    fn other(&self, one: Diagnostic, by: Option<usize>, what: &str, it: &str) -> Diagnostic {
        let class = quoted(self.class.class.name());
        match by.map(|by| (self.place(by), self.name(by))) {
            Some((Some(place), name)) => one.label(place, format!("{name} {what}")).help("keep one of them"),
            Some((None, name)) => one.help(format!("the loop {name} of class {class} {what}")),
            None => one.help(format!("class {class} declares {it}")),
        }
    }

    /// The fault is that of the loop which the composite brings: of two such loops, of the later one in the file.
    fn clash(&self, later: usize, entry: &str, earlier: usize) -> Diagnostic {
        let (at, with) = match (self.place(later), self.place(earlier)) {
            (Some(later_at), Some(earlier_at)) if later_at.span.start < earlier_at.span.start => (earlier, later),
            (None, Some(_)) => (earlier, later),
            _ => (later, earlier),
        };
        let (name, other) = (self.name(at), self.name(with));
        let message = format!("the loops {other} and {name} both effect {}", quoted(entry));
        let mut one = Diagnostic::new(&codes::EFFECTOR_CLASH, self.place_or_component(at), message)
            .at(format!("effects {}", quoted(entry)));
        one = match self.place(with) {
            Some(place) => one.label(place, format!("effects {} as well", quoted(entry))),
            None => one.help(format!("{other} is a loop of class {}", quoted(self.class.class.name()))),
        };
        let bare = self.loops[with].name;
        one.help(format!(
            "only one loop may change the effector {}: replace {other} with `name=\"{bare}\"`, or remove it with \
            `<saoms:loop name=\"{bare}\" remove=\"true\"/>`",
            quoted(entry)
        ))
    }
}
