use saoms_abi::{Bytes, TopicView};

use crate::Failure;
use crate::boundary::null::given;
use crate::host::{TopicDeclaration, TopicKind};

/// The view of a topic.
pub(in crate::boundary) const fn topic_view(topic: &TopicDeclaration<'_>) -> TopicView {
    TopicView {
        name: Bytes::text(topic.name),
        message: Bytes::text(topic.message),
        schema: Bytes::text(topic.schema),
        kind: match topic.kind {
            TopicKind::State => 0,
            TopicKind::Event => 1,
        },
    }
}

/// The topic behind a view.
///
/// # Errors
/// A text cannot be read, or the kind is unknown.
///
/// # Safety
/// The view and its texts are readable.
pub(in crate::boundary) unsafe fn read_topic<'a>(view: *const TopicView) -> Result<TopicDeclaration<'a>, Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        let TopicView { name, message, schema, kind } = *given(view, "a topic")?;
        let kind = match kind {
            0 => TopicKind::State,
            1 => TopicKind::Event,
            other => {
                return Err(Failure::new(format!("found {other} for the kind of a topic, expected 0 or 1")));
            }
        };
        Ok(TopicDeclaration { name: name.get_text()?, kind, message: message.get_text()?, schema: schema.get_text()? })
    }
}
