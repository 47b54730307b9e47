//! Messages that robots receive from other robots, after validation.

use saoms_api::{Context, Header, Subscription};

use super::RobotKnowledge;
use crate::messages::{EventLuggage, Position, RobotList};
use crate::validation::Validate;

impl RobotKnowledge {
    /// True if the message is possible and sent by the robot that it names. Rejected messages are logged.
    pub(super) fn accepts<M: Validate>(&mut self, message: &M, header: Header, context: &mut Context<'_>) -> bool {
        self.validator.accepts(message, header, self.routes.map(), context)
    }

    /// Handles the positions of other robots.
    pub(super) fn hear_positions(&mut self, positions: Subscription<Position>, context: &mut Context<'_>) {
        let RobotKnowledge { validator, lists, routes, .. } = self;
        let heard = context.receive(&positions).with_headers();
        let sound = heard.filter(|(header, position)| validator.accepts(*position, *header, routes.map(), context));
        lists.peers.hear(sound.map(|(_, position)| position));
    }

    /// Handles the states of other robots, and passes each to `learn`.
    pub(super) fn hear_robots<'a>(
        &mut self,
        robots: Subscription<RobotList>,
        context: &mut Context<'a>,
        mut learn: impl FnMut(&mut RobotKnowledge, &'a RobotList),
    ) {
        for (header, robot) in context.receive(&robots).with_headers() {
            if self.accepts(robot, header, context) {
                self.lists.hear_robot(robot);
                self.routes.learn_charger(robot.charger);
                learn(self, robot);
            }
        }
    }

    /// Handles messages about luggage.
    pub(super) fn hear_luggage(&mut self, luggage: Subscription<EventLuggage>, context: &mut Context<'_>) {
        for (header, event) in context.receive(&luggage).with_headers() {
            if self.accepts(event, header, context) {
                self.lists.requests.hear(event, header);
            }
        }
    }
}
