//! What components kept that end or get new instances in a change, for those of their class that begin in it.

use std::sync::Arc;

use saoms_api::KeptByOther;
use saoms_lang::assembly::ComponentSpec;

use super::part::Part;
use super::stored::Stored;

/// What the components kept that a change ends or replaces. All that begin in it share it.
#[derive(Clone, Default)]
pub(crate) struct Estate {
    bequests: Arc<[Bequest]>,
}

/// What one component kept.
#[derive(Clone)]
struct Bequest {
    component: u32,
    spec: Arc<ComponentSpec>,
    stored: Stored,
}

impl Estate {
    /// What these components kept, and what was left to those that do not run: they may not have begun since.
    pub(crate) fn of<'p>(parts: impl Iterator<Item = (&'p Part, bool)>) -> Estate {
        let mut bequests = Vec::new();
        for (part, runs) in parts {
            if !part.stored.entries().is_empty() {
                let (spec, stored) = (Arc::clone(&part.spec), part.stored.clone());
                bequests.push(Bequest { component: part.index, spec, stored });
            }
            if !runs {
                bequests.extend(part.estate.left_to(part.index, &part.spec).cloned());
            }
        }
        Estate { bequests: bequests.into() }
    }

    /// What is left to a component: that of others of its class and site.
    fn left_to(&self, component: u32, spec: &ComponentSpec) -> impl Iterator<Item = &Bequest> {
        let is_of = move |other: &ComponentSpec| other.class.name() == spec.class.name() && other.site == spec.site;
        self.bequests.iter().filter(move |one| one.component != component && is_of(&one.spec))
    }

    /// The same, for its code.
    pub(super) fn kept_by_others(&self, component: u32, spec: &ComponentSpec) -> Vec<KeptByOther<'_>> {
        let kept = self.left_to(component, spec).map(|Bequest { stored, .. }| {
            let entries = stored.entries().iter().map(|(key, bytes)| (*key, &**bytes));
            KeptByOther { kept: entries.collect(), by_earlier_program: stored.is_earlier() }
        });
        kept.collect()
    }
}
