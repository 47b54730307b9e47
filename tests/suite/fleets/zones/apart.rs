//! Sites with several zones: what each of them hears, and what it knows of the others.

use std::time::Duration;

use saoms_testkit::{Fleet, Run};

const PERIOD: u32 = 100;

pub(super) fn component(name: &str, class: &str, properties: &[(&str, String)]) -> String {
    let given = [("ID", name.to_owned()), ("period", PERIOD.to_string())];
    let properties: String = given
        .iter()
        .chain(properties)
        .map(|(name, value)| format!(r#"<property name="{name}">{value}</property>"#))
        .collect();
    let wire = if matches!(class, "Zone" | "Robot") { r#"<reference name="world" target="World"/>"# } else { "" };
    format!(r#"<component name="{name}"><implementation.rust class="saoms.{class}"/>{properties}{wire}</component>"#)
}

/// Zones beside each other, each with as many columns.
pub(super) fn zones(count: u32, columns: u32) -> String {
    let zone = |number: u32| {
        let properties = [("number", number), ("x", (number - 1) * columns), ("width", columns)];
        component(&format!("Zone{number}"), "Zone", &properties.map(|(name, value)| (name, value.to_string())))
    };
    (1..=count).map(zone).collect()
}

pub(super) fn robot(number: u32, x: u32, y: u32) -> String {
    let properties = [("chargeX", x), ("chargeY", y), ("discharge", 0)];
    component(&format!("Robot{number}"), "Robot", &properties.map(|(name, value)| (name, value.to_string())))
}

pub(super) fn site(world: &[(&str, String)], zones: &str, robots: &str, scenario: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="site" targetNamespace="urn:site">
        {}{zones}{}{}{robots}</composite>"#,
        component("World", "World", world),
        component("Master", "MasterEnvironment", &[]),
        component("Environment", "Environment", &[("scenario", scenario.to_owned())]),
    ))
}

pub(super) fn delivered(run: &Run) -> u64 {
    run.sections["luggage"]["delivered"].as_u64().unwrap_or(0)
}

/// One robot in each zone, with work in it.
fn row(count: u32) -> Run {
    let world = [("width", (6 * count).to_string()), ("height", "4".to_owned())];
    let robots: String = (0..count).map(|number| robot(number + 1, 6 * number, 0)).collect();
    let line = |number: u32| {
        let x = 6 * number;
        format!("from 1s every 20s 3 times luggage ({},1) to ({},3)\n", x + 2, x + 3)
    };
    let scenario: String = (0..count).map(line).collect();
    site(&world, &zones(count, 6), &robots, &scenario).run(1, Duration::from_secs(300))
}

#[test]
fn what_a_zone_hears_does_not_grow_with_the_site() {
    let heard = |count: u32| {
        let run = row(count);
        assert_eq!(delivered(&run), u64::from(3 * count), "{count} zones: {}", run.log());
        let zones = run.components.iter().filter(|one| one.name.starts_with("Zone"));
        zones.map(|zone| zone.messages.received).max().unwrap_or(0)
    };
    let (few, many) = (heard(3), heard(12));
    // Each robot of the other nine zones says where it is when it starts, and repeats it after 50, 100, 200 and 400 of
    // the 600 executions.
    assert!(many <= few + 5 * 9, "a zone hears {few} messages in a site of 3 zones, and {many} in one of 12");
}

/// Robots of a site with zones enter the floor once a zone has answered: before that they hear around themselves, too.
#[test]
fn what_a_robot_hears_does_not_grow_with_the_site() {
    let heard = |count: u32| {
        let world = [("width", (6 * count).to_string()), ("height", "60".to_owned())];
        let robots: String = (0..count).map(|number| robot(number + 1, 6 * number, 0)).collect();
        let run =
            site(&world, &zones(1, 6 * count), &robots, "at 1s luggage (1,1) to (3,1)").run(1, Duration::from_secs(9));
        assert_eq!(delivered(&run), 1, "{count} robots: {}", run.log());
        let robots = run.components.iter().filter(|one| one.name.starts_with("Robot"));
        robots.map(|robot| robot.messages.received).max().unwrap_or(0)
    };
    let (few, many) = (heard(20), heard(80));
    assert!(many <= few + 5, "a robot hears {few} messages among 20 robots, and {many} among 80");
}

/// Two ways lead from the first zone through the second one. The shorter one is closed by a robot that broke there: the
/// first zone has to know it, since robots choose their way before the border.
#[test]
fn robots_drive_around_one_that_broke_in_another_zone() {
    let map = "
        ............
        .@@@@@@@@@@.
        .@@@@@@@@@@.
        ............
    ";
    let world = [("map", map.to_owned())];
    let start = [("chargeX", 11), ("chargeY", 1), ("startX", 8), ("startY", 0), ("discharge", 0)];
    let start = start.map(|(name, value)| (name, value.to_string()));
    let robots = robot(1, 0, 1) + &component("Robot2", "Robot", &start);
    let scenario = "at 100ms breakdown Robot2\nat 10s luggage (0,0) to (11,0)";
    let run = site(&world, &zones(2, 6), &robots, scenario).run(1, Duration::from_secs(300));
    assert_eq!(delivered(&run), 1, "{}", run.log());
}
