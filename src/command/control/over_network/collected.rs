//! The parts of an answer, put into their order.

use std::collections::BTreeMap;

use saoms_core::network::control::Answer;

/// Parts that wait for an earlier one, at most: then that one is given up.
const MOST_WAITING: usize = 2_048;

/// The answer of a program, as far as it has arrived.
#[derive(Debug, Default)]
pub(super) struct Collected {
    pub(super) name: String,
    pub(super) status: u32,
    /// The number of the next part.
    pub(super) next: u32,
    /// True if all of it is there.
    pub(super) is_whole: bool,
    waiting: BTreeMap<u32, Answer>,
    /// Parts that will not come.
    pub(super) lost: u64,
}

impl Collected {
    /// Takes a part. Gives the texts that follow now, in order.
    pub(super) fn take(&mut self, answer: Answer) -> Vec<String> {
        if answer.part < self.next {
            return Vec::new();
        }
        if self.name.is_empty() {
            self.name.clone_from(&answer.name);
        }
        self.status = answer.status;
        self.waiting.insert(answer.part, answer);
        if self.waiting.len() > MOST_WAITING
            && let Some((first, _)) = self.waiting.first_key_value()
        {
            self.lost += u64::from(first - self.next);
            self.next = *first;
        }
        let mut texts = Vec::new();
        while let Some(answer) = self.waiting.remove(&self.next) {
            self.next += 1;
            self.is_whole |= answer.is_last;
            texts.push(answer.body);
        }
        texts
    }

    /// True if it is no refusal.
    pub(super) fn is_accepted(&self) -> bool {
        (200..300).contains(&self.status)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_come_in_their_order_once() {
        let part = |part, body: &str, is_last| Answer { part, body: body.to_owned(), is_last, ..Answer::default() };
        let mut collected = Collected::default();
        assert!(collected.take(part(1, "b", false)).is_empty());
        assert_eq!(collected.take(part(0, "a", false)), ["a", "b"]);
        assert!(collected.take(part(1, "b", false)).is_empty() && !collected.is_whole);
        assert_eq!(collected.take(part(2, "c", true)), ["c"]);
        assert!(collected.is_whole && collected.lost == 0);
    }
}
