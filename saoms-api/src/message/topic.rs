use std::fmt;
use std::marker::PhantomData;

use super::is_elsewhere;
use crate::Message;

/// Delivery guarantee of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TopicKind {
    /// Keeps the newest message of each key; a reader that comes later gets those. The key is [`Message::key`], or the
    /// publisher.
    State,
    /// Loses nothing: every message reaches every reader, in order, through a bounded queue whose overflow is counted
    /// and reported.
    Event,
}

impl TopicKind {
    /// `state` or `event`, as declarations say it.
    pub const fn name(self) -> &'static str {
        match self {
            TopicKind::State => "state",
            TopicKind::Event => "event",
        }
    }
}

/// A named channel for messages of one type. Make it a constant, and name it in `#[class(publishes(...),
/// subscribes(...))]`.
pub struct Topic<M> {
    name: &'static str,
    kind: TopicKind,
    is_optional: bool,
    message: PhantomData<fn() -> M>,
}

impl<M: Message> Topic<M> {
    /// A topic that keeps the newest message of each key.
    pub const fn state(name: &'static str) -> Topic<M> {
        Topic { name, kind: TopicKind::State, is_optional: false, message: PhantomData }
    }

    /// A topic that loses no message.
    pub const fn event(name: &'static str) -> Topic<M> {
        Topic { name, kind: TopicKind::Event, is_optional: false, message: PhantomData }
    }

    /// The same topic as optional: the wiring report does not warn if it has no reader.
    ///
    /// ```
    /// # use saoms_api::{Message, Topic};
    /// # #[derive(Clone, Debug, Message)] struct Collision { x: u32 }
    /// pub const COLLISION: Topic<Collision> = Topic::event("COLLISIONTOPIC").optional();
    /// assert!(COLLISION.is_optional());
    /// ```
    pub const fn optional(self) -> Topic<M> {
        Topic { is_optional: true, ..self }
    }

    /// The name before any `topicRename`.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// State or event.
    pub const fn kind(&self) -> TopicKind {
        self.kind
    }

    /// True if the topic needs no reader.
    pub const fn is_optional(&self) -> bool {
        self.is_optional
    }

    /// The schema of its messages, for the declaration of a class.
    pub const fn schema(&self) -> &'static str {
        M::SCHEMA
    }

    /// The fields of its messages that say who speaks, for the declaration of a class.
    pub const fn speakers(&self) -> &'static str {
        M::SPEAKERS
    }

    /// The declaration for the host when a component publishes or subscribes.
    pub const fn declaration(&self) -> TopicDeclaration<'static> {
        TopicDeclaration { name: self.name, kind: self.kind, message: M::NAME, schema: M::SCHEMA }
    }
}

impl<M> fmt::Debug for Topic<M> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Topic({}, {})", self.name, self.kind.name())
    }
}

/// A topic without its Rust type, as it crosses the boundary to the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TopicDeclaration<'a> {
    /// The name before any `topicRename`.
    pub name: &'a str,
    /// State or event.
    pub kind: TopicKind,
    /// The name of the message type.
    pub message: &'a str,
    /// The schema of the message type: two ends agree when these are equal.
    pub schema: &'a str,
}

/// The right to send on a topic, from [`Context::publish`](crate::Context::publish). The default one belongs to no
/// topic: sending with it is a failure with this reason.
pub struct Publisher<M> {
    index: u32,
    message: PhantomData<fn() -> M>,
}

/// The right to read a topic, from [`Context::subscribe`](crate::Context::subscribe). The default one belongs to no
/// topic and receives nothing.
pub struct Subscription<M> {
    index: u32,
    message: PhantomData<fn() -> M>,
}

macro_rules! handle {
    ($name:ident) => {
        impl<M> $name<M> {
            pub(crate) const fn new(index: u32) -> Self {
                $name { index, message: PhantomData }
            }

            pub(crate) const fn index(&self) -> u32 {
                self.index
            }
        }

        impl<M> Default for $name<M> {
            fn default() -> Self {
                $name::new(u32::MAX)
            }
        }

        impl<M> Clone for $name<M> {
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<M> Copy for $name<M> {}

        impl<M> fmt::Debug for $name<M> {
            fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(formatter, concat!(stringify!($name), "({})"), self.index)
            }
        }
    };
}

handle!(Publisher);
handle!(Subscription);

/// A component that may publish on a topic. See [`Context::publishers`](crate::Context::publishers).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KnownPublisher {
    /// Its index in the running fleet, as in [`Header::sender`](crate::Header::sender).
    pub sender: u32,
    /// True if it was ever scheduled.
    pub has_begun: bool,
    /// Number by which it says who speaks in messages, where its class has one.
    pub number: Option<u32>,
}

impl KnownPublisher {
    /// True if it runs in another program.
    pub fn is_elsewhere(&self) -> bool {
        is_elsewhere(self.sender)
    }
}
