use saoms_api::host::SharedMessage;

use crate::bus::{Bus, TopicReader, Watch};

/// The last collection of the messages of a component. Most subscriptions have no news most of the time; what they
/// take in memory is far more than these few numbers, which say that there is none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Collection {
    /// Number of messages that the bus had had; 0 if the next collection has to look at each subscription.
    pub(crate) published: u64,
    /// Where to see whether subscriptions have news; `None` for those that trigger reactions.
    pub(crate) watched: Vec<Option<Watch>>,
    pub(crate) filled: Filled,
}

/// The inboxes that may have messages: a bit for each of the first, and always those beyond.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Filled(u64);

impl Default for Filled {
    fn default() -> Filled {
        Filled(u64::MAX)
    }
}

impl Collection {
    /// Number of messages that the bus had had at the last collection, if it says where to look for news.
    #[inline]
    pub(crate) fn since(&self, bus: &Bus) -> Option<u64> {
        (self.published > 0 && self.published >= bus.relinked()).then_some(self.published)
    }

    /// True if a subscription has nothing to collect since the last collection.
    #[inline]
    pub(crate) fn is_quiet(&self, place: usize, bus: &Bus, since: u64) -> bool {
        self.watched.get(place).is_some_and(|watched| watched.is_none_or(|watch| bus.is_quiet(watch, since)))
    }

    /// Notes where to look for news from now on.
    pub(crate) fn watch(&mut self, subscriptions: &[TopicReader], bus: &Bus) {
        self.watched.clear();
        let watch = |reader| (!bus.is_trigger(reader)).then(|| bus.watch(reader));
        self.watched.extend(subscriptions.iter().map(watch));
    }

    /// Has the next collection look at each subscription: one of them changed, or what it collected was put back.
    pub(crate) fn reset(&mut self) {
        self.published = 0;
        self.filled = Filled::default();
    }
}

impl Filled {
    #[inline]
    pub(crate) fn note(&mut self, place: usize) {
        self.0 |= 1u64.checked_shl(place as u32).unwrap_or(0);
    }

    #[inline]
    pub(crate) fn bits(self) -> u64 {
        self.0
    }

    /// Clears the inboxes.
    #[inline]
    pub(crate) fn clear(&mut self, inboxes: &mut [Vec<SharedMessage>]) {
        let mut bits = std::mem::take(&mut self.0);
        while bits != 0 {
            if let Some(inbox) = inboxes.get_mut(bits.trailing_zeros() as usize) {
                inbox.clear();
            }
            bits &= bits - 1;
        }
        inboxes.iter_mut().skip(u64::BITS as usize).for_each(Vec::clear);
    }
}
