//! What faults can name in a fleet.

use saoms_api::event::fault::{FaultSubjects, SubjectComponent};

use super::ComponentSpec;

/// The components of a fleet and its topics, which faults name.
pub fn fault_subjects<'s>(specs: impl IntoIterator<Item = &'s ComponentSpec>) -> FaultSubjects {
    let mut subjects = FaultSubjects { is_complete: true, ..FaultSubjects::default() };
    for spec in specs {
        let own = spec.class.declaration();
        let (path, node) = (spec.path.clone(), spec.fault_node.to_string());
        subjects.components.push(SubjectComponent { path, node, is_periodic: own.is_periodic() });
        let loops = || spec.loops.iter().map(|one| one.class.declaration());
        for declared in own.publishes.iter().chain(loops().flat_map(|one| &one.publishes)) {
            note(&mut subjects.topic(spec.topic(&declared.name).into_owned()).writers, &spec.path);
        }
        for declared in own.subscribes.iter().chain(loops().flat_map(|one| &one.subscribes)) {
            note(&mut subjects.topic(spec.topic(&declared.name).into_owned()).readers, &spec.path);
        }
    }
    subjects
}

/// Adds a component to the ends of a topic, once.
fn note(ends: &mut Vec<String>, path: &str) {
    if ends.last().is_none_or(|last| last != path) {
        ends.push(path.to_owned());
    }
}
