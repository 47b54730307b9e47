//! Which loops each component has.

use std::collections::HashMap;
use std::sync::Arc;

use saoms_api::PropertyValue;

use super::classes::ClassIndex;
use super::fleet::{Fleet, Kind};
use super::properties::Checked;
use super::report::Report;
use crate::assembly::LoopSpec;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::registry::{LoopClass, Registry};

/// Finds the loops of all components; `None` where something about them is wrong. The class of a component with loops becomes one that uses
/// the topics and references of these as well.
pub(super) fn resolve<'r>(
    fleet: &mut Fleet<'_>,
    classes: &mut Vec<ClassIndex<'r>>,
    checked: &[Option<Checked>],
    registry: &'r Registry,
    report: &mut Report<'_>,
) -> Vec<Option<Vec<LoopSpec>>> {
    // The class of each place together with these loops.
    let mut known: HashMap<(usize, Vec<&str>), usize> = HashMap::new();
    let mut all = Vec::with_capacity(fleet.members.len());
    for (place, checked) in checked.iter().enumerate() {
        let member = &fleet.members[place];
        let (Kind::Class(index), Some(checked)) = (member.kind, checked) else {
            all.push(None);
            continue;
        };
        let class = &classes[index];
        let mut loops: Vec<&'r Arc<LoopClass>> = Vec::new();
        let mut is_sound = true;
        for name in by_default(class, checked) {
            match registry.get_loop(name) {
                Some(one) => loops.push(one),
                None => {
                    let message = format!(
                        "class {} has the loop {}, and there is no such loop",
                        quoted(class.class.name()),
                        quoted(name)
                    );
                    let at = member.component.name.location;
                    report.push(Diagnostic::new(&codes::UNKNOWN_CLASS, at, message));
                    is_sound = false;
                }
            }
        }
        if !loops.is_empty() {
            let key = (index, loops.iter().map(|one| one.name()).collect());
            let with = *known.entry(key).or_insert_with(|| {
                let with = classes[index].with(loops.iter().map(|one| one.declaration()));
                classes.push(with);
                classes.len() - 1
            });
            fleet.members[place].kind = Kind::Class(with);
        }
        let specs = loops.into_iter().map(|one| LoopSpec {
            name: one.declaration().short_name().to_owned(),
            class: Arc::clone(one),
            values: Vec::new(),
        });
        all.push(is_sound.then(|| specs.collect()));
    }
    all
}

/// The names of the loops that a component has unless the composite says otherwise.
fn by_default<'r>(class: &ClassIndex<'r>, checked: &Checked) -> &'r [String] {
    let declaration = class.class.declaration();
    let Some(property) = &declaration.loops.property else { return declaration.loops.of(None) };
    let given = checked.get(class, property).map(|given| &given.value);
    let preset = class.class.presets().iter().find(|(name, _)| name == property).map(|(_, value)| value);
    let value = match given.or(preset) {
        Some(PropertyValue::Text(text)) => Some(text.trim()),
        _ => declaration.property(property).and_then(|property| property.default.as_deref()),
    };
    declaration.loops.of(value)
}
