//! The map of a fleet, as rules look at it.

use std::cell::OnceCell;
use std::collections::HashMap;
use std::ops::Range;
use std::time::Duration;

use saoms_api::rule::FleetView;
use saoms_api::{Finding, Place};

use crate::environment::{Drawn, Environment, Happening, Scenario, Spot, Written};
use crate::grid::{Block, Map};
use crate::world::{World, WorldProperties};

/// A world with a right map.
pub(super) struct Area {
    pub(super) index: usize,
    pub(super) map: Map,
    pub(super) properties: WorldProperties,
    /// Which value says first that a block is blocked.
    blocked: OnceCell<HashMap<Block, usize>>,
}

/// All worlds whose maps are right. Each is made when it is asked for, as a map may take megabytes.
pub(super) fn areas<'f>(fleet: &'f FleetView<'_>) -> impl Iterator<Item = Area> + use<'f> {
    let worlds = fleet.all::<World>();
    worlds.filter_map(|(index, properties)| {
        Some(Area { index, map: properties.map().ok()?, properties, blocked: OnceCell::new() })
    })
}

/// The map of the fleet; `None` where there is no world, or where several, or one with a fault, leave open which one is meant.
pub(super) fn area(fleet: &FleetView<'_>) -> Option<Area> {
    let is_one = fleet.indices::<World>().take(2).count() == 1 && !fleet.misses::<World>();
    is_one.then(|| areas(fleet).next()).flatten()
}

impl Area {
    /// Why no robot can stand on a block: it is outside, or blocked.
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

    /// Adds where the block is blocked, or where the map's size is said.
    pub(super) fn explain(&self, finding: Finding, block: Block) -> Finding {
        if let Some(&value) = self.blocked().get(&block) {
            let all = 0..self.properties.blocked[value].len();
            return finding
                .label(Place::property("blocked").part(value, all).in_component(self.index), "blocked here");
        }
        let map = Place::property("map").in_component(self.index);
        match self.properties.map.as_deref().map(|text| Map::written(text, block)) {
            Some(Some(bytes)) => finding.label(map.part(0, bytes), "blocked here"),
            Some(None) => finding,
            None => finding.label(Place::component(self.index), "the world"),
        }
    }
}

/// A luggage line of a scenario.
pub(super) struct Luggage {
    /// The environment that it is in.
    pub(super) index: usize,
    /// Which of its texts.
    text: usize,
    /// The time from one piece to the next, where they never end.
    pub(super) endless: Option<Drawn<Duration>>,
    pub(super) from: Written<Spot>,
    pub(super) to: Written<Spot>,
}

impl Luggage {
    pub(super) fn place(&self, spot: &Written<Spot>) -> Place {
        self.part(spot.bytes.clone())
    }

    /// Where both ends are written.
    pub(super) fn whole(&self) -> Place {
        self.part(self.from.bytes.start..self.to.bytes.end)
    }

    fn part(&self, bytes: Range<usize>) -> Place {
        Place::property("scenario").part(self.text, bytes).in_component(self.index)
    }
}

/// The luggage of all scenarios, wrong lines left out.
pub(super) fn luggage(fleet: &FleetView<'_>) -> Vec<Luggage> {
    let mut all = Vec::new();
    for (index, properties) in fleet.all::<Environment>() {
        let (scenario, _) = Scenario::read_partly(&properties.scenario);
        for line in scenario.lines() {
            if let Happening::Luggage { from, to } = &line.happening {
                let endless = (line.times.is_none() && line.until.is_none()).then_some(line.every);
                all.push(Luggage { index, text: line.text, endless, from: from.clone(), to: to.clone() });
            }
        }
    }
    all
}

/// The rows of an area between two corners, and its columns, as far as they are on the map.
pub(super) fn rows(first: Block, last: Block, map: &Map) -> (Range<u32>, Range<u32>) {
    let side = |first: i32, last: i32, length: u32| {
        let end = u32::try_from(last).map_or(0, |last| length.min(last + 1));
        u32::try_from(first).unwrap_or(0).min(end)..end
    };
    (side(first.y, last.y, map.height()), side(first.x, last.x, map.width()))
}
