use std::fmt;

use saoms_api::{Cause, Header, Time};

use crate::messages::{CriticalKind, CriticalSituation, CriticalStage, RobotList};

use super::Rival;

/// A robot that waits for a healer.
#[derive(Clone, Debug)]
pub struct Help {
    /// What it asked for.
    pub situation: CriticalSituation,
    /// When.
    pub since: Time,
    /// Why.
    pub cause: Cause,
    /// The other robots that would heal it and did not take that back.
    pub rivals: Vec<Rival>,
    /// How many executions the battery has to last before this robot thinks about it again; 0 while it did not.
    pub needs: u32,
}

impl fmt::Display for Help {
    /// As the console of the manual's figures shows it.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "New help request from Robot{}", self.situation.critical)
    }
}

/// The robots that wait for a healer, in the order in which they asked.
#[derive(Debug)]
pub struct Helps {
    number: u32,
    open: Vec<Help>,
    /// The one that this robot would heal: no longer on the list.
    claimed: Option<Help>,
    /// What is settled: the request may arrive later than that.
    settled: Vec<Settled>,
}

/// That somebody takes care of a robot.
#[derive(Clone, Copy, Debug)]
struct Settled {
    critical: u32,
    /// Whether somebody only stands in for it. That leaves its job open.
    stands_in: bool,
    /// When he said so.
    time: Time,
}

impl Settled {
    fn settles(&self, situation: &CriticalSituation) -> bool {
        let covered = !self.stands_in || situation.kind == CriticalKind::Idle;
        self.critical == situation.critical && covered
    }
}

impl Helps {
    /// None, for the robot of this number.
    pub fn new(number: u32) -> Helps {
        Helps { number, open: Vec::new(), claimed: None, settled: Vec::new() }
    }

    /// Takes in a request, the own ones too, or a response of another robot.
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

    /// A robot that asks again has another reason: what was known of the last one does not count any more.
    fn hear_request(&mut self, message: &CriticalSituation, header: Header) {
        if self.settled.iter().any(|settled| settled.settles(message) && settled.time > header.sent) {
            return;
        }
        let help = Help {
            situation: message.clone(),
            since: header.sent,
            cause: header.cause,
            rivals: Vec::new(),
            needs: 0,
        };
        if let Some(claimed) = self.claimed.as_mut().filter(|claimed| claimed.is_of(message.critical)) {
            claimed.situation = help.situation;
        } else if let Some(known) = self.open.iter_mut().find(|known| known.is_of(message.critical)) {
            *known = help;
        } else {
            self.open.push(help);
        }
    }

    /// Takes in that a robot is active, or no longer is. One that works again needs no substitute, one that ended heals nobody.
    pub fn hear_robot(&mut self, robot: &RobotList) {
        if robot.active && !robot.in_charge {
            self.open.retain(|help| !help.is_of(robot.robot) || help.situation.kind != CriticalKind::Idle);
        } else if !robot.active {
            for help in self.open.iter_mut().chain(&mut self.claimed) {
                help.rivals.retain(|rival| rival.robot != robot.robot);
            }
        }
    }

    /// Takes those that others would heal off the list.
    pub fn drop_contested(&mut self) {
        self.open.retain(|help| help.rivals.is_empty());
    }

    /// Those on the list, oldest first.
    pub fn open(&self) -> &[Help] {
        &self.open
    }

    /// The one that this robot would heal, unless another robot does.
    pub fn claimed(&self) -> Option<&Help> {
        self.claimed.as_ref()
    }

    /// Would heal the robot of this number, if it waits.
    pub fn claim(&mut self, critical: u32) -> Option<&Help> {
        if self.claimed.is_none() {
            let place = self.open.iter().position(|help| help.is_of(critical))?;
            self.claimed = Some(self.open.remove(place));
        }
        self.claimed.as_ref()
    }

    /// Ends that: this robot heals the other one, or somebody else does.
    pub fn settle(&mut self) -> Option<Help> {
        self.claimed.take()
    }

    /// Would not heal it any more: it waits again where it was on the list.
    pub fn put_back(&mut self) {
        if let Some(help) = self.claimed.take() {
            let place = self.open.partition_point(|open| open.since <= help.since);
            self.open.insert(place, help);
        }
    }

    /// The request of a robot, unless this robot would heal it.
    pub fn get(&self, critical: u32) -> Option<&Help> {
        self.open.iter().find(|help| help.is_of(critical))
    }

    /// Thinks about a request again when the battery lasts for so many executions.
    pub fn postpone(&mut self, critical: u32, needs: u32) {
        if let Some(help) = self.open.iter_mut().find(|help| help.is_of(critical)) {
            help.needs = needs;
        }
    }

    /// Leaves a request to others for good.
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
