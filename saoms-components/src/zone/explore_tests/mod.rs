//! Exhaustive exploration of the protocol between zones and robots: every order of sending and delivering messages, of
//! moves, and of crashes, on tiny maps. Each message may be lost, come late and come again, any number of times.
//!
//! In each state that can be reached no two robots hold the same block, and from each state all robots can still reach
//! their goals.

mod mixer;
mod numbering;
mod over;
mod part;
mod scenarios;
mod state;

use std::collections::{BTreeSet, HashMap};
use std::hash::{BuildHasherDefault, Hash, Hasher};

use super::ground::Ground;
use super::ledger::Ledger;
use super::passage::Passage;
use crate::grid::{Block, Map};
use crate::messages::Territory;
use mixer::Mixer;
use state::{Message, Robot, State, Zone};

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
            zones: zones.map(Into::into).collect(),
            robots: fleet.map(Into::into).collect(),
            network: Vec::new(),
            faults: self.faults,
            arriving: self.arriving,
            drawings: 0,
            asks: self.asks,
        };
        for zone in 0..state.zones.len() {
            let territory = state.zones[zone].ledger.territory().clone();
            state.robots.iter_mut().for_each(|robot| robot.change().passage.hear_territory(&territory));
        }
        (0..state.robots.len()).for_each(|robot| state.answer(robot));
        for message in std::mem::take(&mut state.network) {
            match &*message {
                Message::Request(request) => {
                    let zone = state.zones[request.zone as usize - 1].change();
                    zone.ledger.hear(request);
                    zone.unheard.remove(&request.robot);
                }
                Message::Clear(robot, _, clear, _) => {
                    state.zones[clear.zone as usize - 1].change().unheard.remove(robot);
                }
                Message::Territory(..) | Message::Grant(_) | Message::Gone(..) => {}
            }
        }
        state.settle();
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
            if state.is_done() {
                done.push(number);
            }
            for mut next in state.successors(&mut ground, self) {
                next.settle();
                let place = *known.entry(hash(&next)).or_insert_with(|| {
                    let place = u32::try_from(before.len()).unwrap();
                    before.push(Vec::new());
                    open.push((place, next));
                    place
                });
                if place != number {
                    before[place as usize].push(number);
                }
            }
            assert!(before.len() < 100_000, "{}: too many states", self.name);
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
