//! The parts of the value of a property, found by the steps of many paths: a fleet can take each of its values from one
//! complex property.

use std::cell::{Cell, OnceCell, RefCell};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::rc::Rc;

use super::path::{Fault, Position, Predicate, Test, attribute, ends, no_step, steps};
use super::raw::{Piece, Raw};
use crate::check::unfolding::replica::Instance;
use crate::syntax::Element;

/// Elements that are kept for the next path, of all paths together.
const MOST_KEPT: usize = 4_000_000;

/// A value with what was looked up in it.
pub(crate) struct PathIndex<'a> {
    instance: Option<&'a Instance>,
    /// The elements that steps start from.
    first: Rc<IndexLevel<'a>>,
    /// What they start from where each value is one element, and the first step means a part of that: `$order/total`
    /// also means the `total` of a value that is written as one element.
    inside: Option<Rc<IndexLevel<'a>>>,
    /// The elements behind steps, by these and the place where they start.
    behind: RefCell<HashMap<(bool, String), Rc<IndexLevel<'a>>>>,
    /// The number of more elements are kept.
    room: Cell<usize>,
}

/// Elements that the next step chooses from.
#[derive(Default)]
struct IndexLevel<'a> {
    /// Those that they are in.
    around: Vec<Element<'a>>,
    here: Vec<Element<'a>>,
    /// True if they are in each other as well.
    is_deep: bool,
    by_name: OnceCell<HashMap<&'a str, Vec<Element<'a>>>>,
    /// By the name that was asked for and an attribute (`@id`) or a part, and by the value of that.
    by_attribute: RefCell<HashMap<(Option<String>, String), ByValue<'a>>>,
}

type ByValue<'a> = Rc<HashMap<String, Vec<Element<'a>>>>;

impl<'a> PathIndex<'a> {
    pub(crate) fn of(whole: &Raw<'a>) -> Self {
        let (mut here, mut instance, mut is_one) = (Vec::new(), None, true);
        for piece in &whole.0 {
            let (elements, of) = match piece {
                Piece::Elements(elements, of) => (&elements[..], of),
                Piece::Whole(_, root, of) => (std::slice::from_ref(root), of),
                Piece::Text(_) => continue,
            };
            instance = *of;
            is_one &= elements.len() == 1;
            here.extend(elements);
        }
        let inside = (is_one && !here.is_empty()).then(|| Rc::new(IndexLevel::of(here.clone())));
        let first = Rc::new(IndexLevel { here, ..IndexLevel::default() });
        Self { instance, first, inside, behind: RefCell::default(), room: Cell::new(MOST_KEPT) }
    }

    /// The values that a path leads to.
    pub(crate) fn walk(&self, path: &str) -> Result<Raw<'a>, Fault> {
        if self.first.here.is_empty() {
            let first = steps(path).nth(1).map_or("", |(_, step)| step);
            let of_values = Test::of(first).map_or("", |test| test.of_values());
            let message = format!("the property has a simple value: there are no parts in it{of_values}");
            return Err(Fault::new(0..path.len(), message));
        }
        // What stands before the first `/` is the name.
        let mut all = steps(path).skip(1).peekable();
        let first = all.peek().map_or("", |(_, step)| *step);
        let inside = self.inside.as_ref().filter(|inside| inside.is_meant(first));
        let mut level = Rc::clone(inside.unwrap_or(&self.first));
        while let Some((at, step)) = all.next() {
            let is_last = all.peek().is_none();
            let is_deep = step.is_empty() && !is_last && !level.is_deep;
            if !is_deep && let Some(end) = ends(&level.around, (at.clone(), step), is_last, self.instance) {
                return end;
            }
            let test = if is_deep { None } else { Some(Test::of(step).ok_or_else(|| no_step(step, at.clone()))?) };
            if let Some(test) = test.as_ref().filter(|_| is_last) {
                let found = level.find(at, test)?;
                return Ok(Raw::of_elements(&found, self.instance));
            }
            let key = (inside.is_some(), path[..at.end].to_owned());
            let known = self.behind.borrow().get(&key).map(Rc::clone);
            level = match known {
                Some(known) => known,
                None => {
                    let next = match &test {
                        Some(test) => IndexLevel::of(level.find(at, test)?),
                        None => level.deep(),
                    };
                    let next = Rc::new(next);
                    let left = self.room.get().checked_sub(next.around.len() + next.here.len());
                    if let Some(left) = left {
                        self.room.set(left);
                        self.behind.borrow_mut().insert(key, Rc::clone(&next));
                    }
                    next
                }
            };
        }
        Err(Fault::new(0..path.len(), "the path is empty"))
    }
}

impl<'a> IndexLevel<'a> {
    /// The elements inside these.
    fn of(around: Vec<Element<'a>>) -> Self {
        let here = around.iter().flat_map(|one| one.children()).collect();
        Self { around, here, ..Self::default() }
    }

    /// All that is inside, to any depth: siblings beside each other.
    fn deep(&self) -> Self {
        let top = if self.around.is_empty() { &self.here[..] } else { &[] };
        let mut waiting = if self.around.is_empty() { self.here.clone() } else { self.around.clone() };
        let (mut around, mut seen) = (Vec::new(), HashSet::new());
        while let Some(one) = waiting.pop() {
            if seen.insert(one.id()) {
                around.push(one);
                waiting.extend(one.children());
            }
        }
        around.sort_unstable_by_key(|one| one.id());
        let here = top.iter().copied().chain(around.iter().flat_map(|one| one.children())).collect();
        Self { around, here, is_deep: true, ..Self::default() }
    }

    fn by_name(&self) -> &HashMap<&'a str, Vec<Element<'a>>> {
        self.by_name.get_or_init(|| {
            let mut all: HashMap<&'a str, Vec<Element<'a>>> = HashMap::new();
            self.here.iter().for_each(|one| all.entry(one.local_name()).or_default().push(*one));
            all
        })
    }

    /// True if the first step of a path is one from here, rather than one to what this is in.
    fn is_meant(&self, step: &str) -> bool {
        match Test::of(step) {
            Some(Test { name: Some(name), .. }) => {
                self.around.iter().all(|one| one.local_name() != name) && self.by_name().contains_key(name)
            }
            Some(Test { name: None, .. }) => false,
            None => step.starts_with('@') || step == "text()",
        }
    }

    fn named(&self, name: Option<&str>) -> &[Element<'a>] {
        match name {
            Some(name) => self.by_name().get(name).map_or(&[], Vec::as_slice),
            None => &self.here,
        }
    }

    /// The elements that a step leads to, or why it leads to none.
    fn find(&self, at: Range<usize>, test: &Test<'_>) -> Result<Vec<Element<'a>>, Fault> {
        let named = self.named(test.name);
        let mut found = match &test.predicate {
            None => named.to_vec(),
            Some(Predicate::Position(wanted)) => at_place(named, *wanted),
            Some(Predicate::Attribute(name, value)) => {
                let by_value = self.by_value(test.name, &format!("@{name}"));
                by_value.get(*value).cloned().unwrap_or_default()
            }
            Some(Predicate::Part(name, value)) => {
                let by_value = self.by_value(test.name, name);
                by_value.get(*value).cloned().unwrap_or_default()
            }
        };
        if self.is_deep {
            found.sort_unstable_by_key(|one| one.id());
        }
        if found.is_empty() { Err(test.fault(at, &self.here, named)) } else { Ok(found) }
    }

    fn by_value(&self, name: Option<&str>, of: &str) -> ByValue<'a> {
        let key = (name.map(str::to_owned), of.to_owned());
        let mut known = self.by_attribute.borrow_mut();
        let all = known.entry(key).or_insert_with(|| {
            let mut all: HashMap<String, Vec<Element<'a>>> = HashMap::new();
            for one in self.named(name) {
                let Some(of) = of.strip_prefix('@') else {
                    let parts = one.children().filter(|part| part.local_name() == of);
                    for text in parts.filter_map(|part| part.trimmed_text()) {
                        let these = all.entry(text.as_str().to_owned()).or_default();
                        if these.last().is_none_or(|last| last.id() != one.id()) {
                            these.push(*one);
                        }
                    }
                    continue;
                };
                if let Some(attribute) = attribute(*one, of) {
                    all.entry(attribute.value().into_owned()).or_default().push(*one);
                }
            }
            Rc::new(all)
        });
        Rc::clone(all)
    }
}

/// Those at a place among their siblings; siblings stand beside each other.
fn at_place<'a>(all: &[Element<'a>], wanted: Position) -> Vec<Element<'a>> {
    let parent = |one: &Element<'a>| one.parent().map(Element::id);
    let of = |these: &[Element<'a>]| Some(these[wanted.of(these.len())?]);
    match all {
        [first, .., last] if parent(first) == parent(last) => of(all).into_iter().collect(),
        _ => all.chunk_by(|one, other| parent(one) == parent(other)).filter_map(of).collect(),
    }
}
