//! Values of the properties of composites, as far as expressions ask for them before there are
//! [`Parameters`](crate::check::values::parameters::Parameters), which report what is wrong with it. Each value is
//! found once, whoever asks for it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use crate::check::unfolding::Unfolding;
use crate::check::unfolding::expression_scope::Supplied;
use crate::check::values::path::expression;
use crate::check::values::raw::{Piece, Raw, only_way};
use crate::check::values::shared_values::SharedValues;
use crate::model::{Composite, Property};
use crate::source::Text;

/// The properties of a unit, as its expressions see them.
pub(crate) struct UnitProperties<'a> {
    /// The component that its composite implements.
    owner: Option<usize>,
    properties: HashMap<&'a str, (&'a Composite, &'a Property)>,
    /// Their values.
    wholes: RefCell<HashMap<&'a str, Answer<'a>>>,
    /// The parts of values that paths lead to.
    led_to: RefCell<HashMap<String, Answer<'a>>>,
}

/// Values; `Err` with a fault.
type Answer<'a> = Result<Rc<SharedValues<'a>>, ()>;

impl<'a> UnitProperties<'a> {
    /// The properties of a unit before any is evaluated.
    pub(super) fn of(composites: &[&'a Composite], owner: Option<usize>) -> Self {
        let mut properties = HashMap::new();
        for composite in composites.iter().copied() {
            for property in &composite.properties {
                properties.entry(property.name.as_str()).or_insert((composite, property));
            }
        }
        Self { owner, properties, wholes: RefCell::default(), led_to: RefCell::default() }
    }
}

impl<'a> Unfolding<'a> {
    /// The value that expressions in a unit take of a property.
    pub(super) fn supplied(&self, unit: usize, name: &str) -> Supplied {
        match self.taken(unit, name).as_ref().map(|whole| &whole.raw().0[..]) {
            Ok([]) => Supplied::Nothing,
            Ok([Piece::Text(text)]) => Supplied::Text(text.clone().into_owned()),
            Ok([Piece::Whole(text, ..)]) => Supplied::Text((*text).clone()),
            Ok(_) => Supplied::Other,
            Err(()) => Supplied::Faulty,
        }
    }

    fn known(&self, unit: usize) -> Result<&UnitProperties<'a>, ()> {
        self.known.get(unit).and_then(Option::as_ref).ok_or(())
    }

    /// The value that a component gives a property of the composite that implements it.
    fn given(&self, known: &UnitProperties<'a>, name: &str) -> Option<&'a Property> {
        self.fleet.members[known.owner?].component.property(name)
    }

    /// The values of a component's property.
    fn values_given(&self, owner: usize, given: &'a Property) -> Answer<'a> {
        let member = &self.fleet.members[owner];
        let document = &member.composite.document;
        if member.instance.is_some_and(|instance| instance.hides(given, document)) {
            return Err(());
        }
        if let Some(source) = given.source() {
            let whole = self.led_to(member.unit, source)?;
            if !whole.raw().0.is_empty() {
                return Ok(whole);
            }
        }
        only_way(given, document, member.instance).map(SharedValues::new).map_err(|_| ())
    }

    /// The whole value of a property of a unit; `Err` also where there is none of this name.
    fn whole(&self, unit: usize, name: &str) -> Answer<'a> {
        let known = self.known(unit)?;
        let Some(found) = known.wholes.borrow().get(name).cloned() else {
            let &(composite, property) = known.properties.get(name).ok_or(())?;
            let found = self.declared(known, composite, property);
            known.wholes.borrow_mut().insert(&property.name, found.clone());
            return found;
        };
        found
    }

    fn declared(&self, known: &UnitProperties<'a>, composite: &'a Composite, property: &'a Property) -> Answer<'a> {
        let setting = || self.options.settings.iter().find(|setting| setting.name == *property.name.as_str());
        let given = match known.owner {
            Some(owner) => match self.given(known, &property.name) {
                Some(given) => Some(self.values_given(owner, given)),
                // What has a fault may give it.
                None if self.fleet.members[owner].may_give_others() => return Err(()),
                None => None,
            },
            None => setting().map(|setting| Ok(SharedValues::new(Raw::one(&setting.value)))),
        };
        if let Some(given) = given.transpose()?.filter(|given| !given.raw().0.is_empty()) {
            return Ok(given.given_to(property));
        }
        match property.env().and_then(|variable| self.options.variable(variable)) {
            Some(variable) => Ok(SharedValues::of(Raw::one(variable), property)),
            None => match only_way(property, &composite.document, None) {
                Ok(raw) => Ok(SharedValues::of(raw, property)),
                Err(_) => Err(()),
            },
        }
    }

    /// The values of a property of a unit that is named as a whole.
    fn taken(&self, unit: usize, name: &str) -> Answer<'a> {
        let whole = self.whole(unit, name)?;
        let known = self.known(unit)?;
        let &(_, property) = known.properties.get(name).ok_or(())?;
        // Where the composite does not say it, the component that it implements may.
        let outside = self.given(known, name).filter(|_| property.element().is_none());
        Ok(whole.inside_elements_of(outside.unwrap_or(property)))
    }

    /// The values that a `source` in a unit leads to.
    fn led_to(&self, unit: usize, source: &Text) -> Answer<'a> {
        let known = self.known(unit)?;
        let named = expression(source).filter(|(name, _)| known.properties.contains_key(name));
        if let Some((name, None)) = named {
            return self.taken(unit, name);
        }
        if let Some(found) = known.led_to.borrow().get(source.as_str()) {
            return found.clone();
        }
        let found = match named {
            Some((name, Some(path))) => self.by_path(unit, name, path),
            _ => Err(()),
        };
        known.led_to.borrow_mut().insert(source.to_string(), found.clone());
        found
    }

    /// The values that a path leads to.
    fn by_path(&self, unit: usize, name: &str, path: &str) -> Answer<'a> {
        let whole = self.whole(unit, name)?;
        let &(_, property) = self.known(unit)?.properties.get(name).ok_or(())?;
        whole.led_to(path, property).map_err(|_| ())
    }
}
