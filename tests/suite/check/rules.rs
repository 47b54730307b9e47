//! The rules over whole fleets that the shipped components bring: their part of `docs/diagnostics.md`, with an example
//! of each, and where they say nothing.
//!
//! `UPDATE_EXPECT=1 cargo test --test suite rules` writes the part anew, and what the examples say of themselves.

use std::fmt::Write as _;
use std::{env, fs};

use saoms_lang::registry::Registry;
use saoms_testkit::{Fleet, expect_diagnostics};

use crate::support::root;

#[test]
fn every_rule_is_documented_with_an_example() {
    let registry = Registry::linked().unwrap();
    let (mut part, mut rows) = (String::new(), String::new());
    for rule in registry.rules() {
        let (id, name, meaning) = (rule.code().id, rule.code().name, rule.code().meaning);
        assert!(id.len() == 5 && id.starts_with("S50") && meaning.ends_with('.'), "{id}");
        let file = format!("tests/rules/{id}.composite");
        let text = fs::read_to_string(root().join(&file)).unwrap_or_else(|_| panic!("there is no {file}"));
        let shown = Fleet::of_text(text).shown().replace("text.composite", &format!("{id}.composite"));
        assert!(shown.contains("help:"), "{id} does not say what to do");
        let severity = rule.code().severity.name();
        assert!(shown.starts_with(&format!("{severity}[{id}]")), "{file} does not have its fault:\n{shown}");
        let _ = write!(part, "\n## {id} {name}\n\n*{severity}.* {meaning}\n\n```text\n{shown}```\n");
        let _ = writeln!(rows, "| {id} | {name} | {meaning} |  |  |");
    }
    let is_kept =
        [("docs/diagnostics.md", part, "\n## S5"), ("docs/rules.md", rows, "| S5")].map(|(page, part, start)| {
            let path = root().join(page);
            let text = fs::read_to_string(&path).unwrap();
            let (before, behind) = around(&text, start);
            let right = format!("{before}{part}{behind}");
            if env::var_os("UPDATE_EXPECT").is_some() {
                fs::write(path, &right).unwrap();
            }
            text == right || env::var_os("UPDATE_EXPECT").is_some()
        });
    assert_eq!(is_kept, [true, true], "docs/diagnostics.md or docs/rules.md is out of date: run with UPDATE_EXPECT=1");
}

/// The text of a page before the part about rules over whole fleets, and behind it.
fn around<'t>(text: &'t str, start: &str) -> (&'t str, &'t str) {
    if start.starts_with('\n') {
        return text.find(start).map_or((text, ""), |at| (&text[..at], ""));
    }
    // The rows of a table, behind the last of the codes of the core.
    let mut rows = text.split_inclusive('\n').filter(|line| line.starts_with("| S") && !line.starts_with(start));
    let last = rows.next_back().unwrap();
    let begin = text.find(last).unwrap() + last.len();
    let of_part = text[begin..].split_inclusive('\n').take_while(|line| line.starts_with(start));
    let end = begin + of_part.map(str::len).sum::<usize>();
    (&text[..begin], &text[end..])
}

#[test]
fn the_examples_have_the_faults_that_they_say() {
    expect_diagnostics(root().join("tests/rules"));
}

/// A component: its name, class and properties, and whether it is wired to the world.
pub(super) type Component<'a> = (&'a str, &'a str, &'a [(&'a str, &'a str)], bool);

/// A composite of these components, from line 2 on, each in a line.
pub(super) fn fleet(components: &[Component<'_>]) -> String {
    let mut text =
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:t\" name=\"t\">\n"
            .to_owned();
    for (name, class, properties, is_wired) in components {
        let _ = write!(text, "<component name=\"{name}\"><implementation.java class=\"{class}\"/>");
        for (property, value) in [("ID", *name), ("period", "100")].iter().chain(*properties) {
            let _ = write!(text, "<property name=\"{property}\">{value}</property>");
        }
        text += if *is_wired { "<reference name=\"world\" target=\"World\"/>" } else { "" };
        text += "</component>\n";
    }
    text + "</composite>"
}

/// The findings, without lines and columns.
pub(super) fn found(components: &[Component<'_>]) -> Vec<String> {
    let found = Fleet::of_text(fleet(components)).diagnostics();
    let plain = |line: &str| {
        let mut words = line.splitn(4, ' ');
        format!("{} {} {}", words.next().unwrap(), words.next().unwrap(), words.nth(1).unwrap())
    };
    found.lines().map(plain).collect()
}

pub(super) const MASTER: Component<'_> = ("Master", "saoms.MasterEnvironment", &[], false);

pub(super) const ROBOT: Component<'_> = ("Robot1", "saoms.Robot", &[], true);

/// The findings with this scenario on this map, and one robot.
fn with_scenario(map: &str, scenario: &str) -> Vec<String> {
    found(&[
        ("World", "saoms.World", &[("map", map)], false),
        ("Environment", "saoms.Environment", &[("scenario", scenario)], false),
        MASTER,
        ROBOT,
    ])
}

#[test]
fn luggage_is_looked_at_wherever_it_may_be() {
    let map = ".....\n.@@..\n.@...";
    assert!(with_scenario(map, "at 1s luggage (3,1) to (4,2); at 2s luggage random to (0,0)..(1,2)").is_empty());
    assert_eq!(
        with_scenario(map, "at 1s luggage (5,1) to (4,9)\nat 1s luggage (1,1)..(2,1) to (1,2)"),
        [
            "error S5001 luggage cannot be at (5,1) and (4,9): these blocks are outside the map, which goes from (0,0) to (4,2)",
            "error S5001 luggage cannot be from (1,1) to (2,1): these blocks are all blocked",
            "error S5001 luggage cannot be at (1,2): this block is blocked on the map",
        ]
    );
    assert_eq!(
        with_scenario(map, "at 1s luggage (0,0)..(5,1) to (4,2)"),
        ["warning S5001 the blocks from (0,0) to (5,1) are partly outside the map, which ends at (4,2)"]
    );
    let without = [
        ("Environment", "saoms.Environment", &[("scenario", "at 1s luggage random to (70,7)")][..], false),
        MASTER,
        ("Robot1", "saoms.Robot", &[], false),
    ];
    assert_eq!(
        found(&without),
        ["error S5001 `random` needs an area to draw a block from, but no component of the \
        fleet defines one"]
    );
    // A wrong line and an impossible one are reported together.
    let both = with_scenario(map, "at 1s lugage (1,1) to (0,0); at 1s luggage (1,1) to (0,0)");
    assert_eq!(both.len(), 2, "{both:?}");
}

#[test]
fn chargers_are_looked_at_in_the_world_that_they_are_in() {
    let world = ("World", "saoms.World", &[("width", "4"), ("height", "4"), ("blocked", "(0,2)")][..], false);
    fn robot(name: &str, is_wired: bool) -> Component<'_> {
        (name, "saoms.Robot", &[], is_wired)
    }
    assert_eq!(
        found(&[world, ROBOT, robot("Robot2", true), robot("Robot9", true), robot("Robot8", false)]),
        [
            "error S5002 the charger of robot 2 is at (0,2), blocked on the map",
            "error S5002 the charger of robot 9 is at (0,9), outside the map, which goes from (0,0) to (3,3)",
            "warning S5009 this robot is not wired to a world, but others are: the world and the other robots do not \
            know where it is",
            "warning S5002 the charger of robot 8 is at (0,8), outside the map, which goes from (0,0) to (3,3)",
        ]
    );
}

/// Robots that move beside a world: all of them, or some. A mistake in a wire is reported alone.
#[test]
fn robots_outside_of_the_world_are_told_unless_a_wire_has_a_fault() {
    let world = ("World", "saoms.World", &[][..], false);
    fn robot(name: &str, is_wired: bool) -> Component<'_> {
        (name, "saoms.Robot", &[], is_wired)
    }
    let beside = "warning S5009 this robot is not wired to a world, but others are: the world and the other robots \
        do not \
        know where it is";
    assert_eq!(
        found(&[world, ROBOT, robot("Robot2", false), robot("Robot3", false), robot("Robot4", true)]),
        [beside, beside]
    );
    let text = fleet(&[world, ROBOT]);
    for (right, wrong, code) in [
        ("target=\"World\"", "target=\"Wrld\"", "S2011"),
        ("target=\"World\"", "target=\"World/hardwere\"", "S2012"),
        ("name=\"world\"", "name=\"wrld\"", "S2006"),
        ("target=\"World\"", "targt=\"World\"", "S1007"),
        ("target=\"World\"/></component>", "/></component><wire source=\"Q*/world\" target=\"World\"/>", "S2011"),
    ] {
        let found = Fleet::of_text(text.replace(right, wrong)).diagnostics();
        assert!(found.lines().count() == 1 && found.contains(code), "{wrong}: {found}");
    }
    // Findings that do not concern wires are reported together with them.
    let far: &[(&str, &str)] = &[("chargeX", "40"), ("battery", "10")];
    let text = fleet(&[
        ("World", "saoms.World", &[], false),
        ("Environment", "saoms.Environment", &[("scenario", "at 1s breakdown Robot7")], false),
        ("Robot1", "saoms.Robot", far, true),
    ]);
    let found = Fleet::of_text(text.replace("target=\"World\"", "target=\"Wrld\"")).diagnostics();
    assert!(found.contains("S2011") && found.contains("S5005"), "{found}");
}

#[test]
fn an_id_without_a_number_is_shown_at_the_id_alone() {
    for id in ["Alpha", "R${index}"] {
        let text = fleet(&[
            ("Environment", "saoms.Environment", &[("scenario", "at 1s luggage (1,1) to (2,2)")], false),
            MASTER,
            ("Robot1", "saoms.Robot", &[], false),
        ]);
        let text = text.replace("<property name=\"ID\">Robot1<", &format!("<property name=\"ID\">{id}<"));
        let found = Fleet::of_text(text.clone()).diagnostics();
        assert_eq!(found.lines().count(), 1, "{found}");
        let column = text.lines().nth(3).unwrap().find(id).unwrap() + 1;
        assert!(found.contains(&format!("4:{column}")) && found.contains("S3014"), "{column}: {found}");
    }
    let same: &[(&str, &str)] = &[("number", "1"), ("chargeX", "3")];
    let twice = fleet(&[("Robot1", "saoms.Robot", &[], false), ("R", "saoms.Robot", same, false)]);
    let found = Fleet::of_text(twice.replace("name=\"ID\">R<", "name=\"ID\">Robot1<")).diagnostics();
    assert!(found.lines().count() == 1 && found.contains("S3013"), "{found}");
}

#[test]
fn robots_of_one_number_stay_an_error_where_their_id_may_be_shared() {
    let numbers: &[(&str, &str)] = &[("number", "1"), ("chargeX", "3")];
    let other: &[(&str, &str)] = &[("number", "1")];
    for (one, two, id) in [(&[][..], &[("chargeX", "3")][..], "Robot1"), (other, numbers, "R2")] {
        let text = fleet(&[("Robot1", "saoms.Robot", one, false), ("R", "saoms.Robot", two, false)]);
        let text = text.replace("name=\"ID\">R<", &format!("name=\"ID\">{id}<")).replace(
            "</composite>",
            "<s:severity xmlns:s='urn:saoms:1' code='S3013' level='allow' reason='one of them is away'/></composite>",
        );
        let found = Fleet::of_text(text).diagnostics();
        assert!(found.contains("error S5004"), "{id}: {found}");
    }
}

#[test]
fn a_charger_outside_the_map_is_shown_where_it_leaves_the_map() {
    for (properties, wrong) in
        [([("chargeX", "33"), ("chargeY", "2")], "33"), ([("chargeX", "2"), ("chargeY", "22")], "22")]
    {
        let text = fleet(&[("World", "saoms.World", &[], false), ("Robot1", "saoms.Robot", &properties, true)]);
        let found = Fleet::of_text(text.clone()).diagnostics();
        let mut place = found.split([' ', ':']).filter_map(|word| word.parse::<usize>().ok());
        let (line, column) = (place.next().unwrap(), place.next().unwrap());
        let rest = &text.lines().nth(line - 1).unwrap()[column - 1..];
        assert!(rest.starts_with(wrong), "{found}: {rest}");
    }
}

/// The world lets no robot start there: a check that passes is not to promise it.
#[test]
fn what_no_world_lets_start_cannot_be_lowered() {
    let charger: &[(&str, &str)] = &[("chargeX", "0"), ("chargeY", "1")];
    let fleet = fleet(&[
        ("World", "saoms.World", &[], false),
        ("Robot1", "saoms.Robot", &[], true),
        ("Robot2", "saoms.Robot", charger, true),
    ]);
    let lowered = "<s:severity xmlns:s='urn:saoms:1' code='S5003' level='warning' reason='one dock'/></composite>";
    let shown = Fleet::of_text(fleet.replace("</composite>", lowered)).shown();
    assert!(shown.starts_with("error[S5003]") && shown.contains("cannot be lowered"), "{shown}");
}

#[test]
fn robots_of_one_number_are_found_with_and_without_a_world() {
    fn robot<'a>(name: &'a str, class: &'a str, properties: &'a [(&'a str, &'a str)]) -> Component<'a> {
        (name, class, properties, false)
    }
    let number: &[(&str, &str)] = &[("number", "1"), ("chargeX", "3")];
    let one = "robots `Robot1` and `R` both have the number 1";
    assert_eq!(
        found(&[robot("Robot1", "saoms.Robot", &[]), robot("R", "saoms.Robot", number)]),
        [format!("error S5004 {one}")]
    );
    assert_eq!(
        found(&[robot("Robot1", "saoms.Robot", &[]), robot("R", "robot.Robot001", &[])]),
        [format!("error S5004 {one}")],
        "their common block is not told, too"
    );
    let both = found(&[robot("R", "robot.Robot001", &[]), robot("S", "saoms.Robot", number)]);
    assert_eq!(both.len(), 1);
    assert!(both[0].starts_with("error S3013"), "{both:?}");
    let apart: &[(&str, &str)] = &[("number", "2"), ("chargeX", "3")];
    assert!(found(&[robot("Robot1", "saoms.Robot", &[]), robot("R", "saoms.Robot", apart)]).is_empty());
}

#[test]
fn events_of_unknown_robots_are_found() {
    let scenario = |scenario: &'static str| {
        let environment = [("scenario", scenario)];
        found(&[
            ("Environment", "saoms.Environment", &environment, false),
            MASTER,
            ("Robot1", "saoms.Robot", &[], false),
            ("Lift5", "saoms.Robot", &[("number", "2")], false),
        ])
    };
    assert!(scenario("at 1s breakdown 1..2; at 1s breakdown Robot1").is_empty());
    assert_eq!(
        scenario("at 1s breakdown Robt1; at 2s breakdown Robot2"),
        [
            "warning S5005 no robot has the ID `Robt1`: it means robot 1 here, whose ID is `Robot1`",
            "warning S5005 no robot has the ID `Robot2`: it means robot 2 here, whose ID is `Lift5`",
        ]
    );
    assert_eq!(
        scenario("at 1s gone Robt1; at 2s gone Robot7"),
        [
            "warning S5005 no robot has the ID `Robt1`: it means robot 1 here, whose ID is `Robot1`",
            "error S5005 the fleet has no robot 7",
        ]
    );
    assert_eq!(
        scenario("at 1s breakdown Robot7; at 2s breakdown 4..6; at 3s breakdown 1..3; at 4s breakdown Lift5"),
        [
            "error S5005 the fleet has no robot 7",
            "error S5005 the fleet has no robot from 4 to 6",
            "error S5005 the fleet has only 2 of the robots from 1 to 3",
            "error S5005 `Lift5` means robot 5 here, but the robot with this ID has the number 2",
        ]
    );
}

#[test]
fn only_what_no_full_battery_can_do_is_out_of_reach() {
    let row = ".".repeat(60);
    let map = format!("{row}\n{row}\n{row}");
    // Robot 1 is at (0,1), and a full battery lasts for 50 executions; it keeps some in reserve.
    assert!(with_scenario(&map, "at 1s luggage (0,0) to (20,1)").is_empty());
    let far = with_scenario(&map, "at 1s luggage (21,1) to (0,0)");
    assert_eq!(far.len(), 1);
    assert!(far[0].starts_with("error S5006 no robot can bring luggage from (21,1): it is 21 moves"), "{far:?}");
    let range = with_scenario(&map, "at 1s luggage (0,0) to (1,0)..(30,2)");
    let part = "warning S5006 no robot can bring luggage to 32 of the 90 free blocks here: (20,0) is ";
    assert!(range.len() == 1 && range[0].starts_with(part), "{range:?}");
    // A classic robot drives on with an empty battery, if it can go there.
    let with_classic = |properties: &[(&str, &str)]| {
        let mut told = found(&[
            ("World", "saoms.World", &[("map", &format!("{row}\n{}\n{row}", "@".repeat(60)))], false),
            ("Environment", "saoms.Environment", &[("scenario", "at 1s luggage (40,2) to (30,2)")], false),
            MASTER,
            ("Robot1", "saoms.Robot", &[("chargeY", "2"), ("discharge", "2")], true),
            ("Robot2", "saoms.Robot", &[&[("policy", "classic"), ("chargeX", "1")], properties].concat(), true),
        ]);
        // The wall is a mistake of its own.
        let count = told.len();
        told.retain(|line| !line.starts_with("warning S5021"));
        assert_eq!(told.len() + 1, count, "{told:?}");
        told
    };
    assert!(with_classic(&[("chargeY", "2")]).is_empty());
    for properties in [&[("chargeY", "0")][..], &[("chargeY", "2"), ("asleep", "true")]] {
        let told = with_classic(properties);
        assert!(
            told.len() == 1 && told[0].starts_with("error S5006 no robot can bring luggage from (40,2)"),
            "{told:?}"
        );
    }
    let all = with_scenario(&map, "at 1s luggage (0,0) to (25,0)..(30,2)");
    assert!(all.len() == 1 && all[0].starts_with("error S5006 no robot can bring luggage to 18 of the 18"), "{all:?}");
    // Around a wall it is farther.
    let wall = format!("{row}\n.@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@@{}\n{row}", ".".repeat(19));
    assert!(with_scenario(&wall, "at 1s luggage (0,0) to (19,2)").is_empty());
    let wall = wall.replace(&format!("\n{row}"), &format!("\n@{}", &row[1..]));
    assert_eq!(with_scenario(&wall, "at 1s luggage (0,0) to (19,2)").len(), 1);
}

#[test]
fn parts_of_a_map_without_a_charger_are_found() {
    let map = "..@..\n..@..\n@@@@@\n.....";
    assert!(with_scenario(map, "at 1s luggage (0,0) to (0,1)..(1,1)").is_empty());
    assert_eq!(
        with_scenario(map, "at 1s luggage (4,0) to (0,3); at 1s luggage random to (0,0)"),
        [
            "error S5007 the map has no path from any robot's charger to (4,0)",
            "error S5007 the map has no path from any robot's charger to (0,3)",
            "warning S5007 the map has no path from any robot's charger to 9 of these 13 free blocks",
        ]
    );
    let two = found(&[
        ("World", "saoms.World", &[("map", map)], false),
        ("Environment", "saoms.Environment", &[("scenario", "at 1s luggage (0,0) to (4,0)")], false),
        MASTER,
        ROBOT,
        ("Robot2", "saoms.Robot", &[("chargeX", "4"), ("chargeY", "1")], true),
    ]);
    assert_eq!(two, ["error S5007 the map has no path from the start of this luggage to its destination"]);
}

#[test]
fn scenarios_of_which_nothing_comes_are_told() {
    fn with<'a>(scenario: &'a [(&'a str, &'a str)], others: &[Component<'a>]) -> Vec<String> {
        found(&[&[("Environment", "saoms.Environment", scenario, false)], others].concat())
    }
    const KEEPER: Component<'_> = ("Keeper", "saoms.MasterRobot", &[], false);
    const SLEEPER: Component<'_> = ("Robot1", "saoms.Robot", &[("asleep", "true"), ("policy", "classic")], false);
    let luggage = [("scenario", "at 1s luggage (1,0) to (4,0)")];
    let landing = [("scenario", "at 1s landing 2; at 2s luggage (1,0) to (4,0)")];
    let robot = ("Robot2", "saoms.Robot", &[][..], false);
    let sleep = "warning S5008 all robots sleep, and nothing wakes them to bring the luggage of this scenario";
    assert_eq!(
        with(&luggage, &[robot]),
        ["warning S5008 no component forwards the events of this scenario to the robots"]
    );
    assert_eq!(with(&luggage, &[MASTER]), ["warning S5008 there is no robot to bring the luggage of this scenario"]);
    assert_eq!(with(&luggage, &[MASTER, KEEPER, SLEEPER]), [sleep]);
    for empty in ["", "# later", " ;\n"] {
        let nothing = [("scenario", empty)];
        assert_eq!(with(&nothing, &[MASTER, robot]), ["warning S5008 this scenario has no events"], "{empty:?}");
    }
    assert_eq!(
        with(&[], &[MASTER, robot]),
        ["warning S5018 this environment has no scenario, so the robots never get work"]
    );
    assert_eq!(with(&landing, &[MASTER, SLEEPER]), [sleep], "nobody listens to landings");
    assert_eq!(
        with(&landing, &[MASTER, robot]),
        ["warning S5008 no component reacts to the landings and take-offs of this scenario"]
    );
    assert!(with(&landing, &[MASTER, KEEPER, SLEEPER]).is_empty());
    assert!(with(&luggage, &[MASTER, SLEEPER, robot]).is_empty());
    let safe = ("Robot2", "saoms.Robot", &[("asleep", "true")][..], false);
    assert!(with(&luggage, &[MASTER, safe]).is_empty(), "it awakes by itself");
    assert!(with(&[("scenario", "at 9s end")], &[]).is_empty());
    let broker = ("Robot1", "saoms.Robot", &[("useJMS", "true"), ("url", "tcp://localhost:61616")][..], false);
    assert_eq!(with(&luggage, &[broker])[0], with(&luggage, &[robot])[0], "a broker silences nothing");
}

#[test]
fn a_world_that_no_robot_knows_is_told() {
    let blocked: &[(&str, &str)] = &[("blocked", "(3,1)")];
    let unwired = ("Robot1", "saoms.Robot", &[][..], false);
    let message = "warning S5009 robot `Robot1` is not wired to the world, so the robots ignore its blocked blocks";
    assert_eq!(found(&[("World", "saoms.World", blocked, false), unwired]), [message]);
    let message =
        "warning S5009 robot `Robot1` is not wired to the world, so the world sees no robots and no delivered luggage";
    assert_eq!(found(&[("World", "saoms.World", &[], false), unwired]), [message]);
    assert!(found(&[("World", "saoms.World", blocked, false), ROBOT]).is_empty());
}

#[test]
fn what_is_wrong_whatever_a_faulty_component_is_comes_with_its_fault() {
    let luggage: &[(&str, &str)] = &[("scenario", "at 1s luggage (3,1) to (3,11); at 2s breakdown Robot1")];
    let environment = ("Environment", "saoms.Environment", luggage, false);
    let world = ("World", "saoms.World", &[("width", "5")][..], false);
    let low = ("Robot1", "saoms.Robot", &[("battery", "-1")][..], true);
    let outside = "error S5001 luggage cannot be at (3,11): this block is outside the map, which goes from (0,0) to \
        (4,10)";
    let battery = "error S3008 property `battery`: `-1` is out of range: expected a number from 0.0 to 100.0 [%]";
    assert_eq!(found(&[world, environment, low]), [outside, battery], "robot 1 is no unknown robot");
    let far = ("Robot2", "saoms.Robot", &[("chargeX", "7")][..], true);
    assert_eq!(
        found(&[world, low, far]),
        [battery, "error S5002 the charger of robot 2 is at (7,2), outside the map, which goes from (0,0) to (4,10)"]
    );
    let no_world = ("World", "saoms.World", &[("width", "0")][..], false);
    let width = "error S3008 property `width`: `0` is out of range: expected a whole number from 1 to 8192 [blocks]";
    assert_eq!(found(&[no_world, environment, far]), [width], "how large the area is, nobody knows");
}

#[test]
fn several_blocked_blocks_in_one_text_are_told_how_to_write_them() {
    let text = fleet(&[("World", "saoms.World", &[("blocked", "(3,1) (0,2)")], false)]);
    let shown = Fleet::of_text(text).shown();
    assert!(shown.contains("`<value>(3,1)</value><value>(0,2)</value>`"), "{shown}");
}

#[test]
fn what_a_charger_without_a_block_cuts_off_is_not_told() {
    let world = ("World", "saoms.World", &[("map", "@...\n....")][..], false);
    let environment = ("Environment", "saoms.Environment", &[("scenario", "at 1s luggage (1,0) to (3,0)")][..], false);
    let robot = ("Robot1", "saoms.Robot", &[("chargeX", "0"), ("chargeY", "0")][..], true);
    let master = ("Master", "saoms.MasterEnvironment", &[][..], false);
    assert_eq!(
        found(&[world, environment, robot, master]),
        ["error S5002 the charger of robot 1 is at (0,0), blocked on the map"]
    );
}

#[test]
fn a_world_that_is_pasted_again_is_told_once() {
    let world = ("World", "saoms.World", &[("width", "5")][..], false);
    let other = ("World", "saoms.World", &[("width", "7")][..], false);
    let robot = ("Robot1", "saoms.Robot", &[][..], true);
    assert_eq!(found(&[world, robot, other]), ["error S2002 there are two components `World`"]);
}

#[test]
fn luggage_that_is_there_already_is_told() {
    let found = with_scenario("...\n...", "at 1s luggage (2,0) to (2,0); at 1s luggage (2,0) to (0,0)..(2,0)");
    let message = "error S3014 component `Environment`: property `scenario`: found (2,0), where the luggage starts: expected another block";
    assert_eq!(found, [message]);
}

#[test]
fn a_battery_beyond_its_range_is_told_so() {
    let battery: &[(&str, &str)] = &[("battery", "101")];
    assert_eq!(
        found(&[("Robot1", "saoms.Robot", battery, false)]),
        ["error S3008 property `battery`: `101` is out of range: expected a number from 0.0 to 100.0 [%]"]
    );
}
