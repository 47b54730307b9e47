use saoms_api::{Finding, Place, Properties};

use crate::grid::{Block, Map};
use crate::messages::Territory;

/// Properties of a zone.
#[derive(Clone, Debug, Properties)]
pub struct ZoneProperties {
    /// Number of the zone. Zones of one site have different numbers.
    #[property(default = 1, range = 1.., unique = "zone", speaker)]
    pub(crate) number: u32,
    /// First column of its blocks.
    #[property(default = 0, range = 0..=8191, unit = "blocks")]
    pub(crate) x: i32,
    /// First row of its blocks.
    #[property(default = 0, range = 0..=8191, unit = "blocks")]
    pub(crate) y: i32,
    /// Number of its columns; by default all up to the border of the map.
    #[property(range = 1..=8192, unit = "blocks")]
    pub(crate) width: Option<u32>,
    /// Number of its rows; by default all up to the border of the map.
    #[property(range = 1..=8192, unit = "blocks")]
    pub(crate) height: Option<u32>,
    /// The map as text, if the reference `world` leads to no world: one line for each row, `.` for a free block, `@`
    /// for a blocked one.
    pub(crate) map: Option<String>,
    /// Number of blocks that it grants ahead of a robot where no other robot is near.
    #[property(default = 3, range = 1..=16, unit = "blocks")]
    pub(crate) ahead: u32,
}

impl ZoneProperties {
    /// The map of the property.
    pub(crate) fn map(&self) -> Result<Option<Map>, Vec<Finding>> {
        let Some(text) = &self.map else { return Ok(None) };
        let faults = |faults: Vec<crate::text::TextFault>| {
            faults.into_iter().map(|fault| fault.finding("map", 0)).collect::<Vec<Finding>>()
        };
        Map::read(text).map(Some).map_err(faults)
    }

    /// The blocks of the zone on a map.
    ///
    /// # Errors
    /// The zone has blocks outside of the map, or none on it.
    pub(crate) fn territory(&self, term: u64, map: &Map) -> Result<Territory, Box<Finding>> {
        let length = |given: Option<u32>, from: i32, most: u32, [position, property, lines]: [&str; 3]| {
            let left = u32::try_from(i64::from(most) - i64::from(from)).unwrap_or(0);
            let length = given.unwrap_or(left);
            if left == 0 {
                let message = format!("found {from}, but the map has {most} {lines}, from 0 to {}", most - 1);
                let finding = Finding::new(Place::property(position), message);
                return Err(Box::new(finding.help(format!("write at most {}", most - 1))));
            }
            if length > left {
                let message = format!("found {length}, but the map has only {left} {lines} from {from} on");
                let finding = Finding::new(Place::property(property), message);
                return Err(Box::new(finding.help(format!("write at most {left}"))));
            }
            Ok(length)
        };
        let width = length(self.width, self.x, map.width(), ["x", "width", "columns"])?;
        let height = length(self.height, self.y, map.height(), ["y", "height", "rows"])?;
        Ok(Territory { zone: self.number, term, corner: Block::new(self.x, self.y), width, height })
    }
}
