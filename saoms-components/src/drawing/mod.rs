//! The drawing of a fleet in its recording (`saoms run --record`): map, robots and luggage as messages that Foxglove
//! and Lichtblick draw. `docs/recording.md` has the topics.
//!
//! A message of a topic shows all that its topic is about, so that who goes to any time sees all of it. The robots are
//! drawn in frames of their own, which move: their entities change only where what is said of them does.

mod colours;
mod floor;
mod messages;
mod robots;
mod site;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::collections::HashMap;

use saoms_api::Time;
use saoms_api::extension::{DrawingRegistration, DrawnMessage, RunDrawing, submit};
use saoms_api::host::{SharedMessage, TopicDeclaration};

use crate::hardware::Area;
use crate::messages::{
    AREA, EVENT_LUGGAGE, EventLuggage, FAULT, Fault, HANDLING, Handling, POSITION, Position, REMOVAL, ROBOT_LIST,
    Removal, RobotList, TERRITORY, Territory, carries,
};
use site::Site;

submit! {
    DrawingRegistration {
        topics: &["scene", "floor", "map", "tf"],
        wants: |declared| Content::of(declared).is_some(),
        new: || Box::new(Sites::default()),
    }
}

/// What the messages of a topic are.
#[derive(Clone, Copy, Debug)]
enum Content {
    Area,
    Fault,
    Handling,
    Luggage,
    Position,
    Removal,
    Robot,
    Territory,
}

impl Content {
    fn of(declared: &TopicDeclaration<'_>) -> Option<Content> {
        Some(match declared {
            one if carries(one, &AREA) => Content::Area,
            one if carries(one, &FAULT) => Content::Fault,
            one if carries(one, &HANDLING) => Content::Handling,
            one if carries(one, &EVENT_LUGGAGE) => Content::Luggage,
            one if carries(one, &POSITION) => Content::Position,
            one if carries(one, &REMOVAL) => Content::Removal,
            one if carries(one, &ROBOT_LIST) => Content::Robot,
            one if carries(one, &TERRITORY) => Content::Territory,
            _ => return None,
        })
    }
}

/// The sites of a run, each with a scene of its own.
#[derive(Debug, Default)]
struct Sites {
    /// By the name of the topic, what its messages are, and the site.
    topics: HashMap<String, (Content, String)>,
    sites: BTreeMap<String, Site>,
}

impl RunDrawing for Sites {
    fn topic(&mut self, name: &str, declared: &TopicDeclaration<'_>) {
        let Some(content) = Content::of(declared) else { return };
        let site = name.rsplit_once('/').map_or("", |(site, _)| site);
        self.sites.entry(site.to_owned()).or_insert_with(|| Site::new(site));
        self.topics.insert(name.to_owned(), (content, site.to_owned()));
    }

    fn message(&mut self, topic: &str, message: &SharedMessage) {
        let Some((content, site)) = self.topics.get(topic) else { return };
        let Some(site) = self.sites.get_mut(site) else { return };
        match content {
            Content::Area => _ = message.get::<Area>().map(|area| site.area(area)),
            Content::Fault => _ = message.get::<Fault>().map(|fault| site.fault(fault)),
            Content::Handling => _ = message.get::<Handling>().map(|handling| site.handling(handling)),
            Content::Luggage => _ = message.get::<EventLuggage>().map(|event| site.luggage(event)),
            Content::Position => _ = message.get::<Position>().map(|position| site.position(position)),
            Content::Removal => _ = message.get::<Removal>().map(|removal| site.removal(removal)),
            Content::Robot => _ = message.get::<RobotList>().map(|robot| site.robot(robot)),
            Content::Territory => _ = message.get::<Territory>().map(|territory| site.territory(territory)),
        }
    }

    fn draw(&mut self, at: Time) -> Vec<DrawnMessage> {
        let mut drawn = Vec::new();
        self.sites.values_mut().for_each(|site| site.draw(at.into(), &mut drawn));
        drawn
    }

    fn begin_again(&mut self) {
        self.sites.values_mut().for_each(Site::begin_again);
    }
}
