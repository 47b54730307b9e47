//! Robots that share a charger which cannot keep them charged, even if they do nothing.

use std::collections::BTreeMap;

use saoms_api::Finding;
use saoms_api::rule::{FleetView, Severity};

use super::Range;
use crate::rules::robots::FleetRobot;

/// The finding about the charger that is asked for too much. A robot loses energy whenever it is not there, so each one
/// needs it for a part of the time, and together they may have no more than all of it.
pub(super) fn overused(fleet: &FleetView<'_>, robots: &[&FleetRobot], ranges: &[Range]) -> Option<Finding> {
    let mut chargers: BTreeMap<_, Vec<(&FleetRobot, f64)>> = BTreeMap::new();
    for (robot, range) in robots.iter().zip(ranges) {
        chargers.entry((robot.world, robot.charger)).or_default().push((robot, range.charging_at_rest));
    }
    let need = |users: &[(&FleetRobot, f64)]| users.iter().map(|(_, share)| share).sum::<f64>();
    let groups = chargers.into_values().filter(|users| users.len() > 1 && need(users) > 1.0);
    let users = groups.max_by(|one, other| need(one).total_cmp(&need(other)))?;
    let (last, _) = users.last()?;
    let mut numbers: Vec<u32> = users.iter().map(|(robot, _)| robot.number).collect();
    numbers.sort_unstable();
    let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
    let message = format!(
        "robots {} share the charger at {}, and need it for {:.0} % of the time even if they never move",
        numbers.join(", "),
        last.charger,
        need(&users) * 100.0
    );
    let help = "give these robots chargers of their own, or let them charge faster: raise `chargePerSecond`, or reduce \
        `dischargePerSecond`";
    Some(Finding::new(last.charger_place(fleet), message).severity(Severity::Warning).help(help))
}
