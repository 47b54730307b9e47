//! `saoms replay --component`: one component runs again alone, on what it got then.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use saoms_core::replay::Replay;
use saoms_core::tape::StepKind;
use saoms_lang::registry::Registry;
use saoms_recording::{Part, Reader};
use serde_json::Value;

use crate::support::{code, empty_folder, root, saoms_in, stderr, stdout, text};

fn composite(name: &str) -> String {
    root().join("composites").join(name).display().to_string()
}

/// The components of a recording, each with the kinds of its steps: each does what it did.
fn all_replayed(recording: &Path) -> BTreeMap<String, Vec<StepKind>> {
    let mut reader = Reader::open(recording).unwrap();
    let mut replays: BTreeMap<String, (Replay, Vec<StepKind>)> = BTreeMap::new();
    while let Some(part) = reader.next_part().unwrap() {
        let Part::Message(message) = part else { continue };
        let Some(component) = message.channel.taped_component() else { continue };
        let new = || (Replay::new(component, Registry::linked().unwrap()), Vec::new());
        let (replay, kinds) = replays.entry(component.to_owned()).or_insert_with(new);
        let step = message.step().unwrap();
        assert_eq!(replay.step(&step), None, "{component}");
        kinds.push(step.kind);
    }
    let replays = replays.into_iter().map(|(component, (replay, kinds))| {
        let counts = replay.counts();
        assert_eq!((counts.replayed, &counts.ends[..]), (kinds.len() as u64, &[][..]), "{component}");
        (component, kinds)
    });
    replays.collect()
}

const OF_AIRPORT: &str = "Robot001,Robot002,Robot003,MasterRobot,MasterEnvironment,Environment,World,Zone";

#[test]
fn each_component_of_shipped_fleets_does_what_it_did() {
    let folder = empty_folder("replaying");
    let faults = root().join("composites/storm.txt").display().to_string();
    fs::write(
        folder.join("orders.txt"),
        "at 12s set Robot6 stopped=true\nat 14s set Robot6 stopped=false\nat 15s stop Robot5\nat 20s start Robot5\n",
    )
    .unwrap();
    let of_storm = "World,West,East,MasterEnvironment,MasterRobot,Environment,Robot1,Robot3,Robot5,Robot6";
    let more = ["--faults", &faults, "--events", "orders.txt", "--for", "1min"];
    for (fleet, components, more, count) in
        [("airport.composite", OF_AIRPORT, &[][..], 8), ("storm.composite", of_storm, &more[..], 10)]
    {
        let file = composite(fleet);
        let run = ["run", &file, "--virtual", "--quiet", "--record", "r.mcap", "--record-component", components];
        let output = saoms_in(&folder, &[&run[..], more].concat());
        assert!(code(&output) < 2, "{}", text(&output));
        let replayed = all_replayed(&folder.join("r.mcap"));
        assert_eq!(replayed.len(), count, "{:?}", replayed.keys());
        if fleet.starts_with("storm") {
            let has = |component: &str, kind| replayed[component].contains(&kind);
            assert!(has("Robot6", StepKind::Update) && has("World", StepKind::Serve));
            let starts = |component: &str| replayed[component].iter().filter(|kind| **kind == StepKind::Start).count();
            assert_eq!((starts("MasterEnvironment"), starts("West"), starts("Robot5")), (2, 2, 2));
        }
    }
}

#[test]
fn a_replay_says_what_is_the_same_and_what_is_not() {
    let folder = empty_folder("replaying-says");
    let airport = composite("airport.composite");
    let run = ["run", &airport, "--virtual", "--quiet", "--record", "r.mcap", "--record-component"];
    let output = saoms_in(&folder, &[&run[..], &["Robot03"]].concat());
    assert_eq!(code(&output), 2, "{}", text(&output));
    assert!(stderr(&output).contains("the fleet has no component `Robot03`; did you mean `Robot003`?"));
    assert_eq!(code(&saoms_in(&folder, &[&run[..], &["Robot003"]].concat())), 0);

    let replay = ["replay", "r.mcap", "--component"];
    let same = saoms_in(&folder, &[&replay[..], &["Robot003"]].concat());
    assert_eq!(code(&same), 0, "{}", text(&same));
    assert!(stdout(&same).ends_with(": it does what it did then\n"), "{}", text(&same));
    let none = saoms_in(&folder, &[&replay[..], &["Robot004"]].concat());
    assert_eq!(code(&none), 2, "{}", text(&none));
    assert!(stderr(&none).contains("no tape of `Robot004`\n  = help: did you mean `Robot003`?"), "{}", text(&none));

    // The same robot with less in its battery.
    let changed = fs::read_to_string(&airport).unwrap();
    let place = changed.find("<component name=\"Robot003\">").unwrap();
    let end = changed[place..].find("</component>").unwrap() + place;
    let changed = format!("{}<property name=\"battery\">20</property>{}", &changed[..end], &changed[end..]);
    fs::write(folder.join("changed.composite"), changed).unwrap();
    let other = [&replay[..], &["Robot003", "--composite", "changed.composite"]].concat();
    let differs = saoms_in(&folder, &other);
    assert_eq!(code(&differs), 1, "{}", text(&differs));
    assert!(stdout(&differs).starts_with("Robot003 does something else at "), "{}", text(&differs));
    let json = saoms_in(&folder, &[&other[..], &["--format", "json"]].concat());
    let json: Value = serde_json::from_str(&stdout(&json)).unwrap();
    assert!(json["differing"].as_u64().unwrap() > 0 && json["replayed"] == json["steps"], "{json}");
    assert!(json["first"]["lines"].as_array().unwrap().iter().any(|line| line["when"] == "now"), "{json}");
}
