//! Robots that share a charger which cannot keep them charged, even if they do nothing, or only without any delay.

use std::collections::BTreeMap;

use saoms_api::Finding;
use saoms_api::rule::{FleetView, Severity};

use super::Range;
use crate::rules::robots::FleetRobot;

/// Part of the time for which a shared charger can be in use while its robots work. Its robots wait for each other, and
/// on the way to it for others, so that it is never in use all the time: most of the random sites with a charger that
/// is in use for longer had stranded robots in some runs.
const MOST_IN_USE: f64 = 0.7;

/// Robots that share a charger, and the part of the time for which they need it together.
struct Users<'r> {
    robots: Vec<&'r FleetRobot>,
    need: f64,
}

/// The finding about the charger that is asked for too much. A robot loses energy whenever it is not there, so each one
/// needs it for a part of the time, and together they may have no more than all of it.
pub(super) fn overused(fleet: &FleetView<'_>, robots: &[&FleetRobot], ranges: &[Range]) -> Option<Finding> {
    let users = neediest(robots, ranges, |range| range.charging_at_rest).filter(|users| users.need > 1.0)?;
    finding(fleet, &users, "even if they never move", "`dischargePerSecond`")
}

/// The finding about the charger that robots share and need for most of the time while all of them work.
pub(super) fn contended(fleet: &FleetView<'_>, robots: &[&FleetRobot], ranges: &[Range]) -> Option<Finding> {
    let users = neediest(robots, ranges, |range| range.charging_at_work).filter(|users| users.need >= MOST_IN_USE)?;
    let while_driving = "while all of them drive: one that has to wait there may be stranded";
    finding(fleet, &users, while_driving, "what they discharge")
}

/// The robots that need a charger that they share for the largest part of the time.
fn neediest<'r>(robots: &[&'r FleetRobot], ranges: &[Range], share: fn(&Range) -> f64) -> Option<Users<'r>> {
    let mut chargers: BTreeMap<_, Users<'r>> = BTreeMap::new();
    for (robot, range) in robots.iter().zip(ranges) {
        let users = chargers.entry((robot.world, robot.charger)).or_insert(Users { robots: Vec::new(), need: 0.0 });
        users.robots.push(robot);
        users.need += share(range);
    }
    let shared = chargers.into_values().filter(|users| users.robots.len() > 1);
    shared.max_by(|one, other| one.need.total_cmp(&other.need))
}

fn finding(fleet: &FleetView<'_>, users: &Users<'_>, when: &str, less: &str) -> Option<Finding> {
    let last = users.robots.last()?;
    let mut numbers: Vec<u32> = users.robots.iter().map(|robot| robot.number).collect();
    numbers.sort_unstable();
    let numbers: Vec<String> = numbers.iter().map(u32::to_string).collect();
    let message = format!(
        "robots {} share the charger at {}, and need it for {:.0} % of the time {when}",
        numbers.join(", "),
        last.charger,
        users.need * 100.0
    );
    let help = format!(
        "give these robots chargers of their own, or let them charge faster: raise `chargePerSecond`, or reduce {less}"
    );
    Some(Finding::new(last.charger_place(fleet), message).severity(Severity::Warning).help(help))
}
