//! Components of other programs: those of other nodes of the fleet, which are known, and others, which were heard.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use saoms_api::Cause;
use saoms_api::extension::FailureNotice;
use saoms_api::host::{FIRST_ELSEWHERE as FIRST, TopicDeclaration};
use saoms_lang::assembly::ComponentSpec;
use saoms_lang::registry::ClassTopic;

use crate::journal::{node_of, of_node};
use crate::report::PartOfFleet;
use crate::schedule::engine::Engine;
use crate::schedule::inject::OUTSIDE;
use crate::schedule::networks::NO_NETWORK;

/// The components of other programs.
#[derive(Debug, Default)]
pub(in crate::schedule) struct Elsewhere {
    names: Arc<RemoteNames>,
    /// The part of the fleet that runs here.
    part: Option<PartOfFleet>,
    /// Those of other nodes of the fleet, by their numbers.
    known: BTreeMap<u32, Known>,
}

#[derive(Debug)]
struct Known {
    spec: Arc<ComponentSpec>,
    /// True if a message of it has arrived.
    is_heard: bool,
}

impl Elsewhere {
    /// The part of the fleet that runs here from now on, and the components of other nodes.
    pub(in crate::schedule) fn know(&mut self, part: Option<PartOfFleet>, specs: Vec<ComponentSpec>) {
        self.part = part;
        self.known = specs
            .into_iter()
            .map(|spec| (self.names.number(&spec.path), Known { spec: Arc::new(spec), is_heard: false }))
            .collect();
    }

    /// The number of a component of another program that says something.
    pub(super) fn hear(&mut self, name: &str) -> u32 {
        let number = self.names.number(name);
        if let Some(known) = self.known.get_mut(&number) {
            known.is_heard = true;
        }
        number
    }

    /// The part of the fleet that runs here; `None` where all of it does.
    pub(in crate::schedule) fn part(&self) -> Option<&PartOfFleet> {
        self.part.as_ref()
    }

    /// The record that a message follows from, as the component with this number says it.
    pub(in crate::schedule) fn cause(&self, sender: u32, record: u64) -> Cause {
        let Some((part, known)) = self.part.as_ref().zip(self.known.get(&sender)) else { return Cause::default() };
        let place = |name: &str| part.nodes.iter().position(|node| node == name);
        match node_of(Cause(record)) {
            // It passes on why it was told something.
            Some((node, record)) if Some(node) == place(&part.node) => Cause(record),
            Some(_) => Cause(record),
            None => place(&known.spec.node).map_or(Cause::default(), |node| of_node(node, record)),
        }
    }

    /// The names of all of them by their numbers.
    pub(in crate::schedule) fn names(&self) -> Arc<RemoteNames> {
        Arc::clone(&self.names)
    }

    /// The components of other nodes, with their numbers.
    pub(in crate::schedule) fn specs(&self) -> impl Iterator<Item = (u32, Arc<ComponentSpec>)> {
        self.known.iter().map(|(number, known)| (*number, Arc::clone(&known.spec)))
    }

    /// The component of another node with this number, and whether it was ever scheduled, as far as it is known: one
    /// that starts with the fleet has been, since what it drives is there before its program is.
    pub(in crate::schedule) fn get(&self, number: u32) -> Option<(&Arc<ComponentSpec>, bool)> {
        let Known { spec, is_heard } = self.known.get(&number)?;
        let starts = spec.task.as_ref().is_none_or(|task| task.run_on_startup);
        Some((spec, *is_heard || starts))
    }
}

/// The paths of components of other programs, by their numbers.
#[derive(Debug, Default)]
pub(in crate::schedule) struct RemoteNames {
    all: RwLock<Names>,
}

#[derive(Debug, Default)]
struct Names {
    names: Vec<&'static str>,
    numbers: HashMap<&'static str, u32>,
}

impl RemoteNames {
    fn read(&self) -> RwLockReadGuard<'_, Names> {
        self.all.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// The name of the component with this number.
    pub(in crate::schedule) fn get(&self, number: u32) -> Option<&'static str> {
        self.read().names.get(number.checked_sub(FIRST)? as usize).copied()
    }

    /// The names from this place on, in the order of their numbers.
    pub(in crate::schedule) fn from(&self, place: usize) -> Vec<&'static str> {
        self.read().names.get(place..).unwrap_or_default().to_vec()
    }

    /// Gives numbers to these names, in this order.
    pub(in crate::schedule) fn recall(&self, names: &[String]) {
        for name in names {
            let _ = self.number(name);
        }
    }

    /// The number of the component with this name, if it has one.
    pub(in crate::schedule) fn find(&self, name: &str) -> Option<u32> {
        self.read().numbers.get(name).copied()
    }

    /// The number of the component with this name. Names stay: a component that comes again has the same number.
    fn number(&self, name: &str) -> u32 {
        if let Some(number) = self.read().numbers.get(name) {
            return *number;
        }
        let mut all = self.all.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(number) = all.numbers.get(name) {
            return *number;
        }
        let number = FIRST.saturating_add(u32::try_from(all.names.len()).unwrap_or(u32::MAX)).min(OUTSIDE - 1);
        // Never freed: contexts lend it to components.
        let name: &'static str = name.to_owned().leak();
        all.names.push(name);
        all.numbers.insert(name, number);
        number
    }
}

impl Engine {
    /// The path of the component with this number, of this program or of another one.
    pub(in crate::schedule) fn name_of(&self, number: u32) -> Option<Arc<str>> {
        let own = self.slots.get(number as usize).map(|slot| Arc::clone(&slot.name));
        own.or_else(|| self.networks.elsewhere.names.get(number).map(Arc::from))
    }

    /// Opens the topics on which components of other nodes hear what no component sends, which may come from this
    /// program: events, and notices of failures.
    pub(in crate::schedule) fn open_topics_of_others(&mut self) {
        for (_, spec) in self.networks.elsewhere.specs().collect::<Vec<_>>() {
            let network = self.networks.of(&spec);
            if network == NO_NETWORK {
                continue;
            }
            let own = spec.class.declaration();
            let is_noticed = |topic: &&ClassTopic| FailureNotice::linked().any(|one| one.topic.name == topic.name);
            let noticed = spec.subscribes().filter(is_noticed);
            for declared in own.taken().map(|(_, topic)| topic).chain(noticed) {
                let name = spec.topic(&declared.name);
                let schema = declared.schema.to_string();
                let topic = TopicDeclaration {
                    name: &declared.name,
                    kind: declared.kind,
                    message: &declared.message,
                    schema: &schema,
                };
                let known = self.bus.find(&name);
                // The checker has held all users of a topic to one declaration.
                let opened = || self.bus.publisher(&name, &topic, &Arc::from(spec.path.as_str())).ok();
                if let Some(topic) = known.or_else(opened) {
                    self.use_on_network(network, topic);
                }
            }
        }
    }

    /// The components that are members of this program's part of the fleet, and those of other nodes, with their
    /// numbers.
    pub(in crate::schedule) fn members_everywhere(&self) -> impl Iterator<Item = (u32, Arc<ComponentSpec>)> {
        let members = (0..).zip(&self.slots).filter(|(_, slot)| slot.is_member());
        members.map(|(number, slot)| (number, Arc::clone(&slot.spec))).chain(self.networks.elsewhere.specs())
    }
}
