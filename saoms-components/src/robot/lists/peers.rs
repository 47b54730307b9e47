use crate::grid::Block;
use crate::messages::Position;

/// Blocks that the other robots hold and want, as they reported them.
#[derive(Debug)]
pub struct Peers {
    number: u32,
    /// Newest position of each robot and the period in which it arrived, by robot.
    newest: Vec<(Position, u64)>,
    period: u64,
}

impl Peers {
    /// An empty list, for the robot with this number.
    pub fn new(number: u32) -> Peers {
        Peers { number, newest: Vec::new(), period: 0 }
    }

    /// Handles the positions that arrived for this period, without the robot's own.
    pub fn hear<'a>(&mut self, positions: impl Iterator<Item = &'a Position>) {
        self.period += 1;
        for position in positions.filter(|position| position.robot != self.number) {
            match self.newest.binary_search_by_key(&position.robot, |(known, _)| known.robot) {
                Ok(place) => self.newest[place] = (position.clone(), self.period),
                Err(place) => self.newest.insert(place, (position.clone(), self.period)),
            }
        }
    }

    /// Forgets the position of a robot.
    pub(in crate::robot) fn forget(&mut self, robot: u32) {
        if let Ok(place) = self.newest.binary_search_by_key(&robot, |(known, _)| known.robot) {
            self.newest.remove(place);
        }
    }

    /// Positions that arrived in this period.
    pub fn heard(&self) -> impl Iterator<Item = &Position> + Clone {
        let period = self.period;
        self.newest.iter().filter(move |(_, heard)| *heard == period).map(|(position, _)| position)
    }

    /// All positions, by number of the robot.
    pub fn all(&self) -> impl Iterator<Item = &Position> + Clone {
        self.newest.iter().map(|(position, _)| position)
    }

    /// Newest position of a robot.
    pub fn get(&self, robot: u32) -> Option<&Position> {
        let place = self.newest.binary_search_by_key(&robot, |(known, _)| known.robot).ok()?;
        self.newest.get(place).map(|(position, _)| position)
    }

    /// The other robot on the block, if one reported that.
    pub fn on(&self, block: Block) -> Option<&Position> {
        self.all().find(|peer| peer.block == block)
    }
}
