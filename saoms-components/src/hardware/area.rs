use saoms_api::Message;

use crate::grid::Map;

/// A map as it travels through a service call or a topic.
#[derive(Clone, Debug, PartialEq, Eq, Message)]
pub struct Area {
    /// How many blocks wide it is.
    pub width: u32,
    /// How many blocks high it is.
    pub height: u32,
    /// One bit a block, row by row, set where it is blocked.
    pub blocked: Vec<u64>,
}

impl From<&Map> for Area {
    fn from(map: &Map) -> Area {
        Area { width: map.width(), height: map.height(), blocked: map.words().to_vec() }
    }
}

impl From<Area> for Option<Map> {
    fn from(area: Area) -> Option<Map> {
        Map::from_words(area.width, area.height, area.blocked)
    }
}
