use saoms_api::event::Word;
use saoms_api::event::fault::{is_named, names_component};

use super::End;
use crate::bus::TopicId;

/// Which of many numbered things are named by patterns; each is compared once.
#[derive(Clone, Debug, Default)]
pub(super) struct Named {
    /// Without any, all are.
    patterns: Vec<String>,
    known: Vec<Option<bool>>,
}

impl Named {
    pub(super) fn by<'w>(words: impl IntoIterator<Item = &'w Word>) -> Named {
        Named { patterns: words.into_iter().map(|word| word.text.clone()).collect(), known: Vec::new() }
    }

    /// True if this topic is named.
    pub(super) fn has_topic(&mut self, topic: TopicId, name: &str) -> bool {
        self.has(topic.number(), |pattern| is_named(pattern, name))
    }

    /// True if this component is named.
    pub(super) fn has_end(&mut self, end: End<'_>) -> bool {
        self.has(end.number, |pattern| names_component(pattern, end.path, end.node))
    }

    fn has(&mut self, number: u32, is_named: impl Fn(&str) -> bool) -> bool {
        if self.patterns.is_empty() {
            return true;
        }
        let place = number as usize;
        if self.known.len() <= place {
            self.known.resize(place + 1, None);
        }
        let patterns = &self.patterns;
        *self.known[place].get_or_insert_with(|| patterns.iter().any(|pattern| is_named(pattern)))
    }
}
