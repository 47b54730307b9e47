use std::collections::BTreeSet;
use std::fmt;

use saoms_api::{Cause, Header, Time};

use crate::grid::Block;
use crate::messages::{EventLuggage, LuggageStage};
use crate::robot::Job;

/// Another robot that took an interest in the same luggage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rival {
    /// Its number.
    pub robot: u32,
    /// Where it was then.
    pub block: Block,
}

/// Luggage that waits for a robot.
#[derive(Clone, Debug)]
pub struct Request {
    /// What there is to bring.
    pub job: Job,
    /// When it was asked for.
    pub since: Time,
    /// Why.
    pub cause: Cause,
    /// The other robots that took an interest and did not take it back.
    pub rivals: Vec<Rival>,
    /// How many executions the battery has to last before this robot thinks about it again; 0 while it did not.
    pub needs: u32,
    /// Whether this robot found out, while it could take nothing, that the luggage is not out of its reach.
    pub judged: bool,
}

impl fmt::Display for Request {
    /// As the console of the manual's figures shows it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Luggage to bring from {} to {}", self.job.from, self.job.to)
    }
}

impl Request {
    fn hear(&mut self, event: &EventLuggage) {
        match event.stage {
            LuggageStage::Interest => {
                self.rivals.retain(|rival| rival.robot != event.robot);
                self.rivals.push(Rival { robot: event.robot, block: event.block });
            }
            LuggageStage::Release => self.rivals.retain(|rival| rival.robot != event.robot),
            LuggageStage::Request
            | LuggageStage::Taken
            | LuggageStage::Delivered
            | LuggageStage::Refused
            | LuggageStage::GivenUp => {}
        }
    }
}

/// The luggage that waits, oldest first.
#[derive(Debug)]
pub struct Requests {
    number: u32,
    open: Vec<Request>,
    /// The one that this robot took an interest in: no longer on the list.
    claimed: Option<Request>,
    /// Luggage that this robot leaves to others for good.
    refused: Vec<u32>,
    /// Luggage that other robots leave to others for good, and those robots.
    refusals: BTreeSet<(u32, u32)>,
}

impl Requests {
    /// None, for the robot of this number.
    pub fn new(number: u32) -> Requests {
        Requests { number, open: Vec::new(), claimed: None, refused: Vec::new(), refusals: BTreeSet::new() }
    }

    /// Takes in a request or a response; the own responses do not count.
    pub fn hear(&mut self, event: &EventLuggage, header: Header) {
        if event.stage == LuggageStage::Request {
            return self.hear_request(event, header);
        }
        if event.robot == self.number {
            return;
        }
        match event.stage {
            LuggageStage::Refused => _ = self.refusals.insert((event.luggage, event.robot)),
            LuggageStage::Delivered | LuggageStage::GivenUp => {
                self.refusals.retain(|(luggage, _)| *luggage != event.luggage);
            }
            _ => {}
        }
        let gone =
            matches!(event.stage, LuggageStage::Taken | LuggageStage::Delivered | LuggageStage::GivenUp);
        if let Some(claimed) = self.claimed.as_mut().filter(|claimed| claimed.job.luggage == event.luggage) {
            claimed.hear(event);
            if gone {
                self.claimed = None;
            }
        } else if let Some(place) = self.open.iter().position(|open| open.job.luggage == event.luggage) {
            self.open[place].hear(event);
            if gone {
                self.open.remove(place);
            }
        }
    }

    fn hear_request(&mut self, event: &EventLuggage, header: Header) {
        let mut known = self.open.iter().chain(&self.claimed);
        let refused = self.refused.contains(&event.luggage);
        if !refused && !known.any(|request| request.job.luggage == event.luggage) {
            let job = Job { luggage: event.luggage, from: event.from, to: event.to };
            self.open.push(Request {
                job,
                since: header.sent,
                cause: header.cause,
                rivals: Vec::new(),
                needs: 0,
                judged: false,
            });
        }
    }

    /// Drops the interest of a robot that is not active any more.
    pub fn forget(&mut self, robot: u32) {
        for request in self.open.iter_mut().chain(&mut self.claimed) {
            request.rivals.retain(|rival| rival.robot != robot);
        }
    }

    /// Takes what others took an interest in off the list.
    pub fn drop_contested(&mut self) {
        self.open.retain(|request| request.rivals.is_empty());
    }

    /// Those on the list, oldest first.
    pub fn open(&self) -> &[Request] {
        &self.open
    }

    /// Those on the list, to note something about them.
    pub fn open_mut(&mut self) -> &mut [Request] {
        &mut self.open
    }

    /// The one that this robot took an interest in, unless another robot took it.
    pub fn claimed(&self) -> Option<&Request> {
        self.claimed.as_ref()
    }

    /// Takes an interest in the one at this place of the list.
    pub fn claim(&mut self, place: usize) -> Option<&Request> {
        if place < self.open.len() && self.claimed.is_none() {
            self.claimed = Some(self.open.remove(place));
        }
        self.claimed.as_ref()
    }

    /// Ends the interest: the robot brings it, or another one does.
    pub fn settle(&mut self) -> Option<Request> {
        self.claimed.take()
    }

    /// Ends the interest and puts the request back where it was on the list.
    pub fn put_back(&mut self) {
        if let Some(request) = self.claimed.take() {
            let place = self.open.partition_point(|open| open.since <= request.since);
            self.open.insert(place, request);
        }
    }

    /// Whether another robot leaves luggage to others for good.
    pub fn is_refused_by(&self, luggage: u32, robot: u32) -> bool {
        self.refusals.contains(&(luggage, robot))
    }

    /// What was found out about requests while this robot could take none does not hold any more.
    pub fn judge_again(&mut self) {
        self.open.iter_mut().for_each(|request| request.judged = false);
    }

    /// Leaves luggage to others for good.
    pub fn refuse(&mut self, luggage: u32) {
        self.open.retain(|open| open.job.luggage != luggage);
        self.refused.push(luggage);
    }
}
