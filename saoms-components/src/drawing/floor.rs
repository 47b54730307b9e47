//! What stands on the floor: the map, zones and chargers.

use saoms_api::builtin_interfaces::Time;

use super::colours::{ACCENT, PALE, WARN, clear};
use super::messages::{Entity, Header, Line, MapMetaData, OccupancyGrid, Point, Pose};
use super::robots::{centre, cuboid, text};
use crate::grid::{Block, Map};
use crate::messages::Territory;

/// The most cuboids of blocks; a larger map is drawn as a grid alone.
const MOST: usize = 20_000;
/// Free and occupied cells of a grid.
const FREE: i8 = 0;
const OCCUPIED: i8 = 100;

/// The map as a grid, whose rows begin with the lowest one.
pub(super) fn grid(map: &Map, at: Time, frame: &str) -> OccupancyGrid {
    let (width, height) = (map.width(), map.height());
    let mut data = Vec::with_capacity(map.size());
    for row in (0..height).rev() {
        let start = data.len();
        data.resize(start + width as usize, OCCUPIED);
        for free in map.free_ranges(row, 0..width) {
            data[start + free.start as usize..start + free.end as usize].fill(FREE);
        }
    }
    OccupancyGrid {
        header: Header { stamp: at, frame_id: frame.to_owned() },
        info: MapMetaData {
            map_load_time: at,
            resolution: 1.0,
            width,
            height,
            origin: Pose::at(0.0, -f64::from(height), 0.0),
        },
        data,
    }
}

/// The blocked blocks of a map: neighbours in a row are one cuboid.
pub(super) fn blocks(map: &Map, at: Time, frame: &str) -> Entity {
    let mut cubes = Vec::new();
    let mut add = |row: u32, from: u32, to: u32| {
        if from < to && cubes.len() <= MOST {
            let (x, y) = (f64::from(from + to) / 2.0, -f64::from(row) - 0.5);
            cubes.push(cuboid(Pose::at(x, y, 0.25), [f64::from(to - from), 1.0, 0.5], PALE));
        }
    };
    for row in (0..map.height()).filter(|_| !map.is_open()) {
        let mut from = 0;
        for free in map.free_ranges(row, 0..map.width()) {
            add(row, from, free.start);
            from = free.end;
        }
        add(row, from, map.width());
    }
    if cubes.len() > MOST {
        cubes.clear();
    }
    Entity { timestamp: at, frame_id: frame.to_owned(), id: "blocks".to_owned(), cubes, ..Entity::default() }
}

/// The border of a zone, and its number.
pub(super) fn zone(zone: &Territory, at: Time, frame: &str) -> Entity {
    // A little inside, beside those of others.
    const INSIDE: f64 = 0.05;
    let Territory { zone, corner, width, height, .. } = zone;
    let (left, top) = (f64::from(corner.x) + INSIDE, -f64::from(corner.y) - INSIDE);
    let (right, bottom) = (f64::from(corner.x) + f64::from(*width), -f64::from(corner.y) - f64::from(*height));
    let (right, bottom) = (right - INSIDE, bottom + INSIDE);
    let points = [(left, top), (right, top), (right, bottom), (left, bottom)];
    let border = Line {
        r#type: Line::LINE_LOOP,
        thickness: 0.08,
        points: points.map(|(x, y)| Point { x, y, z: 0.05 }).to_vec(),
        color: ACCENT,
        ..Line::default()
    };
    Entity {
        timestamp: at,
        frame_id: frame.to_owned(),
        id: format!("zone{zone}"),
        lines: vec![border],
        texts: vec![text(Pose::at(left + 0.6, top - 0.25, 0.1), format!("zone {zone}"), ACCENT)],
        ..Entity::default()
    }
}

/// The blocks of chargers.
pub(super) fn chargers(chargers: impl Iterator<Item = Block>, at: Time, frame: &str) -> Entity {
    let charger = |block| {
        let Point { x, y, .. } = centre(block);
        cuboid(Pose::at(x, y, 0.02), [0.9, 0.9, 0.04], clear(WARN))
    };
    let cubes = chargers.map(charger).collect();
    Entity { timestamp: at, frame_id: frame.to_owned(), id: "chargers".to_owned(), cubes, ..Entity::default() }
}
