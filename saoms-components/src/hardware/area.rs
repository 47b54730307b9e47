use saoms_api::Message;

use crate::grid::Map;

/// A map as sent by service calls and topics.
#[derive(Clone, Debug, PartialEq, Eq, Message)]
pub struct Area {
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
    /// Bits of the blocked blocks, row by row.
    pub blocked: Vec<u64>,
}

impl From<&Map> for Area {
    fn from(map: &Map) -> Area {
        Area { width: map.width(), height: map.height(), blocked: map.words() }
    }
}

impl From<Area> for Option<Map> {
    fn from(area: Area) -> Option<Map> {
        Map::from_words(area.width, area.height, area.blocked)
    }
}
