use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::time::Duration;

use saoms_api::event::EventCall;
use saoms_api::event::fault::FaultCall;
use saoms_api::{Chance, Failure, Field, Time};

use super::scenario::{EventSpec, Line, Scenario};
use crate::grid::{Block, Map};
use crate::messages::{ExceptionalEvent, ExceptionalKind};

/// An event of a scenario with its random values drawn.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScenarioEvent {
    /// New luggage that waits for a robot.
    Luggage {
        /// Block where the luggage is.
        from: Block,
        /// Destination of the luggage.
        to: Block,
    },
    /// Blocks to visit.
    Visit {
        /// The blocks, in their order.
        stops: Vec<Block>,
        /// Number of the only robot that may do it.
        by: Option<u32>,
    },
    /// A landing or a take-off.
    Exceptional(ExceptionalEvent),
    /// The robot with this number breaks down.
    Breakdown(u32),
    /// Somebody takes the robot with this number off the floor.
    Gone(u32),
    /// An event that other classes take, or a fault of messages or executions, as a line with single values.
    Raised(String),
    /// No event: the scenario lasts until this time.
    End,
}

/// Player of a scenario: returns its events at their times and draws their random values.
///
/// Each line has a random generator of its own, so that adding or removing a line does not change the others.
#[derive(Debug)]
pub(super) struct Player {
    lines: Vec<(Line, Chance)>,
    /// Number of events that each line has had.
    played: Vec<u64>,
    /// Time of the next event of each active line.
    due: BinaryHeap<Reverse<(Duration, usize)>>,
}

/// State of a player, for an environment that goes on.
#[derive(Clone, Debug, Field)]
pub(super) struct PlayerMemory {
    chances: Vec<Chance>,
    played: Vec<u64>,
    due: Vec<Due>,
}

#[derive(Clone, Copy, Debug, Field)]
struct Due {
    at: Time,
    line: u32,
}

impl Player {
    /// The state of the player.
    pub(super) fn memory(&self) -> PlayerMemory {
        // Like `Time`, no scenario lasts longer than 500 years.
        let due =
            |Reverse((at, place)): &Reverse<(Duration, usize)>| Due { at: Time::START + *at, line: *place as u32 };
        let mut due: Vec<Due> = self.due.iter().map(due).collect();
        due.sort_unstable_by_key(|due| (due.at, due.line));
        PlayerMemory {
            chances: self.lines.iter().map(|(_, chance)| chance.clone()).collect(),
            played: self.played.clone(),
            due,
        }
    }

    /// A player that goes on with this scenario.
    ///
    /// # Errors
    /// The scenario has other lines.
    pub(super) fn of(scenario: &Scenario, memory: PlayerMemory) -> Result<Player, Failure> {
        let PlayerMemory { chances, played, due } = memory;
        let count = scenario.lines().len();
        let is_of_scenario = chances.len() == count && played.len() == count;
        if !is_of_scenario || due.iter().any(|due| due.line as usize >= count) {
            return Err("its scenario has changed".into());
        }
        let due = due.iter().map(|due| Reverse((due.at.since(Time::START), due.line as usize)));
        Ok(Player { lines: scenario.lines().iter().cloned().zip(chances).collect(), played, due: due.collect() })
    }

    pub(super) fn new(scenario: &Scenario, chance: &mut Chance) -> Player {
        let lines = scenario.lines().iter().map(|line| (line.clone(), Chance::new(chance.next_u64())));
        let lines: Vec<(Line, Chance)> = lines.collect();
        let mut player = Player { played: vec![0; lines.len()], lines, due: BinaryHeap::new() };
        for place in 0..player.lines.len() {
            if place == 0 || !player.lines[place].0.follows {
                player.begin(place, Duration::ZERO);
            }
        }
        player
    }

    /// True if all events have happened.
    pub(super) fn is_over(&self) -> bool {
        self.due.is_empty()
    }

    /// The next event that is due at this time. The inner `None` is an event for which the area has no free block.
    pub(super) fn next(&mut self, now: Duration, area: Option<&Map>) -> Option<Option<ScenarioEvent>> {
        let Reverse((at, place)) = self.due.peek().copied().filter(|Reverse((at, _))| *at <= now)?;
        self.due.pop();
        self.played[place] += 1;
        let (line, chance) = &mut self.lines[place];
        let event = draw(&line.event, chance, area);
        let is_last = line.times.is_some_and(|times| self.played[place] >= times);
        let next = at.saturating_add(line.every.draw(chance));
        if is_last || line.until.is_some_and(|until| next > until) {
            self.end(place, at);
        } else {
            self.due.push(Reverse((next, place)));
        }
        Some(event)
    }

    /// Starts a line, whose time counts from `from`. If it ends before its first event, the next line starts.
    fn begin(&mut self, mut place: usize, mut from: Duration) {
        loop {
            let (line, chance) = &mut self.lines[place];
            let first = from.saturating_add(line.time.draw(chance));
            if line.until.is_none_or(|until| first <= until) {
                self.due.push(Reverse((first, place)));
                return;
            }
            (place, from) = (place + 1, first);
            if !self.follows(place) {
                return;
            }
        }
    }

    /// Ends a line whose last event was at `at`.
    fn end(&mut self, place: usize, at: Duration) {
        if self.follows(place + 1) {
            self.begin(place + 1, at);
        }
    }

    fn follows(&self, place: usize) -> bool {
        self.lines.get(place).is_some_and(|(line, _)| line.follows)
    }
}

pub(super) fn draw(event: &EventSpec, chance: &mut Chance, area: Option<&Map>) -> Option<ScenarioEvent> {
    let exceptional = |kind, pieces| Some(ScenarioEvent::Exceptional(ExceptionalEvent { kind, pieces }));
    match event {
        EventSpec::Luggage { from, to } => {
            let from = from.value.draw(chance, area, to.value.block())?;
            Some(ScenarioEvent::Luggage { from, to: to.value.draw(chance, area, Some(from))? })
        }
        EventSpec::Visit { stops, by } => {
            let mut blocks: Vec<Block> = Vec::with_capacity(stops.len());
            for stop in stops {
                let last = blocks.last().copied();
                blocks.push(stop.value.draw(chance, area, last)?);
            }
            Some(ScenarioEvent::Visit { stops: blocks, by: by.as_ref().map(|by| by.value.draw(chance)) })
        }
        EventSpec::Landing(pieces) => exceptional(ExceptionalKind::Landing, pieces.draw(chance)),
        EventSpec::Takeoff(pieces) => exceptional(ExceptionalKind::Takeoff, pieces.draw(chance)),
        EventSpec::Breakdown(robot) => Some(ScenarioEvent::Breakdown(robot.value.draw(chance))),
        EventSpec::Gone(robot) => Some(ScenarioEvent::Gone(robot.value.draw(chance))),
        EventSpec::Raised(event) if FaultCall::is_one(event) => Some(ScenarioEvent::Raised(event.to_string())),
        EventSpec::Raised(event) => {
            let call = EventCall::read(event).ok()?;
            Some(ScenarioEvent::Raised(call.drawn(chance)))
        }
        EventSpec::End => Some(ScenarioEvent::End),
    }
}
