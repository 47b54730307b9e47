use std::fmt;

use saoms_api::{Cause, Field, Header, Time};

use crate::messages::{CriticalKind, CriticalSituation, CriticalStage, RobotList};

use super::Rival;

/// A robot that waits for a healer.
#[derive(Clone, Debug, Field)]
pub struct Help {
    /// The request.
    pub situation: CriticalSituation,
    /// Time of the request.
    pub since: Time,
    /// Cause of the request.
    pub cause: Cause,
    /// Other robots that offered to heal it and did not take that back.
    pub rivals: Vec<Rival>,
    /// Number of executions that the battery has to last before this robot considers the request again; 0 if it did not
    /// consider it yet.
    pub needs: u32,
}

impl fmt::Display for Help {
    /// Format of the console in the manual's figures.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "New help request from Robot{}", self.situation.critical)
    }
}

/// Robots that wait for a healer, in the order of their requests.
#[derive(Debug)]
pub struct Helps {
    number: u32,
    open: Vec<Help>,
    /// The request that this robot offered to answer; it is not on the list.
    claimed: Option<Help>,
    /// Requests that are answered; a request may arrive later than its answer.
    settled: Vec<Settled>,
}

/// An answered request, the newest of its robot.
#[derive(Clone, Copy, Debug, Field)]
struct Settled {
    critical: u32,
    /// The luggage of its job, if it had one.
    luggage: Option<u32>,
    /// True if a robot only substitutes the broken one, which leaves its job open.
    stands_in: bool,
    /// Time of the answer.
    time: Time,
}

impl Settled {
    fn settles(&self, situation: &CriticalSituation) -> bool {
        let luggage = luggage_of(situation);
        let covered = if self.stands_in { luggage.is_none() } else { luggage.is_none() || luggage == self.luggage };
        self.critical == situation.critical && covered
    }
}

/// The list, for a robot that goes on.
#[derive(Clone, Debug, Field)]
pub(in crate::robot) struct HelpsMemory {
    open: Vec<Help>,
    claimed: Option<Help>,
    settled: Vec<Settled>,
}

impl Helps {
    pub(super) fn memory(&self) -> HelpsMemory {
        HelpsMemory { open: self.open.clone(), claimed: self.claimed.clone(), settled: self.settled.clone() }
    }

    pub(super) fn restore(&mut self, memory: HelpsMemory) {
        (self.open, self.claimed, self.settled) = (memory.open, memory.claimed, memory.settled);
    }

    /// An empty list, for the robot with this number.
    pub fn new(number: u32) -> Helps {
        Helps { number, open: Vec::new(), claimed: None, settled: Vec::new() }
    }

    /// Handles a request, including the robot's own, or a response of another robot.
    pub fn hear(&mut self, message: &CriticalSituation, header: Header) {
        let critical = message.critical;
        if message.stage == CriticalStage::Request {
            return self.hear_request(message, header);
        }
        if message.healer == self.number {
            return;
        }
        let respond = |help: &mut Help| match message.stage {
            CriticalStage::Intention => {
                help.rivals.retain(|rival| rival.robot != message.healer);
                help.rivals.push(Rival { robot: message.healer, block: message.healer_block, until: None });
            }
            CriticalStage::Release => help.rivals.retain(|rival| rival.robot != message.healer),
            CriticalStage::Request | CriticalStage::Taken | CriticalStage::StandsIn => {}
        };
        self.open.iter_mut().chain(&mut self.claimed).filter(|help| help.is_for(message)).for_each(respond);
        let stands_in = message.stage == CriticalStage::StandsIn;
        if stands_in || message.stage == CriticalStage::Taken {
            let settled = Settled { critical, luggage: luggage_of(message), stands_in, time: header.sent };
            self.settled.retain(|old| (old.critical, old.stands_in) != (critical, stands_in));
            self.settled.push(settled);
            self.open.retain(|help| !settled.settles(&help.situation));
            self.claimed.take_if(|claimed| settled.settles(&claimed.situation));
        }
    }

    /// Handles a request. A robot that asks again about the same luggage, or after a request without a job, has another
    /// reason: the earlier request does not count any more. A job that it left before stays open: a robot can break or
    /// end, be scheduled again, and leave its next job.
    ///
    /// A request that only repeats an earlier one, for a robot that started later, changes nothing for who knows it.
    fn hear_request(&mut self, message: &CriticalSituation, header: Header) {
        let is_again = message.is_again();
        let is_known = || self.open.iter().chain(&self.claimed).any(|known| known.is_for(message));
        if is_again && (message.healer != self.number || is_known()) {
            return;
        }
        if self.settled.iter().any(|settled| settled.settles(message) && (is_again || settled.time > header.sent)) {
            return;
        }
        let help =
            Help { situation: message.clone(), since: header.sent, cause: header.cause, rivals: Vec::new(), needs: 0 };
        if let Some(claimed) = self.claimed.as_mut().filter(|claimed| claimed.is_replaced_by(message)) {
            claimed.situation = help.situation;
        } else if let Some(known) = self.open.iter_mut().find(|known| known.is_replaced_by(message)) {
            *known = help;
        } else {
            self.open.push(help);
        }
    }

    /// Handles the state of a robot. A robot that works again needs no substitute; a robot that ended heals no other.
    pub fn hear_robot(&mut self, robot: &RobotList) {
        if robot.active && !robot.in_charge {
            self.open.retain(|help| !help.is_of(robot.robot) || help.situation.kind != CriticalKind::Idle);
        } else if !robot.active {
            for help in self.open.iter_mut().chain(&mut self.claimed) {
                help.rivals.retain(|rival| rival.robot != robot.robot);
            }
        }
    }

    /// Removes requests that other robots offered to answer.
    pub fn drop_contested(&mut self) {
        self.open.retain(|help| help.rivals.is_empty());
    }

    /// Requests on the list, oldest first.
    pub fn open(&self) -> &[Help] {
        &self.open
    }

    /// The request that this robot offered to answer, unless another robot answers it.
    pub fn claimed(&self) -> Option<&Help> {
        self.claimed.as_ref()
    }

    /// Offers to answer a request, if it is open.
    pub fn claim(&mut self, request: &CriticalSituation) -> Option<&Help> {
        if self.claimed.is_none() {
            let place = self.open.iter().position(|help| help.is_for(request))?;
            self.claimed = Some(self.open.remove(place));
        }
        self.claimed.as_ref()
    }

    /// Ends the offer: this robot heals the other one, or another robot does.
    pub fn settle(&mut self) -> Option<Help> {
        self.claimed.take()
    }

    /// Takes the offer back: the request returns to its place on the list.
    pub fn put_back(&mut self) {
        if let Some(help) = self.claimed.take() {
            let place = self.open.partition_point(|open| open.since <= help.since);
            self.open.insert(place, help);
        }
    }

    /// The oldest request of a robot, unless this robot offered to answer it.
    pub fn get(&self, critical: u32) -> Option<&Help> {
        self.open.iter().find(|help| help.is_of(critical))
    }

    /// Defers a request until the battery lasts for `needs` executions.
    pub fn postpone(&mut self, request: &CriticalSituation, needs: u32) {
        if let Some(help) = self.open.iter_mut().find(|help| help.is_for(request)) {
            help.needs = needs;
        }
    }

    /// Considers again the requests to which no way led.
    pub(in crate::robot) fn judge_again(&mut self) {
        self.open.iter_mut().filter(|help| help.needs == super::WAY_CLOSED).for_each(|help| help.needs = 0);
    }

    /// Leaves a request to other robots for good.
    pub fn refuse(&mut self, request: &CriticalSituation) {
        self.open.retain(|help| !help.is_for(request));
    }
}

impl Help {
    pub(in crate::robot) fn is_of(&self, critical: u32) -> bool {
        self.situation.critical == critical
    }

    /// True if this is the request that a message makes or answers: of that robot, about that luggage.
    fn is_for(&self, message: &CriticalSituation) -> bool {
        self.is_of(message.critical) && luggage_of(&self.situation) == luggage_of(message)
    }

    /// True if a new request of the same robot takes the place of this one.
    fn is_replaced_by(&self, request: &CriticalSituation) -> bool {
        self.is_for(request) || self.is_of(request.critical) && self.situation.kind == CriticalKind::Idle
    }
}

/// The luggage of the job that a situation leaves open.
fn luggage_of(situation: &CriticalSituation) -> Option<u32> {
    situation.job().map(|job| job.luggage)
}

#[cfg(test)]
mod tests {
    use saoms_api::Cause;

    use super::*;

    fn header(sent: u64) -> Header {
        Header { sender: 9, sent: Time::from_nanos(sent), cause: Cause::default() }
    }

    fn request(kind: CriticalKind) -> CriticalSituation {
        CriticalSituation { critical: 2, kind, luggage: 7, ..CriticalSituation::default() }
    }

    /// A response as robots send it: about the job, unless the healer only stands in.
    fn response(kind: CriticalKind, stage: CriticalStage) -> CriticalSituation {
        let kind = if stage == CriticalStage::StandsIn { CriticalKind::Idle } else { kind };
        CriticalSituation { stage, healer: 3, ..request(kind) }
    }

    #[test]
    fn who_stands_in_for_a_robot_leaves_its_job_open() {
        for (kind, stage, open) in [
            (CriticalKind::OnTheWay, CriticalStage::StandsIn, 1),
            (CriticalKind::OnTheWay, CriticalStage::Taken, 0),
            (CriticalKind::Idle, CriticalStage::StandsIn, 0),
            (CriticalKind::Idle, CriticalStage::Taken, 0),
        ] {
            let mut helps = Helps::new(1);
            helps.hear(&request(kind), header(1));
            helps.hear(&response(kind, stage), header(2));
            assert_eq!(helps.open().len(), open, "{kind:?}, {stage:?}");
            let mut late = Helps::new(1);
            late.hear(&response(kind, stage), header(2));
            late.hear(&request(kind), header(1));
            assert_eq!(late.open().len(), open, "{kind:?}, {stage:?}: the request arrives later");
        }
    }

    #[test]
    fn each_job_that_a_robot_left_stays_open_until_it_is_taken() {
        let job = |luggage| CriticalSituation { luggage, ..request(CriticalKind::CarriesLuggage) };
        let open =
            |helps: &Helps| helps.open().iter().filter_map(|help| luggage_of(&help.situation)).collect::<Vec<_>>();
        let mut helps = Helps::new(1);
        helps.hear(&job(7), header(1));
        helps.hear(&job(8), header(2));
        helps.hear(&request(CriticalKind::Idle), header(3));
        assert_eq!(open(&helps), [7, 8]);
        helps.hear(&CriticalSituation { luggage: 8, stage: CriticalStage::Taken, healer: 3, ..job(8) }, header(4));
        assert_eq!(open(&helps), [7]);
        helps.hear(&job(7), header(5));
        assert_eq!(open(&helps), [7], "asks again");
        helps.claim(&job(7));
        helps.hear(&job(9), header(6));
        assert_eq!((helps.claimed().and_then(|help| luggage_of(&help.situation)), open(&helps)), (Some(7), vec![9]));
    }

    #[test]
    fn a_request_that_is_repeated_for_a_robot_is_for_that_one_and_opens_nothing_again() {
        let again = |robot| request(CriticalKind::OnTheWay).again_for(robot);
        let mut helps = Helps::new(1);
        helps.hear(&again(3), header(1));
        assert_eq!(helps.open().len(), 0);
        helps.hear(&again(1), header(2));
        assert_eq!(helps.open().len(), 1);
        helps.hear(&response(CriticalKind::OnTheWay, CriticalStage::Taken), header(3));
        helps.hear(&again(1), header(4));
        assert_eq!(helps.open().len(), 0);
    }

    #[test]
    fn a_request_with_a_job_takes_the_place_of_one_without() {
        let mut helps = Helps::new(1);
        helps.hear(&request(CriticalKind::Idle), header(1));
        helps.hear(&request(CriticalKind::OnTheWay), header(2));
        assert_eq!(helps.open().len(), 1);
        assert_eq!(helps.open()[0].situation.kind, CriticalKind::OnTheWay);
    }
}
