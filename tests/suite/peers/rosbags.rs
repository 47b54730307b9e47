//! Messages of ROS 2 have the schemas and the bytes that the Python package `rosbags` gives them.

use std::process::Command;

use expect_test::expect_file;
use saoms_api::builtin_interfaces::{Duration, Time};
use saoms_api::host::cdr;
use saoms_api::{Bounded, Chance, Message};
use saoms_lang::schema::Schema;
use serde_json::{Value, json};

use super::messages::{
    Header, LaserScan, NavSatStatus, Odometry, Point, Pose, PoseWithCovariance, Quaternion, Rest, Twist,
    TwistWithCovariance, Vector3,
};
use crate::support::{fed, root, stderr};

const VERSION: &str = "0.11.9";
/// Random messages of each type, beside the one that is kept here.
const COUNT: usize = 40;

fn header() -> Header {
    Header { stamp: Time { sec: 1_732_000_000, nanosec: 999_999_999 }, frame_id: "odom".to_owned() }
}

fn odometry() -> Odometry {
    let position = Point { x: 1.5, y: -2.25, z: 0.0 };
    let orientation = Quaternion { x: 0.0, y: 0.0, z: 0.6, w: 0.8 };
    let mut covariance = [0.0; 36];
    (0..6).for_each(|place| covariance[place * 7] = 0.5 + place as f64);
    let pose = PoseWithCovariance { pose: Pose { position, orientation }, covariance };
    let linear = Vector3 { x: 0.25, y: 0.0, z: 0.0 };
    let twist = Twist { linear, angular: Vector3 { x: 0.0, y: 0.0, z: -0.125 } };
    let twist = TwistWithCovariance { twist, covariance: [f64::MIN_POSITIVE; 36] };
    Odometry { header: header(), child_frame_id: "base_link".to_owned(), pose, twist }
}

fn laser_scan() -> LaserScan {
    LaserScan {
        header: header(),
        angle_min: -1.5,
        angle_max: 1.5,
        angle_increment: 1.0,
        time_increment: 0.001,
        scan_time: 0.1,
        range_min: 0.05,
        range_max: 12.0,
        ranges: vec![0.5, f32::INFINITY, f32::NAN, 11.75],
        intensities: Vec::new(),
    }
}

fn rest() -> Rest {
    Rest {
        flag: true,
        few: Bounded::new(vec![1, -2, 3, i32::MIN]).unwrap(),
        name: Bounded::new("größer".to_owned()).unwrap(),
        numbers: vec![0.5],
        rgb: [255, 0, 1],
        corners: [Point::default(), Point { x: 1.0, y: 2.0, z: 3.0 }],
        names: ["left".to_owned(), String::new()],
        times: vec![Duration { sec: -1, nanosec: 500_000_000 }, Duration::default()],
        large: i64::MIN,
        nothing: Vec::new(),
        last: -1,
    }
}

fn nav_sat_status() -> NavSatStatus {
    NavSatStatus { status: NavSatStatus::STATUS_NO_FIX, service: NavSatStatus::SERVICE_GALILEO }
}

/// The bytes that rosbags has for the messages above, kept for those who do not have it.
#[test]
fn messages_of_ros_have_the_bytes_that_rosbags_gives_them() {
    same(&odometry(), include_str!("bytes/odometry.hex"));
    same(&laser_scan(), include_str!("bytes/laser_scan.hex"));
    same(&rest(), include_str!("bytes/rest.hex"));
    same(
        &NavSatStatus { status: NavSatStatus::STATUS_NO_FIX, service: NavSatStatus::SERVICE_GALILEO },
        "00010000ff000800",
    );
}

fn same<M: Message>(message: &M, expected: &str) {
    let bytes = cdr::encode(message);
    assert_eq!(lines(&hex(&bytes)), expected.trim_end(), "{}", M::NAME);
    // Compared as texts: the values that are not numbers equal none.
    assert_eq!(format!("{:?}", cdr::decode::<M>(&bytes)), format!("{:?}", Ok::<_, cdr::DecodeError>(message)));
}

#[test]
fn rosbags_agrees_on_schemas_and_bytes() {
    let Some(python) = super::python("rosbags", VERSION) else { return };
    let mut asked = Asked::default();
    asked.add(&odometry());
    asked.add(&laser_scan());
    asked.add(&rest());
    asked.add(&nav_sat_status());
    let question = json!({"definitions": {Rest::NAME: Rest::DEFINITION}, "messages": asked.messages});
    let program = root().join("tests/suite/peers/ask_rosbags.py");
    let output = fed(Command::new(python).arg(program), question.to_string().as_bytes());
    assert!(output.status.success(), "{}", stderr(&output));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["schemas"], Value::Object(asked.schemas.into_iter().collect()));
    let found = answer["bytes"].as_array().unwrap();
    assert_eq!(found.len(), 4 * (COUNT + 1));
    // The first of each type is kept: `UPDATE_EXPECT=1` writes what rosbags says.
    let first = |place: usize| lines(found[place * (COUNT + 1)].as_str().unwrap()) + "\n";
    expect_file!["bytes/odometry.hex"].assert_eq(&first(0));
    expect_file!["bytes/laser_scan.hex"].assert_eq(&first(1));
    expect_file!["bytes/rest.hex"].assert_eq(&first(2));
    for ((found, bytes), message) in found.iter().zip(&asked.bytes).zip(&asked.messages) {
        assert_eq!(found.as_str(), Some(&*hex(bytes)), "{message}");
    }
}

/// Messages for rosbags, as JSON, with our schemas and bytes.
#[derive(Default)]
struct Asked {
    messages: Vec<Value>,
    bytes: Vec<Vec<u8>>,
    schemas: Vec<(String, Value)>,
}

impl Asked {
    /// This message and random ones of its type.
    fn add<M: Message>(&mut self, message: &M) {
        let schema = Schema::parse(M::SCHEMA).unwrap();
        let mut chance = Chance::new(7);
        self.schemas.push((M::NAME.to_owned(), serde_json::from_str(M::SCHEMA).unwrap()));
        self.bytes.push(cdr::encode(message));
        for _ in 0..COUNT {
            // Written by the type itself, not by its schema.
            let random: M = cdr::decode(&schema.sample(&mut chance)).unwrap();
            self.bytes.push(cdr::encode(&random));
        }
        for bytes in &self.bytes[self.messages.len()..] {
            self.messages.push(json!({"type": M::NAME, "value": schema.decode(bytes).unwrap()}));
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Cut into lines of 32 bytes.
fn lines(hex: &str) -> String {
    hex.as_bytes().chunks(64).map(|line| std::str::from_utf8(line).unwrap()).collect::<Vec<_>>().join("\n")
}
