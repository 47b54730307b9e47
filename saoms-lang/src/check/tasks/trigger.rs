//! The topics that trigger a component: it has to subscribe to them and to have a function for them.

use std::collections::BTreeSet;

use super::Task;
use crate::assembly::topic_list;
use crate::check::report::{Report, list};
use crate::diagnostic::{Diagnostic, codes, quoted};

/// Reports topics in `trigger` that cannot trigger the component, and a `minimum` without any.
pub(super) fn check(task: &Task<'_, '_>, report: &mut Report<'_>) {
    let Some(text) = task.text("trigger").filter(|text| !text.trim().is_empty()) else {
        if let Some(place) = task.place("minimum") {
            let message = "`minimum` has no effect: no topic triggers the component".to_owned();
            let one = Diagnostic::new(&codes::MINIMUM_UNUSED, place, message);
            report.push(one.help("name topics in `trigger`, or remove it"));
        }
        return;
    };
    let class = task.class.class;
    if !class.declaration().reacts {
        let message = format!("class {} does not react to messages: no topic can trigger it", quoted(class.name()));
        let one = Diagnostic::new(&codes::TRIGGER, text.location, message);
        let one = one.help("remove `trigger`: it reads its messages in each period");
        report.push(one.help("a class that reacts says `reacts` in its `#[class(...)]` and has a function `react`"));
        return;
    }
    let subscribed: BTreeSet<&str> = task.class.subscribes.iter().map(|topic| topic.name.as_str()).collect();
    let parts = report.parts(&text);
    let mut seen = BTreeSet::new();
    for (name, at) in topic_list::names(&text) {
        let at = parts.part(at);
        if !seen.insert(name) {
            let one = Diagnostic::new(&codes::TRIGGER, at, format!("{} is named twice", quoted(name)));
            report.push(one.help("name it once"));
        } else if task.class.publishes.iter().any(|topic| topic.name == name) && !subscribed.contains(name) {
            let message =
                format!("class {} publishes {} and does not subscribe to it", quoted(class.name()), quoted(name));
            let one = Diagnostic::new(&codes::TRIGGER, at, message);
            report.push(one.help(format!("it subscribes to {}", list(subscribed.iter().copied()))));
        } else if !subscribed.contains(name) {
            let message = format!("class {} subscribes to no topic {}", quoted(class.name()), quoted(name));
            let known = ("it subscribes to", subscribed.iter().copied());
            let one = report.unknown(&codes::TRIGGER, at, message, name, known);
            report.push(one);
        }
    }
}
