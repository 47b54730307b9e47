//! The robots: their knowledge, and the loops by which they act.
//!
//! A robot is [`RobotKnowledge`] and an ordered list of MAPE-K loops that share it, one for each concern. The policy
//! selects the loops: those of [`safe`] (jobs, energy, right of way) or those of [`classic`] (the rules of the manual).
//! Both use the same hardware.
//!
//! A component that is a robot and more [extends](Class#extending-a-class) [`Robot`].

mod actions;
mod battery;
mod catch_up;
mod change_limit;
pub mod classic;
mod console;
mod hardware_client;
mod job;
mod knowledge;
mod lists;
mod memory;
mod orders;
mod properties;
mod receive;
mod routes;
pub mod safe;
mod sayings;
mod strain;
mod tally;
mod upkeep;
mod zone_client;

use saoms_api::host::prefetch;
use saoms_api::{Class, Component, Context, Failure, Loops, ReportValue, Saved, Subscription, Time, Work, interface};

use crate::console::Timestamp;
use crate::hardware::{Hardware, Progress};
use crate::messages::{
    ASSIGNMENT, COLLISION, DRAIN, Drain, EVENT_LUGGAGE, FAULT, GRANT, GRANT_REQUEST, LEASE, OUTAGE, Outage, POSITION,
    PRESENCE, REMOVAL, ROBOT_LIST, TERRITORY, VISIT,
};

pub use battery::{Battery, Consumption};
pub use job::Job;
#[cfg(test)]
pub(crate) use job::lease::Leased;
pub use knowledge::{JobEnd, Orders, RobotKnowledge, Trouble, Variables};
pub use lists::{Assigned, Help, Helps, Lists, Peers, Request, Requests, Rival, WaitingLuggage};
pub use properties::{Policy, RobotProperties};
pub use routes::Routes;

use hardware_client::{HardwareClient, Reply};
pub(crate) use receive::HEARD;
use receive::Topics;
use zone_client::ZoneClient;

/// The kind of alerts of robots that cannot go on without help.
const ASSISTANCE: &str = "assistance";

/// Brings luggage from one block to another, together with other robots.
///
/// The robot starts at its charger, or at the block of `startX` and `startY`. It takes an interest in luggage that
/// waits, goes if no other robot is closer, collects the luggage, brings it to its destination and deposits it, and
/// charges its battery at its charger.
#[derive(Debug, Class)]
#[class(
    name = "saoms.Robot",
    periodic,
    saves,
    knowledge = RobotKnowledge,
    loops(
        property = "policy",
        safe(
            safe::SafeRobotState,
            safe::SafeBattery,
            safe::SafeRobotList,
            safe::SafeCriticalSituation,
            safe::SafeGripper,
            safe::SafeEventLuggage,
            safe::SafeCollision,
            safe::SafePathFollower
        ),
        classic(
            classic::ClassicRobotState,
            classic::ClassicRobotList,
            classic::ClassicBattery,
            classic::ClassicCriticalSituation,
            classic::ClassicEventLuggage,
            classic::ClassicCollision,
            classic::ClassicPathFollower
        )
    ),
    publishes(COLLISION, GRANT_REQUEST, PRESENCE, LEASE),
    subscribes(ROBOT_LIST, EVENT_LUGGAGE, VISIT, POSITION, FAULT, REMOVAL, ASSIGNMENT, TERRITORY, GRANT),
    reference("world": Hardware, optional),
    service("operator": RobotOperator),
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
    // Boxed, since it is large and a robot is moved while it is built.
    knowledge: Box<RobotKnowledge>,
    loops: Loops,
    topics: Topics,
    /// The battery of a robot loses charge at once, or faster for a time.
    #[takes("drain", DRAIN)]
    drains: Subscription<Drain>,
    /// A charger gives nothing for a time.
    #[takes("outage", OUTAGE)]
    outages: Subscription<Outage>,
}

impl Component for Robot {
    type Properties = RobotProperties;

    fn new(properties: RobotProperties) -> Result<Self, Failure> {
        let number = properties.number()?;
        let charge_block = properties.charge_block(number)?;
        properties.check_sleep(charge_block)?;
        let battery = Battery::new(properties.battery, properties.consumption()?);
        let name = properties.id.trim().to_owned();
        let mut knowledge = Box::new(RobotKnowledge::new(name, number, charge_block, battery));
        (knowledge.block, knowledge.next) = (properties.start(charge_block), properties.start(charge_block));
        knowledge.policy = properties.policy;
        knowledge.variables.asleep = properties.asleep;
        knowledge.variables.in_charge = properties.asleep;
        (knowledge.stopped, knowledge.leaving) = (properties.stopped, properties.leaving);
        Ok(Robot {
            knowledge,
            loops: Loops::default(),
            topics: Topics::default(),
            drains: Subscription::default(),
            outages: Subscription::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops = context.loops()?;
        self.knowledge.hardware = HardwareClient::new(context)?;
        self.knowledge.validator.note_speaker(self.knowledge.number, context.sender());
        self.knowledge.collisions = context.publish(&COLLISION)?;
        self.topics = Topics::subscribe(context)?;
        if self.knowledge.policy == Policy::Safe {
            self.knowledge.leases = context.publish(&LEASE)?;
            self.knowledge.zones = ZoneClient::new(context, self.knowledge.number)?.map(Box::new);
        }
        self.knowledge.period = u64::try_from(context.period().as_micros()).unwrap_or(u64::MAX);
        context.console(format_args!("Initialization of {}", self.knowledge.name));
        if context.goes_on() {
            // It was there all the time.
            self.knowledge.began = Some(Time::START);
        } else {
            self.enter(context)?;
            self.topics.hear_around(&mut self.knowledge, context)?;
        }
        self.loops.initialize(&mut *self.knowledge, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.act(context)?;
        if self.knowledge.leaving {
            context.vote(if self.knowledge.has_finished() { Work::Done } else { Work::Open });
        }
        Ok(())
    }

    fn update(&mut self, properties: RobotProperties) -> Result<(), Failure> {
        (self.knowledge.stopped, self.knowledge.leaving) = (properties.stopped, properties.leaving);
        Ok(())
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        // Hardware that is busy is asked again: it must not go on without its robot.
        self.knowledge.leave_hardware(context)?;
        self.knowledge.leave_zones(context)?;
        self.knowledge.report_row(context);
        self.loops.shutdown(&mut *self.knowledge, context)
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        let loops = self.loops.save(&*self.knowledge)?;
        Ok(self.knowledge.save(loops))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let loops = self.knowledge.restore(saved)?;
        self.loops.restore(&mut *self.knowledge, &loops)
    }

    fn waits_for(&self) -> Option<String> {
        self.knowledge.waits_for()
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        self.knowledge.status()
    }
}

/// What a person tells a robot.
#[interface(name = "saoms.RobotOperator")]
pub trait RobotOperator {
    /// Says whether the action was done of which the alert `open_action` tells.
    fn settle(&mut self, context: &mut Context<'_>, done: bool) -> Result<(), Failure>;
}

impl RobotOperator for Robot {
    fn settle(&mut self, _: &mut Context<'_>, done: bool) -> Result<(), Failure> {
        let hardware = &mut self.knowledge.hardware;
        if !hardware.asks_a_person {
            return Err(Failure::new("the robot does not ask what became of an action: it knows that itself"));
        }
        hardware.told = Some(if done { Progress::Done } else { Progress::Failed });
        Ok(())
    }
}

impl Robot {
    /// Knowledge of the robot, for components that extend it.
    pub fn knowledge(&self) -> &RobotKnowledge {
        &self.knowledge
    }

    /// One execution.
    fn act(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        // Both are needed all over; among thousands of robots nothing of them is left in the processor's cache.
        prefetch(&*self.knowledge);
        self.loops.prefetch();
        self.knowledge.hear_strain(self.drains, self.outages, context);
        let Some(gone) = self.knowledge.hear_gone(&self.topics, context) else {
            return self.knowledge.leave_floor(context);
        };
        if self.knowledge.shut_down {
            self.knowledge.hear_zones(context);
            self.knowledge.ask_zones(context)?;
            self.knowledge.repeat_state(context)?;
            return self.knowledge.stop_for_good(context);
        }
        let entered = self.enter(context)?;
        if self.knowledge.gone {
            return Ok(());
        }
        if entered {
            context.console(format_args!(
                "Execution {} of {} starts at {}",
                context.execution(),
                self.knowledge.name,
                Timestamp::now(context)
            ));
        }
        let was_critical = self.knowledge.variables.critical;
        self.knowledge.hear(&mut self.topics, context)?;
        if entered {
            self.knowledge.hear_zones(context);
            if self.knowledge.zones.as_ref().is_some_and(|zones| zones.is_off_floor()) {
                return self.knowledge.leave_floor(context);
            }
        }
        self.knowledge.begin_execution(context)?;
        self.loops.monitor(&mut *self.knowledge, context)?;
        self.knowledge.forget_gone(&gone);
        if entered {
            self.knowledge.poll_unwatched(&self.loops, context)?;
            self.knowledge.measure();
            self.knowledge.show_lists(context);
            let in_charge = self.knowledge.variables.in_charge;
            self.loops.adapt(&mut *self.knowledge, context)?;
            self.knowledge.carry_out(&self.loops, context)?;
            self.knowledge.end_execution(was_critical, context)?;
            self.knowledge.ask_zones(context)?;
            self.knowledge.repeat_state(context)?;
            self.knowledge.renew_lease(context)?;
            self.knowledge.note_waiting();
            // As in figures 8.6 and 8.15, a robot that arrives at its charger shows only that.
            if in_charge || !self.knowledge.variables.in_charge {
                self.knowledge.show_battery(context);
            }
        }
        Ok(())
    }

    /// Registers the robot with the world and learns the map, or learns what the world did while the robot was out;
    /// `false` while the world cannot be reached.
    fn enter(&mut self, context: &mut Context<'_>) -> Result<bool, Failure> {
        let knowledge = &mut self.knowledge;
        if knowledge.hardware.has_entered() {
            return Ok(true);
        }
        if knowledge.hardware.is_catching_up() {
            return knowledge.catch_up(context);
        }
        if knowledge.hardware.is_wired() && knowledge.routes.map().is_none() {
            let Reply::Answer(map) = knowledge.hardware.area(context)? else { return Ok(false) };
            knowledge.routes.learn(map, knowledge.charge_block);
        }
        if !knowledge.may_enter(context)? {
            return Ok(false);
        }
        match knowledge.hardware.enter(context, knowledge.number, &knowledge.name, knowledge.block)? {
            Reply::Later => Ok(false),
            Reply::Answer(block) => {
                (knowledge.block, knowledge.next) = (block, block);
                Ok(true)
            }
        }
    }
}
