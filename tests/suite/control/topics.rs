//! The topics of a running fleet.

use serde_json::{Value, json};

use super::{Running, fleet};

#[test]
fn topics_are_listed_and_described() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["executions"].as_u64() > Some(2));
    let list = running.told(&["topic", "list"]);
    let line = list.lines().find(|line| line.starts_with("ELMSTOPIC")).unwrap();
    let cells: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(cells[1], "event", "{list}");
    let info = running.told(&["topic", "info", "ELMSTOPIC"]);
    for part in ["  luggage: uint32\n", "published by\n", "  Master\n", "read by\n", "  Robot1: 0 of at most "] {
        assert!(info.contains(part), "{part:?} is missing in\n{info}");
    }
    let unknown = running.refused(&["topic", "info", "ELMSTOPC"]);
    assert!(unknown.contains("no topic `ELMSTOPC`; did you mean `ELMSTOPIC`?"), "{unknown}");
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn messages_are_followed_counted_and_published() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    std::thread::scope(|scope| {
        let echo = scope.spawn(|| running.told(&["topic", "echo", "POSTOPIC", "-n", "3", "--format", "json"]));
        // It drives far enough for whoever begins to listen late.
        running.told(&["send", "luggage (2,1) to (9,9); luggage (8,8) to (2,2)"]);
        let messages = echo.join().unwrap();
        let sent: Vec<Value> = messages.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(sent.len(), 3, "{messages}");
        assert_eq!((&sent[0]["component"], &sent[0]["message"]["robot"]), (&json!("Robot1"), &json!(1)), "{messages}");
    });
    let counted = running.told(&["topic", "hz", "POSTOPIC", "--for", "300ms", "--format", "json"]);
    let counted: Value = serde_json::from_str(&counted).unwrap();
    assert!(counted["messages"].is_u64() && counted["seconds"].as_f64() >= Some(0.3), "{counted}");
    let request = json!({"robot": 0, "luggage": 77, "stage": "REQUEST", "from": {"x": 2, "y": 1}, "to": {"x": 4, "y": 1}, "block": {"x": 0, "y": 0}});
    let wrong = running.refused(&["topic", "pub", "ELMSTOPIC", "{\"luggage\": 77}"]);
    assert!(wrong.contains("topic `ELMSTOPIC`: this is not a message"), "{wrong}");
    let wrong = running.refused(&["topic", "pub", "ELMSTOPIC", "{luggage}"]);
    assert!(wrong.contains("the message is not JSON"), "{wrong}");
    assert_eq!(running.told(&["topic", "pub", "ELMSTOPIC", &request.to_string()]), "published\n");
    running.until("Robot1", |robot| {
        robot["values"]["job"] == "luggage 77 from (2,1) to (4,1)" || robot["values"]["delivered"] == 3
    });
    running.told(&["down"]);
    assert_eq!(running.end().0, Some(0));
}

#[test]
fn what_a_state_topic_retains_is_shown_and_not_counted() {
    let running = Running::start(&fleet(), &["--stay"]);
    running.until("Robot1", |robot| robot["values"]["state"] == "free");
    // Nothing is sent any more.
    running.told(&["estop"]);
    for _ in 0..2 {
        let line = running.told(&["topic", "echo", "POSTOPIC", "-n", "1", "--format", "json"]);
        let retained: Value = serde_json::from_str(&line).unwrap();
        assert!(retained["component"].as_str().unwrap().starts_with("Robot"), "{line}");
        assert!(retained["time_s"].is_f64() && retained["message"]["block"].is_object(), "{line}");
    }
    // What was on its way at the stop may come still.
    let counts = (0..20).map(|_| {
        let counted = running.told(&["topic", "hz", "POSTOPIC", "--for", "300ms", "--format", "json"]);
        serde_json::from_str::<Value>(&counted).unwrap()["messages"].as_u64().unwrap()
    });
    assert!(counts.into_iter().any(|count| count == 0), "what is retained is counted");
}
