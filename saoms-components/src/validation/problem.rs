use std::fmt;

use crate::grid::{Block, Map};
use crate::messages::{EventLuggage, LuggageStage, MOST_FACTOR, is_visit};

/// Reason for rejecting a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Problem {
    /// Robot number 0.
    NoRobot,
    /// A robot that was never announced.
    Unknown { robot: u32 },
    /// A robot for which another component speaks.
    Foreign { robot: u32, speaker: u32 },
    /// A zone for which another component speaks.
    ForeignZone { zone: u32, speaker: u32 },
    /// A zone that the fleet does not have.
    UnknownZone { zone: u32 },
    /// A block outside the area; the area is its width and height, if they are known.
    Outside { block: Block, area: Option<(u32, u32)> },
    /// A blocked block.
    Blocked { block: Block },
    /// Luggage that is already at its destination.
    There { block: Block },
    /// A visit without blocks, or with the number of luggage.
    Visit,
    /// A move over more than one block.
    Jump { from: Block, to: Block },
    /// A battery level that is no percentage.
    Battery { percent: f64 },
    /// A factor by which nothing takes longer, or all too long.
    Factor { factor: f64 },
    /// A period that no component has.
    Period { micros: u64 },
    /// A response in place of a request, or a request in a robot's name.
    Response { robot: u32 },
    /// Luggage that was not requested.
    UnknownLuggage,
    /// The number of other luggage.
    KnownLuggage,
    /// A map whose data does not fit its size.
    Area { width: u32, height: u32 },
}

impl Problem {
    /// Checks a block where a robot is, or moves to.
    pub(crate) fn of_block(block: Block, area: Option<&Map>) -> Result<(), Problem> {
        let inside = area.map_or(block.x >= 0 && block.y >= 0, |area| area.contains(block));
        let size = || area.map(|area| (area.width(), area.height()));
        if inside { Ok(()) } else { Err(Problem::Outside { block, area: size() }) }
    }

    /// Checks a block where a robot has to go.
    pub(crate) fn of_free(block: Block, area: Option<&Map>) -> Result<(), Problem> {
        Problem::of_block(block, area)?;
        match area.is_some_and(|area| !area.is_free(block)) {
            true => Err(Problem::Blocked { block }),
            false => Ok(()),
        }
    }

    /// Checks a factor by which something takes longer, or more.
    pub(crate) fn of_factor(factor: f64) -> Result<(), Problem> {
        match (1.0..=MOST_FACTOR).contains(&factor) {
            true => Ok(()),
            false => Err(Problem::Factor { factor }),
        }
    }

    /// Checks a request to bring luggage, or to visit blocks.
    pub(crate) fn of_request(request: &EventLuggage, area: Option<&Map>) -> Result<(), Problem> {
        let EventLuggage { robot, from, to, .. } = *request;
        if robot != 0 || request.stage != LuggageStage::Request {
            return Err(Problem::Response { robot });
        }
        for block in [from, to] {
            Problem::of_free(block, area)?;
        }
        if from == to && !is_visit(request.luggage) { Err(Problem::There { block: to }) } else { Ok(()) }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Problem::NoRobot => formatter.write_str("found robot 0, expected a number from 1 on"),
            Problem::Unknown { robot } => {
                write!(formatter, "found robot {robot}, which has not announced itself, expected a robot that has")
            }
            Problem::Foreign { robot, speaker } => {
                write!(formatter, "it has the number of robot {robot}, which component {speaker} uses")
            }
            Problem::ForeignZone { zone, speaker } => {
                write!(formatter, "it has the number of zone {zone}, which component {speaker} uses")
            }
            Problem::UnknownZone { zone } => {
                write!(formatter, "found zone {zone}, which the fleet does not have, expected one of its zones")
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
            Problem::Visit => {
                formatter.write_str("found no blocks, or a number of luggage, expected blocks and a number of visits")
            }
            Problem::Jump { from, to } => {
                write!(formatter, "found {to} after {from}, expected the same block or one beside it")
            }
            Problem::Battery { percent } => {
                write!(formatter, "found a battery of {percent} %, expected 0 to 100")
            }
            Problem::Factor { factor } => {
                write!(formatter, "found the factor {factor:?}, expected 1 to {MOST_FACTOR}")
            }
            Problem::Period { micros } => {
                write!(formatter, "found a period of {micros} us, expected at most a day")
            }
            Problem::Response { robot } => {
                write!(formatter, "found a response of robot {robot}, expected a request, which names no robot")
            }
            Problem::UnknownLuggage => {
                formatter.write_str("found a number that no request has, expected the number of waiting luggage")
            }
            Problem::KnownLuggage => formatter.write_str("found a number that another piece has, expected a new one"),
            Problem::Area { width, height } => {
                write!(formatter, "found another number of blocks than the expected {width} x {height}")
            }
        }
    }
}
