use std::fmt;
use std::sync::{Arc, OnceLock};

/// The paths of components by their numbers: numbers are only added, and read without a lock.
#[derive(Default)]
pub(super) struct SlotNames {
    page: Vec<Arc<str>>,
    next: OnceLock<Box<SlotNames>>,
}

impl SlotNames {
    /// Gives the next numbers to these components.
    pub(super) fn add(&self, names: Vec<Arc<str>>) {
        let mut rest = Box::new(SlotNames { page: names, next: OnceLock::new() });
        let mut last = self;
        while let Err(back) = last.next.set(rest) {
            rest = back;
            match last.next.get() {
                Some(next) => last = next,
                None => return,
            }
        }
    }

    pub(super) fn get(&self, number: u32) -> Option<&Arc<str>> {
        let (mut page, mut place) = (self, number as usize);
        loop {
            match page.page.get(place) {
                Some(name) => return Some(name),
                None => (place, page) = (place - page.page.len(), page.next.get()?),
            }
        }
    }
}

impl fmt::Debug for SlotNames {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_list().entries((0..).map_while(|number| self.get(number))).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_by_number_on_all_pages() {
        let names = SlotNames::default();
        assert_eq!(names.get(0), None);
        for page in [vec!["A", "B"], vec![], vec!["C"]] {
            names.add(page.into_iter().map(Arc::from).collect());
        }
        let found: Vec<_> = (0..4).map(|number| names.get(number).map(|name| &**name)).collect();
        assert_eq!(found, [Some("A"), Some("B"), Some("C"), None]);
    }
}
