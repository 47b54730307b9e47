//! The cells of a topic that its readers want. Whoever brings messages from elsewhere, as a network does, has to bring
//! no others.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use saoms_api::Region;

use super::regions::{Cell, cell_of};
use super::{Bus, TopicId, TopicReader};

/// Blocks around a region that are wanted with it: a reader that moves wants others now and then alone, and before its
/// region is there.
const MARGIN: i32 = 4;
/// A reader wants all where the cells of its region are more than these.
const MOST_CELLS: i64 = 1_024;
/// A reader whose region has become smaller gives up cells once they are so many times those of its region, and more
/// than a small region has with all around it.
const TOO_MANY: i64 = 4;
const FEW: i64 = 36;

/// Cells from one corner to the other, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cells {
    least: Cell,
    most: Cell,
}

impl Cells {
    /// Those of a region, and so many blocks around.
    fn of(region: &Region, margin: i32) -> Cells {
        let ((left, top), (right, bottom)) = (region.least(), region.most());
        Cells {
            least: cell_of((left.saturating_sub(margin), top.saturating_sub(margin))),
            most: cell_of((right.saturating_add(margin), bottom.saturating_add(margin))),
        }
    }

    fn count(&self) -> i64 {
        let side = |least: i32, most: i32| (i64::from(most) - i64::from(least) + 1).max(0);
        side(self.least.0, self.most.0).saturating_mul(side(self.least.1, self.most.1))
    }

    fn contain(&self, other: &Cells) -> bool {
        let (least, most) = (other.least, other.most);
        self.least.0 <= least.0 && self.least.1 <= least.1 && self.most.0 >= most.0 && self.most.1 >= most.1
    }

    fn each(self) -> impl Iterator<Item = Cell> {
        (self.least.1..=self.most.1).flat_map(move |y| (self.least.0..=self.most.0).map(move |x| (x, y)))
    }
}

/// What the readers of a topic want.
#[derive(Debug, Default)]
pub(super) struct Interest {
    /// The readers that want some cells alone.
    readers: HashMap<u32, Cells>,
    /// How many of them want each cell.
    cells: BTreeMap<Cell, u32>,
    has_changed: bool,
}

impl Interest {
    /// A reader has another region, or none.
    pub(super) fn set(&mut self, reader: u32, region: Option<&Region>) {
        let needed = region.map(|region| (region, Cells::of(region, 0)));
        let needed = needed.filter(|(_, cells)| cells.count() <= MOST_CELLS);
        let Some((region, cells)) = needed else { return self.remove(reader) };
        let is_fit = |before: &Cells| before.contain(&cells) && before.count() <= FEW.max(TOO_MANY * cells.count());
        if self.readers.get(&reader).is_some_and(is_fit) {
            return;
        }
        let wanted = Cells::of(region, MARGIN);
        wanted.each().for_each(|cell| *self.cells.entry(cell).or_default() += 1);
        let before = self.readers.insert(reader, wanted);
        self.give_up(before);
        self.has_changed = true;
    }

    /// A reader wants all, or is gone.
    pub(super) fn remove(&mut self, reader: u32) {
        let before = self.readers.remove(&reader);
        self.has_changed |= before.is_some();
        self.give_up(before);
    }

    fn give_up(&mut self, cells: Option<Cells>) {
        for cell in cells.into_iter().flat_map(Cells::each) {
            if let Some(readers) = self.cells.get_mut(&cell) {
                *readers -= 1;
                if *readers == 0 {
                    self.cells.remove(&cell);
                }
            }
        }
    }
}

impl Bus {
    /// Notes from now on what the readers of a topic want.
    pub fn note_interest(&mut self, topic: TopicId) {
        let topic = &mut self.topics[topic.0 as usize];
        topic.interest.get_or_insert_default().has_changed = true;
    }

    /// The cells of a topic that its readers want, or `None` for all of it, if that is noted and has changed since
    /// somebody asked last.
    pub fn changed_interest(&mut self, topic: TopicId) -> Option<Option<BTreeSet<Cell>>> {
        let topic = &mut self.topics[topic.0 as usize];
        let interest = topic.interest.as_mut().filter(|interest| interest.has_changed)?;
        interest.has_changed = false;
        // An observer of the topic hears all of it.
        let is_part = interest.readers.len() == topic.reading && topic.watching.is_empty();
        Some(is_part.then(|| interest.cells.keys().copied().collect()))
    }

    /// Notes whether an observer outside the fleet wants all of a topic.
    pub fn watch_all(&mut self, topic: TopicId, observer: u32, is_wanted: bool) {
        let topic = &mut self.topics[topic.0 as usize];
        topic.watching.retain(|other| *other != observer);
        topic.watching.extend(is_wanted.then_some(observer));
        if let Some(interest) = &mut topic.interest {
            interest.has_changed = true;
        }
    }

    pub(super) fn set_interest(&mut self, subscription: &TopicReader, region: Option<&Region>) {
        if let Some(interest) = &mut self.topics[subscription.topic.0 as usize].interest {
            interest.set(subscription.number, region);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(interest: &Interest) -> Vec<Cell> {
        interest.cells.keys().copied().collect()
    }

    #[test]
    fn what_several_readers_want_is_wanted_until_the_last_one_does_not() {
        let mut interest = Interest::default();
        interest.set(1, Some(&Region::new(6..=10, 6..=10)));
        interest.set(2, Some(&Region::new(6..=12, 6..=10)));
        assert_eq!(cells(&interest), [(0, 0), (1, 0)]);
        interest.set(2, None);
        assert_eq!(cells(&interest), [(0, 0)]);
        interest.remove(1);
        assert_eq!((cells(&interest), interest.readers.len()), (vec![], 0));
        interest.set(3, Some(&Region::new(i32::MIN..=i32::MAX, 0..=0)));
        assert_eq!((cells(&interest), interest.readers.len()), (vec![], 0), "it wants all");
    }

    #[test]
    fn a_reader_that_moves_changes_what_it_wants_now_and_then() {
        let (mut interest, mut changes) = (Interest::default(), 0);
        // It goes to and fro, and then far away.
        let way = (0..60).map(|time| 24 + [0, 1, 2, 3, 2, 1][time % 6]).chain(24..344);
        for x in way {
            let region = Region::around((x, 8), 12);
            interest.set(1, Some(&region));
            changes += u32::from(std::mem::take(&mut interest.has_changed));
            assert!(Cells::of(&region, 0).each().all(|cell| interest.cells.contains_key(&cell)), "{x}");
        }
        assert!((15..=45).contains(&changes), "{changes}");
        assert!(cells(&interest).len() <= 16);
        // Its region becomes larger, and small again.
        interest.set(1, Some(&Region::around((344, 8), 200)));
        assert!(cells(&interest).len() > 300);
        interest.set(1, Some(&Region::around((344, 8), 12)));
        assert!(cells(&interest).len() <= 16);
    }
}
