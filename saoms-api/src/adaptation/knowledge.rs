use std::any::Any;

use super::entries::no_entry;
use crate::host::{DynEntries, EntryDeclaration};
use crate::{Effector, Entries, Entry, Extras, Failure, Field, Value};

/// Knowledge of a component: entries with a declared name and type.
///
/// Derive it on a struct, with `#[knowledge(name = "...")]`. Its fields are marked as those of [`Entries`] are, and one
/// field of type [`Extras`], marked `#[extras]`, takes what loops add. What is not marked is known to code that shares
/// the struct alone.
///
/// Loops that are built together with the component work on the struct itself. Others, such as those of a plugin, have
/// `type Knowledge = dyn Knowledge` and reach the entries by name, through an [`Entry`] or an [`Effector`].
///
/// ```
/// use saoms_api::{Entry, Extras, Knowledge};
///
/// /// What a lamp knows.
/// #[derive(Default, Knowledge)]
/// #[knowledge(name = "example.Lamp")]
/// struct LampKnowledge {
///     /// How bright it is around the lamp.
///     #[entry(unit = "lx")]
///     brightness: f64,
///     /// True if the lamp is on.
///     #[entry(effector)]
///     is_on: bool,
///     #[extras]
///     extras: Extras,
/// }
///
/// let mut lamp = LampKnowledge { brightness: 3.0, ..LampKnowledge::default() };
/// let mut brightness = Entry::<f64>::of(&lamp, "brightness")?;
/// assert_eq!(brightness.get(&lamp)?, 3.0);
/// lamp.brightness = 4.0;
/// assert!(brightness.changed(&lamp));
/// assert!(!brightness.changed(&lamp), "not since the last look");
///
/// let failure = Entry::<bool>::of(&lamp, "isNo").unwrap_err();
/// assert_eq!(failure.message(), "there is no entry `isNo`; did you mean `isOn`?");
/// # Ok::<(), saoms_api::Failure>(())
/// ```
pub trait Knowledge: DynEntries {
    /// Name and entries as JSON text; its shape is described in [`crate::host::declaration`]. What loops add is not in
    /// it.
    fn declaration(&self) -> &'static str;

    /// Entries added by loops.
    fn extras(&self) -> &Extras;

    /// Entries added by loops.
    fn extras_mut(&mut self) -> &mut Extras;
}

/// The constants of a [`Knowledge`], which its derive writes.
pub trait KnowledgeClass: Knowledge + Entries {
    /// The name by which loops declare the knowledge that they work on.
    const NAME: &'static str;
    /// See [`Knowledge::declaration`].
    const DECLARATION: &'static str;
}

impl dyn Knowledge {
    /// The entry of this name, to read it ([`Entry::of`]). Call it in [`initialize`](crate::Loop::initialize), and keep
    /// the result.
    ///
    /// # Errors
    /// There is no such entry (the message names the nearest), or it is of another type.
    pub fn entry<T: Field>(&self, name: &str) -> Result<Entry<T>, Failure> {
        Entry::of(self, name)
    }

    /// The entry of this name, to read and to change it ([`Effector::of`]). Only in
    /// [`initialize`](crate::Loop::initialize), and only entries that the loop declares under `effects` or `entries`.
    ///
    /// # Errors
    /// As [`entry`](#method.entry), or the loop does not declare that it changes it.
    pub fn effector<T: Field>(&self, name: &str) -> Result<Effector<T>, Failure> {
        Effector::of(self, name)
    }

    /// All entries in order: those of the component, then those that loops added. An entry is known by its place in
    /// here.
    pub fn all_declared(&self) -> impl Iterator<Item = &'static EntryDeclaration> {
        self.declared().iter().chain(self.extras().declared())
    }

    /// The value of the entry at this place; `None` for one that is no single value, or for none at all.
    pub fn value(&self, entry: u32) -> Option<Value> {
        match entry.checked_sub(self.declared().len() as u32) {
            None => self.get(entry),
            Some(entry) => self.extras().at(entry).and_then(|(group, entry)| group.get(entry)),
        }
    }

    /// Sets it.
    ///
    /// # Errors
    /// There is no such entry, it is no single value, or its type is another.
    pub fn set_value(&mut self, entry: u32, value: Value) -> Result<(), Failure> {
        match entry.checked_sub(self.declared().len() as u32) {
            None => self.set(entry, value),
            Some(extra) => match self.extras_mut().at_mut(extra) {
                Some((group, entry)) => group.set(entry, value),
                None => Err(no_entry(entry)),
            },
        }
    }

    /// Replaces `bytes` by the entry at this place, as [CDR](crate::host::cdr).
    ///
    /// # Errors
    /// There is no such entry.
    pub fn bytes(&self, entry: u32, bytes: &mut Vec<u8>) -> Result<(), Failure> {
        match entry.checked_sub(self.declared().len() as u32) {
            None => self.get_bytes(entry, bytes),
            Some(extra) => match self.extras().at(extra) {
                Some((group, entry)) => group.get_bytes(entry, bytes),
                None => Err(no_entry(entry)),
            },
        }
    }

    /// Sets the entry at this place from [CDR](crate::host::cdr).
    ///
    /// # Errors
    /// There is no such entry, or these are not the bytes of one.
    pub fn set_to_bytes(&mut self, entry: u32, bytes: &[u8]) -> Result<(), Failure> {
        match entry.checked_sub(self.declared().len() as u32) {
            None => self.set_bytes(entry, bytes),
            Some(extra) => match self.extras_mut().at_mut(extra) {
                Some((group, entry)) => group.set_bytes(entry, bytes),
                None => Err(no_entry(entry)),
            },
        }
    }

    /// Appends the values of all entries, [`Value::Nothing`] for those that are no single values, or quiet.
    pub fn values(&self, values: &mut Vec<Value>) {
        self.read(values);
        self.extras().groups().for_each(|group| group.read(values));
    }
}

/// The knowledge that a [`Loop`](crate::Loop) works on: a struct that is [`Knowledge`], or `dyn Knowledge`.
pub trait Subject {
    /// The knowledge as this type, if it is of this type.
    fn of(knowledge: &mut dyn Knowledge) -> Option<&mut Self>;

    /// The name of the knowledge; `None` for `dyn Knowledge`.
    const NAME: Option<&'static str>;
}

impl Subject for dyn Knowledge {
    fn of(knowledge: &mut dyn Knowledge) -> Option<&mut Self> {
        Some(knowledge)
    }

    const NAME: Option<&'static str> = None;
}

impl<K: KnowledgeClass> Subject for K {
    #[inline]
    fn of(knowledge: &mut dyn Knowledge) -> Option<&mut Self> {
        let knowledge: &mut dyn Any = knowledge;
        knowledge.downcast_mut()
    }

    const NAME: Option<&'static str> = Some(<K as KnowledgeClass>::NAME);
}
