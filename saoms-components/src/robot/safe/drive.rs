//! One execution on the way: going where it is clear, and saying what comes next.

use saoms_api::Failure;

use crate::hardware::Action;
use crate::messages::{IMMOVABLE, Position};
use crate::robot::Body;
use crate::robot::actions::Outcome;

use super::traffic::Claim;
use super::{Safe, Urgency};

/// A robot tells that it waits when it does so for so many executions.
const TELLING_WAIT: u32 = 3;

impl Safe {
    pub(super) fn drive(&mut self, body: &mut Body<'_, '_>) -> Result<(), Failure> {
        self.traffic.look(&body.knowledge.lists.peers, body.knowledge.next);
        let goes_on = self.go(body)?;
        self.energy.pace().note_way(self.leg.urgency != Urgency::None, goes_on);
        let knowledge = &mut *body.knowledge;
        let at = knowledge.next;
        let stays = self.job_here(knowledge).is_some() || self.energy.holds_charger(knowledge);
        let (wanted, priority) = if stays {
            self.traffic.stay(at);
            (at, IMMOVABLE)
        } else {
            let own = self.leg.priority(knowledge.number);
            let priority = self.traffic.inherited(own, at);
            let y_first = self.leg.goal == Some(knowledge.charge_block);
            let moves = knowledge.block != at;
            let tempo = if moves { 0 } else { self.energy.tempo(knowledge) };
            let claim = Claim { robot: knowledge.number, at, goal: self.leg.goal, y_first, priority, tempo };
            (self.traffic.choose(&claim, own, &knowledge.routes, body.context.chance()), priority)
        };
        if wanted != at {
            body.show_move(wanted);
        }
        if self.traffic.waited() == TELLING_WAIT {
            body.context.info(format_args!("waits at {at} for others"));
        }
        let position = Position { wanted, priority, ..body.knowledge.position() };
        body.topics.say_position_if_news(body.context, position)
    }

    /// Goes to the block that was wanted in an earlier execution, if it is clear now.
    fn go(&mut self, body: &mut Body<'_, '_>) -> Result<bool, Failure> {
        let from = body.knowledge.next;
        let wanted = self.traffic.wanted(from).filter(|wanted| self.traffic.is_clear(*wanted));
        let Some(wanted) = wanted.filter(|_| body.knowledge.block == from) else { return Ok(false) };
        let outcome = body.begin(Action::move_to(wanted))?;
        let goes_on = matches!(outcome, Outcome::Done | Outcome::Running);
        if goes_on {
            self.traffic.went(from);
            self.traffic.look(&body.knowledge.lists.peers, wanted);
        }
        Ok(goes_on)
    }
}
