//! Which components publish and read which topics.

use std::collections::HashMap;

use super::diagram::Topic;
use super::read::{View, class_of};
use crate::check::topic_renames;
use crate::model::{Component, Composite};
use crate::registry::{Registry, TopicDeclaration};

/// The topics of the components whose classes are registered.
pub(super) fn of(view: &View<'_>, registry: &Registry) -> Vec<Topic> {
    let mut topics = Topics::default();
    for (place, (composite, component)) in view.components().enumerate() {
        let Some(class) = class_of(component, registry) else { continue };
        if value(component, "useJMS", composite) == Some("false") {
            continue;
        }
        let renames = value(component, "topicRename", composite).unwrap_or_default();
        let renames: HashMap<&str, &str> = topic_renames(renames).collect();
        let declaration = class.declaration();
        for topic in &declaration.publishes {
            topics.get(topic, &renames).publishers.push(place);
        }
        for topic in &declaration.subscribes {
            topics.get(topic, &renames).subscribers.push(place);
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
    fn get(&mut self, declared: &TopicDeclaration, renames: &HashMap<&str, &str>) -> &mut Topic {
        let name = renames.get(&*declared.name).copied().unwrap_or(&declared.name);
        let place = *self.places.entry(name.to_owned()).or_insert_with(|| {
            self.all.push(Topic {
                name: name.to_owned(),
                kind: declared.kind,
                message: declared.message.clone(),
                publishers: Vec::new(),
                subscribers: Vec::new(),
            });
            self.all.len() - 1
        });
        &mut self.all[place]
    }
}

/// The value of a component's property, that of a property of the composite where it comes from there.
fn value<'c>(component: &'c Component, name: &str, composite: &'c Composite) -> Option<&'c str> {
    let property = component.property(name)?;
    if let Some(value) = property.simple_value() {
        return Some(value.as_str());
    }
    let source = property.source()?.as_str().strip_prefix('$')?;
    let property = composite.properties.iter().find(|property| property.name == *source)?;
    property.simple_value().map(|value| value.as_str())
}
