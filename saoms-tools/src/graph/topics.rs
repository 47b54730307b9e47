//! Topics with the components that publish and read them.

use std::collections::HashMap;

use super::diagram::{Diagram, DiagramTopic};
use super::read::View;
use saoms_lang::check::TopicUse;

/// The topics of the components whose classes are registered, those of their loops among them.
pub(super) fn of(view: &View<'_>) -> Vec<DiagramTopic> {
    let mut topics = Topics::default();
    for (place, (_, component)) in view.components().enumerate() {
        for one in view.topics(component) {
            let topic = topics.get(one);
            let ends = if one.is_published { &mut topic.publishers } else { &mut topic.subscribers };
            ends.push(place);
        }
    }
    topics.all
}

/// Joins topics that are the same but for their names, such as those of the replicas of a hall: the same before
/// renaming, and with the same ends, where each end is several components. All ends are several where the composite
/// `is_repeated`.
pub(super) fn join(diagram: &mut Diagram, is_repeated: bool) {
    let is_several = |end: &usize| is_repeated || diagram.components[*end].replicas.is_some_and(|(_, most)| most > 1);
    let mut all: Vec<DiagramTopic> = Vec::with_capacity(diagram.topics.len());
    // Indices of joined topics by what they have in common; until here, `names` holds the name before renaming.
    let mut places: HashMap<Sameness, usize> = HashMap::new();
    for mut topic in std::mem::take(&mut diagram.topics) {
        let declared = std::mem::replace(&mut topic.names, vec![topic.name.clone()]);
        if !topic.publishers.iter().chain(&topic.subscribers).all(is_several) {
            all.push(topic);
            continue;
        }
        let key = (declared, topic.publishers.clone(), topic.subscribers.clone());
        let place = *places.entry(key).or_insert(all.len());
        match all.get_mut(place) {
            Some(first) => first.names.append(&mut topic.names),
            None => all.push(topic),
        }
    }
    for topic in all.iter_mut().filter(|topic| topic.names.len() > 1) {
        topic.name = common(&topic.names);
    }
    diagram.topics = all;
}

/// The name before renaming, who publishes, and who reads.
type Sameness = (Vec<String>, Vec<usize>, Vec<usize>);

/// The common start and end of names, with `*` between.
fn common(names: &[String]) -> String {
    let [first, others @ ..] = names else { return String::new() };
    let (mut start, mut end) = (first.len(), first.len());
    for other in others {
        let same = |one: (char, char)| one.0 == one.1;
        let alike = |pairs: &mut dyn Iterator<Item = (char, char)>| {
            pairs.take_while(|pair| same(*pair)).map(|(one, _)| one.len_utf8()).sum::<usize>()
        };
        start = start.min(alike(&mut first.chars().zip(other.chars())));
        end = end.min(alike(&mut first.chars().rev().zip(other.chars().rev())));
    }
    let end = end.min(first.len() - start);
    format!("{}*{}", &first[..start], &first[first.len() - end..])
}

#[derive(Default)]
struct Topics {
    all: Vec<DiagramTopic>,
    places: HashMap<String, usize>,
}

impl Topics {
    fn get(&mut self, one: &TopicUse) -> &mut DiagramTopic {
        let place = *self.places.entry(one.name.clone()).or_insert_with(|| {
            self.all.push(DiagramTopic {
                name: one.name.clone(),
                names: vec![one.declared.name.clone()],
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
