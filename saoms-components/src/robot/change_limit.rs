//! What of a robot does not change while it stays: the others know it by that.

use std::collections::BTreeMap;

use saoms_api::extension::{ChangeLimit, ChangeObjection, submit};
use saoms_api::rule::FleetView;

use super::Robot;

submit! { ChangeLimit { judge: identities } }

/// What the others know a robot by.
#[derive(PartialEq)]
struct Identity {
    number: Option<u32>,
    world: Option<String>,
}

fn robots(view: &FleetView<'_>) -> BTreeMap<String, Identity> {
    let components = view.components();
    let robots = view.all::<Robot>().map(|(place, properties)| {
        let world = components[place].target("world").map(|world| components[world].path.to_owned());
        (components[place].path.to_owned(), Identity { number: properties.number().ok(), world })
    });
    robots.collect()
}

/// Jobs, grants and the body in the world belong to the number of a robot, and its state to the world in which it is.
fn identities(present: &FleetView<'_>, wanted: &FleetView<'_>) -> Vec<ChangeObjection> {
    let after = robots(wanted);
    let reason = |(path, before): (String, Identity)| {
        let after = after.get(&path).filter(|after| **after != before)?;
        let what = if after.number != before.number { "number" } else { "world" };
        let reason = format!(
            "the {what} of `{path}` changes, by which the others know it: remove it first, then add it with the new one"
        );
        Some(ChangeObjection::new(reason).about(path))
    };
    let before = robots(present);
    let mut reasons = handed_on(&before, &after);
    reasons.extend(before.into_iter().filter_map(reason));
    reasons
}

/// Robots that join with the number of one that leaves. That one's body stays on the floor where it went last, and the
/// others still hear of it by its number, while the new one begins as if it were somewhere else.
fn handed_on(before: &BTreeMap<String, Identity>, after: &BTreeMap<String, Identity>) -> Vec<ChangeObjection> {
    let leaving = before.iter().filter(|(path, _)| !after.contains_key(*path));
    let numbers: BTreeMap<u32, &str> =
        leaving.filter_map(|(path, robot)| Some((robot.number?, path.as_str()))).collect();
    let joining = after.iter().filter(|(path, _)| !before.contains_key(*path));
    let reason = |(path, robot): (&String, &Identity)| {
        let number = robot.number?;
        let leaving = numbers.get(&number)?;
        let reason = format!(
            "`{path}` joins with the number {number} of `{leaving}`, which leaves: remove that one first, then add `{path}`"
        );
        Some(ChangeObjection::new(reason).about(path))
    };
    joining.filter_map(reason).collect()
}
