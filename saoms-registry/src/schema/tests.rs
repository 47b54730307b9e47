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
    assert_eq!(error(json!({"y": 1})), "`Block` has no field `y`; its fields are: x; field `x` of `Block` is missing");
    assert_eq!(error(json!({"height": 1, "x": 1})), "`Block` has no field `height`; its fields are: x");
    assert_eq!(error(json!({})), "field `x` of `Block` is missing");
    assert_eq!(error(json!(1)), "found 1, expected an object");
}

#[test]
fn numbers_are_taken_as_their_json_schema_says() {
    let numbers = r#"{"name":"A","fields":[{"name":"whole","type":"int8"},{"name":"half","type":"float32"}]}"#;
    let numbers = Schema::parse(numbers).unwrap();
    let read = |whole, half| {
        let bytes = numbers.encode(&json!({"whole": whole, "half": half})).map_err(|faults| faults.to_string())?;
        Ok::<_, String>(numbers.decode(&bytes).unwrap())
    };
    assert_eq!(read(json!(-7.0), json!(1)).unwrap(), json!({"whole": -7, "half": 1.0}));
    for name in ["NaN", "inf", "-inf"] {
        assert_eq!(read(json!(1e2), json!(name)).unwrap(), json!({"whole": 100, "half": name}));
    }
    for (whole, half, expected) in [
        (json!(1.5), json!(1), "field `whole`: found 1.5, expected a whole number from -128 to 127"),
        (json!(1e300), json!(1), "field `whole`: found 1e+300, expected a whole number from -128 to 127"),
        (json!(1), json!("1.5"), "field `half`: found \"1.5\", expected a number of 32 bits"),
        (json!(1), json!("infinity"), "field `half`: found \"infinity\", expected a number of 32 bits"),
        (json!(1), json!("nan"), "field `half`: found \"nan\", expected a number of 32 bits"),
    ] {
        assert_eq!(read(whole, half).unwrap_err(), expected);
    }
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

#[test]
fn all_faults_of_a_value_are_told_with_their_places() {
    let wrong = json!({
        "small": 256, "flag": 1, "txet": "a", "kind": "TAKEOF", "block": {"x": "1", "y": 2, "z": 3},
        "blocks": [{"x": 1, "y": 2}, {"x": 1}], "numbers": [1, "many"], "large": -1, "half": 1e300,
        "matrix": [1, 2, 3], "corners": [{"x": 1, "y": 2}, 7], "few": [], "short": "", "a/b": 1,
    });
    let faults = schema().encode(&wrong).unwrap_err();
    let told: Vec<(&str, String)> = faults.iter().map(|one| (one.pointer.as_str(), one.to_string())).collect();
    let integer = "expected a whole number from";
    let expected = [
        (
            "/a~1b",
            "`All` has no field `a/b`; its fields are: small, flag, text, kind, block, blocks, numbers, large, \
          half, matrix, corners, few, short, maybe"
                .to_owned(),
        ),
        ("/txet", "`All` has no field `txet`; did you mean `text`?".to_owned()),
        ("/small", format!("field `small`: found 256, {integer} 0 to 255")),
        ("/flag", "field `flag`: found 1, expected true or false".to_owned()),
        (
            "/kind",
            "field `kind`: found \"TAKEOF\", expected one of LANDING, TAKEOFF; did you mean `TAKEOFF`?".to_owned(),
        ),
        ("/block/z", "`Block` has no field `z`; its fields are: x, y".to_owned()),
        ("/block/x", format!("field `block.x`: found \"1\", {integer} -2147483648 to 2147483647")),
        ("/blocks/1/y", "field `y` of `Block` is missing".to_owned()),
        ("/numbers/1", "field `numbers[1]`: found \"many\", expected a number".to_owned()),
        ("/large", format!("field `large`: found -1, {integer} 0 to 18446744073709551615")),
        ("/half", "field `half`: found 1e+300, expected a number of 32 bits".to_owned()),
        ("/corners/1", "field `corners[1]`: found 7, expected an object".to_owned()),
    ];
    assert_eq!(told, expected);
}

#[test]
fn a_value_with_very_many_faults_is_told_in_part() {
    let wrong = json!({"numbers": vec!["x".repeat(1_000); 100]});
    let text = schema().encode(&wrong).unwrap_err().to_string();
    assert!(text.ends_with("; and 92 more") && text.len() < 5_000, "{text}");
}

/// The values that a JSON Schema allows, as far as schemas of messages use it.
fn fits(schema: &serde_json::Value, value: &serde_json::Value) -> bool {
    let all = |key: &str| schema[key].as_array().cloned().unwrap_or_default();
    if schema.get("oneOf").is_some() {
        return all("oneOf").iter().filter(|one| fits(one, value)).count() == 1;
    }
    if schema.get("anyOf").is_some() {
        return all("anyOf").iter().any(|one| fits(one, value));
    }
    if schema.get("enum").is_some() && !all("enum").contains(value) {
        return false;
    }
    let number = |key: &str| schema.get(key).and_then(serde_json::Value::as_u64).map(|number| number as usize);
    let least = |length: usize| number("minItems").is_none_or(|least| length >= least);
    match schema["type"].as_str() {
        Some("null") => value.is_null(),
        Some("boolean") => value.is_boolean(),
        Some("integer") => {
            let integer = |one: &serde_json::Value| one.as_i64().map(i128::from).or(one.as_u64().map(i128::from));
            // 2020-12: any number without a fraction.
            let written =
                |one: &serde_json::Value| one.as_f64().filter(|one| one.fract() == 0.0).map(|one| one as i128);
            let found = integer(value).or_else(|| written(value));
            found.is_some_and(|found| {
                integer(&schema["minimum"]).is_some_and(|least| found >= least)
                    && integer(&schema["maximum"]).is_some_and(|most| found <= most)
            })
        }
        Some("number") => value.is_number(),
        Some("string") => {
            value.as_str().is_some_and(|text| number("maxLength").is_none_or(|most| text.chars().count() <= most))
        }
        Some("array") => value.as_array().is_some_and(|list| {
            least(list.len())
                && number("maxItems").is_none_or(|most| list.len() <= most)
                && list.iter().all(|one| fits(&schema["items"], one))
        }),
        Some("object") => value.as_object().is_some_and(|fields| {
            all("required").iter().all(|name| name.as_str().is_some_and(|name| fields.contains_key(name)))
                && fields.iter().all(|(name, one)| fits(&schema["properties"][name], one))
        }),
        _ => false,
    }
}

proptest! {
    #[test]
    fn the_json_schema_of_a_message_allows_its_messages(seed: u64) {
        let schema = schema();
        let value = schema.decode(&schema.sample(&mut saoms_api::Chance::new(seed))).unwrap();
        prop_assert!(fits(&schema.json_schema(), &value), "{value}");
        prop_assert!(schema.encode(&value).is_ok());
    }

    #[test]
    fn what_the_json_schema_refuses_is_refused(seed: u64, field in 0..14usize, wrong in 0..13usize) {
        let schema = schema();
        let mut value = schema.decode(&schema.sample(&mut saoms_api::Chance::new(seed))).unwrap();
        let names: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
        let wrong = [
            json!({"other": 1}), json!("wrong"), json!([[1], "a"]), json!(1e30), json!(true), json!("1.5"), json!("inf"),
            json!("Infinity"), json!("nan"), json!(1.0), json!(-0.0), json!(0.5), json!(["-inf", "1"]),
        ][wrong].clone();
        value[&names[field]] = wrong;
        let is_refused = !fits(&schema.json_schema(), &value);
        prop_assert_eq!(schema.encode(&value).is_err(), is_refused, "{}", value);
    }
}
