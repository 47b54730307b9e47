//! Topics: a rail for each, and lines of components down to them.

use super::lines::{Owner, Routes};
use super::measure::{GRID, SMALL_SIZE};
use super::{Line, LineKind, Mark, Point, Rail, Rect, Sides};
use crate::graph::diagram::Diagram;
use crate::graph::text::{short, width};

/// From one rail to the next.
const PITCH: i32 = 3 * GRID;
/// The height of a label.
const LABEL_HEIGHT: i32 = 2 * GRID;

/// The height of so many rails.
pub(super) fn height(count: usize) -> i32 {
    if count == 0 { 0 } else { PITCH * count as i32 + 2 * GRID }
}

/// The width of the widest label.
pub(super) fn label_width(diagram: &Diagram) -> i32 {
    diagram.topics.iter().map(|topic| width(&label(&topic.name), SMALL_SIZE, false) + 20).max().unwrap_or(0)
}

fn label(name: &str) -> String {
    short(name, 32)
}

/// The rails from `top` on, and what components do with them; the lines of components are drawn into `lines` of the
/// layout.
pub(super) fn draw(
    diagram: &Diagram,
    routes: &Routes,
    sides: &Sides<'_>,
    channels: &[i32],
    top: i32,
) -> (Vec<Rail>, Vec<Mark>, Vec<Line>) {
    let left = sides.origin.x + sides.lefts.get(1).copied().unwrap_or(0);
    let mut rails: Vec<Rail> = Vec::with_capacity(diagram.topics.len());
    for (place, topic) in diagram.topics.iter().enumerate() {
        let text = label(&topic.name);
        let width = width(&text, SMALL_SIZE, false) + 20;
        let label = Rect { x: left, y: top + PITCH * place as i32 + GRID, width, height: LABEL_HEIGHT };
        rails.push(Rail { label, text, from: left, to: left + width });
    }
    // What each component does with which topics.
    let mut uses: Vec<Vec<(usize, bool, bool)>> = vec![Vec::new(); diagram.components.len()];
    for (topic, ends) in diagram.topics.iter().enumerate() {
        for &component in &ends.publishers {
            uses[component].push((topic, true, false));
        }
        for &component in &ends.subscribers {
            match uses[component].last_mut().filter(|last| last.0 == topic) {
                Some(last) => last.2 = true,
                None => uses[component].push((topic, false, true)),
            }
        }
    }
    let (mut marks, mut lines) = (Vec::new(), Vec::new());
    for (channel, all) in routes.channels.iter().enumerate() {
        for route in all {
            let (Owner::Topics(component), Some(pin)) = (route.owner, route.right.first()) else { continue };
            let x = routes.track(route, channel, channels, sides.origin);
            let y = sides.origin.y + sides.items.line(*pin);
            let mut lowest = y;
            for &(topic, publishes, reads) in &uses[component] {
                let rail = &mut rails[topic];
                let at = Point { x, y: rail.label.y + LABEL_HEIGHT / 2 };
                (rail.from, rail.to) = (rail.from.min(x - GRID), rail.to.max(x + GRID));
                lowest = lowest.max(at.y);
                marks.push(Mark { at, topic, publishes, reads });
            }
            let (end, beside) = (sides.of(pin.item).0, y + route.strand.nudge);
            let point = |x, y| Point { x, y };
            let mut parts = vec![(point(x, lowest), point(x, beside)), (point(x, beside), point(end, beside))];
            if beside != y {
                parts.push((point(end, beside), point(end, y)));
            }
            lines.push(Line { kind: LineKind::Topics, parts, dots: Vec::new() });
        }
    }
    (rails, marks, lines)
}
