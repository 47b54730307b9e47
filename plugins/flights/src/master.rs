use saoms_api::{Cause, Class, Component, Context, Failure, Own, Publisher, Subscription, info, warn};
use saoms_components::master::MasterEnvironment;
use saoms_components::messages::{ENVIRONMENT, EVENT_LUGGAGE, EnvironmentEvent, EventLuggage};

use crate::messages::{FLIGHT, FLIGHT_STATE, Flight, FlightState};
use crate::open::Flights;

/// A master that distributes the events of the environment, and requests the luggage of flights.
#[derive(Debug, Class)]
#[class(name = "flights.MasterEnvironment", periodic)]
pub struct FlightMaster {
    #[extends]
    master: MasterEnvironment,
    /// First number of the luggage of flights; other luggage must have lower numbers.
    #[property(default = 1000, range = 1..)]
    first_luggage: u32,
    #[subscribes(FLIGHT)]
    announced: Subscription<Flight>,
    #[subscribes(EVENT_LUGGAGE)]
    responses: Subscription<EventLuggage>,
    #[publishes(ENVIRONMENT)]
    events: Publisher<EnvironmentEvent>,
    #[publishes(FLIGHT_STATE)]
    states: Publisher<FlightState>,
    flights: Flights,
}

impl Component for FlightMaster {
    type Properties = Own<Self>;

    fn new(properties: Own<Self>) -> Result<Self, Failure> {
        let mut master = Self::made(properties)?;
        master.flights = Flights::new(master.first_luggage);
        Ok(master)
    }

    // The rest, such as `initialize`, is that of the master that ships.
    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.master.execute(context)?;
        for (header, flight) in context.receive(&self.announced).with_headers() {
            context.because(header.cause);
            match self.flights.add(flight) {
                Ok((state, luggage)) => {
                    info!(context, "flight {} has {} pieces of luggage", flight.number, flight.pieces);
                    context.send(&self.states, state)?;
                    // Like luggage from any other sender, the master receives and checks this itself.
                    context.send(&self.events, EnvironmentEvent { luggage, ..EnvironmentEvent::default() })?;
                }
                Err(reason) => {
                    let sender = context.sender_name(header).unwrap_or("nobody").to_owned();
                    context.count("flights.ignored", 1);
                    warn!(context, "ignores what `{sender}` says: {reason}");
                }
            }
        }
        for (header, response) in context.receive(&self.responses).with_headers() {
            let Some(state) = self.flights.hear(response) else { continue };
            context.because(header.cause);
            if state.open == 0 {
                context.count("flights.done", 1);
                let FlightState { number, loaded, lost, .. } = state;
                info!(context, "flight {number} has {loaded} pieces on board, {lost} are lost");
            }
            context.send(&self.states, state)?;
        }
        context.because(Cause::default());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use saoms_components::grid::Block;
    use saoms_components::messages::{EXCEPTIONAL_EVENT, ExceptionalEvent, LuggageStage};
    use saoms_testkit::Bench;

    use super::*;

    fn flight() -> Flight {
        Flight { number: 7, pieces: 2, from: Block::new(1, 1), to: Block::new(2, 2) }
    }

    #[test]
    fn a_flight_becomes_requests_for_luggage() -> Result<(), Failure> {
        let mut master = Bench::of::<FlightMaster>(&[("firstLuggage", "50")])?;
        master.start()?;
        master.deliver(&FLIGHT, flight());
        master.execute()?;
        let events = master.sent(&ENVIRONMENT);
        let numbers: Vec<u32> = events.iter().flat_map(|event| &event.luggage).map(|one| one.luggage).collect();
        assert_eq!(numbers, [50, 51]);
        assert_eq!(master.sent(&FLIGHT_STATE)[0].open, 2);
        let brought = EventLuggage { luggage: 50, stage: LuggageStage::Delivered, ..EventLuggage::default() };
        master.deliver(&EVENT_LUGGAGE, brought);
        master.execute()?;
        assert_eq!(master.sent(&FLIGHT_STATE), [FlightState { number: 7, open: 1, loaded: 1, lost: 0 }]);
        Ok(())
    }

    #[test]
    fn it_is_still_a_master_of_the_environment() -> Result<(), Failure> {
        let mut master = Bench::of::<FlightMaster>(&[])?;
        master.start()?;
        let landing = ExceptionalEvent { pieces: 4, ..ExceptionalEvent::default() };
        master.deliver(&ENVIRONMENT, landing.clone().into());
        master.execute()?;
        assert_eq!(master.sent(&EXCEPTIONAL_EVENT), [landing]);
        Ok(())
    }

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<FlightMaster>(&[]);
    }
}
