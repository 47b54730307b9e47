use std::fmt;
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

use crate::host::cdr;
use crate::rule::nearest;
use crate::{Failure, Field, Knowledge, Value};

/// An entry of a component's knowledge, to read it and to see whether it changed; from [`Entry::of`]. The default one
/// belongs to no knowledge: reading it is a failure with this reason.
///
/// Changes are seen by value: an entry that was changed and changed back between two looks has not changed. So a
/// change of an entry, as a rule a write to a field, costs nothing for its readers.
pub struct Entry<T> {
    place: u32,
    seen: Seen,
    of: PhantomData<fn() -> T>,
}

/// The value of an entry at the last look.
enum Seen {
    Value(Value),
    Bytes { seen: Vec<u8>, now: Vec<u8> },
}

impl<T: Field> Entry<T> {
    /// The entry of this name. Ask in [`initialize`](crate::Loop::initialize), keep what you get.
    ///
    /// # Errors
    /// There is no such entry (the message names the nearest), or it is of another type.
    pub fn of(knowledge: &dyn Knowledge, name: &str) -> Result<Entry<T>, Failure> {
        let Some((place, found)) = knowledge.all_declared().enumerate().find(|(_, entry)| entry.name == name) else {
            return Err(unknown(knowledge, name));
        };
        let wanted = T::TYPE.to_string();
        if found.of != wanted {
            let message = format!("entry `{name}` is of the type {}, and not {wanted}", found.of);
            return Err(Failure::new(message));
        }
        let mut entry = Entry { place: place as u32, ..Entry::default() };
        entry.changed(knowledge);
        Ok(entry)
    }

    /// The present value.
    ///
    /// # Errors
    /// The entry is of another knowledge, or of none.
    pub fn get(&self, knowledge: &dyn Knowledge) -> Result<T, Failure> {
        let stranger = || Failure::new("this entry is not one of this knowledge: ask for it in `initialize`");
        if let Some(value) = knowledge.value(self.place) {
            return T::of_value(value).ok_or_else(stranger);
        }
        let mut bytes = Vec::new();
        knowledge.bytes(self.place, &mut bytes).map_err(|_| stranger())?;
        cdr::decode(&bytes).map_err(|_| stranger())
    }

    /// True if the value differs from that of the last look: the last call of this function, or else the bind of the
    /// entry.
    ///
    /// An entry that is no single value is encoded for this; the memory for it is kept.
    pub fn changed(&mut self, knowledge: &dyn Knowledge) -> bool {
        if let Some(now) = knowledge.value(self.place) {
            let changed = !matches!(self.seen, Seen::Value(seen) if seen.is_same(now));
            self.seen = Seen::Value(now);
            return changed;
        }
        if !matches!(self.seen, Seen::Bytes { .. }) {
            self.seen = Seen::Bytes { seen: Vec::new(), now: Vec::new() };
        }
        let Seen::Bytes { seen, now } = &mut self.seen else { return false };
        now.clear();
        let found = knowledge.bytes(self.place, now).is_ok();
        std::mem::swap(seen, now);
        found && seen != now
    }
}

impl<T> Default for Entry<T> {
    fn default() -> Self {
        Entry { place: u32::MAX, seen: Seen::Value(Value::Nothing), of: PhantomData }
    }
}

impl<T> fmt::Debug for Entry<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Entry({})", self.place)
    }
}

/// An entry that a loop may change, from [`Effector::of`]; it can do what an [`Entry`] can.
pub struct Effector<T>(Entry<T>);

impl<T: Field> Effector<T> {
    /// The entry of this name. Only in [`initialize`](crate::Loop::initialize), and only what the loop declares under
    /// `effects` or `entries`.
    ///
    /// # Errors
    /// As [`Entry::of`], or the loop does not declare that it changes it.
    pub fn of(knowledge: &dyn Knowledge, name: &str) -> Result<Effector<T>, Failure> {
        let entry = Entry::of(knowledge, name)?;
        if !knowledge.extras().writable().has(name) {
            return Err(Failure::new(format!(
                "the loop does not declare that it changes entry `{name}`: write `effects(\"{name}\")`, and ask in \
                 `initialize`"
            )));
        }
        Ok(Effector(entry))
    }

    /// Changes it.
    ///
    /// # Errors
    /// The entry is of another knowledge, or of none.
    pub fn set(&self, knowledge: &mut dyn Knowledge, value: T) -> Result<(), Failure> {
        match value.as_value() {
            Some(value) => knowledge.set_value(self.0.place, value),
            None => knowledge.set_to_bytes(self.0.place, &cdr::encode(&value)),
        }
    }

    /// The change to this value, to be made later.
    pub(crate) fn change(&self, value: &T) -> Change {
        let to = value.as_value().map_or_else(|| ChangedTo::Bytes(cdr::encode(value)), ChangedTo::Value);
        Change { place: self.0.place, to }
    }
}

/// A change of an entry that is not made yet.
#[derive(Clone, Debug)]
pub(crate) struct Change {
    place: u32,
    to: ChangedTo,
}

#[derive(Clone, Debug)]
enum ChangedTo {
    Value(Value),
    Bytes(Vec<u8>),
}

impl Change {
    /// Makes it.
    pub(crate) fn make(&self, knowledge: &mut dyn Knowledge) -> Result<(), Failure> {
        match &self.to {
            ChangedTo::Value(value) => knowledge.set_value(self.place, *value),
            ChangedTo::Bytes(bytes) => knowledge.set_to_bytes(self.place, bytes),
        }
    }
}

impl<T> Default for Effector<T> {
    fn default() -> Self {
        Effector(Entry::default())
    }
}

impl<T> fmt::Debug for Effector<T> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Effector({})", self.0.place)
    }
}

impl<T> Deref for Effector<T> {
    type Target = Entry<T>;

    fn deref(&self) -> &Entry<T> {
        &self.0
    }
}

impl<T> DerefMut for Effector<T> {
    fn deref_mut(&mut self) -> &mut Entry<T> {
        &mut self.0
    }
}

fn unknown(knowledge: &dyn Knowledge, name: &str) -> Failure {
    let names = || knowledge.all_declared().map(|entry| entry.name);
    let hint = match nearest(name, names()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("the entries are {}", names().collect::<Vec<_>>().join(", ")),
    };
    Failure::new(format!("there is no entry `{name}`; {hint}"))
}
