//! Validation of messages from topics, on which any component may publish.
//!
//! A message that is impossible, or sent in another robot's name, is rejected where it arrives. It is counted, and
//! logged with its sender once for each sender and kind of mistake, so that no sender floods the log.

mod problem;
mod sender;
#[cfg(test)]
mod tests;
mod validate;

use std::mem::{Discriminant, discriminant};

use saoms_api::{Context, Field, Header, Level};

use crate::grid::Map;

pub(crate) use problem::Problem;
pub(crate) use sender::Sender;
pub(crate) use validate::{LONGEST_PERIOD, Validate, of_robot};

/// Validator of the messages that one component receives.
///
/// As a robot of the fleet speaks the component that has its number, and nobody else, whoever speaks first. For a robot
/// that the fleet does not know, as one of another program, the first component speaks that sends messages as it.
#[derive(Debug, Default)]
pub(crate) struct MessageValidator {
    /// The component that speaks for each robot, or zone, as pairs of its number and the component, sorted by number.
    /// They are those of the fleet, as far as it knows them.
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
        let Err(problem) = self.judge(message, header, area, context) else { return true };
        context.count("messages.ignored", 1);
        self.log_rejection(context, header, message, problem);
        false
    }

    /// Judges a message, and does not say so. The area is checked if it is known.
    ///
    /// # Errors
    /// The message is impossible, or sent in another one's name.
    #[inline]
    pub(crate) fn judge<M: Validate>(
        &mut self,
        message: &M,
        header: Header,
        area: Option<&Map>,
        context: &Context<'_>,
    ) -> Result<(), Problem> {
        Sender::judge::<M, _>(header.sender, context, |sender| message.validate(sender, self, area))
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
            Problem::ForeignZone { zone, speaker } => {
                format!("it has the number of zone {zone}, which {} uses", name(speaker))
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
        if let Err(place) = self.place(robot) {
            self.speakers.insert(place, (robot, sender));
        }
    }

    /// True if a component speaks for a robot.
    pub(crate) fn is_speaker(&self, sender: Sender<'_>) -> bool {
        self.speaks(sender.component)
    }

    /// The same for the index of a component.
    pub(crate) fn speaks(&self, component: u32) -> bool {
        self.speakers.iter().any(|(_, speaker)| *speaker == component)
    }

    /// Records that a component requested luggage.
    pub(crate) fn note_requester(&mut self, sender: Sender<'_>) {
        if !self.requesters.contains(&sender.component) {
            self.requesters.push(sender.component);
        }
    }

    /// True if a component requested luggage before.
    pub(crate) fn is_requester(&self, sender: Sender<'_>) -> bool {
        self.requesters.contains(&sender.component)
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
        if let Ok(place) = self.place(robot) {
            self.speakers.remove(place);
        }
    }

    /// The place of the component that speaks for a robot or zone, or where it would be.
    fn place(&self, number: u32) -> Result<usize, usize> {
        self.speakers.binary_search_by_key(&number, |(known, _)| *known)
    }

    /// The component that speaks for a robot or zone.
    fn speaker(&self, number: u32) -> Option<u32> {
        self.speakers.get(self.place(number).ok()?).map(|(_, sender)| *sender)
    }

    /// Decides who speaks for a robot or zone, after a word of a component that is not known to do so. The fleet knows
    /// best, also if another one was first: it may have changed since. Returns the component.
    #[cold]
    fn settle(&mut self, number: u32, sender: Sender<'_>) -> u32 {
        match (self.place(number), sender.speaker(number)) {
            (Ok(place), own) => {
                let known = &mut self.speakers[place].1;
                *known = own.unwrap_or(*known);
                *known
            }
            // That a liar speaks in its name does not make it known.
            (Err(_), Some(own)) if own != sender.component => own,
            (Err(place), _) => {
                self.speakers.insert(place, (number, sender.component));
                sender.component
            }
        }
    }

    /// Checks that a component may announce a robot.
    #[inline]
    pub(crate) fn check_speaker(&mut self, robot: u32, sender: Sender<'_>) -> Result<(), Problem> {
        match self.speaker(robot) {
            _ if robot == 0 => Err(Problem::NoRobot),
            Some(speaker) if speaker == sender.component => Ok(()),
            _ => match self.settle(robot, sender) {
                speaker if speaker == sender.component => Ok(()),
                speaker => Err(Problem::Foreign { robot, speaker }),
            },
        }
    }

    /// Checks that a component may speak for a zone. A fleet knows all its zones: nobody else grants anything.
    #[inline]
    pub(crate) fn check_zone(&mut self, zone: u32, sender: Sender<'_>) -> Result<(), Problem> {
        match self.speaker(zone) {
            Some(speaker) if speaker == sender.component => Ok(()),
            _ if zone == 0 || sender.speaker(zone).is_none() => Err(Problem::UnknownZone { zone }),
            _ => match self.settle(zone, sender) {
                speaker if speaker == sender.component => Ok(()),
                speaker => Err(Problem::ForeignZone { zone, speaker }),
            },
        }
    }

    /// Checks that a component may speak for a robot that was announced before.
    pub(crate) fn check_known_speaker(&mut self, robot: u32, sender: Sender<'_>) -> Result<(), Problem> {
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
