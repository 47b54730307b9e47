mod memory;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use saoms_api::{Cause, Field, Header, Time};

use crate::grid::Block;
use crate::messages::{Assignment, EventLuggage, Lease, LuggageStage, Visit, is_visit};
use crate::robot::Job;
use crate::state::Numbers;

pub(in crate::robot) use memory::RequestsMemory;

/// Another robot that took an interest in the same luggage, or offered the same help.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub struct Rival {
    /// Number of the robot.
    pub robot: u32,
    /// Its position at that time.
    pub block: Block,
    /// Of a robot of another program, the time after which its interest does not count, unless it takes the luggage.
    pub until: Option<Time>,
}

/// What the battery has to last for a request to which no way leads for now.
pub(in crate::robot) const WAY_CLOSED: u32 = u32::MAX;

/// Luggage that waits for a robot.
#[derive(Clone, Debug, Field)]
pub struct Request {
    /// The job.
    pub job: Job,
    /// Time of the request.
    pub since: Time,
    /// Cause of the request.
    pub cause: Cause,
    /// Other robots that took an interest and did not take it back.
    pub rivals: Vec<Rival>,
    /// Number of executions that the battery has to last before this robot considers the request again; 0 if it did not
    /// consider it yet, and the greatest number until the ways change.
    pub needs: u32,
    /// True if this robot found out, while it could take no job, that the luggage is within its reach.
    pub judged: bool,
    /// Blocks to visit, in place of bringing luggage; none while a visit is not known yet.
    pub stops: Vec<Block>,
    /// True if only this robot may visit them.
    pub reserved: bool,
}

impl Request {
    /// True if all is known that a robot has to know to do it.
    pub fn is_known(&self) -> bool {
        !is_visit(self.job.luggage) || !self.stops.is_empty()
    }

    fn learn(&mut self, visit: &Visit) {
        self.stops.clone_from(&visit.stops);
        self.reserved = visit.robot != 0;
    }
}

impl fmt::Display for Request {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Luggage to bring from {} to {}", self.job.from, self.job.to)
    }
}

impl Request {
    fn hear(&mut self, event: &EventLuggage, until: Option<Time>) {
        match event.stage {
            LuggageStage::Interest => {
                self.rivals.retain(|rival| rival.robot != event.robot);
                self.rivals.push(Rival { robot: event.robot, block: event.block, until });
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

/// Luggage that waits, oldest first.
#[derive(Debug)]
pub struct Requests {
    number: u32,
    open: Vec<Request>,
    /// The request that this robot took an interest in; it is not on the list.
    claimed: Option<Request>,
    /// Luggage that this robot leaves to other robots for good, as long as it is where it was.
    refused: Vec<Refused>,
    /// Luggage that other robots refused, with the robot.
    refusals: BTreeSet<(u32, u32)>,
    /// Visits that are not done, without those of other robots alone.
    visits: BTreeMap<u32, Visit>,
    /// Luggage that a robot took, brought or gave up: a request that only repeats an earlier one does not count.
    settled: Numbers,
    /// Luggage that was delivered: a robot that came too late for it may request it again.
    delivered: Numbers,
    /// Luggage that a master assigned to this robot, or took back, which the robot has not answered yet.
    assigned: Vec<Assigned>,
    /// When robots said last whether they are interested in luggage that is not delivered, by luggage and robot:
    /// messages may overtake each other.
    said: BTreeMap<(u32, u32), Time>,
    /// When a master said last whether luggage is for this robot.
    ordered: BTreeMap<u32, Time>,
    /// Visits that this robot has done.
    done: Numbers,
    /// When luggage was requested last that nobody took since. That somebody took it before may be heard later.
    requested: BTreeMap<u32, Time>,
    /// Luggage that is not settled and was announced from another program.
    of_elsewhere: BTreeSet<u32>,
    /// When the interest of a robot of another program does not count any more, the first of them.
    silent_at: Option<Time>,
}

/// Greatest number of assignments that wait for an answer: a robot without a loop that answers keeps the newest.
const MOST_ASSIGNED: usize = 8;

/// Luggage that a master assigned to the robot, or took back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub struct Assigned {
    /// The job.
    pub job: Job,
    /// True if it is for another robot now.
    pub withdrawn: bool,
    /// Number of the component of the master.
    pub master: u32,
    /// Cause of the assignment.
    pub cause: Cause,
}

/// Luggage that this robot refused, and where it was; none where that is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
struct Refused {
    luggage: u32,
    from: Option<Block>,
}

impl Requests {
    /// An empty list, for the robot with this number.
    pub fn new(number: u32) -> Requests {
        Requests {
            number,
            open: Vec::new(),
            claimed: None,
            refused: Vec::new(),
            refusals: BTreeSet::new(),
            visits: BTreeMap::new(),
            settled: Numbers::default(),
            delivered: Numbers::default(),
            assigned: Vec::new(),
            said: BTreeMap::new(),
            ordered: BTreeMap::new(),
            done: Numbers::default(),
            requested: BTreeMap::new(),
            of_elsewhere: BTreeSet::new(),
            silent_at: None,
        }
    }

    /// Handles which blocks a visit has.
    pub fn hear_visit(&mut self, visit: &Visit) {
        if visit.robot != 0 && visit.robot != self.number {
            return;
        }
        for request in self.open.iter_mut().chain(&mut self.claimed) {
            if request.job.luggage == visit.visit {
                request.learn(visit);
            }
        }
        // Who took it may give it back.
        if !self.delivered.contains(visit.visit) {
            self.visits.insert(visit.visit, visit.clone());
        }
    }

    /// Handles what a master assigned to this robot, in this program or in another one.
    pub fn hear_assignment(&mut self, assignment: &Assignment, header: Header) {
        let Assignment { luggage, from, to, withdrawn, .. } = *assignment;
        if header.is_from_elsewhere() && !withdrawn {
            self.of_elsewhere.insert(luggage);
        }
        let ordered = self.ordered.entry(luggage).or_default();
        if header.sent < *ordered {
            return;
        }
        *ordered = header.sent;
        self.assigned.retain(|known| known.job.luggage != luggage);
        if self.assigned.len() >= MOST_ASSIGNED {
            self.assigned.remove(0);
        }
        self.assigned.push(Assigned {
            job: Job { luggage, from, to },
            withdrawn,
            master: header.sender,
            cause: header.cause,
        });
    }

    /// True if luggage was announced from another program.
    pub(in crate::robot) fn is_of_elsewhere(&self, luggage: u32) -> bool {
        self.of_elsewhere.contains(&luggage)
    }

    /// The oldest assignment that the robot has not answered, without visits whose blocks it has not heard of yet.
    pub fn assigned(&self) -> Option<&Assigned> {
        self.assigned.iter().find(|assigned| self.knows(assigned))
    }

    /// Ends the oldest assignment: the robot has answered it.
    pub fn answer_assignment(&mut self) -> Option<Assigned> {
        let place = self.assigned.iter().position(|assigned| self.knows(assigned))?;
        Some(self.assigned.remove(place))
    }

    fn knows(&self, assigned: &Assigned) -> bool {
        let luggage = assigned.job.luggage;
        assigned.withdrawn || !is_visit(luggage) || self.visits.contains_key(&luggage) || self.done.contains(luggage)
    }

    /// True if this robot has done the visit.
    pub(in crate::robot) fn has_done(&self, visit: u32) -> bool {
        self.done.contains(visit)
    }

    /// True if a robot has brought the luggage, or done the visit.
    pub(in crate::robot) fn is_delivered(&self, luggage: u32) -> bool {
        self.delivered.contains(luggage)
    }

    /// True if this robot refused the luggage.
    pub(in crate::robot) fn has_refused(&self, luggage: u32) -> bool {
        self.refused.iter().any(|refused| refused.luggage == luggage)
    }

    /// Takes luggage off the list: this robot brings it.
    pub fn take(&mut self, luggage: u32) {
        self.settled.insert(luggage);
        self.open.retain(|open| open.job.luggage != luggage);
        self.claimed.take_if(|claimed| claimed.job.luggage == luggage);
    }

    /// Handles a request or a response. Of the robot's own responses those count that end its interest for good:
    /// whichever loop sent them, the luggage does not wait for this robot any more.
    pub fn hear(&mut self, event: &EventLuggage, header: Header) {
        if event.stage == LuggageStage::Request {
            return self.hear_request(event, header);
        }
        let gone = match event.stage {
            // Whoever took it before has given it back.
            LuggageStage::Taken => self.requested.get(&event.luggage).is_none_or(|at| *at <= header.sent),
            stage => matches!(stage, LuggageStage::Delivered | LuggageStage::GivenUp),
        };
        if gone {
            self.settled.insert(event.luggage);
            self.requested.remove(&event.luggage);
        }
        if matches!(event.stage, LuggageStage::Delivered | LuggageStage::GivenUp) {
            self.visits.remove(&event.luggage);
            self.of_elsewhere.remove(&event.luggage);
            self.ordered.remove(&event.luggage);
        }
        if event.stage == LuggageStage::Delivered {
            self.delivered.insert(event.luggage);
        }
        if event.robot == self.number {
            return self.hear_own(event);
        }
        if self.is_outdated(event, header.sent) {
            return;
        }
        match event.stage {
            LuggageStage::Refused => _ = self.refusals.insert((event.luggage, event.robot)),
            LuggageStage::Delivered | LuggageStage::GivenUp => {
                let of_luggage = (event.luggage, 0)..=(event.luggage, u32::MAX);
                for refusal in self.refusals.range(of_luggage).copied().collect::<Vec<_>>() {
                    self.refusals.remove(&refusal);
                }
            }
            _ => {}
        }
        let until = header.is_from_elsewhere().then(|| header.sent + Lease::duration(0));
        self.silent_at = self.silent_at.into_iter().chain(until).min();
        if let Some(claimed) = self.claimed.as_mut().filter(|claimed| claimed.job.luggage == event.luggage) {
            claimed.hear(event, until);
            if gone {
                self.claimed = None;
            }
        } else if let Some(place) = self.open.iter().position(|open| open.job.luggage == event.luggage) {
            self.open[place].hear(event, until);
            if gone {
                self.open.remove(place);
            }
        }
    }

    /// True if a robot said since whether it is interested.
    fn is_outdated(&mut self, event: &EventLuggage, sent: Time) -> bool {
        let EventLuggage { luggage, robot, stage, .. } = *event;
        match stage {
            LuggageStage::Interest | LuggageStage::Release | LuggageStage::Taken | LuggageStage::Refused => {
                if self.delivered.contains(luggage) {
                    return false;
                }
                let said = self.said.entry((luggage, robot)).or_default();
                let is_outdated = sent < *said;
                *said = sent.max(*said);
                is_outdated && matches!(stage, LuggageStage::Interest | LuggageStage::Release)
            }
            LuggageStage::Delivered | LuggageStage::GivenUp => {
                let of_luggage = self.said.range((luggage, 0)..=(luggage, u32::MAX)).map(|(key, _)| *key);
                for key in of_luggage.collect::<Vec<_>>() {
                    self.said.remove(&key);
                }
                false
            }
            LuggageStage::Request => false,
        }
    }

    fn hear_own(&mut self, event: &EventLuggage) {
        if event.stage == LuggageStage::Delivered && is_visit(event.luggage) {
            self.done.insert(event.luggage);
        }
        match event.stage {
            // A robot also refuses the job of a broken robot, which may wait as luggage later.
            LuggageStage::Refused if self.open.iter().any(|open| open.job.luggage == event.luggage) => {
                self.refuse(event.luggage, Some(event.from));
            }
            LuggageStage::Taken | LuggageStage::Delivered | LuggageStage::GivenUp => {
                self.open.retain(|open| open.job.luggage != event.luggage);
            }
            LuggageStage::Request | LuggageStage::Interest | LuggageStage::Release | LuggageStage::Refused => {}
        }
    }

    fn hear_request(&mut self, event: &EventLuggage, header: Header) {
        let is_again = event.robot != 0;
        let is_over = self.delivered.contains(event.luggage) || is_again && self.settled.contains(event.luggage);
        if !event.is_request_for(self.number) || is_over {
            return;
        }
        if header.is_from_elsewhere() {
            self.of_elsewhere.insert(event.luggage);
        }
        if !is_again {
            // From where it is now, it may be in reach.
            let is_elsewhere = |refused: &Refused| refused.from.is_some_and(|from| from != event.from);
            self.refused.retain(|refused| refused.luggage != event.luggage || !is_elsewhere(refused));
        }
        if !is_again {
            let requested = self.requested.entry(event.luggage).or_insert(header.sent);
            *requested = header.sent.max(*requested);
        }
        let mut known = self.open.iter().chain(&self.claimed);
        let refused = self.refused.iter().any(|refused| refused.luggage == event.luggage);
        if !refused && !known.any(|request| request.job.luggage == event.luggage) {
            let job = Job { luggage: event.luggage, from: event.from, to: event.to };
            let mut request = Request {
                job,
                since: header.sent,
                cause: header.cause,
                rivals: Vec::new(),
                needs: 0,
                judged: false,
                stops: Vec::new(),
                reserved: false,
            };
            if let Some(visit) = self.visits.get(&event.luggage) {
                request.learn(visit);
            }
            self.open.push(request);
        }
    }

    fn rivals(&self) -> impl Iterator<Item = &Rival> {
        self.open.iter().chain(&self.claimed).flat_map(|request| &request.rivals)
    }

    /// Drops the interest of robots of other programs that said nothing more for the time of a lease: nothing may be
    /// heard of them. Who takes the luggage has it on a lease, and nobody collects it twice.
    pub(in crate::robot) fn forget_silent(&mut self, now: Time) {
        if self.silent_at.is_some_and(|at| at <= now) {
            for request in self.open.iter_mut().chain(&mut self.claimed) {
                request.rivals.retain(|rival| rival.until.is_none_or(|until| until > now));
            }
            self.silent_at = self.rivals().filter_map(|rival| rival.until).min();
        }
    }

    /// Drops the interest of a robot that is not active any more.
    pub fn forget(&mut self, robot: u32) {
        for request in self.open.iter_mut().chain(&mut self.claimed) {
            request.rivals.retain(|rival| rival.robot != robot);
        }
    }

    /// Keeps the open requests of a part of the map, for a robot that hears no more of the others.
    pub(in crate::robot) fn keep(&mut self, is_near: impl Fn(Block) -> bool) {
        self.open.retain(|request| is_near(request.job.from));
        let Requests { open, claimed, requested, said, assigned, of_elsewhere, .. } = self;
        let is_open = |luggage: u32| open.iter().chain(&*claimed).any(|request| request.job.luggage == luggage);
        requested.retain(|luggage, _| is_open(*luggage));
        said.retain(|(luggage, _), _| is_open(*luggage));
        of_elsewhere.retain(|luggage| is_open(*luggage) || assigned.iter().any(|one| one.job.luggage == *luggage));
    }

    /// Removes requests that other robots took an interest in.
    pub fn drop_contested(&mut self) {
        self.open.retain(|request| request.rivals.is_empty());
    }

    /// Requests on the list, oldest first.
    pub fn open(&self) -> &[Request] {
        &self.open
    }

    /// Blocks of a visit; none if it is luggage, or not known.
    pub fn stops(&self, luggage: u32) -> &[Block] {
        self.visits.get(&luggage).map_or(&[], |visit| &visit.stops)
    }

    /// Requests on the list, mutable.
    pub fn open_mut(&mut self) -> &mut [Request] {
        &mut self.open
    }

    /// The request that this robot took an interest in, unless another robot took it.
    pub fn claimed(&self) -> Option<&Request> {
        self.claimed.as_ref()
    }

    /// Takes an interest in the request at this index.
    pub fn claim(&mut self, place: usize) -> Option<&Request> {
        if place < self.open.len() && self.claimed.is_none() {
            self.claimed = Some(self.open.remove(place));
        }
        self.claimed.as_ref()
    }

    /// Ends the interest: this robot brings the luggage, or another one does.
    pub fn settle(&mut self) -> Option<Request> {
        self.claimed.take()
    }

    /// Ends the interest and returns the request to its place on the list.
    pub fn put_back(&mut self) {
        if let Some(request) = self.claimed.take() {
            let place = self.open.partition_point(|open| open.since <= request.since);
            self.open.insert(place, request);
        }
    }

    /// True if another robot refused the luggage for good.
    pub fn is_refused_by(&self, luggage: u32, robot: u32) -> bool {
        self.refusals.contains(&(luggage, robot))
    }

    /// Forgets the results that were found out about requests while this robot could take no job, and that no way led
    /// to them.
    pub fn judge_again(&mut self) {
        for request in &mut self.open {
            request.judged = false;
            if request.needs == WAY_CLOSED {
                request.needs = 0;
            }
        }
    }

    /// Considers all requests again, also those for which the battery did not last.
    pub fn consider_again(&mut self) {
        self.open.iter_mut().for_each(|request| request.needs = 0);
    }

    /// Refuses luggage for good, or until it is requested from another block than this one.
    pub fn refuse(&mut self, luggage: u32, from: Option<Block>) {
        self.open.retain(|open| open.job.luggage != luggage);
        self.refused.retain(|refused| refused.luggage != luggage);
        self.refused.push(Refused { luggage, from });
    }
}
