use std::time::Duration;

use saoms_api::{Failure, Properties};

use crate::grid::{Block, Map};

/// What a composite says about the world.
#[derive(Clone, Debug, Properties)]
pub struct WorldProperties {
    /// How many blocks wide the area is, unless there is a `map`.
    #[property(default = 11, range = 1..=8192, unit = "blocks")]
    pub(super) width: u32,
    /// How many blocks high the area is, unless there is a `map`.
    #[property(default = 11, range = 1..=8192, unit = "blocks")]
    pub(super) height: u32,
    /// The map as text: one line a row, `.` for a free block, `@` for a blocked one. The header of a MovingAI map may stand before the rows.
    pub(super) map: Option<String>,
    /// Blocks where no robot can go, such as `(3,4)`, in addition to those of the map.
    pub(super) blocked: Vec<String>,
    /// How long a robot moves from one block to the next.
    #[property(default = "0ms", range = "0ms"..="1h")]
    pub(super) move_time: Duration,
    /// How long a robot collects or deposits luggage.
    #[property(default = "0ms", range = "0ms"..="1h")]
    pub(super) handling_time: Duration,
}

impl WorldProperties {
    pub(super) fn map(&self) -> Result<Map, Failure> {
        let mut map = match &self.map {
            None => Map::new(self.width, self.height),
            Some(text) => {
                Map::read(text).map_err(|error| Failure::new(format!("property `map`, {error}")))?
            }
        };
        for text in &self.blocked {
            let failure = |message| Failure::new(format!("property `blocked`: {message}"));
            let block: Block = text.parse().map_err(failure)?;
            if !map.set_blocked(block) {
                let (x, y) = (map.width() - 1, map.height() - 1);
                return Err(failure(format!("found {block}, expected a block from (0,0) to ({x},{y})")));
            }
        }
        Ok(map)
    }
}
