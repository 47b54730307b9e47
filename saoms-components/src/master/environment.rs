use saoms_api::{Class, Component, Context, Failure, Publisher, Subscription};

use crate::console::Timestamp;
use crate::messages::{
    ENVIRONMENT, EVENT_LUGGAGE, EXCEPTIONAL_EVENT, EnvironmentEvent, EventLuggage, ExceptionalEvent,
};

/// Sorts the events of the environment to their topics: luggage to the robots, exceptional events to the master of the robots.
#[derive(Debug, Class)]
#[class(
    name = "saoms.MasterEnvironment",
    periodic,
    subscribes(ENVIRONMENT),
    publishes(EVENT_LUGGAGE, EXCEPTIONAL_EVENT),
    also("unibg.saoms.MasterEnvironmentManagingSystem")
)]
pub struct MasterEnvironment {
    events: Subscription<EnvironmentEvent>,
    luggage: Publisher<EventLuggage>,
    exceptional: Publisher<ExceptionalEvent>,
}

impl Component for MasterEnvironment {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(MasterEnvironment {
            events: Subscription::default(),
            luggage: Publisher::default(),
            exceptional: Publisher::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.events = context.subscribe(&ENVIRONMENT)?;
        self.luggage = context.publish(&EVENT_LUGGAGE)?;
        self.exceptional = context.publish(&EXCEPTIONAL_EVENT)?;
        context.count("luggage.requested", 0);
        let now = Timestamp::now(context);
        context.console(format_args!("MasterEnvironmentManagingSystem starts at {now}"));
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = Timestamp::now(context);
        for event in context.receive(&self.events) {
            for luggage in &event.luggage {
                context.count("luggage.requested", 1);
                let EventLuggage { luggage, from, to, .. } = *luggage;
                context.send(&self.luggage, EventLuggage::request(luggage, from, to))?;
            }
            for exceptional in &event.exceptional {
                context.send(&self.exceptional, exceptional.clone())?;
            }
            context.console(format_args!(
                "MasterEnvironmentManagingSystem: new event received and managed at {now}"
            ));
        }
        Ok(())
    }
}
