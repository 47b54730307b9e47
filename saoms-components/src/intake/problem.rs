use std::fmt;

use crate::grid::{Block, Map};
use crate::messages::{EventLuggage, LuggageStage};

/// Why a message cannot be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Problem {
    /// Robot 0.
    NoRobot,
    /// A robot that nobody heard of.
    Unknown { robot: u32 },
    /// Another component speaks for the robot.
    Foreign { robot: u32, speaker: u32 },
    /// A block outside the area, which has this width and height as far as they are known.
    Outside { block: Block, area: Option<(u32, u32)> },
    /// A block where no robot can be.
    Blocked { block: Block },
    /// Luggage that is already where it has to go.
    There { block: Block },
    /// More than one block at once.
    Jump { from: Block, to: Block },
    /// A battery that is no percentage.
    Battery { percent: f64 },
    /// A time from one execution to the next that no component has.
    Period { micros: u64 },
    /// A response, or a request that a robot makes.
    Response { robot: u32 },
    /// Luggage that nobody asked for.
    UnknownLuggage,
    /// The number of other luggage.
    KnownLuggage,
    /// A map that is not as large as it says.
    Area { width: u32, height: u32 },
}

impl Problem {
    /// What is wrong with a block where somebody is, or goes.
    pub(super) fn of_block(block: Block, area: Option<&Map>) -> Result<(), Problem> {
        let inside = area.map_or(block.x >= 0 && block.y >= 0, |area| area.contains(block));
        let size = || area.map(|area| (area.width(), area.height()));
        if inside { Ok(()) } else { Err(Problem::Outside { block, area: size() }) }
    }

    /// What is wrong with a request to bring luggage.
    pub(crate) fn of_request(request: &EventLuggage, area: Option<&Map>) -> Result<(), Problem> {
        let EventLuggage { robot, from, to, .. } = *request;
        if robot != 0 || request.stage != LuggageStage::Request {
            return Err(Problem::Response { robot });
        }
        for block in [from, to] {
            Problem::of_block(block, area)?;
            if area.is_some_and(|area| !area.is_free(block)) {
                return Err(Problem::Blocked { block });
            }
        }
        if from == to { Err(Problem::There { block: to }) } else { Ok(()) }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Problem::NoRobot => formatter.write_str("found robot 0, expected a number from 1 on"),
            Problem::Unknown { robot } => {
                write!(
                    formatter,
                    "found robot {robot}, which did not say that it is there, expected one that did"
                )
            }
            Problem::Foreign { robot, speaker } => {
                write!(formatter, "it is in the name of robot {robot}, for which component {speaker} speaks")
            }
            Problem::Outside { block, area: Some((width, height)) } => write!(
                formatter,
                "found {block}, expected a block of the area from (0,0) to ({},{})",
                width.saturating_sub(1),
                height.saturating_sub(1)
            ),
            Problem::Outside { block, area: None } => {
                write!(formatter, "found {block}, expected a block of the area, which starts at (0,0)")
            }
            Problem::Blocked { block } => {
                write!(formatter, "found {block}, which is blocked, expected a free block")
            }
            Problem::There { block } => {
                write!(formatter, "found {block} twice, expected another block to bring it to")
            }
            Problem::Jump { from, to } => {
                write!(formatter, "found {to} after {from}, expected the same block or one beside it")
            }
            Problem::Battery { percent } => {
                write!(formatter, "found a battery of {percent} %, expected 0 to 100")
            }
            Problem::Period { micros } => {
                write!(formatter, "found a period of {micros} us, expected one of at most a day")
            }
            Problem::Response { robot } => {
                write!(
                    formatter,
                    "found a response with robot {robot}, expected a request, which is of no robot"
                )
            }
            Problem::UnknownLuggage => {
                formatter.write_str("nobody asked for it, expected the number of luggage that waits")
            }
            Problem::KnownLuggage => {
                formatter.write_str("its number is known already, expected one of its own for each piece")
            }
            Problem::Area { width, height } => {
                write!(formatter, "found another number of blocks than the expected {width} x {height}")
            }
        }
    }
}
