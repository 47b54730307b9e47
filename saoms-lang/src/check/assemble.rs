//! The assembly of a fleet without errors.

use std::sync::Arc;

use smol_str::SmolStr;

use crate::assembly::{Assembly, ComponentSpec, Wire, WireTarget};
use crate::check::classes;
use crate::check::component::ComponentCheck;
use crate::check::fleet::Fleet;
use crate::check::run_settings;
use crate::check::wiring::Wiring;
use crate::source::Sources;

/// The assembly of a fleet without errors; `None` if something is taken as given.
pub(crate) fn assemble(
    fleet: &Fleet<'_>,
    checks: Vec<ComponentCheck<'_>>,
    wiring: &Wiring,
    sources: &Sources,
) -> Option<Assembly> {
    // Components that composites implement are in no assembly.
    let mut count = 0;
    let indices = fleet.members.iter().map(|member| {
        count += usize::from(member.runs());
        count.saturating_sub(1)
    });
    let indices: Vec<usize> = indices.collect();
    let mut components = Vec::with_capacity(count);
    for (place, check) in checks.into_iter().enumerate() {
        let member = &fleet.members[place];
        if !member.runs() {
            continue;
        }
        if !check.is_sound() {
            return None;
        }
        let class = fleet.class_of(place)?;
        let (values, written, _) = check.given.into_own();
        let references = class.references.iter().zip(&wiring[place]);
        let references = references.map(|(declared, targets)| Wire {
            reference: declared.name.clone(),
            interface: declared.interface.name.clone(),
            targets: targets
                .iter()
                .flatten()
                .filter_map(|provider| {
                    let class = fleet.class_of(provider.member)?;
                    let service = class.services[provider.service].name.clone();
                    Some(WireTarget { component: indices[provider.member], service })
                })
                .collect(),
        });
        components.push(ComponentSpec {
            path: member.path().to_owned(),
            site: member.site.clone(),
            node: member.node.clone(),
            class: Arc::clone(class.class),
            library: classes::library(member.component, fleet.contribution, sources),
            values,
            written,
            task: check.task,
            references: references.collect(),
            loops: check.loops?.specs,
        });
    }
    Some(Assembly {
        components,
        elsewhere: Vec::new(),
        node: SmolStr::default(),
        run: run_settings::policy(fleet, sources),
    })
}
