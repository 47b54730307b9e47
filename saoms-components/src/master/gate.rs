use std::collections::BTreeSet;

use crate::grid::Map;
use crate::intake::Problem;
use crate::messages::EventLuggage;

/// What is let in from the environment, where anybody may publish.
#[derive(Debug, Default)]
pub(super) struct Gate {
    /// The area, once the world has said it.
    area: Option<Map>,
    /// The numbers of all luggage so far.
    known: BTreeSet<u32>,
}

/// Why luggage is not let in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Refusal {
    pub(super) problem: Problem,
    /// Whether whoever waits for the luggage has to be told that it is never brought.
    pub(super) is_lost: bool,
}

impl Gate {
    /// The area, as far as it is known.
    pub(super) fn area(&self) -> Option<&Map> {
        self.area.as_ref()
    }

    pub(super) fn learn(&mut self, area: Option<Map>) {
        self.area = area;
    }

    /// Lets luggage in, once.
    pub(super) fn luggage(&mut self, request: &EventLuggage) -> Result<(), Refusal> {
        if self.known.contains(&request.luggage) {
            return Err(Refusal { problem: Problem::KnownLuggage, is_lost: false });
        }
        let lost = |problem| Refusal { problem, is_lost: true };
        Problem::of_request(request, self.area()).map_err(lost)?;
        self.known.insert(request.luggage);
        Ok(())
    }

    /// Takes in luggage for which somebody asked the robots themselves.
    pub(super) fn note(&mut self, luggage: u32) {
        self.known.insert(luggage);
    }

    /// Whether somebody asked for luggage of this number.
    pub(super) fn knows(&self, luggage: u32) -> bool {
        self.known.contains(&luggage)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Block;

    fn refused(gate: &mut Gate, luggage: u32, from: (i32, i32), to: (i32, i32)) -> Option<Problem> {
        let request = EventLuggage::request(luggage, Block::new(from.0, from.1), Block::new(to.0, to.1));
        gate.luggage(&request).err().map(|refusal| refusal.problem)
    }

    #[test]
    fn only_luggage_that_robots_can_reach_is_let_in_once() {
        let mut gate = Gate::default();
        assert_eq!(refused(&mut gate, 1, (0, 0), (50, 50)), None, "nobody said yet how large the area is");
        gate.learn(Map::read("...\n..@").ok());
        assert_eq!(refused(&mut gate, 2, (0, 0), (1, 1)), None);
        let beyond = Problem::Outside { block: Block::new(3, 0), area: Some((3, 2)) };
        for (luggage, from, to, problem) in [
            (2, (0, 0), (1, 0), Problem::KnownLuggage),
            (3, (3, 0), (1, 0), beyond),
            (3, (0, 0), (2, 1), Problem::Blocked { block: Block::new(2, 1) }),
            (3, (1, 0), (1, 0), Problem::There { block: Block::new(1, 0) }),
        ] {
            assert_eq!(refused(&mut gate, luggage, from, to), Some(problem));
        }
        assert_eq!(refused(&mut gate, 3, (0, 0), (1, 1)), None, "a refused number is free");
    }

    #[test]
    fn a_response_is_no_request() {
        let response =
            EventLuggage { robot: 3, ..EventLuggage::request(1, Block::new(0, 0), Block::new(1, 0)) };
        assert!(Gate::default().luggage(&response).unwrap_err().is_lost);
        assert!(Gate::default().luggage(&EventLuggage::given_up(1, response.from, response.to)).is_err());
    }
}
