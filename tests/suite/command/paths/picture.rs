//! Facts of a picture, read from its SVG as any other program would.

use roxmltree::{Document, Node};

/// A block of the grid.
pub(crate) type Block = (i32, i32);

/// A picture whose blocks are found again by the numbers on its axes.
pub(crate) struct Picture<'a> {
    document: &'a Document<'a>,
    cell: f64,
    /// The upper left corner of block (0,0).
    left: f64,
    top: f64,
}

/// A text and the box that it takes.
#[derive(Debug)]
pub(crate) struct Label {
    pub(crate) text: String,
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl<'a> Picture<'a> {
    pub(crate) fn of(document: &'a Document<'a>) -> Picture<'a> {
        let area = find(document.root(), "area").next().unwrap();
        let (left, top) = (number(area, "x"), number(area, "y"));
        let axis = find(document.root(), "axis").next().unwrap();
        // The first columns with a number, and how far apart they are.
        let columns: Vec<(f64, f64)> = axis
            .children()
            .filter(|node| node.has_tag_name("text") && !node.has_attribute("text-anchor"))
            .map(|node| (node.text().unwrap().parse().unwrap(), number(node, "x")))
            .collect();
        let [(one, here), (other, there), ..] = columns[..] else { panic!("too few columns: {columns:?}") };
        Picture { document, cell: (there - here) / (other - one), left, top }
    }

    /// Elements of this class.
    pub(crate) fn all(&self, class: &'static str) -> Vec<Node<'a, 'a>> {
        find(self.document.root(), class).collect()
    }

    /// The block that holds a point.
    pub(crate) fn block(&self, x: f64, y: f64) -> Block {
        (((x - self.left) / self.cell).floor() as i32, ((y - self.top) / self.cell).floor() as i32)
    }

    /// The blocks that a robot's line leads through, in order.
    pub(crate) fn way(&self, robot: &str) -> Vec<Block> {
        let is_it = |node: &Node<'_, '_>| node.attribute("data-robot") == Some(robot);
        let group = self.all("robot").into_iter().find(is_it).unwrap();
        let line = find(group, "path").next().unwrap().attribute("d").unwrap();
        let mut blocks = Vec::new();
        let mut last: Option<(f64, f64)> = None;
        for (x, y) in points(line) {
            let (from_x, from_y) = last.replace((x, y)).unwrap_or((x, y));
            // Finely enough to meet each block on the way.
            for step in 0..=100 {
                let part = f64::from(step) / 100.0 * if from_x == x && from_y == y { 0.0 } else { 1.0 };
                let block = self.block(from_x + (x - from_x) * part, from_y + (y - from_y) * part);
                if blocks.last() != Some(&block) {
                    blocks.push(block);
                }
            }
        }
        blocks
    }

    /// All texts but the hints that a screen shows.
    pub(crate) fn labels(&self) -> Vec<Label> {
        self.document.descendants().filter(|node| node.has_tag_name("text")).map(label).collect()
    }

    pub(crate) fn size(&self) -> (f64, f64) {
        let root = self.document.root_element();
        (number(root, "width"), number(root, "height"))
    }

    /// Fails where two texts overlap, or one leaves the paper.
    #[track_caller]
    pub(crate) fn assert_readable(&self) {
        let (width, height) = self.size();
        let labels = self.labels();
        for (place, one) in labels.iter().enumerate() {
            let inside = one.left >= 0.0 && one.top >= 0.0 && one.right <= width && one.bottom <= height;
            assert!(inside, "{one:?} leaves the paper of {width} x {height}");
            for other in &labels[..place] {
                let apart = one.right <= other.left
                    || other.right <= one.left
                    || one.bottom <= other.top
                    || other.bottom <= one.top;
                assert!(apart, "{one:?} and {other:?} overlap");
            }
        }
    }
}

fn find<'a>(node: Node<'a, 'a>, class: &'static str) -> impl Iterator<Item = Node<'a, 'a>> {
    let has = move |node: &Node<'_, '_>| {
        node.attribute("class").is_some_and(|classes| classes.split(' ').any(|one| one == class))
    };
    node.descendants().filter(has)
}

fn number(node: Node<'_, '_>, attribute: &str) -> f64 {
    node.attribute(attribute).unwrap().parse().unwrap()
}

/// The nearest of an attribute on the way to the root, as SVG inherits it.
fn inherited<'a>(node: Node<'a, 'a>, attribute: &str) -> Option<&'a str> {
    node.ancestors().find_map(|node| node.attribute(attribute))
}

/// The box of a text in a common font without serifs: letters are 0.56 em wide on average, figures as well.
fn label(node: Node<'_, '_>) -> Label {
    let text = node.text().unwrap_or_default().to_owned();
    let font: f64 = inherited(node, "font-size").unwrap().parse().unwrap();
    let (x, y) = (number(node, "x"), number(node, "y"));
    let width = 0.56 * font * text.chars().count() as f64;
    let left = match inherited(node, "text-anchor") {
        Some("middle") => x - width / 2.0,
        Some("end") => x - width,
        _ => x,
    };
    // Figures and capitals have no descenders worth counting.
    Label { text, left, top: y - 0.72 * font, right: left + width, bottom: y + 0.05 * font }
}

/// The points that a line of M, L and Q leads to. A bend is within its block, and is cut short.
fn points(line: &str) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for part in line.split_inclusive(|sign: char| sign.is_ascii_alphabetic()) {
        let numbers: Vec<f64> = part
            .trim_end_matches(|sign: char| sign.is_ascii_alphabetic())
            .split_whitespace()
            .map(|number| number.parse().unwrap())
            .collect();
        points.extend(numbers.chunks(2).map(|pair| (pair[0], pair[1])));
    }
    points
}
