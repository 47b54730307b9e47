use saoms_api::event::Word;
use saoms_api::event::fault::is_named;

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

    /// True if the thing with this number and path is named.
    pub(super) fn has(&mut self, number: u32, path: &str) -> bool {
        if self.patterns.is_empty() {
            return true;
        }
        let place = number as usize;
        if self.known.len() <= place {
            self.known.resize(place + 1, None);
        }
        let patterns = &self.patterns;
        *self.known[place].get_or_insert_with(|| patterns.iter().any(|pattern| is_named(pattern, path)))
    }
}
