use super::territories::Territories;
use crate::grid::Block;
use crate::messages::{ClearTerm, Grant, GrantRequest, LAST_NUMBER, Standing, Step, Territory, link};

/// The blocks that a robot may enter: its part of the protocol.
///
/// The first block is the one where the robot is. It enters the second one only because a zone granted it, and releases
/// the first one when it has left it. A robot that is not on the floor yet holds nothing: it enters the floor at the
/// first block once a zone has granted that.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Passage {
    robot: u32,
    incarnation: u64,
    held: Vec<Held>,
    /// True if the robot is not on the floor, and waits for the grant of the first block.
    enters: bool,
    /// The zones that the robot knows.
    territories: Territories,
    /// The zones to which it has spoken, also former ones.
    links: Vec<Link>,
    /// The end of the passage and the charger for which links were made.
    linked: Option<(Block, Block)>,
}

/// A block that the robot holds, with its zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Held {
    /// Number of the zone; 0 for a block whose zone is not known yet.
    pub(crate) zone: u32,
    pub(crate) step: Step,
}

/// What the robot and one zone know of each other. Numbers grow also where the zone is another one than before.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Link {
    pub(crate) territory: Territory,
    /// Highest number of a step that was received.
    pub(crate) received: u64,
    /// The newest request.
    pub(crate) said: GrantRequest,
    /// Number of the newest request that the zone took in.
    pub(crate) heard: u64,
}

/// Where a robot wants to go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wish {
    /// Block where it wants to go; `None` if it wants to stay.
    pub(crate) goal: Option<Block>,
    /// Block of its charger.
    pub(crate) charger: Block,
    /// Rank of its way.
    pub(crate) rank: u64,
    /// What it does when another robot wants its block.
    pub(crate) standing: Standing,
    /// Number of blocks that it needs granted ahead, so that it does not wait for grants.
    pub(crate) ahead: u32,
    /// A block of another zone to which it makes way, and the rank of the robot for which it does.
    pub(crate) aside: Option<(Block, u64)>,
}

impl Link {
    /// True if the zone is no former one.
    fn is_open(&self, territories: &Territories) -> bool {
        territories.known().contains(&self.territory)
    }
}

impl Passage {
    /// The passage of a robot that wants to enter the floor at a block.
    pub(crate) fn entering(robot: u32, incarnation: u64, block: Block) -> Passage {
        Passage { enters: true, ..Passage::new(robot, incarnation, block) }
    }

    /// The passage of a robot that stands on a block.
    pub(crate) fn new(robot: u32, incarnation: u64, block: Block) -> Passage {
        let held = vec![Held { zone: 0, step: Step { number: 0, block } }];
        Passage { robot, incarnation, held, ..Passage::default() }
    }

    /// The same passage as an earlier one.
    pub(crate) fn with(
        robot: u32,
        incarnation: u64,
        (held, enters): (Vec<Held>, bool),
        territories: Territories,
        links: Vec<Link>,
    ) -> Passage {
        Passage { robot, incarnation, held, enters, territories, links, linked: None }
    }

    pub(crate) fn robot(&self) -> u32 {
        self.robot
    }

    pub(crate) fn incarnation(&self) -> u64 {
        self.incarnation
    }

    /// The blocks that the robot holds. Before it has entered the floor, the one where it wants to do so.
    pub(crate) fn held(&self) -> &[Held] {
        &self.held
    }

    /// True if the robot is not on the floor, and waits until it may enter it.
    pub(crate) fn enters(&self) -> bool {
        self.enters
    }

    pub(crate) fn territories(&self) -> &Territories {
        &self.territories
    }

    pub(crate) fn links(&self) -> &[Link] {
        &self.links
    }

    /// The block after the one where the robot is, if it may enter it.
    pub(crate) fn next(&self) -> Option<Block> {
        self.held.get(1).map(|held| held.step.block)
    }

    /// The block after another one of the passage.
    pub(crate) fn next_after(&self, block: Block) -> Option<Block> {
        let place = self.held.iter().position(|held| held.step.block == block)?;
        self.held.get(place + 1).map(|held| held.step.block)
    }

    /// The last block that the robot holds.
    pub(crate) fn end(&self) -> Block {
        self.held.last().map_or(Block::default(), |held| held.step.block)
    }

    /// True if the block is in another zone than this one, and the end of the passage or beside it.
    pub(crate) fn may_ask_for(&self, block: Block, from: u32) -> bool {
        block.distance(self.end()) <= 1 && self.territories.of(block).is_some_and(|there| there.zone != from)
    }

    /// True if the block is in this zone.
    pub(crate) fn is_of(&self, block: Block, zone: u32) -> bool {
        self.territories.of(block).is_some_and(|one| one.zone == zone)
    }

    /// True if this is the number of a zone, as far as the robot knows.
    pub(crate) fn knows(&self, zone: u32) -> bool {
        self.territories.known().iter().any(|known| known.zone == zone)
    }

    /// Takes in the territory of a zone. Where that has new borders or a new term, grants of those that it replaces
    /// count no more, and the robot has to say what it holds of its blocks, whichever zone granted them.
    pub(crate) fn hear_territory(&mut self, territory: &Territory) {
        if !self.territories.hear(territory) {
            return;
        }
        if let Some(link) = self.links.iter_mut().find(|link| link.territory.zone == territory.zone) {
            link.heard = 0;
            link.territory.clone_from(territory);
        }
        let Passage { held, territories, .. } = self;
        for held in held.iter_mut().filter(|held| held.zone != 0 || territory.contains(held.step.block)) {
            held.zone = territories.of(held.step.block).map_or(0, |zone| zone.zone);
        }
        self.linked = None;
    }

    /// The terms in which the robot holds nothing: it ignores grants of earlier ones.
    pub(crate) fn clear(&self) -> Vec<ClearTerm> {
        let holds = |zone: u32| !self.enters && self.held.iter().any(|held| held.zone == zone);
        let clear = self.territories.known().iter().filter(|territory| !holds(territory.zone));
        clear.map(|&Territory { zone, term, .. }| ClearTerm { zone, term }).collect()
    }

    /// Makes links to the zones that the robot holds blocks of, those close to the end of its passage, and that of its
    /// charger.
    fn link(&mut self, charger: Block) {
        let end = self.end();
        if self.linked == Some((end, charger)) {
            return;
        }
        self.linked = Some((end, charger));
        let Passage { held, territories, links, .. } = self;
        for territory in territories.known() {
            let is_near = || territory.is_near(end);
            let is_held = || held.iter().any(|held| held.zone == territory.zone);
            let is_linked = || links.iter().any(|link| link.territory.zone == territory.zone);
            if (is_near() || is_held() || territory.contains(charger)) && !is_linked() {
                let territory = territory.clone();
                links.push(Link { territory, received: 0, said: GrantRequest::default(), heard: 0 });
            }
        }
    }

    /// Takes in a grant. Steps that do not continue the passage are released at once. False if the grant is for an
    /// earlier incarnation, or of an earlier term or zone.
    pub(crate) fn hear(&mut self, grant: &Grant) -> bool {
        let end = self.end();
        let Some(link) = self.links.iter_mut().find(|link| link.territory.zone == grant.zone) else { return false };
        let is_mine = grant.robot == self.robot && grant.incarnation == self.incarnation;
        if !is_mine || grant.term != link.territory.term || !link.is_open(&self.territories) {
            return false;
        }
        link.heard = link.heard.max(grant.heard);
        let mut end = end;
        for step in &grant.steps {
            if step.number > link.received {
                link.received = step.number;
                let held = Held { zone: grant.zone, step: *step };
                if self.enters && step.block == end {
                    (self.held, self.enters) = (vec![held], false);
                } else if !self.enters && step.block.distance(end) == 1 {
                    self.held.push(held);
                    end = step.block;
                }
            }
        }
        true
    }

    /// The robot has arrived at a block of its passage: it releases those before.
    pub(crate) fn arrive(&mut self, block: Block) {
        if let Some(place) = self.held.iter().position(|held| held.step.block == block) {
            self.held.drain(..place);
        }
    }

    /// Releases the blocks after the first ones, which the robot has not begun to enter.
    pub(crate) fn give_back(&mut self, first: usize) {
        self.held.truncate(first.max(1));
    }

    /// The robot leaves the fleet: it takes no step any more that it has not received.
    pub(crate) fn leave(&mut self) {
        self.links.iter_mut().for_each(|link| link.received = LAST_NUMBER);
    }

    /// The robot leaves the floor: it holds nothing any more, and takes no step that it has not received.
    pub(crate) fn leave_floor(&mut self) {
        self.held.truncate(1);
        self.held.iter_mut().for_each(|held| held.zone = 0);
        self.leave();
    }

    /// The requests that have to be sent now: new ones, and with `again` also those that were not taken in.
    pub(crate) fn requests(&mut self, wish: Wish, again: bool) -> Vec<GrantRequest> {
        self.link(wish.charger);
        let Passage { robot, incarnation, ref held, enters, ref territories, ref mut links, .. } = *self;
        let (Some(first), Some(last)) = (held.first(), held.last()) else { return Vec::new() };
        let (block, end) = (first.step.block, last.step.block);
        let goal = wish.goal.unwrap_or(end);
        let mut requests = Vec::new();
        for one in links.iter_mut().filter(|link| link.is_open(territories)) {
            let zone = one.territory.zone;
            let of_zone = held.iter().filter(|held| !enters && held.zone == zone);
            let of_zone: Vec<Step> = of_zone.map(|held| held.step).collect();
            // It has received what other zones granted, too, before this one had these blocks.
            one.received = of_zone.iter().map(|step| step.number).fold(one.received, u64::max);
            let aside = wish.aside.filter(|(block, _)| one.territory.contains(*block));
            let is_near = |block: Block, end: Block| one.territory.is_near(block) || one.territory.is_near(end);
            let is_concerned = is_near(block, end) || !of_zone.is_empty();
            // It has to hear that the robot is not close any more.
            let was_concerned = is_near(one.said.block, one.said.end);
            let (goal, rank) = aside.unwrap_or((goal, wish.rank));
            // Each zone has to hear once in its term what each robot holds.
            let is_new = one.said.term != one.territory.term;
            let request = GrantRequest {
                link: link(zone, robot),
                zone,
                term: one.territory.term,
                robot,
                incarnation,
                number: one.said.number,
                at: one.territory.closest(block),
                block,
                end,
                received: one.received,
                held: of_zone,
                goal: if is_concerned { goal } else { end },
                charger: wish.charger,
                rank: if is_concerned { rank } else { 0 },
                standing: wish.standing,
                ahead: if is_concerned { wish.ahead } else { 0 },
            };
            let is_unheard = again && one.heard < one.said.number;
            // A zone that the robot has left need not know where it is now; but its answer has to reach the robot.
            let is_news = if is_concerned || was_concerned || is_new || is_unheard {
                // The zone need not hear of another latency by itself.
                GrantRequest { ahead: one.said.ahead, ..request.clone() } != one.said
            } else {
                (request.goal != request.end) != (one.said.goal != one.said.end)
                    || (&request.held, request.received) != (&one.said.held, one.said.received)
            };
            if is_news {
                one.said = GrantRequest { number: one.said.number + 1, ..request };
            }
            if is_news || is_unheard {
                requests.push(one.said.clone());
            }
        }
        requests
    }
}
