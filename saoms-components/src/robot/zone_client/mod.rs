//! Client of the zones of a robot's site, which grant it the blocks that it enters.

mod latency;
mod presence;

use std::collections::BTreeMap;
use std::ops::Range;

use saoms_api::{Context, Failure, Field, Publisher, Region, Subscription, Time};

use crate::grid::{Block, Map};
use crate::messages::{
    GRANT, GRANT_REQUEST, Grant, GrantRequest, LAST_NUMBER, PRESENCE, Position, Presence, RobotList, Standing, Step,
    TERRITORY, Territory, address,
};
use crate::validation::MessageValidator;
use crate::zone::{Held, Link, Passage, Territories, Wish};
use latency::Latency;

/// Number of executions after which a robot repeats a request that its zone did not confirm.
const REPEAT: u32 = 4;

/// The same for a robot that waits for a grant.
const REPEAT_WAITING: u32 = 2;

/// Number of executions without a word of a zone for which a robot that waits for one takes the zone for out of reach.
/// A zone that does not come back in that time is taken for dead.
const CUT_OFF: Range<u32> = 20..6000;

/// Number of executions after which a robot forgets that a zone lets it make way, if the zone does not say so again: it
/// may have missed that this is over. Zones repeat it every four executions of theirs; where they answer late, the
/// robot waits longer, by this number of answers.
const ASIDE_LASTS: u32 = 16;
const ANSWERS: u32 = 4;

/// Number of executions after which a robot says that it cannot enter the floor.
const LONG: u32 = 50;

/// A robot's passage through zones, and the topics on which it speaks with them.
#[derive(Debug)]
pub(crate) struct ZoneClient {
    /// `None` until the robot is on the floor, or asks to enter it.
    passage: Option<Passage>,
    territories: Subscription<Territory>,
    grants: Subscription<Grant>,
    requests: Publisher<GrantRequest>,
    presences: Publisher<Presence>,
    /// True if a zone has asked where the robot is.
    is_asked: bool,
    /// Whether the robot said last that it cannot move any more; `None` if it never said so.
    said_lost: Option<bool>,
    /// Its charger, as it said last.
    said_charger: Block,
    /// Number of times when a repetition of where it is was due, since it last changed whether it can move.
    due: u32,
    /// The [round](presence) of its last execution in which it could not move.
    lost_round: u128,
    /// For repetitions of what loops said; `None` where the robot has no loop that says it.
    pub(super) positions: Option<Publisher<Position>>,
    pub(super) robots: Option<Publisher<RobotList>>,
    /// What the robot said of itself when a repetition was due last, and how often it was due since that changed.
    said: Option<(Position, RobotList)>,
    state_due: u32,
    /// Zones and the components that speak for them.
    validator: MessageValidator,
    /// Number of executions since the last request.
    silent: u32,
    /// Number of executions in which it waited to drive on, since a zone was heard last.
    unheard: u32,
    goal: Option<Block>,
    /// For each zone, the first request with that goal.
    aimed: Vec<Aimed>,
    /// True if it had no goal before this one: what is granted to it for that time is to make way for others.
    rested: bool,
    /// Block to which a loop ordered the robot, and that is not granted yet.
    pub(super) asked: Option<Block>,
    /// The block that another robot has to leave first, and that robot.
    in_the_way: Option<InTheWay>,
    /// For each zone that lets the robot make way to a block of another one, what it said last.
    asides: BTreeMap<u32, Aside>,
    latency: Latency,
    /// Number of executions in which it waited to enter the floor.
    waited: u32,
}

/// What a robot goes on from after a failure.
#[derive(Clone, Debug, Field)]
pub(crate) struct ZoneMemory {
    incarnation: u64,
    held: Vec<HeldMemory>,
    /// True if it waits until it may enter the floor.
    enters: bool,
    territories: Vec<Territory>,
    former: Vec<Territory>,
    said_lost: Option<bool>,
    said_charger: Block,
    links: Vec<LinkMemory>,
    goal: Option<Block>,
    aimed: Vec<Aimed>,
    in_the_way: Option<InTheWay>,
    latency: Latency,
}

/// A zone, and the number of a request to it.
#[derive(Clone, Copy, Debug, Field)]
struct Aimed {
    zone: u32,
    number: u64,
}

/// A block, and the robot that has to leave it first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Field)]
pub(crate) struct InTheWay {
    pub(super) block: Block,
    pub(super) robot: u32,
}

/// A block of another zone to which a zone lets the robot make way.
#[derive(Clone, Copy, Debug)]
struct Aside {
    block: Block,
    /// The rank with which the robot asks for it.
    rank: u64,
    /// Number of executions since the zone said so.
    age: u32,
}

#[derive(Clone, Copy, Debug, Field)]
struct HeldMemory {
    zone: u32,
    step: Step,
}

#[derive(Clone, Debug, Field)]
struct LinkMemory {
    territory: Territory,
    received: u64,
    said: GrantRequest,
    heard: u64,
}

impl ZoneClient {
    /// The client of a robot, if its site has zones.
    ///
    /// # Errors
    /// The component cannot use the topics.
    pub(crate) fn new(context: &mut Context<'_>, robot: u32) -> Result<Option<ZoneClient>, Failure> {
        // A component that grants without a number is no zone: robots would not know who it is.
        if context.publishers(&GRANT).iter().all(|one| one.number.is_none()) {
            return Ok(None);
        }
        let grants = context.subscribe(&GRANT)?;
        let address = address(robot);
        context.set_region(&grants, Some(Region::around((address.x, address.y), 0)))?;
        Ok(Some(ZoneClient {
            passage: None,
            territories: context.subscribe(&TERRITORY)?,
            grants,
            requests: context.publish(&GRANT_REQUEST)?,
            presences: context.publish(&PRESENCE)?,
            is_asked: false,
            said_lost: None,
            said_charger: Block::default(),
            due: 0,
            lost_round: 0,
            positions: None,
            robots: None,
            said: None,
            state_due: 0,
            validator: MessageValidator::default(),
            silent: 0,
            unheard: 0,
            goal: None,
            aimed: Vec::new(),
            rested: false,
            asked: None,
            in_the_way: None,
            asides: BTreeMap::new(),
            latency: Latency::default(),
            waited: 0,
        }))
    }

    pub(crate) fn memory(&self, passage: &Passage) -> ZoneMemory {
        let held = passage.held().iter().map(|held| HeldMemory { zone: held.zone, step: held.step });
        let links = passage.links().iter().map(|link| LinkMemory {
            territory: link.territory.clone(),
            received: link.received,
            said: link.said.clone(),
            heard: link.heard,
        });
        ZoneMemory {
            incarnation: passage.incarnation(),
            held: held.collect(),
            enters: passage.enters(),
            territories: passage.territories().known().to_vec(),
            former: passage.territories().former().to_vec(),
            said_lost: self.said_lost,
            said_charger: self.said_charger,
            links: links.collect(),
            goal: self.goal,
            aimed: self.aimed.clone(),
            in_the_way: self.in_the_way,
            latency: self.latency.clone(),
        }
    }

    /// The same once the robot is on the floor, or asks to enter it.
    pub(crate) fn save(&self) -> Option<ZoneMemory> {
        self.passage.as_ref().map(|passage| self.memory(passage))
    }

    pub(crate) fn restore(&mut self, robot: u32, memory: ZoneMemory) {
        let held = memory.held.into_iter().map(|held| Held { zone: held.zone, step: held.step });
        let links = memory.links.into_iter().map(|link| Link {
            territory: link.territory,
            received: link.received,
            said: link.said,
            heard: link.heard,
        });
        let (incarnation, territories) = (memory.incarnation, Territories::with(memory.territories, memory.former));
        let held = (held.collect(), memory.enters);
        self.passage = Some(Passage::with(robot, incarnation, held, territories, links.collect()));
        self.is_asked = true;
        (self.said_lost, self.said_charger) = (memory.said_lost, memory.said_charger);
        (self.goal, self.aimed) = (memory.goal, memory.aimed);
        (self.in_the_way, self.latency) = (memory.in_the_way, memory.latency);
    }

    /// The robot stands on a block of the floor, without memory of grants to an earlier incarnation of it.
    pub(crate) fn stand(&mut self, context: &Context<'_>, robot: u32, block: Block) {
        self.passage.get_or_insert_with(|| Passage::new(robot, incarnation(context), block));
    }

    /// The robot is not on the floor, and wants to enter it at a block.
    pub(crate) fn wait_to_enter(&mut self, context: &Context<'_>, robot: u32, block: Block) {
        self.passage.get_or_insert_with(|| Passage::entering(robot, incarnation(context), block));
    }

    /// True if the robot has neither a place on the floor, nor asked for one.
    pub(crate) fn is_new(&self) -> bool {
        self.passage.is_none()
    }

    /// The robot waits until it may enter the floor.
    pub(crate) fn waits_to_enter(&self) -> bool {
        self.passage.as_ref().is_some_and(Passage::enters)
    }

    /// Counts an execution in which the robot waits to enter the floor; once it has waited for so many, returns the
    /// robot on its block, if there is one.
    pub(super) fn waits_in_vain(&mut self) -> Option<Option<u32>> {
        self.waited += 1;
        (self.waited == LONG).then(|| self.in_the_way.map(|wait| wait.robot))
    }

    /// Takes in what zones say. True if there are grants for an earlier goal among them, whose blocks may lead
    /// elsewhere.
    pub(crate) fn hear(&mut self, context: &mut Context<'_>, area: Option<&Map>) -> bool {
        let ZoneClient { passage: Some(passage), territories, validator, asides, latency, is_asked, .. } = self else {
            return false;
        };
        latency.begin_execution();
        let lasts = ASIDE_LASTS + ANSWERS * latency.executions();
        asides.retain(|_, aside| {
            aside.age += 1;
            aside.age <= lasts
        });
        for (header, territory) in context.receive(territories).with_headers() {
            if validator.accepts(territory, header, area, context) {
                passage.hear_territory(territory);
                *is_asked = true;
                validator.expect_introductions();
                latency.hears_zones(|zone| passage.knows(zone));
            }
        }
        self.hear_grants(context, area)
    }

    /// Takes in grants alone. A robot that goes on after a failure may have begun to use those which it heard then, so
    /// that it has to know of them before it hears that their zone has begun a new term.
    pub(crate) fn hear_grants(&mut self, context: &mut Context<'_>, area: Option<&Map>) -> bool {
        let ZoneClient {
            passage: Some(passage),
            grants,
            validator,
            in_the_way,
            asides,
            latency,
            aimed,
            rested,
            unheard,
            ..
        } = self
        else {
            return false;
        };
        let mut is_late = false;
        for (header, grant) in context.receive(grants).with_headers() {
            if grant.robot == passage.robot() && validator.accepts(grant, header, area, context) && passage.hear(grant)
            {
                match grant.aside_rank {
                    0 => _ = asides.remove(&grant.zone),
                    rank => _ = asides.insert(grant.zone, Aside { block: grant.aside, rank, age: 0 }),
                }
                let waits = grant.waits_for != 0;
                // Of a block of another zone this one says nothing.
                if waits || in_the_way.is_none_or(|wait| passage.is_of(wait.block, grant.zone)) {
                    *in_the_way = waits.then_some(InTheWay { block: grant.wanted, robot: grant.waits_for });
                }
                *unheard = 0;
                latency.hears(grant.zone, grant.heard);
                is_late |= !*rested && aimed.iter().any(|one| one.zone == grant.zone && one.number > grant.heard);
            }
        }
        is_late
    }

    /// The block that the robot may enter next.
    pub(crate) fn next(&self) -> Option<Block> {
        self.passage.as_ref()?.next()
    }

    /// The block that it may enter once it is at another one.
    pub(crate) fn next_after(&self, block: Block) -> Option<Block> {
        self.passage.as_ref()?.next_after(block)
    }

    /// The robot that is in the way, if the robot can drive no further.
    pub(crate) fn in_the_way(&self) -> Option<InTheWay> {
        let passage = self.passage.as_ref()?;
        self.in_the_way.filter(|wait| passage.next().is_none() && wait.block.distance(passage.end()) == 1)
    }

    /// The block of another zone to which a zone lets the robot make way, and the rank with which it asks for that.
    pub(crate) fn aside(&self) -> Option<(Block, u64)> {
        let passage = self.passage.as_ref()?;
        let may_ask = |(zone, aside): &(&u32, &Aside)| passage.may_ask_for(aside.block, **zone);
        let best = self.asides.iter().filter(may_ask).max_by_key(|(_, aside)| aside.rank)?.1;
        Some((best.block, best.rank))
    }

    /// True if the robot may drive on.
    pub(crate) fn may_drive(&self) -> bool {
        self.next().is_some()
    }

    /// Number of executions that zones take to answer.
    pub(crate) fn latency(&self) -> u32 {
        self.latency.executions()
    }

    /// The robot is at a block, and leaves no other one.
    pub(crate) fn arrive(&mut self, block: Block) {
        if let Some(passage) = &mut self.passage {
            passage.arrive(block);
        }
    }

    /// The robot wants to go there, or nowhere. If it wanted to go elsewhere before, it releases its passage, but for
    /// the first `begun` blocks, which it is on or has begun to enter, and those after them that lead to the new goal:
    /// `way` is the number of moves between two blocks. What was granted while it had no goal is to make way for
    /// others.
    pub(crate) fn aim(&mut self, goal: Option<Block>, begun: usize, way: impl FnMut(Block, Block) -> u32) {
        let before = std::mem::replace(&mut self.goal, goal);
        if goal != before {
            self.aimed.clear();
            self.rested = before.is_none();
        }
        if before.is_some() && goal != before {
            self.turn(begun, way);
        }
    }

    /// Releases the passage, but for its first `begun` blocks, and those after them that lead to the goal.
    pub(crate) fn turn(&mut self, begun: usize, mut way: impl FnMut(Block, Block) -> u32) {
        if let (Some(passage), Some(goal)) = (&mut self.passage, self.goal) {
            let left: Vec<u32> = passage.held().iter().map(|held| way(held.step.block, goal)).collect();
            let ahead = left.windows(2).skip(begun.max(1) - 1).take_while(|pair| pair[1] < pair[0]).count();
            passage.give_back(begun.max(1) + ahead);
        }
    }

    /// The robot stays where it is, or where it has begun to go: it releases the rest of its passage.
    pub(crate) fn stay(&mut self, begun: usize) {
        if let Some(passage) = &mut self.passage {
            passage.give_back(begun);
        }
    }

    /// The robot leaves the fleet where it is, or where it has begun to go: it releases the rest of its passage, also
    /// what is granted and on its way.
    pub(crate) fn leave(&mut self, begun: usize) {
        self.stay(begun);
        if let Some(passage) = &mut self.passage {
            passage.leave();
        }
    }

    /// Somebody took the robot off the floor: it holds nothing any more, wherever it was.
    ///
    /// # Errors
    /// The messages cannot be sent.
    pub(crate) fn leave_floor(&mut self, context: &mut Context<'_>, charger: Block) -> Result<(), Failure> {
        if let Some(passage) = &mut self.passage {
            passage.leave_floor();
        }
        self.is_asked = true;
        self.ask(context, Wish { charger, ..Wish::default() })
    }

    /// True if a zone said that somebody took the robot off the floor.
    pub(crate) fn is_off_floor(&self) -> bool {
        self.passage.as_ref().is_some_and(|passage| passage.links().iter().any(|link| link.heard == LAST_NUMBER))
    }

    /// True if the robot waits for a zone that it does not hear: no other robot is why.
    pub(crate) fn is_cut_off(&self) -> bool {
        CUT_OFF.contains(&self.unheard)
    }

    /// Sends what changed, or what was not confirmed for long.
    ///
    /// # Errors
    /// The messages cannot be sent.
    pub(crate) fn ask(&mut self, context: &mut Context<'_>, wish: Wish) -> Result<(), Failure> {
        let Some(passage) = &mut self.passage else { return Ok(()) };
        self.silent = self.silent.saturating_add(1);
        let waits = passage.next().is_none() && wish.goal.is_some_and(|goal| goal != passage.end());
        self.unheard = if waits { self.unheard.saturating_add(1) } else { 0 };
        let again = match waits {
            // Ever less often, so that a run ends whose zone is dead.
            true if self.unheard >= CUT_OFF.end => self.unheard.is_power_of_two(),
            true => self.silent >= REPEAT_WAITING,
            false => self.silent >= REPEAT,
        };
        let requests = passage.requests(wish, again);
        if again || !requests.is_empty() {
            self.silent = 0;
        }
        for request in requests {
            if self.goal == wish.goal && !self.aimed.iter().any(|one| one.zone == request.zone) {
                self.aimed.push(Aimed { zone: request.zone, number: request.number });
            }
            self.latency.asks(request.zone, request.number);
            context.send(&self.requests, request)?;
        }
        let is_lost = wish.standing == Standing::Lost;
        let is_news = is_lost != self.said_lost.unwrap_or(false) || wish.charger != self.said_charger;
        if std::mem::take(&mut self.is_asked) || is_news || is_lost && self.is_next_round(context) {
            self.said_charger = wish.charger;
            self.tell_presence(context, is_lost)?;
        }
        Ok(())
    }
}

/// A number greater than those of all earlier incarnations of a robot.
fn incarnation(context: &Context<'_>) -> u64 {
    let born = context.date().unwrap_or_else(|| context.now().since(Time::START));
    u64::try_from(born.as_nanos()).unwrap_or(u64::MAX).saturating_add(1)
}
