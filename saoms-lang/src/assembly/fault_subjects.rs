//! What faults can name in a fleet.

use std::collections::BTreeMap;

use saoms_api::event::fault::{FaultSubjects, SubjectTopic};

use super::ComponentSpec;

/// The components of a fleet and its topics, which faults name.
pub fn fault_subjects<'s>(specs: impl IntoIterator<Item = &'s ComponentSpec>) -> FaultSubjects {
    let mut subjects = FaultSubjects { is_complete: true, ..FaultSubjects::default() };
    let mut topics: BTreeMap<String, SubjectTopic> = BTreeMap::new();
    for spec in specs {
        let own = spec.class.declaration();
        subjects.components.push((spec.path.clone(), own.is_periodic()));
        let loops = || spec.loops.iter().map(|one| one.class.declaration());
        for declared in own.publishes.iter().chain(loops().flat_map(|one| &one.publishes)) {
            note(&mut topics, spec, &declared.name, |topic| &mut topic.writers);
        }
        for declared in own.subscribes.iter().chain(loops().flat_map(|one| &one.subscribes)) {
            note(&mut topics, spec, &declared.name, |topic| &mut topic.readers);
        }
    }
    subjects.topics = topics.into_values().collect();
    subjects
}

fn note(
    topics: &mut BTreeMap<String, SubjectTopic>,
    spec: &ComponentSpec,
    declared: &str,
    ends: impl Fn(&mut SubjectTopic) -> &mut Vec<String>,
) {
    let name = spec.topic(declared).into_owned();
    let new = || SubjectTopic { name: name.clone(), ..SubjectTopic::default() };
    let ends = ends(topics.entry(name.clone()).or_insert_with(new));
    if ends.last() != Some(&spec.path) {
        ends.push(spec.path.clone());
    }
}
