//! Teams: rules for loops that work together in one component.

use std::collections::HashMap;

use super::{ClassDeclaration, DeclaredEntry, LoopDeclaration};

/// The loops of a component, in their order, beside the class that they are to work in.
pub struct Team<'a> {
    class: &'a ClassDeclaration,
    loops: Vec<&'a LoopDeclaration>,
    entries: HashMap<&'a str, (&'a DeclaredEntry, Option<usize>)>,
}

/// The reason why a loop cannot work in a team. Loops are named by their places.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TeamFault<'a> {
    /// It works on another knowledge than that of the class.
    Knowledge {
        /// The loop.
        at: usize,
    },
    /// There is no such entry.
    UnknownEntry {
        /// The loop.
        at: usize,
        /// The entry that it names.
        entry: &'a str,
        /// `senses` or `effects`.
        verb: &'static str,
    },
    /// It adds an entry that is there already.
    EntryTaken {
        /// The loop.
        at: usize,
        /// The entry.
        entry: &'a str,
        /// The loop that adds it first; `None` where the component has it itself.
        by: Option<usize>,
    },
    /// It changes an effector that an earlier loop changes.
    Clash {
        /// The loop.
        at: usize,
        /// The effector.
        entry: &'a str,
        /// The earlier loop.
        with: usize,
    },
    /// It has a reference of the same name as the class or an earlier loop, with another interface.
    Reference {
        /// The loop.
        at: usize,
        /// The reference.
        reference: &'a str,
        /// The earlier loop; `None` where the class has it.
        with: Option<usize>,
    },
}

impl TeamFault<'_> {
    /// In words, where the loops have these names.
    pub(super) fn describe(&self, names: &[String]) -> String {
        let name = |at: usize| names.get(at).map_or("", String::as_str);
        let other = |with: Option<usize>, own: &'static str| match with {
            Some(with) => format!("`{}`", name(with)),
            None => own.to_owned(),
        };
        match self {
            Self::Knowledge { at } => format!("`{}` works on another knowledge", name(*at)),
            Self::UnknownEntry { at, entry, verb } => {
                format!("`{}` {verb} `{entry}`, and there is no such entry", name(*at))
            }
            Self::EntryTaken { at, entry, by } => {
                let by = other(*by, "the class");
                format!("`{}` adds the entry `{entry}`, which {by} has already", name(*at))
            }
            Self::Clash { at, entry, with } => {
                format!("`{}` and `{}` both effect `{entry}`", name(*with), name(*at))
            }
            Self::Reference { at, reference, with } => {
                let with = other(*with, "the class");
                format!("`{}` and {with} have different references `{reference}`", name(*at))
            }
        }
    }
}

impl<'a> Team<'a> {
    /// These loops in a component of the class.
    pub fn of(class: &'a ClassDeclaration, loops: Vec<&'a LoopDeclaration>) -> Self {
        let known = class.knowledge.iter().flat_map(|knowledge| &knowledge.entries);
        let mut entries: HashMap<&str, (&DeclaredEntry, Option<usize>)> =
            known.map(|entry| (entry.name.as_str(), (entry, None))).collect();
        for (at, one) in loops.iter().enumerate() {
            for entry in &one.entries {
                entries.entry(&entry.name).or_insert((entry, Some(at)));
            }
        }
        Self { class, loops, entries }
    }

    /// The names of all entries, sorted.
    pub fn entries(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = self.entries.keys().copied().collect();
        names.sort_unstable();
        names
    }

    /// All that is wrong.
    pub fn faults(&self) -> Vec<TeamFault<'a>> {
        let mut faults = Vec::new();
        // Who changes an effector first.
        let mut owners: HashMap<&str, usize> = HashMap::new();
        let mut references: HashMap<&str, (&str, Option<usize>)> = HashMap::new();
        for reference in &self.class.references {
            references.insert(&reference.name, (&reference.interface.name, None));
        }
        for (at, &one) in self.loops.iter().enumerate() {
            let knowledge = self.class.knowledge.as_ref().map(|knowledge| &knowledge.name);
            if one.knowledge.is_some() && one.knowledge.as_ref() != knowledge {
                faults.push(TeamFault::Knowledge { at });
                continue;
            }
            for entry in &one.entries {
                match self.entries.get(entry.name.as_str()) {
                    Some(&(_, by)) if by != Some(at) => {
                        faults.push(TeamFault::EntryTaken { at, entry: &entry.name, by });
                    }
                    _ => self.own(at, &entry.name, &mut owners, &mut faults),
                }
            }
            for (verb, names) in [("senses", &one.senses), ("effects", &one.effects)] {
                for entry in names {
                    if !self.entries.contains_key(entry.as_str()) {
                        faults.push(TeamFault::UnknownEntry { at, entry, verb });
                    } else if verb == "effects" {
                        self.own(at, entry, &mut owners, &mut faults);
                    }
                }
            }
            for reference in &one.references {
                let (name, interface) = (&reference.name, reference.interface.name.as_str());
                let (known, with) = *references.entry(name).or_insert((interface, Some(at)));
                if known != interface {
                    faults.push(TeamFault::Reference { at, reference: name, with });
                }
            }
        }
        faults
    }

    /// A loop changes an entry, which is an effector or not.
    fn own(&self, at: usize, entry: &'a str, owners: &mut HashMap<&'a str, usize>, faults: &mut Vec<TeamFault<'a>>) {
        if !self.entries.get(entry).is_some_and(|(entry, _)| entry.effector) {
            return;
        }
        match *owners.entry(entry).or_insert(at) {
            with if with != at => faults.push(TeamFault::Clash { at, entry, with }),
            _ => {}
        }
    }
}
