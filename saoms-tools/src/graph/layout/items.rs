//! Items of columns and the links between them: components, parts of the composite at its borders, and lines that pass
//! by.

use std::collections::HashMap;
use std::rc::Rc;

use super::measure::{GRID, Plan};
use crate::graph::diagram::{Diagram, DiagramEnd, LinkKind};

/// An item of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Component(usize),
    /// A service of the composite, in the first column.
    Service(usize),
    /// A reference of the composite, in the last column.
    Reference(usize),
    /// A line on its way to a column further on.
    Pass,
}

#[derive(Clone, Debug)]
pub(super) struct Item {
    pub(super) kind: Kind,
    pub(super) column: usize,
    pub(super) height: i32,
    /// Its upper end.
    pub(super) y: i32,
}

/// A point of an item where a line ends, from the item's upper end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Pin {
    pub(super) item: usize,
    pub(super) offset: i32,
}

/// A line from a column to the next one. Lines of one net are drawn together: they lead to the same place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub(super) net: usize,
    pub(super) left: Pin,
    pub(super) right: Pin,
}

/// Wires to one place that lead to the same column or back to an earlier one, or too far: they go above all columns.
#[derive(Clone, Debug)]
pub(super) struct Back {
    pub(super) kind: LinkKind,
    pub(super) from: Vec<Pin>,
    pub(super) to: Pin,
}

/// Lines that pass by columns, for each link and component and for any picture: long ways of wires could have as many
/// as the product of both.
const PASSES: (usize, usize) = (2, 1_000);

/// Columns with their items from top to bottom; the first and the last hold what the composite promotes.
#[derive(Debug, Default)]
pub(super) struct Items {
    pub(super) items: Vec<Item>,
    pub(super) columns: Vec<Vec<usize>>,
    pub(super) joints: Vec<Joint>,
    pub(super) backs: Vec<Back>,
    /// The kind of each net.
    pub(super) nets: Vec<LinkKind>,
    /// The item of each component.
    pub(super) components: Vec<usize>,
}

impl Items {
    pub(super) fn of(diagram: &Diagram, plans: &[Rc<Plan>], columns: &[Vec<usize>]) -> Self {
        let mut all = Self { components: vec![0; plans.len()], ..Self::default() };
        all.columns = vec![Vec::new(); columns.len() + 2];
        let last = columns.len() + 1;
        let ports = |count: usize, kind: fn(usize) -> Kind| (0..count).map(kind).collect::<Vec<_>>();
        let add = |all: &mut Self, kinds: Vec<Kind>, column| {
            kinds.into_iter().map(|kind| all.add(kind, column, 2 * GRID)).collect::<Vec<_>>()
        };
        let services = add(&mut all, ports(diagram.services.len(), Kind::Service), 0);
        let references = add(&mut all, ports(diagram.references.len(), Kind::Reference), last);
        for (place, column) in columns.iter().enumerate() {
            for &component in column {
                let item = all.add(Kind::Component(component), place + 1, plans[component].height);
                all.components[component] = item;
            }
        }
        let pin = |all: &Self, end: DiagramEnd, is_called: bool| match (end, is_called) {
            (DiagramEnd::Component { component, port }, _) => {
                Pin { item: all.components[component], offset: plans[component].port(port) }
            }
            (DiagramEnd::Composite(place), true) => Pin { item: references[place], offset: GRID },
            (DiagramEnd::Composite(place), false) => Pin { item: services[place], offset: GRID },
        };
        let mut nets: HashMap<(LinkKind, DiagramEnd, bool), Vec<Pin>> = HashMap::new();
        let mut order = Vec::new();
        for link in &diagram.links {
            let (from, to) = (pin(&all, link.from, false), pin(&all, link.to, true));
            let leads_on = all.items[from.item].column < all.items[to.item].column;
            let key = (link.kind, link.to, leads_on);
            let sources = nets.entry(key).or_default();
            if sources.is_empty() {
                order.push(key);
            }
            sources.push(from);
        }
        let mut passes = PASSES.0 * (plans.len() + diagram.links.len()) + PASSES.1;
        for key @ (kind, to, leads_on) in order {
            let mut sources = nets.remove(&key).unwrap_or_default();
            let to = pin(&all, to, true);
            let column = |pin: &Pin| all.items[pin.item].column;
            let first = sources.iter().map(column).min().unwrap_or_default();
            let between = column(&to).saturating_sub(first + 1);
            if leads_on && between <= passes {
                passes -= between;
                sources.sort_by_key(column);
                all.net(kind, &sources, to);
            } else {
                all.backs.push(Back { kind, from: sources, to });
            }
        }
        all
    }

    fn add(&mut self, kind: Kind, column: usize, height: i32) -> usize {
        self.items.push(Item { kind, column, height, y: 0 });
        self.columns[column].push(self.items.len() - 1);
        self.items.len() - 1
    }

    /// Joins sources to their target through all columns between. They are in the order of their columns.
    fn net(&mut self, kind: LinkKind, sources: &[Pin], to: Pin) {
        let net = self.nets.len();
        self.nets.push(kind);
        let column = |all: &Self, pin: &Pin| all.items[pin.item].column;
        let target = column(self, &to);
        let Some(first) = sources.first().map(|pin| column(self, pin)) else { return };
        let mut sources = sources.iter().copied().peekable();
        let mut passing: Option<Pin> = None;
        for at in first..target {
            let right = if at + 1 == target { to } else { Pin { item: self.add(Kind::Pass, at + 1, GRID), offset: 0 } };
            while let Some(left) = sources.next_if(|pin| column(self, pin) == at) {
                self.joints.push(Joint { net, left, right });
            }
            self.joints.extend(passing.map(|left| Joint { net, left, right }));
            passing = Some(right);
        }
    }

    /// The line of a pin in the picture.
    pub(super) fn line(&self, pin: Pin) -> i32 {
        self.items[pin.item].y + pin.offset
    }

    /// The lower end of the lowest item.
    pub(super) fn height(&self) -> i32 {
        self.items.iter().map(|item| item.y + item.height).max().unwrap_or(0)
    }
}
