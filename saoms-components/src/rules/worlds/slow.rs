//! Rule: robots wait for their world.

use std::collections::HashMap;
use std::time::Duration;

use saoms_api::host::format_duration;
use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use crate::rules::robots::{by_world, robots};
use crate::rules::unlikely::{LONG, SHORT};
use crate::world::World;

pub(in crate::rules) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5022",
        name: "slow-world",
        meaning: "A world executes more than ten times less often than a robot in it. It learns of new luggage when it \
            executes, and robots wait at the luggage until then.",
        severity: Severity::Warning,
        rule: None,
    },
    judges_parts: true,
    prevents_start: false,
    check,
};

/// Periods of a robot that may pass until its world executes.
const MOST: u32 = 10;

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let components = fleet.components();
    // The robot of each world with the shortest period.
    let mut fastest: HashMap<usize, (Duration, usize)> = HashMap::new();
    for (world, robot) in by_world(&robots(fleet)) {
        // Shorter periods are reported as they are.
        let Some(period) = components[robot.index].period.filter(|period| *period >= SHORT) else { continue };
        let first = fastest.entry(world).or_insert((period, robot.index));
        *first = (*first).min((period, robot.index));
    }
    let worlds = fleet.indices::<World>().filter_map(|world| {
        let (own, (period, robot)) = (components[world].period?, *fastest.get(&world)?);
        // Longer periods are reported whoever has them.
        (own > period * MOST && own <= LONG).then(|| {
            let message = format!(
                "the world executes every {}, but robot `{}` every {}: robots wait up to {0} until they can collect new \
                 luggage",
                format_duration(own),
                components[robot].path,
                format_duration(period)
            );
            Finding::new(Place::property("period").in_component(world), message)
                .help(format!("give the world a period such as `{}`", format_duration(period)))
        })
    });
    worlds.collect()
}
