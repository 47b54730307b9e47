//! State of a world, for the one that takes its place after a failure.

use std::time::Duration;

use saoms_api::{Failure, Field, Message, Saved, Time, Work};

use super::World;
use super::luggage::{PieceMemory, Stock};
use super::referee::{Body, Meeting, Referee, Slowness};
use super::strain::EarlyFault;
use crate::grid::Block;
use crate::hardware::{Action, Progress};
use crate::messages::Removal;
use crate::state::Numbers;
use crate::validation::SpeakerMemory;

/// The newest saved state, as long as nothing changed since: most calls only ask.
#[derive(Debug, Default)]
pub(super) struct Memory(Option<Saved>);

impl Memory {
    /// Something has changed, or may have.
    pub(super) fn forget(&mut self) {
        self.0 = None;
    }
}

#[derive(Clone, Debug, Message)]
struct WorldMemory {
    bodies: Vec<BodyMemory>,
    meetings: Vec<Meeting>,
    stock: StockMemory,
    speakers: SpeakerMemory,
    is_done: Option<bool>,
    collided: u64,
    broken: Vec<u32>,
    left: Vec<Removal>,
    early: Vec<EarlyFault>,
}

#[derive(Clone, Debug, Field)]
struct BodyMemory {
    robot: u32,
    name: String,
    block: Block,
    moving: Option<Moving>,
    handling: Option<Handling>,
    handled: Option<Handled>,
    retired: bool,
    gone: bool,
    entered: Time,
    entered_again: bool,
    period_us: u64,
    slow: Option<Slowness>,
}

#[derive(Clone, Copy, Debug, Field)]
struct Moving {
    to: Block,
    until: Time,
}

#[derive(Clone, Copy, Debug, Field)]
struct Handling {
    action: Action,
    until: Time,
}

#[derive(Clone, Copy, Debug, Field)]
struct Handled {
    action: Action,
    progress: Progress,
}

/// Pieces of luggage: of those that are delivered, the numbers.
#[derive(Clone, Debug, Field)]
pub(super) struct StockMemory {
    pub(super) pieces: Vec<PieceMemory>,
    pub(super) delivered: Numbers,
    pub(super) awaited: Vec<u32>,
    pub(super) settled: Vec<u32>,
}

impl BodyMemory {
    fn of((robot, body): (&u32, &Body)) -> BodyMemory {
        BodyMemory {
            robot: *robot,
            name: body.name.clone(),
            block: body.block,
            moving: body.moving.map(|(to, until)| Moving { to, until }),
            handling: body.handling.map(|(action, until)| Handling { action, until }),
            handled: body.handled.map(|(action, progress)| Handled { action, progress }),
            retired: body.retired,
            gone: body.gone,
            entered: body.entered,
            entered_again: body.entered_again,
            period_us: u64::try_from(body.period.as_micros()).unwrap_or(u64::MAX),
            slow: body.slow,
        }
    }

    fn body(self) -> (u32, Body) {
        let body = Body {
            name: self.name,
            block: self.block,
            moving: self.moving.map(|moving| (moving.to, moving.until)),
            handling: self.handling.map(|handling| (handling.action, handling.until)),
            handled: self.handled.map(|handled| (handled.action, handled.progress)),
            retired: self.retired,
            gone: self.gone,
            entered: self.entered,
            entered_again: self.entered_again,
            period: Duration::from_micros(self.period_us),
            slow: self.slow,
            moved: (Time::START, false),
        };
        (self.robot, body)
    }
}

impl World {
    pub(super) fn save_state(&mut self) -> Saved {
        let saved = self.memory.0.take().unwrap_or_else(|| self.state());
        self.memory.0.insert(saved).clone()
    }

    fn state(&self) -> Saved {
        let is_done = self.vote.map(|vote| vote == Work::Done);
        Saved::of(&WorldMemory {
            bodies: self.referee.bodies().map(BodyMemory::of).collect(),
            meetings: self.referee.meetings().to_vec(),
            stock: self.stock.memory(),
            speakers: self.validator.memory(),
            is_done,
            collided: self.collided as u64,
            broken: self.broken.iter().copied().collect(),
            left: self.left.values().cloned().collect(),
            early: self.early.clone(),
        })
    }

    pub(super) fn restore_state(&mut self, saved: &Saved) -> Result<(), Failure> {
        let Some(memory) = saved.read::<WorldMemory>()? else { return Ok(()) };
        let bodies = memory.bodies.into_iter().map(BodyMemory::body);
        self.referee = Referee::with(self.referee.map().clone(), bodies, memory.meetings);
        self.stock = Stock::of(memory.stock);
        self.validator.restore(memory.speakers);
        self.vote = memory.is_done.map(|is_done| if is_done { Work::Done } else { Work::Open });
        self.collided = usize::try_from(memory.collided).unwrap_or(usize::MAX);
        self.broken = memory.broken.into_iter().collect();
        self.left = memory.left.into_iter().map(|left| (left.robot, left)).collect();
        self.early = memory.early;
        self.memory.forget();
        Ok(())
    }
}
