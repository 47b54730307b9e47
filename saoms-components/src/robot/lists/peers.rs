use crate::grid::Block;
use crate::messages::Position;

/// Which blocks the other robots hold and want, as far as was heard.
#[derive(Debug)]
pub struct Peers {
    number: u32,
    /// The newest of each robot and the period in which it was heard, by robot.
    newest: Vec<(Position, u64)>,
    period: u64,
}

impl Peers {
    /// Nobody, for the robot of this number.
    pub fn new(number: u32) -> Peers {
        Peers { number, newest: Vec::new(), period: 0 }
    }

    /// Takes in the positions that arrived for this period; the own one does not count.
    pub fn hear<'a>(&mut self, positions: impl Iterator<Item = &'a Position>) {
        self.period += 1;
        for position in positions.filter(|position| position.robot != self.number) {
            match self.newest.binary_search_by_key(&position.robot, |(known, _)| known.robot) {
                Ok(place) => self.newest[place] = (position.clone(), self.period),
                Err(place) => self.newest.insert(place, (position.clone(), self.period)),
            }
        }
    }

    /// Those that said something in this period.
    pub fn heard(&self) -> impl Iterator<Item = &Position> + Clone {
        let period = self.period;
        self.newest.iter().filter(move |(_, heard)| *heard == period).map(|(position, _)| position)
    }

    /// All, by number.
    pub fn all(&self) -> impl Iterator<Item = &Position> + Clone {
        self.newest.iter().map(|(position, _)| position)
    }

    /// The newest of a robot.
    pub fn get(&self, robot: u32) -> Option<&Position> {
        let place = self.newest.binary_search_by_key(&robot, |(known, _)| known.robot).ok()?;
        self.newest.get(place).map(|(position, _)| position)
    }

    /// The other robot that is on the block, as far as was heard.
    pub fn on(&self, block: Block) -> Option<&Position> {
        self.all().find(|peer| peer.block == block)
    }
}
