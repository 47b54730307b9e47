//! Components by their names.
//!
//! A table of nothing but places: names stay where the components have them. That of a large fleet is small enough for the caches of a
//! processor, where one with the names in it is not; looking names up would take a tenth of the time of a check otherwise.

use std::hash::BuildHasher;
use std::hint::black_box;

use smol_str::SmolStr;

use super::fleet::{Fleet, Member};
use crate::hash::Seeded;

/// Names that [`ByName::warm`] takes at once: about as many as a processor has reads of memory under way.
pub(super) const AT_ONCE: usize = 32;

/// The components of a fleet by scope and name; of each name one.
#[derive(Default)]
pub(super) struct ByName {
    /// As many as a power of two, at least half as many again as are taken. Where one is taken already, the next one is.
    slots: Vec<Slot>,
    taken: usize,
    hashing: Seeded,
}

/// The place of a component, and a part of the hash of its name.
#[derive(Clone, Copy)]
struct Slot {
    tag: u32,
    member: u32,
}

/// A slot that is not taken.
const FREE: Slot = Slot { tag: 0, member: u32::MAX };

impl ByName {
    /// With room for so many.
    pub(super) fn with_capacity(count: usize) -> Self {
        let mut all = Self::default();
        if count > 0 {
            all.slots = vec![FREE; (count + count.div_ceil(2)).next_power_of_two()];
        }
        all
    }

    /// The component of this name.
    pub(super) fn get(&self, scope: usize, name: &str, members: &[Member<'_>]) -> Option<usize> {
        let slot = self.slots.get(self.slot(scope, name, members)?)?;
        (slot.member != FREE.member).then_some(slot.member as usize)
    }

    /// Looks at what [`get`](Self::get) will look at for each of these names. A name that is looked up waits for memory three times, one
    /// after the other; many of them wait together.
    pub(super) fn warm<'n>(&self, names: impl Iterator<Item = (usize, &'n str)>, members: &[Member<'_>]) {
        let Some(last) = self.slots.len().checked_sub(1) else { return };
        let mut slots = [0; AT_ONCE];
        let mut count = 0;
        for (slot, (scope, name)) in slots.iter_mut().zip(names) {
            *slot = (self.hash(scope, name) >> 32) as usize & last;
            count += 1;
        }
        let slots = slots[..count].iter().map(|at| self.slots[*at].member);
        let seen = slots.filter_map(|member| members.get(member as usize)).map(|member| member.component);
        black_box(seen.fold(0, |sum, component| sum + component.name.len()));
    }

    /// Adds the component at a place, in place of another one of its name.
    pub(super) fn insert(&mut self, place: usize, members: &[Member<'_>]) {
        if let Some((slot, tag)) = self.own_slot(place, members) {
            // Fleets are limited to fewer.
            let before = std::mem::replace(slot, Slot { tag, member: place as u32 });
            self.taken += usize::from(before.member == FREE.member);
        }
    }

    /// Adds the component at a place where there is none of its name; else gives that one.
    pub(super) fn admit(&mut self, place: usize, members: &[Member<'_>]) -> Option<usize> {
        let (slot, tag) = self.own_slot(place, members)?;
        if slot.member != FREE.member {
            return Some(slot.member as usize);
        }
        *slot = Slot { tag, member: place as u32 };
        self.taken += 1;
        None
    }

    /// The components that are in it.
    pub(super) fn places(&self) -> impl Iterator<Item = usize> + use<> {
        let taken = self.slots.iter().filter(|slot| slot.member != FREE.member);
        taken.map(|slot| slot.member as usize).collect::<Vec<_>>().into_iter()
    }

    /// The slot for the name of the component at a place, with its part of the hash.
    fn own_slot(&mut self, place: usize, members: &[Member<'_>]) -> Option<(&mut Slot, u32)> {
        let count = self.taken + 1;
        if count + count.div_ceil(2) > self.slots.len() {
            let larger = Self { hashing: self.hashing, ..Self::with_capacity(2 * count) };
            let before = std::mem::replace(self, larger);
            before.places().for_each(|place| self.insert(place, members));
        }
        let (scope, name) = key(&members[place]);
        let hash = self.hash(scope, name);
        let slot = self.slot_of(hash, (scope, name), members)?;
        Some((&mut self.slots[slot], hash as u32))
    }

    fn hash(&self, scope: usize, name: &str) -> u64 {
        self.hashing.hash_one((scope, name))
    }

    /// The slot of this name: its own, or the free one where it would be. `None` when there are no slots.
    fn slot(&self, scope: usize, name: &str, members: &[Member<'_>]) -> Option<usize> {
        self.slot_of(self.hash(scope, name), (scope, name), members)
    }

    /// The same where the hash of the name is known.
    fn slot_of(&self, hash: u64, of: (usize, &str), members: &[Member<'_>]) -> Option<usize> {
        let last = self.slots.len().checked_sub(1)?;
        let mut at = (hash >> 32) as usize & last;
        loop {
            let slot = self.slots[at];
            let is_it = || slot.tag == hash as u32 && key(&members[slot.member as usize]) == of;
            if slot.member == FREE.member || is_it() {
                return Some(at);
            }
            // At least a third of them are free.
            at = (at + 1) & last;
        }
    }
}

/// Has the memory ready in which the targets of this component and of the next ones will be looked up, before each of them is.
pub(super) fn warm_targets(member: usize, fleet: &Fleet<'_>) {
    /// Components at a time: most have a target or two.
    const TOGETHER: usize = AT_ONCE / 2;
    if !member.is_multiple_of(TOGETHER) {
        return;
    }
    let mut targets = [(0, ""); AT_ONCE];
    let mut count = 0;
    let mut before: Option<&SmolStr> = None;
    for one in fleet.members[member..].iter().take(TOGETHER) {
        for text in one.component.references.iter().flat_map(|reference| &reference.targets) {
            // Components that stand together may all have the same one.
            if count < AT_ONCE && before != Some(&text.value) {
                targets[count] = (one.scope, text.as_str());
                count += 1;
                before = Some(&text.value);
            }
        }
    }
    fleet.by_name.warm(targets[..count].iter().copied(), &fleet.members);
}

fn key<'m>(member: &'m Member<'_>) -> (usize, &'m str) {
    (member.scope, &member.component.name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Diagnostics;
    use crate::load::load_file;
    use crate::source::Sources;

    #[test]
    fn the_last_of_each_name_is_found() {
        let components: String =
            (0..100).map(|number| format!("<component name='C{}'/>", number % 70)).collect();
        let text =
            format!("<composite xmlns='http://www.osoa.org/xmlns/sca/1.0' name='c'>{components}</composite>");
        let mut sources = Sources::new();
        let file = sources.add("c.composite", text);
        let composite = load_file(file, &sources, &mut Diagnostics::new()).unwrap();
        let scope = |place: usize| place % 2;
        let all = composite.components.iter().enumerate();
        let members: Vec<Member<'_>> =
            all.map(|(place, component)| Member::new(&composite, 0, scope(place), component)).collect();
        let mut table = ByName::default();
        assert_eq!(table.get(0, "C0", &members), None, "there are no slots");
        for place in 0..members.len() {
            table.insert(place, &members);
        }
        for (number, last) in (0..70).map(|number| (number, if number < 30 { number + 70 } else { number })) {
            let name = format!("C{number}");
            assert_eq!(table.get(scope(last), &name, &members), Some(last), "{name}");
            assert_eq!(table.get(1 - scope(last), &name, &members), None, "{name} in the other scope");
        }
        let mut places: Vec<usize> = table.places().collect();
        places.sort_unstable();
        assert_eq!(places, (30..100).collect::<Vec<_>>());
    }
}
