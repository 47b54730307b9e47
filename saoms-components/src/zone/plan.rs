//! Which robot is granted which block next.
//!
//! A round of planning looks at the ends of all passages, where robots come to rest if nothing more is granted to them.
//! In the order of their ranks, each robot is granted the free block that leads it closest to its goal. A robot that
//! holds that block is first moved away, with the rank of the one that waits for it, and so on along a line of robots;
//! if that is not possible, the next best block is tried. This is the priority inheritance with backtracking of PIBT
//! (Okumura, Machida, Défago, Tamura, 2019) without its common time steps, and without moves into a block that is not
//! free yet.
//!
//! Before all others come robots that want to enter the floor: a robot on their block is moved away.
//!
//! Into a dead end no robot goes on while another one comes out of it, which is served first: else more and more robots
//! would queue in it, and none could leave.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::ground::Ground;
use super::ledger::{Ledger, Member};
use super::maneuver::Maneuver;
use crate::grid::{Block, MOVE, UNREACHABLE};
use crate::messages::Standing;
use crate::precedence::Precedence;

/// Maximum number of robots that are moved away for one.
const LINE: u32 = 64;

/// A round of planning.
pub(crate) struct Round<'z> {
    ledger: &'z mut Ledger,
    ground: &'z mut Ground,
    /// Robots on blocks of other zones, close to this one.
    outside: BTreeMap<Block, u32>,
    /// Robots for which this round has decided.
    decided: BTreeSet<u32>,
    /// Robots that still have to move in maneuvers.
    busy: BTreeSet<u32>,
    /// Blocks of maneuvers, which others do not enter.
    taken: BTreeSet<Block>,
    /// Robots to which something was granted.
    granted: BTreeSet<u32>,
    /// True if a robot that makes way in this line has to do so over the edge.
    leads_over_edge: bool,
    /// Robots for which another one has to make way over the edge.
    waits_over_edge: BTreeSet<u32>,
    /// Number of blocks that are granted ahead of a robot.
    ahead: usize,
}

/// Robot for which another one makes way.
#[derive(Clone, Copy)]
struct Asker {
    /// Where it wants to go.
    goal: Block,
    /// The rank of its way.
    rank: u64,
}

/// What comes of a wish to have a block.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// It is granted.
    Granted,
    /// Its holder leaves it.
    Waits,
    /// Its holder cannot leave it.
    Refused,
}

/// Number of rounds after which a robot that nobody can make way for is helped by a maneuver. If there is none, it is
/// looked for again after twice as many rounds.
const PATIENCE: u32 = 4;

/// The same where another robot was told to make way over the edge: until the zone over there has heard of that, and
/// its robots have made room, a maneuver would take back what they do.
const PATIENCE_OVER_EDGE: u32 = 16;

/// Maximum number of blocks that are granted ahead of a robot.
const MOST_AHEAD: u32 = 16;

/// Maximum number of searches for a maneuver in one round.
const SEARCHES: usize = 2;

/// What a round of planning changed.
#[derive(Debug, Default)]
pub(crate) struct Planned {
    /// Robots to which something was granted.
    pub(crate) granted: BTreeSet<u32>,
    /// Robots to which the zone has something else to tell: they wait for another robot than before or for none any
    /// more, or have to make way over the edge to another block than before or to none any more.
    pub(crate) told: BTreeSet<u32>,
}

/// Plans a round: grants blocks, and notes which robots wait for which.
pub(crate) fn plan(ledger: &mut Ledger, maneuvers: &mut Vec<Maneuver>, ground: &mut Ground, ahead: usize) -> Planned {
    let mut granted = BTreeSet::new();
    ledger.forget_waits();
    let asides = ledger.take_asides();
    let order = order(ledger, ground);
    maneuvers.retain_mut(|maneuver| !is_outranked(maneuver, ledger, &order) && maneuver.go_on(ledger, &mut granted));
    let (busy, taken): (BTreeSet<u32>, BTreeSet<Block>) = maneuvers.iter().flat_map(Maneuver::concerns).unzip();
    let outside = ledger.outside();
    let mut round = Round {
        ledger,
        ground,
        outside,
        decided: busy.clone(),
        busy,
        taken,
        granted,
        leads_over_edge: false,
        waits_over_edge: BTreeSet::new(),
        ahead,
    };
    let mut told = round.admit();
    for robot in &order {
        round.serve(*robot);
    }
    for robot in &order {
        round.extend(*robot);
    }
    if let Some(maneuver) = round.maneuver(&order) {
        maneuvers.push(maneuver);
    }
    told.extend(order.iter().copied().filter(|robot| round.note_wait(*robot)));
    let has_changed = |(robot, member): &(&u32, &Member)| member.aside != asides.get(robot).copied();
    told.extend(round.ledger.members().iter().filter(has_changed).map(|(robot, _)| *robot));
    Planned { granted: round.granted, told }
}

/// The robots that want to go somewhere, in the order in which they are served: by their ranks, and first of all those
/// that come out of a dead end into which others want to go.
fn order(ledger: &Ledger, ground: &Ground) -> Vec<u32> {
    let going = || ledger.members().iter().filter(|(_, member)| member.wants_to_go());
    let first: BTreeSet<u32> = going()
        .filter_map(|(robot, member)| Some((*robot, ground.dead_ends().door(member.end(), member.request.goal)?)))
        .flat_map(|(robot, door)| coming_out(ledger, ground, door, robot))
        .collect();
    let mut order: Vec<(bool, Reverse<u64>, u32)> =
        going().map(|(robot, member)| (!first.contains(robot), Reverse(member.request.rank), *robot)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, _, robot)| robot).collect()
}

/// The robots that come out of a part of a dead end into which this robot wants to go through a block of it, also those
/// that only want to another part of the same dead end. If the block before it is one of another zone, over which this
/// zone cannot send a robot away again, also those that are still busy in there.
fn coming_out(ledger: &Ledger, ground: &Ground, door: Block, robot: u32) -> impl Iterator<Item = u32> {
    let dead_ends = ground.dead_ends();
    let there = ledger.member(robot).map_or(door, |member| member.request.goal);
    let way_out = dead_ends.way_out(there);
    let is_edge = dead_ends.out(door).is_some_and(|out| !ledger.territory().contains(out));
    let leaves = move |member: &Member| {
        let (goal, end) = (member.request.goal, member.end());
        if !dead_ends.is_behind(end, door) {
            return false;
        }
        let is_busy = is_edge && (member.wants_to_go() || member.request.standing == Standing::Stays);
        // Where the ways of both meet: there they cannot get past each other.
        let meeting = dead_ends.meeting(end, &way_out).unwrap_or(door);
        is_busy || member.wants_to_go() && !dead_ends.is_behind(goal, meeting)
    };
    let others = ledger.members().iter().filter(move |(other, member)| **other != robot && leaves(member));
    others.map(|(other, _)| *other)
}

/// True if no robot has moved yet, and one outside that has to is served before the robot that gets on: its own zone
/// thinks of it. So two zones do not wait for each other's moves.
fn is_outranked(maneuver: &Maneuver, ledger: &Ledger, order: &[u32]) -> bool {
    let place = |robot: u32| order.iter().position(|other| *other == robot);
    let is_outside = |robot: u32| ledger.member(robot).is_none_or(|member| !ledger.territory().contains(member.end()));
    let first = place(maneuver.robot());
    let is_before = |robot: u32| place(robot).is_some_and(|place| first.is_none_or(|first| place < first));
    !maneuver.has_begun() && maneuver.concerns().any(|(robot, _)| is_outside(robot) && is_before(robot))
}

impl Round<'_> {
    /// Grants robots the block where they want to enter the floor, if it is free; else its holder is asked to leave.
    /// Returns those that wait for another robot than before.
    fn admit(&mut self) -> BTreeSet<u32> {
        let territory = self.ledger.territory();
        let waits = |member: &Member| member.waits_to_enter() && territory.contains(member.request.block);
        let members = self.ledger.members().iter().filter(|(_, member)| waits(member));
        let entering: Vec<(u32, Block)> = members.map(|(robot, member)| (*robot, member.request.block)).collect();
        let mut waiting = BTreeSet::new();
        for (robot, block) in entering {
            let holder = self.ledger.holder(block);
            if let Some(holder) = holder {
                self.ask(holder, block, Asker { goal: block, rank: u64::MAX }, LINE);
            } else if !self.taken.contains(&block) && self.ledger.grant(robot, block) {
                self.granted.insert(robot);
            }
            let in_the_way = holder.map(|holder| (block, holder));
            let rule = holder.map_or(Precedence::There, |holder| self.ledger.rule_of_holder(holder, block));
            if let Some(member) = self.ledger.member_mut(robot) {
                member.rule = rule;
                if std::mem::replace(&mut member.in_the_way, in_the_way) != in_the_way {
                    waiting.insert(robot);
                }
            }
        }
        waiting
    }

    /// True if the passage of a robot ends in this zone.
    fn is_inside(&self, robot: u32) -> bool {
        self.ledger.member(robot).is_some_and(|member| self.ledger.territory().contains(member.end()))
    }

    /// Grants a robot its next block, unless it still has one ahead.
    fn serve(&mut self, robot: u32) {
        let Some(member) = self.ledger.member(robot) else { return };
        if self.decided.contains(&robot) || member.steps.len() > 2 || member.is_cut() {
            return;
        }
        self.leads_over_edge = false;
        let outcome = self.advance(robot, None, LINE);
        if self.leads_over_edge {
            self.waits_over_edge.insert(robot);
        }
        // How long a robot of another zone waits, that zone counts.
        if outcome != Outcome::Granted
            && self.is_inside(robot)
            && let Some(member) = self.ledger.member_mut(robot)
        {
            member.waited = member.waited.saturating_add(1);
        }
    }

    /// Looks for a maneuver for the first robot for which nobody can make way.
    fn maneuver(&mut self, order: &[u32]) -> Option<Maneuver> {
        let is_stuck = |robot: &u32| {
            let Some(member) = self.ledger.member(*robot) else { return false };
            // One that others come out to would push them back; of one in another zone that zone thinks.
            let has_right =
                self.is_inside(*robot) && self.comes_out(*robot, member.end(), member.request.goal).is_none();
            let waited = member.waited;
            let patience = if self.waits_over_edge.contains(robot) { PATIENCE_OVER_EDGE } else { PATIENCE };
            waited >= patience && waited.is_power_of_two() && !self.busy.contains(robot) && has_right
        };
        let stuck: Vec<u32> = order.iter().copied().filter(is_stuck).take(SEARCHES).collect();
        let find = |robot| Maneuver::find(robot, (&*self.ledger, &self.outside), self.ground, &self.taken);
        let may_begin = |maneuver: &Maneuver| !is_outranked(maneuver, self.ledger, order);
        let mut maneuver = stuck.into_iter().filter_map(find).find(may_begin)?;
        maneuver.go_on(self.ledger, &mut self.granted).then_some(maneuver)
    }

    /// Extends the passage of a robot. One that makes way for another, on the way to that one's goal, moves anywhere,
    /// with the rank of that one; one that goes to its goal moves closer to it.
    fn advance(&mut self, robot: u32, makes_way: Option<Asker>, line: u32) -> Outcome {
        self.decided.insert(robot);
        let Some(member) = self.ledger.member(robot) else { return Outcome::Refused };
        if member.request.standing != Standing::MakesWay || line == 0 {
            return Outcome::Refused;
        }
        if member.is_cut() {
            return Outcome::Waits;
        }
        let (end, goal) = (member.end(), member.request.goal);
        let asker = makes_way.unwrap_or(Asker { goal, rank: member.request.rank });
        let is_inside = self.ledger.territory().contains(end);
        let mut held_outside = None;
        for block in self.candidates(robot, end, goal, makes_way.map(|asker| asker.goal)) {
            if !self.ledger.territory().contains(block) {
                // The zone over there decides.
                let Some(Asker { rank, .. }) = makes_way.filter(|_| is_inside) else { return Outcome::Waits };
                if let Some(holder) = self.outside.get(&block).copied() {
                    // Its zone lets it make way, if it goes behind the one for which this robot does.
                    let member = self.ledger.member(holder).filter(|_| !self.decided.contains(&holder));
                    if member.is_some_and(|member| member.request.rank < rank) {
                        held_outside.get_or_insert((block, rank));
                    }
                    continue;
                }
                if let Some(member) = self.ledger.member_mut(robot) {
                    member.aside = Some((block, rank));
                    self.leads_over_edge = true;
                }
                return Outcome::Waits;
            }
            let outcome = match self.ledger.holder(block) {
                None if self.ledger.grant(robot, block) => {
                    self.granted.insert(robot);
                    Outcome::Granted
                }
                Some(holder) if holder != robot => self.ask(holder, block, asker, line),
                _ => Outcome::Refused,
            };
            if outcome != Outcome::Refused {
                return outcome;
            }
        }
        match self.ledger.member_mut(robot).filter(|_| held_outside.is_some()) {
            Some(member) => {
                member.aside = held_outside;
                self.leads_over_edge = true;
                Outcome::Waits
            }
            None => Outcome::Refused,
        }
    }

    /// Asks the holder of a block to leave it to another robot. One that rests there with a higher rank stays.
    fn ask(&mut self, holder: u32, block: Block, asker: Asker, line: u32) -> Outcome {
        let Some(member) = self.ledger.member(holder) else { return Outcome::Refused };
        if member.end() != block {
            // It is on its way to the end of its passage, which nobody can take from it.
            return Outcome::Waits;
        }
        let stays = !member.wants_to_go() && member.request.rank > asker.rank;
        if stays || self.decided.contains(&holder) {
            return Outcome::Refused;
        }
        match self.advance(holder, Some(asker), line - 1) {
            Outcome::Refused => Outcome::Refused,
            Outcome::Granted | Outcome::Waits => Outcome::Waits,
        }
    }

    /// The robot that comes out of the dead end with a goal of another one, if that is beside it or in it, and has to
    /// wait; and the block over which it comes.
    fn comes_out(&self, robot: u32, end: Block, goal: Block) -> Option<(Block, u32)> {
        let door = self.ground.dead_ends().door(end, goal)?;
        coming_out(self.ledger, self.ground, door, robot).next().map(|other| (door, other))
    }

    /// True if another robot comes out of the dead end into which this block leads from the end of a passage.
    fn is_kept_free(&self, robot: u32, (end, block, goal): (Block, Block, Block)) -> bool {
        let door = self.ground.dead_ends().door_behind(end, block, goal);
        door.is_some_and(|door| coming_out(self.ledger, self.ground, door, robot).next().is_some())
    }

    /// The blocks beside the end of a robot's passage, the best first.
    fn candidates(&mut self, robot: u32, end: Block, goal: Block, makes_way: Option<Block>) -> Vec<Block> {
        let here = self.ground.cost(end, goal);
        let mut candidates: Vec<(u32, bool, Block)> = Vec::with_capacity(4);
        for block in end.neighbours() {
            if !self.ground.is_free(block) || self.taken.contains(&block) {
                continue;
            }
            let cost = self.ground.cost(block, goal);
            let is_deeper = self.ground.dead_ends().out(block) == Some(end);
            let is_in_vain = match makes_way {
                // The other one wants to go there, too.
                Some(other) => is_deeper && self.ground.dead_ends().is_behind(other, block),
                None => cost >= here || cost == UNREACHABLE || self.is_kept_free(robot, (end, block, goal)),
            };
            if is_in_vain {
                continue;
            }
            let is_outside = !self.ledger.territory().contains(block);
            let holder = self.ledger.holder(block);
            let is_held = holder.is_some() || self.outside.contains_key(&block);
            // What lies on the passage of a robot that is still far away stays held for long.
            let moves = holder.and_then(|holder| self.ledger.member(holder)).map_or(0, |other| other.moves_to(block));
            // One that makes way deeper into a dead end soon comes out again, and asks in its turn.
            let comes_back = makes_way.is_some() && is_deeper;
            let held = if is_held { MOVE / 2 + moves * MOVE } else { 0 };
            let worse = held + if comes_back { 2 * MOVE } else { 0 };
            // Over the edge another zone has to agree.
            let worse = worse + if makes_way.is_some() && is_outside { 2 * MOVE } else { 0 };
            candidates.push((cost.saturating_add(worse), is_held, block));
        }
        candidates.sort_unstable();
        candidates.into_iter().map(|(_, _, block)| block).collect()
    }

    /// Notes for which robot this one waits; `true` if it waited for another one before, or for none.
    fn note_wait(&mut self, robot: u32) -> bool {
        let Some(member) = self.ledger.member(robot) else { return false };
        let (end, goal) = (member.end(), member.request.goal);
        // A robot that can still drive does not wait.
        let waits = (member.waited > 0 || !self.is_inside(robot)) && member.steps.len() < 2;
        let best = if waits { self.candidates(robot, end, goal, None).into_iter().next() } else { None };
        let in_the_way = match best {
            Some(block) => self.ledger.holder(block).map(|holder| (block, holder)),
            None if waits => self.comes_out(robot, end, goal),
            None => None,
        };
        let rule = match in_the_way {
            Some((block, holder)) if best.is_some() => self.ledger.rule_of_holder(holder, block),
            _ => Precedence::ComesOut,
        };
        let Some(member) = self.ledger.member_mut(robot) else { return false };
        // What robots hear does not have it.
        member.rule = rule;
        std::mem::replace(&mut member.in_the_way, in_the_way) != in_the_way
    }

    /// Grants a robot further blocks ahead: those that it needs so that it does not wait for grants, and some more
    /// where no other robot is near.
    fn extend(&mut self, robot: u32) {
        while let Some(member) = self.ledger.member(robot)
            && !self.busy.contains(&robot)
            && member.wants_to_go()
            && !member.steps.is_empty()
            && !member.is_cut()
        {
            let (end, goal) = (member.end(), member.request.goal);
            let is_needed = member.steps.len() <= member.request.ahead.min(MOST_AHEAD) as usize;
            if !is_needed && member.steps.len() > self.ahead {
                return;
            }
            let best = self.candidates(robot, end, goal, None).into_iter().next();
            let Some(block) = best.filter(|block| is_needed || self.is_quiet(*block, robot)) else { return };
            if !self.ledger.grant(robot, block) {
                return;
            }
            self.granted.insert(robot);
        }
    }

    /// True if no other robot holds a block beside this one.
    fn is_quiet(&self, block: Block, robot: u32) -> bool {
        let others = |block: &Block| self.ledger.holder(*block).is_some_and(|holder| holder != robot);
        !block.neighbours().iter().any(others)
    }
}
