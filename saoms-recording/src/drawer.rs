//! When a run is drawn: at most ten times a second of it, and only where it has changed.

use std::collections::HashSet;

use saoms_api::Time;
use saoms_api::extension::{DrawingRegistration, DrawnMessage, RunDrawing};
use saoms_api::host::contain::contained;
use saoms_api::host::{SharedMessage, TopicDeclaration, TopicKind};

/// The least time between two pictures.
const EVERY: u64 = 100_000_000;
/// Nanoseconds after each byte of a picture: those of large fleets come less often, 2 MB in a second.
const OF_BYTE: u64 = 500;

/// What drawings hear.
pub(crate) enum Heard {
    /// Messages of a topic follow.
    Topic(HeardTopic),
    /// A message of a topic, by the number of the topic.
    Message(usize, SharedMessage),
}

/// A topic that drawings hear, as its publishers declare it.
pub(crate) struct HeardTopic {
    pub(crate) name: String,
    pub(crate) declared: String,
    pub(crate) kind: TopicKind,
    pub(crate) message: String,
    pub(crate) schema: String,
}

/// The drawings of a run.
pub(crate) struct Drawer {
    drawings: Vec<Drawing>,
    topics: Vec<HeardTopic>,
    /// When the next picture is due: something was heard since the last one.
    due: Option<u64>,
    /// The next picture is not due before.
    next: u64,
}

struct Drawing {
    wants: fn(&TopicDeclaration<'_>) -> bool,
    drawing: Box<dyn RunDrawing>,
    /// The numbers of the topics that it hears.
    topics: HashSet<usize>,
}

impl HeardTopic {
    pub(crate) fn of(name: &str, declared: &TopicDeclaration<'_>) -> HeardTopic {
        let TopicDeclaration { name: before, kind, message, schema } = *declared;
        let (message, schema) = (message.to_owned(), schema.to_owned());
        HeardTopic { name: name.to_owned(), declared: before.to_owned(), kind, message, schema }
    }

    fn declaration(&self) -> TopicDeclaration<'_> {
        let HeardTopic { declared, kind, message, schema, .. } = self;
        TopicDeclaration { name: declared, kind: *kind, message, schema }
    }
}

impl Drawer {
    pub(crate) fn new(registrations: &[&DrawingRegistration]) -> Drawer {
        let drawing = |one: &&DrawingRegistration| contained(|| (one.new)()).ok().map(|drawing| (one.wants, drawing));
        let drawings = registrations.iter().filter_map(drawing);
        let drawings = drawings.map(|(wants, drawing)| Drawing { wants, drawing, topics: HashSet::new() }).collect();
        Drawer { drawings, topics: Vec::new(), due: None, next: 0 }
    }

    /// Takes in a topic, or a message that was sent at a time.
    pub(crate) fn hear(&mut self, heard: Heard, at: impl Fn(Time) -> u64) {
        match heard {
            Heard::Topic(topic) => {
                let number = self.topics.len();
                each(&mut self.drawings, |one| {
                    let declared = topic.declaration();
                    if (one.wants)(&declared) {
                        one.topics.insert(number);
                        one.drawing.topic(&topic.name, &declared);
                    }
                });
                self.topics.push(topic);
            }
            Heard::Message(number, message) => {
                let Some(topic) = self.topics.get(number) else { return };
                self.due.get_or_insert(at(message.header().sent).max(self.next));
                each(&mut self.drawings, |one| {
                    if one.topics.contains(&number) {
                        one.drawing.message(&topic.name, &message);
                    }
                });
            }
        }
    }

    /// When the next picture is due, if that is before a time. What happens at one instant is in one picture.
    pub(crate) fn due_before(&self, time: u64) -> Option<u64> {
        self.due.filter(|due| *due < time)
    }

    /// Draws what has changed, at a time.
    pub(crate) fn draw(&mut self, at: u64) -> Vec<DrawnMessage> {
        let mut drawn = Vec::new();
        each(&mut self.drawings, |one| drawn.extend(one.drawing.draw(Time::from_nanos(at))));
        let bytes: u64 = drawn.iter().map(|one| one.bytes.len() as u64).sum();
        (self.due, self.next) = (None, at.saturating_add(bytes.saturating_mul(OF_BYTE).max(EVERY)));
        drawn
    }

    /// Has the next picture show everything.
    pub(crate) fn begin_again(&mut self) {
        each(&mut self.drawings, |one| one.drawing.begin_again());
    }
}

/// Calls each drawing; one that panics draws nothing any more.
fn each(drawings: &mut Vec<Drawing>, mut call: impl FnMut(&mut Drawing)) {
    drawings.retain_mut(|one| contained(|| call(one)).is_ok());
}
