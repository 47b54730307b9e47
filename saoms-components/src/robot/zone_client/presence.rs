//! Where a robot is and what it does, as it says to zones and other robots, and repeats: no one confirms that.
//!
//! It repeats both ever less often while they stay the same, so that a run ends in which nothing happens any more. A
//! zone that was out of reach may have missed all of that. So a robot that cannot move any more, in whose way others
//! would be sent, goes on: once in each round of [`LOST_AGAIN`], which is longer than the time in which a fleet has to
//! be quiet to stand still. All robots do so at the beginning of a round, so that a fleet is quiet for the rest of it.

use std::time::Duration;

use saoms_api::{Context, Failure, Time};

use super::ZoneClient;
use crate::grid::Block;
use crate::messages::{Position, Presence, RobotList};

/// Length of a round, and the least number of the robot's periods in one.
const LOST_AGAIN: Duration = Duration::from_secs(90);
const LEAST_PERIODS: u32 = 4;

impl ZoneClient {
    /// Repeats where the robot is, after twice as many times as before, since no zone confirms it.
    ///
    /// # Errors
    /// The message cannot be sent.
    pub(crate) fn repeat_presence(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.due = self.due.saturating_add(1);
        match self.due.is_power_of_two() {
            true => self.tell_presence(context, self.said_lost.unwrap_or(false)),
            false => Ok(()),
        }
    }

    /// Repeats the messages of the robot's loops about itself, after twice as many times as before unless they change.
    ///
    /// # Errors
    /// The messages cannot be sent.
    pub(crate) fn repeat_state(
        &mut self,
        position: Position,
        robot: RobotList,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let said = (position, robot);
        if self.said.as_ref() != Some(&said) {
            self.state_due = 0;
        }
        self.state_due = self.state_due.saturating_add(1);
        if self.state_due.is_power_of_two() {
            let (position, robot) = said.clone();
            self.positions.as_ref().map_or(Ok(()), |positions| context.send(positions, position))?;
            self.robots.as_ref().map_or(Ok(()), |robots| context.send(robots, robot))?;
        }
        self.said = Some(said);
        Ok(())
    }

    /// True in the first execution of a round, for a robot that cannot move any more.
    pub(super) fn is_next_round(&mut self, context: &Context<'_>) -> bool {
        let length = LOST_AGAIN.max(context.period().saturating_mul(LEAST_PERIODS));
        let round = context.now().since(Time::START).as_nanos() / length.as_nanos();
        std::mem::replace(&mut self.lost_round, round) != round
    }

    /// Says where the robot is, to all zones.
    ///
    /// # Errors
    /// The message cannot be sent.
    pub(super) fn tell_presence(&mut self, context: &mut Context<'_>, is_lost: bool) -> Result<(), Failure> {
        let Some(passage) = &self.passage else { return Ok(()) };
        if is_lost || self.said_lost.is_some() {
            if self.said_lost != Some(is_lost) {
                self.due = 0;
            }
            self.said_lost = Some(is_lost);
        }
        let block = passage.held().first().map_or(Block::default(), |held| held.step.block);
        let presence = Presence {
            robot: passage.robot(),
            incarnation: passage.incarnation(),
            block,
            end: passage.end(),
            is_lost,
            charger: self.said_charger,
            clear: passage.clear(),
        };
        context.send(&self.presences, presence)
    }
}
