use saoms_api::{Field, Time};

use crate::grid::Block;
use crate::messages::Priority;
use crate::robot::RobotKnowledge;

/// Way to one goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub(crate) struct Leg {
    pub(super) goal: Option<Block>,
    pub(super) urgency: Urgency,
    since: Time,
}

/// Purposes of a way, the most urgent last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Field)]
pub(super) enum Urgency {
    /// No way: the robot is where it wants to be.
    #[default]
    None,
    /// Going home without a job.
    Home,
    /// Bringing luggage.
    Job,
    /// Reaching the charger in time.
    Energy,
    /// Reaching the charger, with half of the reserve used up if others are in the way as usual.
    Exhausted,
    /// Reaching the charger, with half of the reserve used up even if nobody is in the way any more.
    NearlyEmpty,
}

impl Urgency {
    /// True if a robot has this priority because of such a way or a more urgent one, and not because it makes way for
    /// another one.
    pub(super) fn is_at_most(self, robot: u32, priority: Priority) -> bool {
        priority.robot == robot && self.is_at_most_that_of(priority)
    }

    /// True if a robot, or one that it makes way for, has this priority because of such a way or a more urgent one.
    pub(super) fn is_at_most_that_of(self, priority: Priority) -> bool {
        (self as u64..=Urgency::NearlyEmpty as u64).contains(&(priority.rank >> AGE_BITS))
    }
}

/// Number of bits of a rank that are the age of the way; those above are its urgency.
const AGE_BITS: u32 = 56;

impl Leg {
    /// A way to the charger that is older than any other one.
    pub(super) const OLDEST_TO_CHARGER: Leg = Leg { goal: None, urgency: Urgency::Energy, since: Time::START };

    /// A way home that is older than any other one.
    pub(super) const OLDEST_HOME: Leg = Leg { goal: None, urgency: Urgency::Home, since: Time::START };

    /// Priority of the way: the more urgent one is higher; of two equally urgent ways the older one. It does not change
    /// on the way: robots that swap their priorities would push each other back and forth.
    pub(super) fn priority(&self, robot: u32) -> Priority {
        if self.urgency == Urgency::None {
            // A resting robot has no way to compare, and need not announce a new reason for resting.
            return Priority { rank: 0, robot };
        }
        const MOST: u64 = (1 << AGE_BITS) - 1;
        // The unit is 256 ns, so that the time of a run fits for more than 500 years.
        let age = MOST - (self.since.as_nanos() >> 8).min(MOST);
        Priority { rank: (self.urgency as u64) << AGE_BITS | age, robot }
    }
}

impl RobotKnowledge {
    /// True if the gripper reaches a block from another one: it is the same block, or adjacent and held by a robot that
    /// does not move any more.
    pub(super) fn reaches(&self, block: Block, from: Block) -> bool {
        from == block || (from.distance(block) == 1 && self.routes.is_obstacle(block))
    }

    /// The goal and its urgency, as the knowledge has them now.
    pub(super) fn leg_now(&self) -> (Option<Block>, Urgency) {
        let (goal, urgency) = if self.must_charge {
            let urgency = self.urgency_of_charging();
            // It does not fall on the way: robots that swap their priorities would push each other back and forth.
            let is_same_way = self.leg.goal == Some(self.charge_block);
            (Some(self.charge_block), if is_same_way { self.leg.urgency.max(urgency) } else { urgency })
        } else if let Some(destination) = self.destination() {
            (Some(destination), Urgency::Job)
        } else if self.variables.transporter || self.offers_help || self.lingers > 0 {
            (None, Urgency::None)
        } else {
            (Some(self.charge_block), Urgency::Home)
        };
        let arrived = goal.is_none_or(|goal| goal == self.next)
            || (urgency == Urgency::Job && goal.is_some_and(|goal| self.reaches(goal, self.next)))
            || (urgency != Urgency::Job && self.waits_for_charger());
        (goal, if arrived { Urgency::None } else { urgency })
    }

    /// Selects the goal and its urgency.
    pub(super) fn set_leg(&mut self, now: Time) {
        let (goal, urgency) = self.leg_now();
        if (goal, urgency) != (self.leg.goal, self.leg.urgency) {
            // One that looks for another charger has waited all the same.
            let goes_on = urgency == self.leg.urgency && urgency >= Urgency::Energy;
            self.leg = Leg { goal, urgency, since: if goes_on { self.leg.since } else { now } };
        }
        if let Some(goal) = goal {
            self.routes.head_for(goal);
        }
    }

    /// True if a loop asked the robot to go to its charger after its job: the flag is set, and not by the robot itself.
    pub(super) fn is_asked_home(&self) -> bool {
        self.variables.ready_to_go_under_charge && !self.said_homeward
    }

    /// Two flags: the robot goes to its charger after its job; the robot is on the way there.
    pub(super) fn homeward(&self) -> (bool, bool) {
        let homeward = self.must_charge || self.relieved || self.is_asked_home();
        let Leg { goal, urgency, .. } = self.leg;
        (homeward, homeward && goal == Some(self.charge_block) && urgency != Urgency::None)
    }
}
