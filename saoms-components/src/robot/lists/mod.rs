//! State of the other robots and of open work, as messages reported it.

mod helps;
mod memory;
mod peers;
mod requests;
mod shown;
#[cfg(test)]
mod tests;

use saoms_api::Entries;

use crate::gone::Gone;
use crate::grid::Block;
use crate::messages::RobotList;

pub(super) use memory::ListsMemory;

pub use helps::{Help, Helps};
pub use peers::Peers;
pub(in crate::robot) use requests::WAY_CLOSED;
pub use requests::{Assigned, Request, Requests, Rival};
pub use shown::WaitingLuggage;

/// The lists of a robot.
#[derive(Debug, Entries)]
pub struct Lists {
    number: u32,
    /// Other robots that are active, by number, as they announced themselves.
    #[entry(name = "robots")]
    pub active: Vec<RobotList>,
    /// Luggage that waits for a robot, oldest first, without that in which this robot takes an interest.
    #[entry]
    pub requests: Requests,
    /// Robots that wait for a healer, oldest first, as `CriticalSituationMS` hears of them.
    #[entry(name = "helpRequests")]
    pub helps: Helps,
    /// Blocks that the other robots hold and want, by number of the robot.
    #[entry(name = "positions")]
    pub peers: Peers,
    /// Chargers of the other robots, including those that are not active any more, by number.
    pub chargers: Vec<(u32, Block)>,
    /// Blocks of chargers, including those that no robot uses any more.
    pub charging_places: Vec<Block>,
    /// Robots that cannot move any more and whose position is not known yet.
    pub lost: Vec<u32>,
    /// Robots that are off the floor, or whose component failed.
    pub(crate) gone: Gone,
    /// True in an execution in which the others may not count what this robot is interested in: it takes that back.
    pub(crate) is_doubted: bool,
    /// Longest period of the other robots, in microseconds.
    slowest_period: u64,
}

/// Greatest number of blocks of chargers that a robot remembers on a large map.
const MOST_PLACES: usize = 256;

impl Lists {
    /// Empty lists of the robot with this number.
    pub fn new(number: u32) -> Lists {
        Lists {
            number,
            active: Vec::new(),
            requests: Requests::new(number),
            helps: Helps::new(number),
            peers: Peers::new(number),
            chargers: Vec::new(),
            charging_places: Vec::new(),
            lost: Vec::new(),
            gone: Gone::default(),
            is_doubted: false,
            slowest_period: 0,
        }
    }

    /// Longest period of the other robots, in microseconds.
    pub fn slowest_period(&self) -> u64 {
        self.slowest_period
    }

    fn note_period(&mut self, before: u64, now: u64) {
        if now < before && before == self.slowest_period {
            self.slowest_period = self.active.iter().map(|robot| robot.period).max().unwrap_or(0);
        } else {
            self.slowest_period = self.slowest_period.max(now);
        }
    }

    /// True if the other robot is active.
    pub fn is_active(&self, robot: u32) -> bool {
        self.active.binary_search_by_key(&robot, |known| known.robot).is_ok()
    }

    /// Other robots that sleep.
    pub fn sleepers(&self) -> impl Iterator<Item = &RobotList> {
        self.active.iter().filter(|robot| robot.asleep)
    }

    /// True if another robot is awake.
    pub fn anybody_awake(&self) -> bool {
        self.active.iter().any(|robot| !robot.asleep)
    }

    /// Adds the block of a charger.
    pub fn learn_charger(&mut self, charger: Block) {
        if !self.charging_places.contains(&charger) {
            self.charging_places.push(charger);
        }
    }

    /// Forgets a robot that is off the floor, but for its charger, where it starts again.
    pub(super) fn forget(&mut self, robot: u32) {
        self.end_of(robot);
        self.peers.forget(robot);
        self.lost.retain(|lost| *lost != robot);
    }

    /// A robot is not active any more: what it was interested in and offered does not count.
    pub(super) fn end_of(&mut self, robot: u32) {
        self.helps.hear_robot(&RobotList { robot, active: false, ..RobotList::default() });
        self.requests.forget(robot);
        self.end(robot);
    }

    /// Forgets a robot that is out of earshot, but for the block of its charger, where this one can charge.
    pub(super) fn lose(&mut self, robot: u32) {
        self.end(robot);
        self.lost.retain(|lost| *lost != robot);
        if let Ok(place) = self.chargers.binary_search_by_key(&robot, |(known, _)| *known) {
            self.chargers.remove(place);
        }
        if self.charging_places.len() > MOST_PLACES {
            self.charging_places.remove(0);
        }
    }

    /// Takes a robot off the active ones.
    fn end(&mut self, robot: u32) -> bool {
        let Ok(place) = self.active.binary_search_by_key(&robot, |known| known.robot) else { return false };
        let ended = self.active.remove(place);
        self.note_period(ended.period, 0);
        true
    }

    /// Handles the state of a robot.
    pub fn hear_robot(&mut self, robot: &RobotList) {
        self.helps.hear_robot(robot);
        if robot.robot == self.number {
            return self.learn_charger(robot.charger);
        }
        // As a rule it is known: only what changes is looked for among all places.
        match self.chargers.binary_search_by_key(&robot.robot, |(known, _)| *known) {
            Ok(place) if self.chargers[place].1 == robot.charger => {}
            Ok(place) => {
                self.chargers[place].1 = robot.charger;
                self.learn_charger(robot.charger);
            }
            Err(place) => {
                self.chargers.insert(place, (robot.robot, robot.charger));
                self.learn_charger(robot.charger);
            }
        }
        if !robot.active {
            if self.end(robot.robot) {
                self.requests.forget(robot.robot);
            }
            return;
        }
        let before = match self.active.binary_search_by_key(&robot.robot, |known| known.robot) {
            Ok(place) => std::mem::replace(&mut self.active[place], robot.clone()).period,
            Err(place) => {
                self.active.insert(place, robot.clone());
                0
            }
        };
        self.note_period(before, robot.period);
    }
}
