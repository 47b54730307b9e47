//! Layout: places for everything in a picture.
//!
//! Components stand in columns, each to the right of what calls it; lines run between columns on tracks of their own;
//! topics are rails below all columns, to which each component has one line.

mod items;
mod layers;
mod lines;
pub(in crate::graph) mod measure;
mod order;
mod place;
mod rails;
mod route;
#[cfg(test)]
mod tests;

use std::rc::Rc;

use items::{Items, Kind};
use lines::Routes;
use measure::{CHEVRON, Chip, GRID, NAME_SIZE, Plan, SMALL_SIZE, chips, on_grid};

use super::diagram::{Diagram, DiagramEnd, LinkKind};
use super::text::{short, width};

/// A place in pixels, from the upper left corner of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Point {
    pub(super) x: i32,
    pub(super) y: i32,
}

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Rect {
    pub(super) x: i32,
    pub(super) y: i32,
    pub(super) width: i32,
    pub(super) height: i32,
}

/// The meaning of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineKind {
    Wire,
    Promotion,
    /// From a component to its topics.
    Topics,
}

impl From<LinkKind> for LineKind {
    fn from(kind: LinkKind) -> Self {
        match kind {
            LinkKind::Wire => Self::Wire,
            LinkKind::Promotion => Self::Promotion,
        }
    }
}

/// Parts of lines between two points each, all horizontal or vertical, and dots where they join.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) kind: LineKind,
    pub(super) parts: Vec<(Point, Point)>,
    pub(super) dots: Vec<Point>,
}

/// A component in its place.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    /// All of it, with what sticks out above.
    pub(super) rect: Rect,
    pub(super) plan: Rc<Plan>,
}

/// A topic.
#[derive(Clone, Debug)]
pub(super) struct Rail {
    pub(super) label: Rect,
    pub(super) text: String,
    /// The ends of the rail, in the middle of the label's height.
    pub(super) from: i32,
    pub(super) to: i32,
}

/// The mark where the line of a component meets the rail of a topic: it publishes, subscribes or both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark {
    pub(super) at: Point,
    pub(super) topic: usize,
    pub(super) publishes: bool,
    pub(super) reads: bool,
}

/// A picture.
#[derive(Debug, Default)]
pub(super) struct Layout {
    pub(super) width: i32,
    pub(super) height: i32,
    /// The box of the composite.
    pub(super) frame: Rect,
    /// The distance of its name below the usual place, below its properties.
    pub(super) name: i32,
    /// Its properties.
    pub(super) chips: Vec<Chip>,
    /// The middles of its services and references.
    pub(super) services: Vec<Point>,
    pub(super) references: Vec<Point>,
    pub(super) components: Vec<Placed>,
    pub(super) lines: Vec<Line>,
    pub(super) rails: Vec<Rail>,
    pub(super) marks: Vec<Mark>,
}

/// Pictures are made to fill screens of this shape.
const WIDTH_TO_HEIGHT: f64 = 1.6;
/// Above so many components only one shape is tried.
const MANY: usize = 400;
/// Space around the picture.
const AROUND: i32 = 2 * GRID;
/// The line with the name of the composite.
const TITLE: i32 = 4 * GRID;
/// The legend below.
pub(super) const LEGEND: i32 = 4 * GRID;
/// The least width of a picture: that of the legend.
const LEAST_WIDTH: i32 = 640;

/// Lays out a diagram in the shape that fills a screen best: as a whole picture with a legend, or to stand inside
/// another one.
pub(super) fn layout(diagram: &Diagram, is_whole: bool) -> Layout {
    let mut has_topics = vec![false; diagram.components.len()];
    for topic in &diagram.topics {
        for &end in topic.publishers.iter().chain(&topic.subscribers) {
            has_topics[end] = true;
        }
    }
    let components = diagram.components.iter().zip(has_topics);
    let plans: Vec<Rc<Plan>> = components.map(|(component, topics)| Rc::new(Plan::of(component, topics))).collect();
    let count = plans.len();
    let all: Vec<usize> = match count {
        0 => vec![1],
        MANY.. => vec![(count as f64 * 1.5).sqrt() as usize],
        _ => [1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 30, count].into_iter().filter(|rows| *rows <= count).collect(),
    };
    let layouts = all.into_iter().map(|rows| in_rows(diagram, &plans, rows, is_whole));
    let size = |layout: &Layout| (f64::from(layout.width) / WIDTH_TO_HEIGHT).max(f64::from(layout.height));
    layouts.min_by(|one, other| size(one).total_cmp(&size(other))).unwrap_or_default()
}

/// Lays out a diagram with at most so many components above each other.
fn in_rows(diagram: &Diagram, plans: &[Rc<Plan>], rows: usize, is_whole: bool) -> Layout {
    let wires: Vec<(usize, usize)> = diagram
        .links
        .iter()
        .filter_map(|link| match (link.from, link.to) {
            (DiagramEnd::Component { component: from, .. }, DiagramEnd::Component { component: to, .. }) => {
                Some((from, to))
            }
            _ => None,
        })
        .collect();
    let (around, legend, least) = if is_whole { (AROUND, LEGEND, LEAST_WIDTH) } else { (0, 0, 0) };
    let columns = layers::columns(plans.len(), &wires, rows);
    let mut items = Items::of(diagram, plans, &columns);
    order::order(&mut items);
    place::place(&mut items);
    let routes = Routes::of(diagram, plans, &items);
    let widths = column_widths(diagram, plans, &items);
    let (lefts, channels, right) = routes.columns(&widths);

    let (chips, _, chips_height) = chips(&diagram.properties, (right - 2 * GRID).max(184));
    // The first row of properties sticks out of the frame, the others are in it.
    let name = (chips_height - 2 * GRID).max(0);
    let title = name + TITLE.max(GRID * routes.lanes() + TITLE);
    let longest = |names: Vec<&str>| names.into_iter().map(|name| width(&border(name), SMALL_SIZE, false)).max();
    let outside = |names: Vec<&str>| longest(names).map_or(0, |width| width + CHEVRON + 4);
    let left_labels = outside(diagram.services.iter().map(|port| &*port.name).collect());
    let right_labels = outside(diagram.references.iter().map(|port| &*port.name).collect());
    let origin = Point { x: around + left_labels, y: around + if chips.is_empty() { 0 } else { GRID } + GRID + title };

    let bottom = items.height();
    let title_width = width(&heading(&diagram.name), NAME_SIZE + 2, true) + 4 * GRID;
    let chips_end = chips.iter().map(|chip| chip.x + chip.width + GRID).max().unwrap_or(0);
    let inside = on_grid(right.max(title_width).max(chips_end));
    let frame = Rect {
        x: origin.x,
        y: origin.y - title,
        width: inside,
        height: title + bottom + 2 * GRID + rails::height(diagram.topics.len()),
    };
    let mut layout = Layout {
        width: (frame.x + frame.width + right_labels + around).max(least),
        height: frame.y + frame.height + around + legend,
        frame,
        name,
        chips: chips.into_iter().map(|chip| Chip { x: frame.x + chip.x, y: frame.y - GRID + chip.y, ..chip }).collect(),
        ..Layout::default()
    };
    layout.services = vec![Point::default(); diagram.services.len()];
    layout.references = vec![Point::default(); diagram.references.len()];
    let mut components: Vec<Option<Placed>> = vec![None; plans.len()];
    for item in &items.items {
        let y = origin.y + item.y;
        match item.kind {
            Kind::Service(place) => layout.services[place] = Point { x: frame.x, y: y + GRID },
            Kind::Reference(place) => {
                layout.references[place] = Point { x: frame.x + frame.width, y: y + GRID };
            }
            Kind::Component(place) => {
                let plan = Rc::clone(&plans[place]);
                let free = widths[item.column] - plan.width;
                let x = origin.x + lefts[item.column] + free / 2;
                let rect = Rect { x, y, width: plan.width, height: plan.height };
                components[place] = Some(Placed { rect, plan });
            }
            Kind::Pass => {}
        }
    }
    layout.components = components.into_iter().flatten().collect();
    let sides = Sides { items: &items, layout: &layout, lefts: &lefts, widths: &widths, origin };
    // Those of topics first: the others are drawn over them.
    let (rails, marks, mut lines) = rails::draw(diagram, &routes, &sides, &channels, origin.y + bottom + 2 * GRID);
    lines.extend(routes.draw(&sides, &channels, frame.y + name + TITLE));
    (layout.rails, layout.marks, layout.lines) = (rails, marks, lines);
    layout
}

/// The name of a composite as it is shown.
pub(super) fn heading(name: &str) -> String {
    short(name, 80)
}

/// The name of a service or reference of a composite as it is shown.
pub(super) fn border(name: &str) -> String {
    short(name, 40)
}

/// The left and right ends of items.
struct Sides<'a> {
    items: &'a Items,
    layout: &'a Layout,
    lefts: &'a [i32],
    widths: &'a [i32],
    origin: Point,
}

impl Sides<'_> {
    /// The start of lines on the right of an item: lines that pass by start at its left end, so that they are whole.
    fn start(&self, item: usize) -> i32 {
        let (left, right) = self.of(item);
        if self.items.items[item].kind == Kind::Pass { left } else { right }
    }

    /// The left and the right end of an item.
    fn of(&self, item: usize) -> (i32, i32) {
        let item = &self.items.items[item];
        match item.kind {
            Kind::Component(place) => {
                let rect = self.layout.components[place].rect;
                (rect.x, rect.x + rect.width)
            }
            Kind::Service(place) => (self.layout.services[place].x, self.layout.services[place].x),
            Kind::Reference(place) => (self.layout.references[place].x, self.layout.references[place].x),
            Kind::Pass => {
                let left = self.origin.x + self.lefts[item.column];
                (left, left + self.widths[item.column])
            }
        }
    }
}

/// The width of each column; labels of topics stand below the first one with components.
fn column_widths(diagram: &Diagram, plans: &[Rc<Plan>], items: &Items) -> Vec<i32> {
    let widest = |column: &Vec<usize>| {
        let widths = column.iter().map(|&item| match items.items[item].kind {
            Kind::Component(place) => plans[place].width,
            _ => 0,
        });
        widths.max().unwrap_or(0)
    };
    let mut widths: Vec<i32> = items.columns.iter().map(widest).collect();
    if widths.len() > 2 {
        widths[1] = widths[1].max(rails::label_width(diagram));
    }
    widths
}
