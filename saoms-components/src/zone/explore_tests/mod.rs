//! Exhaustive exploration of the protocol between zones and robots: every order of sending and delivering messages, of
//! moves, and of crashes, on tiny maps. Each message may be lost, come late and come again, any number of times.
//!
//! In each state that can be reached no two robots hold the same block, and from each state all robots can still reach
//! their goals.

mod mixer;
mod numbering;
mod scenarios;

use std::collections::{BTreeSet, HashMap};
use std::hash::{BuildHasherDefault, Hash, Hasher};

use super::ground::Ground;
use super::ledger::{Heard, Ledger};
use super::maneuver::Maneuver;
use super::passage::{Passage, Wish};
use super::plan::plan;
use crate::grid::{Block, Map};
use crate::messages::{ClearTerm, Grant, GrantRequest, Standing, Territory};
use mixer::Mixer;

type Spot = (i32, i32);

/// A fleet to explore.
struct Scenario {
    name: &'static str,
    map: &'static str,
    /// First column and number of columns of each zone.
    zones: &'static [(i32, u32)],
    /// Borders that follow, at any moment: number, first column and number of columns of each zone.
    drawings: &'static [&'static [(u32, i32, u32)]],
    /// True if zones with other borders ask again and again, and robots answer all zones at once, too.
    asks: bool,
    /// Start and goal of each robot.
    robots: &'static [(Spot, Spot)],
    /// Number of the last robots that are not on the floor at first, and want to enter it.
    entering: usize,
    faults: Faults,
    /// Number of blocks that are granted ahead.
    ahead: usize,
    /// Number of blocks ahead that robots say they need.
    needed: u32,
    /// Number up to which rounds of waiting are told apart: 0 where no maneuver is needed.
    waits: u32,
    /// Number of the newest messages of each link that may still arrive.
    arriving: usize,
}

/// Crashes that may still happen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Faults {
    /// Crashes of robots that lose their memory.
    robots: u8,
    /// Crashes of zones that lose their record.
    zones: u8,
    /// Robots that somebody takes off the floor.
    gone: u8,
    /// Robots that somebody puts back where they started.
    back: u8,
}

#[derive(Clone, PartialEq, Eq, Hash)]
struct State {
    zones: Vec<Zone>,
    robots: Vec<Robot>,
    /// The newest messages of each link, sorted by their hash. A message stays when it is delivered, since it may
    /// come again, and is lost if it is never delivered.
    network: Vec<Message>,
    faults: Faults,
    arriving: usize,
    /// How often the zones got other borders.
    drawings: usize,
    /// True if robots answer to all zones at once, too.
    asks: bool,
}

#[derive(Clone, PartialEq, Eq, Hash)]
struct Zone {
    ledger: Ledger,
    maneuvers: Vec<Maneuver>,
    /// Robots that did not answer in this term.
    unheard: BTreeSet<u32>,
    /// True if it grants before all have answered.
    has_record: bool,
}

#[derive(Clone, PartialEq, Eq, Hash)]
struct Robot {
    passage: Passage,
    at: Block,
    moving: Option<Block>,
    goal: Block,
    needed: u32,
    is_gone: bool,
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
enum Message {
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
    fn age(&self) -> (u64, u64) {
        match self {
            Message::Territory(_, territory) => (territory.term, 0),
            Message::Request(request) => (request.incarnation, request.number),
            Message::Grant(grant) => (grant.heard, grant.steps.last().map_or(0, |step| step.number)),
            Message::Clear(_, incarnation, clear, _) => (clear.term, *incarnation),
            Message::Gone(..) => (0, 0),
        }
    }
}

fn hash(of: &impl Hash) -> u64 {
    let mut mixer = Mixer::default();
    of.hash(&mut mixer);
    mixer.finish()
}

impl Scenario {
    fn start(&self) -> State {
        let height = u32::try_from(self.map.trim().lines().count()).unwrap();
        let robots: BTreeSet<u32> = (1..).take(self.robots.len()).collect();
        let zones = self.zones.iter().zip(1..).map(|(&(x, width), zone)| Zone {
            ledger: Ledger::new(Territory { zone, term: 1, corner: Block::new(x, 0), width, height }),
            maneuvers: Vec::new(),
            unheard: robots.clone(),
            has_record: false,
        });
        let standing = self.robots.len() - self.entering;
        let fleet = self.robots.iter().zip(1..).map(|(&(at, goal), robot)| {
            let (at, goal) = (Block::new(at.0, at.1), Block::new(goal.0, goal.1));
            let begin = if robot as usize <= standing { Passage::new } else { Passage::entering };
            Robot { passage: begin(robot, 1, at), at, moving: None, goal, needed: self.needed, is_gone: false }
        });
        let mut state = State {
            zones: zones.collect(),
            robots: fleet.collect(),
            network: Vec::new(),
            faults: self.faults,
            arriving: self.arriving,
            drawings: 0,
            asks: self.asks,
        };
        for zone in 0..state.zones.len() {
            let territory = state.zones[zone].ledger.territory().clone();
            state.robots.iter_mut().for_each(|robot| robot.passage.hear_territory(&territory));
        }
        (0..state.robots.len()).for_each(|robot| state.answer(robot));
        for message in std::mem::take(&mut state.network) {
            match message {
                Message::Request(request) => {
                    let zone = &mut state.zones[request.zone as usize - 1];
                    zone.ledger.hear(&request);
                    zone.unheard.remove(&request.robot);
                }
                Message::Clear(robot, _, clear, _) => _ = state.zones[clear.zone as usize - 1].unheard.remove(&robot),
                Message::Territory(..) | Message::Grant(_) | Message::Gone(..) => {}
            }
        }
        state
    }

    /// Explores all states, and returns their number.
    fn explore(&self) -> usize {
        let mut ground = Ground::new(Map::read(self.map).unwrap());
        let mut known: HashMap<u64, u32, BuildHasherDefault<Mixer>> = HashMap::default();
        let mut before: Vec<Vec<u32>> = Vec::new();
        let mut done: Vec<u32> = Vec::new();
        let mut open = Vec::new();
        let start = self.start();
        known.insert(hash(&start), 0);
        before.push(Vec::new());
        open.push((0, start));
        while let Some((number, state)) = open.pop() {
            state.check(self.name);
            if state.robots.iter().all(Robot::is_done) {
                done.push(number);
            }
            for mut next in state.successors(&mut ground, self) {
                if next == state {
                    continue;
                }
                next.renumber();
                let place = *known.entry(hash(&next)).or_insert_with(|| {
                    let place = u32::try_from(before.len()).unwrap();
                    before.push(Vec::new());
                    open.push((place, next));
                    place
                });
                before[place as usize].push(number);
            }
            assert!(before.len() < 400_000, "{}: too many states", self.name);
        }
        // Each state leads to one in which all robots are at their goals.
        let mut leads = vec![false; before.len()];
        while let Some(number) = done.pop() {
            if !std::mem::replace(&mut leads[number as usize], true) {
                done.extend(&before[number as usize]);
            }
        }
        let lost = leads.iter().filter(|leads| !**leads).count();
        assert_eq!(lost, 0, "{}: of {} states, {lost} do not lead to the goals", self.name, before.len());
        before.len()
    }
}

impl State {
    /// No two robots hold the same block.
    fn check(&self, name: &str) {
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

    /// A message can be overtaken by newer messages of the same link, as on a topic that keeps the newest.
    fn send(&mut self, message: Message) {
        let same = |other: &Message| match (other, &message) {
            (Message::Territory(one, a), Message::Territory(other, b)) => one == other && a.zone == b.zone,
            (Message::Request(one), Message::Request(other)) => one.link == other.link,
            (Message::Grant(one), Message::Grant(other)) => one.link == other.link,
            (Message::Clear(one, _, a, _), Message::Clear(other, _, b, _)) => one == other && a.zone == b.zone,
            _ => false,
        };
        let earlier = self.network.iter().filter(|other| same(other)).min_by_key(|other| other.age()).cloned();
        if let Some(earlier) = earlier
            && self.network.iter().filter(|other| same(other)).count() >= self.arriving
        {
            self.network.retain(|other| *other != earlier);
        }
        if !self.network.contains(&message) {
            self.network.push(message);
        }
    }

    /// The place of the zone with a number.
    fn place(&self, zone: u32) -> Option<usize> {
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
            let same = |one: &&Zone| Territory { term, ..one.ledger.territory().clone() } == territory;
            self.zones.iter().find(same).cloned().unwrap_or_else(|| Zone {
                ledger: Ledger::drawn(territory.clone(), &ledgers),
                maneuvers: Vec::new(),
                unheard: if rules.asks || !has_record { self.everyone() } else { BTreeSet::new() },
                has_record,
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
        let territory = self.zones[zone].ledger.territory().clone();
        for robot in self.zones[zone].unheard.clone() {
            self.send(Message::Territory(robot, territory.clone()));
        }
    }

    /// A robot says to all zones of which of them it holds nothing, and to some of them what it holds.
    fn answer(&mut self, robot: usize) {
        self.request(robot, false);
        if !self.asks {
            return;
        }
        let passage = &self.robots[robot].passage;
        let (number, incarnation, clear) = (passage.robot(), passage.incarnation(), passage.clear());
        let place = (passage.held()[0].step.block, passage.end());
        clear.into_iter().for_each(|clear| self.send(Message::Clear(number, incarnation, clear, place)));
    }

    fn request(&mut self, robot: usize, again: bool) {
        let one = &mut self.robots[robot];
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
        for request in one.passage.requests(wish, again) {
            self.send(Message::Request(request));
        }
    }

    fn plan(&mut self, zone: usize, again: bool, ground: &mut Ground, rules: &Scenario) {
        self.announce(zone);
        let one = &mut self.zones[zone];
        if !one.unheard.is_empty() && !one.has_record {
            return;
        }
        one.has_record = true;
        let mut told = plan(&mut one.ledger, &mut one.maneuvers, ground, rules.ahead).granted;
        let robots: Vec<u32> = one.ledger.members().keys().copied().collect();
        for robot in &robots {
            let waited = &mut one.ledger.member_mut(*robot).unwrap().waited;
            if *waited > rules.waits {
                // The next round looks for a maneuver again.
                *waited = rules.waits.saturating_sub(1);
            }
        }
        if again {
            told.extend(robots);
        }
        let grants: Vec<Grant> = told.iter().filter_map(|robot| one.ledger.message(*robot)).collect();
        grants.into_iter().for_each(|grant| self.send(Message::Grant(grant)));
    }

    fn deliver(&mut self, message: &Message, ground: &mut Ground, rules: &Scenario) {
        match message {
            Message::Territory(robot, _) | Message::Grant(Grant { robot, .. })
                if self.robots[*robot as usize - 1].is_gone => {}
            Message::Gone(zone, robot, incarnation) => {
                self.network.retain(|other| other != message);
                let Some(zone) = self.place(*zone) else { return };
                // A robot that the zone heard of since then is back.
                let known = self.zones[zone].ledger.member(*robot);
                if known.is_none_or(|known| known.request.incarnation <= *incarnation) {
                    self.zones[zone].ledger.end(*robot, *incarnation);
                    self.zones[zone].unheard.remove(robot);
                    self.plan(zone, false, ground, rules);
                }
            }
            Message::Territory(robot, territory) => {
                let robot = *robot as usize - 1;
                self.robots[robot].passage.hear_territory(territory);
                self.answer(robot);
            }
            Message::Grant(grant) => {
                let robot = grant.robot as usize - 1;
                let one = &mut self.robots[robot];
                one.passage.hear(grant);
                one.moving = one.moving.or_else(|| one.passage.next());
                self.request(robot, false);
            }
            Message::Request(request) => {
                let Some(zone) = self.place(request.zone) else { return };
                let is_news = self.zones[zone].ledger.hear(request) != Heard::Nothing;
                let is_of_term = request.term == self.zones[zone].ledger.territory().term;
                if is_of_term && self.zones[zone].unheard.remove(&request.robot) || is_news {
                    self.plan(zone, false, ground, rules);
                }
            }
            Message::Clear(robot, incarnation, clear, place) => {
                let Some(zone) = self.place(clear.zone) else { return };
                let is_of_term = clear.term == self.zones[zone].ledger.territory().term;
                let is_news = is_of_term && self.zones[zone].ledger.hear_clear(*robot, *incarnation, *place);
                if is_of_term && self.zones[zone].unheard.remove(robot) || is_news {
                    self.plan(zone, false, ground, rules);
                }
            }
        }
    }

    /// Somebody starts a robot that is gone again: it enters the floor where it started at first.
    fn put_back(&self, robot: usize, rules: &Scenario) -> Option<State> {
        let (x, y) = rules.robots[robot].0;
        let start = Block::new(x, y);
        if !self.robots[robot].is_gone {
            return None;
        }
        let mut back = self.clone();
        back.faults.back -= 1;
        let one = &mut back.robots[robot];
        one.passage = Passage::entering(one.passage.robot(), one.passage.incarnation() + 1, start);
        (one.is_gone, one.at, one.moving) = (false, start, None);
        for zone in &self.zones {
            one.passage.hear_territory(zone.ledger.territory());
        }
        back.answer(robot);
        Some(back)
    }

    fn successors(&self, ground: &mut Ground, rules: &Scenario) -> Vec<State> {
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
            let mut next = self.clone();
            let one = &mut next.robots[robot];
            if let Some(to) = one.moving.take() {
                one.at = to;
                one.passage.arrive(to);
                one.moving = one.passage.next();
                next.request(robot, false);
                all.push(next);
            }
            if self.faults.gone > 0 {
                let mut taken = self.clone();
                taken.faults.gone -= 1;
                let one = &mut taken.robots[robot];
                (one.is_gone, one.moving) = (true, None);
                let number = one.passage.robot();
                let incarnation = one.passage.incarnation();
                let zones = self.zones.iter().map(|zone| zone.ledger.territory().zone);
                zones.for_each(|zone| taken.send(Message::Gone(zone, number, incarnation)));
                // Its program may have ended before.
                let mut ended = taken.clone();
                taken.robots[robot].passage.leave_floor();
                taken.request(robot, false);
                for next in [&mut taken, &mut ended] {
                    let one = &mut next.robots[robot];
                    // What it knew makes no difference any more.
                    (one.at, one.passage) = (one.goal, Passage::new(number, one.passage.incarnation(), one.goal));
                }
                all.extend([taken, ended]);
            }
            if self.faults.robots > 0 {
                let mut crashed = self.clone();
                crashed.faults.robots -= 1;
                let one = &mut crashed.robots[robot];
                one.moving = None;
                let begin = if one.is_on_floor() { Passage::new } else { Passage::entering };
                one.passage = begin(one.passage.robot(), one.passage.incarnation() + 1, one.at);
                // State topics give it the territories again.
                for zone in &self.zones {
                    one.passage.hear_territory(zone.ledger.territory());
                }
                crashed.answer(robot);
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
                let term = territory.term + 1;
                crashed.zones[zone].ledger = Ledger::new(Territory { term, ..territory });
                crashed.zones[zone].maneuvers.clear();
                crashed.zones[zone].unheard = self.everyone();
                crashed.zones[zone].has_record = false;
                crashed.announce(zone);
                all.push(crashed);
            }
        }
        all
    }
}
