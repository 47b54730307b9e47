//! What components give the composites that they implement, as far as expressions ask for it before there are
//! [`Parameters`](crate::check::parameters::Parameters), which report what is wrong with it.

use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;

use crate::check::levels::Levels;
use crate::check::names::{Names, Supplied, with_included};
use crate::check::parameters::MOST_PARTS;
use crate::check::path::{Fault, expression, one_of};
use crate::check::raw::{Piece, Raw, unreported};
use crate::check::unfold::Unfolding;
use crate::check::xpath::XPath;
use crate::model::{Composite, Property};
use crate::source::Text;

/// What is known of the properties of a unit whose expressions were asked about.
pub(in crate::check) struct Known<'a> {
    pub(in crate::check) names: Rc<Names>,
    properties: HashMap<&'a str, (&'a Composite, &'a Property)>,
    /// What paths led to.
    found: RefCell<HashMap<String, Supplied>>,
    /// How many elements there are in the values of properties that a path led into.
    sizes: RefCell<HashMap<String, usize>>,
    left: Rc<Left>,
}

/// What sources can still look at, of a unit and all inside it.
struct Left {
    /// Elements, in each step of a path anew.
    elements: Cell<usize>,
    /// Parts of values, where a source is more than a path.
    parts: Cell<usize>,
}

/// Elements that paths can look at: replicas of a composite can each take a part of one long value.
const MOST_ELEMENTS: usize = 200_000_000;

impl<'a> Known<'a> {
    pub(super) fn of(names: Rc<Names>, main: &'a Composite, unfolding: &Unfolding<'a>) -> Self {
        let mut properties = HashMap::new();
        for composite in with_included(main, unfolding.fleet.contribution) {
            for property in &composite.properties {
                properties.entry(property.name.as_str()).or_insert((composite, property));
            }
        }
        let mut others = unfolding.fleet.names.iter().flatten();
        let left = others.next().map(|other| Rc::clone(&other.left));
        let new = || Rc::new(Left { elements: Cell::new(MOST_ELEMENTS), parts: Cell::new(MOST_PARTS) });
        let left = left.unwrap_or_else(new);
        Self { names, properties, found: RefCell::default(), sizes: RefCell::default(), left }
    }

    /// Counts what a path looks at in a value that was measured; `Err` where there is no room for it.
    fn look(&self, name: &str, path: &str) -> Result<(), ()> {
        let size = self.sizes.borrow().get(name).copied().unwrap_or_default();
        let cost = size.saturating_mul(1 + path.matches('/').count());
        self.left.elements.set(self.left.elements.get().checked_sub(cost).ok_or(())?);
        Ok(())
    }

    /// Counts the elements in a value, before the second path leads into it.
    fn measure(&self, name: &str, whole: &Raw<'a>) {
        if self.sizes.borrow().contains_key(name) {
            return;
        }
        let elements = whole.0.iter().flat_map(|piece| match piece {
            Piece::Text(_) => &[],
            Piece::Elements(elements, _) => &elements[..],
            Piece::Whole(_, root, _) => std::slice::from_ref(root),
        });
        let size = elements.map(|element| 1 + element.descendants().count()).sum();
        self.sizes.borrow_mut().insert(name.to_owned(), size);
    }
}

impl<'a> Unfolding<'a> {
    /// What a component gives a property of the composite that it implements.
    pub(super) fn supplied(&self, owner: usize, name: &str) -> Supplied {
        let member = &self.fleet.members[owner];
        let Some(given) = member.component.property(name) else { return Supplied::Nothing };
        let Some(known) = self.known(member.unit) else { return Supplied::Nothing };
        let named = given.source().and_then(|source| source.strip_prefix('$'));
        if let Some(supplied) = named.and_then(|named| known.names.supply(named)) {
            return supplied;
        }
        // Where it leads nowhere, the property can have a value of its own.
        let path = given.source().filter(|source| expression(source).is_some() && !given.has_value());
        if let Some(found) = path.and_then(|path| known.found.borrow().get(path.as_str()).cloned()) {
            return found;
        }
        let found = match self.values_given(owner, given).as_ref().map(|raw| &raw.0[..]) {
            Ok([]) => Supplied::Nothing,
            Ok([Piece::Text(text)]) => Supplied::Text(text.clone().into_owned()),
            Ok([Piece::Whole(text, ..)]) => Supplied::Text((*text).clone()),
            Ok(_) => Supplied::Other,
            Err(()) => Supplied::Faulty,
        };
        if let Some(path) = path {
            known.found.borrow_mut().insert(path.to_string(), found.clone());
        }
        found
    }

    fn known(&self, unit: usize) -> Option<&Known<'a>> {
        self.fleet.names.get(unit)?.as_ref()
    }

    /// The values of a component's property; `Err` with a fault.
    fn values_given(&self, owner: usize, given: &'a Property) -> Result<Raw<'a>, ()> {
        let member = &self.fleet.members[owner];
        let document = &member.composite.document;
        if member.instance.is_some_and(|instance| instance.hides(given, document)) {
            return Err(());
        }
        if let Some(source) = given.source() {
            let raw = self.led_to(member.unit, source)?;
            if !raw.0.is_empty() {
                return Ok(raw);
            }
        }
        unreported(given, document, member.instance)
    }

    /// What a `source` in a unit leads to; `Err` with a fault.
    fn led_to(&self, unit: usize, source: &Text) -> Result<Raw<'a>, ()> {
        let known = self.known(unit).ok_or(())?;
        let Some((name, path)) = expression(source) else { return self.by_xpath(unit, source) };
        let Some(&(_, property)) = known.properties.get(name) else { return self.by_xpath(unit, source) };
        let Some(path) = path else { return Ok(self.whole(unit, name)?.inside_elements_of(property)) };
        known.look(name, path)?;
        let whole = self.whole(unit, name)?;
        if whole.0.is_empty() {
            return Ok(whole);
        }
        known.measure(name, &whole);
        let whole = match one_of(whole.split_into_elements_of(property), path) {
            Err(Fault { is_understood: false, .. }) => return self.by_xpath(unit, source),
            found => found.map_err(drop)?,
        };
        if !path.contains('/') {
            return Ok(whole.inside_elements_of(property));
        }
        match Levels::of(whole).walk(path) {
            Err(Fault { is_understood: false, .. }) => self.by_xpath(unit, source),
            found => found.map_err(drop),
        }
    }

    /// The whole value of a property of a unit; `Err` with a fault, or where there is none.
    fn whole(&self, unit: usize, name: &str) -> Result<Raw<'a>, ()> {
        let known = self.known(unit).ok_or(())?;
        let &(composite, property) = known.properties.get(name).ok_or(())?;
        let given = match self.fleet.scopes[self.fleet.units[unit].scope].owner {
            Some(owner) => match self.fleet.members[owner].component.property(name) {
                Some(given) => self.values_given(owner, given)?,
                None => Raw(Vec::new()),
            },
            None => {
                let setting = self.options.settings.iter().find(|setting| setting.name == *name);
                Raw(setting.iter().flat_map(|setting| Raw::one(&setting.value).0).collect())
            }
        };
        if !given.0.is_empty() {
            return Ok(given);
        }
        match property.env().and_then(|variable| self.options.variable(variable)) {
            Some(variable) => Ok(Raw::one(variable)),
            None => unreported(property, &composite.document, None),
        }
    }

    /// What a `source` comes to that is more than a path.
    fn by_xpath(&self, unit: usize, source: &Text) -> Result<Raw<'a>, ()> {
        let known = self.known(unit).ok_or(())?;
        let xpath = XPath::parse(source).map_err(drop)?;
        let mut variables = Vec::new();
        for (name, _) in xpath.variables() {
            let &(_, property) = known.properties.get(name.as_str()).ok_or(())?;
            // A text was found when the names of the unit were: around composites inside each other it is not put together anew for each.
            let whole = match known.names.supply(&name) {
                Some(Supplied::Text(text)) => Raw(vec![Piece::Text(Cow::Owned(text))]),
                Some(Supplied::Faulty) => return Err(()),
                _ => self.whole(unit, &name)?,
            };
            variables.push((name, whole.split_into_elements_of(property)));
        }
        if !source.contains(['$', '(']) {
            return Err(());
        }
        match xpath.evaluate(&variables, &known.left.parts, source.location) {
            Err(_) if !variables.is_empty() && variables.iter().all(|(_, whole)| whole.0.is_empty()) => {
                Ok(Raw(Vec::new()))
            }
            found => found.map_err(drop),
        }
    }
}
