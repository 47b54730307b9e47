//! Robots that say nothing any more and did not say so: somebody took them off the floor, or their component failed.

mod failure;

use saoms_api::{Field, Header, Time};

use crate::grid::Block;
use crate::messages::{Fault, RobotList};

/// The robots that are out, as a component heard of them. One of them is back when it says that it is active after
/// that, and one that was taken off the floor if it also began after that; what it said before, and its last words, do
/// not count any more.
#[derive(Clone, Debug, Default, Field)]
pub(crate) struct Gone {
    robots: Vec<GoneRobot>,
}

#[derive(Clone, Copy, Debug, Field)]
struct GoneRobot {
    robot: u32,
    since: Time,
    /// True if its component failed, so that it stands on its block.
    failed: bool,
    /// That block, where it is known.
    block: Option<Block>,
}

impl Gone {
    /// Notes that a robot is out, by a fault that came with this header.
    pub(crate) fn note(&mut self, fault: &Fault, header: Header) {
        self.robots.retain(|known| known.robot != fault.robot);
        let since = fault.since.unwrap_or(header.sent);
        let Fault { robot, block, .. } = *fault;
        self.robots.push(GoneRobot { robot, since, failed: fault.is_failure(), block });
    }

    /// True if somebody took the robot off the floor.
    pub(crate) fn contains(&self, robot: u32) -> bool {
        self.robots.iter().any(|known| known.robot == robot && !known.failed)
    }

    /// True if the robot is off the floor, or its component failed.
    pub(crate) fn is_out(&self, robot: u32) -> bool {
        self.robots.iter().any(|known| known.robot == robot)
    }

    /// True if a robot that is out said something before that, with this header.
    pub(crate) fn is_over(&self, robot: u32, header: Header) -> bool {
        self.robots.iter().any(|known| known.robot == robot && header.sent <= known.since)
    }

    /// True if what a robot says of its state counts: it is not out, or is back now.
    #[inline]
    pub(crate) fn hears(&mut self, robot: &RobotList, header: Header) -> bool {
        self.robots.is_empty() || self.comes_back(robot, header)
    }

    #[cold]
    fn comes_back(&mut self, robot: &RobotList, header: Header) -> bool {
        let Some(place) = self.robots.iter().position(|known| known.robot == robot.robot) else { return true };
        let GoneRobot { since, failed, .. } = self.robots[place];
        // One that hears late that somebody took it off the floor speaks after that, too.
        let is_back = robot.active && robot.began.filter(|_| !failed).unwrap_or(header.sent) > since;
        if is_back {
            self.robots.remove(place);
        }
        is_back
    }

    /// The robots whose component failed, with their blocks where they are known, and the time of the failure.
    #[inline]
    pub(crate) fn failed(&self) -> impl Iterator<Item = (u32, Option<Block>, Time)> {
        self.robots.iter().filter(|known| known.failed).map(|known| (known.robot, known.block, known.since))
    }

    /// The time since when a robot is out, unless it is back.
    pub(crate) fn since(&self, robot: u32) -> Option<Time> {
        self.robots.iter().find(|known| known.robot == robot).map(|known| known.since)
    }

    /// The numbers of the robots that are off the floor.
    pub(crate) fn robots(&self) -> impl Iterator<Item = u32> {
        self.robots.iter().filter(|known| !known.failed).map(|known| known.robot)
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
        gone.note(&Fault::gone(2), at(5));
        assert!(gone.hears(&RobotList { robot: 3, ..says(true) }, at(6)));
        assert!(!gone.hears(&says(true), at(5)), "it said so before");
        assert!(!gone.hears(&says(false), at(6)), "its last words");
        assert!(gone.contains(2) && gone.hears(&says(true), at(7)) && !gone.contains(2));
    }

    #[test]
    fn a_robot_that_hears_late_that_it_is_gone_is_not_back() {
        let at = |seconds| Time::START + Duration::from_secs(seconds);
        let header = |seconds| Header { sender: 0, sent: at(seconds), cause: Cause::default() };
        let says = |began| RobotList { robot: 2, active: true, began: Some(at(began)), ..RobotList::default() };
        let mut gone = Gone::default();
        gone.note(&Fault::gone(2), header(5));
        assert!(!gone.hears(&says(1), header(6)) && gone.contains(2));
        assert!(gone.hears(&says(7), header(8)) && !gone.contains(2));
    }

    #[test]
    fn a_robot_that_failed_stands_on_its_block_and_what_it_said_before_is_over() {
        let at = |seconds| Time::START + Duration::from_secs(seconds);
        let header = |seconds| Header { sender: 0, sent: at(seconds), cause: Cause::default() };
        let mut gone = Gone::default();
        gone.note(&Fault::failure(2, at(5), true), header(7));
        assert!(gone.is_out(2) && !gone.contains(2) && gone.robots().next().is_none());
        assert!(gone.is_over(2, header(5)) && !gone.is_over(2, header(6)) && !gone.is_over(3, header(5)));
        let back = RobotList { robot: 2, active: true, ..RobotList::default() };
        assert!(gone.hears(&back, header(6)), "it started again before the others heard of its failure");
        assert!(!gone.is_out(2));
    }
}
