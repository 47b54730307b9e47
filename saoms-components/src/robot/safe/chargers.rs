//! Which charger a robot uses that cannot use its own one.

use crate::grid::{Block, UNREACHABLE};
use crate::robot::RobotKnowledge;

impl RobotKnowledge {
    /// The closest free charger, otherwise the closest one where another robot is, if the battery lasts for the way to
    /// it. At one where another robot is, this one can wait.
    pub(super) fn charger_elsewhere(&mut self, gives: impl Fn(Block) -> bool) -> Option<Block> {
        if self.next != self.block {
            return None;
        }
        let own = self.charge_block;
        let ((is_used, way), closest) = self.closest_charger(true, |charger| charger != own && gives(charger))?;
        let waiting = if is_used { self.usual_reserve() / 2 } else { 0 };
        let lasts = self.executions_left() > self.home_to(closest).saturating_add(waiting);
        (way != UNREACHABLE && lasts).then_some(closest)
    }

    /// The closest free charger that is closer than the robot's own, if the battery does not last for the way to its
    /// own.
    pub(super) fn charger_in_reach(&mut self, gives: impl Fn(Block) -> bool) -> Option<Block> {
        let home = self.home(self.next);
        if self.executions_left() > home || self.next != self.block {
            return None;
        }
        let left = self.executions_left();
        let unclaimed = self.unclaimed_charger(&gives).filter(|closest| self.home_to(*closest) < left);
        let closest = unclaimed.or_else(|| self.closest_charger(false, gives).map(|(_, closest)| closest))?;
        (self.home_to(closest) < home).then_some(closest)
    }

    /// The closest free charger to which no other robot is on its way because it has to charge.
    fn unclaimed_charger(&mut self, gives: impl Fn(Block) -> bool) -> Option<Block> {
        let places = self.lists.charging_places.iter().copied();
        let claimed: Vec<Block> = places.filter(|charger| self.is_claimed(*charger)).collect();
        let (_, closest) = self.closest_charger(false, |charger| gives(charger) && !claimed.contains(&charger))?;
        Some(closest)
    }

    /// The closest free charger to which no other robot is on its way, if others have held the robot up on the way to
    /// its own for as long as the way there takes, and the battery lasts for that.
    pub(super) fn charger_on_detour(&mut self, gives: impl Fn(Block) -> bool) -> Option<Block> {
        let (held_up, own) = (self.energy.held_up(), self.charge_block);
        if held_up == 0 || self.next != self.block {
            return None;
        }
        let closest = self.unclaimed_charger(|charger| charger != own && gives(charger))?;
        let there = self.home_to(closest);
        let lasts = self.executions_left() > there.saturating_add(self.usual_reserve() / 2);
        (held_up >= there && lasts).then_some(closest)
    }

    /// The closest of these chargers, those without a robot first, or these alone: if another robot is there, the
    /// number of moves, and its block.
    fn closest_charger(&mut self, also_used: bool, is_meant: impl Fn(Block) -> bool) -> Option<((bool, u32), Block)> {
        let RobotKnowledge { lists, routes, next, .. } = self;
        let meant = lists.charging_places.iter().copied().filter(|one| is_meant(*one) && !routes.is_obstacle(*one));
        let meant: Vec<(bool, Block)> = meant.map(|one| (lists.peers.on(one).is_some(), one)).collect();
        let ways = meant.into_iter().filter(|(is_used, _)| also_used || !is_used);
        ways.map(|(is_used, one)| ((is_used, routes.between(*next, one)), one)).min()
    }

    /// True if a way leads to a charger, and no robot that does not move any more is there.
    pub(super) fn leads_to(&mut self, charger: Block) -> bool {
        self.routes.between(self.next, charger) != UNREACHABLE && !self.routes.is_obstacle(charger)
    }

    /// Another charger, if no way leads to the robot's own: the closest one that no robot uses any more, otherwise the
    /// closest one, where robots charge one after the other.
    pub(super) fn other_charger(&mut self) -> Option<Block> {
        if self.leads_to(self.charge_block) {
            return None;
        }
        let RobotKnowledge { lists, routes, next, .. } = self;
        let chargers = lists.chargers.iter().filter(|(_, charger)| !routes.is_obstacle(*charger));
        let chargers: Vec<(bool, Block)> =
            chargers.map(|(robot, charger)| (lists.is_active(*robot), *charger)).collect();
        let ways = chargers.into_iter().map(|(used, charger)| (used, routes.between(*next, charger), charger));
        ways.filter(|(_, way, _)| *way != UNREACHABLE).min().map(|(_, _, charger)| charger)
    }
}
