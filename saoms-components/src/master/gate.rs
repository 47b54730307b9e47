use std::collections::BTreeSet;

use crate::grid::{Block, Map};
use crate::messages::{EventLuggage, Fault, LuggageStage};

/// What is let in from the environment, where anybody may publish.
#[derive(Debug, Default)]
pub(super) struct Gate {
    /// The area, once the world has said it.
    area: Option<Map>,
    /// The numbers of all luggage so far.
    known: BTreeSet<u32>,
}

/// Why something is not let in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) reason: String,
    /// Whether whoever waits for the luggage has to be told that it is never brought.
    pub(super) is_lost: bool,
}

impl Gate {
    pub(super) fn learn(&mut self, area: Option<Map>) {
        self.area = area;
    }

    /// Lets luggage in, once.
    pub(super) fn luggage(&mut self, request: &EventLuggage) -> Result<(), Refusal> {
        let EventLuggage { luggage, from, to, robot, stage, .. } = *request;
        if self.known.contains(&luggage) {
            let reason = format!("luggage {luggage} is known already: each piece needs its own number");
            return Err(Refusal { reason, is_lost: false });
        }
        let lost = |reason| Err(Refusal { reason, is_lost: true });
        if stage != LuggageStage::Request || robot != 0 {
            return lost(format!("luggage {luggage} is no request: robots respond on another topic"));
        }
        if let Some(problem) = [from, to].into_iter().find_map(|block| self.problem(block)) {
            return lost(format!("luggage {luggage} from {from} to {to}: {problem}"));
        }
        self.known.insert(luggage);
        Ok(())
    }

    /// Lets a fault in.
    pub(super) fn fault(fault: &Fault) -> Result<(), Refusal> {
        match fault.robot {
            0 => Err(Refusal {
                reason: "a fault of no robot: their numbers start at 1".to_owned(),
                is_lost: false,
            }),
            _ => Ok(()),
        }
    }

    fn problem(&self, block: Block) -> Option<String> {
        match &self.area {
            None if block.x < 0 || block.y < 0 => {
                Some(format!("{block} is outside the area, which starts at (0,0)"))
            }
            None => None,
            Some(area) if !area.contains(block) => {
                let (x, y) = (area.width() - 1, area.height() - 1);
                Some(format!("{block} is outside the area from (0,0) to ({x},{y})"))
            }
            Some(area) => (!area.is_free(block)).then(|| format!("{block} is blocked")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(gate: &mut Gate, luggage: u32, from: (i32, i32), to: (i32, i32)) -> Option<String> {
        let request = EventLuggage::request(luggage, Block::new(from.0, from.1), Block::new(to.0, to.1));
        gate.luggage(&request).err().map(|refusal| refusal.reason)
    }

    #[test]
    fn only_luggage_that_robots_can_reach_is_let_in_once() {
        let mut gate = Gate::default();
        assert_eq!(refused(&mut gate, 1, (0, 0), (50, 50)), None, "nobody said yet how large the area is");
        gate.learn(Map::read("...\n..@").ok());
        assert_eq!(refused(&mut gate, 2, (0, 0), (1, 1)), None);
        for (luggage, from, to, reason) in [
            (2, (0, 0), (1, 0), "luggage 2 is known already: each piece needs its own number"),
            (
                3,
                (3, 0),
                (1, 0),
                "luggage 3 from (3,0) to (1,0): (3,0) is outside the area from (0,0) to (2,1)",
            ),
            (3, (0, 0), (2, 1), "luggage 3 from (0,0) to (2,1): (2,1) is blocked"),
        ] {
            assert_eq!(refused(&mut gate, luggage, from, to).as_deref(), Some(reason));
        }
        assert_eq!(refused(&mut gate, 3, (0, 0), (1, 1)), None, "a refused number is free");
        assert!(Gate::fault(&Fault::breakdown(0)).is_err() && Gate::fault(&Fault::breakdown(1)).is_ok());
    }

    #[test]
    fn a_response_is_no_request() {
        let response =
            EventLuggage { robot: 3, ..EventLuggage::request(1, Block::new(0, 0), Block::new(1, 0)) };
        assert!(Gate::default().luggage(&response).unwrap_err().is_lost);
        assert!(Gate::default().luggage(&EventLuggage::given_up(1, response.from, response.to)).is_err());
    }
}
