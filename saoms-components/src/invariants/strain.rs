//! What excuses an empty battery: a fault drains it, takes the charger of its robot, or keeps the robot from its grants
//! for longer than its battery lasts.

use saoms_api::Time;
use saoms_api::host::SharedMessage;

use super::robots::Robots;
use crate::grid::Block;
use crate::messages::{Drain, Outage, RobotList, Slow, end_of};

/// The battery of a robot, as it says.
#[derive(Debug, Default)]
pub(super) struct Supply {
    /// In percent.
    level: f64,
    /// When that was said.
    said: Time,
    /// What it has lost since it was charged at blocks where faults kept it from its grants, in percent.
    kept: f64,
    /// What else it has lost since then, and the number of blocks that it has entered.
    used: f64,
    moves: u32,
    /// The end of the faults that drain it or took its charger since it was charged; the inner `None` is never.
    strained: Option<Option<Time>>,
}

impl Supply {
    /// Notes a fault that drains the battery, or takes the charger, until a time.
    fn strain(&mut self, until: Option<Time>) {
        self.strained = Some(match self.strained {
            Some(before) => before.zip(until).map(|(one, other)| one.max(other)),
            None => until,
        });
    }

    /// Notes that the robot entered a block.
    pub(super) fn note_move(&mut self) {
        self.moves = self.moves.saturating_add(1);
    }

    /// Notes what the robot says, which faults may keep from its grants. `moved` is when it entered its block. True if
    /// its battery has gained.
    pub(super) fn hear(
        &mut self,
        state: &RobotList,
        (at, moved): (Time, Time),
        is_kept: bool,
        outages: &Outages,
    ) -> bool {
        let gains = state.battery > self.level;
        if let Some(until) = outages.of(state.charger, at) {
            self.strain(until);
        }
        if gains {
            (self.kept, self.used, self.moves) = (0.0, 0.0, 0);
            self.strained = self.strained.filter(|until| until.is_none_or(|until| at < until));
        } else if is_kept && moved <= self.said {
            self.kept += self.level - state.battery;
        } else {
            self.used += self.level - state.battery;
        }
        (self.level, self.said) = (state.battery, at);
        gains
    }

    /// True if faults are why the battery is empty so many blocks from its charger: they drained it, or took the
    /// charger, or what it lost while they kept the robot would have lasted for these blocks, as it drove before.
    pub(super) fn is_excused(&self, blocks: u32) -> bool {
        let needed = self.used / f64::from(self.moves.max(1)) * f64::from(blocks);
        self.strained.is_some() || self.kept > 0.0 && self.kept >= needed
    }
}

/// Chargers that give nothing, and until when.
#[derive(Debug, Default)]
pub(super) struct Outages(Vec<(Block, Option<Time>)>);

impl Outages {
    /// The end of the outage of a charger.
    fn of(&self, charger: Block, at: Time) -> Option<Option<Time>> {
        let is_on = |until: Option<Time>| until.is_none_or(|until| at < until);
        self.0.iter().find(|(block, until)| *block == charger && is_on(*until)).map(|(_, until)| *until)
    }
}

impl Robots {
    /// Notes a robot that is slow; gives the end of that.
    pub(super) fn hear_slow(&mut self, message: &SharedMessage) -> Option<Time> {
        let at = message.header().sent;
        let Some(Slow { robot, lasting, .. }) = message.get::<Slow>() else { return Some(at) };
        // It set out with another pace. Once it has charged it knows this one.
        self.supply(*robot).strain(Some(at));
        end_of(at, lasting.as_ref())
    }

    /// Notes a battery that a fault drains; gives the end of that.
    pub(super) fn hear_drain(&mut self, message: &SharedMessage) -> Option<Time> {
        let at = message.header().sent;
        let Some(Drain { robot, factor, lasting, .. }) = message.get::<Drain>() else { return Some(at) };
        let until = if factor.is_some() { end_of(at, lasting.as_ref()) } else { Some(at) };
        self.supply(*robot).strain(until);
        until
    }

    /// Notes a charger that gives nothing; gives the end of that.
    pub(super) fn hear_outage(&mut self, message: &SharedMessage) -> Option<Time> {
        let at = message.header().sent;
        let Some(Outage { charger, lasting }) = message.get::<Outage>() else { return Some(at) };
        let until = end_of(at, lasting.as_ref());
        self.outages().0.push((*charger, until));
        until
    }
}
