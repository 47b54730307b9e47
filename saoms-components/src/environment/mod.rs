//! What happens outside the fleet, as a scenario tells it.

mod scenario;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;

use saoms_api::{
    Class, Component, Context, Failure, Finding, Place, Properties, Publisher, Subscription, Time, Work,
};

use crate::console::Timestamp;
use crate::hardware::Area;
use crate::messages::{AREA, ENVIRONMENT, EVENT_LUGGAGE, EnvironmentEvent, EventLuggage, LuggageStage};

pub use scenario::{Event, Scenario, ScenarioError};

/// What a composite says about the environment.
#[derive(Clone, Debug, Properties)]
pub struct EnvironmentProperties {
    /// What happens and when, counted from the environment's first execution: one event a line, such as `at 6s luggage (3,1) to (3,10)`,
    /// `then 500ms luggage (10,8) to (1,8)` (after the line before), `at 3s landing 4` or `at 3s takeoff 4`. `;` ends a line, too, and `#`
    /// starts a comment. Without it nothing happens.
    scenario: Vec<String>,
}

/// Plays a scenario: publishes its events at their times.
///
/// It sees the run as done when all luggage of its scenario is delivered or given up.
#[derive(Debug, Class)]
#[class(
    name = "saoms.Environment",
    periodic,
    publishes(ENVIRONMENT),
    subscribes(EVENT_LUGGAGE, AREA),
    also("launch.Environment")
)]
pub struct Environment {
    scenario: Scenario,
    played: usize,
    start: Option<Time>,
    /// Luggage that is published and not delivered yet.
    open: BTreeSet<u32>,
    luggage: u32,
    events: Publisher<EnvironmentEvent>,
    responses: Subscription<EventLuggage>,
    area: Subscription<Area>,
    has_world: bool,
    done: bool,
}

impl Component for Environment {
    type Properties = EnvironmentProperties;

    fn new(properties: EnvironmentProperties) -> Result<Self, Failure> {
        let scenario = Scenario::read(properties.scenario.iter().map(String::as_str))
            .map_err(|error| Finding::new(Place::property("scenario"), error.to_string()))?;
        Ok(Environment {
            scenario,
            played: 0,
            start: None,
            open: BTreeSet::new(),
            luggage: 0,
            events: Publisher::default(),
            responses: Subscription::default(),
            area: Subscription::default(),
            has_world: false,
            done: false,
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.events = context.publish(&ENVIRONMENT)?;
        self.responses = context.subscribe(&EVENT_LUGGAGE)?;
        self.area = context.subscribe(&AREA)?;
        let now = Timestamp::now(context);
        context.console(format_args!("Environment tests start at {now}"));
        if self.scenario.events().is_empty() {
            context.info(format_args!("has no scenario: publishes nothing"));
            self.done = true;
        } else {
            context.console(format_args!("Environment: ready to test at {now}"));
            context.vote(Work::Open);
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.done {
            return Ok(());
        }
        for response in context.receive(&self.responses) {
            // What is given up stays open in the report, but nobody waits for it.
            let counted = match response.stage {
                LuggageStage::Delivered => -1,
                LuggageStage::GivenUp => 0,
                _ => continue,
            };
            if self.open.remove(&response.luggage) && !self.has_world {
                context.count("luggage.open", counted);
            }
        }
        // A world counts luggage itself.
        self.has_world |= context.receive_last(&self.area).is_some();
        let start = *self.start.get_or_insert(context.due());
        while let Some((at, event)) = self.scenario.events().get(self.played)
            && context.due() >= start + *at
        {
            let event = event.clone();
            self.play(context, event)?;
        }
        if self.played == self.scenario.events().len() && self.open.is_empty() {
            self.done = true;
            context.vote(Work::Done);
        }
        Ok(())
    }
}

impl Environment {
    fn play(&mut self, context: &mut Context<'_>, event: Event) -> Result<(), Failure> {
        self.played += 1;
        let (test, now) = (self.played, Timestamp::now(context));
        match event {
            Event::Luggage { from, to } => {
                self.luggage += 1;
                let request = EventLuggage::request(self.luggage, from, to);
                self.open.insert(self.luggage);
                if !self.has_world {
                    context.count("luggage.open", 1);
                }
                context.console(format_args!("Environment: Test{test}: {request} at {now}"));
                context.info(format_args!("luggage {} waits at {from} to be brought to {to}", self.luggage));
                context.send(&self.events, request.into())
            }
            Event::Exceptional(event) => {
                context.console(format_args!("Environment: Test{test}: New event: {event}."));
                context.info(format_args!("{event}"));
                context.send(&self.events, event.into())
            }
        }
    }
}
