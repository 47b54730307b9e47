//! Messages that an operator sends by hand.

use serde_json::{Value, json};

use super::{Running, component, composite};

/// A world, both masters, an awake robot and a sleeping one.
fn fleet() -> String {
    let world = "<reference name=\"world\" target=\"World\"/>";
    composite(
        &[
            component("World", "saoms.World", ""),
            component("Master", "saoms.MasterEnvironment", ""),
            component("MasterRobot", "saoms.MasterRobot", ""),
            component("Robot1", "saoms.Robot", world),
            component("Robot2", "saoms.Robot", &format!("{world}<property name=\"asleep\">true</property>")),
        ]
        .concat(),
    )
}

fn block(x: i32, y: i32) -> Value {
    json!({"x": x, "y": y})
}

fn publish(running: &Running, topic: &str, message: &Value) {
    assert_eq!(running.told(&["topic", "pub", topic, &message.to_string()]), "published\n", "{topic}");
}

fn state<'s>(state: &'s str) -> impl Fn(&Value) -> bool + use<'s> {
    move |robot| robot["values"]["state"] == state
}

#[test]
fn every_message_of_the_manual_is_sent_by_hand() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", state("free"));
    running.until("MasterRobot", |master| master["values"]["robots"] == 2 && master["values"]["asleep"] == 1);

    let request = |luggage: u32, from: Value, to: Value| json!({"robot": 0, "luggage": luggage, "stage": "REQUEST", "from": from, "to": to, "block": block(0, 0)});
    let event = json!({"luggage": [request(71, block(2, 1), block(3, 1))], "exceptional": [], "faults": []});
    publish(&running, "ETOPIC", &event);
    running.until("World", |world| world["values"]["delivered"] == 1);

    publish(&running, "ELMSTOPIC", &request(72, block(4, 4), block(5, 5)));
    running.until("Robot1", |robot| robot["values"]["job"] == "luggage 72 from (4,4) to (5,5)");
    // No world knows of it, so that the robot gives it up.
    running.until("Robot1", |robot| robot["values"]["job"].is_null());

    publish(&running, "EETOPIC", &json!({"kind": "LANDING", "pieces": 2}));
    running.until("MasterRobot", |master| master["values"]["on_shift"] == 1 && master["values"]["asleep"] == 0);
    publish(&running, "RMSTOPIC", &json!({"robot": 2, "awake": false, "emulate": 0}));
    running.until("MasterRobot", |master| master["values"]["asleep"] == 1);

    // A robot that is none of the fleet.
    let robot = json!({"robot": 70, "active": true, "battery": 50.0, "in_charge": false, "asleep": false,
        "charger": block(0, 10), "period": 50_000, "block": block(6, 6), "policy": "SAFE"});
    publish(&running, "RLMSTOPIC", &robot);
    running.until("MasterRobot", |master| master["values"]["robots"] == 3);
    let position = json!({"robot": 70, "block": block(6, 6), "next": block(6, 6), "wanted": block(6, 6),
        "priority": {"rank": 0, "robot": 70}});
    publish(&running, "POSTOPIC", &position);
    running.told(&["send", "luggage (6,6) to (8,8)"]);
    let robot = running.until("Robot1", |robot| robot["values"]["waits_for_robot"] == 70);
    let told = ["waits_at", "goes_first", "because"].map(|name| robot["values"][name].clone());
    assert_eq!(told, [json!([6, 6]), json!(70), json!("it is there")]);
    let aside = json!({"robot": 70, "block": block(6, 7), "next": block(6, 7), "wanted": block(6, 7),
        "priority": {"rank": 0, "robot": 70}});
    publish(&running, "POSTOPIC", &aside);
    running.until("World", |world| world["values"]["delivered"] == 2);
    let help = json!({"critical": 70, "block": block(3, 3), "luggage": 73, "from": block(2, 2), "to": block(1, 1),
        "kind": "CARRIES_LUGGAGE", "stage": "REQUEST", "healer": 0, "healer_block": block(0, 0)});
    publish(&running, "CSMSTOPIC", &help);
    // Its job may be over before anybody looks.
    running.until("Robot1", |robot| robot["values"]["delivered"] == 3);

    publish(&running, "FAULTTOPIC", &json!({"robot": 1, "kind": "BREAKDOWN"}));
    running.until("Robot1", state("broken"));
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn nobody_speaks_in_the_name_of_a_robot() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", state("free"));
    let robot = json!({"robot": 1, "active": false, "battery": 50.0, "in_charge": false, "asleep": false,
        "charger": block(0, 1), "period": 50_000, "block": block(0, 1), "policy": "SAFE"});
    let position = json!({"robot": 2, "block": block(6, 6), "next": block(6, 6), "wanted": block(6, 6),
        "priority": {"rank": 0, "robot": 2}});
    let taken = json!({"robot": 1, "luggage": 5, "stage": "TAKEN", "from": block(1, 1), "to": block(2, 2),
        "block": block(0, 1)});
    let help = |stage: &str, healer: u32| {
        json!({"critical": 2, "block": block(3, 3), "luggage": 0, "from": block(2, 2), "to": block(1, 1), "kind": "IDLE",
            "stage": stage, "healer": healer, "healer_block": block(0, 0)})
    };
    for (topic, message, field, component, instead) in [
        ("RLMSTOPIC", robot, "`robot` is 1", "Robot1", "if the robot was removed from the floor, send `gone`"),
        ("POSTOPIC", position, "`robot` is 2", "Robot2", "stop it with `estop`"),
        ("ELMSTOPIC", taken, "`robot` is 1", "Robot1", "for new luggage publish a request"),
        ("CSMSTOPIC", help("REQUEST", 0), "`critical` is 2", "Robot2", "send `breakdown` or `gone`"),
        ("CSMSTOPIC", help("INTENTION", 1), "`healer` is 1", "Robot1", "with a message on RMSTOPIC"),
    ] {
        let refused = running.refused(&["topic", "pub", topic, &message.to_string()]);
        for part in [topic, field, &format!("component `{component}`"), instead] {
            assert!(refused.contains(part), "{part:?} is missing in {refused}");
        }
        let line = running.refused(&["send", &format!("at 1h publish {topic} {message}")]);
        assert!(line.contains(field), "{line}");
    }
    let info = running.told(&["topic", "info", "CSMSTOPIC"]);
    let words = "sender: `critical`, where `stage` is `REQUEST`\nsender: `healer`, unless `stage` is `REQUEST`\n";
    assert!(info.contains(words), "{info}");
    assert_eq!(running.component("Robot1")["values"]["state"], "free");
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
    assert!(!text.contains("ignores"), "{text}");
}

#[test]
fn an_operator_says_that_a_robot_is_gone_and_back() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", state("free"));
    running.told(&["send", "luggage (9,9) to (1,9)"]);
    running.until("Robot1", |robot| robot["values"]["job"].is_string());
    assert_eq!(running.told(&["send", "gone Robot1"]), "1 event accepted\n");
    running.until("Robot1", |robot| robot["state"] == "idle");
    running.until("Master", |master| master["values"]["gone"] == json!([1]));
    running.until("World", |world| world["values"]["robots"] == 1);
    running.until("MasterRobot", |master| master["values"]["robots"] == 1);
    let why = running.told(&["why", "Robot1"]);
    assert!(why.contains("and stops") && why.contains("gone 1"), "{why}");
    assert!(why.contains("busy: yes -> no"), "it has no job any more: {why}");
    running.told(&["topic", "pub", "RMSTOPIC", &json!({"robot": 2, "awake": true, "emulate": 0}).to_string()]);
    running.until("World", |world| world["values"]["delivered"] == 1);
    assert!(running.told(&["logs"]).contains("waits again at (9,9): robot 1 is gone"));
    running.told(&["start", "Robot1"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free" && robot["values"]["block"] == json!([0, 1]));
    running.until("MasterRobot", |master| master["values"]["robots"] == 2);
    running.until("Master", |master| master["values"]["gone"] == json!([]));
    for (line, part) in [
        ("gone robot 1", "did you mean `1`?"),
        ("gon Robot1", "did you mean `gone`?"),
        ("gone Robt", "expected a robot such as"),
    ] {
        let refused = running.refused(&["send", line]);
        assert!(refused.contains(part), "{refused}");
    }
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn a_robot_of_a_library_in_c_speaks_for_itself_as_well() {
    let library = crate::plugins::c_library();
    let text = crate::support::project("plugins/robot-in-c/fleet.composite");
    let running = Running::start(&text, &["--stay", "--plugin", library.to_str().unwrap()]);
    running.until("Patrol", |patrol| patrol["executions"].as_u64() > Some(2));
    let position = json!({"robot": 99, "block": block(6, 6), "next": block(6, 6), "wanted": block(6, 6),
        "priority": {"rank": 0, "robot": 99}});
    let refused = running.refused(&["topic", "pub", "POSTOPIC", &position.to_string()]);
    assert!(refused.contains("`robot` is 99, the number of component `Patrol`"), "{refused}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}
