use crate::grid::Map;
use crate::messages::EventLuggage;
use crate::state::Numbers;
use crate::validation::Problem;

/// Filter for events from the environment's topic, on which any component may publish.
#[derive(Debug, Default)]
pub(super) struct EventFilter {
    /// The area, once the world has published it.
    area: Option<Map>,
    /// Numbers of all luggage so far.
    known: Numbers,
    /// Numbers of luggage that others requested from the robots: a master that begins anew may have to take it on.
    heard: Numbers,
}

/// Refusal of luggage with its reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Refusal {
    pub(super) problem: Problem,
    /// True if the component that waits for the luggage has to learn that it is never brought.
    pub(super) is_lost: bool,
}

impl EventFilter {
    /// A filter that knows this luggage, and that others requested this.
    pub(super) fn of(known: Numbers, heard: Numbers) -> EventFilter {
        EventFilter { area: None, known, heard }
    }

    /// Numbers of all luggage so far.
    pub(super) fn known(&self) -> &Numbers {
        &self.known
    }

    /// Numbers of luggage that others requested from the robots.
    pub(super) fn heard(&self) -> &Numbers {
        &self.heard
    }

    /// The area, if it is known.
    pub(super) fn area(&self) -> Option<&Map> {
        self.area.as_ref()
    }

    pub(super) fn learn(&mut self, area: Option<Map>) {
        self.area = area;
    }

    /// Admits luggage, once.
    pub(super) fn luggage(&mut self, request: &EventLuggage) -> Result<(), Refusal> {
        if self.known.contains(request.luggage) {
            return Err(Refusal { problem: Problem::KnownLuggage, is_lost: false });
        }
        let lost = |problem| Refusal { problem, is_lost: true };
        Problem::of_request(request, self.area()).map_err(lost)?;
        self.known.insert(request.luggage);
        Ok(())
    }

    /// Records luggage that is for others to request.
    pub(super) fn note(&mut self, luggage: u32) {
        self.known.insert(luggage);
    }

    /// Records luggage that others requested from the robots.
    pub(super) fn hear(&mut self, luggage: u32) {
        self.heard.insert(luggage);
    }

    /// True if luggage with this number was requested.
    pub(super) fn knows(&self, luggage: u32) -> bool {
        self.known.contains(luggage) || self.heard.contains(luggage)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Block;

    fn refused(filter: &mut EventFilter, luggage: u32, from: (i32, i32), to: (i32, i32)) -> Option<Problem> {
        let request = EventLuggage::request(luggage, Block::new(from.0, from.1), Block::new(to.0, to.1));
        filter.luggage(&request).err().map(|refusal| refusal.problem)
    }

    #[test]
    fn only_luggage_that_robots_can_reach_is_let_in_once() {
        let mut filter = EventFilter::default();
        assert_eq!(refused(&mut filter, 1, (0, 0), (50, 50)), None, "nobody said yet how large the area is");
        filter.learn(Map::read("...\n..@").ok());
        assert_eq!(refused(&mut filter, 2, (0, 0), (1, 1)), None);
        let beyond = Problem::Outside { block: Block::new(3, 0), area: Some((3, 2)) };
        for (luggage, from, to, problem) in [
            (2, (0, 0), (1, 0), Problem::KnownLuggage),
            (3, (3, 0), (1, 0), beyond),
            (3, (0, 0), (2, 1), Problem::Blocked { block: Block::new(2, 1) }),
            (3, (1, 0), (1, 0), Problem::There { block: Block::new(1, 0) }),
        ] {
            assert_eq!(refused(&mut filter, luggage, from, to), Some(problem));
        }
        assert_eq!(refused(&mut filter, 3, (0, 0), (1, 1)), None, "a refused number is free");
        filter.hear(4);
        assert!(filter.knows(4));
        assert_eq!(refused(&mut filter, 4, (0, 0), (1, 1)), None, "who began anew takes on what others requested");
        assert_eq!(refused(&mut filter, 4, (0, 0), (1, 1)), Some(Problem::KnownLuggage));
    }

    #[test]
    fn a_response_is_no_request() {
        let response = EventLuggage { robot: 3, ..EventLuggage::request(1, Block::new(0, 0), Block::new(1, 0)) };
        assert!(EventFilter::default().luggage(&response).unwrap_err().is_lost);
        assert!(EventFilter::default().luggage(&EventLuggage::given_up(1, response.from, response.to)).is_err());
    }
}
