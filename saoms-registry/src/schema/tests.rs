use proptest::prelude::*;
use saoms_api::host::cdr;
use saoms_api::{Bounded, Field, Message};
use serde_json::json;

use super::Schema;

/// The subject.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
enum Kind {
    #[default]
    Landing,
    Takeoff,
}

#[derive(Clone, Debug, Default, PartialEq, Field)]
struct Block {
    x: i32,
    y: i64,
}

#[derive(Clone, Debug, Default, PartialEq, Message)]
struct All {
    small: u8,
    flag: bool,
    text: String,
    kind: Kind,
    block: Block,
    blocks: Vec<Block>,
    numbers: Vec<f64>,
    large: u64,
    half: f32,
    matrix: [f64; 3],
    corners: [Block; 2],
    few: Bounded<Vec<i16>, 2>,
    short: Bounded<String, 3>,
    maybe: Option<Block>,
}

fn schema() -> Schema {
    Schema::parse(All::SCHEMA).unwrap()
}

prop_compose! {
    fn all()(
        small: u8, flag: bool, text in ".{0,8}", takeoff: bool, x: i32, y: i64,
        numbers in prop::collection::vec(-1e9..1e9f64, 0..4), large: u64, count in 0..3usize,
        few in prop::collection::vec(0..9i16, 0..=2), short in "[a-z]{0,3}",
    ) -> All {
        All {
            small, flag, text, kind: if takeoff { Kind::Takeoff } else { Kind::Landing }, block: Block { x, y },
            blocks: vec![Block { x: y as i32, y: x.into() }; count], numbers, large, half: 0.5,
            matrix: [x.into(); 3], corners: [Block { x, y }, Block::default()], few: Bounded::new(few).unwrap(),
            short: Bounded::new(short).unwrap(), maybe: takeoff.then_some(Block { x, y }),
        }
    }
}

proptest! {
    #[test]
    fn bytes_of_a_message_are_that_message_and_come_back_from_json(message in all()) {
        let bytes = cdr::encode(&message);
        prop_assert!(schema().check(&bytes).is_ok());
        let value = schema().decode(&bytes).unwrap();
        prop_assert_eq!(schema().encode(&value).unwrap(), bytes);
    }

    #[test]
    fn any_bytes_are_judged_as_the_type_itself_does(message in all(), at in 0..300usize, byte: u8, cut in 0..300usize) {
        let mut bytes = cdr::encode(&message);
        let place = at % bytes.len();
        bytes[place] = byte;
        bytes.truncate(cut.max(1));
        prop_assert_eq!(schema().check(&bytes).is_ok(), cdr::decode::<All>(&bytes).is_ok());
        prop_assert_eq!(schema().decode(&bytes).is_ok(), cdr::decode::<All>(&bytes).is_ok());
    }
}

#[test]
fn json_is_what_people_expect() {
    let value = schema().decode(&cdr::encode(&All { kind: Kind::Takeoff, half: f32::NAN, ..All::default() })).unwrap();
    assert_eq!(value["kind"], "TAKEOFF");
    assert_eq!(value["block"], json!({"x": 0, "y": 0}));
    assert_eq!(value["half"], "NaN");
    assert_eq!(value["matrix"], json!([0.0, 0.0, 0.0]));
    assert_eq!(value["maybe"], json!(null));
    let without = value.as_object().unwrap().iter().filter(|(name, _)| *name != "maybe");
    let without = without.map(|(name, value)| (name.clone(), value.clone())).collect();
    assert_eq!(schema().encode(&serde_json::Value::Object(without)), schema().encode(&value));
}

#[test]
fn wrong_json_is_told() {
    let block = Schema::parse(r#"{"name":"Block","fields":[{"name":"x","type":"int8"}]}"#).unwrap();
    let error = |value| block.encode(&value).unwrap_err().to_string();
    assert_eq!(error(json!({"x": 200})), "field `x`: found 200, expected a whole number from -128 to 127");
    assert_eq!(error(json!({"x": "1"})), "field `x`: found \"1\", expected a whole number from -128 to 127");
    assert_eq!(error(json!({"y": 1})), "`Block` has no field `y`; its fields are: x");
    assert_eq!(error(json!({})), "field `x` of `Block` is missing");
    assert_eq!(error(json!(1)), "found 1, expected an object");
}

#[test]
fn wrong_lengths_are_told() {
    let error = |field: &str, wrong| {
        let mut value = schema().decode(&cdr::encode(&All::default())).unwrap();
        value[field] = wrong;
        schema().encode(&value).unwrap_err().to_string()
    };
    assert_eq!(error("matrix", json!([1, 2])), "field `matrix`: found [1,2], expected a list of 3");
    assert_eq!(error("few", json!([1, 2, 3])), "field `few`: found [1,2,3], expected a list of at most 2");
    assert_eq!(error("short", json!("long")), "field `short`: found \"long\", expected a text of at most 3 bytes");
    assert_eq!(error("short", json!(1)), "field `short`: found 1, expected a text");
}

#[test]
fn a_schema_that_is_none_is_refused() {
    for text in [
        "",
        "{}",
        r#"{"name":"A","fields":[{"name":"x","type":"int9"}]}"#,
        r#"{"name":"A","fields":[{"name":"x","type":{"enumeration":"float32","values":{}}}]}"#,
        r#"{"name":"A","fields":[{"name":"x","type":{"enumeration":"uint8","values":{"A":"1"}}}]}"#,
        r#"{"name":"A","fields":[{"name":"x","type":{"array":"int8","length":0}}]}"#,
        r#"{"name":"A","fields":[{"name":"x","type":{"array":"int8"}}]}"#,
        r#"{"name":"A","fields":[{"name":"x","type":{"array":{"array":"int64","length":100000},"length":100000}}]}"#,
        r#"{"name":"A","fields":[{"name":"x","type":{"bounded":"int8","most":3}}]}"#,
        r#"{"name":"A","fields":[{"name":"x","type":{"bounded":"string","most":-3}}]}"#,
    ] {
        assert!(Schema::parse(text).is_err(), "{text}");
    }
    let deep = (0..40).fold("\"int8\"".to_owned(), |inner, _| format!("{{\"sequence\":{inner}}}"));
    let error = Schema::parse(&format!(r#"{{"name":"A","fields":[{{"name":"x","type":{deep}}}]}}"#)).unwrap_err();
    assert!(error.to_string().contains("32 deep"), "{error}");
}

#[test]
fn samples_are_messages() {
    let mut chance = saoms_api::Chance::new(1);
    for _ in 0..500 {
        let bytes = schema().sample(&mut chance);
        assert!(cdr::decode::<All>(&bytes).is_ok(), "{bytes:?}");
    }
}

#[test]
fn the_key_of_a_message_is_read_from_its_bytes() {
    #[derive(Clone, Debug, Message)]
    #[message(key = "key")]
    struct Keyed {
        text: String,
        key: i16,
        flag: bool,
    }
    let schema = Schema::parse(Keyed::SCHEMA).unwrap();
    for key in [-1, 0, 7] {
        let message = Keyed { text: "before".to_owned(), key, flag: true };
        assert_eq!(schema.key(&cdr::encode(&message)), message.key());
    }
    let key = |schema: &str, bytes: &[u8]| Schema::parse(schema).unwrap().key(bytes);
    let own = |kind: &str| format!(r#"{{"name":"Own","fields":[{{"name":"key","type":{kind}}}],"key":"key"}}"#);
    assert_eq!(key(&own(r#""bool""#), &[0, 1, 0, 0, 1]), Some(1));
    assert_eq!(key(&own(r#"{"enumeration":"uint8","values":{"A":3}}"#), &[0, 1, 0, 0, 3]), Some(3));
    assert_eq!(key(All::SCHEMA, &cdr::encode(&All::default())), None);
    let error = Schema::parse(&own(r#""float32""#)).unwrap_err().to_string();
    assert_eq!(error, "the key of `Own` is `key`, which is not an integer");
}
