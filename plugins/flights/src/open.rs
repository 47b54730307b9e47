use std::collections::BTreeMap;

use saoms_components::messages::{EventLuggage, LuggageStage};

use crate::messages::{Flight, FlightState};

/// Maximum number of pieces of a flight.
const MOST: u32 = 500;

/// Flights and their luggage.
#[derive(Debug, Default)]
pub(crate) struct Flights {
    /// Number of the next piece.
    next: u32,
    states: BTreeMap<u32, FlightState>,
    /// The flight of each piece that is open.
    pieces: BTreeMap<u32, u32>,
}

impl Flights {
    /// No flights; their luggage is numbered from `first` on.
    pub(crate) fn new(first: u32) -> Flights {
        Flights { next: first, states: BTreeMap::new(), pieces: BTreeMap::new() }
    }

    /// Adds a flight; returns its state, and the requests for its luggage.
    pub(crate) fn add(&mut self, flight: &Flight) -> Result<(FlightState, Vec<EventLuggage>), String> {
        let Flight { number, pieces, from, to } = *flight;
        if self.states.contains_key(&number) {
            return Err(format!("flight {number} is known already"));
        }
        if !(1..=MOST).contains(&pieces) {
            return Err(format!("flight {number} has {pieces} pieces of luggage, expected 1 to {MOST}"));
        }
        let end = self.next.checked_add(pieces).ok_or("there are no more numbers for luggage")?;
        let numbers = std::mem::replace(&mut self.next, end)..end;
        self.pieces.extend(numbers.clone().map(|luggage| (luggage, number)));
        let state = FlightState { number, open: pieces, ..FlightState::default() };
        self.states.insert(number, state.clone());
        Ok((state, numbers.map(|luggage| EventLuggage::request(luggage, from, to)).collect()))
    }

    /// Handles a message about luggage; returns the new state of its flight, if that changed.
    pub(crate) fn hear(&mut self, event: &EventLuggage) -> Option<FlightState> {
        let is_loaded = match event.stage {
            LuggageStage::Delivered => true,
            LuggageStage::GivenUp => false,
            _ => return None,
        };
        let state = self.states.get_mut(&self.pieces.remove(&event.luggage)?)?;
        state.open -= 1;
        *if is_loaded { &mut state.loaded } else { &mut state.lost } += 1;
        Some(state.clone())
    }
}

#[cfg(test)]
mod tests {
    use saoms_components::grid::Block;

    use super::*;

    fn flight(number: u32, pieces: u32) -> Flight {
        Flight { number, pieces, from: Block::new(1, 1), to: Block::new(2, 2) }
    }

    #[test]
    fn each_piece_counts_once_and_for_its_own_flight() {
        let mut flights = Flights::new(100);
        let (state, requests) = flights.add(&flight(7, 2)).unwrap();
        assert_eq!((state.open, requests.len(), requests[1].luggage), (2, 2, 101));
        assert_eq!(flights.add(&flight(8, 1)).unwrap().1[0].luggage, 102);
        let said = |luggage, stage| EventLuggage { luggage, stage, ..EventLuggage::default() };
        assert_eq!(flights.hear(&said(100, LuggageStage::Taken)), None);
        let state = flights.hear(&said(100, LuggageStage::Delivered)).unwrap();
        assert_eq!(state, FlightState { number: 7, open: 1, loaded: 1, lost: 0 });
        assert_eq!(flights.hear(&said(100, LuggageStage::Delivered)), None, "twice");
        assert_eq!(flights.hear(&said(5, LuggageStage::Delivered)), None, "of no flight");
        let state = flights.hear(&said(101, LuggageStage::GivenUp)).unwrap();
        assert_eq!(state, FlightState { number: 7, open: 0, loaded: 1, lost: 1 });
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let mut flights = Flights::new(u32::MAX - 3);
        assert!(flights.add(&flight(7, 0)).unwrap_err().contains("expected 1 to 500"));
        assert!(flights.add(&flight(7, 3)).is_ok());
        assert!(flights.add(&flight(7, 1)).unwrap_err().contains("known already"));
        assert!(flights.add(&flight(8, 1)).unwrap_err().contains("no more numbers"));
    }
}
