//! What robots, zones and the network between them can do in a state.

use std::collections::BTreeSet;

use super::part::Part;
use super::{Faults, Scenario};
use crate::grid::Block;
use crate::messages::{ClearTerm, Grant, GrantRequest, Standing, Territory};
use crate::zone::ground::Ground;
use crate::zone::ledger::{Heard, Ledger};
use crate::zone::maneuver::Maneuver;
use crate::zone::passage::{Passage, Wish};
use crate::zone::plan::plan;

#[derive(Clone, Hash)]
pub(super) struct State {
    pub(super) zones: Vec<Part<Zone>>,
    pub(super) robots: Vec<Part<Robot>>,
    /// The newest messages of each link, sorted by their hash. A message stays when it is delivered, since it may
    /// come again, and is lost if it is never delivered.
    pub(super) network: Vec<Part<Message>>,
    pub(super) faults: Faults,
    pub(super) arriving: usize,
    /// How often the zones got other borders.
    pub(super) drawings: usize,
    /// True if robots answer to all zones at once, too.
    pub(super) asks: bool,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Zone {
    pub(super) ledger: Ledger,
    pub(super) maneuvers: Vec<Maneuver>,
    /// Robots that did not answer in this term.
    pub(super) unheard: BTreeSet<u32>,
    /// True if it grants before all have answered.
    pub(super) has_record: bool,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Robot {
    pub(super) passage: Passage,
    pub(super) at: Block,
    pub(super) moving: Option<Block>,
    pub(super) goal: Block,
    pub(super) needed: u32,
    pub(super) is_gone: bool,
}

impl Robot {
    fn is_on_floor(&self) -> bool {
        !self.is_gone && !self.passage.enters()
    }

    fn is_done(&self) -> bool {
        self.is_gone || self.is_on_floor() && self.at == self.goal && self.moving.is_none()
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Message {
    /// To this robot.
    Territory(u32, Territory),
    Request(GrantRequest),
    Grant(Grant),
    /// What an incarnation of a robot says to all zones, with its block and the end of its passage, as one of them
    /// hears it.
    Clear(u32, u64, ClearTerm, (Block, Block)),
    /// To a zone: this robot is gone, which was this incarnation of it then.
    Gone(u32, u32, u64),
}

impl Message {
    /// Order of the messages of a link.
    fn age(&self) -> (u64, u64, u64) {
        match self {
            Message::Territory(_, territory) => (territory.term, 0, 0),
            Message::Request(request) => (request.incarnation, request.number, 0),
            Message::Grant(grant) => (grant.term, grant.incarnation, grant.steps.last().map_or(0, |step| step.number)),
            Message::Clear(_, incarnation, clear, _) => (clear.term, *incarnation, 0),
            Message::Gone(..) => (0, 0, 0),
        }
    }

    /// True if both are of one link.
    fn is_beside(&self, other: &Message) -> bool {
        match (self, other) {
            (Message::Territory(one, a), Message::Territory(other, b)) => one == other && a.zone == b.zone,
            (Message::Request(one), Message::Request(other)) => one.link == other.link,
            (Message::Grant(one), Message::Grant(other)) => one.link == other.link,
            (Message::Clear(one, _, a, _), Message::Clear(other, _, b, _)) => one == other && a.zone == b.zone,
            _ => false,
        }
    }
}

impl State {
    /// No two robots hold the same block.
    pub(super) fn check(&self, name: &str) {
        let on_floor = self.robots.iter().filter(|robot| robot.is_on_floor());
        let held = on_floor.flat_map(|robot| {
            let held = robot.passage.held().iter().map(|held| held.step.block);
            held.chain([robot.at]).chain(robot.moving).collect::<BTreeSet<Block>>()
        });
        let mut blocks: Vec<Block> = held.collect();
        let all = blocks.len();
        blocks.sort_unstable();
        blocks.dedup();
        assert_eq!(blocks.len(), all, "{name}: robots collide");
    }

    /// True if all robots are at their goals, or gone.
    pub(super) fn is_done(&self) -> bool {
        self.robots.iter().all(|robot| robot.is_done())
    }

    /// A message can be overtaken by newer messages of the same link, as on a topic that keeps the newest.
    fn send(&mut self, message: Message) {
        let same = || self.network.iter().enumerate().filter(|(_, other)| other.is_beside(&message));
        if same().any(|(_, other)| **other == message) {
            return;
        }
        if same().count() >= self.arriving
            && let Some((earlier, _)) = same().min_by_key(|(_, other)| other.age())
        {
            self.network.remove(earlier);
        }
        self.network.push(message.into());
    }

    /// The place of the zone with a number.
    pub(super) fn place(&self, zone: u32) -> Option<usize> {
        self.zones.iter().position(|one| one.ledger.territory().zone == zone)
    }

    fn everyone(&self) -> BTreeSet<u32> {
        (1..).take(self.robots.len()).collect()
    }

    /// The zones get their next borders, at one instant. Those whose blocks stay the same go on.
    fn drawn(&self, rules: &Scenario) -> Option<State> {
        let borders = rules.drawings.get(self.drawings)?;
        let ledgers: Vec<&Ledger> = self.zones.iter().map(|zone| &zone.ledger).collect();
        let term = ledgers.iter().map(|ledger| ledger.territory().term + 1).max()?;
        let height = ledgers.first()?.territory().height;
        let mut next = State { drawings: self.drawings + 1, ..self.clone() };
        let zones = borders.iter().map(|&(zone, x, width)| {
            let territory = Territory { zone, term, corner: Block::new(x, 0), width, height };
            let has_record = self.zones.iter().all(|zone| zone.has_record || zone.unheard.is_empty());
            let same = |one: &&Part<Zone>| Territory { term, ..one.ledger.territory().clone() } == territory;
            self.zones.iter().find(same).cloned().unwrap_or_else(|| {
                let unheard = if rules.asks || !has_record { self.everyone() } else { BTreeSet::new() };
                let ledger = Ledger::drawn(territory.clone(), &ledgers);
                Zone { ledger, maneuvers: Vec::new(), unheard, has_record }.into()
            })
        });
        next.zones = zones.collect();
        for zone in &next.zones.clone() {
            let territory = zone.ledger.territory();
            self.everyone().into_iter().for_each(|robot| next.send(Message::Territory(robot, territory.clone())));
        }
        Some(next)
    }

    fn announce(&mut self, zone: usize) {
        let one = self.zones[zone].clone();
        for robot in &one.unheard {
            self.send(Message::Territory(*robot, one.ledger.territory().clone()));
        }
    }

    /// A robot says to all zones of which of them it holds nothing, and to some of them what it holds.
    pub(super) fn answer(&mut self, robot: usize) {
        self.request(robot);
        if !self.asks {
            return;
        }
        let passage = &self.robots[robot].passage;
        let (number, incarnation, clear) = (passage.robot(), passage.incarnation(), passage.clear());
        let place = (passage.held()[0].step.block, passage.end());
        clear.into_iter().for_each(|clear| self.send(Message::Clear(number, incarnation, clear, place)));
    }

    /// A robot says what is new to zones. It need not repeat it: each message may come again.
    fn request(&mut self, robot: usize) {
        let one = self.robots[robot].change();
        let rank = u64::try_from(robot).unwrap();
        let enters = one.passage.enters();
        let goal = Some(one.goal).filter(|goal| *goal != one.passage.end() && !one.is_gone && !enters);
        let wish = Wish {
            goal,
            charger: one.goal,
            rank: if goal.is_some() { 10 - rank } else { 0 },
            standing: if enters && !one.is_gone { Standing::Enters } else { Standing::MakesWay },
            ahead: one.needed,
            aside: None,
        };
        for request in one.passage.requests(wish, false) {
            self.send(Message::Request(request));
        }
    }

    fn plan(&mut self, zone: usize, again: bool, ground: &mut Ground, rules: &Scenario) {
        self.announce(zone);
        let one = &self.zones[zone];
        if !one.unheard.is_empty() && !one.has_record {
            return;
        }
        let Zone { ledger, maneuvers, has_record, .. } = self.zones[zone].change();
        *has_record = true;
        let mut told = plan(ledger, maneuvers, ground, rules.ahead).granted;
        let robots: Vec<u32> = ledger.members().keys().copied().collect();
        for robot in &robots {
            let waited = &mut ledger.member_mut(*robot).unwrap().waited;
            if *waited > rules.waits {
                // The next round looks for a maneuver again.
                *waited = rules.waits.saturating_sub(1);
            }
        }
        if again {
            told.extend(robots);
        }
        // The part of the robot that is explored takes its steps from a grant, and nothing else.
        let steps_of = |grant: Grant| Grant {
            heard: 0,
            waits_for: 0,
            wanted: Block::default(),
            aside: Block::default(),
            aside_rank: 0,
            ..grant
        };
        let grants: Vec<Grant> = told.iter().filter_map(|robot| ledger.message(*robot)).map(steps_of).collect();
        grants.into_iter().for_each(|grant| self.send(Message::Grant(grant)));
    }

    fn deliver(&mut self, message: &Message, ground: &mut Ground, rules: &Scenario) {
        match message {
            Message::Territory(robot, _) | Message::Grant(Grant { robot, .. })
                if self.robots[*robot as usize - 1].is_gone => {}
            Message::Gone(zone, robot, incarnation) => {
                self.network.retain(|other| **other != *message);
                let Some(zone) = self.place(*zone) else { return };
                // A robot that the zone heard of since then is back.
                let known = self.zones[zone].ledger.member(*robot);
                if known.is_none_or(|known| known.request.incarnation <= *incarnation) {
                    let one = self.zones[zone].change();
                    one.ledger.end(*robot, *incarnation);
                    one.unheard.remove(robot);
                    self.plan(zone, false, ground, rules);
                }
            }
            Message::Territory(robot, territory) => {
                let robot = *robot as usize - 1;
                self.robots[robot].change().passage.hear_territory(territory);
                self.answer(robot);
            }
            Message::Grant(grant) => {
                let robot = grant.robot as usize - 1;
                let one = self.robots[robot].change();
                one.passage.hear(grant);
                one.moving = one.moving.or_else(|| one.passage.next());
                self.request(robot);
            }
            Message::Request(request) => {
                let Some(zone) = self.place(request.zone) else { return };
                let one = self.zones[zone].change();
                let is_news = one.ledger.hear(request) != Heard::Nothing;
                let is_of_term = request.term == one.ledger.territory().term;
                if is_of_term && one.unheard.remove(&request.robot) || is_news {
                    self.plan(zone, false, ground, rules);
                }
            }
            Message::Clear(robot, incarnation, clear, place) => {
                let Some(zone) = self.place(clear.zone) else { return };
                let one = self.zones[zone].change();
                let is_of_term = clear.term == one.ledger.territory().term;
                let is_news = is_of_term && one.ledger.hear_clear(*robot, *incarnation, *place);
                if is_of_term && one.unheard.remove(robot) || is_news {
                    self.plan(zone, false, ground, rules);
                }
            }
        }
    }

    /// A robot begins with this passage, as a new incarnation, and hears the zones on their state topics.
    fn begin(&mut self, robot: usize, begin: fn(u32, u64, Block) -> Passage, at: Block) {
        let one = self.robots[robot].change();
        one.passage = begin(one.passage.robot(), one.passage.incarnation() + 1, at);
        (one.is_gone, one.at, one.moving) = (false, at, None);
        for zone in &self.zones {
            one.passage.hear_territory(zone.ledger.territory());
        }
        self.answer(robot);
    }

    /// Somebody starts a robot that is gone again: it enters the floor where it started at first.
    fn put_back(&self, robot: usize, rules: &Scenario) -> Option<State> {
        let (x, y) = rules.robots[robot].0;
        if !self.robots[robot].is_gone {
            return None;
        }
        let mut back = self.clone();
        back.faults.back -= 1;
        back.begin(robot, Passage::entering, Block::new(x, y));
        Some(back)
    }

    pub(super) fn successors(&self, ground: &mut Ground, rules: &Scenario) -> Vec<State> {
        let mut all = Vec::new();
        for message in &self.network {
            let mut next = self.clone();
            next.deliver(message, ground, rules);
            all.push(next);
        }
        if self.faults.back > 0 {
            all.extend((0..self.robots.len()).filter_map(|robot| self.put_back(robot, rules)));
        }
        for robot in (0..self.robots.len()).filter(|robot| !self.robots[*robot].is_gone) {
            if let Some(to) = self.robots[robot].moving {
                let mut next = self.clone();
                let one = next.robots[robot].change();
                one.at = to;
                one.passage.arrive(to);
                one.moving = one.passage.next();
                next.request(robot);
                all.push(next);
            }
            if self.faults.gone > 0 {
                all.extend(self.taken(robot));
            }
            if self.faults.robots > 0 {
                let mut crashed = self.clone();
                crashed.faults.robots -= 1;
                let one = &self.robots[robot];
                crashed.begin(robot, if one.is_on_floor() { Passage::new } else { Passage::entering }, one.at);
                all.push(crashed);
            }
        }
        for zone in 0..self.zones.len() {
            let mut next = self.clone();
            next.plan(zone, true, ground, rules);
            all.push(next);
        }
        all.extend(self.drawn(rules));
        if self.faults.zones > 0 {
            for zone in 0..self.zones.len() {
                let mut crashed = self.clone();
                crashed.faults.zones -= 1;
                let territory = self.zones[zone].ledger.territory().clone();
                let ledger = Ledger::new(Territory { term: territory.term + 1, ..territory });
                let unheard = self.everyone();
                crashed.zones[zone] = Zone { ledger, maneuvers: Vec::new(), unheard, has_record: false }.into();
                crashed.announce(zone);
                all.push(crashed);
            }
        }
        all
    }

    /// Somebody takes a robot off the floor, which tells the zones, or had ended before.
    fn taken(&self, robot: usize) -> [State; 2] {
        let mut taken = self.clone();
        taken.faults.gone -= 1;
        let one = taken.robots[robot].change();
        (one.is_gone, one.moving) = (true, None);
        let number = one.passage.robot();
        let incarnation = one.passage.incarnation();
        let zones = self.zones.iter().map(|zone| zone.ledger.territory().zone);
        zones.for_each(|zone| taken.send(Message::Gone(zone, number, incarnation)));
        let mut ended = taken.clone();
        taken.robots[robot].change().passage.leave_floor();
        taken.request(robot);
        for next in [&mut taken, &mut ended] {
            let one = next.robots[robot].change();
            // What it knew makes no difference any more.
            (one.at, one.passage) = (one.goal, Passage::new(number, incarnation, one.goal));
        }
        [taken, ended]
    }
}
