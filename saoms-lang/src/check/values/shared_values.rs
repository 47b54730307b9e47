//! The values of a property as all who take them share them, and the parts of these that paths lead to: a fleet can
//! give one long value on through many composites, and take each of its parts in one of these.

use std::cell::{Cell, RefCell};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;

use super::path::{POSITION, PathFault, Predicate, Test, attribute, ends, no_step, one_of, steps};
use super::raw::{Piece, Raw};
use crate::check::judged::Judged;
use crate::limits::{Budget, PATH_STEPS, TABLE_ELEMENTS};
use crate::model::Property;
use crate::syntax::Element;

/// Elements that a step to any depth, and a new table, count for: they take so much longer for each.
const DEEP: usize = 10;
const TABLE: usize = 20;

/// The values of a property.
pub(crate) struct SharedValues<'a> {
    pub(crate) raw: Raw<'a>,
    /// The elements behind steps such as `robot[@id='r1']`, by the path up to the value: many paths ask for one each.
    tables: RefCell<HashMap<String, ByValue<'a>>>,
    /// The number of elements in these tables.
    kept: Cell<usize>,
}

/// The values of a property.
pub(crate) type Answer<'a> = Judged<Rc<SharedValues<'a>>>;

/// Elements by the value that a step asks for.
type ByValue<'a> = HashMap<String, Vec<Element<'a>>>;

/// The elements that a step starts from.
#[derive(Default)]
struct Level<'a> {
    /// Those that it leads into.
    around: Vec<Element<'a>>,
    /// Those of the value itself, which are in none of these.
    top: Vec<Element<'a>>,
    /// True if they are in each other as well.
    is_deep: bool,
}

impl<'a> SharedValues<'a> {
    /// Values that no property declares.
    pub(crate) fn new(raw: Raw<'a>) -> Rc<Self> {
        Rc::new(Self { raw, tables: RefCell::default(), kept: Cell::default() })
    }

    /// These values as those of a property of this declaration.
    pub(crate) fn given_to(self: Rc<Self>, property: &Property) -> Rc<Self> {
        match property.element() {
            Some(of) if property.many().is_some_and(|many| many.value) => {
                Self::new(self.into_raw().split_into_elements(of))
            }
            _ => self,
        }
    }

    /// These values as components take them from a property of this declaration.
    pub(crate) fn inside_elements_of(self: Rc<Self>, property: &Property) -> Rc<Self> {
        match property.element() {
            Some(_) => Self::new(self.raw.clone().inside_elements_of(property)),
            None => self,
        }
    }

    /// These values, for whoever takes them alone.
    pub(crate) fn into_raw(self: Rc<Self>) -> Raw<'a> {
        Rc::try_unwrap(self).map_or_else(|shared| shared.raw.clone(), |own| own.raw)
    }

    /// The values that a path leads to, as components take them. `budget` is of the elements that paths look at.
    pub(crate) fn led_to(
        self: Rc<Self>,
        path: &str,
        property: &Property,
        budget: &Budget,
    ) -> Result<Rc<Self>, PathFault> {
        let values = &self.raw.0;
        if values.is_empty() {
            // What has no value has no parts either.
            return Ok(self);
        }
        let values = match one_of(values.len(), path)? {
            Some(place) => &values[place..=place],
            None => values,
        };
        let all: Vec<(Range<usize>, &str)> = steps(path).skip(1).collect();
        let is_all = match all[..] {
            [] => return Ok(Self::new(Raw(values.to_vec())).inside_elements_of(property)),
            [(_, "text()")] => self.raw.0.iter().all(|piece| matches!(piece, Piece::Text(_))),
            _ => false,
        };
        if let Some((at, _)) = all.get(PATH_STEPS) {
            return Err(PathFault::new(at.clone(), format!("a path has at most {PATH_STEPS} steps")));
        }
        Ok(Self::new(if is_all { Raw(values.to_vec()) } else { self.walk(values, path, &all, budget)? }))
    }

    /// The parts of some of the values that the steps of a path lead to.
    fn walk(
        &self,
        values: &[Piece<'a>],
        path: &str,
        all: &[(Range<usize>, &str)],
        budget: &Budget,
    ) -> Result<Raw<'a>, PathFault> {
        let instance = values.iter().find_map(Piece::instance);
        let mut steps = all.iter();
        // Once the limit is reached, no path is walked any more.
        look_at(0, &all[0].0, budget)?;
        // From the last step on whose end is known.
        let known = (1..=all.len()).rev().find_map(|count| Some((count, self.known(path, &all[count - 1])?)));
        let mut level = match known {
            Some((count, found)) => {
                steps = all[count..].iter();
                Level { around: found, ..Level::default() }
            }
            None => Level::start(values, path, &all[0], budget)?,
        };
        while let Some((at, step)) = steps.next() {
            let is_last = steps.len() == 0;
            if step.is_empty() && !is_last && !level.is_deep {
                level = level.deep(at, budget)?;
                continue;
            }
            look_at(level.around.len(), at, budget)?;
            if let Some(end) = ends(&level.around, (at.clone(), step), is_last, instance) {
                return end;
            }
            let test = Test::of(step).ok_or_else(|| no_step(step, at.clone()))?;
            let here: Vec<Element<'a>> = level.here().collect();
            look_at(here.len(), at, budget)?;
            let named: Vec<Element<'a>> = here.iter().copied().filter(|one| test.is_of_name(*one)).collect();
            let mut found = match test.predicate.as_ref().map(Predicate::asked) {
                None => named.clone(),
                Some(None) => siblings(&named).filter_map(|these| these.last().copied()).collect(),
                Some(Some((of, value))) => {
                    let mut tables = self.tables.borrow_mut();
                    let key = key(path, at, &test, of);
                    if let Some(table) = tables.get(&key) {
                        table.get(&*value).cloned().unwrap_or_default()
                    } else {
                        look_at(TABLE * named.len(), at, budget)?;
                        let table = by_value(&named, of);
                        let found = table.get(&*value).cloned().unwrap_or_default();
                        if self.kept.get() + named.len() <= TABLE_ELEMENTS {
                            self.kept.set(self.kept.get() + named.len());
                            tables.insert(key, table);
                        }
                        found
                    }
                }
            };
            if found.is_empty() {
                return Err(test.fault(at.clone(), &here, &named));
            }
            found.sort_unstable_by_key(|one| one.id());
            level = Level { around: found, ..Level::default() };
        }
        Ok(Raw::of_elements(&level.around, instance))
    }

    /// The elements behind a step, where another path came this way.
    fn known(&self, path: &str, (at, step): &(Range<usize>, &str)) -> Option<Vec<Element<'a>>> {
        let test = Test::of(step)?;
        let (of, value) = test.predicate.as_ref()?.asked()?;
        let mut found = self.tables.borrow().get(&key(path, at, &test, of))?.get(&*value)?.clone();
        found.sort_unstable_by_key(|one| one.id());
        Some(found)
    }
}

/// A path up to the value that the step at some bytes asks for.
fn key(path: &str, at: &Range<usize>, test: &Test<'_>, of: &str) -> String {
    format!("{}{}[{of}", &path[..at.start], test.name.unwrap_or("*"))
}

/// Counts elements that the step at these bytes is to look at.
fn look_at(count: usize, at: &Range<usize>, budget: &Budget) -> Result<(), PathFault> {
    if budget.spend(count as u64) { Ok(()) } else { Err(PathFault::too_many(at.clone())) }
}

/// Elements by the values that they have of a part, of an attribute such as `@id`, or by their places.
fn by_value<'a>(elements: &[Element<'a>], of: &str) -> ByValue<'a> {
    let mut all = ByValue::new();
    for (place, one) in siblings(elements).flat_map(|these| these.iter().enumerate()) {
        let values: Vec<String> = match of.strip_prefix('@') {
            Some(name) => attribute(*one, name).map(|found| found.value().into_owned()).into_iter().collect(),
            None if of == POSITION => vec![(place + 1).to_string()],
            None => {
                let parts = one.children().filter(|part| part.local_name() == of);
                parts.filter_map(|part| Some(part.trimmed_text()?.as_str().to_owned())).collect()
            }
        };
        for value in values {
            let these = all.entry(value).or_default();
            if these.last().is_none_or(|last| last.id() != one.id()) {
                these.push(*one);
            }
        }
    }
    all
}

/// Elements by what they are in: siblings stand beside each other.
fn siblings<'e, 'a>(all: &'e [Element<'a>]) -> impl Iterator<Item = &'e [Element<'a>]> {
    let parent = |one: &Element<'_>| one.parent().map(Element::id);
    all.chunk_by(move |one, other| parent(one) == parent(other))
}

impl<'a> Level<'a> {
    /// The elements that the first step of a path starts from. Where each value is one element, that may mean a part of
    /// it: `$order/total` also means the `total` of a value that is written as one element.
    fn start(
        values: &[Piece<'a>],
        path: &str,
        (at, first): &(Range<usize>, &str),
        budget: &Budget,
    ) -> Result<Self, PathFault> {
        let elements: Vec<&[Element<'a>]> = values.iter().filter_map(Piece::elements).collect();
        let top = elements.concat();
        if top.is_empty() {
            let of_values = Test::of(first).map_or("", |test| test.of_values());
            let message = format!("the property has a simple value: there are no parts in it{of_values}");
            return Err(PathFault::new(0..path.len(), message));
        }
        let mut looked_at = top.len();
        let mut inside = top.iter().flat_map(|one| one.children()).inspect(|_| looked_at += 1);
        let is_inside = elements.iter().all(|value| value.len() == 1)
            && match Test::of(first) {
                Some(Test { name: None, .. }) => false,
                Some(test) => !top.iter().any(|one| test.is_of_name(*one)) && inside.any(|one| test.is_of_name(one)),
                None => first.starts_with('@') || *first == "text()",
            };
        look_at(looked_at, at, budget)?;
        Ok(match is_inside {
            true => Self { around: top, ..Self::default() },
            false => Self { top, ..Self::default() },
        })
    }

    /// The elements that a step chooses from.
    fn here(&self) -> impl Iterator<Item = Element<'a>> {
        self.top.iter().copied().chain(self.around.iter().flat_map(|one| one.children()))
    }

    /// All that is inside, to any depth: siblings beside each other.
    fn deep(self, at: &Range<usize>, budget: &Budget) -> Result<Self, PathFault> {
        let mut waiting = [&self.around[..], &self.top].concat();
        let (mut around, mut seen) = (Vec::new(), HashSet::new());
        while let Some(one) = waiting.pop() {
            if seen.insert(one.id()) {
                look_at(DEEP, at, budget)?;
                around.push(one);
                waiting.extend(one.children());
            }
        }
        around.sort_unstable_by_key(|one| one.id());
        Ok(Self { around, top: self.top, is_deep: true })
    }
}
