use crate::host::{SharedMessage, TopicDeclaration, cdr};
use crate::{Message, Time};

/// What a crate of components draws of a run in its recording (`saoms run --record`), for programs that show messages
/// of types that they know: messages on topics that no component has, made from those of the fleet.
///
/// Messages are those that were sent, before any fault acts on their ways; they come in the order in which they were
/// sent, to the thread that writes the recording.
pub trait RunDrawing: Send {
    /// Takes in that messages of a topic follow, which is [wanted](DrawingRegistration::wants): its publishers declare
    /// it so and call it `name` after renaming.
    fn topic(&mut self, name: &str, declared: &TopicDeclaration<'_>);

    /// Takes in a message that a component sent on such a topic.
    fn message(&mut self, topic: &str, message: &SharedMessage);

    /// Draws what has changed since the last call. `at` is the time for the messages: that of the run, counted from
    /// 1970 as all times in the recording.
    fn draw(&mut self, at: Time) -> Vec<DrawnMessage>;

    /// Has the next call of [`draw`](RunDrawing::draw) draw everything: another file begins.
    fn begin_again(&mut self);
}

/// A message of a drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawnMessage {
    /// The topic.
    pub topic: String,
    /// The schema of the message, as a declaration has it.
    pub schema: &'static str,
    /// The message in CDR.
    pub bytes: Vec<u8>,
}

impl DrawnMessage {
    /// A message on a topic, all of whose messages are of this type.
    pub fn new<M: Message>(topic: String, message: &M) -> DrawnMessage {
        DrawnMessage { topic, schema: M::SCHEMA, bytes: cdr::encode(message) }
    }
}

/// The registration of a [`RunDrawing`].
#[derive(Clone, Copy, Debug)]
pub struct DrawingRegistration {
    /// The last parts of the names of its topics, as `scene`: without sites they are `/scene`, and `/North/scene` in
    /// the site `North`.
    pub topics: &'static [&'static str],
    /// True if the messages of a topic are needed that its publishers declare so.
    pub wants: fn(&TopicDeclaration<'_>) -> bool,
    /// Makes the drawing of one run.
    pub new: fn() -> Box<dyn RunDrawing>,
}

inventory::collect!(DrawingRegistration);

impl DrawingRegistration {
    /// The drawings that are linked into this program, by the name of the first topic.
    pub fn linked() -> Vec<&'static DrawingRegistration> {
        let mut all: Vec<&DrawingRegistration> = inventory::iter::<DrawingRegistration>().collect();
        all.sort_by_key(|one| one.topics.first());
        all
    }
}
