use std::time::Duration;

use saoms_api::{Finding, Properties};

use crate::grid::{Block, Map};
use crate::text::TextFault;

/// Properties of a world.
#[derive(Clone, Debug, Properties)]
pub struct WorldProperties {
    /// Number of columns of the area, unless `map` is set.
    #[property(default = 11, range = 1..=8192, unit = "blocks")]
    pub(crate) width: u32,
    /// Number of rows of the area, unless `map` is set.
    #[property(default = 11, range = 1..=8192, unit = "blocks")]
    pub(crate) height: u32,
    /// The map as text: one line for each row, `.` for a free block, `@` for a blocked one. The header of a MovingAI
    /// map may stand before the rows.
    pub(crate) map: Option<String>,
    /// Blocks that no robot can enter, such as `(3,4)`, in addition to those of the map.
    pub(crate) blocked: Vec<String>,
    /// Time that a robot needs to move from one block to the next.
    #[property(default = "0ms", range = "0ms"..="1h")]
    pub(crate) move_time: Duration,
    /// Time that a robot needs to collect or deposit luggage.
    #[property(default = "0ms", range = "0ms"..="1h")]
    pub(crate) handling_time: Duration,
}

/// Help for several blocks in one text.
const SEVERAL: &str =
    "write several blocks as `many=\"true\"` and a `<value>` for each: `<value>(3,1)</value><value>(0,2)</value>`";

/// Maximum number of wrong blocks that are reported.
const MOST_WRONG: usize = 1000;

impl WorldProperties {
    /// The map with all blocked blocks, or findings about it.
    pub(crate) fn map(&self) -> Result<Map, Vec<Finding>> {
        let (mut map, mut findings) = match self.map.as_deref().map_or(Ok(Map::new(self.width, self.height)), Map::read)
        {
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
            let bracketed = format!("({})", text.trim().trim_matches(['(', '[', '{', ')', ']', '}']));
            let meant = Some(bracketed).filter(|meant| meant != text && meant.parse::<Block>().is_ok());
            findings.push(fault.instead(meant).finding("blocked", value));
        }
        map.filter(|_| findings.is_empty()).ok_or(findings)
    }
}

fn outside(map: &Map, block: Block) -> String {
    format!("found {block}, expected a block from (0,0) to ({},{})", map.width() - 1, map.height() - 1)
}
