//! The physical state of the fleet: the map, the real positions of robots and luggage, and the simulated hardware of
//! the robots.

mod hardware;
mod luggage;
mod map_change;
mod memory;
mod properties;
mod referee;
mod removals;
mod strain;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use saoms_api::{Cause, Class, Component, Context, Failure, Publisher, ReportValue, Saved, Subscription, Work, warn};

use crate::hardware::Hardware;
use crate::messages::{
    AREA, COLLISION, Collision, DRAIN, Drain, ENVIRONMENT, EVENT_LUGGAGE, EnvironmentEvent, EventLuggage, Fault,
    FaultKind, HANDLING, Handling, LuggageStage, OUTAGE, Outage, REMOVAL, REMOVAL_ASKED, ROBOT_LIST, Removal,
    RobotList, SLOW, Slow, is_visit,
};
use crate::report::pieces;
use crate::validation::{MessageValidator, Problem};

pub use properties::WorldProperties;

use luggage::Stock;
use memory::Memory;
use referee::Referee;
use strain::EarlyFault;

/// The physical world of a fleet.
///
/// Robots whose reference `world` leads here drive simulated hardware: their actions take the time that the properties
/// set, and succeed only where they are possible. The world counts deliveries and collisions. A robot that breaks down
/// stays where it is, with its luggage, which another robot beside it can take over; so does one whose component has
/// failed. One that somebody took off the floor leaves its luggage on its block, which is free then. The run ends when
/// all luggage is delivered or given up; it is incomplete if any was given up.
#[derive(Debug, Class)]
#[class(
    name = "saoms.World",
    periodic,
    saves,
    publishes(AREA),
    service("hardware": Hardware)
)]
pub struct World {
    properties: WorldProperties,
    referee: Referee,
    stock: Stock,
    validator: MessageValidator,
    #[subscribes(ENVIRONMENT)]
    events: Subscription<EnvironmentEvent>,
    #[subscribes(ROBOT_LIST)]
    robots: Subscription<RobotList>,
    #[subscribes(EVENT_LUGGAGE)]
    responses: Subscription<EventLuggage>,
    /// The moves of a robot, collecting and depositing take longer by a factor, for a time.
    #[takes("slow", SLOW)]
    slowed: Subscription<Slow>,
    /// The battery of a robot loses charge at once, or faster for a time.
    #[takes("drain", DRAIN)]
    drained: Subscription<Drain>,
    /// A charger gives nothing for a time.
    #[takes("outage", OUTAGE)]
    outages: Subscription<Outage>,
    #[publishes(COLLISION)]
    collisions: Publisher<Collision>,
    #[publishes(HANDLING)]
    handlings: Publisher<Handling>,
    #[publishes(REMOVAL)]
    removals: Publisher<Removal>,
    #[subscribes(REMOVAL_ASKED)]
    removals_asked: Subscription<Fault>,
    /// What it said last that a robot left, by robot.
    left: BTreeMap<u32, Removal>,
    /// Faults of robots that are not on the floor yet.
    early: Vec<EarlyFault>,
    vote: Option<Work>,
    /// Number of collisions.
    collided: usize,
    /// The robots that broke down.
    broken: BTreeSet<u32>,
    /// Its newest saved state.
    memory: Memory,
}

impl Component for World {
    type Properties = WorldProperties;

    fn new(properties: WorldProperties) -> Result<Self, Failure> {
        let map = properties.map().map_err(Failure::of_findings)?;
        Ok(World {
            properties,
            referee: Referee::new(map),
            stock: Stock::default(),
            validator: MessageValidator::default(),
            events: Subscription::default(),
            robots: Subscription::default(),
            responses: Subscription::default(),
            slowed: Subscription::default(),
            drained: Subscription::default(),
            outages: Subscription::default(),
            collisions: Publisher::default(),
            handlings: Publisher::default(),
            removals: Publisher::default(),
            removals_asked: Subscription::default(),
            left: BTreeMap::new(),
            early: Vec::new(),
            vote: None,
            collided: 0,
            broken: BTreeSet::new(),
            memory: Memory::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let area = context.publish(&AREA)?;
        context.send(&area, self.referee.map().into())?;
        for section in [
            "luggage.delivered", "luggage.open", "luggage.given_up", "collisions.vertex", "collisions.swap", "stranded",
        ] {
            context.count(section, 0);
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.memory.forget();
        for (header, event) in context.receive(&self.events).with_headers() {
            // Impossible luggage is reported by the master of the environment, which does not forward it.
            let map = self.referee.map();
            let can_be = |request: &&EventLuggage| Problem::of_request(request, Some(map)).is_ok();
            for request in event.luggage.iter().filter(can_be) {
                if self.stock.add(request.luggage, request.from, request.to) {
                    context.count("luggage.open", 1);
                }
            }
            for fault in &event.faults {
                match fault.kind {
                    FaultKind::Breakdown => self.break_down(context, fault),
                    FaultKind::Gone => {
                        context.because(header.cause);
                        self.take_away(context, fault, fault.since.unwrap_or(header.sent))?;
                        context.because(Cause::default());
                    }
                    FaultKind::Failed | FaultKind::Restarting => {
                        context.because(header.cause);
                        self.stop_failed(context, fault, fault.since.unwrap_or(header.sent))?;
                        context.because(Cause::default());
                    }
                }
            }
        }
        for (header, fault) in context.receive(&self.removals_asked).with_headers() {
            if fault.is_any() {
                self.say_all_again(context)?;
            } else if fault.silences() && self.validator.accepts(fault, header, None, context) {
                context.because(header.cause);
                self.say_again(context, fault, fault.since.unwrap_or(header.sent))?;
                context.because(Cause::default());
            }
        }
        // The components that speak for each robot.
        for (header, robot) in context.receive(&self.robots).with_headers() {
            if self.validator.accepts(robot, header, Some(self.referee.map()), context) {
                self.referee.note_period(robot.robot, robot.period);
            }
        }
        self.take_strain(context);
        for (header, response) in context.receive(&self.responses).with_headers() {
            if !self.validator.accepts(response, header, Some(self.referee.map()), context) {
                continue;
            }
            let EventLuggage { luggage, stage, from, to, .. } = *response;
            // What the environment says of it may arrive later than the robot that brings it.
            let waits = matches!(stage, LuggageStage::Request | LuggageStage::Taken) && !is_visit(luggage);
            if waits && self.stock.add(luggage, from, to) {
                context.count("luggage.open", 1);
            }
            if stage == LuggageStage::GivenUp && self.stock.give_up(luggage) {
                context.count("luggage.given_up", 1);
                context.vote(Work::GivenUp);
            }
        }
        self.stock.settle();
        self.referee.settle(context.now());
        self.vote(context);
        Ok(())
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.end_early(context);
        self.report_row(context);
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.save_state())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.restore_state(saved)
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        self.counts()
    }

    fn waits_for(&self) -> Option<String> {
        let Some((first, more)) = self.stock.first_open() else { return Some("luggage".to_owned()) };
        let pieces = pieces(first, more);
        Some(match self.referee.is_empty() {
            true => format!("a robot with a reference `world` to it, to carry {pieces}"),
            false => format!("a robot to carry {pieces}"),
        })
    }
}

impl World {
    /// The world does not vote before there is luggage, so that a fleet without a scenario runs until it is stopped.
    fn vote(&mut self, context: &mut Context<'_>) {
        let vote = match self.stock.is_settled() {
            _ if self.stock.is_empty() => return,
            true => Work::Done,
            false => Work::Open,
        };
        if self.vote != Some(vote) {
            self.vote = Some(vote);
            context.vote(vote);
        }
    }

    /// Writes the row of the world to the report: the sections count all worlds together.
    fn report_row(&self, context: &mut Context<'_>) {
        // Dots lead into objects.
        let key = context.name().replace('.', "_");
        context.report(&format!("worlds.{key}"), ReportValue::Map(self.counts()));
    }

    /// Its counts so far.
    fn counts(&self) -> Vec<(String, ReportValue)> {
        let number = |number: usize| ReportValue::from(i64::try_from(number).unwrap_or(i64::MAX));
        let (delivered, open, given_up) = self.stock.counts();
        ReportValue::named([
            ("robots", number(self.referee.robots())),
            ("delivered", number(delivered)),
            ("open", number(open)),
            ("given_up", number(given_up)),
            ("collisions", number(self.collided)),
        ])
    }

    fn count_delivery(&mut self, context: &mut Context<'_>, was_given_up: bool) {
        context.count("luggage.delivered", 1);
        context.count("luggage.open", -1);
        if was_given_up {
            context.count("luggage.given_up", -1);
        }
        self.vote(context);
    }

    fn break_down(&mut self, context: &mut Context<'_>, fault: &Fault) {
        if self.referee.retire(fault.robot).is_ok() {
            // One that is broken already, or was repaired, is one robot.
            if self.broken.insert(fault.robot) {
                context.count("robots.broken", 1);
            }
            warn!(context, "{fault}");
        }
    }
}
