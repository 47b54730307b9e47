//! Luggage that waits, for a robot that goes on after a failure.

use std::collections::BTreeMap;

use saoms_api::{Field, Time};

use super::{Assigned, Refused, Request, Requests};
use crate::messages::Visit;
use crate::state::Numbers;

/// The list, for a robot that goes on.
#[derive(Clone, Debug, Field)]
pub(in crate::robot) struct RequestsMemory {
    open: Vec<Request>,
    claimed: Option<Request>,
    refused: Vec<Refused>,
    refusals: Vec<Refusal>,
    visits: Vec<Visit>,
    settled: Numbers,
    delivered: Numbers,
    assigned: Vec<Assigned>,
    requested: Vec<Timed>,
    said: Vec<Said>,
    ordered: Vec<Timed>,
    done: Numbers,
    of_elsewhere: Vec<u32>,
}

#[derive(Clone, Copy, Debug, Field)]
struct Timed {
    luggage: u32,
    at: Time,
}

#[derive(Clone, Copy, Debug, Field)]
struct Said {
    luggage: u32,
    robot: u32,
    at: Time,
}

#[derive(Clone, Copy, Debug, Field)]
struct Refusal {
    luggage: u32,
    robot: u32,
}

impl Requests {
    pub(in crate::robot::lists) fn memory(&self) -> RequestsMemory {
        let timed = |times: &BTreeMap<u32, Time>| times.iter().map(|(&luggage, &at)| Timed { luggage, at }).collect();
        RequestsMemory {
            open: self.open.clone(),
            claimed: self.claimed.clone(),
            refused: self.refused.clone(),
            refusals: self.refusals.iter().map(|&(luggage, robot)| Refusal { luggage, robot }).collect(),
            visits: self.visits.values().cloned().collect(),
            settled: self.settled.clone(),
            delivered: self.delivered.clone(),
            assigned: self.assigned.clone(),
            requested: timed(&self.requested),
            said: self.said.iter().map(|(&(luggage, robot), &at)| Said { luggage, robot, at }).collect(),
            ordered: timed(&self.ordered),
            done: self.done.clone(),
            of_elsewhere: self.of_elsewhere.iter().copied().collect(),
        }
    }

    pub(in crate::robot::lists) fn restore(&mut self, memory: RequestsMemory) {
        (self.open, self.claimed, self.refused) = (memory.open, memory.claimed, memory.refused);
        self.refusals = memory.refusals.iter().map(|refusal| (refusal.luggage, refusal.robot)).collect();
        self.visits = memory.visits.into_iter().map(|visit| (visit.visit, visit)).collect();
        (self.settled, self.delivered, self.assigned) = (memory.settled, memory.delivered, memory.assigned);
        let times = |timed: &[Timed]| timed.iter().map(|timed| (timed.luggage, timed.at)).collect();
        (self.requested, self.ordered) = (times(&memory.requested), times(&memory.ordered));
        self.said = memory.said.iter().map(|said| ((said.luggage, said.robot), said.at)).collect();
        self.done = memory.done;
        self.of_elsewhere = memory.of_elsewhere.into_iter().collect();
        self.silent_at = self.rivals().filter_map(|rival| rival.until).min();
    }
}
