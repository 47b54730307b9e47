//! Who hears whom, by the names that topics have on the bus.
//!
//! A site and `topicRename` give topics other names, so that two components that use one topic may not hear each other,
//! and two of different sites may.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::rc::Rc;

use saoms_api::rule::{ComponentView, Fact, FleetView};

use super::robots::publishers_beside_robots;
use crate::master::MasterEnvironment;
use crate::messages::{ENVIRONMENT, EVENT_LUGGAGE, EXCEPTIONAL_EVENT, FAULT, ROBOT_LIST};
use crate::world::World;

/// The components that hear environments, or may.
pub(super) struct Hearing {
    /// Masters of the environment, by the topic of the events that they pass on.
    masters: ByTopic,
    /// Components beside these and robots that publish what masters do: whom they listen to is not known.
    others: Vec<usize>,
    /// Worlds, by the topic of the events that they hear.
    worlds: ByTopic,
    /// Worlds, by the topic of the states of robots that they hear.
    of_robots: ByTopic,
}

type ByTopic = HashMap<String, Vec<usize>>;

/// Help where two components do not hear each other, for whatever reason.
const TOGETHER: &str = "use the same topic for both: put them into one site, or give the topic the same \
    new name with `topicRename` in both; a name that begins with `/` is outside of all sites";

/// Help where a component and something else do not hear each other on a topic, each with its name on the bus.
pub(super) fn together(topic: &str, component: &ComponentView<'_>, (what, other): (&str, &str)) -> String {
    let (path, own) = (component.path, component.topic(topic));
    let in_site = |site: &str| match site {
        "" => "in no site".to_owned(),
        site => format!("in the site `{site}`"),
    };
    match (site_of(topic, own), site_of(topic, other)) {
        (Some(site), _) if let Some(real) = site_of_others(topic, component).filter(|real| *real != site) => format!(
            "`{path}` is {}, and its `topicRename` gives `{topic}` the name `{own}`: remove that pair",
            in_site(real)
        ),
        (Some(site), Some(others)) if site != others => {
            let help = match (site, others) {
                ("", site) | (site, "") => {
                    format!(
                        "remove `saoms:site` there, or put all components that work together into the site `{site}`"
                    )
                }
                _ => "give both the same `saoms:site`".to_owned(),
            };
            format!("`{path}` is {}, but {what} is {}: {help}", in_site(site), in_site(others))
        }
        _ => TOGETHER.to_owned(),
    }
}

/// The site of a topic that keeps its name in it; empty outside of all sites.
pub(super) fn site_of<'n>(topic: &str, on_bus: &'n str) -> Option<&'n str> {
    let site = on_bus.strip_suffix(topic)?;
    if site.is_empty() { Some(site) } else { site.strip_suffix('/') }
}

/// The site in which a component has all its other topics that have a new name.
fn site_of_others<'c>(topic: &str, component: &ComponentView<'c>) -> Option<&'c str> {
    let others = component.renamed.iter().filter(|(name, _)| *name != topic);
    let mut sites = others.map(|(name, on_bus)| site_of(name, on_bus));
    let first = sites.next()??;
    sites.all(|site| site == Some(first)).then_some(first)
}

/// What masters of the environment publish.
const PASSED_ON: [&str; 3] = [EVENT_LUGGAGE.name(), EXCEPTIONAL_EVENT.name(), FAULT.name()];

impl Fact for Hearing {
    fn of(fleet: &FleetView<'_>) -> Hearing {
        let components = fleet.components();
        let by_topic = |all: &mut dyn Iterator<Item = usize>, topic: &'static str| {
            let mut sorted = ByTopic::new();
            for index in all {
                sorted.entry(components[index].topic(topic).to_owned()).or_default().push(index);
            }
            sorted
        };
        let known: HashSet<usize> = fleet.indices::<MasterEnvironment>().collect();
        let others: BTreeSet<usize> =
            PASSED_ON.iter().flat_map(|topic| publishers_beside_robots(fleet, topic)).collect();
        let others = others.into_iter().filter(|index| !known.contains(index)).collect();
        Hearing {
            masters: by_topic(&mut fleet.indices::<MasterEnvironment>(), ENVIRONMENT.name()),
            others,
            worlds: by_topic(&mut fleet.indices::<World>(), ENVIRONMENT.name()),
            of_robots: by_topic(&mut fleet.indices::<World>(), ROBOT_LIST.name()),
        }
    }
}

impl Hearing {
    /// The masters that pass on events of this name on the bus.
    pub(super) fn masters(&self, events: &str) -> &[usize] {
        self.masters.get(events).map_or(&[], Vec::as_slice)
    }

    /// True if a component may pass on events of this name on the bus.
    pub(super) fn passes_on(&self, events: &str) -> bool {
        !self.masters(events).is_empty() || !self.others.is_empty()
    }

    /// The worlds that hear events of this name on the bus.
    pub(super) fn worlds(&self, events: &str) -> &[usize] {
        self.worlds.get(events).map_or(&[], Vec::as_slice)
    }

    /// The worlds that hear of robots with this name of their list on the bus.
    pub(super) fn worlds_of_robots(&self, list: &str) -> &[usize] {
        self.of_robots.get(list).map_or(&[], Vec::as_slice)
    }
}

/// Who hears environments.
pub(super) fn hearing(fleet: &FleetView<'_>) -> Rc<Hearing> {
    fleet.fact()
}

/// The name on the bus of the events of an environment.
pub(super) fn events<'f>(fleet: &FleetView<'f>, environment: usize) -> &'f str {
    fleet.components()[environment].topic(ENVIRONMENT.name())
}

/// The names on the bus of a topic, one that masters publish, on which events of this name on the bus are passed on;
/// none if nobody does that, which another rule reports.
pub(super) fn passed_on<'f>(fleet: &FleetView<'f>, events: &str, topic: &'static str) -> BTreeSet<&'f str> {
    let components = fleet.components();
    let hearing = hearing(fleet);
    let others = hearing.others.iter().filter(|index| components[**index].class.publishes.contains(&topic));
    hearing.masters(events).iter().chain(others).map(|index| components[*index].topic(topic)).collect()
}
