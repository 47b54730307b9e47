//! The sizes of components and what is in them.

use std::rc::Rc;

use super::{Layout, Point, layout};
use crate::graph::diagram::{DiagramComponent, DiagramSetting, Port};
use crate::graph::text::{end, short, width};

/// All boxes and lines stand on a grid of so many pixels: two lines are one or well apart.
pub(in crate::graph) const GRID: i32 = 8;
/// From one service or reference to the next.
const PITCH: i32 = 2 * GRID;
/// Half the length of a chevron, which sticks out of its box so far.
pub(in crate::graph) const CHEVRON: i32 = 9;
/// The least room at a side for the label of a service or reference: behind its chevron.
pub(in crate::graph) const LABEL: i32 = CHEVRON + 4;
/// The sizes of texts.
pub(in crate::graph) const NAME_SIZE: i32 = 13;
pub(in crate::graph) const SMALL_SIZE: i32 = 10;
pub(in crate::graph) const CHIP_SIZE: i32 = 9;
pub(in crate::graph) const CHIP_HEIGHT: i32 = 14;

/// A property: a box with its name.
#[derive(Clone, Debug)]
pub(in crate::graph) struct Chip {
    pub(in crate::graph) x: i32,
    pub(in crate::graph) y: i32,
    pub(in crate::graph) width: i32,
    pub(in crate::graph) text: String,
}

/// The drawing of a component; all places are from its upper left corner.
#[derive(Clone, Debug)]
pub(in crate::graph) struct Plan {
    pub(in crate::graph) width: i32,
    pub(in crate::graph) height: i32,
    /// The start of the body: properties stick out of it.
    pub(in crate::graph) body: i32,
    /// The lines of name and class.
    pub(in crate::graph) name: i32,
    pub(in crate::graph) class: i32,
    pub(in crate::graph) name_text: String,
    pub(in crate::graph) class_text: String,
    pub(in crate::graph) services: Vec<String>,
    pub(in crate::graph) references: Vec<String>,
    pub(in crate::graph) chips: Vec<Chip>,
    /// The first service and the first reference.
    first: i32,
    /// The height of the line to topics on the left.
    pub(in crate::graph) topics: Option<i32>,
    /// The picture of what is inside, and where it starts.
    pub(in crate::graph) inside: Option<(Rc<Layout>, Point)>,
}

impl Plan {
    pub(in crate::graph) fn of(component: &DiagramComponent, has_topics: bool) -> Self {
        let label = component.label();
        let name_text = short(if label.is_empty() { "?" } else { &label }, 32);
        let class_text = end(&component.class, 36);
        let labels = |ports: &[Port]| ports.iter().map(|port| short(&port.name, 28)).collect();
        let services: Vec<String> = labels(&component.services);
        let references: Vec<String> = labels(&component.references);
        let rows = services.len().max(references.len());
        let row = |at: usize| {
            let wide = |labels: &[String]| labels.get(at).map_or(0, |label| width(label, SMALL_SIZE, false));
            wide(&services) + wide(&references) + 2 * LABEL + 10
        };
        let texts = [width(&name_text, NAME_SIZE, true), width(&class_text, SMALL_SIZE, false)];
        let texts = texts.into_iter().map(|text| text + 20);
        let inside = (0..rows).map(row).chain(texts).chain([96]).max().unwrap_or_default();
        let (chips, chips_width, chips_height) = chips(&component.properties, (inside - 16).max(184));
        // The first row sticks out of the body, the others are in it.
        let body = if chips.is_empty() { 0 } else { GRID };
        let top = chips_height;
        let header = if class_text.is_empty() { 3 * GRID } else { 5 * GRID };
        let ports = top + header + PITCH * rows as i32;
        let topics = has_topics.then_some(ports + GRID);
        let mut width = on_grid(inside.max(chips_width + 16));
        let mut height = if has_topics || rows > 0 { ports + 2 * GRID } else { ports + GRID };
        let inside = component.inside.as_deref().map(|diagram| {
            let picture = layout(diagram, false);
            // On both sides is room for the lines of what it promotes.
            width = width.max(on_grid(picture.width) + 4 * GRID);
            let at = Point { x: (width - picture.width) / 2, y: height };
            height += on_grid(picture.height) + GRID;
            (Rc::new(picture), at)
        });
        Self {
            width,
            height,
            body,
            name: top + 18,
            class: top + 32,
            name_text,
            class_text,
            services,
            references,
            chips,
            first: top + header + GRID,
            topics,
            inside,
        }
    }

    /// The line of a service or a reference.
    pub(in crate::graph) fn port(&self, place: usize) -> i32 {
        self.first + PITCH * place as i32
    }
}

/// The next place on the grid.
pub(in crate::graph) fn on_grid(length: i32) -> i32 {
    (length + GRID - 1) / GRID * GRID
}

/// Properties in rows that are at most so wide, unless one alone is wider; how wide and how high they are together.
pub(in crate::graph) fn chips(settings: &[DiagramSetting], most: i32) -> (Vec<Chip>, i32, i32) {
    const GAP: i32 = 4;
    let mut chips: Vec<Chip> = Vec::with_capacity(settings.len());
    let (mut x, mut y, mut widest) = (0, 0, 0);
    for setting in settings {
        let text = short(&setting.name, 24);
        let width = width(&text, CHIP_SIZE, false) + 8;
        if x > 0 && x + width > most {
            (x, y) = (0, y + PITCH);
        }
        chips.push(Chip { x: x + GRID, y, width, text });
        widest = widest.max(x + width);
        x += width + GAP;
    }
    let height = if chips.is_empty() { 0 } else { y + PITCH };
    (chips, widest, height)
}
