use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use saoms_api::{
    CallError, Cause, Class, Component, Context, Failure, Header, KnownPublisher, Publisher, Region, ReportValue,
    Subscription, Time, record, warn,
};

use super::asides::Asides;
use super::asking::Asking;
use super::beginning::Beginning;
use super::deadlock::StandingStill;
use super::ground::Ground;
use super::ledger::{Heard, Ledger, Member};
use super::maneuver::Maneuver;
use super::memory::Record;
use super::plan::Planned;
use super::properties::ZoneProperties;
use super::spoken::{Spoken, longest_move, newest};
use super::{memory, plan, status};
use crate::grid::{Block, Map};
use crate::hardware::HardwareReference;
use crate::messages::{
    ClearTerm, FAULT, Fault, GRANT, GRANT_REQUEST, Grant, GrantRequest, PRESENCE, Presence, REMOVAL, REMOVAL_ASKED,
    Removal, Standing, TERRITORY, Territory,
};
use crate::validation::MessageValidator;

/// Number of executions after which the zone repeats what was not confirmed.
const REPEAT: u64 = 4;

/// Number of executions after which it confirms what it need not answer otherwise.
const CONFIRM: u64 = 1;

/// Grants robots the passage through its blocks.
///
/// Robots of its site enter a block only with a grant of the zone in which it lies. A grant is a message that holds
/// until the robot says that it has left the block; no timeout ends it. So no two robots share a block or exchange
/// their blocks, however late messages are and whichever component fails.
///
/// Without a `delay` it executes half a period after the start, between robots without one: its answers take them one
/// period in place of two.
#[derive(Debug, Class)]
#[class(name = "saoms.Zone", periodic, alternates, reference("world": crate::hardware::Hardware, optional))]
pub struct Zone {
    properties: ZoneProperties,
    hardware: HardwareReference,
    state: Option<State>,
    validator: MessageValidator,
    /// The question to robots where they are, until all have answered.
    asking: Option<Asking>,
    /// True if a robot asked the one that was the zone of its blocks before.
    is_unknown: bool,
    /// When each robot spoke.
    spoke: BTreeMap<u32, Spoken>,
    /// True if the zone grants: its record has all that robots may hold.
    open: bool,
    /// Robots that the alerts about deadlocks are about.
    deadlocked: BTreeSet<u32>,
    standing_still: StandingStill,
    asides: Asides,
    /// Robots with an unconfirmed request, and the execution in which that is confirmed at the latest.
    unconfirmed: BTreeMap<u32, u64>,
    #[subscribes(GRANT_REQUEST)]
    requests: Subscription<GrantRequest>,
    #[subscribes(PRESENCE)]
    presences: Subscription<Presence>,
    #[subscribes(FAULT)]
    faults: Subscription<Fault>,
    #[subscribes(REMOVAL)]
    removals: Subscription<Removal>,
    #[publishes(REMOVAL_ASKED)]
    removals_asked: Publisher<Fault>,
    #[publishes(GRANT)]
    grants: Publisher<Grant>,
    #[publishes(TERRITORY)]
    territories: Publisher<Territory>,
}

/// The record of the grants, and the map.
#[derive(Debug)]
struct State {
    ledger: Ledger,
    maneuvers: Vec<Maneuver>,
    ground: Ground,
    /// Blocks of robots that cannot move any more, as far as these or others have said so last.
    lost: BTreeMap<u32, Vec<Block>>,
}

impl Component for Zone {
    type Properties = ZoneProperties;

    fn new(properties: ZoneProperties) -> Result<Self, Failure> {
        if let Some(map) = properties.map().map_err(Failure::of_findings)? {
            properties.territory(1, &map).map_err(|finding| Failure::from(*finding))?;
        }
        Ok(Zone {
            properties,
            hardware: HardwareReference::default(),
            state: None,
            validator: MessageValidator::default(),
            asking: None,
            is_unknown: false,
            spoke: BTreeMap::new(),
            open: false,
            deadlocked: BTreeSet::new(),
            standing_still: StandingStill::default(),
            asides: Asides::default(),
            unconfirmed: BTreeMap::new(),
            requests: Subscription::default(),
            presences: Subscription::default(),
            faults: Subscription::default(),
            removals: Subscription::default(),
            removals_asked: Publisher::default(),
            grants: Publisher::default(),
            territories: Publisher::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.hardware = context.reference("world")?;
        self.begin(context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.begin(context)?;
        let Some(mut state) = self.state.take() else { return Ok(()) };
        let result = self.serve(&mut state, context);
        self.state = Some(state);
        result
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        status::status(self.state.as_ref().map(|state| &state.ledger), self.open)
    }

    fn waits_for(&self) -> Option<String> {
        Some("requests of robots".to_owned())
    }
}

impl Zone {
    /// Learns the map and the grants that it kept, unless it knows them.
    fn begin(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.state.is_some() {
            return Ok(());
        }
        let Some(map) = self.map(context)? else { return Ok(()) };
        let (own, others) = records(context);
        let is_part = |territory: &Territory| (map.width(), map.height()) != (territory.width, territory.height);
        let has_record = own.is_some() || !others.is_empty() || !context.kept().is_empty();
        let term = context.date().unwrap_or_else(|| context.now().since(Time::START));
        let term = u64::try_from(term.as_nanos()).unwrap_or(u64::MAX).saturating_add(1);
        let territory = self.properties.territory(term, &map).map_err(|finding| Failure::from(*finding))?;
        let Beginning { ledger, spoke, is_complete, is_new } = Beginning::of(territory, own, others, &map);
        (self.open, self.asking) = (is_complete, is_new.then(Asking::default));
        if is_complete {
            let spoken = spoke.into_iter().map(|(robot, (incarnation, first))| (robot, Spoken::at(incarnation, first)));
            self.spoke.extend(spoken);
        }
        if is_new && has_record {
            self.keep_all(&ledger, context)?;
        }
        context.send(&self.territories, ledger.territory().clone())?;
        if context.is_wired(&self.hardware) {
            // It may have begun after robots went out.
            context.send(&self.removals_asked, Fault::any())?;
        }
        let Territory { corner, width, height, .. } = *ledger.territory();
        // The instance before may have read a part of the map alone.
        if is_part(ledger.territory()) || has_record {
            let columns = corner.x..=corner.x.saturating_add_unsigned(width - 1);
            let rows = corner.y..=corner.y.saturating_add_unsigned(height - 1);
            context.set_region(&self.requests, Some(Region::new(columns, rows)))?;
        }
        let mut ground = Ground::new(map);
        ledger.members().values().for_each(|member| ground.add_charger(member.request.charger));
        self.state = Some(State { ledger, maneuvers: Vec::new(), ground, lost: BTreeMap::new() });
        Ok(())
    }

    /// The map of the world, or of the property; `None` while the world cannot be reached.
    fn map(&self, context: &mut Context<'_>) -> Result<Option<Map>, Failure> {
        if !context.is_wired(&self.hardware) {
            let map = self.properties.map().map_err(Failure::of_findings)?;
            return map.map(Some).ok_or_else(|| {
                Failure::new("the zone has no map: wire its reference `world` to a world, or give it `map`")
            });
        }
        match self.hardware.area(context) {
            Ok(area) => {
                let map: Option<Map> = area.into();
                map.map(Some).ok_or_else(|| Failure::new("the world's map does not match its width and height"))
            }
            Err(CallError::Busy { .. } | CallError::NotRunning { .. }) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    fn serve(&mut self, state: &mut State, context: &mut Context<'_>) -> Result<(), Failure> {
        let mut changed = self.hear(state, context);
        changed.extend(self.hear_presence(state, context));
        changed.extend(self.hear_gone(state, context));
        if !self.ask(state, context)? {
            // It begins a new record once all have answered.
            return Ok(());
        }
        let Planned { granted, mut told } = self.plan(state);
        changed.extend(&granted);
        told.extend(granted);
        self.name_deadlocks(state, context);
        let execution = context.execution();
        self.unconfirmed.retain(|robot, due| {
            let is_due = *due <= execution;
            if is_due {
                told.insert(*robot);
            }
            !is_due && !told.contains(robot)
        });
        let asides = self.asides.note(&state.ledger, &state.maneuvers, execution);
        if execution.is_multiple_of(REPEAT) {
            told.extend(asides);
            let is_due = |member: &Member| member.granted > member.request.received && !member.steps.is_empty();
            told.extend(state.ledger.members().iter().filter(|(_, member)| is_due(member)).map(|(robot, _)| *robot));
        }
        // Before the messages of this execution leave.
        for robot in changed {
            let (key, bytes) = memory::member(&state.ledger, robot, self.first_heard(robot));
            context.keep(key, &bytes)?;
        }
        for grant in told.iter().filter_map(|robot| state.ledger.message(*robot)) {
            context.send(&self.grants, grant)?;
        }
        Ok(())
    }

    /// Takes in what robots ask for. Returns those whose record has changed.
    fn hear(&mut self, state: &mut State, context: &mut Context<'_>) -> BTreeSet<u32> {
        let mut changed = BTreeSet::new();
        let State { ledger, ground, lost, .. } = state;
        for (header, request) in context.receive(&self.requests).with_headers() {
            let own = ledger.territory();
            let is_here = request.zone == own.zone && request.term == own.term;
            // These blocks were those of another zone, or of this one in an earlier term.
            self.is_unknown |= own.contains(request.at) && (request.zone != own.zone || request.term < own.term);
            if !is_here || !self.validator.accepts(request, header, Some(ground.map()), context) {
                continue;
            }
            if let Some(asking) = &mut self.asking {
                asking.note_heard(header.sender);
            }
            if let Some(spoken) = newest(&mut self.spoke, request.robot, request.incarnation, header.sent)
                && !ledger.has_ended(request.robot, request.incarnation)
            {
                spoken.hear(request, header.sent, ledger.territory());
                let is_lost = request.standing == Standing::Lost;
                note_lost(lost, request.robot, is_lost.then_some([request.block, request.end]));
            }
            ground.add_charger(request.charger);
            let heard = ledger.hear(request);
            // While it is closed, the other one may have to say yet that it is somewhere else.
            if let (Heard::Conflict { block, other }, true) = (heard, self.open) {
                let robot = request.robot;
                warn!(context, "robot {robot} is at {block}, which was granted to robot {other}");
                context.effect(record!(grant_conflict: "robot {robot} is on a block of robot {other}", robot, other));
            }
            if heard != Heard::Nothing {
                changed.insert(request.robot);
            }
            self.unconfirmed.entry(request.robot).or_insert(context.execution() + CONFIRM);
        }
        changed
    }

    /// Takes in where robots of the whole site are. Returns those whose record has changed.
    fn hear_presence(&mut self, state: &mut State, context: &mut Context<'_>) -> BTreeSet<u32> {
        let mut changed = BTreeSet::new();
        let State { ledger, ground, lost, .. } = state;
        let &Territory { zone, term, .. } = ledger.territory();
        for (header, presence) in context.receive(&self.presences).with_headers() {
            if !self.validator.accepts(presence, header, Some(ground.map()), context) {
                continue;
            }
            if presence.clear.contains(&ClearTerm { zone, term }) {
                if let Some(asking) = &mut self.asking {
                    asking.note_heard(header.sender);
                }
                if ledger.hear_clear(presence.robot, presence.incarnation, (presence.block, presence.end)) {
                    changed.insert(presence.robot);
                }
            }
            if newest(&mut self.spoke, presence.robot, presence.incarnation, header.sent).is_none()
                || ledger.has_ended(presence.robot, presence.incarnation)
            {
                continue;
            }
            ground.add_charger(presence.charger);
            note_lost(lost, presence.robot, presence.is_lost.then_some([presence.block, presence.end]));
        }
        changed
    }

    /// Frees the blocks of robots that somebody took off the floor. Those whose component failed keep the block where a
    /// world stopped them, or all where that is not known. Returns those whose record has changed.
    fn hear_gone(&mut self, state: &mut State, context: &mut Context<'_>) -> BTreeSet<u32> {
        let mut changed = BTreeSet::new();
        let faults = context.receive(&self.faults).with_headers();
        let mut heard: Vec<(Time, Fault)> = faults.map(|(header, fault)| (header.sent, fault.clone())).collect();
        // A master passes on what the world says here, and may be out.
        let removals = context.receive(&self.removals).with_headers();
        heard.extend(removals.filter_map(|(header, removal)| Some((header.sent, removal.fault()?))));
        heard.retain(|(_, fault)| fault.silences() && fault.robot != 0);
        for (sent, fault) in &heard {
            let spoken = self.spoke.get_mut(&fault.robot);
            if fault.is_failure() {
                // One that has begun anew since said what it holds.
                let is_over = |spoken: &Spoken| fault.since.is_none_or(|since| spoken.last > since);
                let is_off = state.ledger.member(fault.robot).is_some_and(Member::is_over);
                if !is_off && !spoken.as_deref().is_some_and(is_over) {
                    let at = fault.block.filter(|_| spoken.is_some());
                    state.lost.extend(at.map(|at| (fault.robot, vec![at])));
                    state.ledger.stop(fault.robot, at);
                    changed.insert(fault.robot);
                }
                continue;
            }
            // A robot that began anew since then is back. Whether it did may be unknown when the event is said again.
            let is_back = spoken.as_ref().map(|spoken| spoken.first > fault.since.unwrap_or(*sent));
            if is_back.unwrap_or(fault.since.is_some()) {
                continue;
            }
            state.ledger.end(fault.robot, spoken.as_ref().map_or(0, |spoken| spoken.incarnation));
            spoken.into_iter().for_each(Spoken::forget_pace);
            state.lost.remove(&fault.robot);
            if let Some(asking) = &mut self.asking {
                asking.note_gone(fault.robot);
            }
            changed.insert(fault.robot);
        }
        changed
    }

    /// Time of the first request of a robot's newest incarnation.
    fn first_heard(&self, robot: u32) -> Time {
        self.spoke.get(&robot).map_or(Time::START, |spoken| spoken.first)
    }

    /// Asks all robots where they are until they have said so, and says for whom it waits. True if it grants.
    fn ask(&mut self, state: &State, context: &mut Context<'_>) -> Result<bool, Failure> {
        let is_unknown = std::mem::take(&mut self.is_unknown);
        let Some(asking) = &mut self.asking else {
            if is_unknown {
                context.send(&self.territories, state.ledger.territory().clone())?;
            }
            return Ok(true);
        };
        let has_lasted = asking.has_lasted();
        let is_due = asking.is_due(self.open);
        let unheard = asking.unheard(context, is_due);
        if unheard.as_ref().is_some_and(Vec::is_empty) {
            self.asking = None;
            if !std::mem::replace(&mut self.open, true) {
                self.keep_all(&state.ledger, context)?;
                context.alert_over("closed", "");
            }
            return Ok(true);
        }
        if has_lasted && !self.open {
            // Zones that have its blocks after it begin a higher term.
            let (key, bytes) = memory::territory(&state.ledger, false);
            context.keep(key, &bytes)?;
        }
        if is_due || is_unknown && self.open {
            context.send(&self.territories, state.ledger.territory().clone())?;
        }
        if let Some(unheard) = unheard.filter(|_| asking.has_become_long() && !self.open) {
            let (sent, cause) = (context.now(), Cause::default());
            let header = |one: &KnownPublisher| Header { sender: one.sender, sent, cause };
            let names: Vec<&str> = unheard.iter().filter_map(|one| context.sender_name(header(one))).collect();
            let names = names.join(", ");
            context.alert(
                "closed",
                "",
                format_args!(
                    "grants nothing: it waits for robots to say where they are: {names}; if one is not on the floor, send \
                     `gone` for it"
                ),
            );
        }
        Ok(self.open)
    }

    /// Keeps the record, and nothing else: not what it knew of robots of which somebody said that they are gone.
    fn keep_all(&self, ledger: &Ledger, context: &mut Context<'_>) -> Result<(), Failure> {
        let kept: Vec<u64> = context.kept().into_keys().filter(|key| !memory::is_current(ledger, *key)).collect();
        kept.into_iter().try_for_each(|key| context.keep(key, &[]))?;
        let members = ledger.members().keys();
        let members = members.map(|robot| memory::member(ledger, *robot, self.first_heard(*robot)));
        for (key, bytes) in std::iter::once(memory::territory(ledger, self.open)).chain(members) {
            context.keep(key, &bytes)?;
        }
        Ok(())
    }

    /// Says which robots stand in each other's way for good, so that a person takes one of them away.
    fn name_deadlocks(&mut self, state: &mut State, context: &mut Context<'_>) {
        let waits = state.ledger.members().values().any(|member| member.waited > 0);
        if !waits && self.deadlocked.is_empty() && self.standing_still.is_empty() {
            return;
        }
        let moving = state.maneuvers.iter().flat_map(Maneuver::robots).collect();
        let (spoke, period) = (&self.spoke, context.period());
        let longest_move = || rounds(longest_move(spoke), period);
        let found = self.standing_still.count(&state.ledger, &mut state.ground, &moving, longest_move);
        self.deadlocked.retain(|robot| {
            let lasts = found.iter().any(|deadlock| deadlock.first() == *robot);
            if !lasts {
                context.alert_over("deadlock", robot);
            }
            lasts
        });
        for deadlock in found {
            if self.deadlocked.insert(deadlock.first()) {
                let line =
                    format_args!("{deadlock}: send one of them elsewhere, or take it off the floor and send `gone`");
                context.alert("deadlock", deadlock.first(), line);
                context.count("deadlocks", 1);
            }
        }
    }

    /// Plans a round, if a robot wants to go somewhere.
    fn plan(&self, state: &mut State) -> Planned {
        let State { ledger, maneuvers, ground, lost } = state;
        let members = ledger.members().values().filter(|member| member.is_obstacle());
        let obstacles: Vec<Block> = members.flat_map(Member::blocks).chain(lost.values().flatten().copied()).collect();
        ground.begin_round(obstacles);
        let planned = plan::plan(ledger, maneuvers, ground, self.properties.ahead as usize);
        ledger.end_round();
        planned
    }
}

/// The number of executions that take so long.
fn rounds(time: Duration, period: Duration) -> u32 {
    let rounds = time.as_nanos().div_ceil(period.as_nanos().max(1));
    u32::try_from(rounds).unwrap_or(u32::MAX)
}

/// Notes the blocks of a robot that cannot move any more, or that it can.
fn note_lost(lost: &mut BTreeMap<u32, Vec<Block>>, robot: u32, blocks: Option<[Block; 2]>) {
    match blocks {
        Some(blocks) => _ = lost.insert(robot, blocks.to_vec()),
        None => _ = lost.remove(&robot),
    }
}

/// What the zone kept, and what others did that were zones of its site until this one began. What an earlier program
/// left lacks what robots did since.
fn records(context: &mut Context<'_>) -> (Option<Record>, Vec<Record>) {
    let read = |kept: &BTreeMap<u64, &[u8]>, is_earlier: bool| {
        let record = memory::record(kept)?;
        Ok(record.map(|record| Record { is_open: record.is_open && !is_earlier, ..record }))
    };
    let own: Result<_, Failure> = read(&context.kept(), context.kept_by_earlier_program());
    let others = context.kept_by_others();
    let others = others.iter().map(|other| read(&other.kept, other.by_earlier_program));
    let others: Vec<Result<_, Failure>> = others.collect();
    let mut all = std::iter::once(own).chain(others).map(|record| {
        record.unwrap_or_else(|failure| {
            warn!(context, "asks all robots where they are, since its record of grants cannot be read: {failure}");
            None
        })
    });
    (all.next().flatten(), all.flatten().collect())
}
