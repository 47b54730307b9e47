//! What robots hear from others, as far as they let it in.

use saoms_api::{Context, Header, Subscription};

use super::RobotKnowledge;
use crate::intake::Judged;
use crate::messages::{EventLuggage, Position, RobotList};

impl RobotKnowledge {
    /// Whether a message can be, and is of who it says. What is not let in is told.
    pub(super) fn lets_in<M: Judged>(
        &mut self,
        message: &M,
        header: Header,
        context: &mut Context<'_>,
    ) -> bool {
        self.intake.lets_in(message, header, self.routes.map(), context)
    }

    /// Takes in where the others are.
    pub(super) fn hear_positions(&mut self, positions: Subscription<Position>, context: &mut Context<'_>) {
        let RobotKnowledge { intake, lists, routes, .. } = self;
        let heard = context.receive(&positions).with_headers();
        let sound =
            heard.filter(|(header, position)| intake.lets_in(*position, *header, routes.map(), context));
        lists.peers.hear(sound.map(|(_, position)| position));
    }

    /// Takes in who is there, and gives it on to who has more to learn from it.
    pub(super) fn hear_robots<'a>(
        &mut self,
        robots: Subscription<RobotList>,
        context: &mut Context<'a>,
        mut learn: impl FnMut(&mut RobotKnowledge, &'a RobotList),
    ) {
        for (header, robot) in context.receive(&robots).with_headers() {
            if self.lets_in(robot, header, context) {
                self.lists.hear_robot(robot);
                self.routes.learn_charger(robot.charger);
                learn(self, robot);
            }
        }
    }

    /// Takes in what was said about luggage.
    pub(super) fn hear_luggage(&mut self, luggage: Subscription<EventLuggage>, context: &mut Context<'_>) {
        for (header, event) in context.receive(&luggage).with_headers() {
            if self.lets_in(event, header, context) {
                self.lists.requests.hear(event, header);
            }
        }
    }
}
