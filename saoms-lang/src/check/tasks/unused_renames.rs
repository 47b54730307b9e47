//! Lists of topics with new names, which components may share: a name that none of them uses is a mistake.

use std::collections::HashMap;
use std::rc::Rc;

use crate::check::fleet::Fleet;
use crate::check::report::Report;
use crate::diagnostic::{codes, quoted};
use crate::source::Location;

/// A topic in a list of renamed ones.
pub(crate) struct Listed<'a> {
    pub(crate) name: String,
    pub(crate) at: Location,
    /// The message where the class of the component does not use it.
    pub(crate) unused: Option<Unused<'a>>,
}

pub(crate) struct Unused<'a> {
    pub(crate) class: &'a str,
    /// Its topics that the list says nothing of.
    pub(crate) others: Rc<[&'a str]>,
}

/// The renames that the components of a fleet list.
#[derive(Default)]
pub(crate) struct Renames<'a> {
    places: HashMap<Location, usize>,
    all: Vec<One<'a>>,
}

struct One<'a> {
    name: String,
    at: Location,
    /// Those who list it and do not use it, with their places; none where somebody uses it.
    users: Vec<(usize, Unused<'a>)>,
    is_used: bool,
}

impl<'a> Renames<'a> {
    /// Adds what a component lists.
    pub(crate) fn add(&mut self, member: usize, listed: Vec<Listed<'a>>) {
        for Listed { name, at, unused } in listed {
            let place = *self.places.entry(at).or_insert_with(|| {
                self.all.push(One { name, at, users: Vec::new(), is_used: false });
                self.all.len() - 1
            });
            let one = &mut self.all[place];
            match unused {
                None => {
                    one.is_used = true;
                    one.users = Vec::new();
                }
                Some(unused) if !one.is_used => {
                    // As a rule a list is of one component.
                    if one.users.is_empty() {
                        one.users.reserve_exact(1);
                    }
                    one.users.push((member, unused));
                }
                Some(_) => {}
            }
        }
    }

    /// Reports the topics that none of those uses who list them.
    pub(crate) fn finish(self, fleet: &Fleet<'_>, report: &mut Report<'_>) {
        for One { name, at, users, .. } in self.all {
            let mut classes: Vec<&str> = users.iter().map(|(_, unused)| unused.class).collect();
            classes.sort_unstable();
            classes.dedup();
            let whose = match classes[..] {
                [only] => format!("class {} uses no topic", quoted(only)),
                _ => format!("none of the {} classes that share this uses a topic", classes.len()),
            };
            let message = format!("{whose} {}: nothing is renamed", quoted(&name));
            let mut others: Vec<&str> = users.iter().flat_map(|(_, unused)| unused.others.iter().copied()).collect();
            others.sort_unstable();
            others.dedup();
            let known = ("topics that keep their names are", others.iter().copied());
            for (member, _) in &users {
                report.about(&fleet.members[*member]);
                let one = report.unknown(&codes::RENAME_UNUSED, at, message.clone(), &name, known.clone());
                let one = if others.is_empty() {
                    one.help("remove the pair: all topics there have new names already")
                } else {
                    one
                };
                report.push(one);
            }
        }
        report.about_all();
    }
}
