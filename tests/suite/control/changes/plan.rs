//! Plans, and what cannot be changed.

use std::fs;

use serde_json::{Value, json};

use super::{Running, fleet, other, write};
use crate::support::{code, stderr, stdout, text};

#[test]
fn a_plan_shows_what_would_change_and_changes_nothing() {
    let running = Running::start(&fleet(), &["--stay"]);
    assert_eq!(running.told(&["plan", "fleet.composite"]), "nothing to do\n");
    write(&running, &other());
    for _ in 0..2 {
        let planned = running.ask(&["plan", "other.composite"]);
        assert_eq!(code(&planned), 3, "{}", text(&planned));
        let expected = "\
+ Robot3 (saoms.Robot)
- Robot2 (saoms.Robot)
~ Master is replaced: keeps its state
    period: 50ms -> 100ms
+ wire Robot3.world -> World.hardware
- wire Robot2.world -> World.hardware
1 added, 1 removed, 1 replaced
";
        assert_eq!(stdout(&planned), expected);
    }
    let json = running.ask(&["plan", "other.composite", "--format", "json"]);
    assert_eq!(code(&json), 3);
    let json: Value = serde_json::from_str(&stdout(&json)).unwrap();
    assert_eq!(json["plan"]["added"][0]["component"], "Robot3");
    assert_eq!(json["plan"]["replaced"][0]["state"], "kept");
    assert!(json["diagnostics"].is_array() && json.get("applied").is_none() && json.get("text").is_none(), "{json}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn a_plan_shows_topics_that_come_and_go() {
    let renamed = |to: &str| {
        let gauge = |name: &str, more: &str| super::component(name, "bad.Actor", more);
        let rename = format!("<property name=\"topicRename\">WORDS,{to}</property>");
        super::composite(&[gauge("One", &rename), gauge("Two", &rename), gauge("Still", "")].concat())
    };
    let plugin = crate::boundary::build::library("bad");
    let running = Running::start(&renamed("NEWS"), &["--stay", "--plugin", plugin.to_str().unwrap()]);
    write(&running, &renamed("RUMOURS"));
    let planned = running.ask(&["plan", "other.composite"]);
    assert_eq!(code(&planned), 3, "{}", text(&planned));
    let expected = "\
~ One is replaced: loses its state
    topicRename: WORDS,NEWS -> WORDS,RUMOURS
~ Two is replaced: loses its state
    topicRename: WORDS,NEWS -> WORDS,RUMOURS
+ topic RUMOURS
- topic NEWS
2 replaced
";
    assert_eq!(stdout(&planned), expected);
    let json = running.ask(&["plan", "other.composite", "--format", "json"]);
    let json: Value = serde_json::from_str(&stdout(&json)).unwrap();
    let [added, removed] = ["topics_added", "topics_removed"].map(|key| json["plan"][key].clone());
    assert_eq!((added, removed), (json!(["RUMOURS"]), json!(["NEWS"])), "{json}");
    // One that another component still uses stays.
    write(&running, &renamed("NEWS").replacen("WORDS,NEWS", "WORDS,RUMOURS", 1));
    let planned = stdout(&running.ask(&["plan", "other.composite"]));
    assert!(planned.contains("+ topic RUMOURS\n") && !planned.contains("- topic"), "{planned}");
    running.told(&["apply", "other.composite", "--allow-loss"]);
    assert_eq!(running.told(&["plan", "other.composite"]), "nothing to do\n");
    running.told(&["down"]);
    running.end();
}

#[test]
fn wrong_files_are_told_as_check_tells_them_and_change_nothing() {
    let running = Running::start(&fleet(), &["--stay"]);
    write(&running, &other().replace("saoms.MasterEnvironment", "saoms.MasterEnvironmnt"));
    let checked = running.ask(&["check", "other.composite"]);
    for command in ["plan", "apply"] {
        let refused = running.ask(&[command, "other.composite"]);
        assert_eq!(code(&refused), 2, "{}", text(&refused));
        assert_eq!(stdout(&refused), "");
        let told = stderr(&refused);
        assert!(told.starts_with(&stderr(&checked)), "{told}\n{}", stderr(&checked));
        assert!(told.ends_with("error: the files describe no fleet\n\nnothing has changed\n"), "{told}");
    }
    // Also from another folder, with the paths of that.
    fs::create_dir(running.folder().join("beside")).unwrap();
    let mut command = crate::support::command(&["plan", "../other.composite"]);
    command.current_dir(running.folder().join("beside")).env("XDG_RUNTIME_DIR", running.folder());
    let refused = command.output().unwrap();
    assert!(stderr(&refused).contains("--> ../other.composite:"), "{}", stderr(&refused));
    // What the file says of that folder is none of its paths.
    let beside = format!("{}/", running.folder().join("beside").display());
    write(&running, &other().replace("saoms.MasterEnvironment", &beside));
    let refused = command.output().unwrap();
    let told = stderr(&refused);
    assert!(told.contains("--> ../other.composite:") && told.contains(&format!("class `{beside}`")), "{told}");
    let missing = running.refused(&["plan", "missing.composite"]);
    assert!(missing.contains("missing.composite"), "{missing}");
    let input = running.refused(&["plan", "-"]);
    assert!(input.contains("standard input"), "{input}");
    assert_eq!(running.told(&["plan", "fleet.composite"]), "nothing to do\n");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}
