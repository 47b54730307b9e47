//! Validation of messages from topics, on which any component may publish.
//!
//! A message that is impossible, or sent in another robot's name, is rejected where it arrives. It is counted, and
//! logged with its sender once for each sender and kind of mistake, so that no sender floods the log.

mod problem;
#[cfg(test)]
mod tests;
mod validate;

use std::mem::{Discriminant, discriminant};

use saoms_api::{Context, Field, Header, Level};

use crate::grid::Map;

pub(crate) use problem::Problem;
pub(crate) use validate::{LONGEST_PERIOD, Validate, of_robot};

/// Validator of the messages that one component receives.
///
/// If several components send messages as the same robot, the first of them speaks for it.
#[derive(Debug, Default)]
pub(crate) struct MessageValidator {
    /// The component that speaks for each robot, as pairs of robot and component, sorted by robot.
    speakers: Vec<(u32, u32)>,
    /// Components that requested luggage.
    requesters: Vec<u32>,
    /// True if robots announce themselves, so that a message about any other robot is rejected.
    introduced: bool,
    /// True if the component hears the robots of a part of the map alone, so that others are not unknown.
    hears_a_part: bool,
    /// Mistakes that were logged.
    logged: Vec<(u32, &'static str, Discriminant<Problem>)>,
}

/// The speakers of robots, for a component that goes on after a failure.
#[derive(Clone, Debug, Default, Field)]
pub(crate) struct SpeakerMemory {
    speakers: Vec<SpeakerOfRobot>,
    requesters: Vec<u32>,
    introduced: bool,
}

#[derive(Clone, Copy, Debug, Field)]
struct SpeakerOfRobot {
    robot: u32,
    sender: u32,
}

impl MessageValidator {
    /// The speakers, for a component that goes on. Mistakes that were logged are logged once more.
    pub(crate) fn memory(&self) -> SpeakerMemory {
        let speakers = self.speakers.iter().map(|&(robot, sender)| SpeakerOfRobot { robot, sender });
        SpeakerMemory { speakers: speakers.collect(), requesters: self.requesters.clone(), introduced: self.introduced }
    }

    /// Takes over the speakers that another one knew.
    pub(crate) fn restore(&mut self, memory: SpeakerMemory) {
        self.speakers = memory.speakers.iter().map(|known| (known.robot, known.sender)).collect();
        (self.requesters, self.introduced) = (memory.requesters, memory.introduced);
    }

    /// True if the message is accepted. The area is checked if it is known.
    #[inline]
    pub(crate) fn accepts<M: Validate>(
        &mut self,
        message: &M,
        header: Header,
        area: Option<&Map>,
        context: &mut Context<'_>,
    ) -> bool {
        let Err(problem) = message.validate(header.sender, self, area) else { return true };
        context.count("messages.ignored", 1);
        self.log_rejection(context, header, message, problem);
        false
    }

    /// Logs and counts a rejected message with its sender.
    #[cold]
    pub(crate) fn log_rejection<M: Validate>(
        &mut self,
        context: &mut Context<'_>,
        header: Header,
        message: &M,
        problem: Problem,
    ) {
        let key = (header.sender, M::WHAT, discriminant(&problem));
        if self.logged.contains(&key) {
            return;
        }
        self.logged.push(key);
        let name = |sender: u32| match context.sender_name(Header { sender, ..header }) {
            Some(name) => format!("`{name}`"),
            None => format!("component {sender}"),
        };
        let (sender, what, which) = (name(header.sender), M::WHAT, message.about());
        let from = match sender.as_str() {
            // No component has this name.
            "`(outside)`" => "an event from outside".to_owned(),
            _ => format!("what {sender} sent"),
        };
        let problem = match problem {
            Problem::Foreign { robot, speaker } => {
                format!("it has the number of robot {robot}, which {} uses", name(speaker))
            }
            problem => problem.to_string(),
        };
        context.log(
            Level::Error,
            format_args!("ignores {from}, {what} of {which}: {problem} (further ones are only counted)"),
        );
    }

    /// Records that a component speaks for a robot.
    pub(crate) fn note_speaker(&mut self, robot: u32, sender: u32) {
        if let Err(place) = self.speakers.binary_search_by_key(&robot, |(known, _)| *known) {
            self.speakers.insert(place, (robot, sender));
        }
    }

    /// True if a component speaks for a robot.
    pub(crate) fn is_speaker(&self, sender: u32) -> bool {
        self.speakers.iter().any(|(_, speaker)| *speaker == sender)
    }

    /// Records that a component requested luggage.
    pub(crate) fn note_requester(&mut self, sender: u32) {
        if !self.requesters.contains(&sender) {
            self.requesters.push(sender);
        }
    }

    /// True if a component requested luggage before.
    pub(crate) fn is_requester(&self, sender: u32) -> bool {
        self.requesters.contains(&sender)
    }

    /// Records that robots announce themselves.
    pub(crate) fn expect_introductions(&mut self) {
        self.introduced = !self.hears_a_part;
    }

    /// Records that the component hears the robots of a part of the map alone.
    pub(crate) fn hear_a_part(&mut self) {
        (self.hears_a_part, self.introduced) = (true, false);
    }

    /// Forgets who speaks for a robot that is out of earshot.
    pub(crate) fn forget_speaker(&mut self, robot: u32) {
        if let Ok(place) = self.speakers.binary_search_by_key(&robot, |(known, _)| *known) {
            self.speakers.remove(place);
        }
    }

    /// The component that speaks for a robot.
    fn speaker(&self, robot: u32) -> Option<u32> {
        let place = self.speakers.binary_search_by_key(&robot, |(known, _)| *known).ok()?;
        self.speakers.get(place).map(|(_, sender)| *sender)
    }

    /// Checks that a component may announce a robot.
    pub(crate) fn check_speaker(&mut self, robot: u32, sender: u32) -> Result<(), Problem> {
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

    /// Checks that a component may speak for a robot that was announced before.
    pub(crate) fn check_known_speaker(&mut self, robot: u32, sender: u32) -> Result<(), Problem> {
        self.check_known(robot)?;
        self.check_speaker(robot, sender)
    }

    /// Checks that a robot was announced, where robots announce themselves.
    pub(crate) fn check_known(&self, robot: u32) -> Result<(), Problem> {
        match self.speaker(robot) {
            _ if robot == 0 => Err(Problem::NoRobot),
            None if self.introduced => Err(Problem::Unknown { robot }),
            _ => Ok(()),
        }
    }
}
