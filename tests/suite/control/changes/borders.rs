//! Changes of zones, maps and robots that stay.

use serde_json::Value;

use super::{WORLD, write};
use crate::control::{Running, component, composite, fleet};
use crate::support::{code, stderr, stdout, text};

#[test]
fn maps_and_numbers_do_not_change_under_robots() {
    let fleet = |world: &str, zone: &str, robot: &str| {
        composite(
            &[
                component("World", "saoms.World", world),
                component("Master", "saoms.MasterEnvironment", ""),
                component("Zone", "saoms.Zone", &format!("{WORLD}{zone}")),
                component(robot, "saoms.Robot", WORLD),
            ]
            .concat(),
        )
    };
    let value = |name: &str, value: u32| format!("<property name=\"{name}\">{value}</property>");
    let running = Running::start(&fleet("", "", "Robot1"), &["--stay", "--invariants"]);
    running.until("Zone", |zone| zone["values"]["open"] == true);
    let zone = component("Zone", "saoms.Zone", WORLD);
    let renamed = |robot: &str| fleet("", "", robot).replace("component name=\"Zone\"", "component name=\"Hall\"");
    let robot = |properties: &str| component("Robot1", "saoms.Robot", &format!("{WORLD}{properties}"));
    let changed = |properties: &str| fleet("", "", "Robot1").replace(&robot(""), &robot(properties));
    for (text, expected) in [
        (
            fleet(&value("width", 12), "", "Robot1"),
            "error: the map of `World` changes, and robots that stay have learned",
        ),
        (
            renamed("Robot1"),
            "error: `Hall` gets the number 1 of `Zone`, by which robots know that zone: give it a number that no zone had\n",
        ),
        (
            fleet("", "", "Robot1").replace(&zone, ""),
            "error: the site loses its last zone, and robots that stay hold grants for blocks: end the run, and start",
        ),
        (
            fleet("", "", "Robot2").replace(&zone, ""),
            "error: the site loses its last zone, and robots may be left on blocks: end the run, and start",
        ),
        (changed(&value("number", 5)), "error: the number of `Robot1` changes, by which the others know it: remove"),
        (
            fleet("", "", "Rover1"),
            "error: `Rover1` joins with the number 1 of `Robot1`, which leaves: remove that one first",
        ),
    ] {
        write(&running, &text);
        for command in ["plan", "apply"] {
            let refused = running.ask(&[command, "other.composite"]);
            assert_eq!(code(&refused), 2);
            assert!(stderr(&refused).contains(expected), "{}", stderr(&refused));
        }
        let json = running.ask(&["plan", "other.composite", "--format", "json"]);
        assert_eq!(code(&json), 2);
        let json: Value = serde_json::from_str(&stdout(&json)).unwrap();
        assert_eq!(json["plan"]["refused"].as_array().map(Vec::len), Some(1), "{json}");
    }
    // What a zone grants ahead is no border: it goes on with its record.
    write(&running, &fleet("", &value("ahead", 2), "Robot1"));
    let done = running.told(&["apply", "other.composite"]);
    assert!(done.starts_with("~ Zone is replaced: keeps its state\n    ahead: 3 -> 2\n"), "{done}");
    running.until("Zone", |zone| zone["values"]["open"] == true);
    running.told(&["send", "luggage (2,1) to (4,1)"]);
    running.until("World", |world| world["values"]["delivered"] == 1);
    // A charger is no identity: the robot goes to the new one.
    write(&running, &changed(&value("chargeX", 3)));
    running.told(&["apply", "other.composite"]);
    running.told(&["send", "luggage (4,1) to (2,1)"]);
    running.until("World", |world| world["values"]["delivered"] == 2);
    running.until("Robot1", |robot| robot["values"]["block"] == serde_json::json!([3, 1]));
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn zones_get_other_borders_while_robots_drive() {
    let zones = |zones: &[(u32, u32, u32)]| {
        let zone = |&(number, x, width): &(u32, u32, u32)| {
            let values = [("number", number), ("x", x), ("width", width)];
            let values = values.map(|(name, value)| format!("<property name=\"{name}\">{value}</property>"));
            component(&format!("Zone{number}"), "saoms.Zone", &format!("{WORLD}{}", values.concat()))
        };
        let zones: String = zones.iter().map(zone).collect();
        fleet().replace("</composite>", &format!("{zones}</composite>"))
    };
    let running = Running::start(&zones(&[(1, 0, 11)]), &["--stay", "--invariants"]);
    running.until("Zone1", |zone| zone["values"]["open"] == true);
    // Robots that drive, one of them with a job, and one that stands there for good.
    running.told(&["send", "luggage (2,1) to (8,4)"]);
    running.until("Robot1", |robot| robot["values"]["job"].is_string());
    write(&running, &zones(&[(1, 0, 5), (2, 5, 6)]));
    let planned = running.ask(&["plan", "other.composite"]);
    assert_eq!(code(&planned), 3, "{}", text(&planned));
    let expected = "\
+ Zone2 (saoms.Zone)
~ Zone1 is replaced: keeps its state
    width: 11 -> 5
+ wire Zone2.world -> World.hardware
~ blocks (5,0)..(10,10): zone 1 -> zone 2
1 added, 1 replaced
";
    assert_eq!(stdout(&planned), expected);
    running.told(&["apply", "other.composite"]);
    let open = |zone: &str| running.until(zone, |zone| zone["values"]["open"] == true);
    open("Zone2");
    running.until("World", |world| world["values"]["delivered"] == 1);
    // An edge moves, while a robot drives over it.
    running.told(&["send", "luggage (8,4) to (2,1)"]);
    running.until("Robot1", |robot| robot["values"]["job"].is_string());
    write(&running, &zones(&[(1, 0, 7), (2, 7, 4)]));
    let done = running.told(&["apply", "other.composite"]);
    assert!(done.contains("~ blocks (5,0)..(6,10): zone 2 -> zone 1\n"), "{done}");
    running.until("World", |world| world["values"]["delivered"] == 2);
    running.told(&["send", "luggage (2,1) to (8,4)"]);
    running.until("Robot1", |robot| robot["values"]["job"].is_string());
    let done = running.told(&["apply", "fleet.composite"]);
    assert!(done.contains("- Zone2 (saoms.Zone)\n"), "{done}");
    running.until("World", |world| world["values"]["delivered"] == 3);
    let zone = running.until("Zone1", |zone| zone["values"]["open"] == true);
    assert_eq!(zone["failures"], 0, "{zone}");
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn zones_of_masters_keep_their_borders() {
    let site = |zones: &[(u32, u32, u32)]| {
        let value = |name: &str, value: u32| format!("<property name=\"{name}\">{value}</property>");
        let parts = zones.iter().flat_map(|&(number, x, width)| {
            let place = [value("number", number), value("x", x), value("width", width)].concat();
            [
                component(&format!("Zone{number}"), "saoms.Zone", &format!("{WORLD}{place}")),
                component(&format!("Master{number}"), "saoms.MasterEnvironment", &value("zone", number)),
            ]
        });
        let others = [component("World", "saoms.World", ""), component("Robot1", "saoms.Robot", WORLD)];
        composite(&others.into_iter().chain(parts).collect::<String>())
    };
    let running = Running::start(&site(&[(1, 0, 5), (2, 5, 6)]), &["--stay"]);
    write(&running, &site(&[(1, 0, 6), (2, 6, 5)]));
    for command in ["plan", "apply"] {
        let refused = running.refused(&[command, "other.composite"]);
        let expected = "error: zones get other borders, but `Master1` assigns the luggage of zone 1, and others that of \
                        other zones: what is requested meanwhile might be assigned twice: end the run, and start it";
        assert!(refused.contains(expected), "{refused}");
    }
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}
