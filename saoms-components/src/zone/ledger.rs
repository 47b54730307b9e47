use std::collections::BTreeMap;

use crate::grid::Block;
use crate::messages::{Grant, GrantRequest, LAST_NUMBER, Standing, Step, Territory, address, link};
use crate::precedence::Precedence;

/// A zone's record of grants: which robot holds which of its blocks.
///
/// It is the part of the protocol on which safety rests: a block is granted only while no robot holds it, and a robot
/// holds it until it has said that it released it. It has no clock and no chance.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Ledger {
    territory: Territory,
    members: BTreeMap<u32, Member>,
    /// The robot that holds each block of the territory, row by row; 0 for none.
    holders: Vec<u32>,
    /// True if two robots held one block at some time: somebody put one of them there.
    contested: bool,
}

/// Number of rounds after which a robot that could go on, and says nothing, counts as an obstacle.
const SILENT: u32 = 200;

/// A robot, as a zone knows it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Member {
    /// Its newest request.
    pub(crate) request: GrantRequest,
    /// Steps that were granted and not released, in their order.
    pub(crate) steps: Vec<Step>,
    /// Number of the last step that was granted.
    pub(crate) granted: u64,
    /// Number of rounds of planning in which it wanted to go on from a block of the zone, and its passage did not grow.
    pub(crate) waited: u32,
    /// Number of rounds of planning in which it did not say anything new, although it could go on.
    pub(crate) silent: u32,
    /// The block that it wants next, and the robot that holds it, while it waits for that.
    pub(crate) in_the_way: Option<(Block, u32)>,
    /// Why that robot goes first.
    pub(crate) rule: Precedence,
    /// A block of another zone to which it has to make way, and the rank of the robot for which it does.
    pub(crate) aside: Option<(Block, u64)>,
}

impl Member {
    pub(crate) fn new(request: GrantRequest, steps: Vec<Step>, granted: u64) -> Member {
        Member { request, steps, granted, waited: 0, silent: 0, in_the_way: None, rule: Precedence::There, aside: None }
    }

    /// End of the robot's passage: the newest step that the robot has not heard of yet, else where the robot says that
    /// it is, which may be in another zone.
    pub(crate) fn end(&self) -> Block {
        let unheard = self.steps.last().filter(|_| self.request.received < self.granted);
        unheard.map_or(self.request.end, |step| step.block)
    }

    /// True if it released a block behind which others are granted that it has not heard of yet: it cannot get to them,
    /// and releases them, too.
    pub(crate) fn is_cut(&self) -> bool {
        let unheard = self.steps.iter().find(|step| step.number > self.request.received);
        unheard.is_some_and(|step| step.block.distance(self.request.end) > 1)
    }

    /// Number of moves after which it is on a block of the zone, on its way to the end of its passage; 0 if it is
    /// there, or stays there.
    pub(crate) fn moves_to(&self, block: Block) -> u32 {
        let is_passed = self.end() != block;
        let place = self.steps.iter().position(|step| step.block == block).filter(|_| is_passed);
        u32::try_from(place.unwrap_or(0)).unwrap_or(u32::MAX)
    }

    /// True if it stands on one block, and its passage ends there.
    pub(crate) fn is_at_rest(&self) -> bool {
        self.steps.len() < 2 && self.request.block == self.end()
    }

    /// True if others have to drive around it: it cannot move any more, or could go on and says nothing for long.
    pub(crate) fn is_obstacle(&self) -> bool {
        self.request.standing == Standing::Lost || self.silent > SILENT
    }

    /// The blocks of the zone that it holds.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = Block> {
        self.steps.iter().map(|step| step.block)
    }

    /// True if somebody took it off the floor, and it has not begun anew.
    pub(crate) fn is_over(&self) -> bool {
        self.request.number == LAST_NUMBER
    }

    /// True if it is not on the floor, and waits until it may enter it at its block.
    pub(crate) fn waits_to_enter(&self) -> bool {
        self.request.standing == Standing::Enters && self.steps.is_empty()
    }

    /// True if it wants to go somewhere else.
    pub(crate) fn wants_to_go(&self) -> bool {
        self.request.standing == Standing::MakesWay && self.request.goal != self.end()
    }
}

/// What a request meant to a zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Heard {
    /// It said nothing new, or is of an earlier time.
    Nothing,
    /// It changed what the zone knows.
    News,
    /// It holds a block that the zone granted to another robot: somebody put it there.
    Conflict {
        /// The block.
        block: Block,
        /// The robot to which it was granted.
        other: u32,
    },
}

impl Ledger {
    /// The record of a zone that granted nothing yet.
    pub(crate) fn new(territory: Territory) -> Ledger {
        let size = territory.width as usize * territory.height as usize;
        Ledger { territory, members: BTreeMap::new(), holders: vec![0; size], contested: false }
    }

    /// The same record as an earlier one.
    pub(crate) fn with(territory: Territory, members: BTreeMap<u32, Member>) -> Ledger {
        let mut ledger = Ledger { members, ..Ledger::new(territory) };
        let held: Vec<(Block, u32)> = ledger
            .members
            .iter()
            .flat_map(|(robot, member)| member.steps.iter().map(|step| (step.block, *robot)))
            .collect();
        held.into_iter().for_each(|(block, robot)| ledger.hold(block, robot));
        ledger
    }

    pub(crate) fn territory(&self) -> &Territory {
        &self.territory
    }

    pub(crate) fn members(&self) -> &BTreeMap<u32, Member> {
        &self.members
    }

    pub(crate) fn member(&self, robot: u32) -> Option<&Member> {
        self.members.get(&robot)
    }

    /// The component of a robot failed: it cannot move any more, until it says something new. If it is known on which
    /// of its blocks it was stopped, or that it is in another zone, the others are free: nobody is left to enter them.
    pub(crate) fn stop(&mut self, robot: u32, at: Option<Block>) {
        let Some(member) = self.members.get_mut(&robot) else { return };
        member.request.standing = Standing::Lost;
        let steps = &member.steps;
        let is_its = |at: &Block| steps.iter().any(|step| step.block == *at) || !self.territory.contains(*at);
        let Some(at) = at.filter(is_its) else { return };
        // It stands there, and its passage ends there.
        let request = &mut member.request;
        (request.block, request.end, request.goal) = (at, at, at);
        let (kept, freed): (Vec<Step>, Vec<Step>) = member.steps.iter().partition(|step| step.block == at);
        member.steps = kept;
        for step in &freed {
            self.free(step.block, robot);
        }
    }

    /// Begins this term, or the next one: robots ignore grants of earlier terms, and say what they hold. Whatever they
    /// say next counts, also if the clock, which gives their incarnations, went back meanwhile. Those that say nothing
    /// keep their blocks.
    pub(crate) fn begin_term(&mut self, term: u64) {
        self.territory.term = term.max(self.territory.term.saturating_add(1));
        self.members.values_mut().for_each(|member| member.request.incarnation = 0);
    }

    pub(crate) fn member_mut(&mut self, robot: u32) -> Option<&mut Member> {
        self.members.get_mut(&robot)
    }

    fn place(&self, block: Block) -> Option<usize> {
        let Territory { corner, width, .. } = self.territory;
        let (x, y) = (block.x.checked_sub(corner.x)?, block.y.checked_sub(corner.y)?);
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        (x < width as usize).then(|| y * width as usize + x).filter(|place| *place < self.holders.len())
    }

    /// The robot that holds a block of the territory.
    pub(crate) fn holder(&self, block: Block) -> Option<u32> {
        self.place(block).map(|place| self.holders[place]).filter(|robot| *robot != 0)
    }

    /// Why the holder of a block goes before others that want it.
    pub(crate) fn rule_of_holder(&self, holder: u32, block: Block) -> Precedence {
        let Some(Member { request, .. }) = self.members.get(&holder) else { return Precedence::Granted };
        match request.standing {
            _ if request.block != block => Precedence::Granted,
            Standing::Lost => Precedence::Lost,
            Standing::Stays => Precedence::Stays,
            Standing::MakesWay | Standing::Enters => Precedence::There,
        }
    }

    /// The robots that stand on blocks of other zones close to this one, or go there, with these blocks.
    pub(crate) fn outside(&self) -> BTreeMap<Block, u32> {
        let mut outside = BTreeMap::new();
        for (robot, member) in &self.members {
            let request = &member.request;
            if !member.is_over() && request.standing != Standing::Enters {
                let blocks = [request.block, request.end].into_iter();
                outside.extend(blocks.filter(|block| self.is_near(*block)).map(|block| (block, *robot)));
            }
        }
        outside
    }

    /// True if the block is in another zone, and robots there tell this one where they are.
    pub(crate) fn is_near(&self, block: Block) -> bool {
        !self.territory.contains(block) && self.territory.is_near(block)
    }

    fn hold(&mut self, block: Block, robot: u32) {
        let Some(place) = self.place(block) else { return };
        match self.holders[place] {
            0 => self.holders[place] = robot,
            other => self.contested |= other != robot,
        }
    }

    /// Frees a block, or gives it to another robot that stands there.
    fn free(&mut self, block: Block, robot: u32) {
        let Some(place) = self.place(block).filter(|place| self.holders[*place] == robot) else { return };
        let stands_there = |(_, member): &(&u32, &Member)| member.steps.iter().any(|step| step.block == block);
        let other = if self.contested { self.members.iter().find(stands_there) } else { None };
        self.holders[place] = other.map_or(0, |(other, _)| *other);
    }

    /// Forgets for how long robots waited that do not want to go anywhere from a block of the territory.
    pub(crate) fn forget_waits(&mut self) {
        let Ledger { territory, members, .. } = self;
        let waits = |member: &Member| member.wants_to_go() && territory.contains(member.end());
        members.values_mut().filter(|member| !waits(member)).for_each(|member| member.waited = 0);
    }

    /// Forgets which robots have to make way over the edge, and returns that.
    pub(crate) fn take_asides(&mut self) -> BTreeMap<u32, (Block, u64)> {
        let members = self.members.iter_mut();
        members.filter_map(|(robot, member)| Some((*robot, member.aside.take()?))).collect()
    }

    /// Takes in a request.
    pub(crate) fn hear(&mut self, request: &GrantRequest) -> Heard {
        if request.zone != self.territory.zone || request.term != self.territory.term || request.robot == 0 {
            return Heard::Nothing;
        }
        match self.members.get(&request.robot) {
            Some(known) if request.incarnation < known.request.incarnation => Heard::Nothing,
            Some(known) if request.incarnation == known.request.incarnation => self.hear_again(request),
            _ => self.adopt(request),
        }
    }

    /// Takes in a request of a robot that is known.
    fn hear_again(&mut self, request: &GrantRequest) -> Heard {
        let Some(member) = self.members.get_mut(&request.robot) else { return Heard::Nothing };
        let is_held = |step: &Step| step.number > request.received || request.held.contains(step);
        let (kept, released): (Vec<Step>, Vec<Step>) = member.steps.iter().partition(|step| is_held(step));
        member.steps = kept;
        member.silent = 0;
        let is_newer = request.number > member.request.number;
        if is_newer {
            member.request = request.clone();
            // In an earlier term it received steps with higher numbers, and takes none with lower ones.
            if request.received != LAST_NUMBER {
                member.granted = member.granted.max(request.received);
            }
        }
        for step in &released {
            self.free(step.block, request.robot);
        }
        if is_newer || !released.is_empty() { Heard::News } else { Heard::Nothing }
    }

    /// Takes in the first request of a robot, or of its new incarnation: the earlier one holds nothing any more.
    fn adopt(&mut self, request: &GrantRequest) -> Heard {
        self.forget(request.robot);
        let steps: Vec<Step> =
            request.held.iter().copied().filter(|step| self.territory.contains(step.block)).collect();
        let other = |step: &Step| self.holder(step.block).map(|other| Heard::Conflict { block: step.block, other });
        let conflict = steps.iter().find_map(other);
        for step in &steps {
            self.hold(step.block, request.robot);
        }
        let granted = steps.iter().map(|step| step.number).max().unwrap_or(0).max(request.received);
        self.members.insert(request.robot, Member::new(request.clone(), steps, granted));
        conflict.unwrap_or(Heard::News)
    }

    /// Takes in that this incarnation of a robot held nothing in this term when it began, or later, and where it and
    /// the end of its passage were then. What it held in earlier ones is free. False if the zone has heard of this
    /// incarnation before.
    pub(crate) fn hear_clear(&mut self, robot: u32, incarnation: u64, (block, end): (Block, Block)) -> bool {
        let Some(known) = self.members.get(&robot).filter(|known| known.request.incarnation < incarnation) else {
            return false;
        };
        // It stays known, so that a late request of an earlier incarnation means nothing.
        let request = GrantRequest {
            incarnation,
            number: 0,
            at: self.territory.closest(block),
            block,
            end,
            received: 0,
            held: Vec::new(),
            goal: end,
            rank: 0,
            standing: Standing::MakesWay,
            ahead: 0,
            ..known.request.clone()
        };
        self.adopt(&request);
        true
    }

    /// Counts the round for robots that could go on and say nothing.
    pub(crate) fn end_round(&mut self) {
        for member in self.members.values_mut().filter(|member| member.steps.len() > 1) {
            member.silent = member.silent.saturating_add(1);
        }
    }

    /// Somebody took a robot off the floor: this is the last word of its incarnation, and releases all of its blocks.
    /// What it said before and what arrives late means nothing any more. The incarnation is needed where the zone has
    /// no request of the robot; 0 if it is not known.
    pub(crate) fn end(&mut self, robot: u32, incarnation: u64) {
        let Territory { zone, term, corner, .. } = self.territory;
        let known = self.members.get(&robot).map(|member| member.request.clone());
        let Some(known) = known.or_else(|| {
            let (end, link) = (corner, link(zone, robot));
            let request =
                GrantRequest { link, zone, term, robot, at: corner, block: corner, end, ..Default::default() };
            (incarnation > 0).then_some(GrantRequest { charger: corner, ..request })
        }) else {
            return;
        };
        self.forget(robot);
        let last = GrantRequest {
            incarnation: incarnation.max(known.incarnation),
            number: LAST_NUMBER,
            received: LAST_NUMBER,
            held: Vec::new(),
            goal: known.end,
            rank: 0,
            standing: Standing::MakesWay,
            ahead: 0,
            ..known
        };
        self.members.insert(robot, Member::new(last, Vec::new(), LAST_NUMBER));
    }

    /// True if somebody took this incarnation of a robot off the floor.
    pub(crate) fn has_ended(&self, robot: u32, incarnation: u64) -> bool {
        self.members.get(&robot).is_some_and(|member| member.is_over() && incarnation <= member.request.incarnation)
    }

    /// Forgets a robot; its blocks are free.
    fn forget(&mut self, robot: u32) {
        let Some(member) = self.members.remove(&robot) else { return };
        for step in &member.steps {
            self.free(step.block, robot);
        }
    }

    /// Grants a block of the territory to a robot; `false` if a robot holds it.
    pub(crate) fn grant(&mut self, robot: u32, block: Block) -> bool {
        let Some(place) = self.place(block).filter(|place| self.holders[*place] == 0) else { return false };
        let Some(member) = self.members.get_mut(&robot) else { return false };
        self.holders[place] = robot;
        member.granted = member.granted.saturating_add(1);
        member.steps.push(Step { number: member.granted, block });
        member.waited = 0;
        true
    }

    /// The message that tells a robot what is granted to it.
    pub(crate) fn message(&self, robot: u32) -> Option<Grant> {
        let Member { request, steps, in_the_way, aside, .. } = self.members.get(&robot)?;
        let Territory { zone, term, .. } = self.territory;
        Some(Grant {
            link: link(zone, robot),
            zone,
            term,
            robot,
            incarnation: request.incarnation,
            heard: request.number,
            address: address(robot),
            steps: steps.clone(),
            waits_for: in_the_way.map_or(0, |(_, other)| other),
            wanted: in_the_way.map_or(request.end, |(block, _)| block),
            aside: aside.map_or(request.end, |(block, _)| block),
            // The lowest rank is 0, which says there that it need not.
            aside_rank: aside.map_or(0, |(_, rank)| rank.max(1)),
        })
    }
}
