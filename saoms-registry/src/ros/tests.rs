#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use proptest::prelude::*;
use serde_json::json;

use super::{RosBase, RosList, RosType, read_ros_file};
use crate::schema::Schema;

const PLAN: &str = r#"{"name":"Plan","fields":[
    {"name":"stage","type":{"enumeration":"uint8","values":{"ASKED":0,"DONE":1}}},
    {"name":"at","type":"time"},
    {"name":"chargeX","type":{"array":"int32","length":2}},
    {"name":"names","type":{"bounded":{"sequence":{"bounded":"string","most":5}},"most":3}},
    {"name":"rows","type":{"sequence":{"sequence":{"name":"Block","fields":[{"name":"x","type":"int32"}]}}}},
    {"name":"stamp","type":{"name":"builtin_interfaces/msg/Time","fields":[{"name":"sec","type":"int32"}]}},
    {"name":"other","type":{"optional":{"name":"Block","fields":[]}}}]}"#;

#[test]
fn types_have_the_form_that_ros_gives_the_same_bytes() {
    let line = "=".repeat(80);
    let expected = format!(
        "uint8 STAGE_ASKED=0\nuint8 STAGE_DONE=1\nuint8 stage\n# Nanoseconds since the start of the run.\nuint64 at\n\
         int32[2] charge_x\nstring<=5[<=3] names\nsaoms_msgs/PlanRows[] rows\nbuiltin_interfaces/Time stamp\n\
         saoms_msgs/Block2[<=1] other\n{line}\nMSG: saoms_msgs/Block\nint32 x\n{line}\nMSG: saoms_msgs/PlanRows\n\
         saoms_msgs/Block[] value\n{line}\nMSG: builtin_interfaces/Time\nint32 sec\n{line}\nMSG: saoms_msgs/Block2\n\
         uint8 structure_needs_at_least_one_member\n"
    );
    let found = RosType::of(PLAN).unwrap();
    assert_eq!((&*found.name, &*found.text), ("saoms_msgs/msg/Plan", &*expected));
    assert_eq!(RosType::of(r#"{"name":"nav_msgs/msg/Path","fields":[]}"#).unwrap().name, "nav_msgs/msg/Path");
}

#[test]
fn the_schema_with_the_names_of_ros_has_the_same_bytes() {
    let (own, of_ros) = (Schema::parse(PLAN).unwrap(), Schema::of(&RosType::of(PLAN).unwrap().schema).unwrap());
    let bytes = own
        .encode(&json!({"stage": "DONE", "at": 7, "chargeX": [1, -1], "names": ["a"], "rows": [[{"x": 3}], []],
            "stamp": {"sec": 5}, "other": {}}))
        .unwrap();
    let expected = json!({"stage": 1, "at": 7, "charge_x": [1, -1], "names": ["a"],
        "rows": [{"value": [{"x": 3}]}, {"value": []}], "stamp": {"sec": 5}, "other": [{}]});
    assert_eq!(of_ros.decode(&bytes).unwrap(), expected);
    assert_eq!(of_ros.encode(&expected).unwrap(), bytes);
}

#[test]
fn descriptions_are_those_that_ros_makes_hashes_of() {
    let text = |schema: &str| RosType::of(schema).unwrap().description;
    // Its hash is df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18.
    assert_eq!(
        text(r#"{"name":"std_msgs/msg/String","fields":[{"name":"data","type":"string"}]}"#),
        "{\"type_description\": {\"type_name\": \"std_msgs/msg/String\", \"fields\": [{\"name\": \"data\", \
         \"type\": {\"type_id\": 17, \"capacity\": 0, \"string_capacity\": 0, \"nested_type_name\": \"\"}}]}, \
         \"referenced_type_descriptions\": []}"
    );
    let plan = text(PLAN);
    for part in [
        r#"{"name": "names", "type": {"type_id": 117, "capacity": 3, "string_capacity": 5, "nested_type_name": ""}}"#,
        r#"{"name": "charge_x", "type": {"type_id": 54, "capacity": 2, "string_capacity": 0, "nested_type_name": ""}}"#,
        r#"{"type_id": 145, "capacity": 0, "string_capacity": 0, "nested_type_name": "saoms_msgs/msg/PlanRows"}"#,
        // Those that a type refers to are sorted.
        r#""referenced_type_descriptions": [{"type_name": "builtin_interfaces/msg/Time""#,
    ] {
        assert!(plan.contains(part), "{part}\n{plan}");
    }
}

#[test]
fn all_faults_of_a_file_are_told_with_their_places() {
    let text = "# Lamps.\n\n  bool On\nint3 x\nstring<=0 s\nuint8 A=256\nuint8 a=1\nint8[a] l\nbool\nbool on\nbool on\n\
                geo-metry/Point p\nwstring w\nPoint LIST=1\n";
    let faults = read_ros_file(text, false).unwrap_err();
    let places: Vec<(usize, usize)> = faults.iter().map(|fault| (fault.line, fault.column)).collect();
    let expected = [(3, 8), (4, 1), (5, 1), (6, 7), (7, 7), (8, 1), (9, 5), (11, 6), (12, 1), (13, 1), (14, 1)];
    assert_eq!(places, expected, "{faults:#?}");
    assert_eq!(
        read_ros_file("bool on\n", true).unwrap_err()[0].to_string(),
        "1:1: a service has a line `---` between its request and its answer"
    );
    assert_eq!(read_ros_file("---\n---\n", true).unwrap_err()[0].line, 2);
}

#[test]
fn definitions_are_read_with_their_comments_and_constants() {
    let text = "# A goal,\n# and its kind.\n\n# None.\nuint8 NONE=0x0\nstring NAME=\"a # b\"  # of it\nfloat32 HALF=.5\n\
                # Where.\ngeometry_msgs/msg/Point[<=3] points\nuint8[36] bytes # raw\nstring label \"none\"\n";
    let goal = read_ros_file(text, false).unwrap().remove(0);
    assert_eq!(goal.docs, ["A goal,", "and its kind."]);
    let constants: Vec<_> = goal.constants.iter().map(|one| (one.kind, &*one.name, &*one.value, &*one.docs)).collect();
    let (none, of_it) = (["None.".to_owned()], ["of it".to_owned()]);
    assert_eq!(
        constants,
        [("u8", "NONE", "0", &none[..]), ("&str", "NAME", "\"a # b\"", &of_it), ("f32", "HALF", "0.5", &[])]
    );
    let fields: Vec<_> = goal.fields.iter().map(|one| (&*one.name, &one.base, one.list, one.docs.join(" "))).collect();
    let point = RosBase::Message(Some("geometry_msgs".to_owned()), "Point".to_owned());
    assert_eq!(
        fields,
        [
            ("points", &point, RosList::Most(3), "Where.".to_owned()),
            ("bytes", &RosBase::Plain("u8"), RosList::Length(36), "raw".to_owned()),
            ("label", &RosBase::String(None), RosList::None, "In ROS 2 the default is `\"none\"`.".to_owned()),
        ]
    );
}

proptest! {
    #[test]
    fn no_text_does_harm(text in "(bool|int8|string|a/B|A|#|=|<=|[\\[\\]0-9\"' _a-zA-Z/ö-]|\n|---\n){0,60}", is_service: bool) {
        if let Err(faults) = read_ros_file(&text, is_service) {
            for fault in faults {
                prop_assert!((1..=text.lines().count().max(1)).contains(&fault.line) && fault.column >= 1);
            }
        }
    }

    /// What is made of a schema is read as it is.
    #[test]
    fn own_definitions_are_read(fields in prop::collection::vec((kinds(), "[a-z][a-zA-Z0-9]{0,8}"), 0..6)) {
        let fields: Vec<_> = fields.into_iter().map(|(kind, name)| json!({"name": name, "type": kind})).collect();
        let count = fields.len().max(1);
        let form = RosType::of(&json!({"name": "Drawn", "fields": fields}).to_string()).unwrap();
        for (place, (name, text)) in form.definitions.iter().enumerate() {
            let read = read_ros_file(text, false);
            let read = read.map_err(|faults| TestCaseError::fail(format!("{name}: {faults:?}\n{text}")))?;
            prop_assert!(place > 0 || read[0].fields.len() == count);
        }
    }
}

/// Types of fields.
fn kinds() -> impl Strategy<Value = serde_json::Value> {
    let plain = prop::sample::select(vec!["bool", "int8", "uint64", "float32", "string", "time"]);
    let leaf = prop_oneof![
        plain.prop_map(serde_json::Value::from),
        Just(json!({"bounded": "string", "most": 5})),
        Just(json!({"enumeration": "uint8", "values": {"ON": 1, "OFF": 0}})),
        Just(json!({"name": "Inner", "fields": [{"name": "x", "type": "int32"}]})),
    ];
    leaf.prop_recursive(3, 8, 1, |inner| {
        prop_oneof![
            inner.clone().prop_map(|kind| json!({"sequence": kind})),
            inner.clone().prop_map(|kind| json!({"optional": kind})),
            inner.clone().prop_map(|kind| json!({"array": kind, "length": 3})),
            inner.prop_map(|kind| json!({"bounded": {"sequence": kind}, "most": 4})),
        ]
    })
}
