use std::any::Any;

use crate::{Failure, Value};

/// What a component knows, as entries that have a declared name and type. `#[derive(Knowledge)]` writes it for a struct.
///
/// Loops that are built together with the component work on the struct itself. Others, such as those of a plugin, have
/// `type Knowledge = dyn Knowledge` and reach the entries by name.
pub trait Knowledge: Any + Send {
    /// The entries as JSON text; its shape is described in [`crate::declaration`].
    fn declaration(&self) -> &'static str;

    /// The value of the entry at this place of the declaration; `None` for one that is no single value, or for none at all.
    fn get(&self, entry: u32) -> Option<Value>;

    /// Sets it.
    ///
    /// # Errors
    /// There is no such entry, or its type is another.
    fn set(&mut self, entry: u32, value: Value) -> Result<(), Failure>;
}

/// What a [`Loop`](crate::Loop) works on: a struct that is [`Knowledge`], or `dyn Knowledge`.
pub trait Subject {
    /// The knowledge as this type, if it is of this type.
    fn of(knowledge: &mut dyn Knowledge) -> Option<&mut Self>;
}

impl Subject for dyn Knowledge {
    fn of(knowledge: &mut dyn Knowledge) -> Option<&mut Self> {
        Some(knowledge)
    }
}

impl<K: Knowledge> Subject for K {
    #[inline]
    fn of(knowledge: &mut dyn Knowledge) -> Option<&mut Self> {
        let knowledge: &mut dyn Any = knowledge;
        knowledge.downcast_mut()
    }
}
