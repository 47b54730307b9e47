//! `saoms run --paths`: what is in the picture, read from its SVG.

mod picture;

use std::fmt::Write;
use std::fs;

use roxmltree::Document;

use picture::{Block, Picture};

use crate::support::{empty_folder, project, saoms};

/// More time than any run here needs: one that does not end by itself ends then.
const ENOUGH: &str = "5min";

/// The picture of a run in virtual time, which must not fail.
fn drawn(composite: &str, limit: &str) -> String {
    drawn_after(composite, limit, 0)
}

/// The picture of a run with this exit code.
fn drawn_after(composite: &str, limit: &str, code: i32) -> String {
    let output = saoms(&["run", composite, "--virtual", "--for", limit, "--quiet", "--paths", "-"]);
    assert_eq!(output.status.code(), Some(code), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Robots with chargers in the columns 0 and `width` - 1, and luggage that sends each of them right across.
fn crowd(test: &str, robots: u32, (width, height): (u32, u32), robot: &str) -> String {
    let component = |name: &str, class: &str, more: &str| {
        format!(
            "<component name=\"{name}\"><implementation.rust class=\"{class}\"/><property name=\"ID\">{name}</property>\
             <property name=\"period\">100</property>{more}</component>\n"
        )
    };
    let mut scenario = String::new();
    let mut text = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"crowd\" targetNamespace=\"urn:crowd\">\n"
        .to_owned();
    let blocked = (2..height - 2).map(|y| format!("<value>({},{y})</value>", width / 2)).collect::<String>();
    let size = format!(
        "<property name=\"width\">{width}</property><property name=\"height\">{height}</property>\
         <property name=\"blocked\" many=\"true\">{blocked}</property>"
    );
    text += &component("World", "saoms.World", &size);
    for place in 0..robots {
        let (x, y) = (place / height * (width - 1), place % height);
        let (from, to) = ((2 + place % 3, (y + 5) % height), (width - 3 - place % 2, height - 1 - y));
        writeln!(scenario, "at 1s luggage ({},{}) to ({},{})", from.0, from.1, to.0, to.1).unwrap();
        let more = format!(
            "<property name=\"chargeX\">{x}</property><property name=\"chargeY\">{y}</property>\
             <property name=\"discharge\">0.2</property>{robot}<reference name=\"world\" target=\"World\"/>"
        );
        text += &component(&format!("Robot{}", place + 1), "saoms.Robot", &more);
    }
    let scenario = format!("<property name=\"scenario\">{scenario}</property>");
    text += &component("Environment", "saoms.Environment", &scenario);
    text += &component("Master", "saoms.MasterEnvironment", "");
    text += "</composite>\n";
    let path = empty_folder(&format!("paths/{test}")).join("crowd.composite");
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

/// The blocks that a robot says on the console that it is on and goes to.
fn said(console: &str, robot: &str) -> Vec<Block> {
    let block = |text: &str| {
        let (x, y) = text.split_once(')').unwrap().0.trim_start_matches('(').split_once(',').unwrap();
        (x.parse().unwrap(), y.parse().unwrap())
    };
    let mut blocks: Vec<Block> = Vec::new();
    for line in console.lines() {
        let Some(rest) = line.strip_prefix(&format!("{robot} says: My position now is: ")) else { continue };
        let (now, next) = rest.split_once(" and my next position will be: ").unwrap();
        for block in [block(now), block(next)] {
            if blocks.last() != Some(&block) {
                blocks.push(block);
            }
        }
    }
    blocks
}

#[test]
fn a_line_leads_through_the_blocks_that_the_robot_was_on_and_no_others() {
    for composite in ["composites/scenario1.composite", "composites/scenario2.composite"] {
        let text = drawn(composite, ENOUGH);
        let document = Document::parse(&text).unwrap();
        let picture = Picture::of(&document);
        let console = saoms(&["run", composite, "--virtual", "--for", ENOUGH, "--console", "classic"]);
        let console = String::from_utf8(console.stdout).unwrap();
        let robots = picture.all("robot");
        assert!(!robots.is_empty());
        for robot in robots {
            let name = robot.attribute("data-robot").unwrap();
            let (way, mut said) = (picture.way(name), said(&console, name));
            // Where the run ended before it went there, it only said so.
            said.truncate(way.len().max(said.len() - 1));
            assert_eq!(way, said, "{composite}: {name}");
        }
        picture.assert_readable();
    }
}

#[test]
fn the_second_scenario_shows_what_the_manual_tells_of_it() {
    let text = drawn("composites/scenario2.composite", ENOUGH);
    let document = Document::parse(&text).unwrap();
    let picture = Picture::of(&document);
    let texts: Vec<String> = picture.labels().into_iter().map(|label| label.text).collect();
    for text in ["scenario2", "Robot001", "Robot002", "charger", "collision"] {
        assert!(texts.iter().any(|shown| shown == text), "no `{text}` in {texts:?}");
    }
    assert!(texts.iter().any(|text| text.contains("4 of 4 pieces of luggage delivered, 1 collision")));
    // One in the area, one in the legend.
    let collisions = picture.all("collision");
    let [collision, _] = collisions[..] else { panic!("{collisions:?}") };
    let sign = collision.children().find(|node| node.has_tag_name("text")).unwrap();
    let at = |name: &str| sign.attribute(name).unwrap().parse::<f64>().unwrap();
    assert_eq!(picture.block(at("x"), at("y") - 5.0), (3, 5));
    assert_eq!(picture.all("collect").len(), 3 + 1, "(3,1) twice, (1,5), (10,8), and the legend");
    assert_eq!(picture.all("deliver").len(), 3 + 1);
    assert_eq!(picture.all("wait").len(), 0);
}

#[test]
fn a_fleet_without_a_world_is_drawn_on_the_area_that_it_used() {
    let airport = project("composites/hall.composite");
    let (before, after) = airport.split_once("  <component name=\"World\">").unwrap();
    let (_, after) = after.split_once("</component>\n").unwrap();
    let composite = format!("{before}{after}").replace("<reference name=\"world\" target=\"World\"/>", "");
    let path = empty_folder("paths/no_world").join("hall.composite");
    fs::write(&path, composite).unwrap();
    let text = drawn(path.to_str().unwrap(), ENOUGH);
    let document = Document::parse(&text).unwrap();
    let picture = Picture::of(&document);
    let way = picture.way("Robot7");
    assert_eq!((way.first(), way.contains(&(3, 1))), (Some(&(0, 7)), true), "{way:?}");
    // From (0,0) to the furthest block that somebody was on or spoke of.
    let area = picture.all("area")[0];
    let side = |name: &str| area.attribute(name).unwrap().parse::<f64>().unwrap();
    assert_eq!(picture.block(side("x") + side("width") - 1.0, side("y") + side("height") - 1.0), (3, 10));
    picture.assert_readable();
}

#[test]
fn ten_robots_are_told_apart_by_colour_and_dash() {
    let text = drawn(&crowd("ten", 10, (13, 10), ""), ENOUGH);
    let document = Document::parse(&text).unwrap();
    let picture = Picture::of(&document);
    let paths = picture.all("path");
    let looks: std::collections::BTreeSet<_> =
        paths.iter().map(|path| (path.attribute("stroke"), path.attribute("stroke-dasharray"))).collect();
    assert_eq!((paths.len(), looks.len()), (10, 10));
    assert_eq!((picture.all("start").len(), picture.all("end").len()), (10 + 10, 10), "and in the legend");
    picture.assert_readable();
}

#[test]
fn a_hundred_robots_shade_the_blocks_that_they_entered() {
    let text = drawn(&crowd("hundred", 68, (102, 34), ""), "20s");
    let document = Document::parse(&text).unwrap();
    let picture = Picture::of(&document);
    assert_eq!((picture.all("robot").len(), picture.all("density").len()), (0, 1));
    let texts: Vec<String> = picture.labels().into_iter().map(|label| label.text).collect();
    assert!(texts.iter().any(|text| text == "How often a block was entered"), "{texts:?}");
    assert!(texts.iter().any(|text| text.starts_with("Robot68: ")), "{texts:?}");
    assert!(text.len() < 400_000, "{} bytes", text.len());
    picture.assert_readable();
}

#[test]
fn a_robot_that_stands_with_an_empty_battery_is_marked() {
    let robot = "<property name=\"battery\">1</property>";
    let composite = crowd("empty", 1, (13, 10), robot).clone();
    let text = fs::read_to_string(&composite).unwrap();
    fs::write(
        &composite,
        text.replace("\"saoms.Robot\"/>", "\"saoms.Robot\"/><property name=\"policy\">classic</property>"),
    )
    .unwrap();
    let text = drawn(&composite, "3s");
    let document = Document::parse(&text).unwrap();
    let picture = Picture::of(&document);
    assert_eq!(picture.all("stranded").len(), 1 + 1, "and in the legend");
    assert_eq!(picture.all("wait").len(), 1 + 1, "its luggage is not delivered");
}

/// One robot, and this scenario.
fn alone(test: &str, scenario: &str, code: i32) -> String {
    let composite = crowd(test, 1, (13, 10), "");
    let text = fs::read_to_string(&composite).unwrap();
    let (before, rest) = text.split_once("at 1s luggage").unwrap();
    let rest = rest.split_once("</property>").unwrap().1;
    fs::write(&composite, format!("{before}{scenario}</property>{rest}")).unwrap();
    drawn_after(&composite, ENOUGH, code)
}

#[test]
fn a_master_that_gives_luggage_up_is_no_robot() {
    let text = alone("given-up", "at 1s luggage (2,5) to (10,9); at 2s breakdown 1", 1);
    assert!(text.contains(">Robot1<") && !text.contains(">Master<"));
    let document = Document::parse(&text).unwrap();
    assert_eq!(Picture::of(&document).all("wait").len(), 1 + 1, "its luggage, and the legend");
}

#[test]
fn a_robot_that_breaks_down_twice_is_marked_as_one() {
    let once = alone("broken-once", "at 2s breakdown 1; at 5s end", 0);
    let twice = alone("broken-twice", "at 2s breakdown 1; at 3s breakdown 1; at 5s end", 0);
    assert_eq!(once.replace("broken-once", ""), twice.replace("broken-twice", ""));
}

#[test]
fn what_does_not_fit_into_the_legend_is_said_in_fewer_words() {
    let text = alone("many", "from 1s every 100ms 5 times luggage (2,5) to (10,9)", 0);
    assert!(text.contains(">delivered 5 pieces \u{b7} ") && !text.contains('\u{2026}'));
}

#[test]
fn a_place_that_cannot_be_written_is_told_before_anything_starts() {
    let output = saoms(&["run", "composites/hall.composite", "--virtual", "--paths", "/no/such/folder/a.svg"]);
    let told = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(told.starts_with("error: the picture cannot be written to `/no/such/folder/a.svg`: "), "{told}");
    assert!(told.ends_with("1 error: nothing was started\n") && output.stdout.is_empty(), "{told}");
    let output = saoms(&["run", "composites/hall.composite", "--paths", "-", "--report", "-"]);
    assert_eq!(output.status.code(), Some(2));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("the report and the picture cannot both be written to `-`"), "{told}");
}

#[test]
fn a_file_with_the_ending_of_another_kind_of_picture_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = |file: &str| {
        let path = folder.path().join(file);
        let fleet = "composites/hall.composite";
        let output = saoms(&["run", fleet, "--virtual", "--for", "1s", "--quiet", "--paths", path.to_str().unwrap()]);
        let told = String::from_utf8(output.stderr).unwrap().replace(folder.path().to_str().unwrap(), "");
        (output.status.code(), told, path.exists())
    };
    for ending in ["png", "PNG", "jpeg", "pdf", "svgz"] {
        let told = format!(
            "error: the picture of `--paths` is in SVG, but `/a.{ending}` ends with `.{ending}`\n  = help: write \
            `/a.svg`\n\n1 error: nothing was started\n"
        );
        assert_eq!(run(&format!("a.{ending}")), (Some(2), told, false));
    }
    for file in ["a.svg", "a.SVG", "a", "a.xml"] {
        assert_eq!(run(file), (Some(0), String::new(), true), "{file}");
    }
}

#[test]
fn a_fleet_without_robots_says_that_there_is_nothing_to_draw() {
    let text = drawn("composites/manual/launchbroker.composite", "1s");
    let document = Document::parse(&text).unwrap();
    let shown = document.descendants().filter_map(|node| node.text()).collect::<String>();
    assert!(shown.contains("no robot said where it is"), "{shown}");
}

/// Write it anew with the command that stands in the README.
#[test]
fn the_picture_of_the_readme_is_real() {
    let text = drawn("composites/scenario2.composite", ENOUGH);
    let kept = project("docs/scenario2.svg");
    assert!(text == kept, "docs/scenario2.svg is not what the command draws: run it again");
    let readme = project("README.md");
    assert!(readme.contains("saoms run composites/scenario2.composite --virtual --paths docs/scenario2.svg"));
    assert!(readme.contains("(docs/scenario2.svg)"));
}

/// Two halls with a robot each, which have topics of their own.
fn two_halls() -> String {
    let mut text =
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"halls\" targetNamespace=\"urn:h\">\n"
            .to_owned();
    for (hall, (width, height), number, scenario) in [
        ("North", (8, 4), 1, "at 1s luggage (3,1) to (6,3); at 2s luggage (1,1) to (5,2)"),
        ("South", (6, 9), 2, "at 1s luggage (2,7) to (5,8); at 5s breakdown 2; at 6s luggage (1,1) to (2,2)"),
    ] {
        let world = format!("<property name=\"width\">{width}</property><property name=\"height\">{height}</property>");
        let robot =
            format!("<property name=\"number\">{number}</property><reference name=\"world\" target=\"World{hall}\"/>");
        let scenario = format!("<property name=\"scenario\">{scenario}</property>");
        let topics = |topics: &[&str]| {
            let pairs: Vec<String> = topics.iter().map(|topic| format!("{topic},{topic}-{hall}")).collect();
            format!("<property name=\"topicRename\">{}</property>", pairs.join("::"))
        };
        let events = ["ETOPIC", "ELMSTOPIC", "RLMSTOPIC", "AREATOPIC"];
        for (name, class, more, topics) in [
            ("World", "World", world, topics(&["AREATOPIC", "ETOPIC", "ELMSTOPIC", "RLMSTOPIC"])),
            ("Environment", "Environment", scenario, topics(&events)),
            ("Master", "MasterEnvironment", String::new(), topics(&[&events[..], &["FAULTTOPIC"]].concat())),
            ("Robot", "Robot", robot, topics(&["ELMSTOPIC", "RLMSTOPIC", "POSTOPIC", "FAULTTOPIC"])),
        ] {
            writeln!(
                text,
                "<component name=\"{name}{hall}\"><implementation.rust class=\"saoms.{class}\"/>\
                 <property name=\"ID\">{name}{hall}</property><property name=\"period\">100</property>{more}{topics}</component>"
            )
            .unwrap();
        }
    }
    let path = empty_folder("paths/two-halls").join("halls.composite");
    fs::write(&path, text + "</composite>\n").unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn two_worlds_are_two_panels_with_their_names() {
    let fleet = two_halls();
    let folder = std::path::Path::new(&fleet).parent().unwrap();
    let report = folder.join("report.json");
    let run = ["run", &fleet, "--virtual", "--quiet", "--paths", "-", "--report", report.to_str().unwrap()];
    let output = saoms(&run);
    // Nobody is left in the south.
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let svg = String::from_utf8(output.stdout).unwrap();
    let document = Document::parse(&svg).unwrap();
    let worlds: Vec<_> = document.descendants().filter(|node| node.attribute("class") == Some("world")).collect();
    let names: Vec<_> = worlds.iter().map(|world| world.attribute("data-world").unwrap()).collect();
    assert_eq!(names, ["WorldNorth", "WorldSouth"]);
    let top = |world: &roxmltree::Node<'_, '_>, name| world.attribute(name).unwrap().parse::<f64>().unwrap();
    assert!(top(&worlds[1], "y") >= top(&worlds[0], "y") + top(&worlds[0], "height"));
    for (world, robot, waiting) in [(worlds[0], "RobotNorth", false), (worlds[1], "RobotSouth", true)] {
        let of = |class: &'static str| world.descendants().filter(move |node| node.attribute("class") == Some(class));
        let robots: Vec<_> = of("robot").map(|one| one.attribute("data-robot").unwrap()).collect();
        assert_eq!((of("title").next().unwrap().text(), &robots[..]), (world.attribute("data-world"), &[robot][..]));
        assert_eq!(of("wait").next().is_some(), waiting, "{robot}");
    }
    let report: serde_json::Value = serde_json::from_slice(&fs::read(report).unwrap()).unwrap();
    assert_eq!(
        report["worlds"],
        serde_json::json!({
            "WorldNorth": {"robots": 1, "delivered": 2, "open": 0, "given_up": 0, "collisions": 0},
            "WorldSouth": {"robots": 1, "delivered": 1, "open": 1, "given_up": 1, "collisions": 0},
        })
    );
}
