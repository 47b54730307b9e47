use saoms_api::Time;

use crate::grid::Block;
use crate::messages::{IMMOVABLE, Position};

/// Blocks that the other robots hold and want, as they reported them.
#[derive(Debug)]
pub struct Peers {
    number: u32,
    /// Newest position of each robot, by robot.
    newest: Vec<Newest>,
    period: u64,
    /// The period in which a position arrived last.
    heard: u64,
    /// Number of changes of any position.
    changes: u64,
}

/// The newest position of a robot.
#[derive(Clone, Debug)]
struct Newest {
    position: Position,
    sent: Time,
    /// The period in which it arrived.
    period: u64,
    /// True if the robot failed since.
    stopped: bool,
}

impl Peers {
    /// An empty list, for the robot with this number.
    pub fn new(number: u32) -> Peers {
        Peers { number, newest: Vec::new(), period: 0, heard: 0, changes: 0 }
    }

    /// Handles the positions that arrived for this period, without the robot's own.
    pub fn hear<'a>(&mut self, positions: impl Iterator<Item = (&'a Position, Time)>) {
        self.period += 1;
        for (position, sent) in positions.filter(|(position, _)| position.robot != self.number) {
            let newest = Newest { position: position.clone(), sent, period: self.period, stopped: false };
            self.heard = self.period;
            self.changes += 1;
            match self.place(position.robot) {
                Ok(place) => self.newest[place] = newest,
                Err(place) => self.newest.insert(place, newest),
            }
        }
    }

    /// A robot failed at a time, and stands on its block, which is this one if that is known: otherwise it is on one of
    /// those that it held and wanted. True if that is news: it did not say later where it is.
    pub(in crate::robot) fn stop(&mut self, robot: u32, block: Option<Block>, since: Time) -> bool {
        let newest = self.place(robot).ok().and_then(|place| self.newest.get_mut(place));
        let Some(Newest { position, sent, stopped, .. }) = newest else { return false };
        if *sent > since || std::mem::replace(stopped, true) {
            return false;
        }
        self.changes += 1;
        position.priority = IMMOVABLE;
        if let Some(block) = block {
            (position.block, position.next, position.wanted) = (block, block, block);
        }
        true
    }

    fn place(&self, robot: u32) -> Result<usize, usize> {
        self.newest.binary_search_by_key(&robot, |newest| newest.position.robot)
    }

    /// Forgets the position of a robot.
    pub(in crate::robot) fn forget(&mut self, robot: u32) {
        if let Ok(place) = self.place(robot) {
            self.newest.remove(place);
            self.changes += 1;
        }
    }

    /// Positions that arrived in this period.
    pub fn heard(&self) -> impl Iterator<Item = &Position> + Clone {
        let period = self.period;
        // Most of the time nobody moved.
        let newest = if self.heard == period { self.newest.as_slice() } else { &[] };
        newest.iter().filter(move |newest| newest.period == period).map(|newest| &newest.position)
    }

    /// Number of changes of any position.
    pub(in crate::robot) fn changes(&self) -> u64 {
        self.changes
    }

    /// All positions, by number of the robot.
    pub fn all(&self) -> impl Iterator<Item = &Position> + Clone {
        self.newest.iter().map(|newest| &newest.position)
    }

    /// Newest position of a robot.
    pub fn get(&self, robot: u32) -> Option<&Position> {
        self.newest.get(self.place(robot).ok()?).map(|newest| &newest.position)
    }

    /// The other robot on the block, if one reported that.
    pub fn on(&self, block: Block) -> Option<&Position> {
        self.all().find(|peer| peer.block == block)
    }
}
