//! Parts that states share.

use std::cell::OnceCell;
use std::hash::{Hash, Hasher};
use std::ops::Deref;
use std::rc::Rc;

use super::hash;
use super::numbering::{Number, Numbered};

/// A part of a state. States share it until one of them changes it, so that a state costs what differs from the one
/// before, and not a copy and a hash of all that it has.
#[derive(Clone, Debug)]
pub(super) struct Part<T>(Rc<Content<T>>);

#[derive(Clone, Debug)]
struct Content<T> {
    value: T,
    /// What follows from the value, once somebody has asked for it.
    digest: OnceCell<u64>,
    numbers: OnceCell<Rc<[Number]>>,
}

impl<T> Deref for Part<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.0.value
    }
}

impl<T> From<T> for Part<T> {
    fn from(value: T) -> Part<T> {
        Part(Rc::new(Content { value, digest: OnceCell::new(), numbers: OnceCell::new() }))
    }
}

impl<T: Hash> Hash for Part<T> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.digest());
    }
}

impl<T: Hash> Part<T> {
    pub(super) fn digest(&self) -> u64 {
        *self.0.digest.get_or_init(|| hash(&self.0.value))
    }
}

impl<T: Clone> Part<T> {
    /// The part of this state alone, to be changed.
    pub(super) fn change(&mut self) -> &mut T {
        let content = Rc::make_mut(&mut self.0);
        (content.digest, content.numbers) = (OnceCell::new(), OnceCell::new());
        &mut content.value
    }
}

impl<T: Clone + Numbered> Part<T> {
    /// The numbers that it has. What makes no difference to it is forgotten meanwhile.
    pub(super) fn numbers(&mut self) -> Rc<[Number]> {
        if let Some(numbers) = self.0.numbers.get() {
            return Rc::clone(numbers);
        }
        let mut numbers = Vec::new();
        self.change().visit(&mut |number, is| numbers.push(number.being(*is)));
        let numbers: Rc<[Number]> = numbers.into();
        self.0.numbers.get_or_init(|| numbers).clone()
    }

    /// Gives it other numbers, where they differ.
    pub(super) fn renumber(&mut self, rank: impl Fn(Number) -> u64) {
        if self.numbers().iter().any(|number| rank(*number) != number.is) {
            self.change().visit(&mut |number, is| *is = rank(number.being(*is)));
        }
    }
}
