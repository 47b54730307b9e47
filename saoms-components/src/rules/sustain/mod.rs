//! Rules: work that exceeds the energy of the robots.
//!
//! The work can be too much: luggage farther away than a full battery lasts, or luggage that arrives permanently faster
//! than the robots can bring it and charge. So can robots be that share a charger, are in each other's way to their
//! chargers, or crowd a map.

mod barred;
pub(super) mod crowded;
mod load;
mod missed;
mod pairs;
mod reach;
mod shared;
mod useless;

use std::time::Duration;

use saoms_api::rule::{Code, FleetRule, FleetView, Severity};
use saoms_api::{Finding, Place};

use super::budget::Budget;
use super::hearing::passed_on;
use super::map::{LuggageLine, WorldMap, area, by_events};
use super::robots::{FleetRobot, may_be_others, robots, unless_elsewhere};
use crate::grid::Block;
use crate::master::MasterRobot;
use crate::messages::EVENT_LUGGAGE;
use crate::robot::safe::is_within;
use crate::robot::{Battery, Policy};

use barred::barred;
use load::overloaded;
use missed::Missed;
use reach::{Ways, out_of_reach};
use shared::{contended, overused};
use useless::useless;

pub(super) static RULE: FleetRule = FleetRule {
    code: Code {
        id: "S5006",
        name: "unsustainable",
        meaning: "The batteries of the robots do not last for the work: luggage is too far from every charger, or one \
            robot's charger is too far from all of it, or luggage without an end comes faster than the robots \
            can deliver it and charge. Or robots share a charger that cannot keep them charged, or that they need for \
            most of the time, or one that charges is in the only way of others to their chargers.",
        severity: Severity::Error,
        rule: None,
    },
    judges_parts: false,
    prevents_start: false,
    check,
};

/// Cost of asking a robot what it hears of, in comparisons of the budget.
const HEARS: usize = 20;

fn check(fleet: &FleetView<'_>) -> Vec<Finding> {
    let (all, mut budget) = (by_events(fleet), Budget::default());
    let within = all.iter().take_while(|_| budget.admit(HEARS * robots(fleet).len()));
    let findings = within.flat_map(|(events, luggage)| check_luggage(fleet, events, luggage)).collect();
    unless_elsewhere(fleet, findings)
}

/// The findings about luggage of one name of the events on the bus.
fn check_luggage(fleet: &FleetView<'_>, events: &str, luggage: &[LuggageLine]) -> Vec<Finding> {
    let (Some(area), robots) = (area(fleet, events), robots(fleet)) else { return Vec::new() };
    // Robots that do not hear of it do not bring it.
    let passed_on = passed_on(fleet, events, EVENT_LUGGAGE.name());
    let hears = |robot: &&FleetRobot| passed_on.contains(fleet.components()[robot.index].topic(EVENT_LUGGAGE.name()));
    let robots: Vec<&FleetRobot> = robots.iter().filter(|robot| passed_on.is_empty() || hears(robot)).collect();
    // Robots of other classes and other loops are unknown.
    let is_known =
        |robot: &FleetRobot| fleet.components()[robot.index].class.loops.iter().all(|name| name.starts_with("saoms."));
    // Nothing wakes a classic robot but a master.
    let has_master = fleet.indices::<MasterRobot>().next().is_some();
    let comes = |robot: &&FleetRobot| robot.properties.policy == Policy::Safe || has_master || !robot.properties.asleep;
    let robots: Vec<&FleetRobot> = robots.into_iter().filter(comes).collect();
    if robots.is_empty() || !robots.iter().all(|robot| is_known(robot)) || may_be_others(fleet) {
        return Vec::new();
    }
    // A charger that is nowhere is told; how far it is from luggage says nothing.
    if robots.iter().any(|robot| area.problem(robot.charger).is_some()) {
        return Vec::new();
    }
    let ranges: Option<Vec<Range>> = robots.iter().map(|robot| Range::of(fleet, &area, robot)).collect();
    let Some(ranges) = ranges else { return Vec::new() };
    let chargers = ranges.iter().map(|range| range.charger);
    let ends = luggage.iter().flat_map(|piece| [&piece.from, &piece.to]);
    let mut ways = Ways::on(&area.map, chargers.chain(ends.filter_map(|spot| spot.value.block())));
    let missed = Missed::on(&area.map, &ranges);
    let told = |missed: &Missed| {
        luggage.iter().filter_map(|piece| out_of_reach(&area, &ranges, missed, piece, &mut ways)).collect()
    };
    let mut findings: Vec<Finding> = missed.as_ref().map_or_else(Vec::new, told);
    let is_safe = robots.iter().all(|robot| robot.properties.policy == Policy::Safe);
    if findings.is_empty() && is_safe {
        let useless = useless(fleet, &area, (&robots, &ranges), luggage);
        if !useless.is_empty() {
            return useless;
        }
    }
    // How far a battery lasts that counts blocks alone does not depend on how long they take.
    let consumption = &robots[0].properties;
    let is_by_distance = consumption.discharge_per_block.is_some() && consumption.discharge_per_second.is_none();
    let is_timeless = is_by_distance && !findings.is_empty();
    // Luggage that no robot can bring is no load. What a classic robot does in a time with an empty battery is unknown.
    if findings.is_empty() && is_safe {
        let load = overloaded(&area, &ranges, luggage, &mut ways);
        let is_certain = load.as_ref().is_some_and(|finding| finding.own_severity() == Some(Severity::Error));
        let told = match load {
            Some(load) if is_certain => Some(load),
            load => overused(fleet, &robots, &ranges).or(load),
        };
        let is_lasting = luggage.iter().any(|piece| piece.is_lasting);
        let told = told.or_else(|| is_lasting.then(|| contended(fleet, &robots, &ranges)).flatten());
        findings.extend(told.or_else(|| barred(fleet, &area, (&robots, &ranges), luggage)));
    }
    let times = (!is_timeless).then_some(&ranges[0]);
    findings.into_iter().map(|finding| explained(fleet, finding, &area, robots[0], times)).collect()
}

/// The finding with the properties that make the work take energy, and, if times matter, of a robot of this range,
/// those that make it take long, as far as the composite gives them.
fn explained(
    fleet: &FleetView<'_>,
    finding: Finding,
    area: &WorldMap,
    robot: &FleetRobot,
    times: Option<&Range>,
) -> Finding {
    let takes = |count: fn(&Range) -> u32, what: &str| {
        let range = times?;
        let count = Some(count(range)).filter(|count| *count > 1)?;
        Some(match range.physical {
            Some(_) => format!("{what} takes {} s", f64::from(count) * range.period),
            None => format!("{what} takes {count} executions"),
        })
    };
    let properties = &robot.properties;
    let energy =
        |percent: Option<f64>, what: &str| percent.map(|percent| format!("each {what} takes {percent} % of a battery"));
    let discharge = energy(properties.discharge, "execution");
    let of_block = energy(properties.discharge_per_block, "block");
    let of_second = energy(properties.discharge_per_second, "second");
    let causes = [
        (area.index, "moveTime", takes(|range| range.moving, "a move")),
        (area.index, "handlingTime", takes(|range| range.handling, "collecting or depositing")),
        (robot.index, "discharge", discharge),
        (robot.index, "dischargePerBlock", of_block),
        (robot.index, "dischargePerSecond", of_second),
    ];
    let given = |index: usize, name: &str| fleet.components()[index].values.iter().any(|(given, _)| given == name);
    let causes = causes.into_iter().filter(|(index, name, _)| given(*index, name));
    causes.fold(finding, |finding, (index, name, text)| match text {
        Some(text) => finding.label(Place::property(name).in_component(index), text),
        None => finding,
    })
}

/// Range and speed of a robot.
struct Range {
    charger: Block,
    /// Number of executions that a full battery lasts while the robot drives; `u32::MAX` without discharge.
    full: u32,
    /// Number of executions off the charger for which the energy of one execution at the charger lasts; `None` without
    /// discharge.
    charge_factor: Option<f64>,
    /// Part of the time for which the robot has to be at its charger if it stands still in the rest of it.
    charging_at_rest: f64,
    /// The same where it drives in the rest of the time.
    charging_at_work: f64,
    /// Number of executions of a move.
    moving: u32,
    /// Number of executions of collecting or depositing.
    handling: u32,
    /// Seconds from one execution to the next.
    period: f64,
    /// The property that says what a move takes, where that is no execution.
    physical: Option<&'static str>,
}

impl Range {
    /// The range of a robot; `None` if its battery is faulty.
    fn of(fleet: &FleetView<'_>, area: &WorldMap, robot: &FleetRobot) -> Option<Range> {
        let period = fleet.components()[robot.index].period.unwrap_or_default();
        // A robot checks in each execution if its action is over. Without a world each action is over at once.
        let executions = |time: Duration| match robot.world {
            Some(world) if world == area.index => {
                let executions = time.as_nanos().div_ceil(period.as_nanos().max(1));
                u32::try_from(executions).unwrap_or(u32::MAX).max(1)
            }
            _ => 1,
        };
        let consumption = robot.properties.consumption().ok()?;
        let moving = executions(area.properties.move_time);
        // A classic robot drives on with an empty battery.
        let is_limited = robot.properties.policy == Policy::Safe;
        let charge_factor = consumption.charge_factor(period, moving).filter(|_| is_limited);
        let at_rest = consumption.charge_factor(period, u32::MAX).filter(|_| is_limited);
        let charging = |factor: Option<f64>| factor.map_or(0.0, |factor| 1.0 / (1.0 + factor));
        let full = Battery::new(100.0, consumption).executions_when_full(period, moving);
        Some(Range {
            charger: robot.charger,
            charge_factor,
            charging_at_rest: charging(at_rest),
            charging_at_work: charging(charge_factor),
            full: if is_limited { full } else { u32::MAX },
            moving,
            handling: executions(area.properties.handling_time),
            period: period.as_secs_f64(),
            physical: match (robot.properties.discharge_per_block, robot.properties.discharge_per_second) {
                (Some(_), _) => Some("dischargePerBlock"),
                (None, Some(_)) => Some("dischargePerSecond"),
                (None, None) => None,
            },
        })
    }

    /// True if it can go there and back. It may charge between collecting and depositing, so it never needs more at
    /// once.
    fn reaches(&self, moves: u32) -> bool {
        is_within(moves, self.moving, self.handling, self.full)
    }

    /// Maximum number of moves from its charger.
    fn most(&self) -> u32 {
        let (mut reached, mut beyond) = (0, self.full / 2 / self.moving + 1);
        while reached + 1 < beyond {
            let middle = reached + (beyond - reached) / 2;
            if self.reaches(middle) { reached = middle } else { beyond = middle }
        }
        reached
    }
}
