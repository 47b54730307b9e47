use saoms_api::{Context, Failure, Publisher, Subscription};

use crate::messages::{
    COLLISION, Collision, EVENT_LUGGAGE, EventLuggage, IMMOVABLE, LuggageStage, POSITION, Position, Priority,
    ROBOT_LIST, RobotList,
};

use super::{Job, Knowledge};

/// The topics of a robot, and what it last said on them.
#[derive(Debug, Default)]
pub(crate) struct Topics {
    luggage: Publisher<EventLuggage>,
    luggage_heard: Subscription<EventLuggage>,
    robots: Publisher<RobotList>,
    robots_heard: Subscription<RobotList>,
    positions: Publisher<Position>,
    positions_heard: Subscription<Position>,
    collisions: Publisher<Collision>,
    said_robot: Option<RobotList>,
    said_position: Option<Position>,
}

/// A robot repeats that it is active when its battery changed by so many percent.
const BATTERY_STEP: f64 = 5.0;

impl Topics {
    pub(crate) fn new(context: &mut Context<'_>) -> Result<Topics, Failure> {
        Ok(Topics {
            luggage: context.publish(&EVENT_LUGGAGE)?,
            luggage_heard: context.subscribe(&EVENT_LUGGAGE)?,
            robots: context.publish(&ROBOT_LIST)?,
            robots_heard: context.subscribe(&ROBOT_LIST)?,
            positions: context.publish(&POSITION)?,
            positions_heard: context.subscribe(&POSITION)?,
            collisions: context.publish(&COLLISION)?,
            said_robot: None,
            said_position: None,
        })
    }

    /// Takes in what arrived for this period.
    pub(crate) fn listen(&self, context: &Context<'_>, knowledge: &mut Knowledge) {
        let lists = &mut knowledge.lists;
        for robot in context.receive(&self.robots_heard) {
            lists.hear_robot(robot);
            knowledge.routes.learn_charger(robot.charger);
        }
        lists.peers.hear(context.receive(&self.positions_heard));
        for stranded in context.receive(&self.robots_heard).filter(|robot| robot.is_out_of_battery()) {
            if let Some(peer) = lists.peers.get(stranded.robot).filter(|peer| peer.priority == IMMOVABLE) {
                knowledge.routes.learn_obstacle(peer.block);
            }
        }
        for (header, event) in context.receive(&self.luggage_heard).with_headers() {
            lists.requests.hear(event, header.sent);
        }
    }

    /// Says that the robot is active, or no longer is.
    pub(crate) fn say_robot(
        &mut self,
        context: &mut Context<'_>,
        knowledge: &Knowledge,
        active: bool,
    ) -> Result<(), Failure> {
        let robot = RobotList {
            robot: knowledge.number,
            active,
            battery: knowledge.battery.percent(),
            in_charge: knowledge.variables.in_charge,
            charger: knowledge.charge_block,
            period: knowledge.period,
        };
        self.said_robot = Some(robot.clone());
        context.send(&self.robots, robot)
    }

    /// The same, where others would learn something from it.
    pub(crate) fn say_robot_if_news(
        &mut self,
        context: &mut Context<'_>,
        knowledge: &Knowledge,
    ) -> Result<(), Failure> {
        let news = self.said_robot.as_ref().is_none_or(|said| {
            said.in_charge != knowledge.variables.in_charge
                || (said.battery - knowledge.battery.percent()).abs() >= BATTERY_STEP
        });
        if news { self.say_robot(context, knowledge, true) } else { Ok(()) }
    }

    /// Responds to a luggage request.
    pub(crate) fn respond(
        &self,
        context: &mut Context<'_>,
        knowledge: &Knowledge,
        job: &Job,
        stage: LuggageStage,
    ) -> Result<(), Failure> {
        context.send(&self.luggage, job.response(knowledge.number, knowledge.block, stage))
    }

    /// Says that the robot entered a block that another one was on.
    pub(crate) fn say_collision(
        &self,
        context: &mut Context<'_>,
        collision: Collision,
    ) -> Result<(), Failure> {
        context.send(&self.collisions, collision)
    }

    /// Says where the robot is and goes.
    pub(crate) fn say_position(
        &mut self,
        context: &mut Context<'_>,
        position: Position,
    ) -> Result<(), Failure> {
        self.said_position = Some(position.clone());
        context.send(&self.positions, position)
    }

    /// The same, where it is not what the others know already.
    pub(crate) fn say_position_if_news(
        &mut self,
        context: &mut Context<'_>,
        position: Position,
    ) -> Result<(), Failure> {
        if self.said_position.as_ref() == Some(&position) {
            return Ok(());
        }
        self.say_position(context, position)
    }
}

impl Knowledge {
    /// What the robot says about its position when it wants nothing but what it holds.
    pub(crate) fn position(&self) -> Position {
        Position {
            robot: self.number,
            block: self.block,
            next: self.next,
            wanted: self.next,
            priority: Priority { rank: 0, robot: self.number },
        }
    }
}
