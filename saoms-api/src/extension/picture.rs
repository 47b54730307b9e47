use std::sync::Arc;

use crate::host::{SharedMessage, TopicDeclaration};

/// A picture of a run, drawn from the messages of the fleet.
pub trait RunPicture: Send {
    /// Takes in a wire of the fleet: the paths of the components at its ends. All wires come before the readers.
    fn wire(&mut self, component: &str, reference: &str, target: &str) {
        let _ = (component, reference, target);
    }

    /// Takes in that a component reads a topic, by the topic's name after renaming. All readers come before the first
    /// message.
    fn reader(&mut self, topic: &str, component: &str) {
        let _ = (topic, component);
    }

    /// True if the picture shows the messages of a topic, which its publishers declare so and call `name` after
    /// renaming. Asked before the first message of the topic.
    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool;

    /// Takes in a message that a component sent on such a topic; `component` is the path of the component. The messages
    /// of a run come in the order in which they were sent.
    fn message(&mut self, topic: &str, component: &Arc<str>, message: &SharedMessage);

    /// The picture as an SVG document, under a title and a line about the end of the run. Called once.
    fn draw(&mut self, title: &str, outcome: &str) -> String;
}

/// The registration of a [`RunPicture`].
#[derive(Clone, Copy, Debug)]
pub struct PictureRegistration {
    /// The name of the picture; `saoms run --paths FILE` draws the one named `paths`.
    pub name: &'static str,
    /// Makes a picture without any message.
    pub new: fn() -> Box<dyn RunPicture>,
}

inventory::collect!(PictureRegistration);

impl PictureRegistration {
    /// The picture of this name, if one is linked into this program.
    pub fn linked(name: &str) -> Option<&'static PictureRegistration> {
        inventory::iter::<PictureRegistration>().find(|picture| picture.name == name)
    }
}
