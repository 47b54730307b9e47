//! Paths as lines, in the manner of a map of a city's railways.

use std::collections::BTreeSet;

use super::frame::Frame;
use super::lanes::Lanes;
use super::palette::{Look, look};
use super::path::{Leg, Path};
use super::svg::{Svg, number};

/// A point on the paper.
type Point = (f64, f64);

/// The distance from a turn at which the line begins to bend.
const BEND: f64 = 6.0;

/// Arrows stand so many blocks apart.
const ARROWS: u32 = 4;

/// The lines of all robots.
pub(super) struct Lines<'a> {
    pub(super) frame: &'a Frame,
    pub(super) lanes: &'a Lanes,
    /// From one lane to the next.
    pub(super) spacing: f64,
}

/// The begin and the end of a path on the paper.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    pub(super) start: Point,
    pub(super) end: Point,
}

impl Lines<'_> {
    pub(super) fn width(&self) -> f64 {
        (self.spacing * 0.64).clamp(1.2, 3.0)
    }

    /// Draws the path of the robot that comes at this place.
    pub(super) fn draw(&self, svg: &mut Svg, place: usize, path: &Path) -> Ends {
        let look = look(place);
        let runs = self.runs(path, &self.lanes.offsets[place]);
        let mut straight = String::new();
        let mut unheard = String::new();
        for run in &runs {
            let line = if run.jump { &mut unheard } else { &mut straight };
            line.push_str(&bent(&run.points));
        }
        let width = self.width();
        if !straight.is_empty() {
            let dash = dashes(&look, width);
            svg.leaf("path", format_args!(
                r#"class="path" d="{straight}" fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round"{dash}"#,
                look.colour, number(width)
            ));
        }
        if !unheard.is_empty() {
            svg.leaf(
                "path",
                format_args!(
                    r#"class="unheard" d="{unheard}" fill="none" stroke="{}" stroke-width="1" stroke-dasharray="2 4""#,
                    look.colour
                ),
            );
        }
        self.draw_arrows(svg, path, &self.lanes.offsets[place], look.colour);
        let middle = self.frame.middle(path.start);
        let start = runs.first().and_then(|run| run.points.first()).copied().unwrap_or(middle);
        let end = runs.last().and_then(|run| run.points.last()).copied().unwrap_or(start);
        Ends { start, end }
    }

    /// The points of the legs, in runs that belong together.
    fn runs(&self, path: &Path, offsets: &[f64]) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for (place, leg) in path.legs.iter().enumerate() {
            if leg.jump {
                let from = runs.last().and_then(|run| run.points.last()).copied();
                let from = from.unwrap_or(self.frame.middle(leg.from));
                let next = path.legs.get(place + 1).filter(|next| !next.jump);
                let to =
                    next.map_or(self.frame.middle(leg.to), |next| self.end_of(next, offsets[place + 1], leg.to, None));
                runs.push(Run { jump: true, points: vec![from, to] });
                continue;
            }
            let beside = |other: Option<usize>| {
                let other = other.filter(|other| path.legs.get(*other).is_some_and(|leg| !leg.jump))?;
                let turns = path.legs[other].is_level() != leg.is_level();
                turns.then_some(offsets[other])
            };
            let from = self.end_of(leg, offsets[place], leg.from, beside(place.checked_sub(1)));
            let to = self.end_of(leg, offsets[place], leg.to, beside(Some(place + 1)));
            if runs.last().is_none_or(|run| run.jump) {
                runs.push(Run { jump: false, points: Vec::new() });
            }
            if let Some(run) = runs.last_mut() {
                for point in [from, to] {
                    if run.points.last() != Some(&point) {
                        run.points.push(point);
                    }
                }
            }
        }
        runs
    }

    /// The point at which a leg in this lane meets the block at one of its ends: in the middle, or in the lane of the
    /// leg that it turns into.
    fn end_of(&self, leg: &Leg, offset: f64, block: crate::grid::Block, turn: Option<f64>) -> Point {
        let (x, y) = self.frame.middle(block);
        let (own, other) = (offset * self.spacing, turn.unwrap_or(0.0) * self.spacing);
        if leg.is_level() { (x + other, y + own) } else { (x + own, y + other) }
    }

    /// Arrows stand where two blocks meet, so that they are clear of everything that is drawn in blocks.
    fn draw_arrows(&self, svg: &mut Svg, path: &Path, offsets: &[f64], colour: &str) {
        let (half, long) = ((self.width() * 1.5).max(1.8), (self.width() * 2.9).max(3.6));
        let mut drawn = BTreeSet::new();
        let mut arrows = String::new();
        for (leg, offset) in path.legs.iter().zip(offsets).filter(|(leg, _)| !leg.jump) {
            let length = leg.from.distance(leg.to);
            let level = leg.is_level();
            let (x, y) = self.frame.middle(leg.from);
            let sign = if leg.is_forward() { 1.0 } else { -1.0 };
            let first = if length <= ARROWS { (length - 1) / 2 } else { 1 };
            // Neighbours take turns, so that their arrows do not touch.
            let stagger = if offset.rem_euclid(2.0) < 1.0 { 0.0 } else { long * 0.9 };
            for at in (first..length).step_by(ARROWS as usize) {
                let along = sign * ((f64::from(at) + 0.5) * self.frame.cell + stagger + long / 2.0);
                let across = offset * self.spacing;
                let (x, y) = if level { (x + along, y + across) } else { (x + across, y + along) };
                let key = ((x * 10.0).round() as i64, (y * 10.0).round() as i64, level, leg.is_forward());
                if !drawn.insert(key) {
                    continue;
                }
                let back = -sign * long;
                let corners = if level { [(back, -half), (back, half)] } else { [(-half, back), (half, back)] };
                let [one, other] = corners.map(|(dx, dy)| format!("{} {}", number(x + dx), number(y + dy)));
                arrows.push_str(&format!("M{} {}L{one}L{other}z", number(x), number(y)));
            }
        }
        if !arrows.is_empty() {
            svg.leaf(
                "path",
                format_args!(r##"class="arrows" d="{arrows}" fill="{colour}" stroke="#fff" stroke-width="0.7""##),
            );
        }
    }
}

struct Run {
    jump: bool,
    points: Vec<Point>,
}

/// The attribute that makes a line dashed, with a blank before it; nothing for a whole line.
pub(super) fn dashes(look: &Look, width: f64) -> String {
    if look.dash.is_empty() {
        return String::new();
    }
    let lengths: Vec<String> = look.dash.iter().map(|length| number(length * width).to_string()).collect();
    format!(r#" stroke-dasharray="{}""#, lengths.join(" "))
}

/// A line through the points that bends before it turns.
fn bent(points: &[Point]) -> String {
    let mut line = String::new();
    for (place, (x, y)) in points.iter().enumerate() {
        let around = place.checked_sub(1).zip(points.get(place + 1));
        let Some((before, after)) = around.map(|(before, after)| (points[before], *after)) else {
            let verb = if place == 0 { 'M' } else { 'L' };
            line.push_str(&format!("{verb}{} {}", number(*x), number(*y)));
            continue;
        };
        let toward = |(ox, oy): Point| {
            let (dx, dy) = (ox - x, oy - y);
            let length = dx.hypot(dy);
            let part = BEND.min(length / 2.0) / length;
            (x + dx * part, y + dy * part)
        };
        let ((ax, ay), (bx, by)) = (toward(before), toward(after));
        line.push_str(&format!(
            "L{} {}Q{} {} {} {}",
            number(ax),
            number(ay),
            number(*x),
            number(*y),
            number(bx),
            number(by)
        ));
    }
    line
}
