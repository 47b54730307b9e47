use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use saoms_api::extension::RunPicture;
use saoms_api::host::{SharedMessage, TopicDeclaration};

use super::picture::{self, Panel};
use super::recording::{Content, Recording};
use crate::grid::Block;
use crate::messages::{EventLuggage, LuggageStage};

/// The messages of a run, those of each world apart.
///
/// Robots of two worlds may have one number: all is kept by the path of the component that the robots drive in.
#[derive(Debug, Default)]
pub(super) struct Worlds {
    /// The component that each robot drives in, by the robot's path.
    around: HashMap<String, String>,
    /// The components around the robots that read a topic.
    readers: HashMap<String, BTreeSet<String>>,
    topics: HashMap<String, Content>,
    /// By the component around the robots that said it; without one, by the path of the composite that they are in.
    recordings: BTreeMap<String, Recording>,
    /// Luggage that was asked for and not delivered, by its topic: where it was to be collected.
    requests: BTreeMap<String, BTreeMap<u32, Block>>,
}

/// The reference of a robot to the world.
const WORLD: &str = "world";

impl RunPicture for Worlds {
    fn wire(&mut self, component: &str, reference: &str, target: &str) {
        if reference == WORLD {
            self.around.insert(component.to_owned(), target.to_owned());
        }
    }

    fn reader(&mut self, topic: &str, component: &str) {
        let key = match self.around.get(component) {
            Some(around) => around,
            None => composite(component),
        };
        match self.readers.get_mut(topic) {
            Some(known) if known.contains(key) => {}
            Some(known) => _ = known.insert(key.to_owned()),
            None => _ = self.readers.insert(topic.to_owned(), BTreeSet::from([key.to_owned()])),
        }
    }

    fn wants_topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        let Some(content) = Content::of(declared) else { return false };
        self.topics.insert(name.to_owned(), content);
        true
    }

    fn message(&mut self, topic: &str, component: &Arc<str>, message: &SharedMessage) {
        let Some(&content) = self.topics.get(topic) else { return };
        if content == Content::Fault {
            // The robot is where it was seen.
            for (_, recording) in self.recordings.iter_mut().filter(|(key, _)| hears(&self.readers, topic, key)) {
                recording.record(content, component, message, None);
            }
            return;
        }
        let mut from = None;
        if let Some(event) = message.get::<EventLuggage>().filter(|_| content == Content::Luggage) {
            match event.stage {
                LuggageStage::Request => {
                    self.requests.entry(topic.to_owned()).or_default().insert(event.luggage, event.from);
                    return;
                }
                LuggageStage::Delivered => {
                    from = self.requests.get_mut(topic).and_then(|open| open.remove(&event.luggage));
                }
                // The master says that no robot can bring it.
                LuggageStage::GivenUp if event.robot == 0 => return,
                _ => {}
            }
        }
        let key = match (self.around.get(&**component), content) {
            (Some(around), _) => around,
            (None, Content::Area | Content::Collision) => &**component,
            (None, _) => composite(component),
        };
        match self.recordings.get_mut(key) {
            Some(recording) => recording.record(content, component, message, from),
            None => {
                let mut recording = Recording::default();
                recording.record(content, component, message, from);
                self.recordings.insert(key.to_owned(), recording);
            }
        }
    }

    fn draw(&mut self, title: &str, outcome: &str) -> String {
        match &self.panels()[..] {
            [panel] => picture::draw(&panel.recording, title, outcome),
            panels => picture::draw_several(panels, title, outcome),
        }
    }
}

impl Worlds {
    /// A panel for each world with robots, and one for robots without a world, or more where their numbers are the
    /// same. Without a world or with a single one, these are one panel.
    fn panels(&mut self) -> Vec<Panel> {
        let mut all = std::mem::take(&mut self.recordings);
        for (topic, open) in std::mem::take(&mut self.requests) {
            for (_, recording) in all.iter_mut().filter(|(key, _)| hears(&self.readers, &topic, key)) {
                recording.open.extend(open.iter().map(|(luggage, block)| (*luggage, *block)));
            }
        }
        let is_world = |recording: &Recording| recording.map.is_some() && !recording.robots.is_empty();
        let is_one = all.values().filter(|recording| is_world(recording)).count() < 2;
        let (mut worlds, mut others) = (Vec::new(), Vec::<Panel>::new());
        for (name, mut recording) in all {
            if !is_one && is_world(&recording) {
                worlds.push(Panel { name, recording });
                continue;
            }
            if !is_one {
                recording.map = None;
            }
            let mut known = others.iter_mut().map(|panel| &mut panel.recording);
            match known.find(|known| known.robots.keys().all(|robot| !recording.robots.contains_key(robot))) {
                Some(known) => known.absorb(recording),
                None => others.push(Panel { name: format!("without a world: {name}"), recording }),
            }
        }
        let is_empty = |panel: &Panel| panel.recording.robots.is_empty();
        others.retain(|panel| is_one || !is_empty(panel));
        worlds.extend(others);
        if worlds.is_empty() {
            worlds.push(Panel { name: String::new(), recording: Recording::default() });
        }
        worlds
    }
}

/// The path of the composite that a component is in, empty for the first.
fn composite(component: &str) -> &str {
    component.rsplit_once('/').map_or("", |(composite, _)| composite)
}

/// True if the robots of a recording read a topic.
fn hears(readers: &HashMap<String, BTreeSet<String>>, topic: &str, key: &str) -> bool {
    readers.get(topic).is_some_and(|known| known.contains(key))
}

#[cfg(test)]
mod tests {
    use saoms_api::{Cause, Header, Message, Time};

    use super::*;
    use crate::hardware::Area;
    use crate::messages::{FAULT, Fault, POSITION, Position};

    fn say<M: Message>(worlds: &mut Worlds, topic: &str, component: &str, message: M) {
        let header = Header { sender: 0, sent: Time::START, cause: Cause::default() };
        worlds.message(topic, &Arc::from(component), &SharedMessage::new(header, message));
    }

    /// Robots of the number 1 at two sites, one of which breaks: what is drawn of each.
    fn two_sites(worlds: [Option<&str>; 2]) -> Vec<(String, Vec<u32>, usize)> {
        let mut all = Worlds::default();
        for (site, world) in ["North", "South"].into_iter().zip(worlds) {
            let robot = format!("{site}/Robot1");
            if let Some(world) = world {
                all.wire(&robot, WORLD, world);
            }
            all.reader(&format!("{site}.fault"), &robot);
            assert!(all.wants_topic(&format!("{site}.position"), &POSITION.declaration()));
            assert!(all.wants_topic(&format!("{site}.fault"), &FAULT.declaration()));
            say(&mut all, &format!("{site}.position"), &robot, Position { robot: 1, ..Position::default() });
        }
        for recording in all.recordings.values_mut() {
            recording.map = worlds[0].and_then(|_| Area { width: 1, height: 1, blocked: vec![0] }.into());
        }
        say(&mut all, "South.fault", "South/Master", Fault::breakdown(1));
        let panels = all.panels().into_iter();
        panels
            .map(|Panel { name, recording }| {
                (name, recording.robots.keys().copied().collect(), recording.breakdowns.len())
            })
            .collect()
    }

    #[test]
    fn robots_of_two_worlds_may_have_one_number() {
        let expected = |names: [&str; 2]| vec![(names[0].to_owned(), vec![1], 0), (names[1].to_owned(), vec![1], 1)];
        let worlds = [Some("North/World"), Some("South/World")];
        assert_eq!(two_sites(worlds), expected(["North/World", "South/World"]));
        assert_eq!(two_sites([None, None]), expected(["without a world: North", "without a world: South"]));
    }
}
