//! Robots that somebody took off the floor.

use saoms_api::{Field, Header, Time};

use crate::messages::RobotList;

/// The robots that are gone, as a component heard of them. One of them is back when it says that it is active after
/// that; what it said before, and its last words, do not count any more.
#[derive(Clone, Debug, Default, Field)]
pub(crate) struct Gone {
    robots: Vec<GoneRobot>,
}

#[derive(Clone, Copy, Debug, Field)]
struct GoneRobot {
    robot: u32,
    since: Time,
}

impl Gone {
    /// Notes that a robot is gone.
    pub(crate) fn note(&mut self, robot: u32, header: Header) {
        self.robots.retain(|known| known.robot != robot);
        self.robots.push(GoneRobot { robot, since: header.sent });
    }

    pub(crate) fn contains(&self, robot: u32) -> bool {
        self.robots.iter().any(|known| known.robot == robot)
    }

    /// True if what a robot says of its state counts: it is not gone, or is back now.
    #[inline]
    pub(crate) fn hears(&mut self, robot: &RobotList, header: Header) -> bool {
        self.robots.is_empty() || self.comes_back(robot, header)
    }

    #[cold]
    fn comes_back(&mut self, robot: &RobotList, header: Header) -> bool {
        let Some(place) = self.robots.iter().position(|known| known.robot == robot.robot) else { return true };
        let is_back = robot.active && header.sent > self.robots[place].since;
        if is_back {
            self.robots.remove(place);
        }
        is_back
    }

    /// The numbers of the robots.
    pub(crate) fn robots(&self) -> impl Iterator<Item = u32> {
        self.robots.iter().map(|known| known.robot)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use saoms_api::Cause;

    use super::*;

    #[test]
    fn a_robot_is_back_when_it_says_that_it_is_active_later() {
        let at =
            |seconds| Header { sender: 0, sent: Time::START + Duration::from_secs(seconds), cause: Cause::default() };
        let says = |active| RobotList { robot: 2, active, ..RobotList::default() };
        let mut gone = Gone::default();
        assert!(gone.hears(&says(false), at(1)));
        gone.note(2, at(5));
        assert!(gone.hears(&RobotList { robot: 3, ..says(true) }, at(6)));
        assert!(!gone.hears(&says(true), at(5)), "it said so before");
        assert!(!gone.hears(&says(false), at(6)), "its last words");
        assert!(gone.contains(2) && gone.hears(&says(true), at(7)) && !gone.contains(2));
    }
}
