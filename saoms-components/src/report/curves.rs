//! The curves of a fleet of robots: luggage and visits, robots that are awake, and their batteries.

use std::collections::{BTreeMap, HashMap, HashSet};

use saoms_api::Time;
use saoms_api::extension::{Curve, CurvesRegistration, RunCurves, submit};
use saoms_api::host::{SharedMessage, TopicDeclaration};

use crate::messages::{
    ASSIGNMENT, Assignment, EVENT_LUGGAGE, EventLuggage, FAULT, Fault, FaultKind, LuggageStage, REMOVAL, ROBOT_LIST,
    Removal, RobotList, VISIT, Visit, carries,
};

const fn curve(panel: &'static str, name: &'static str) -> Curve {
    Curve { name, panel, is_work: false }
}

const CURVES: &[Curve] = &[
    Curve { name: "finished", panel: "finished", is_work: true },
    curve("open", "luggage and visits"),
    curve("robots", "awake"),
    curve("robots", "in service"),
    curve("battery, %", "mean"),
    curve("battery, %", "least"),
];

submit! { CurvesRegistration { curves: CURVES, new: || Box::new(FleetCurves::default()) } }

/// What the curves show. Robots and luggage of different sites may have the same number.
#[derive(Debug, Default)]
struct FleetCurves {
    /// By the name of the topic, what its messages are, and the site.
    topics: HashMap<String, (Content, String)>,
    sites: BTreeMap<String, Site>,
    finished: usize,
}

#[derive(Debug, Default)]
struct Site {
    open: HashSet<u32>,
    closed: HashSet<u32>,
    robots: BTreeMap<u32, State>,
    /// Robots that are broken for good, whatever they say.
    broken: HashSet<u32>,
}

#[derive(Clone, Copy, Debug)]
struct State {
    is_awake: bool,
    battery: f64,
    /// When it ended, if it has.
    ended: Option<Time>,
}

/// What the messages of a topic are.
#[derive(Clone, Copy, Debug)]
enum Content {
    Assignment,
    Luggage,
    Fault,
    Removal,
    Robot,
    Visit,
}

fn content(declared: &TopicDeclaration<'_>) -> Option<Content> {
    Some(match declared {
        one if carries(one, &ASSIGNMENT) => Content::Assignment,
        one if carries(one, &EVENT_LUGGAGE) => Content::Luggage,
        one if carries(one, &FAULT) => Content::Fault,
        one if carries(one, &REMOVAL) => Content::Removal,
        one if carries(one, &ROBOT_LIST) => Content::Robot,
        one if carries(one, &VISIT) => Content::Visit,
        _ => return None,
    })
}

impl Site {
    /// Takes in a message. Gives the number of pieces and visits that it finishes; `None` for one that is no such
    /// message.
    fn hear(&mut self, content: Content, message: &SharedMessage) -> Option<usize> {
        match content {
            Content::Robot => self.hear_state(message.get::<RobotList>()?, message.header().sent),
            Content::Luggage => {
                let EventLuggage { luggage, stage, .. } = message.get::<EventLuggage>()?;
                match stage {
                    LuggageStage::Request => self.ask(*luggage),
                    LuggageStage::Delivered => return Some(usize::from(self.close(*luggage))),
                    LuggageStage::GivenUp => _ = self.close(*luggage),
                    LuggageStage::Interest | LuggageStage::Release | LuggageStage::Taken | LuggageStage::Refused => {}
                }
            }
            Content::Assignment => self.ask(message.get::<Assignment>()?.luggage),
            Content::Visit => self.ask(message.get::<Visit>()?.visit),
            Content::Fault => self.hear_fault(message.get::<Fault>()?),
            Content::Removal => {
                let delivered = &message.get::<Removal>()?.delivered;
                return Some(delivered.iter().filter(|luggage| self.close(**luggage)).count());
            }
        }
        Some(0)
    }

    fn ask(&mut self, number: u32) {
        if !self.closed.contains(&number) {
            self.open.insert(number);
        }
    }

    /// True if it was not closed before.
    fn close(&mut self, number: u32) -> bool {
        self.open.remove(&number);
        self.closed.insert(number)
    }

    fn hear_state(&mut self, said: &RobotList, at: Time) {
        if self.broken.contains(&said.robot) {
            return;
        }
        if said.active {
            self.robots.insert(said.robot, State { is_awake: !said.asleep, battery: said.battery, ended: None });
        } else if let Some(state) = self.robots.get_mut(&said.robot) {
            state.ended.get_or_insert(at);
        }
    }

    fn hear_fault(&mut self, fault: &Fault) {
        self.robots.remove(&fault.robot);
        if fault.kind == FaultKind::Breakdown {
            self.broken.insert(fault.robot);
        }
    }
}

impl RunCurves for FleetCurves {
    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        let Some(content) = content(declared) else { return false };
        let site = name.rsplit_once('/').map_or("", |(site, _)| site);
        self.topics.insert(name.to_owned(), (content, site.to_owned()));
        true
    }

    fn message(&mut self, topic: &str, _component: &str, message: &SharedMessage) {
        let Some((content, name)) = self.topics.get(topic) else { return };
        if !self.sites.contains_key(name) {
            self.sites.insert(name.clone(), Site::default());
        }
        let Some(site) = self.sites.get_mut(name) else { return };
        self.finished += site.hear(*content, message).unwrap_or_default();
    }

    fn figures(&self, now: Time) -> Vec<f64> {
        let open: usize = self.sites.values().map(|site| site.open.len()).sum();
        let is_there = move |robot: &&State| robot.ended.is_none_or(|ended| ended >= now);
        let robots = || self.sites.values().flat_map(|site| site.robots.values()).filter(is_there);
        let count = robots().count();
        let awake = robots().filter(|robot| robot.is_awake).count();
        // Without robots neither is known.
        let mean = robots().map(|robot| robot.battery).sum::<f64>() / count as f64;
        let least = robots().map(|robot| robot.battery).fold(f64::NAN, f64::min);
        vec![self.finished as f64, open as f64, awake as f64, count as f64, mean, least]
    }
}

#[cfg(test)]
mod tests {
    use saoms_api::host::cdr;
    use saoms_api::{Cause, Header, Message};

    use super::*;

    fn say<M: Message>(curves: &mut FleetCurves, topic: &str, message: M) {
        let header = Header { sender: 0, sent: Time::START, cause: Cause::default() };
        curves.message(topic, "", &SharedMessage::new(header, message));
    }

    #[test]
    fn bytes_are_read_as_what_their_topic_carries() {
        let mut curves = FleetCurves::default();
        assert!(curves.wants_topic("VTOPIC", &VISIT.declaration()));
        let header = Header { sender: 0, sent: Time::START, cause: Cause::default() };
        let state = cdr::encode(&RobotList { robot: 1, active: true, ..RobotList::default() });
        curves.message("VTOPIC", "", &SharedMessage::from_bytes(header, None, state));
        assert_eq!(curves.figures(Time::START)[3], 0.0);
    }

    #[test]
    fn the_curves_follow_what_components_say() {
        let mut curves = FleetCurves::default();
        for (topic, declared) in [
            ("North/luggage", EVENT_LUGGAGE.declaration()),
            ("South/luggage", EVENT_LUGGAGE.declaration()),
            ("North/robots", ROBOT_LIST.declaration()),
            ("North/faults", FAULT.declaration()),
        ] {
            assert!(curves.wants_topic(topic, &declared));
        }
        assert!(curves.figures(Time::START)[4].is_nan(), "no robot is known");
        let luggage = |stage| EventLuggage { luggage: 1, stage, ..EventLuggage::default() };
        for topic in ["North/luggage", "South/luggage", "North/luggage"] {
            say(&mut curves, topic, luggage(LuggageStage::Request));
        }
        let robot = |robot, asleep, battery| RobotList { robot, active: true, asleep, battery, ..RobotList::default() };
        say(&mut curves, "North/robots", robot(1, false, 50.0));
        say(&mut curves, "North/robots", robot(2, true, 100.0));
        assert_eq!(curves.figures(Time::START), [0.0, 2.0, 1.0, 2.0, 75.0, 50.0]);
        say(&mut curves, "North/luggage", luggage(LuggageStage::Delivered));
        say(&mut curves, "North/luggage", luggage(LuggageStage::Delivered));
        say(&mut curves, "North/luggage", luggage(LuggageStage::Request));
        say(&mut curves, "North/faults", Fault::breakdown(1));
        say(&mut curves, "North/robots", robot(1, false, 50.0));
        assert_eq!(curves.figures(Time::START), [1.0, 1.0, 0.0, 1.0, 100.0, 100.0], "a broken robot is out of service");
        say(&mut curves, "North/robots", RobotList { robot: 2, active: false, ..RobotList::default() });
        assert_eq!(curves.figures(Time::START)[3], 1.0, "it ends just now");
        assert_eq!(curves.figures(Time::from_nanos(1))[3], 0.0);
    }
}
