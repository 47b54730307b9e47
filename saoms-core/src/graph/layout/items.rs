//! What stands in columns, and what joins it: components, parts of the composite at its borders, and lines that pass by.

use std::collections::HashMap;

use super::measure::{GRID, Plan};
use crate::graph::diagram::{Diagram, End, LinkKind};

/// What stands in a column.
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// A wire that leads to the same column, or back to an earlier one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Back {
    pub(super) from: Pin,
    pub(super) to: Pin,
}

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
    pub(super) fn of(diagram: &Diagram, plans: &[Plan], columns: &[Vec<usize>]) -> Self {
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
        let pin = |all: &Self, end: End, is_called: bool| match (end, is_called) {
            (End::Component { component, port }, _) => {
                Pin { item: all.components[component], offset: plans[component].port(port) }
            }
            (End::Composite(place), true) => Pin { item: references[place], offset: GRID },
            (End::Composite(place), false) => Pin { item: services[place], offset: GRID },
        };
        let mut nets: HashMap<(LinkKind, End), Vec<Pin>> = HashMap::new();
        let mut order = Vec::new();
        for link in &diagram.links {
            let (from, to) = (pin(&all, link.from, false), pin(&all, link.to, true));
            if all.items[from.item].column < all.items[to.item].column {
                let sources = nets.entry((link.kind, link.to)).or_default();
                if sources.is_empty() {
                    order.push((link.kind, link.to));
                }
                sources.push(from);
            } else {
                all.backs.push(Back { from, to });
            }
        }
        for key in order {
            let to = pin(&all, key.1, true);
            all.net(key.0, &nets[&key], to);
        }
        all
    }

    fn add(&mut self, kind: Kind, column: usize, height: i32) -> usize {
        self.items.push(Item { kind, column, height, y: 0 });
        self.columns[column].push(self.items.len() - 1);
        self.items.len() - 1
    }

    /// Joins sources to their target through all columns between.
    fn net(&mut self, kind: LinkKind, sources: &[Pin], to: Pin) {
        let net = self.nets.len();
        self.nets.push(kind);
        let column = |all: &Self, pin: &Pin| all.items[pin.item].column;
        let target = column(self, &to);
        let Some(first) = sources.iter().map(|pin| column(self, pin)).min() else { return };
        let mut passing: Option<Pin> = None;
        for at in first..target {
            let right = if at + 1 == target {
                to
            } else {
                Pin { item: self.add(Kind::Pass, at + 1, GRID), offset: 0 }
            };
            let here: Vec<Pin> = sources.iter().filter(|pin| column(self, pin) == at).copied().collect();
            for left in here.into_iter().chain(passing) {
                self.joints.push(Joint { net, left, right });
            }
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
