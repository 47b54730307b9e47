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

/// An answered request.
#[derive(Clone, Copy, Debug, Field)]
struct Settled {
    critical: u32,
    /// True if a robot only substitutes the broken one, which leaves its job open.
    stands_in: bool,
    /// Time of the answer.
    time: Time,
}

impl Settled {
    fn settles(&self, situation: &CriticalSituation) -> bool {
        let covered = !self.stands_in || situation.kind == CriticalKind::Idle;
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
                help.rivals.push(Rival { robot: message.healer, block: message.healer_block });
            }
            CriticalStage::Release => help.rivals.retain(|rival| rival.robot != message.healer),
            CriticalStage::Request | CriticalStage::Taken | CriticalStage::StandsIn => {}
        };
        self.open.iter_mut().chain(&mut self.claimed).filter(|help| help.is_of(critical)).for_each(respond);
        let stands_in = message.stage == CriticalStage::StandsIn;
        if stands_in || message.stage == CriticalStage::Taken {
            let settled = Settled { critical, stands_in, time: header.sent };
            self.settled.retain(|old| (old.critical, old.stands_in) != (critical, stands_in));
            self.settled.push(settled);
            self.open.retain(|help| !settled.settles(&help.situation));
            self.claimed.take_if(|claimed| settled.settles(&claimed.situation));
        }
    }

    /// Handles a request. A robot that asks again has another reason: its last request does not count any more.
    fn hear_request(&mut self, message: &CriticalSituation, header: Header) {
        if self.settled.iter().any(|settled| settled.settles(message) && settled.time > header.sent) {
            return;
        }
        let help =
            Help { situation: message.clone(), since: header.sent, cause: header.cause, rivals: Vec::new(), needs: 0 };
        if let Some(claimed) = self.claimed.as_mut().filter(|claimed| claimed.is_of(message.critical)) {
            claimed.situation = help.situation;
        } else if let Some(known) = self.open.iter_mut().find(|known| known.is_of(message.critical)) {
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

    /// Offers to heal the robot with this number, if it waits.
    pub fn claim(&mut self, critical: u32) -> Option<&Help> {
        if self.claimed.is_none() {
            let place = self.open.iter().position(|help| help.is_of(critical))?;
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

    /// The request of a robot, unless this robot offered to answer it.
    pub fn get(&self, critical: u32) -> Option<&Help> {
        self.open.iter().find(|help| help.is_of(critical))
    }

    /// Defers a request until the battery lasts for `needs` executions.
    pub fn postpone(&mut self, critical: u32, needs: u32) {
        if let Some(help) = self.open.iter_mut().find(|help| help.is_of(critical)) {
            help.needs = needs;
        }
    }

    /// Leaves a request to other robots for good.
    pub fn refuse(&mut self, critical: u32) {
        self.open.retain(|help| !help.is_of(critical));
    }
}

impl Help {
    fn is_of(&self, critical: u32) -> bool {
        self.situation.critical == critical
    }
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

    fn response(stage: CriticalStage) -> CriticalSituation {
        CriticalSituation { stage, healer: 3, ..request(CriticalKind::Idle) }
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
            helps.hear(&response(stage), header(2));
            assert_eq!(helps.open().len(), open, "{kind:?}, {stage:?}");
            let mut late = Helps::new(1);
            late.hear(&response(stage), header(2));
            late.hear(&request(kind), header(1));
            assert_eq!(late.open().len(), open, "{kind:?}, {stage:?}: the request arrives later");
        }
    }
}
