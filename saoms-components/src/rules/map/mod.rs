//! Map and luggage of a fleet, as rules use them.

pub(super) mod size;

use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::Range;
use std::time::Duration;

use saoms_api::rule::FleetView;
use saoms_api::{Finding, Place};

use super::hearing::{events, hearing};
use crate::environment::{Environment, EventSpec, RandomRange, Scenario, Spanned, Spot};
use crate::grid::{Block, Map};
use crate::world::{World, WorldProperties};

/// A world with a valid map.
pub(super) struct WorldMap {
    pub(super) index: usize,
    pub(super) map: Map,
    pub(super) properties: WorldProperties,
    /// Index of the first value that blocks each block.
    blocked: OnceCell<HashMap<Block, usize>>,
}

/// Worlds with valid maps. Each map is built when it is needed, as it may take megabytes.
pub(super) fn areas<'f>(fleet: &'f FleetView<'_>) -> impl Iterator<Item = WorldMap> + use<'f> {
    let worlds = fleet.all::<World>();
    worlds.filter_map(|(index, properties)| WorldMap::of(index, properties))
}

/// The map of the world that hears the events of this name on the bus; `None` if there is none, or if several worlds,
/// or one with a fault, make it ambiguous.
pub(super) fn area(fleet: &FleetView<'_>, events: &str) -> Option<WorldMap> {
    let hearing = hearing(fleet);
    let [index] = *hearing.worlds(events) else { return None };
    let properties = fleet.components()[index].properties::<World>().filter(|_| !fleet.misses::<World>())?;
    WorldMap::of(index, properties)
}

impl WorldMap {
    fn of(index: usize, properties: WorldProperties) -> Option<WorldMap> {
        Some(WorldMap { index, map: properties.map().ok()?, properties, blocked: OnceCell::new() })
    }

    /// Reason why no robot can be on a block: it is outside, or blocked.
    pub(super) fn problem(&self, block: Block) -> Option<String> {
        if !self.map.contains(block) {
            let (x, y) = (self.map.width() - 1, self.map.height() - 1);
            return Some(format!("outside the map, which goes from (0,0) to ({x},{y})"));
        }
        (!self.map.is_free(block)).then(|| "blocked on the map".to_owned())
    }

    fn blocked(&self) -> &HashMap<Block, usize> {
        self.blocked.get_or_init(|| {
            let all = self.properties.blocked.iter().enumerate().rev();
            all.filter_map(|(value, text)| Some((text.parse().ok()?, value))).collect()
        })
    }

    /// Adds the place that blocks the block, or that sets the size of the map.
    pub(super) fn explain(&self, finding: Finding, block: Block) -> Finding {
        if let Some(&value) = self.blocked().get(&block) {
            let all = 0..self.properties.blocked[value].len();
            return finding
                .label(Place::property("blocked").part(value, all).in_component(self.index), "this block is blocked");
        }
        let map = Place::property("map").in_component(self.index);
        match self.properties.map.as_deref().map(|text| Map::written(text, block)) {
            Some(Some(bytes)) => finding.label(map.part(0, bytes), "this block is blocked"),
            Some(None) => finding,
            None => finding.label(Place::component(self.index), "the world"),
        }
    }
}

/// A luggage line of a scenario.
#[derive(Clone)]
pub(super) struct LuggageLine {
    /// Index of its environment.
    pub(super) index: usize,
    /// Index of its text.
    text: usize,
    /// Time from one piece to the next, if they never end.
    pub(super) endless: Option<RandomRange<Duration>>,
    /// True if its pieces are enough to keep several robots busy for a while.
    pub(super) is_lasting: bool,
    pub(super) from: Spanned<Spot>,
    pub(super) to: Spanned<Spot>,
    /// True if a robot visits the two blocks, and brings nothing.
    pub(super) is_visit: bool,
}

impl LuggageLine {
    pub(super) fn place(&self, spot: &Spanned<Spot>) -> Place {
        self.part(spot.bytes.clone())
    }

    /// Place of both ends.
    pub(super) fn whole(&self) -> Place {
        self.part(self.from.bytes.start..self.to.bytes.end)
    }

    fn part(&self, bytes: Range<usize>) -> Place {
        Place::property("scenario").part(self.text, bytes).in_component(self.index)
    }
}

/// Number of pieces of a line from which on they keep several robots busy for a while.
const LASTING: u64 = 20;

/// Luggage of all scenarios, and blocks to visit, two at a time; without wrong lines.
pub(super) fn luggage(fleet: &FleetView<'_>) -> Vec<LuggageLine> {
    let mut all = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        for line in scenario.lines() {
            let endless = (line.times.is_none() && line.until.is_none()).then_some(line.every);
            let is_lasting = line.times.is_none_or(|times| times >= LASTING);
            let text = line.text as usize;
            let piece = |from: &Spanned<Spot>, to: &Spanned<Spot>, is_visit: bool| {
                let (from, to) = (from.clone(), to.clone());
                LuggageLine { index, text, endless, is_lasting, from, to, is_visit }
            };
            match &line.event {
                EventSpec::Luggage { from, to } => all.push(piece(from, to, false)),
                EventSpec::Visit { stops, .. } => {
                    all.extend(stops.chunks(2).map(|two| piece(&two[0], &two[two.len() - 1], true)));
                }
                _ => {}
            }
        }
    }
    all
}

/// Luggage of all scenarios, by the names that the events have on the bus; both in document order.
pub(super) fn by_events<'f>(fleet: &FleetView<'f>) -> Vec<(&'f str, Vec<LuggageLine>)> {
    let mut places: HashMap<&str, usize> = HashMap::new();
    let mut all: Vec<(&str, Vec<LuggageLine>)> = Vec::new();
    for line in luggage(fleet) {
        let events = events(fleet, line.index);
        let place = *places.entry(events).or_insert(all.len());
        if place == all.len() {
            all.push((events, Vec::new()));
        }
        all[place].1.push(line);
    }
    all
}

/// Rows and columns between two corners, as far as they are on the map.
pub(super) fn rows(first: Block, last: Block, map: &Map) -> (Range<u32>, Range<u32>) {
    let side = |first: i32, last: i32, length: u32| {
        let end = u32::try_from(last).map_or(0, |last| length.min(last + 1));
        u32::try_from(first).unwrap_or(0).min(end)..end
    };
    (side(first.y, last.y, map.height()), side(first.x, last.x, map.width()))
}
