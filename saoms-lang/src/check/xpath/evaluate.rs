//! From an expression to its value (XPath 1.0, 2 and 3).

use std::borrow::Cow;
use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

use super::no_number::NoNumber;
use super::parse::{Axis, Expression, Node as Part, Step, Test};
use super::value::{Key, Node, Value, compares};
use crate::check::instance::Instance;
use crate::check::path::Fault;
use crate::check::raw::{Piece, Raw};
use crate::check::report::list;
use crate::check::whole::Whole;
use crate::diagnostic::quoted;
use crate::source::{Located, Location};
use crate::xml::Element;

/// So many bytes of a text that is made are as much work as a part of a value: it takes memory, too.
const BYTES: usize = 8;

/// What variables stand for, and how much more work there may be.
pub(super) struct Scope<'v, 'a> {
    /// The text of the expression.
    text: &'v str,
    variables: &'v [(String, Rc<Whole<'a>>)],
    /// How many more parts are looked at.
    left: &'v Cell<usize>,
    /// The values that the outermost elements are in.
    tops: OnceCell<HashMap<Key, Node<'a>>>,
    /// The first step that leads nowhere.
    dead: RefCell<Option<Fault>>,
    /// The first operand of arithmetic that is no number.
    no_number: RefCell<Option<NoNumber>>,
}

/// What an expression is evaluated at.
pub(super) struct At<'a> {
    pub(super) node: Option<Node<'a>>,
    /// Its place among those beside it, from 1 on, and how many these are.
    pub(super) position: usize,
    pub(super) size: usize,
    /// Whether it is the value of all.
    is_whole: bool,
}

/// What the whole expression comes to.
pub(super) fn evaluate<'a>(
    expression: &Expression,
    text: &str,
    (variables, left): (&[(String, Rc<Whole<'a>>)], &Cell<usize>),
    place: Location,
) -> Result<Raw<'a>, Fault> {
    let (tops, dead, no_number) = (OnceCell::new(), RefCell::default(), RefCell::default());
    let scope = Scope { text, variables, left, tops, dead, no_number };
    let at = At { node: None, position: 1, size: 1, is_whole: true };
    let value = scope.value(expression, &at)?;
    if let Value::Nodes(nodes) = &value {
        scope.spend(nodes.len());
    }
    if left.get() == 0 {
        return Err(scope.used_up());
    }
    let pieces = match value {
        Value::Nodes(nodes) if nodes.is_empty() => {
            let fault = scope.dead.take();
            return Err(fault.unwrap_or_else(|| Fault::new(0..text.len(), "it leads to nothing")));
        }
        Value::Nodes(nodes) => nodes.iter().map(|node| scope.piece(node)).collect(),
        other => {
            let written = other.text(&scope);
            if let Some(operand) = scope.no_number.take().filter(|_| written.contains("NaN")) {
                return Err(operand.fault(expression, text));
            }
            vec![Piece::Text(Cow::Owned(Located::new(written.into(), place)))]
        }
    };
    Ok(Raw(pieces))
}

impl<'a> Scope<'_, 'a> {
    /// Whether there is room for so much more work.
    pub(super) fn spend(&self, count: usize) -> bool {
        let left = self.left.get().saturating_sub(count);
        self.left.set(left);
        left > 0
    }

    /// The fault of an expression for which there is no room.
    fn used_up(&self) -> Fault {
        let why = "the sources of a check look at most at four million parts of values or make as much text, and this goes beyond";
        Fault::new(0..self.text.len(), format!("{why}: paths such as `$name/part[2]` do not count"))
    }

    fn values(&self, variable: usize) -> &[Piece<'a>] {
        &self.variables[variable].1.split().0
    }

    fn held(&self, variable: usize, value: usize) -> &Piece<'a> {
        &self.values(variable)[value]
    }

    /// The elements of a whole value, and the replica whose numbers are in their texts.
    fn inside(&self, variable: usize, value: usize) -> (&[Element<'a>], Option<&'a Instance>) {
        match self.held(variable, value) {
            Piece::Elements(all, instance) => (all, *instance),
            Piece::Whole(_, root, instance) => (std::slice::from_ref(root), *instance),
            Piece::Text(_) => (&[], None),
        }
    }

    /// The text of a node: all that is inside.
    pub(super) fn text(&self, node: &Node<'a>) -> String {
        match node {
            Node::Value(variable, value) => match self.held(*variable, *value) {
                Piece::Text(text) => text.to_string(),
                _ => {
                    let (all, instance) = self.inside(*variable, *value);
                    all.iter().map(|one| self.text_inside(*one, instance)).collect()
                }
            },
            Node::Element(one, instance) => self.text_inside(*one, *instance),
            Node::Attribute(one, _, instance) => shown(one.trimmed(), *instance),
            Node::Text(one, instance) => {
                one.trimmed_text().map_or_else(String::new, |text| shown(text, *instance))
            }
        }
    }

    fn text_inside(&self, element: Element<'a>, instance: Option<&'a Instance>) -> String {
        let mut text = String::new();
        for one in element.descendants() {
            if !self.spend(1) {
                break;
            }
            text.extend(one.trimmed_text().map(|own| shown(own, instance)));
        }
        text
    }

    /// A node as the value of a property.
    fn piece(&self, node: &Node<'a>) -> Piece<'a> {
        match node {
            Node::Value(variable, value) => self.held(*variable, *value).clone(),
            Node::Element(one, instance) => Piece::inside(*one, *instance),
            Node::Attribute(one, _, instance) => Piece::text(one.trimmed(), *instance),
            Node::Text(one, instance) => match one.trimmed_text() {
                Some(text) => Piece::text(text, *instance),
                None => Piece::text(Located::new("".into(), one.name_location()), *instance),
            },
        }
    }

    fn value(&self, expression: &Expression, at: &At<'a>) -> Result<Value<'a>, Fault> {
        let part = At { is_whole: false, ..*at };
        Ok(match &expression.node {
            Part::Number(number) => Value::Number(*number),
            Part::Literal(text) => Value::Text(text.clone()),
            Part::Variable(name) => {
                let place = self.variables.iter().position(|(known, _)| known == name);
                let values = place.map_or(0, |place| self.values(place).len());
                self.spend(values);
                Value::Nodes((0..values).map(|value| Node::Value(place.unwrap_or_default(), value)).collect())
            }
            Part::Call(function, arguments) => {
                let arguments = arguments.iter().map(|one| self.value(one, &part));
                let arguments = arguments.collect::<Result<Vec<_>, _>>()?;
                let value = (function.run)(self, at, &arguments)
                    .map_err(|message| Fault::new(expression.span.clone(), message))?;
                // Texts that are joined with themselves, from composite to composite, double each time.
                if let Value::Text(text) = &value
                    && !self.spend(text.len() / BYTES)
                {
                    return Err(self.used_up());
                }
                value
            }
            Part::Negation(inner) => Value::Number(-self.operand("-", inner, &self.value(inner, &part)?)),
            Part::Binary("|", left, right) => {
                let mut all = self.nodes(left, at)?;
                all.extend(self.nodes(right, at)?);
                Value::Nodes(in_order(all))
            }
            Part::Binary(operator, left, right) => {
                let first = self.value(left, &part)?;
                match *operator {
                    "or" if first.boolean() => return Ok(Value::Boolean(true)),
                    "and" if !first.boolean() => return Ok(Value::Boolean(false)),
                    _ => {}
                }
                let second = self.value(right, &part)?;
                self.binary(operator, (left, &first), (right, &second))
            }
            Part::Path(start, predicates, steps) => {
                let mut nodes = match start {
                    Some(start) => self.nodes(start, &part)?,
                    None => vec![at.node.ok_or_else(|| {
                        Fault::new(expression.span.clone(), "a path starts at a property: `$name/...`")
                    })?],
                };
                for predicate in predicates {
                    let before = nodes.len();
                    nodes = self.chosen(nodes, predicate)?;
                    if at.is_whole && nodes.is_empty() && before > 0 {
                        let values =
                            if before == 1 { "one value".to_owned() } else { format!("{before} values") };
                        self.die(predicate.span.clone(), || format!("the property has {values}"));
                    }
                }
                for step in steps {
                    nodes = self.step(nodes, step, at.is_whole)?;
                }
                Value::Nodes(nodes)
            }
        })
    }

    fn binary(
        &self,
        operator: &str,
        (left, first): (&Expression, &Value<'a>),
        (right, second): (&Expression, &Value<'a>),
    ) -> Value<'a> {
        let calculate: fn(f64, f64) -> f64 = match operator {
            "or" | "and" => return Value::Boolean(second.boolean()),
            "+" => |one, other| one + other,
            "-" => |one, other| one - other,
            "*" => |one, other| one * other,
            "div" => |one, other| one / other,
            "mod" => |one, other| one % other,
            _ => return Value::Boolean(compares(operator, first, second, self)),
        };
        let one = self.operand(operator, left, first);
        Value::Number(calculate(one, self.operand(operator, right, second)))
    }

    /// A value as a number of arithmetic. The first that is none is kept.
    fn operand(&self, operator: &str, expression: &Expression, value: &Value<'a>) -> f64 {
        let number = value.number(self);
        let is_first = number.is_nan() && self.no_number.borrow().is_none();
        if is_first && let Value::Nodes(_) | Value::Text(_) = value {
            *self.no_number.borrow_mut() =
                Some(NoNumber::new(operator, (expression, self.text), value, &value.text(self)));
        }
        number
    }

    fn nodes(&self, expression: &Expression, at: &At<'a>) -> Result<Vec<Node<'a>>, Fault> {
        match self.value(expression, at)? {
            Value::Nodes(nodes) => Ok(nodes),
            _ => Err(Fault::new(expression.span.clone(), "this is a simple value: there are no parts in it")),
        }
    }

    fn die(&self, span: Range<usize>, message: impl FnOnce() -> String) {
        self.dead.borrow_mut().get_or_insert_with(|| Fault::new(span, message()));
    }

    /// Those of the nodes that a predicate takes.
    fn chosen(&self, nodes: Vec<Node<'a>>, predicate: &Expression) -> Result<Vec<Node<'a>>, Fault> {
        let size = nodes.len();
        let mut chosen = Vec::new();
        for (place, node) in nodes.into_iter().enumerate() {
            if !self.spend(1) {
                break;
            }
            let position = place + 1;
            let at = At { node: Some(node), position, size, is_whole: false };
            let is_chosen = match self.value(predicate, &at)? {
                Value::Number(number) => number == position as f64,
                other => other.boolean(),
            };
            chosen.extend(is_chosen.then_some(node));
        }
        Ok(chosen)
    }

    fn step(&self, from: Vec<Node<'a>>, step: &Step, is_whole: bool) -> Result<Vec<Node<'a>>, Fault> {
        let (mut all, mut has_named) = (Vec::new(), false);
        for node in &from {
            let mut found = self.axis(*node, step);
            has_named |= !found.is_empty();
            for predicate in &step.predicates {
                found = self.chosen(found, predicate)?;
            }
            all.extend(found);
            if self.left.get() == 0 {
                break;
            }
        }
        if is_whole && all.is_empty() && !from.is_empty() {
            self.die(step.span.clone(), || {
                let shown = quoted(&self.text[step.span.clone()]);
                let mut known: Vec<&str> = Vec::new();
                let any = |axis| Step { axis, test: Test::Any, predicates: Vec::new(), span: 0..0 };
                let axis = if step.axis == Axis::Attribute { Axis::Attribute } else { Axis::Child };
                for one in from.iter().take(50).flat_map(|node| self.axis(*node, &any(axis))).take(1_000) {
                    let name = match one {
                        Node::Element(one, _) => one.local_name(),
                        Node::Attribute(one, ..) => one.local_name(),
                        _ => continue,
                    };
                    if known.len() < 50 && !known.contains(&name) {
                        known.push(name);
                    }
                }
                match (has_named, known.is_empty()) {
                    (true, _) => format!("no part here is {shown}"),
                    (false, true) => format!("there is no part {shown}: there are no parts here"),
                    (false, false) => format!("there is no part {shown}; the parts are {}", list(known)),
                }
            });
        }
        Ok(in_order(all))
    }

    /// The nodes that an axis leads to from a node, the nearest first.
    fn axis(&self, node: Node<'a>, step: &Step) -> Vec<Node<'a>> {
        let mut found = match step.axis {
            Axis::Own => vec![node],
            Axis::Child if step.test == Test::Text => self.texts(node),
            Axis::Child => self.children(node, &step.test),
            Axis::Attribute => self.attributes(node),
            Axis::Parent => self.parent(node).into_iter().collect(),
            Axis::Ancestor => std::iter::successors(self.parent(node), |one| self.parent(*one)).collect(),
            Axis::AncestorOrSelf => std::iter::successors(Some(node), |one| self.parent(*one)).collect(),
            Axis::Descendant | Axis::DescendantOrSelf => {
                self.descendants(node, step.axis == Axis::Descendant)
            }
            Axis::FollowingSibling | Axis::PrecedingSibling => {
                let around = self.parent(node);
                let beside = around.map_or_else(Vec::new, |around| self.children(around, &Test::All));
                let key = node.key();
                match step.axis {
                    Axis::FollowingSibling => beside.into_iter().filter(|one| one.key() > key).collect(),
                    _ => beside.into_iter().rev().filter(|one| one.key() < key).collect(),
                }
            }
        };
        self.spend(1 + found.len());
        found.retain(|one| match (&step.test, one) {
            (Test::All, _) | (Test::Text, Node::Text(..)) => true,
            (Test::Text, Node::Value(variable, value)) => {
                matches!(self.held(*variable, *value), Piece::Text(_))
            }
            (Test::Any, Node::Element(..) | Node::Attribute(..)) => true,
            (Test::Name(name), Node::Element(one, _)) => one.local_name() == name,
            (Test::Name(name), Node::Attribute(one, ..)) => one.local_name() == name,
            _ => false,
        });
        found
    }

    /// The elements in a node. A value that is one element has the parts of that as well, where none of its own is meant.
    fn children(&self, node: Node<'a>, test: &Test) -> Vec<Node<'a>> {
        let inside = |element: Element<'a>, instance| {
            element.children().map(|one| Node::Element(one, instance)).collect::<Vec<_>>()
        };
        match node {
            Node::Value(variable, value) => {
                let (all, instance) = self.inside(variable, value);
                if let ([only], Test::Name(name)) = (all, test)
                    && only.local_name() != name
                {
                    return inside(*only, instance);
                }
                all.iter().map(|one| Node::Element(*one, instance)).collect()
            }
            Node::Element(element, instance) => inside(element, instance),
            Node::Attribute(..) | Node::Text(..) => Vec::new(),
        }
    }

    /// The element that a node is, or that a value is alone.
    fn only(&self, node: Node<'a>) -> Option<(Element<'a>, Option<&'a Instance>)> {
        match node {
            Node::Element(element, instance) => Some((element, instance)),
            Node::Value(variable, value) => match self.inside(variable, value) {
                ([only], instance) => Some((*only, instance)),
                _ => None,
            },
            Node::Attribute(..) | Node::Text(..) => None,
        }
    }

    fn texts(&self, node: Node<'a>) -> Vec<Node<'a>> {
        if let Node::Value(variable, value) = node
            && matches!(self.held(variable, value), Piece::Text(_))
        {
            return vec![node];
        }
        let only = self.only(node).filter(|(element, _)| element.has_text());
        only.map(|(element, instance)| Node::Text(element, instance)).into_iter().collect()
    }

    fn attributes(&self, node: Node<'a>) -> Vec<Node<'a>> {
        let Some((element, instance)) = self.only(node) else { return Vec::new() };
        element.attributes().map(|one| Node::Attribute(one, element, instance)).collect()
    }

    fn descendants(&self, node: Node<'a>, is_behind: bool) -> Vec<Node<'a>> {
        let mut all = Vec::new();
        let mut add = |element: Element<'a>, instance, is_behind| {
            for one in element.descendants().skip(usize::from(is_behind)) {
                if !self.spend(1) {
                    break;
                }
                all.push(Node::Element(one, instance));
            }
        };
        match node {
            Node::Element(element, instance) => add(element, instance, is_behind),
            Node::Value(variable, value) => {
                let (elements, instance) = self.inside(variable, value);
                elements.iter().for_each(|one| add(*one, instance, false));
                if !is_behind {
                    all.insert(0, node);
                }
            }
            Node::Attribute(..) | Node::Text(..) => all.extend((!is_behind).then_some(node)),
        }
        all
    }

    fn parent(&self, node: Node<'a>) -> Option<Node<'a>> {
        match node {
            Node::Value(..) => None,
            Node::Attribute(_, element, instance) | Node::Text(element, instance) => {
                Some(Node::Element(element, instance))
            }
            Node::Element(element, instance) => {
                let top = self.tops().get(&node.key()).copied();
                top.or_else(|| element.parent().map(|one| Node::Element(one, instance)))
            }
        }
    }

    fn tops(&self) -> &HashMap<Key, Node<'a>> {
        self.tops.get_or_init(|| {
            let mut tops = HashMap::new();
            for variable in 0..self.variables.len() {
                for value in 0..self.values(variable).len() {
                    let (all, instance) = self.inside(variable, value);
                    for one in all {
                        tops.insert(Node::Element(*one, instance).key(), Node::Value(variable, value));
                    }
                }
            }
            tops
        })
    }
}

/// A text of a replica, or of what is none.
fn shown(text: crate::source::Text, instance: Option<&Instance>) -> String {
    match instance {
        Some(instance) => instance.text(Cow::Owned(text)).to_string(),
        None => text.to_string(),
    }
}

/// Each node once, in document order.
fn in_order(mut nodes: Vec<Node<'_>>) -> Vec<Node<'_>> {
    if !nodes.is_sorted_by(|one, other| one.key() < other.key()) {
        nodes.sort_by_key(Node::key);
        nodes.dedup_by_key(|one| one.key());
    }
    nodes
}
