//! The robots of a fleet, as rules look at them.

use std::ops::Deref;
use std::rc::Rc;

use saoms_api::Place;
use saoms_api::rule::{Fact, FleetView};

use crate::grid::Block;
use crate::messages::ROBOT_LIST;
use crate::robot::{Robot, RobotProperties};

/// A robot of the fleet whose own values are right.
pub(super) struct Known {
    pub(super) index: usize,
    pub(super) number: u32,
    /// Where its charger is, and where it starts.
    pub(super) charger: Block,
    /// The index of the world that it is in.
    pub(super) world: Option<usize>,
    pub(super) properties: RobotProperties,
}

/// All robots in document order.
pub(super) fn robots(fleet: &FleetView<'_>) -> Rc<Robots> {
    fleet.fact()
}

/// Whether there are robots of other classes, or may be some in other programs.
pub(super) fn may_be_others(fleet: &FleetView<'_>) -> bool {
    robots(fleet).may_be_others
}

/// What rules know about all robots.
pub(super) struct Robots {
    known: Vec<Known>,
    may_be_others: bool,
}

impl Deref for Robots {
    type Target = [Known];

    fn deref(&self) -> &[Known] {
        &self.known
    }
}

impl Fact for Robots {
    fn of(fleet: &FleetView<'_>) -> Robots {
        // Of a large fleet most components are robots, and a list that grows is moved again and again.
        let mut known = Vec::with_capacity(fleet.indices::<Robot>().count());
        known.extend(fleet.all::<Robot>().filter_map(|(index, properties)| {
            let number = properties.number().ok()?;
            let charger = properties.charge_block(number).ok()?;
            let world = fleet.components()[index].target("world");
            Some(Known { index, number, charger, world, properties })
        }));
        Robots {
            known,
            may_be_others: fleet.components().iter().any(|component| component.has_broker)
                || publishes_beside_robots(fleet, ROBOT_LIST.name()),
        }
    }
}

/// Whether somebody else than a robot publishes on a topic.
pub(super) fn publishes_beside_robots(fleet: &FleetView<'_>, topic: &str) -> bool {
    let mut robots = fleet.indices::<Robot>().peekable();
    let mut components = fleet.components().iter().enumerate();
    components.any(|(index, component)| {
        robots.next_if_eq(&index).is_none() && component.class.publishes.contains(&topic)
    })
}

/// The robots, in their order, that share a key with one before them, each with the first that has it.
pub(super) fn sharing<K: Ord>(robots: &[Known], key: impl Fn(&Known) -> K) -> Vec<(&Known, &Known)> {
    // In most fleets the keys rise with the places, and are nearly sorted as they are.
    let mut keys: Vec<(K, usize)> = robots.iter().map(key).zip(0..).collect();
    keys.sort_unstable();
    let of_one_key = keys.chunk_by(|(one, _), (other, _)| one == other);
    let mut sharing: Vec<(usize, usize)> = Vec::new();
    for places in of_one_key {
        sharing.extend(places[1..].iter().map(|(_, later)| (*later, places[0].1)));
    }
    sharing.sort_unstable();
    sharing.into_iter().map(|(later, first)| (&robots[later], &robots[first])).collect()
}

/// The robots that are wired to a world, with that: by their worlds, and in their order.
pub(super) fn by_world(robots: &[Known]) -> Vec<(usize, &Known)> {
    let mut wired: Vec<(usize, &Known)> =
        robots.iter().filter_map(|robot| Some((robot.world?, robot))).collect();
    wired.sort_by_key(|(world, _)| *world);
    wired
}

impl Known {
    /// Where the composite says where its charger is, as far as it does.
    pub(super) fn charger_place(&self, fleet: &FleetView<'_>) -> Place {
        self.first_given(fleet, &["chargeY", "chargeX", "ID"])
    }

    /// Where the composite says in which column its charger is, as far as it does.
    pub(super) fn column_place(&self, fleet: &FleetView<'_>) -> Place {
        self.first_given(fleet, &["chargeX", "chargeY", "ID"])
    }

    /// Where the composite says its number.
    pub(super) fn number_place(&self, fleet: &FleetView<'_>) -> Place {
        let name = if self.properties.number.is_some() { "number" } else { "ID" };
        self.first_given(fleet, &[name])
    }

    fn first_given(&self, fleet: &FleetView<'_>, names: &[&str]) -> Place {
        let values = fleet.components()[self.index].values;
        let given = names.iter().find(|name| values.iter().any(|(given, _)| given == **name));
        let place = given.map_or_else(Place::default, |name| Place::property(*name));
        place.in_component(self.index)
    }
}
