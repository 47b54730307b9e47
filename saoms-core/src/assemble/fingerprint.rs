use std::fmt::Write;

use saoms_api::host::PropertyValue;
use saoms_lang::assembly::{Assembly, ComponentSpec, Wire};

use super::plan::is_default;
use crate::hash::{fold, text_hash};

/// A number by which a fleet is known again later: fleets between which there is nothing to change have the same one.
///
/// ```
/// use saoms_core::assemble::fingerprint;
/// use saoms_lang::assembly::Assembly;
///
/// assert_eq!(fingerprint(&Assembly::default()), fingerprint(&Assembly::default()));
/// ```
pub fn fingerprint(assembly: &Assembly) -> u64 {
    let mut components: Vec<&ComponentSpec> = assembly.components.iter().collect();
    components.sort_unstable_by(|one, other| one.path.cmp(&other.path));
    let mut text = String::new();
    components.into_iter().fold(0, |hash, component| {
        text.clear();
        // Writing to a text does not fail.
        let _ = describe(component, assembly, &mut text);
        fold(hash, text_hash(&text))
    })
}

/// Writes all that a [plan](super::ChangePlan) compares of a component.
fn describe(component: &ComponentSpec, assembly: &Assembly, text: &mut String) -> std::fmt::Result {
    let ComponentSpec { path, site, class, values, task, references, loops, web, .. } = component;
    write!(text, "{path:?} {site:?} {:?} {task:?}", class.name())?;
    let mut values: Vec<&(_, PropertyValue)> =
        values.iter().filter(|(name, value)| !is_default(component, name, value)).collect();
    values.sort_unstable_by(|(one, _), (other, _)| one.cmp(other));
    write!(text, " {values:?}")?;
    for one in &loops[..] {
        write!(text, " {:?} {:?} {:?}", one.name, one.class.name(), one.values)?;
    }
    for one in &web[..] {
        write!(text, " {:?} {:?} {:?} {:?}", one.path, one.service, one.interface, one.deadline)?;
    }
    let mut references: Vec<&Wire> = references.iter().collect();
    references.sort_by(|one, other| one.reference.cmp(&other.reference));
    for Wire { reference, interface, targets, elsewhere, web, deadline } in references {
        write!(text, " {reference:?} {interface:?} {deadline:?} {elsewhere:?}")?;
        for target in targets {
            let provider = assembly.components.get(target.component).map(|provider| provider.path.as_str());
            write!(text, " {provider:?} {:?}", target.service)?;
        }
        for target in &web[..] {
            write!(text, " {:?} {:?}", target.address, target.token_env)?;
        }
    }
    Ok(())
}
