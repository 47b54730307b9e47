//! Robots of a fleet, as rules use them.

use std::collections::BTreeSet;
use std::ops::Deref;
use std::rc::Rc;

use saoms_api::rule::{Fact, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::hearing::hearing;
use crate::grid::Block;
use crate::messages::ROBOT_LIST;
use crate::robot::{Robot, RobotProperties};
use crate::world::World;

/// Nodes that are named, at most.
const MOST_NODES: usize = 8;

/// A robot of the fleet with valid properties.
pub(super) struct FleetRobot {
    pub(super) index: usize,
    pub(super) number: u32,
    /// Block of its charger.
    pub(super) charger: Block,
    /// Block where it starts: by default its charger.
    pub(super) start: Block,
    /// Index of its world.
    pub(super) world: Option<usize>,
    /// Index of the world whose blocks it drives on: its own, or, where it is wired to none, the one that hears of it.
    pub(super) ground: Option<usize>,
    pub(super) properties: RobotProperties,
}

/// All robots in document order.
pub(super) fn robots(fleet: &FleetView<'_>) -> Rc<Robots> {
    fleet.fact()
}

/// True if there are robots of other classes.
pub(super) fn may_be_others(fleet: &FleetView<'_>) -> bool {
    robots(fleet).may_be_others
}

/// True if some messages go to a broker, which may have robots and masters of other programs as its users.
pub(super) fn has_broker(fleet: &FleetView<'_>) -> bool {
    robots(fleet).has_broker
}

/// True if each robot of the fleet is known, with a number of its own property, class name or ID. Others are told of.
pub(super) fn are_all_known(fleet: &FleetView<'_>) -> bool {
    robots(fleet).len() == fleet.indices::<Robot>().count()
}

/// The findings, as warnings where other programs may supply what is missing here. Of a fleet with nodes all programs
/// are known: none of them does.
pub(super) fn unless_elsewhere(fleet: &FleetView<'_>, findings: Vec<Finding>) -> Vec<Finding> {
    const HELP: &str = "ignore this if another program at the same broker (`url`) provides what is missing";
    if findings.is_empty() {
        return findings;
    }
    if has_broker(fleet) {
        return findings.into_iter().map(|finding| finding.severity(Severity::Warning).help(HELP)).collect();
    }
    let nodes: BTreeSet<&str> = fleet.components().iter().map(|component| component.node).collect();
    let named: Vec<String> = nodes.iter().filter(|node| !node.is_empty()).map(|node| format!("`{node}`")).collect();
    let (first, more) = named.split_at(named.len().min(MOST_NODES));
    let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
    let text = format!("none of the nodes of this fleet has it: {}{more}", first.join(", "));
    findings.into_iter().map(|finding| if named.is_empty() { finding } else { finding.help(text.clone()) }).collect()
}

/// Facts about all robots, computed once.
pub(super) struct Robots {
    known: Vec<FleetRobot>,
    may_be_others: bool,
    has_broker: bool,
}

impl Deref for Robots {
    type Target = [FleetRobot];

    fn deref(&self) -> &[FleetRobot] {
        &self.known
    }
}

impl Fact for Robots {
    fn of(fleet: &FleetView<'_>) -> Robots {
        // In large fleets most components are robots; reserving their number avoids moving the list as it grows.
        let mut known = Vec::with_capacity(fleet.indices::<Robot>().count());
        let (hearing, misses) = (hearing(fleet), fleet.misses::<World>());
        known.extend(fleet.all::<Robot>().filter_map(|(index, properties)| {
            let number = properties.number().ok()?;
            let charger = properties.charge_block(number).ok()?;
            let start = properties.start(charger);
            let component = &fleet.components()[index];
            let world = component.target("world");
            let ground = world.or_else(|| match hearing.worlds_of_robots(component.topic(ROBOT_LIST.name())) {
                [world] if !misses => Some(*world),
                _ => None,
            });
            Some(FleetRobot { index, number, charger, start, world, ground, properties })
        }));
        Robots {
            known,
            may_be_others: publishers_beside_robots(fleet, ROBOT_LIST.name()).next().is_some(),
            has_broker: fleet.components().iter().any(|component| component.has_broker),
        }
    }
}

/// The components other than robots that publish on a topic.
pub(super) fn publishers_beside_robots<'f>(
    fleet: &FleetView<'f>,
    topic: &'static str,
) -> impl Iterator<Item = usize> + use<'f> {
    let mut robots = fleet.indices::<Robot>().peekable();
    let components = fleet.components().iter().enumerate();
    let others = components.filter(move |(index, _)| robots.next_if_eq(index).is_none());
    others.filter(move |(_, component)| component.class.publishes.contains(&topic)).map(|(index, _)| index)
}

/// The robots that share a key with an earlier one, each with the first that has the key, in document order.
pub(super) fn sharing<K: Ord>(
    robots: &[FleetRobot],
    key: impl Fn(&FleetRobot) -> K,
) -> Vec<(&FleetRobot, &FleetRobot)> {
    // In most fleets the keys are nearly sorted already.
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

/// Robots that are wired to a world, with the index of the world, sorted by world and then in document order.
pub(super) fn by_world(robots: &[FleetRobot]) -> Vec<(usize, &FleetRobot)> {
    let mut wired: Vec<(usize, &FleetRobot)> = robots.iter().filter_map(|robot| Some((robot.world?, robot))).collect();
    wired.sort_by_key(|(world, _)| *world);
    wired
}

impl FleetRobot {
    /// The world of its own site, which hears of it, where it is wired to that of another one, which does not.
    pub(super) fn other_world(&self, fleet: &FleetView<'_>) -> Option<usize> {
        let hearing = hearing(fleet);
        let of = |index: usize| hearing.worlds_of_robots(fleet.components()[index].topic(ROBOT_LIST.name()));
        let (own, wired) = (of(self.index), self.world?);
        own.first().copied().filter(|_| of(wired).contains(&wired) && !own.contains(&wired))
    }

    /// Place of the robot's charger in the composite, as far as it is given.
    pub(super) fn charger_place(&self, fleet: &FleetView<'_>) -> Place {
        self.first_given(fleet, &["chargeY", "chargeX", "ID"]).or_own("chargeX")
    }

    /// Place of the column of the robot's charger in the composite, as far as it is given.
    pub(super) fn column_place(&self, fleet: &FleetView<'_>) -> Place {
        self.first_given(fleet, &["chargeX", "chargeY", "ID"]).or_own("chargeY")
    }

    /// Place of the robot's start in the composite, as far as it is given.
    pub(super) fn start_place(&self, fleet: &FleetView<'_>) -> Place {
        match self.start == self.charger {
            true => self.charger_place(fleet),
            false => self.first_given(fleet, &["startX", "startY"]),
        }
    }

    /// Place of the robot's number in the composite.
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
