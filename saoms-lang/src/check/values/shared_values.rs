//! The values of a property as all who take them share them, with what paths led to in them: a fleet can give one long
//! value on through many composites, and take each of its parts in one of these.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use super::path::{Fault, one_of, steps};
use super::path_index::PathIndex;
use super::raw::{Piece, Raw};
use crate::model::Property;

/// The values of a property.
pub(crate) struct SharedValues<'a> {
    raw: Raw<'a>,
    /// The same with a value for each element, where it is a property that takes several of one.
    split: Option<Raw<'a>>,
    /// The content of all of them, or of the one at a place, once a path led into it.
    levels: RefCell<HashMap<Option<usize>, Rc<PathIndex<'a>>>>,
}

impl<'a> SharedValues<'a> {
    /// Values that no property declares.
    pub(crate) fn new(raw: Raw<'a>) -> Rc<Self> {
        Rc::new(Self { raw, split: None, levels: RefCell::default() })
    }

    /// Values of a property of this declaration.
    pub(crate) fn of(raw: Raw<'a>, property: &Property) -> Rc<Self> {
        let split = raw.is_split_by(property).then(|| raw.clone().split_into_elements_of(property));
        Rc::new(Self { raw, split, levels: RefCell::default() })
    }

    /// These values as those of a property of this declaration.
    pub(crate) fn given_to(self: Rc<Self>, property: &Property) -> Rc<Self> {
        match self.split.is_none() && !self.raw.is_split_by(property) {
            true => self,
            false => Self::of(self.raw.clone(), property),
        }
    }

    /// These values as components take them from a property of this declaration.
    pub(crate) fn inside_elements_of(self: Rc<Self>, property: &Property) -> Rc<Self> {
        match property.element() {
            Some(_) => Self::new(self.raw.clone().inside_elements_of(property)),
            None => self,
        }
    }

    pub(crate) fn raw(&self) -> &Raw<'a> {
        &self.raw
    }

    /// The values as a path counts them.
    fn split(&self) -> &Raw<'a> {
        self.split.as_ref().unwrap_or(&self.raw)
    }

    /// These values, for whoever takes them alone.
    pub(crate) fn into_raw(self: Rc<Self>) -> Raw<'a> {
        Rc::try_unwrap(self).map_or_else(|shared| shared.raw.clone(), |own| own.raw)
    }

    /// The values that a path leads to from these, of a property of this declaration, as components take them.
    pub(crate) fn led_to(self: Rc<Self>, path: &str, property: &Property) -> Result<Rc<Self>, Fault> {
        if self.raw.0.is_empty() {
            // What has no value has no parts either.
            return Ok(self);
        }
        let part = Self::new(self.part(path)?);
        // Without more steps it is the value itself.
        Ok(if steps(path).nth(1).is_none() { part.inside_elements_of(property) } else { part })
    }

    /// The values that a path leads to: the part of a `source` behind the name.
    fn part(&self, path: &str) -> Result<Raw<'a>, Fault> {
        let values = &self.split().0;
        let place = one_of(values.len(), path)?;
        let one = || place.map_or_else(|| self.split().clone(), |place| Raw(vec![values[place].clone()]));
        let mut rest = steps(path).skip(1).map(|(_, step)| step);
        let (first, second) = (rest.next(), rest.next());
        let are_texts = || values.iter().all(|piece| matches!(piece, Piece::Text(_)));
        if first.is_none() || (first, second) == (Some("text()"), None) && are_texts() {
            return Ok(one());
        }
        let known = self.levels.borrow().get(&place).map(Rc::clone);
        let levels = known.unwrap_or_else(|| {
            let levels = Rc::new(PathIndex::of(&one()));
            self.levels.borrow_mut().insert(place, Rc::clone(&levels));
            levels
        });
        levels.walk(path)
    }
}
