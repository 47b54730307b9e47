//! The map of a world does not change while robots drive on it.

use std::collections::BTreeMap;

use saoms_api::extension::{ChangeLimit, ChangeObjection, submit};
use saoms_api::rule::FleetView;

use super::World;
use crate::zone::staying;

submit! { ChangeLimit { judge: maps } }

/// A robot learns the map of its world when it enters it.
fn maps(present: &FleetView<'_>, wanted: &FleetView<'_>) -> Vec<ChangeObjection> {
    let worlds = |view: &FleetView<'_>| {
        let worlds = view.all::<World>().map(|(place, world)| {
            let map = (world.width, world.height, world.map, world.blocked);
            (view.components()[place].path.to_owned(), map)
        });
        worlds.collect::<BTreeMap<_, _>>()
    };
    let (before, after) = (worlds(present), worlds(wanted));
    let changed = before.iter().filter(|(path, map)| after.get(*path).is_some_and(|new| new != *map));
    let has_robots = !staying(present, wanted).is_empty();
    let reason = |path: &String| {
        ChangeObjection::new(format!(
            "the map of `{path}` changes, and robots that stay have learned the present one: end the run, and start it with \
             the new composites"
        ))
        .about(path)
    };
    changed.filter(|_| has_robots).map(|(path, _)| reason(path)).collect()
}
