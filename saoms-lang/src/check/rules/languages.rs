//! Texts in a language that a crate of components knows: it judges them before the constructor, with all events that
//! classes take.

use std::cell::OnceCell;
use std::collections::HashMap;

use saoms_api::event::fault::{FaultSubjects, SubjectComponent};
use saoms_api::event::{Events, receiver};
use saoms_api::extension::{LineFault, PropertyLanguage, PropertyTexts, RaisedEvent, RaisedFault};
use saoms_api::host::PropertyValue;
use saoms_api::{Finding, Place};

use crate::assembly::on_bus;
use crate::check::component::ComponentCheck;
use crate::check::fleet::{Fleet, Member};
use crate::check::placement::fault_nodes::FaultNodes;
use crate::check::properties::findings::{Subject, diagnostic};
use crate::check::report::Report;
use crate::diagnostic::{Severity, codes};
use crate::registry::PropertyDeclaration;

/// The events of a fleet, which most fleets never ask for.
pub(super) struct Languages<'f, 'a> {
    fleet: &'f Fleet<'a>,
    checks: &'f [ComponentCheck<'a>],
    events: OnceCell<Events>,
    /// By site and event: the paths of the components that take it.
    takers: OnceCell<HashMap<(String, String), Vec<String>>>,
}

impl<'f, 'a> Languages<'f, 'a> {
    pub(super) fn of(fleet: &'f Fleet<'a>, checks: &'f [ComponentCheck<'a>]) -> Self {
        Languages { fleet, checks, events: OnceCell::new(), takers: OnceCell::new() }
    }

    /// The events of all known classes; where two have one of the same name, that of the fleet's class.
    fn events(&self) -> &Events {
        self.events.get_or_init(|| {
            let own = self.fleet.classes.iter().flat_map(|class| class.class.declaration().events());
            let known = self.fleet.registry.into_iter().flat_map(|registry| registry.iter());
            Events::of(own.chain(known.flat_map(|class| class.declaration().events())))
        })
    }

    fn takers(&self, site: &str, event: &str) -> Vec<&str> {
        let all = self.takers.get_or_init(|| {
            let mut all: HashMap<(String, String), Vec<String>> = HashMap::new();
            for (place, member) in self.fleet.members.iter().enumerate() {
                let taken = self.fleet.class_of(place).map_or(&[][..], |class| &class.class.declaration().takes);
                for one in taken {
                    let key = (member.site.to_string(), one.event.clone());
                    all.entry(key).or_default().push(member.path().to_owned());
                }
            }
            all
        });
        let found = all.get(&(site.to_owned(), event.to_owned()));
        found.into_iter().flatten().map(String::as_str).collect()
    }

    /// The sites in which an event is taken, in words.
    fn sites_of(&self, event: &str) -> Vec<String> {
        let all = self.takers.get().into_iter().flat_map(HashMap::keys).filter(|(_, name)| name == event);
        let mut all: Vec<String> = all
            .map(|(site, _)| match site.is_empty() {
                true => "outside of sites".to_owned(),
                false => format!("in the site `{site}`"),
            })
            .collect();
        all.sort_unstable();
        all
    }

    /// What is wrong with the texts of a component that have a language. Tells of events that nobody takes.
    pub(super) fn judge(
        &self,
        member: &Member<'_>,
        subject: Subject<'_>,
        properties: &[PropertyDeclaration],
        report: &mut Report<'_>,
    ) -> Vec<Finding> {
        let mut all = Vec::new();
        for property in properties {
            let Some(language) = property.language.as_deref().and_then(PropertyLanguage::named) else { continue };
            let given = subject.values.iter().find(|(name, _)| *name == property.name);
            let texts: Vec<&str> = match given.map(|(_, value)| value) {
                Some(PropertyValue::Many(values)) => {
                    values.iter().filter_map(PropertyValue::as_text).map(|text| text.as_str()).collect()
                }
                Some(value) => value.as_text().into_iter().map(|text| text.as_str()).collect(),
                None => continue,
            };
            let texts = PropertyTexts {
                property: &property.name,
                texts: &texts,
                plays: &property.plays,
                events: self.events(),
            };
            let judged = (language.check)(&texts);
            all.extend(judged.findings);
            if !judged.faults.is_empty() {
                let subjects = self.fault_subjects(&member.site);
                let wrong =
                    |RaisedFault { text, call }| Some(finding(subjects.check(&call).err()?, &property.name, text));
                all.extend(judged.faults.into_iter().filter_map(wrong));
            }
            for raised in judged.raised {
                all.extend(self.reaches(member, subject, &property.name, raised, report));
            }
        }
        all
    }

    /// What the faults of a scenario can name: components of its site, or all outside of sites.
    fn fault_subjects(&self, site: &str) -> FaultSubjects {
        let mut subjects = FaultSubjects { is_complete: true, ..FaultSubjects::default() };
        let nodes = FaultNodes::of(self.fleet, self.checks);
        let members = self.fleet.members.iter().zip(self.checks).enumerate();
        for (place, (member, check)) in members.filter(|(_, (member, _))| member.runs()) {
            if !(site.is_empty() || member.site == *site) {
                continue;
            }
            let Some(class) = self.fleet.class_of(place) else {
                subjects.is_complete = false;
                continue;
            };
            let path = member.path().to_owned();
            let on_bus = |declared: &str| {
                let renamed = check.renamed.iter().find(|one| *one.old == *declared);
                on_bus(&member.site, renamed.map_or(declared, |one| &one.new)).into_owned()
            };
            for declared in &class.publishes {
                subjects.topic(on_bus(&declared.name)).writers.push(path.clone());
            }
            for declared in &class.subscribes {
                subjects.topic(on_bus(&declared.name)).readers.push(path.clone());
            }
            let node = nodes.of_member(member).to_string();
            let is_periodic = class.class.declaration().is_periodic();
            subjects.components.push(SubjectComponent { path, node, is_periodic });
        }
        subjects
    }

    /// Tells of an event that nobody in the site takes; a wrong component behind `to` is a finding.
    fn reaches(
        &self,
        member: &Member<'_>,
        subject: Subject<'_>,
        property: &str,
        RaisedEvent { text, call }: RaisedEvent,
        report: &mut Report<'_>,
    ) -> Option<Finding> {
        let name = &call.name.text;
        let takers = self.takers(&member.site, name);
        let is_known = |place: usize| !self.fleet.members[place].runs() || self.fleet.class_of(place).is_some();
        if takers.is_empty() {
            if !(0..self.fleet.members.len()).all(is_known) {
                // A component without a class here may take it.
                return None;
            }
            let elsewhere = self.sites_of(name);
            let place = match (elsewhere.is_empty(), member.site.is_empty()) {
                (true, _) => "of the fleet".to_owned(),
                (false, true) => "outside of sites".to_owned(),
                (false, false) => format!("of the site `{}`", member.site),
            };
            let message = format!("no component {place} takes the event `{name}`, so the event has no effect");
            let classes = self.events().get(name).map_or(&[][..], |event| &event.classes);
            let classes: Vec<String> = classes.iter().take(3).map(|class| format!("`{class}`")).collect();
            let finding = Finding::new(Place::property(property).part(text, call.name.bytes.clone()), message);
            let finding = finding.help(match elsewhere.is_empty() {
                true => format!("add a component of a class that takes it, such as {}", classes.join(", ")),
                false => format!("components {} take it: move the event there", elsewhere.join(", ")),
            });
            let one = diagnostic(&codes::EVENT_UNTAKEN, Severity::Warning, &finding, subject, &|_| None, report);
            one.into_iter().for_each(|one| report.push(one));
            return None;
        }
        let to = call.to.as_ref()?;
        let fault = receiver(&takers, to, name).err()?;
        Some(finding(fault, property, text))
    }
}

/// A fault of a line as a finding about a property.
fn finding(fault: LineFault, property: &str, text: usize) -> Finding {
    let finding = Finding::new(Place::property(property).part(text, fault.bytes), fault.message);
    let finding = match fault.instead {
        Some(instead) => finding.instead(instead),
        None => finding,
    };
    match fault.help {
        Some(help) => finding.help(help),
        None => finding,
    }
}
