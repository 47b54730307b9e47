//! The topics that components give new names. Components may share a list of them: a name that none of them uses is a
//! mistake.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::rc::Rc;

use crate::assembly::topic_rename::{self, RenameFault};
use crate::check::fleet::{Fleet, class_index::ClassIndex};
use crate::check::properties::findings::Renamed;
use crate::check::report::{Parts, Report, replacing};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::{Location, Span, Text};
use crate::syntax::escaped;

/// The lists of renamed topics of a fleet.
#[derive(Default)]
pub(crate) struct Renames {
    /// By their texts, in order.
    places: HashMap<(Location, String), usize>,
    all: Vec<List>,
}

struct List {
    renamed: Rc<[Renamed]>,
    /// The components that share it.
    members: Vec<usize>,
}

impl Renames {
    /// Adds the list of a component, with the topics that it renames. What is wrong with it as it stands is reported.
    pub(super) fn add(&mut self, member: usize, text: &Text, report: &mut Report<'_>) -> Rc<[Renamed]> {
        let (pairs, faults) = topic_rename::parse(text);
        let parts = report.parts(text);
        faults.into_iter().for_each(|fault| report.push(wrong(fault, text, &parts)));
        let place = *self.places.entry((text.location, text.to_string())).or_insert_with(|| {
            let name = |name: topic_rename::Name<'_>| Text::new(name.text.into(), parts.part(name.at));
            let renamed = pairs.into_iter().map(|pair| Renamed { old: name(pair.old), new: name(pair.new) });
            self.all.push(List { renamed: renamed.collect(), members: Vec::new() });
            self.all.len() - 1
        });
        let list = &mut self.all[place];
        list.members.push(member);
        Rc::clone(&list.renamed)
    }

    /// Reports the topics that none of the components uses that list them.
    pub(super) fn finish(self, fleet: &Fleet<'_>, report: &mut Report<'_>) {
        for List { renamed, members } in &self.all {
            let classes = members.iter().filter_map(|member| fleet.class_of(*member));
            let classes: HashMap<&str, &ClassIndex<'_>> = classes.map(|class| (class.class.name(), class)).collect();
            let used: BTreeSet<&str> = classes.values().flat_map(|class| topics(class)).collect();
            let listed: HashSet<&str> = renamed.iter().map(|one| one.old.as_str()).collect();
            let others: Vec<&str> = used.iter().copied().filter(|topic| !listed.contains(topic)).collect();
            for Renamed { old: name, new } in renamed.iter().filter(|one| !used.contains(one.old.as_str())) {
                let mut classes = classes.keys();
                let whose = match (classes.next(), classes.len()) {
                    (Some(only), 0) => format!("class {} uses no topic", quoted(only)),
                    (_, more) => format!("none of the {} classes that share this uses a topic", more + 1),
                };
                let message = format!("{whose} {}: nothing is renamed", quoted(name));
                let known = ("topics that keep their names are", others.iter().copied());
                for member in members {
                    report.about(&fleet.members[*member]);
                    let one =
                        report.unknown(&codes::RENAME_UNUSED, name.location, message.clone(), name, known.clone());
                    // The two names of a pair in the other order.
                    let is_swapped = used.contains(new.as_str()) && report.written(new.location) == new.as_str();
                    let whole = Span::new(name.location.span.start, new.location.span.end);
                    if is_swapped && name.location.file == new.location.file {
                        let meant = format!("{new},{name}");
                        let one = Diagnostic::new(&codes::RENAME_UNUSED, name.location, message.clone());
                        let description = format!("write {}: the name that the class uses comes first", quoted(&meant));
                        report.push(one.suggest(description, whole.in_file(name.location.file), escaped(&meant)));
                        continue;
                    }
                    report.push(match others.is_empty() {
                        true => one.help("remove the pair: all topics there have new names already"),
                        false => one,
                    });
                }
            }
        }
        report.about_all();
    }
}

fn wrong(fault: RenameFault, text: &str, parts: &Parts) -> Diagnostic {
    let at = parts.part(fault.at.clone());
    let one = Diagnostic::new(&codes::TOPIC_RENAME, at, format!("property `topicRename`: {}", fault.message));
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

/// The names of the topics of a class.
fn topics<'c>(class: &'c ClassIndex<'_>) -> impl Iterator<Item = &'c str> {
    class.publishes.iter().chain(&class.subscribes).map(|topic| topic.name.as_str())
}
