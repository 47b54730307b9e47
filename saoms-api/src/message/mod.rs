mod region;
pub(crate) mod topic;

use std::any::Any;
use std::fmt;
use std::mem::{self, ManuallyDrop};
use std::panic::{self, AssertUnwindSafe};
use std::slice;
use std::sync::{Arc, OnceLock};

use crate::host::cdr;
use crate::host::contain::discard;
use crate::{Cause, Field, Time};

pub use region::{Departed, Region};
pub use topic::{KnownPublisher, Publisher, Subscription, Topic};

/// A message between components. Derive it: `#[derive(Clone, Debug, Message)]` on a struct whose fields are of the
/// types that [`Field`] lists. `#[message(...)]` takes
///
/// | attribute | meaning |
/// | --- | --- |
/// | `key = "field"` | the integer field that is the key of a state topic |
/// | `place = "block"` | the field that is the block of the message, a struct with `#[field(pair)]`: subscriptions can
/// receive a [region](crate::Context::set_region) alone |
/// | `speaker("robot", unless(stage = "REQUEST"))` | an integer field that [names the speaker](#who-speaks) |
/// | `name = "sensor_msgs/msg/LaserScan"` | the name, if it is not that of the struct |
/// | `constants(NO_FIX: i8 = -1, FIX: i8 = 0)` | constants of the struct, which stand in the schema, too |
///
/// ```
/// use saoms_api::{Message, builtin_interfaces};
///
/// /// A position with its quality, as a receiver of satellites gives it.
/// #[derive(Clone, Debug, Message)]
/// #[message(constants(
///     /// There is no position.
///     NO_FIX: i8 = -1,
///     FIX: i8 = 0,
/// ))]
/// struct Fix {
///     stamp: builtin_interfaces::Time,
///     status: i8,
///     /// Of longitude and latitude, row by row.
///     covariance: [f64; 4],
/// }
///
/// let none = Fix { stamp: Default::default(), status: Fix::NO_FIX, covariance: [0.0; 4] };
/// assert_eq!(none.status, -1);
/// ```
///
/// # Who speaks
/// A field that is a `speaker` holds the number of the component that sends the message: one of its
/// [properties](crate::Properties) is `speaker`, too. A message from outside the fleet in the name of a component of
/// the fleet is refused. With `only(field = "CONSTANT")` the field names the speaker in such messages alone, with
/// `unless(...)` in all others. `instead` ends the sentence that tells an operator what to do instead.
/// ```
/// use saoms_api::{Field, Message};
///
/// #[derive(Clone, Copy, Debug, Field)]
/// enum Stage {
///     Request,
///     Taken,
/// }
///
/// /// A job: a request without a number, or the answer of the robot that takes it.
/// #[derive(Clone, Debug, Message)]
/// #[message(speaker("robot", unless(stage = "REQUEST"), instead = "send a request"))]
/// struct Job {
///     robot: u32,
///     stage: Stage,
/// }
///
/// let speakers = r#"[{"field":"robot","unless":{"stage":"REQUEST"},"instead":"send a request"}]"#;
/// assert_eq!(Job::SPEAKERS, speakers);
/// ```
pub trait Message: Field + Clone + fmt::Debug + Send + Sync + 'static {
    /// The name of the type, as tools show it.
    const NAME: &'static str;
    /// The schema as text, in the terms of ROS 2 interfaces. Equal text, equal encoding.
    const SCHEMA: &'static str;

    /// The key under which a state topic keeps this message, beside those of other keys and of other publishers; `None`
    /// keeps one message per publisher.
    fn key(&self) -> Option<u64> {
        None
    }

    /// The fields that say who speaks, as the `speakers` of a [declaration](crate::host::declaration); empty where
    /// there is none.
    const SPEAKERS: &'static str = "";

    /// True if messages of this type have a block.
    const HAS_PLACE: bool = false;

    /// Column and row of the block of the message, where the type declares a `place`.
    fn place(&self) -> Option<(i32, i32)> {
        None
    }
}

/// An integer that can be the key of a state topic.
pub trait Key: Copy {
    /// The key; negative numbers have their place too.
    fn key(self) -> u64;
}

macro_rules! keys {
    ($($type:ty),*) => {
        $(impl Key for $type {
            fn key(self) -> u64 {
                self as u64
            }
        })*
    };
}

keys!(i8, i16, i32, i64, u8, u16, u32, u64);

/// For generated code: true if a field is a single value of two numbers. Runs at compile time.
pub const fn is_pair(value: &str) -> bool {
    crate::property::equal(value.as_bytes(), b"pair")
}

/// For generated code: the two numbers of such a value.
#[inline]
pub fn pair_of(value: Option<crate::Value>) -> Option<(i32, i32)> {
    match value {
        Some(crate::Value::Pair(x, y)) => Some((x, y)),
        _ => None,
    }
}

/// Sender, time and cause of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// The sender's index in the running fleet.
    pub sender: u32,
    /// Due time of the execution that sent it.
    pub sent: Time,
    /// The record of the journal with the reason for which it was sent.
    pub cause: Cause,
}

/// The index of the first sender of another program. Those of this one have indices from 0.
pub const FIRST_ELSEWHERE: u32 = 1 << 31;

impl Header {
    /// True if the sender is a component of another program.
    pub const fn is_from_elsewhere(&self) -> bool {
        is_elsewhere(self.sender)
    }
}

/// True if the component of this index runs in another program. The greatest index is that of events from outside.
const fn is_elsewhere(sender: u32) -> bool {
    sender >= FIRST_ELSEWHERE && sender != u32::MAX
}

/// A message on its way: one value, shared by all its readers, encoded at most once and only where it leaves this build
/// of the program.
#[derive(Clone)]
pub struct SharedMessage(Arc<Shared<dyn Payload>>);

/// Layout of a message: the fields that every message has stand before its value, so that they are found without
/// knowing the type.
struct Shared<P: ?Sized> {
    header: Header,
    key: Option<u64>,
    place: Option<(i32, i32)>,
    /// The number of the only component that receives it; `u32::MAX` where all readers of its topic do.
    to: u32,
    bytes: OnceLock<Vec<u8>>,
    forms: OnceLock<Box<Form>>,
    payload: P,
}

/// The receiver of a message for all readers of its topic: no component has this number.
const EVERYONE: u32 = u32::MAX;

impl SharedMessage {
    /// Shares a value.
    pub fn new<M: Message>(header: Header, value: M) -> SharedMessage {
        let (bytes, forms) = (OnceLock::new(), OnceLock::new());
        let (key, place) = (value.key(), value.place());
        SharedMessage(Arc::new(Shared { header, key, place, to: EVERYONE, bytes, forms, payload: Typed::new(value) }))
    }

    /// Takes over a message that arrived as bytes (see [`cdr`]). The schema must have been checked against the topic's.
    pub fn from_bytes(header: Header, key: Option<u64>, bytes: Vec<u8>) -> SharedMessage {
        let (bytes, forms) = (OnceLock::from(bytes), OnceLock::new());
        SharedMessage(Arc::new(Shared { header, key, place: None, to: EVERYONE, bytes, forms, payload: Arrived }))
    }

    /// The same message with this key and block, which its bytes say.
    #[must_use]
    pub fn of(mut self, key: Option<u64>, place: Option<(i32, i32)>) -> SharedMessage {
        // Nobody shares a message that was made just now.
        if let Some(shared) = Arc::get_mut(&mut self.0) {
            (shared.key, shared.place) = (key, place);
        }
        self
    }

    /// For hosts: the same message for one of the components that read its topic, by the component's number.
    #[must_use]
    pub fn only_to(mut self, to: Option<u32>) -> SharedMessage {
        // Nobody shares a message that was made just now.
        if let Some(shared) = Arc::get_mut(&mut self.0) {
            shared.to = to.unwrap_or(EVERYONE);
        }
        self
    }

    /// The number of the only component that receives it; `None` where all readers of its topic do.
    #[inline]
    pub fn to(&self) -> Option<u32> {
        Some(self.0.to).filter(|to| *to != EVERYONE)
    }

    /// Column and row of its block, if its type declares a place.
    pub fn place(&self) -> Option<(i32, i32)> {
        self.0.place
    }

    /// Sender, time and cause.
    pub fn header(&self) -> Header {
        self.0.header
    }

    /// For hosts: a number that all copies of one message have, and no other message while one of them lives.
    pub fn address(&self) -> usize {
        Arc::as_ptr(&self.0).cast::<()>().addr()
    }

    /// For hosts: whether it was shared as a value. Bytes that came from elsewhere are to be checked before they are
    /// passed on.
    pub fn is_value(&self) -> bool {
        self.0.payload.schema().is_some()
    }

    /// Its key on a state topic, if the message type has one.
    pub fn key(&self) -> Option<u64> {
        self.0.key
    }

    /// The value as this Rust type. A message that arrived as bytes, or was sent by code built with another copy of the
    /// type, is decoded once, however many readers there are. `None` when it was sent with another schema, or its bytes
    /// are not such a message. What arrived as bytes says nothing of its schema: ask for the type of its topic.
    #[inline]
    pub fn get<M: Message>(&self) -> Option<&M> {
        let payload: &dyn Any = &self.0.payload;
        match payload.downcast_ref::<Typed<M>>() {
            Some(typed) => Some(&typed.0),
            None if self.0.payload.schema().is_some_and(|schema| schema != M::SCHEMA) => None,
            None => decoded(&self.0.forms, self.bytes()),
        }
    }

    /// The CDR form, encoded at the first call.
    pub fn bytes(&self) -> &[u8] {
        self.0.bytes.get_or_init(|| {
            let mut bytes = Vec::with_capacity(64);
            self.0.payload.encode(&mut bytes);
            bytes
        })
    }

    /// The CDR form in a reused buffer: its content is replaced, its memory is kept. For uses that need the bytes only
    /// in passing.
    pub fn encode_into(&self, bytes: &mut Vec<u8>) {
        match self.0.bytes.get() {
            Some(encoded) => bytes.clone_from(encoded),
            None => self.0.payload.encode(bytes),
        }
    }
}

impl fmt::Debug for SharedMessage {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "SharedMessage({:?})", self.header())
    }
}

/// The value of a message, whatever its type.
trait Payload: Any + Send + Sync {
    fn encode(&self, bytes: &mut Vec<u8>);

    /// The schema of a value; `None` where there are bytes alone.
    fn schema(&self) -> Option<&'static str>;
}

/// A value of this build of the program. Hosts drop messages in the midst of their own work, so a panic of the value's
/// destructor ends there.
struct Typed<M>(ManuallyDrop<M>);

impl<M> Typed<M> {
    fn new(value: M) -> Typed<M> {
        Typed(ManuallyDrop::new(value))
    }
}

impl<M> Drop for Typed<M> {
    #[inline]
    fn drop(&mut self) {
        if mem::needs_drop::<M>() {
            // SAFETY: the value is not used again.
            let dropped = panic::catch_unwind(AssertUnwindSafe(|| unsafe { ManuallyDrop::drop(&mut self.0) }));
            if let Err(payload) = dropped {
                discard(payload);
            }
        }
    }
}

impl<M: Message> Payload for Typed<M> {
    fn encode(&self, bytes: &mut Vec<u8>) {
        cdr::encode_into(&*self.0, bytes);
    }

    fn schema(&self) -> Option<&'static str> {
        Some(M::SCHEMA)
    }
}

/// A value that is there as bytes alone.
struct Arrived;

impl Payload for Arrived {
    fn encode(&self, bytes: &mut Vec<u8>) {
        bytes.clear();
    }

    fn schema(&self) -> Option<&'static str> {
        None
    }
}

/// A decoded form, and those of other Rust types: as a rule there is one.
struct Form {
    value: Box<dyn Any + Send + Sync>,
    next: OnceLock<Box<Form>>,
}

fn decoded<'a, M: Message>(mut forms: &'a OnceLock<Box<Form>>, bytes: &[u8]) -> Option<&'a M> {
    let mut own: Option<Box<Form>> = None;
    loop {
        // Another thread may add a form at any time, of this type or another: the first one of a type is everybody's.
        while let Some(form) = forms.get() {
            match form.value.downcast_ref::<Typed<M>>() {
                Some(value) => return Some(&value.0),
                None => forms = &form.next,
            }
        }
        let form = match own.take() {
            Some(form) => form,
            None => {
                Box::new(Form { value: Box::new(Typed::new(cdr::decode::<M>(bytes).ok()?)), next: OnceLock::new() })
            }
        };
        own = forms.set(form).err();
    }
}

/// The messages of one topic in one period, oldest first, from [`Context::receive`](crate::Context::receive).
#[derive(Debug)]
pub struct Messages<'a, M> {
    shared: slice::Iter<'a, SharedMessage>,
    message: std::marker::PhantomData<fn() -> M>,
}

impl<'a, M: Message> Messages<'a, M> {
    pub(crate) fn new(shared: &'a [SharedMessage]) -> Self {
        Messages { shared: shared.iter(), message: std::marker::PhantomData }
    }

    /// The messages with their senders and times.
    pub fn with_headers(self) -> impl DoubleEndedIterator<Item = (Header, &'a M)> {
        self.shared.filter_map(|shared| Some((shared.header(), shared.get::<M>()?)))
    }
}

impl<M> Clone for Messages<'_, M> {
    fn clone(&self) -> Self {
        Messages { shared: self.shared.clone(), message: std::marker::PhantomData }
    }
}

impl<'a, M: Message> Iterator for Messages<'a, M> {
    type Item = &'a M;

    fn next(&mut self) -> Option<&'a M> {
        self.shared.by_ref().find_map(SharedMessage::get)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (0, self.shared.size_hint().1)
    }
}

impl<'a, M: Message> DoubleEndedIterator for Messages<'a, M> {
    fn next_back(&mut self) -> Option<&'a M> {
        self.shared.by_ref().rev().find_map(SharedMessage::get)
    }
}
