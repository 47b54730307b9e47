use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::time::Duration;

use saoms_api::Chance;

use super::scenario::{Happening, Line, Scenario};
use crate::grid::{Block, Map};
use crate::messages::{ExceptionalEvent, ExceptionalKind};

/// Something that happens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// Luggage waits to be brought somewhere.
    Luggage {
        /// Where it is.
        from: Block,
        /// Where it has to go.
        to: Block,
    },
    /// A landing or a take-off.
    Exceptional(ExceptionalEvent),
    /// The robot of this number breaks down.
    Breakdown(u32),
    /// Nothing: the scenario lasts until then.
    End,
}

/// Plays a scenario: gives its events at their times, what is left to chance drawn.
///
/// Each line has a source of chance of its own, so that another line more or less changes nothing in it.
#[derive(Debug)]
pub(super) struct Player {
    lines: Vec<(Line, Chance)>,
    /// How many events each line had.
    played: Vec<u64>,
    /// The time of the next event of each line that goes on.
    due: BinaryHeap<Reverse<(Duration, usize)>>,
}

impl Player {
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

    /// Whether all has happened.
    pub(super) fn is_over(&self) -> bool {
        self.due.is_empty()
    }

    /// The next event that is due at this time; the inner `None` is one for which there is no block in the area.
    pub(super) fn next(&mut self, now: Duration, area: Option<&Map>) -> Option<Option<Event>> {
        let Reverse((at, place)) = self.due.peek().copied().filter(|Reverse((at, _))| *at <= now)?;
        self.due.pop();
        self.played[place] += 1;
        let (line, chance) = &mut self.lines[place];
        let event = draw(&line.happening, chance, area);
        let is_last = line.times.is_some_and(|times| self.played[place] >= times);
        let next = at.saturating_add(line.every.draw(chance));
        if is_last || line.until.is_some_and(|until| next > until) {
            self.end(place, at);
        } else {
            self.due.push(Reverse((next, place)));
        }
        Some(event)
    }

    /// Lets a line begin; its time counts from here. One that is over before its first event lets the next begin.
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

    /// The last event of a line was then.
    fn end(&mut self, place: usize, at: Duration) {
        if self.follows(place + 1) {
            self.begin(place + 1, at);
        }
    }

    fn follows(&self, place: usize) -> bool {
        self.lines.get(place).is_some_and(|(line, _)| line.follows)
    }
}

pub(super) fn draw(happening: &Happening, chance: &mut Chance, area: Option<&Map>) -> Option<Event> {
    let exceptional = |kind, pieces| Some(Event::Exceptional(ExceptionalEvent { kind, pieces }));
    match happening {
        Happening::Luggage { from, to } => {
            let from = from.value.draw(chance, area, to.value.block())?;
            Some(Event::Luggage { from, to: to.value.draw(chance, area, Some(from))? })
        }
        Happening::Landing(pieces) => exceptional(ExceptionalKind::Landing, pieces.draw(chance)),
        Happening::Takeoff(pieces) => exceptional(ExceptionalKind::Takeoff, pieces.draw(chance)),
        Happening::Breakdown(robot) => Some(Event::Breakdown(robot.value.draw(chance))),
        Happening::End => Some(Event::End),
    }
}
