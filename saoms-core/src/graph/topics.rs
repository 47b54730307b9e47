//! Which components publish and read which topics.

use std::collections::HashMap;

use super::diagram::Topic;
use super::read::View;
use crate::check::{Census, TopicUse};

/// The topics of the components whose classes are registered, those of their loops among them.
pub(super) fn of(view: &View<'_>, census: &Census) -> Vec<Topic> {
    let mut topics = Topics::default();
    for (place, (_, component)) in view.components().enumerate() {
        for one in census.topics(component.origin) {
            let topic = topics.get(one);
            let ends = if one.is_published { &mut topic.publishers } else { &mut topic.subscribers };
            ends.push(place);
        }
    }
    topics.all
}

#[derive(Default)]
struct Topics {
    all: Vec<Topic>,
    places: HashMap<String, usize>,
}

impl Topics {
    fn get(&mut self, one: &TopicUse) -> &mut Topic {
        let place = *self.places.entry(one.name.clone()).or_insert_with(|| {
            self.all.push(Topic {
                name: one.name.clone(),
                kind: one.declared.kind,
                message: one.declared.message.clone(),
                publishers: Vec::new(),
                subscribers: Vec::new(),
            });
            self.all.len() - 1
        });
        &mut self.all[place]
    }
}
