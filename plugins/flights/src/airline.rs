use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Finding, Own, Place, Publisher, Subscription, Time, Work};
use saoms_components::grid::Block;

use crate::messages::{FLIGHT, FLIGHT_STATE, Flight, FlightState};

/// An airline, which announces a flight and waits until its luggage is on board.
#[derive(Debug, Class)]
#[class(name = "flights.Airline", periodic)]
pub struct Airline {
    /// Number of its flight.
    #[property(unique = "flight")]
    flight: u32,
    /// Number of pieces of luggage of the flight.
    #[property(range = 1..=500)]
    pieces: u32,
    /// Block where the luggage waits, such as `(1,1)`.
    #[property]
    from: String,
    /// Block of the airplane.
    #[property]
    to: String,
    /// Time of the announcement, since the start of the airline.
    #[property(default = "0s", range = "0s"..)]
    at: Duration,
    #[publishes(FLIGHT)]
    flights: Publisher<Flight>,
    #[subscribes(FLIGHT_STATE)]
    states: Subscription<FlightState>,
    announcement: Flight,
    /// Time of its first execution.
    start: Option<Time>,
    announced: bool,
}

impl Component for Airline {
    type Properties = Own<Self>;

    fn new(properties: Own<Self>) -> Result<Self, Failure> {
        let mut airline = Self::made(properties)?;
        let mut wrong = Vec::new();
        let mut block = |name: &str, text: &str| {
            let refuse = |problem| wrong.push(Finding::new(Place::property(name), problem));
            text.parse::<Block>().map_err(refuse).unwrap_or_default()
        };
        let (from, to) = (block("from", &airline.from), block("to", &airline.to));
        if !wrong.is_empty() {
            return Err(Failure::of_findings(wrong));
        }
        airline.announcement = Flight { number: airline.flight, pieces: airline.pieces, from, to };
        Ok(airline)
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.vote(Work::Open);
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let start = *self.start.get_or_insert(context.due());
        if !self.announced && context.due().since(start) >= self.at {
            self.announced = true;
            context.send(&self.flights, self.announcement.clone())?;
        }
        for state in context.receive(&self.states).filter(|state| state.number == self.flight) {
            if state.lost > 0 {
                context.vote(Work::GivenUp);
            }
            if state.open == 0 {
                context.vote(Work::Done);
            }
        }
        Ok(())
    }

    fn waits_for(&self) -> Option<String> {
        self.announced.then(|| format!("the luggage of flight {}", self.flight))
    }
}

#[cfg(test)]
mod tests {
    use saoms_testkit::Bench;

    use super::*;

    const VALUES: &[(&str, &str)] =
        &[("flight", "12"), ("pieces", "3"), ("from", "(1,1)"), ("to", "(9,9)"), ("at", "2s")];

    #[test]
    fn a_flight_is_announced_once_and_in_time() -> Result<(), Failure> {
        let mut airline = Bench::of::<Airline>(VALUES)?.period(Duration::from_secs(1));
        airline.start()?;
        let mut announced = Vec::new();
        for _ in 0..5 {
            airline.execute()?;
            announced.push(airline.sent(&FLIGHT).len());
        }
        assert_eq!(announced.iter().sum::<usize>(), 1, "{announced:?}");
        Ok(())
    }

    #[test]
    fn wrong_blocks_are_all_found() {
        let mut values = VALUES.to_vec();
        (values[2].1, values[3].1) = ("1,1", "(9)");
        let failure = Bench::of::<Airline>(&values).err().unwrap();
        assert_eq!(failure.findings().len(), 2, "{failure}");
    }

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<Airline>(VALUES);
    }
}
