//! What a component does, as acts: once when it is recorded, and once when it is replayed.

use saoms_api::host::{Operation, Phase, SharedMessage};
use saoms_api::{Field, KeptByOther, KnownPublisher, Region, ReportValue, Work};

use super::{Act, ActKind};
use crate::journal::{Batch, Head};

impl Act {
    /// A record of the journal, by a loop of this name, or by none.
    pub(crate) fn record(head: &Head, batch: &Batch, by: &str) -> Act {
        let what = match (head.change, head.phase) {
            (true, _) => ActKind::Changed,
            (false, Phase::Symptom) => ActKind::Symptom,
            (false, Phase::Decision) => ActKind::Decision,
            (false, Phase::Effect) => ActKind::Effect,
        };
        Act::new(what, head.id.0, by).other(head.fingerprint).with(batch.record(head).to_string())
    }

    /// A message on a topic, by the name that the class has for it.
    pub(crate) fn sent(topic: &str, message: &SharedMessage) -> Act {
        let (key, cause) = (message.key().unwrap_or(u64::MAX), message.header().cause.0);
        Act::new(ActKind::Sent, key, topic).other(cause).with(message.bytes())
    }

    /// A call through a reference.
    pub(crate) fn called(reference: u32, operation: Operation, arguments: &[u8]) -> Act {
        Act::new(ActKind::Called, u64::from(reference), "").other(u64::from(operation)).with(arguments)
    }

    /// The region of a subscription.
    pub(crate) fn region(subscription: u32, region: Option<Region>) -> Act {
        let corners = region.map(|region| (region.least(), region.most()));
        let text = corners.map_or_else(String::new, |((x, y), (to_x, to_y))| format!("({x},{y}) to ({to_x},{to_y})"));
        Act::new(ActKind::Region, u64::from(subscription), "").with(text)
    }

    /// An alert that begins with a text, or is over.
    pub(crate) fn alert(kind: &str, subject: &str, text: Option<String>) -> Act {
        let name = if subject.is_empty() { kind.to_owned() } else { format!("{kind} {subject}") };
        Act::new(ActKind::Alert, u64::from(text.is_some()), &name).with(text.unwrap_or_default())
    }

    /// A value of the report.
    pub(crate) fn reported(path: &str, value: &ReportValue) -> Act {
        Act::new(ActKind::Reported, 0, path).with(value.to_string())
    }

    /// A number that is added to one of the report.
    pub(crate) fn counted(path: &str, more: i64) -> Act {
        Act::new(ActKind::Counted, 0, path).with(more.to_string())
    }

    /// A vote.
    pub(crate) fn voted(work: Work) -> Act {
        let name = match work {
            Work::Open => "open",
            Work::Done => "done",
            Work::GivenUp => "given up",
        };
        Act::new(ActKind::Voted, 0, name)
    }

    /// True if somebody who saw both would see the same: numbers of records and causes say nothing by themselves.
    pub(crate) fn is_same(&self, other: &Act) -> bool {
        let is_same = self.what == other.what && self.name == other.name;
        match self.what {
            what if what.is_record() => is_same && self.other == other.other,
            ActKind::Sent => is_same && self.number == other.number && self.bytes == other.bytes,
            _ => is_same && (self.number, self.other, &self.bytes) == (other.number, other.other, &other.bytes),
        }
    }
}

/// A publisher that a component knows.
#[derive(Clone, Copy, Debug, Field)]
pub(crate) struct PublisherForm {
    sender: u32,
    has_begun: bool,
    number: Option<u32>,
}

impl PublisherForm {
    pub(crate) fn of(publisher: &KnownPublisher) -> PublisherForm {
        let KnownPublisher { sender, has_begun, number } = *publisher;
        PublisherForm { sender, has_begun, number }
    }

    pub(crate) fn publisher(self) -> KnownPublisher {
        let PublisherForm { sender, has_begun, number } = self;
        KnownPublisher { sender, has_begun, number }
    }
}

/// What another component kept.
#[derive(Clone, Debug, Default, Field)]
pub(crate) struct KeptForm {
    keys: Vec<u64>,
    bytes: Vec<KeptBytes>,
    by_earlier_program: bool,
}

#[derive(Clone, Debug, Field)]
struct KeptBytes {
    bytes: Vec<u8>,
}

impl KeptForm {
    pub(crate) fn of(other: &KeptByOther<'_>) -> KeptForm {
        let bytes = other.kept.values().map(|bytes| KeptBytes { bytes: bytes.to_vec() }).collect();
        let by_earlier_program = other.by_earlier_program;
        KeptForm { keys: other.kept.keys().copied().collect(), bytes, by_earlier_program }
    }

    pub(crate) fn kept(&self) -> KeptByOther<'_> {
        let kept = self.keys.iter().copied().zip(self.bytes.iter().map(|one| one.bytes.as_slice())).collect();
        KeptByOther { kept, by_earlier_program: self.by_earlier_program }
    }
}
