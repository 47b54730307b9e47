//! Robots that are too many for their map, or for a charger that they share, and chargers in the way of others.

use std::fmt::Write;

use super::sites::found;

/// A site with a world of a single row of this length, and robots from this number on, with these properties.
fn row(site: &str, length: usize, numbers: std::ops::Range<usize>, properties: &str) -> String {
    let letter = &site[..site.len().min(1)];
    let lines = format!("{letter}World:World:{site} width={length}|height=1\n");
    lines + &robots(site, numbers, properties)
}

/// Robots of a site, each wired to its world, with a charger of its own in the first row.
fn robots(site: &str, numbers: std::ops::Range<usize>, properties: &str) -> String {
    let letter = &site[..site.len().min(1)];
    let mut lines = String::new();
    for number in numbers {
        let name = format!("{letter}Robot{number}:Robot:{site}@{letter}World");
        let _ = writeln!(lines, "{name} chargeX={}|chargeY=0|{properties}", number - 1);
    }
    lines
}

/// What is found about crowds.
fn crowds(lines: &str) -> Vec<String> {
    found(lines).into_iter().filter(|found| found.starts_with("S5029")).collect()
}

fn crowd(robots: usize, blocks: usize) -> String {
    format!(
        "S5029 {robots} robots with batteries share {blocks} free blocks: they may be in each other's way to the \
        chargers until some are stranded"
    )
}

#[test]
fn robots_with_five_free_blocks_each_are_a_crowd() {
    assert_eq!(crowds(&row("", 30, 1..7, "")), [crowd(6, 30)]);
    assert_eq!(crowds(&row("", 31, 1..7, "")), [""; 0]);
    assert_eq!(crowds(&row("", 6, 1..6, "")), [""; 0], "a few robots get out of each other's way");
    // Robots that are never stranded are no part of it.
    assert_eq!(crowds(&row("", 30, 1..7, "discharge=0")), [""; 0]);
    assert_eq!(crowds(&row("", 30, 1..7, "policy=classic")), [""; 0]);
    let physical = |discharge: &str| format!("chargePerSecond=5|dischargePerSecond={discharge}");
    assert_eq!(crowds(&row("", 30, 1..7, &physical("0"))), [""; 0]);
    assert_eq!(crowds(&row("", 30, 1..7, &physical("0.1"))), [crowd(6, 30)]);
    assert_eq!(crowds(&(row("", 30, 1..6, "") + &robots("", 6..7, "discharge=0"))), [""; 0]);
}

#[test]
fn robots_with_small_batteries_need_more_room() {
    let site = |robots_: std::ops::Range<usize>, length: usize, properties: &str| {
        crowds(&row("", length, robots_, &format!("{properties}|"))).join("\n")
    };
    let small = |moves: u32, robots: usize, blocks: usize| {
        format!(
            "S5029 a full battery lasts for {moves} moves, and {robots} robots share {blocks} free blocks: too little is \
            left for waiting on the way to the charger, and some may be stranded"
        )
    };
    assert_eq!(site(1..7, 150, "discharge=2.5"), small(40, 6, 150));
    assert_eq!(site(1..7, 151, "discharge=2.5"), "");
    assert_eq!(site(1..6, 100, "discharge=2.5"), "", "a few robots get out of each other's way");
    assert_eq!(site(1..7, 100, "discharge=2"), "");
    assert_eq!(site(1..7, 30, "discharge=2.5"), crowd(6, 30), "there is no room, whatever batteries they have");
    // Each move takes two executions, and the manual's battery lasts for 50.
    let slow = row("", 100, 1..7, "").replace("height=1", "height=1|moveTime=200ms");
    assert_eq!(crowds(&slow), [small(25, 6, 100)]);
    let physical = "chargePerSecond=5|dischargePerSecond=0|dischargePerBlock";
    assert_eq!(site(1..7, 100, &format!("{physical}=2.5")), small(40, 6, 100));
    assert_eq!(site(1..7, 100, &format!("{physical}=2")), "");
    let mixed = |small: &str| row("", 175, 1..7, "discharge=1") + &robots("", 7..8, "discharge=4") + small;
    assert_eq!(crowds(&mixed("")), [""; 0], "those that can wait make way for a few others");
    assert_eq!(crowds(&mixed(&robots("", 8..13, "discharge=4"))), [small(25, 12, 175)]);
}

#[test]
fn a_crowd_is_on_one_map() {
    // Six robots in two worlds are none, whatever their numbers.
    assert_eq!(crowds(&(row("North", 15, 1..4, "") + &row("South", 15, 1..4, ""))), [""; 0]);
    let both = row("North", 20, 1..7, "") + &row("South", 25, 1..8, "");
    assert_eq!(crowds(&both), [crowd(6, 20), crowd(7, 25)]);
    // Robots without a world have no map, but one that hears of them knows where they are.
    let unwired = |lines: &str| lines.replace("@World", "");
    assert_eq!(crowds(&unwired(&robots("", 1..9, ""))), [""; 0]);
    assert_eq!(crowds(&unwired(&row("", 20, 1..7, ""))), [crowd(6, 20)]);
}

#[test]
fn blocks_that_no_robot_reaches_are_no_room() {
    let walled = |at: &str| row("", 60, 1..7, "").replace("height=1", &format!("height=1|blocked={at}"));
    assert_eq!(crowds(&walled("(20,0)")), [crowd(6, 20)]);
    assert_eq!(crowds(&walled("(40,0)")), [""; 0]);
    // Three robots on each side of a wall.
    assert_eq!(crowds(&walled("(20,0)").replace("chargeX=5", "chargeX=25")), [""; 0]);
}

#[test]
fn a_shared_charger_in_use_most_of_the_time_is_told_where_the_luggage_lasts() {
    let site = |scenario: &str, charge: &str| {
        let robots = (1..4).map(|number| {
            let battery = "dischargePerBlock=0.5|dischargePerSecond=0.5";
            let places = format!("chargeX=2|chargeY=2|startX={number}|startY=5");
            format!("Robot{number}:Robot:@World {places}|{battery}|chargePerSecond={charge}\n")
        });
        let robots: String = robots.collect();
        format!(
            "World:World: moveTime=1s\nEnvironment:Environment: scenario={scenario}\nMaster:MasterEnvironment:\n\
            {robots}"
        )
    };
    let told = |scenario: &str, charge: &str| found(&site(scenario, charge));
    let message = "S5006 robots 1, 2, 3 share the charger at (2,2), and need it for 75 % of the time while all of them \
        drive: one that has to wait there may be stranded";
    let lasting = ["from 1s every 5min luggage random to random", "from 1s every 5s 20 times luggage (1,1) to (7,7)"];
    for scenario in lasting {
        assert_eq!(told(scenario, "3"), [message], "{scenario}");
        assert_eq!(told(scenario, "4"), [""; 0], "{scenario}");
    }
    assert_eq!(told("from 1s every 5s 19 times luggage (1,1) to (7,7)", "3"), [""; 0]);
    // Luggage that is certainly too much is an error, which a warning does not hide.
    let too_much = told("from 1s every 1s luggage (1,1) to (7,7)", "0.5");
    assert!(too_much.len() == 1 && too_much[0].starts_with("S5006 luggage comes faster"), "{too_much:?}");
}

#[test]
fn a_charger_in_the_only_way_to_another_one_is_told_where_batteries_hardly_last() {
    // A dead end, three blocks long, beside a hall.
    let site = |places: [(u32, u32); 2], discharge: &str, luggage: &str| {
        let robots = (1..).zip(places).map(|(number, (x, y))| {
            let battery = format!("dischargePerBlock={discharge}|chargePerSecond=10");
            format!("Robot{number}:Robot:@World chargeX={x}|chargeY={y}|{battery}\n")
        });
        let robots: String = robots.collect();
        let map = ["@@@......", ".........", "@@@......", "@@@......"].join("&#10;");
        format!(
            "World:World: map={map}|moveTime=1s\nEnvironment:Environment: scenario={luggage}\n\
            Master:MasterEnvironment:\n{robots}"
        )
    };
    let far = "from 1s every 5min luggage (3,1) to (8,3)";
    let message = |charger: &str, robot: u32| {
        format!(
            "S5006 a robot that charges at {charger} is in the only way of robot {robot} to its charger, and it may be \
            stranded while it waits: half of a battery does not last for the farthest luggage, there and back"
        )
    };
    let told = |places: [(u32, u32); 2], discharge: &str, luggage: &str| found(&site(places, discharge, luggage));
    assert_eq!(told([(2, 1), (1, 1)], "2.5", far), [message("(2,1)", 2)]);
    assert_eq!(told([(1, 1), (2, 1)], "2.5", far), [message("(2,1)", 1)]);
    // Half of a battery lasts.
    assert_eq!(told([(2, 1), (1, 1)], "1.5", far), [""; 0]);
    assert_eq!(told([(2, 1), (1, 1)], "2.5", "from 1s every 5min luggage (3,1) to (4,1)"), [""; 0]);
    // Robots drive past the charger, or share it.
    assert_eq!(told([(3, 1), (4, 1)], "2.5", far), [""; 0]);
}
