//! The robots: what they know, what they hear, and the two policies by which they act.
//!
//! [`Knowledge`] is apart from behaviour. In each execution a robot takes in what arrived, uses its battery, says that it is active, and then
//! acts by its policy: `safe` (jobs, energy, right of way) or `classic` (the rules of the manual). Both drive the same hooks.

mod actions;
mod battery;
mod body;
mod classic;
mod hooks;
mod job;
mod knowledge;
mod lists;
mod properties;
mod routes;
mod safe;
mod topics;

use saoms_api::{Class, Component, Context, Failure};

use crate::console::Timestamp;
use crate::hardware::Hardware;
use crate::messages::{COLLISION, EVENT_LUGGAGE, POSITION, ROBOT_LIST};

pub use battery::Battery;
pub use job::Job;
pub use knowledge::{Knowledge, Variables};
pub use lists::{Lists, Peers, Request, Requests, Rival};
pub use properties::{Policy, RobotProperties};
pub use routes::Routes;

use body::Body;
use classic::Classic;
use hooks::{Hooks, Reply};
use safe::Safe;
use topics::Topics;

/// Brings luggage from one block to another, together with other robots.
///
/// It starts at its charger, takes an interest in luggage that waits, goes when no other robot is closer, collects, brings and deposits it,
/// and charges its battery there where it started.
#[derive(Debug, Class)]
#[class(
    name = "saoms.Robot",
    periodic,
    publishes(EVENT_LUGGAGE, ROBOT_LIST, POSITION, COLLISION),
    subscribes(EVENT_LUGGAGE, ROBOT_LIST, POSITION),
    reference("world": Hardware, optional),
    also("unibg.saoms.RobotImpl"),
    also("robot.Robot001", number = 1),
    also("robot.Robot002", number = 2),
    also("robot.Robot003", number = 3),
    also("robot.Robot004", number = 4),
    also("robot.Robot005", number = 5),
    also("robot.Robot006", number = 6),
    also("robot.Robot007", number = 7),
    also("robot.Robot008", number = 8),
    also("robot.Robot009", number = 9),
    also("robot.Robot010", number = 10)
)]
pub struct Robot {
    knowledge: Knowledge,
    hooks: Hooks,
    topics: Topics,
    rules: Rules,
}

/// The behaviour of a policy.
#[derive(Debug)]
enum Rules {
    Safe(Safe),
    Classic(Classic),
}

impl Component for Robot {
    type Properties = RobotProperties;

    fn new(properties: RobotProperties) -> Result<Self, Failure> {
        let number = properties.number()?;
        let charge_block = properties.charge_block(number)?;
        let battery = Battery::new(properties.battery, properties.discharge);
        let name = properties.id.trim().to_owned();
        Ok(Robot {
            knowledge: Knowledge::new(name, number, charge_block, battery),
            hooks: Hooks::default(),
            topics: Topics::default(),
            rules: match properties.policy {
                Policy::Safe => Rules::Safe(Safe::default()),
                Policy::Classic => Rules::Classic(Classic::default()),
            },
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.topics = Topics::new(context)?;
        self.hooks = Hooks::new(context)?;
        self.knowledge.period = u64::try_from(context.period().as_micros()).unwrap_or(u64::MAX);
        context.console(format_args!("Initialization of {}", self.knowledge.name));
        self.enter(context)?;
        if matches!(self.rules, Rules::Safe(_)) {
            // Before anybody moves, everybody has to know which blocks are held.
            self.topics.say_position(context, self.knowledge.position())?;
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let entered = self.enter(context)?;
        self.topics.listen(context, &mut self.knowledge);
        if !entered {
            return Ok(());
        }
        context.console(format_args!(
            "Execution {} of {} starts at {}",
            context.execution(),
            self.knowledge.name,
            Timestamp(context.now())
        ));
        let mut body = Body {
            knowledge: &mut self.knowledge,
            hooks: &mut self.hooks,
            topics: &mut self.topics,
            context,
        };
        match &mut self.rules {
            Rules::Safe(safe) => safe.execute(&mut body),
            Rules::Classic(classic) => classic.execute(&mut body),
        }
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.hooks.stop(context, self.knowledge.number)?;
        self.topics.say_robot(context, &self.knowledge, false)
    }
}

impl Robot {
    /// Says to the world that the robot is there, and learns the map; `false` while the world cannot be reached.
    fn enter(&mut self, context: &mut Context<'_>) -> Result<bool, Failure> {
        if self.hooks.has_entered() {
            return Ok(true);
        }
        let knowledge = &mut self.knowledge;
        match self.hooks.enter(context, knowledge.number, &knowledge.name, knowledge.block)? {
            Reply::Later => Ok(false),
            Reply::Answer((block, map)) => {
                (knowledge.block, knowledge.next) = (block, block);
                if let Some(map) = map {
                    knowledge.routes.learn(map, knowledge.charge_block);
                }
                Ok(true)
            }
        }
    }
}
