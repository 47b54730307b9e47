//! Borders of zones: what hinders a change of them while robots stay. A plan of a change shows which blocks change
//! hands.

use std::collections::{BTreeMap, BTreeSet};

use saoms_api::extension::{ChangeConsequence, ChangeLimit, ChangeObjection, submit};
use saoms_api::rule::{ComponentView, FleetView};

use super::Zone;
use crate::master::MasterEnvironment;
use crate::messages::{GRANT, GRANT_REQUEST, Territory};
use crate::world::World;

submit! { ChangeLimit { judge: borders } }
submit! { ChangeConsequence { tell: handed_over } }

/// The robots that stay, whose blocks zones have granted.
pub(crate) fn staying<'v>(present: &'v FleetView<'_>, wanted: &FleetView<'_>) -> BTreeSet<&'v str> {
    let robots = |view: &'v FleetView<'_>| {
        let all = view.components().iter();
        all.filter(|one| one.class.publishes.contains(&GRANT_REQUEST.name())).map(|one| one.path)
    };
    let later: BTreeSet<&str> = wanted.components().iter().map(|one| one.path).collect();
    robots(present).filter(|path| later.contains(path)).collect()
}

/// A zone, as far as robots know it.
#[derive(PartialEq)]
struct Border {
    number: u32,
    blocks: (i32, i32, Option<u32>, Option<u32>),
    map: Option<String>,
}

/// What hinders new borders where robots stay, or have left their bodies on the floor.
fn borders(present: &FleetView<'_>, wanted: &FleetView<'_>) -> Vec<ChangeObjection> {
    let (before, after) = (zones(present), zones(wanted));
    let stays = !staying(present, wanted).is_empty();
    if before == after || !stays && !keeps_world(present, wanted) {
        return Vec::new();
    }
    // The first zone with other borders than before, or one that is gone.
    let differs = |one: &(&&str, &Border)| before.get(*one.0) != Some(one.1);
    let differing = after.iter().find(differs).or_else(|| before.iter().find(|(path, _)| !after.contains_key(**path)));
    let mut reasons = Vec::new();
    let mut refuse = |reason: String| {
        let objection = ChangeObjection::new(format!("{reason}: end the run, and start it with the new composites"));
        reasons.push(match differing {
            Some((path, _)) => objection.about(*path),
            None => objection,
        });
    };
    if before.is_empty() != after.is_empty() {
        let (what, why) = match (before.is_empty(), stays) {
            (true, false) => return Vec::new(),
            (true, true) => {
                ("gets its first zone", "robots that stay ask for grants only if it had one when they began")
            }
            (false, true) => ("loses its last zone", "robots that stay hold grants for blocks"),
            (false, false) => ("loses its last zone", "robots may be left on blocks"),
        };
        refuse(format!("the site {what}, and {why}"));
        return reasons;
    }
    if stays && maps(&before) != maps(&after) {
        refuse("the map of zones changes, and robots that stay have learned the present one".to_owned());
    }
    if let Some(apart) = [present, wanted].into_iter().find_map(apart) {
        refuse(format!(
            "zones get other borders, all at one instant, but `{apart}` may be in another program than they are, and hear \
             of that later"
        ));
    }
    if let Some((master, zone)) = [present, wanted].into_iter().find_map(master_of_zone) {
        refuse(format!(
            "zones get other borders, but `{master}` assigns the luggage of zone {zone}, and others that of other zones: what \
             is requested meanwhile might be assigned twice"
        ));
    }
    let path_of = |zones: &BTreeMap<&str, Border>, number: u32| {
        let found = zones.iter().find(|(_, border)| border.number == number);
        found.map(|(path, _)| (*path).to_owned())
    };
    for (path, border) in &after {
        if let Some(other) = path_of(&before, border.number).filter(|other| stays && other != path) {
            let reason = format!(
                "`{path}` gets the number {} of `{other}`, by which robots know that zone: give it a number that no zone \
                 had",
                border.number
            );
            reasons.push(ChangeObjection::new(reason).about(*path));
        }
    }
    reasons
}

/// The zones, by their paths.
fn zones<'v>(view: &FleetView<'v>) -> BTreeMap<&'v str, Border> {
    let zones = view.all::<Zone>().map(|(place, zone)| {
        let blocks = (zone.x, zone.y, zone.width, zone.height);
        (view.components()[place].path, Border { number: zone.number, blocks, map: zone.map })
    });
    zones.collect()
}

fn maps<'b>(zones: &'b BTreeMap<&str, Border>) -> BTreeSet<&'b str> {
    zones.values().filter_map(|border| border.map.as_deref()).collect()
}

/// A zone, or a robot that asks for grants, whose messages may go to another program.
fn apart<'v>(view: &FleetView<'v>) -> Option<&'v str> {
    let takes_part = |one: &ComponentView<'_>| {
        [GRANT.name(), GRANT_REQUEST.name()].iter().any(|topic| one.class.publishes.contains(topic))
    };
    let mut all = view.components().iter().filter(|one| takes_part(one));
    all.find(|one| one.has_broker || !one.node.is_empty()).map(|one| one.path)
}

/// A master that assigns the luggage of a zone, with the number of that.
fn master_of_zone<'v>(view: &FleetView<'v>) -> Option<(&'v str, u32)> {
    view.all::<MasterEnvironment>().find_map(|(place, master)| Some((view.components()[place].path, master.zone?)))
}

/// True if a world goes on, with the bodies that are in it.
fn keeps_world(present: &FleetView<'_>, wanted: &FleetView<'_>) -> bool {
    let worlds = |view: &FleetView<'_>| -> BTreeSet<String> {
        view.all::<World>().map(|(place, _)| view.components()[place].path.to_owned()).collect()
    };
    !worlds(present).is_disjoint(&worlds(wanted))
}

/// The blocks that another zone grants from then on.
fn handed_over(present: &FleetView<'_>, wanted: &FleetView<'_>) -> Vec<String> {
    let (before, after) = (territories(present), territories(wanted));
    let pairs = before.iter().flat_map(|one| after.iter().map(move |other| (one, other)));
    let pairs = pairs.filter(|((world, _), (other, _))| world == other).map(|((_, one), (_, other))| (one, other));
    let shared = pairs.filter(|(one, other)| one.zone != other.zone).filter_map(|(one, other)| {
        let (from, to) = one.shared(other)?;
        let blocks = if from == to { from.to_string() } else { format!("{from}..{to}") };
        Some(format!("blocks {blocks}: zone {} -> zone {}", one.zone, other.zone))
    });
    shared.collect()
}

/// The blocks of the zones, in the order of their numbers, each with the path of its world. Those of a zone without a
/// map are not known.
fn territories<'v>(view: &'v FleetView<'_>) -> Vec<(Option<&'v str>, Territory)> {
    let blocks = view.all::<Zone>().filter_map(|(place, zone)| {
        let world = view.components()[place].target("world");
        let map = match world.and_then(|world| view.components()[world].properties::<World>()) {
            Some(world) => world.map().ok()?,
            None => zone.map().ok()??,
        };
        Some((world.map(|world| view.components()[world].path), zone.territory(1, &map).ok()?))
    });
    let mut all: Vec<_> = blocks.collect();
    all.sort_by_key(|(_, one)| one.zone);
    all
}

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use saoms_api::Class;
    use saoms_api::host::{PropertyValue, SmolStr};
    use saoms_api::rule::ClassView;

    use super::*;

    /// A component, its class, and its values.
    type Given = (&'static str, (&'static str, &'static str), Vec<(SmolStr, PropertyValue)>);

    fn zone(path: &'static str, number: u32, width: u32) -> Given {
        let values = [("number", number), ("width", width)];
        let values = values.map(|(name, value)| (SmolStr::new(name), PropertyValue::from(value.to_string().as_str())));
        (path, (Zone::DECLARATION, GRANT.name()), values.to_vec())
    }

    fn view<'a>(
        (path, (declaration, publishes), values): &'a Given,
        node: &'a str,
        has_broker: bool,
    ) -> ComponentView<'a> {
        let class = ClassView {
            name: "any",
            declaration,
            extends: Vec::new(),
            publishes: vec![*publishes],
            subscribes: Vec::new(),
            loops: Vec::new(),
            takes: Vec::new(),
        };
        ComponentView {
            path,
            class: Rc::new(class),
            values,
            period: None,
            starts: true,
            restarts: false,
            node,
            has_broker,
            renamed: &[],
            wires: &[],
        }
    }

    fn judge(before: &[Given], after: &[Given], node: &str, has_broker: bool) -> Vec<ChangeObjection> {
        let [before, after] = [before, after].map(|all| {
            let views = all.iter().map(|one| view(one, node, has_broker));
            views.collect::<Vec<_>>()
        });
        borders(&FleetView::new(&before), &FleetView::new(&after))
    }

    #[test]
    fn borders_stay_where_robots_may_hear_of_them_later() {
        let robot: Given = ("Robot1", ("", GRANT_REQUEST.name()), Vec::new());
        let before = [zone("Zone1", 1, 10), robot.clone()];
        let after = [zone("Zone1", 1, 5), zone("Zone2", 2, 5), robot.clone()];
        assert!(judge(&before, &after, "", false).is_empty());
        for (node, has_broker) in [("floor", false), ("", true)] {
            let reasons = judge(&before, &after, node, has_broker);
            assert_eq!(reasons.len(), 1, "{reasons:?}");
            assert!(reasons[0].reason.contains("`Zone1` may be in another program than they are"), "{reasons:?}");
            assert_eq!(reasons[0].component.as_deref(), Some("Zone1"));
            assert!(judge(&before, &before, node, has_broker).is_empty());
        }
        // A zone keeps its number, and a number its zone.
        let moved = [zone("Zone3", 1, 10), zone("Zone1", 4, 10), robot];
        let reasons = judge(&before, &moved, "", false);
        let expected = "`Zone3` gets the number 1 of `Zone1`, by which robots know that zone: give it a number that no \
                        zone had";
        assert_eq!(reasons, [ChangeObjection::new(expected).about("Zone3")]);
        let reasons = judge(&before, &before[1..], "", false);
        assert!(
            reasons[0].reason.starts_with("the site loses its last zone, and robots that stay hold grants"),
            "{reasons:?}"
        );
    }
}
