//! The topics that a component gives new names.

use std::collections::HashSet;
use std::rc::Rc;

use super::unused_renames::{Listed, Unused};
use crate::assembly::topic_rename::{self, Fault};
use crate::check::fleet::classes::ClassIndex;
use crate::check::report::{Parts, Report, replacing};
use crate::diagnostic::{Diagnostic, codes};
use crate::registry::ClassTopic;
use crate::source::{Location, Text};
use crate::syntax::escaped;

/// A topic with a new name.
pub(crate) struct Renamed {
    pub(crate) old: String,
    pub(crate) new: String,
    /// The place of the new name.
    pub(crate) at: Location,
}

/// The topics that a text renames.
pub(crate) fn renamed(text: &Text, report: &Report<'_>) -> Vec<Renamed> {
    let parts = report.parts(text);
    let renamed = |pair: topic_rename::Pair<'_>| {
        let (old, new) = (pair.old.text.to_owned(), pair.new.text.to_owned());
        Renamed { old, new, at: parts.part(pair.new.at) }
    };
    topic_rename::read(text).0.into_iter().map(renamed).collect()
}

/// Checks a text that renames topics: the old names, with those that the class does not have.
pub(super) fn check<'a>(text: &Text, class: &ClassIndex<'a>, report: &mut Report<'_>) -> Vec<Listed<'a>> {
    let (pairs, faults) = topic_rename::parse(text);
    let parts = report.parts(text);
    faults.into_iter().for_each(|fault| report.push(wrong(fault, text, &parts)));
    let renamed: HashSet<&str> = pairs.iter().map(|pair| pair.old.text).collect();
    let mut others: Option<Rc<[&str]>> = None;
    let listed = pairs.iter().map(|pair| {
        let name = pair.old.text;
        let is_used = topics(class).any(|topic| topic.name == name);
        let unused = || {
            let names = topics(class).map(|topic| topic.name.as_str());
            let others = others.get_or_insert_with(|| names.filter(|name| !renamed.contains(name)).collect());
            Unused { class: class.class.name(), others: Rc::clone(others) }
        };
        let at = parts.part(pair.old.at.clone());
        Listed { name: name.to_owned(), at, unused: (!is_used).then(unused) }
    });
    listed.collect()
}

fn wrong(fault: Fault, text: &str, parts: &Parts) -> Diagnostic {
    let at = parts.part(fault.at.clone());
    let one = Diagnostic::new(&codes::TOPIC_RENAME, at, format!("bad `topicRename`: {}", fault.message));
    if let Some((other, what)) = fault.other {
        return one.label(parts.part(other), what);
    }
    let one = one.help("write `OLD,new` for each topic, and `::` between two of them");
    let pair = text.get(fault.at).unwrap_or_default();
    match topic_rename::pairs_of(pair) {
        Some(meant) => one.suggest(replacing(pair, &meant), at, escaped(&meant)),
        None => one,
    }
}

/// The topics of a class, each once.
fn topics<'c, 'a>(class: &'c ClassIndex<'a>) -> impl Iterator<Item = &'a ClassTopic> + Clone + use<'c, 'a> {
    let published = |name: &str| class.publishes.iter().any(|topic| topic.name == name);
    let others = class.subscribes.iter().filter(move |topic| !published(&topic.name));
    class.publishes.iter().chain(others).copied()
}
