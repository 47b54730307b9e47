//! What components kept that end or get new instances in a change, for those of their class that begin in it.

use std::sync::Arc;

use saoms_api::KeptByOther;
use saoms_lang::assembly::ComponentSpec;

use super::part::Part;
use super::stored::Stored;

/// What the components kept that a change ends or replaces. All that begin in it share it.
#[derive(Clone, Default)]
pub(crate) struct Estate {
    bequests: Arc<[Arc<Bequest>]>,
    /// Number of them, at the beginning, that components kept until this change. The others were left to components
    /// that have kept nothing since.
    direct: usize,
    /// True if who got it has kept something since: what it made of it.
    is_taken: bool,
}

/// What one component kept.
struct Bequest {
    component: u32,
    class: String,
    site: String,
    stored: Stored,
}

impl Estate {
    /// What these components kept, and what was left to them, as long as they have kept nothing since.
    pub(crate) fn of<'p>(parts: impl Iterator<Item = &'p Part>) -> Estate {
        let (mut bequests, mut passed_on): (Vec<Arc<Bequest>>, Vec<Arc<Bequest>>) = Default::default();
        for part in parts {
            if !part.stored.entries().is_empty() {
                let (class, site) = (part.spec.class.name().to_owned(), part.spec.site.to_string());
                bequests.push(Arc::new(Bequest { component: part.index, class, site, stored: part.stored.clone() }));
            }
            if !part.estate.is_taken {
                for left in part.estate.left_to(part.index, &part.spec) {
                    if !passed_on.iter().any(|known| Arc::ptr_eq(known, left)) {
                        passed_on.push(Arc::clone(left));
                    }
                }
            }
        }
        let direct = bequests.len();
        bequests.append(&mut passed_on);
        Estate { bequests: bequests.into(), direct, is_taken: false }
    }

    /// What components of an earlier program kept: each with its number, its class, its site and that.
    pub(crate) fn of_earlier_program(kept: impl Iterator<Item = (u32, String, String, Stored)>) -> Estate {
        let bequest = |(component, class, site, stored)| Arc::new(Bequest { component, class, site, stored });
        let bequests: Arc<[Arc<Bequest>]> = kept.map(bequest).collect();
        Estate { direct: bequests.len(), bequests, is_taken: false }
    }

    /// Notes whether who got it has kept something since. Gives whether it had before.
    pub(crate) fn set_taken(&mut self, is_taken: bool) -> bool {
        std::mem::replace(&mut self.is_taken, is_taken)
    }

    /// What is left to a component: that of others of its class and site. What it kept itself before an earlier change
    /// may be left to another one that has not begun since, and comes back to it then.
    fn left_to(&self, component: u32, spec: &ComponentSpec) -> impl Iterator<Item = &Arc<Bequest>> {
        let is_of = move |other: &Bequest| other.class == spec.class.name() && other.site == *spec.site;
        let is_own = move |place: usize, one: &Bequest| place < self.direct && one.component == component;
        let all = self.bequests.iter().enumerate();
        all.filter(move |(place, one)| !is_own(*place, one) && is_of(one)).map(|(_, one)| one)
    }

    /// The same, for its code.
    pub(super) fn kept_by_others(&self, component: u32, spec: &ComponentSpec) -> Vec<KeptByOther<'_>> {
        let kept = self.left_to(component, spec).map(|one| {
            let entries = one.stored.entries().iter().map(|(key, bytes)| (*key, &**bytes));
            KeptByOther { kept: entries.collect(), by_earlier_program: one.stored.is_earlier() }
        });
        kept.collect()
    }
}
