use std::time::Duration;

use saoms_api::{Finding, Properties};

use crate::grid::{Block, Map};
use crate::text::TextFault;

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
    pub(crate) map: Option<String>,
    /// Blocks where no robot can go, such as `(3,4)`, in addition to those of the map.
    pub(crate) blocked: Vec<String>,
    /// How long a robot moves from one block to the next.
    #[property(default = "0ms", range = "0ms"..="1h")]
    pub(crate) move_time: Duration,
    /// How long a robot collects or deposits luggage.
    #[property(default = "0ms", range = "0ms"..="1h")]
    pub(crate) handling_time: Duration,
}

/// What to do with several blocks in one text.
const SEVERAL: &str = "write several blocks as `many=\"true\"` and a `<value>` for each: `<value>(3,1)</value><value>(0,2)</value>`";

/// How many wrong blocks are told.
const MOST_WRONG: usize = 1000;

impl WorldProperties {
    /// The map with all blocked blocks, or what is wrong with it.
    pub(crate) fn map(&self) -> Result<Map, Vec<Finding>> {
        let (mut map, mut findings) =
            match self.map.as_deref().map_or(Ok(Map::new(self.width, self.height)), Map::read) {
                Ok(map) => (Some(map), Vec::new()),
                Err(faults) => (None, faults.into_iter().map(|fault| fault.finding("map", 0)).collect()),
            };
        for (value, text) in self.blocked.iter().enumerate() {
            if findings.len() >= MOST_WRONG {
                break;
            }
            let problem = match (text.parse(), &mut map) {
                (Err(problem), _) => Some(problem),
                (Ok(block), Some(map)) => (!map.set_blocked(block)).then(|| outside(map, block)),
                (Ok(_), None) => None,
            };
            let Some(problem) = problem else { continue };
            let fault = TextFault::new(0..text.len(), problem);
            let fault = if text.matches('(').count() > 1 { fault.help(SEVERAL) } else { fault };
            findings.push(fault.finding("blocked", value));
        }
        map.filter(|_| findings.is_empty()).ok_or(findings)
    }
}

fn outside(map: &Map, block: Block) -> String {
    format!("found {block}, expected a block from (0,0) to ({},{})", map.width() - 1, map.height() - 1)
}
