//! Fleets that follow their files.

use std::fs;
use std::thread::sleep;
use std::time::Duration;

use super::{LEAVES, Running, WORLD, component, fleet, other, until_logged, write};

#[test]
fn a_watched_fleet_follows_its_files() {
    let running = Running::start(&fleet(), &["--stay", "--watch"]);
    let path = running.folder().join("fleet.composite");
    let logged = |what: &str| until_logged(&running, what, 1);
    fs::write(&path, other()).unwrap();
    logged("the fleet has changed: 1 added, 1 removed, 1 replaced");
    fs::write(&path, other().replace("saoms.World", "saoms.Wrld")).unwrap();
    logged("`fleet.composite` changed: the files describe no fleet; the fleet continues as it was");
    assert_eq!(running.component("Robot3")["state"], "running");
    fs::write(&path, other()).unwrap();
    logged("`fleet.composite` changed: the fleet is the same");
    // From then on it follows the files that somebody applied.
    write(&running, &fleet());
    running.told(&["apply", "other.composite"]);
    sleep(Duration::from_millis(700));
    fs::write(&path, fleet().replace("</composite>", "")).unwrap();
    write(
        &running,
        &fleet().replace("</composite>", &format!("{}</composite>", component("Robot4", "saoms.Robot", WORLD))),
    );
    logged("the fleet has changed: 1 added\n");
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("there is no class `saoms.Wrld`"), "{text}");
    assert_eq!(text.matches("describe no fleet").count(), 1, "a file that is none of the fleet any more: {text}");
}

#[test]
fn files_that_change_again_take_back_what_is_not_made() {
    let running = Running::start(&fleet(), &["--stay", "--watch"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    running.told(&["send", "luggage (2,1) to (6,4)"]);
    running.until("Robot1", |robot| robot["values"]["job"].is_string());
    running.told(&["estop", "Robot1"]);
    let path = running.folder().join("fleet.composite");
    fs::write(&path, fleet().replace(&component("Robot1", "saoms.Robot", WORLD), "")).unwrap();
    until_logged(&running, LEAVES, 1);
    fs::write(&path, fleet()).unwrap();
    until_logged(&running, "a change of the fleet is taken back", 1);
    until_logged(&running, "`fleet.composite` changed: the fleet is the same", 1);
    running.told(&["release", "Robot1"]);
    running.until("World", |world| world["values"]["delivered"] == 1);
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
}
