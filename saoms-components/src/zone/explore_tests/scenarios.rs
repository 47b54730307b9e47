//! What is explored.

use super::{Faults, Scenario};

/// Two robots that exchange their places on a square.
const SQUARE: Scenario = Scenario {
    name: "square",
    map: "..\n..",
    zones: &[(0, 2)],
    robots: &[((0, 0), (1, 1)), ((1, 1), (0, 0))],
    entering: 0,
    drawings: &[],
    asks: true,
    faults: NONE,
    ahead: 1,
    needed: 0,
    waits: 0,
    arriving: 2,
};

/// Two robots that have to pass each other beside a single block.
const BAY: Scenario = Scenario {
    name: "bay",
    map: "...\n@.@",
    robots: &[((0, 0), (2, 0)), ((2, 0), (0, 0))],
    zones: &[(0, 3)],
    waits: 4,
    ..SQUARE
};

/// A robot that drives from one zone to the other.
const BORDER: Scenario =
    Scenario { name: "border", map: "...", zones: &[(0, 2), (2, 1)], robots: &[((0, 0), (2, 0))], ..SQUARE };

const NONE: Faults = Faults { robots: 0, zones: 0, gone: 0, back: 0 };

fn explore(scenarios: &[Scenario]) {
    for scenario in scenarios {
        let states = scenario.explore();
        println!("{}, {:?}: {states} states", scenario.name, scenario.faults);
    }
}

/// Three robots on four blocks: each can only go where the next one was.
const ROUND: Scenario =
    Scenario { name: "round", robots: &[((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (0, 1))], ..SQUARE };

/// Four robots, of which each can only go where the next one was.
const ROW: Scenario = Scenario {
    name: "row",
    map: "...\n...",
    zones: &[(0, 3)],
    robots: &[((0, 0), (1, 0)), ((1, 0), (2, 0)), ((2, 0), (2, 1)), ((2, 1), (1, 1))],
    ..SQUARE
};

/// Two robots, of which each has to enter the zone of the other one.
const ZONES: Scenario = Scenario { name: "zones", zones: HALVES, ..SQUARE };

/// Two robots, of which the first one drives into another zone, and the second one follows it.
const TRAIN: Scenario = Scenario {
    name: "train",
    map: "...",
    zones: &[(0, 2), (2, 1)],
    robots: &[((0, 0), (1, 0)), ((1, 0), (2, 0))],
    ..SQUARE
};

/// Two robots that drive in the same direction: each has to enter two blocks where the other one may have been.
const QUEUE: Scenario =
    Scenario { name: "queue", map: "....", zones: &[(0, 4)], robots: &[((0, 0), (2, 0)), ((1, 0), (3, 0))], ..SQUARE };

/// Three robots in two zones, of which each can only go where the next one was, and two drive over the border.
const ACROSS: Scenario = Scenario { name: "across", zones: HALVES, ..ROUND };

/// Three robots that drive in the same direction, over the border of two zones.
const CONVOY: Scenario = Scenario {
    name: "convoy",
    map: "....",
    zones: &[(0, 2), (2, 2)],
    robots: &[((0, 0), (1, 0)), ((1, 0), (2, 0)), ((2, 0), (3, 0))],
    ..SQUARE
};

#[test]
fn three_robots_in_two_zones_do_not_collide_or_stand_still() {
    explore(&[CONVOY, ACROSS]);
}

/// Here late messages never overtake newer ones.
#[test]
fn one_of_three_robots_and_one_of_two_zones_that_fail_lead_to_no_collision_and_no_standstill() {
    let faults = [Faults { robots: 1, ..NONE }, Faults { zones: 1, ..NONE }];
    explore(&faults.map(|faults| Scenario { faults, arriving: 1, ..ACROSS }));
}

#[test]
fn messages_that_are_lost_late_or_come_again_lead_to_no_collision_and_no_standstill() {
    explore(&[SQUARE, BORDER, BAY, ROUND, ROW, TRAIN]);
}

#[test]
fn robots_that_exchange_their_zones_do_not_collide_or_stand_still() {
    explore(&[ZONES]);
}

#[test]
fn blocks_that_are_granted_ahead_beside_other_robots_lead_to_no_collision_and_no_standstill() {
    explore(&[Scenario { needed: 2, ..SQUARE }, Scenario { needed: 2, ..ROUND }, Scenario { needed: 3, ..ROW }]);
}

#[test]
fn robots_that_lose_their_memory_lead_to_no_collision_and_no_standstill() {
    let faults = Faults { robots: 1, ..NONE };
    let train = Scenario { faults, ..TRAIN };
    explore(&[Scenario { faults, ..BORDER }, Scenario { faults, ..ROUND }, Scenario { faults, ..SQUARE }, train]);
}

#[test]
fn zones_that_lose_their_record_lead_to_no_collision_and_no_standstill() {
    let faults = Faults { zones: 1, ..NONE };
    let train = Scenario { faults, ..TRAIN };
    explore(&[Scenario { faults, ..BORDER }, Scenario { faults, ..ROUND }, Scenario { faults, ..SQUARE }, train]);
}

#[test]
fn robots_that_are_taken_off_the_floor_lead_to_no_collision_and_no_standstill() {
    let faults = Faults { gone: 1, ..NONE };
    explore(&[QUEUE, BORDER, SQUARE, ROUND, TRAIN].map(|scenario| Scenario { faults, ..scenario }));
}

#[test]
fn robots_that_are_gone_and_come_back_lead_to_no_collision_and_no_standstill() {
    let faults = Faults { gone: 1, back: 1, ..NONE };
    explore(&[BORDER, SQUARE].map(|scenario| Scenario { faults, arriving: 1, ..scenario }));
}

/// A robot that drives over the block where another one wants to enter the floor.
const ENTRY: Scenario =
    Scenario { name: "entry", robots: &[((0, 0), (1, 1)), ((1, 0), (0, 1))], entering: 1, ..SQUARE };

#[test]
fn robots_that_enter_the_floor_among_others_do_not_collide_or_stand_still() {
    explore(&[ENTRY, Scenario { entering: 2, ..SQUARE }, Scenario { entering: 1, ..TRAIN }]);
}

#[test]
fn robots_and_zones_that_fail_while_a_robot_enters_the_floor_lead_to_no_collision_and_no_standstill() {
    let faults = [Faults { robots: 1, ..NONE }, Faults { zones: 1, ..NONE }, Faults { gone: 1, back: 1, ..NONE }];
    explore(&faults.map(|faults| Scenario { faults, arriving: 1, ..ENTRY }));
}

/// Borders: number, first column and number of columns of each zone.
type Borders = &'static [(u32, i32, u32)];

/// The first column becomes a zone of its own, and the other one keeps its number; or both get new ones.
const EAST: Borders = &[(1, 1, 1), (2, 0, 1)];
const BOTH: Borders = &[(2, 0, 1), (3, 1, 1)];

/// Both columns become one zone.
const UNITED: Borders = &[(1, 0, 2)];

/// The border of three columns moves; and again, to a zone of another number.
const MOVED: Borders = &[(1, 0, 1), (2, 1, 2)];
const AGAIN: Borders = &[(3, 0, 2), (2, 2, 1)];

/// Two zones beside each other.
const HALVES: &[(i32, u32)] = &[(0, 1), (1, 1)];

/// The robot of a square, which drives over the border.
const ALONE: Scenario = Scenario { robots: &[((0, 0), (1, 1))], ..SQUARE };

#[test]
fn a_zone_that_is_divided_leads_to_no_collision_and_no_standstill() {
    explore(&[
        Scenario { name: "divided, alone", drawings: &[EAST], ..ALONE },
        Scenario { name: "divided, new numbers, alone", drawings: &[BOTH], ..ALONE },
    ]);
}

#[test]
fn zones_that_become_one_lead_to_no_collision_and_no_standstill() {
    explore(&[
        Scenario { name: "united, alone", zones: HALVES, drawings: &[UNITED], ..ALONE },
        Scenario { name: "united, divided, alone", zones: HALVES, drawings: &[UNITED, EAST], ..ALONE },
    ]);
}

#[test]
fn a_border_that_moves_leads_to_no_collision_and_no_standstill() {
    explore(&[
        Scenario { name: "moved, alone", drawings: &[MOVED], ..BORDER },
        Scenario { name: "moved twice, alone", drawings: &[MOVED, AGAIN], asks: false, arriving: 1, ..BORDER },
        Scenario { name: "moved", drawings: &[MOVED], asks: false, arriving: 1, ..TRAIN },
    ]);
}

#[test]
fn robots_and_zones_that_fail_while_borders_change_lead_to_no_collision_and_no_standstill() {
    let faults = [Faults { robots: 1, ..NONE }, Faults { zones: 1, ..NONE }];
    explore(&faults.map(|faults| Scenario { name: "moved, alone", drawings: &[MOVED], faults, arriving: 1, ..BORDER }));
    explore(&faults.map(|faults| Scenario { name: "divided, alone", drawings: &[EAST], faults, arriving: 1, ..ALONE }));
}
