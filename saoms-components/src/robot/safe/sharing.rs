//! Right of way at a charger that robots share, since their own ones are taken, out of reach, cut off or give nothing.
//!
//! The robot that charges stays until it has enough for its work, and the others wait at a distance. One that cannot
//! wait any longer is let in as soon as the battery of the first one lasts for the usual reserve and a few moves. The
//! first one can then wait itself: it lets the other one charge until that has enough. So of two robots that need a
//! charger one is always served, and neither drives the other away before it has gained something.

use crate::grid::Block;
use crate::messages::{IMMOVABLE, Position};
use crate::robot::RobotKnowledge;

use super::leg::Urgency;

/// Distance from a charger at which robots wait for it: the one that leaves it has a block to go to.
const WAITING_AT: u32 = 2;

impl RobotKnowledge {
    /// True if a robot at a charger that it shares still needs it, and may keep it.
    pub(super) fn keeps_shared_charger(&self) -> bool {
        let needs = (self.must_charge && !self.battery.is_full()) || !self.has_enough();
        if !needs || self.energy.gives_nothing {
            return false;
        }
        let mut others = self.sharers().peekable();
        others.peek().is_some() && !others.any(|other| Urgency::Exhausted.is_at_most_that_of(other.priority))
    }

    /// True if a robot beside a charger that it shares leaves it to the one that is there.
    pub(super) fn waits_for_charger(&self) -> bool {
        if self.next == self.charge_block || self.next.distance(self.charge_block) > WAITING_AT || self.relieved {
            return false;
        }
        let Some(there) = self.at_shared_charger() else { return false };
        let keeps = there.priority == IMMOVABLE;
        if self.must_charge { keeps && !self.is_exhausted() } else { keeps || self.has_enough() }
    }

    /// True if another robot is on its way to this charger, which it has to reach in time.
    pub(super) fn is_claimed(&self, charger: Block) -> bool {
        let comes = |robot: u32| {
            let position = self.lists.peers.get(robot).filter(|_| self.lists.is_active(robot));
            position.is_some_and(|at| at.block != charger && Urgency::Energy.is_at_most(robot, at.priority))
        };
        let mut users = self.lists.chargers.iter().filter(|(robot, used)| *used == charger && *robot != self.number);
        users.any(|(robot, _)| comes(*robot))
    }

    fn at_shared_charger(&self) -> Option<&Position> {
        self.sharers().find(|other| other.block == self.charge_block)
    }

    /// The robots nearby that use its charger, too.
    fn sharers(&self) -> impl Iterator<Item = &Position> {
        let shares = |other: &&Position| {
            let chargers = &self.lists.chargers;
            let place = chargers.binary_search_by_key(&other.robot, |(robot, _)| *robot);
            place.is_ok_and(|place| chargers[place].1 == self.charge_block) && self.lists.is_active(other.robot)
        };
        self.traffic.near().iter().filter(shares)
    }
}
