//! One execution on the way: going where it is clear, and saying what comes next.

use saoms_api::Failure;

use crate::hardware::Action;
use crate::messages::{IMMOVABLE, Position};
use crate::robot::Body;
use crate::robot::actions::Outcome;

use super::traffic::Claim;
use super::{Safe, is_at_destination};

impl Safe {
    pub(super) fn drive(&mut self, body: &mut Body<'_, '_>) -> Result<(), Failure> {
        self.traffic.look(&body.knowledge.lists.peers, body.knowledge.next);
        self.go(body)?;
        let knowledge = &*body.knowledge;
        let at = knowledge.next;
        let stays =
            is_at_destination(body) && !self.energy.must_charge() || self.energy.holds_charger(knowledge);
        let (wanted, priority) = if stays {
            self.traffic.stay(at);
            (at, IMMOVABLE)
        } else {
            let own = self.leg.priority(knowledge.number);
            let priority = self.traffic.inherited(own, at);
            let claim = Claim { robot: knowledge.number, at, goal: self.leg.goal, priority };
            (self.traffic.choose(&claim, own, &knowledge.routes, body.context.chance()), priority)
        };
        if wanted != at {
            body.show_move(wanted);
        }
        let position = Position { wanted, priority, ..body.knowledge.position() };
        body.topics.say_position_if_news(body.context, position)
    }

    /// Goes to the block that was wanted in an earlier execution, if it is clear now.
    fn go(&mut self, body: &mut Body<'_, '_>) -> Result<(), Failure> {
        let from = body.knowledge.next;
        let Some(wanted) = self.traffic.wanted(from).filter(|wanted| self.traffic.is_clear(*wanted)) else {
            return Ok(());
        };
        if body.knowledge.block != from {
            return Ok(());
        }
        match body.begin(Action::move_to(wanted))? {
            Outcome::Done | Outcome::Running => {
                self.traffic.went(from);
                self.traffic.look(&body.knowledge.lists.peers, wanted);
            }
            Outcome::NotBegun | Outcome::Failed => {}
        }
        Ok(())
    }
}
