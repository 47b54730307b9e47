//! The lines between columns as strands of channels, and as parts of the picture.

use std::collections::{BTreeMap, HashMap};
use std::rc::Rc;

use super::items::{Items, Pin};
use super::measure::{GRID, Plan};
use super::route::{self, Strand};
use super::{Line, LineKind, Point, Sides};
use crate::graph::diagram::{Diagram, LinkKind};

/// The owner of a strand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Owner {
    Net(LinkKind),
    /// The start of a wire that leads back.
    BackFrom(usize),
    /// Its end.
    BackTo(usize),
    /// The line of a component to its topics.
    Topics(usize),
}

/// A strand with what its ends belong to.
#[derive(Debug)]
pub(super) struct Route {
    pub(super) owner: Owner,
    pub(super) strand: Strand,
    pub(super) left: Vec<Pin>,
    pub(super) right: Vec<Pin>,
}

/// All lines by channel; channel 0 is between the first two columns.
#[derive(Debug)]
pub(super) struct Routes {
    pub(super) channels: Vec<Vec<Route>>,
    tracks: Vec<usize>,
    /// The kind of each line above the columns.
    backs: Vec<LinkKind>,
}

impl Routes {
    pub(super) fn of(diagram: &Diagram, plans: &[Rc<Plan>], items: &Items) -> Self {
        let mut channels: Vec<Vec<Route>> = Vec::new();
        channels.resize_with(items.columns.len() - 1, Vec::new);
        let mut nets: BTreeMap<(usize, usize), (Vec<Pin>, Pin)> = BTreeMap::new();
        for joint in &items.joints {
            let channel = items.items[joint.left.item].column;
            nets.entry((channel, joint.net)).or_insert_with(|| (Vec::new(), joint.right)).0.push(joint.left);
        }
        let route = |owner, mut left: Vec<Pin>, right: Vec<Pin>, far| {
            left.sort_by_key(|pin| items.line(*pin));
            left.dedup();
            let lines = |pins: &[Pin]| pins.iter().map(|pin| items.line(*pin)).collect();
            let strand = Strand { left: lines(&left), right: lines(&right), far, ..Strand::default() };
            Route { owner, strand, left, right }
        };
        for ((channel, net), (left, right)) in nets {
            channels[channel].push(route(Owner::Net(items.nets[net]), left, vec![right], None));
        }
        for (place, back) in items.backs.iter().enumerate() {
            let lane = Some(-GRID * (place as i32 + 1));
            let column = |pin: &Pin| items.items[pin.item].column;
            let mut starts: BTreeMap<usize, Vec<Pin>> = BTreeMap::new();
            for pin in &back.from {
                starts.entry(column(pin)).or_default().push(*pin);
            }
            for (from, pins) in starts {
                channels[from].push(route(Owner::BackFrom(place), pins, Vec::new(), lane));
            }
            let to = column(&back.to) - 1;
            channels[to].push(route(Owner::BackTo(place), Vec::new(), vec![back.to], lane));
        }
        let below = items.height() + GRID * (diagram.topics.len() as i32 + 1);
        for (component, plan) in plans.iter().enumerate() {
            let Some(offset) = plan.topics else { continue };
            let item = items.components[component];
            let pin = Pin { item, offset };
            channels[items.items[item].column - 1].push(route(
                Owner::Topics(component),
                Vec::new(),
                vec![pin],
                Some(below),
            ));
        }
        let tracks = channels.iter_mut().map(|routes| {
            let mut strands: Vec<Strand> = routes.iter_mut().map(|route| std::mem::take(&mut route.strand)).collect();
            let count = route::tracks(&mut strands);
            routes.iter_mut().zip(strands).for_each(|(route, strand)| route.strand = strand);
            count
        });
        let tracks = tracks.collect();
        Self { channels, tracks, backs: items.backs.iter().map(|back| back.kind).collect() }
    }

    /// The number of lanes above the columns.
    pub(super) fn lanes(&self) -> i32 {
        self.backs.len() as i32
    }

    /// The starts of columns and channels, and the end of the last column.
    pub(super) fn columns(&self, widths: &[i32]) -> (Vec<i32>, Vec<i32>, i32) {
        let mut x = 0;
        let (mut lefts, mut channels) = (Vec::new(), Vec::new());
        for (column, width) in widths.iter().enumerate() {
            lefts.push(x);
            x += width;
            if let Some(tracks) = self.tracks.get(column) {
                channels.push(x);
                x += route::width(*tracks);
            }
        }
        (lefts, channels, x)
    }

    /// The vertical part of a route.
    pub(super) fn track(&self, route: &Route, channel: usize, channels: &[i32], origin: Point) -> i32 {
        let track = route.strand.track.unwrap_or(0) as i32;
        origin.x + channels[channel] + route::MARGIN + GRID * track
    }

    /// All lines but those of topics; the first lane is right below `ceiling`.
    pub(super) fn draw(&self, sides: &Sides<'_>, channels: &[i32], ceiling: i32) -> Vec<Line> {
        let origin = sides.origin;
        let mut lines = Vec::new();
        let mut lanes: BTreeMap<usize, Vec<i32>> = BTreeMap::new();
        for (channel, routes) in self.channels.iter().enumerate() {
            let furthest = furthest(routes);
            for route in routes {
                let x = self.track(route, channel, channels, origin);
                let kind = match route.owner {
                    Owner::Net(kind) => kind.into(),
                    Owner::BackFrom(place) | Owner::BackTo(place) => {
                        lanes.entry(place).or_default().push(x);
                        self.backs[place].into()
                    }
                    Owner::Topics(_) => continue,
                };
                let mut line = parts(route, x, sides, kind);
                line.dots.extend(forks(route, &furthest, x, origin));
                lines.push(line);
            }
        }
        for (place, mut ends) in lanes {
            let y = origin.y - GRID * (place as i32 + 1);
            debug_assert!(y >= ceiling, "lanes are below the title");
            ends.sort_unstable();
            if let [from, between @ .., to] = &ends[..] {
                let parts = vec![(Point { x: *from, y }, Point { x: *to, y })];
                let dots = between.iter().map(|x| Point { x: *x, y }).collect();
                lines.push(Line { kind: self.backs[place].into(), parts, dots });
            }
        }
        lines
    }
}

fn parts(route: &Route, x: i32, sides: &Sides<'_>, kind: LineKind) -> Line {
    let origin = sides.origin;
    let strand = &route.strand;
    let mut line = Line { kind, parts: Vec::new(), dots: Vec::new() };
    let at = |x, y| Point { x, y: origin.y + y };
    let lefts = route.left.iter().zip(&strand.left).map(|(pin, y)| (sides.start(pin.item), *y));
    let rights = route.right.iter().zip(&strand.right).map(|(pin, y)| (sides.of(pin.item).0, *y));
    if strand.track.is_none() {
        if let (Some((from, y)), Some((to, _))) = (lefts.clone().next(), rights.clone().next()) {
            line.parts.push((at(from, y), at(to, y)));
        }
        return line;
    }
    let (top, bottom) = strand.span();
    line.parts.push((at(x, top), at(x, bottom)));
    if strand.nudge != 0 {
        line.parts.extend(rights.clone().map(|(to, y)| (at(to, y), at(to, y + strand.nudge))));
    }
    let rights = rights.map(|(to, y)| (to, y + strand.nudge));
    for (from, y) in lefts.chain(rights.clone()) {
        line.parts.push((at(from, y), at(x, y)));
        // Where a line meets the middle of another, or both its sides, they join.
        let is_both = strand.left.binary_search(&y).is_ok() && rights.clone().any(|(_, other)| other == y);
        if y != top && y != bottom || is_both {
            line.dots.push(at(x, y));
        }
    }
    line.dots.dedup();
    line
}

/// The furthest track that the lines from each start reach, or one past all of them.
fn furthest(routes: &[Route]) -> HashMap<Pin, usize> {
    let mut all: HashMap<Pin, usize> = HashMap::new();
    for route in routes {
        let track = route.strand.track.unwrap_or(usize::MAX);
        for pin in &route.left {
            let known = all.entry(*pin).or_default();
            *known = track.max(*known);
        }
    }
    all
}

/// The points where another line of the same reference continues.
fn forks(route: &Route, furthest: &HashMap<Pin, usize>, x: i32, origin: Point) -> Vec<Point> {
    let Some(track) = route.strand.track else { return Vec::new() };
    let lines = route.left.iter().zip(&route.strand.left);
    let goes_on = lines.filter(|(pin, _)| furthest.get(pin).is_some_and(|furthest| *furthest > track));
    goes_on.map(|(_, y)| Point { x, y: origin.y + y }).collect()
}
