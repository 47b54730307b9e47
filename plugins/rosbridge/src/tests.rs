#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::ErrorKind;

use proptest::prelude::*;
use saoms_transport::Topic;
use serde_json::{Value, json};

use crate::form::Form;
use crate::handshake::{accepted, is_trusted};
use crate::incoming::{Incoming, LONGEST, Said};
use crate::op::Op;
use crate::socket::{self, CONTINUATION, PING, TEXT};

fn form() -> Form {
    let schema = json!({"name": "saoms_msgs/msg/Picture", "fields": [
        {"name": "stamp", "type": {"name": "builtin_interfaces/msg/Time", "fields": [
            {"name": "sec", "type": "int32"}, {"name": "nanosec", "type": "uint32"}]}},
        {"name": "data", "type": {"sequence": "uint8"}},
        {"name": "scale", "type": "float64"},
        {"name": "corners", "type": {"array": "int16", "length": 2}},
        {"name": "name", "type": {"bounded": "string", "most": 5}}]});
    let topic = json!({"topic": "PICTURE", "type": "saoms_msgs/msg/Picture", "definition": "", "description": "",
        "schema": schema, "state": false});
    Form::of(&serde_json::from_value::<Topic>(topic).unwrap()).unwrap()
}

#[test]
fn messages_are_in_json_as_rosbridge_has_them() {
    let form = form();
    let whole =
        json!({"stamp": {"sec": 1, "nanosec": 2}, "data": "AAEC", "scale": null, "corners": [3, -4], "name": "a"});
    let bytes = form.to_cdr(whole.clone()).unwrap();
    assert_eq!(form.to_json(&bytes).unwrap(), whole);
    let of_ros_1 =
        json!({"stamp": {"secs": 1, "nsecs": 2}, "data": [0, 1, 2], "scale": null, "corners": [3, -4], "name": "a"});
    assert_eq!(form.to_cdr(of_ros_1).unwrap(), bytes);
    let empty = json!({"stamp": {"sec": 0, "nanosec": 0}, "data": "", "scale": 0.0, "corners": [0, 0], "name": ""});
    assert_eq!(form.to_json(&form.to_cdr(json!({})).unwrap()).unwrap(), empty);
    let wrong = form.to_cdr(json!({"scales": 1, "corners": [1], "data": "?"})).unwrap_err();
    for part in ["`scales`", "corners", "data"] {
        assert!(wrong.contains(part), "{wrong}");
    }
}

#[test]
fn types_have_the_names_of_both_generations() {
    let form = form();
    assert!(form.is_named("saoms_msgs/Picture") && form.is_named("saoms_msgs/msg/Picture"));
    assert!(!form.is_named("saoms_msgs/srv/Picture") && !form.is_named("Picture"));
}

#[test]
fn the_answer_to_a_key_is_that_of_the_standard() {
    assert_eq!(accepted("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
}

#[test]
fn pages_of_other_sites_are_not_trusted() {
    for (host, origin, is_local, is) in [
        ("localhost:9090", None, true, true),
        ("localhost:9090", Some("http://localhost:3000"), true, true),
        ("10.0.0.5:9090", Some("http://10.0.0.5"), false, true),
        ("robot:9090", Some("https://robot"), false, true),
        ("[::1]:9090", Some("http://[::1]:8080"), true, true),
        ("localhost:9090", Some("http://evil.example"), true, false),
        ("localhost:9090", Some("null"), true, false),
        // A name of another site that leads to this machine.
        ("evil.example:9090", Some("http://evil.example:9090"), true, false),
    ] {
        assert_eq!(is_trusted(host, origin, is_local), is, "{host} {origin:?}");
    }
}

/// What is read of these bytes.
fn said(bytes: &[u8]) -> Vec<Result<Said, ErrorKind>> {
    let mut incoming = Incoming::new(bytes, true);
    let mut all = Vec::new();
    loop {
        let next = incoming.next().map_err(|error| error.kind());
        let is_over = matches!(next, Err(_) | Ok(Said::End));
        all.push(next);
        if is_over {
            return all;
        }
    }
}

#[test]
fn messages_come_in_parts_with_signs_of_life_between() {
    let mask = Some([1, 2, 3, 4]);
    let mut first = socket::frame(TEXT, "größ".as_bytes(), mask);
    first[0] &= 0x7f;
    let all = [first, socket::frame(PING, b"?", mask), socket::frame(CONTINUATION, b"er", mask)].concat();
    let expected = [
        Ok(Said::Nothing),
        Ok(Said::Ping(b"?".to_vec())),
        Ok(Said::Text("größer".to_owned())),
        Err(ErrorKind::UnexpectedEof),
    ];
    assert_eq!(said(&all), expected);
    assert_eq!(said(&socket::frame(TEXT, b"bare", None)), [Err(ErrorKind::InvalidData)]);
    let long = socket::frame(TEXT, &vec![b'a'; 70_000], mask);
    assert_eq!(said(&long)[0], Ok(Said::Text("a".repeat(70_000))));
    let mut endless = vec![0x81, 0xff];
    endless.extend((LONGEST as u64 + 1).to_be_bytes());
    assert_eq!(said(&endless), [Err(ErrorKind::InvalidData)]);
}

proptest! {
    #[test]
    fn no_bytes_and_no_text_do_harm(bytes in prop::collection::vec(any::<u8>(), 0..300), text in ".*") {
        let _ = said(&bytes);
        let _ = serde_json::from_str::<Op>(&text);
        let _ = form().to_cdr(Value::String(text));
    }
}
