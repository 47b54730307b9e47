//! Events that classes take: an event has the same fields for all of them.

use std::collections::{BTreeMap, HashSet};

use saoms_api::event::EventField;
use saoms_api::extension::PropertyLanguage;

use crate::check::fleet::Member;
use crate::check::fleet::class_index::ClassIndex;
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::Location;

/// The events that the components of a fleet take.
#[derive(Default)]
pub(crate) struct TakenEvents<'a> {
    first: BTreeMap<String, FirstTaker<'a>>,
    seen: HashSet<usize>,
}

/// The component that takes an event first.
struct FirstTaker<'a> {
    class: &'a str,
    place: Location,
    fields: Vec<EventField>,
}

impl<'a> TakenEvents<'a> {
    /// Adds the events of a component: one speaks for all others of its class.
    pub(crate) fn add(
        &mut self,
        member: &Member<'a>,
        (index, class): (usize, &ClassIndex<'a>),
        report: &mut Report<'_>,
    ) {
        let declaration = class.class.declaration();
        if declaration.takes.is_empty() || !self.seen.insert(index) {
            return;
        }
        let (place, component) = (member.component.name.location, quoted(&member.component.name));
        for event in declaration.events() {
            let taken = format!("component {component} takes the event {}", quoted(&event.name));
            let word = |language: &&PropertyLanguage| language.words.contains(&event.name.as_str());
            if let Some(language) = PropertyLanguage::linked().find(word) {
                let message = format!("{taken}, which is a reserved word of the {} language", quoted(language.name));
                let one = Diagnostic::new(&codes::EVENT_MISMATCH, place, message);
                let class = quoted(&declaration.name);
                report
                    .push(one.help(format!("give it another name under `takes` in the declaration of class {class}")));
                continue;
            }
            let Some(first) = self.first.get(&event.name) else {
                let first = FirstTaker { class: &class.class.declaration().name, place, fields: event.fields };
                self.first.insert(event.name, first);
                continue;
            };
            if first.fields != event.fields {
                let [one, other] = [&first.fields, &event.fields].map(|fields| described(fields));
                let message = format!("{taken} with {other}, and class {} with {one}", quoted(first.class));
                let one = Diagnostic::new(&codes::EVENT_MISMATCH, place, message);
                report.push(one.label(first.place, "a component of that class").help(
                    "an event has the same fields for all classes; give it another name under `takes` in one of them",
                ));
            }
        }
    }
}

fn described(fields: &[EventField]) -> String {
    let names: Vec<String> =
        fields.iter().map(|field| quoted(&format!("{}={}", field.name, field.of.sample()))).collect();
    match names.is_empty() {
        true => "no fields".to_owned(),
        false => format!("the fields {}", names.join(", ")),
    }
}
