//! What components let in from their topics, where anybody may publish.
//!
//! A message that cannot be, or that is said in another robot's name, is judged where it comes in. It is not taken in, counted, and logged with its
//! sender: once for each sender and kind of mistake, so that nobody floods the log.

mod judge;
mod problem;
#[cfg(test)]
mod tests;

use std::mem::{Discriminant, discriminant};

use saoms_api::{Context, Header, Level};

use crate::grid::Map;

pub(crate) use judge::Judged;
pub(crate) use problem::Problem;

/// What one component knows about those that talk to it.
///
/// Of several components that say something as one robot, the first speaks for it.
#[derive(Debug, Default)]
pub(crate) struct Intake {
    /// Which component speaks for which robot, by robot.
    speakers: Vec<(u32, u32)>,
    /// Whether robots say that they are there, so that one that does not is none.
    introduced: bool,
    /// Who was told what is wrong.
    told: Vec<(u32, &'static str, Discriminant<Problem>)>,
}

impl Intake {
    /// Whether to take a message in; the area as far as it is known.
    #[inline]
    pub(crate) fn lets_in<M: Judged>(
        &mut self,
        message: &M,
        header: Header,
        area: Option<&Map>,
        context: &mut Context<'_>,
    ) -> bool {
        let Err(problem) = message.judge(header.sender, self, area) else { return true };
        context.count("messages.ignored", 1);
        self.tell(context, header, message, problem);
        false
    }

    /// Logs what is not taken in, with its sender.
    #[cold]
    pub(crate) fn tell<M: Judged>(
        &mut self,
        context: &mut Context<'_>,
        header: Header,
        message: &M,
        problem: Problem,
    ) {
        let key = (header.sender, M::WHAT, discriminant(&problem));
        if self.told.contains(&key) {
            return;
        }
        self.told.push(key);
        let name = |sender: u32| match context.sender_name(Header { sender, ..header }) {
            Some(name) => format!("`{name}`"),
            None => format!("component {sender}"),
        };
        let (sender, what, which) = (name(header.sender), M::WHAT, message.about());
        let problem = match problem {
            Problem::Foreign { robot, speaker } => {
                format!("it is in the name of robot {robot}, for which {} speaks", name(speaker))
            }
            problem => problem.to_string(),
        };
        context.log(
            Level::Error,
            format_args!(
                "ignores what {sender} sent, {what} of {which}: {problem} (more of this kind is only counted)"
            ),
        );
    }

    /// Notes for which robot a component speaks.
    pub(crate) fn note_speaker(&mut self, robot: u32, sender: u32) {
        if let Err(place) = self.speakers.binary_search_by_key(&robot, |(known, _)| *known) {
            self.speakers.insert(place, (robot, sender));
        }
    }

    /// Who speaks for a robot.
    fn speaker(&self, robot: u32) -> Option<u32> {
        let place = self.speakers.binary_search_by_key(&robot, |(known, _)| *known).ok()?;
        self.speakers.get(place).map(|(_, sender)| *sender)
    }

    /// Whether a component may say for the first time that a robot is there.
    fn check_speaker(&mut self, robot: u32, sender: u32) -> Result<(), Problem> {
        match self.speaker(robot) {
            _ if robot == 0 => Err(Problem::NoRobot),
            Some(speaker) if speaker != sender => Err(Problem::Foreign { robot, speaker }),
            Some(_) => Ok(()),
            None => {
                self.note_speaker(robot, sender);
                Ok(())
            }
        }
    }

    /// Whether a component may speak for a robot that has to be there already.
    fn check_known_speaker(&mut self, robot: u32, sender: u32) -> Result<(), Problem> {
        self.check_known(robot)?;
        self.check_speaker(robot, sender)
    }

    fn check_known(&self, robot: u32) -> Result<(), Problem> {
        match self.speaker(robot) {
            _ if robot == 0 => Err(Problem::NoRobot),
            None if self.introduced => Err(Problem::Unknown { robot }),
            _ => Ok(()),
        }
    }
}
