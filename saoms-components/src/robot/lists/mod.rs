//! What a robot heard from others.

mod helps;
mod peers;
mod requests;
#[cfg(test)]
mod tests;

use crate::grid::Block;
use crate::messages::RobotList;

pub use helps::{Help, Helps};
pub use peers::Peers;
pub use requests::{Request, Requests, Rival};

/// The lists of a robot.
#[derive(Debug)]
pub struct Lists {
    number: u32,
    /// The other robots that are active, by number.
    pub active: Vec<RobotList>,
    /// The luggage that waits, oldest first.
    pub requests: Requests,
    /// The robots that wait for a healer, oldest first.
    pub helps: Helps,
    /// Where the other robots are and go.
    pub peers: Peers,
    /// The chargers of the other robots, also of those that are not active any more, by number.
    pub chargers: Vec<(u32, Block)>,
    /// Where there are chargers, also where nobody charges any more.
    pub charging_places: Vec<Block>,
    /// Robots that cannot move any more, until it is known where they are.
    pub lost: Vec<u32>,
}

impl Lists {
    /// The empty lists of the robot with this number.
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
        }
    }

    /// The longest time from one execution to the next of the other robots, in microseconds.
    pub fn slowest_period(&self) -> u64 {
        self.active.iter().map(|robot| robot.period).max().unwrap_or(0)
    }

    /// Whether another robot is active.
    pub fn is_active(&self, robot: u32) -> bool {
        self.active.binary_search_by_key(&robot, |known| known.robot).is_ok()
    }

    /// The other robots that sleep.
    pub fn sleepers(&self) -> impl Iterator<Item = &RobotList> {
        self.active.iter().filter(|robot| robot.asleep)
    }

    /// Whether another robot is awake.
    pub fn anybody_awake(&self) -> bool {
        self.active.iter().any(|robot| !robot.asleep)
    }

    /// Takes in that there is a charger.
    pub fn learn_charger(&mut self, charger: Block) {
        if !self.charging_places.contains(&charger) {
            self.charging_places.push(charger);
        }
    }

    /// Takes in that a robot is active, or no longer is.
    pub fn hear_robot(&mut self, robot: &RobotList) {
        self.helps.hear_robot(robot);
        self.learn_charger(robot.charger);
        if robot.robot == self.number {
            return;
        }
        match self.chargers.binary_search_by_key(&robot.robot, |(known, _)| *known) {
            Ok(place) => self.chargers[place].1 = robot.charger,
            Err(place) => self.chargers.insert(place, (robot.robot, robot.charger)),
        }
        match (self.active.binary_search_by_key(&robot.robot, |known| known.robot), robot.active) {
            (Ok(place), true) => self.active[place].clone_from(robot),
            (Err(place), true) => self.active.insert(place, robot.clone()),
            (Ok(place), false) => {
                self.active.remove(place);
                self.requests.forget(robot.robot);
            }
            (Err(_), false) => {}
        }
    }
}
