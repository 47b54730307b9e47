//! Declarations of classes that the derives make, as text.

use std::time::Duration;

use saoms_api::host::{Interface, PropertyValue, Registration, SmolStr};
use saoms_api::{Class, Component, Context, Failure, Field, Message, Properties, PropertyField, Topic, interface};

/// Position of a robot.
#[derive(Clone, Debug, PartialEq, Message)]
#[message(key = "robot")]
struct Position {
    robot: u8,
    block: Block,
    path: Vec<Block>,
    r#move: Move,
}

#[derive(Clone, Debug, PartialEq, Field)]
struct Block {
    x: i32,
    y: i32,
}

#[derive(Clone, Debug, PartialEq, Field)]
#[field(repr = "u16")]
enum Move {
    StandStill,
    Drive = 10,
    Turn,
}

#[derive(Clone, Debug, PartialEq, Message)]
#[message(name = "Nothing")]
struct Empty;

const POSITION: Topic<Position> = Topic::state("POS\"TOPIC");
const ALARM: Topic<Empty> = Topic::event("ALARM").optional();

/// Moves a robot.
#[interface(name = "example.Wheels")]
trait Wheels {
    /// Moves.
    fn r#move(&mut self, context: &mut Context<'_>, block_from: Block, speed: f32) -> Result<bool, Failure>;
    fn stop(&mut self, context: &mut Context<'_>) -> Result<(), Failure>;
}

#[derive(Debug, PartialEq, PropertyField)]
enum Late {
    Use,
    DropSilently,
    #[property(name = "ask-me")]
    Ask,
}

#[derive(Debug, PartialEq, Properties)]
struct Charger {
    x: i32,
    #[property(default = 0)]
    y: i32,
}

/// Not shown.
#[derive(Debug, PartialEq, Properties)]
struct RobotProperties {
    /// The robot's
    /// number.
    ///
    /// Not twice.
    #[property(range = 1..=99, unique = "robot")]
    number: u8,
    /// Charge that it "loses".
    #[property(default = 2.5, range = 0.0..100.0, unit = "%")]
    discharge: f64,
    #[property(default = "use")]
    late: Late,
    #[property(default = "1.5s", range = "1ms"..)]
    wait_time: Duration,
    #[property(allowed("red", "blue"), default = "red")]
    color: String,
    #[property(required_text)]
    title: String,
    charge_at: Option<Charger>,
    stops: Vec<u16>,
    #[property(name = "isAwake", default = true)]
    awake: bool,
}

/// A robot
/// with \ and "quotes".
#[derive(Class)]
#[class(
    name = "example.Robot",
    periodic,
    publishes(POSITION, ALARM),
    subscribes(ALARM),
    service("wheels": Wheels),
    reference("other": Wheels),
    reference("spare": Wheels, optional),
    also("example.Robot001", number = 1, discharge = -0.5, isAwake = false, title = "first")
)]
#[class(also("example.Plain"))]
struct Robot;

impl Component for Robot {
    type Properties = RobotProperties;

    fn new(_: RobotProperties) -> Result<Self, Failure> {
        Ok(Robot)
    }
}

impl Wheels for Robot {
    fn r#move(&mut self, _: &mut Context<'_>, from: Block, speed: f32) -> Result<bool, Failure> {
        Ok(from.x > 0 && speed > 0.0)
    }

    fn stop(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }
}

#[derive(Class)]
#[class(name = "example.Passive", passive)]
struct Passive;

impl Component for Passive {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Passive)
    }
}

const POSITION_SCHEMA: &str = concat!(
    r#"{"name":"Position","fields":[{"name":"robot","type":"uint8"},"#,
    r#"{"name":"block","type":{"name":"Block","fields":[{"name":"x","type":"int32"},{"name":"y","type":"int32"}]}},"#,
    r#"{"name":"path","type":{"sequence":{"name":"Block","fields":[{"name":"x","type":"int32"},{"name":"y","type":"int32"}]}}},"#,
    r#"{"name":"move","type":{"enumeration":"uint16","values":{"STAND_STILL":0,"DRIVE":10,"TURN":11}}}],"key":"robot"}"#,
);

const WHEELS: &str = concat!(
    r#"{"name":"example.Wheels","operations":[{"name":"move","arguments":[{"name":"blockFrom","type":"#,
    r#"{"name":"Block","fields":[{"name":"x","type":"int32"},{"name":"y","type":"int32"}]}},{"name":"speed","type":"float32"}],"#,
    r#""reply":"bool"},{"name":"stop","arguments":[],"reply":null}]}"#,
);

#[test]
fn a_message_declares_its_schema() {
    assert_eq!(Position::SCHEMA, POSITION_SCHEMA);
    assert_eq!(Empty::SCHEMA, r#"{"name":"Nothing","fields":[]}"#);
}

#[test]
fn an_interface_declares_its_operations() {
    assert_eq!(<dyn Wheels as Interface>::DECLARATION, WHEELS);
    assert_eq!(
        <dyn saoms_api::TaskInterface as Interface>::DECLARATION,
        concat!(
            r#"{"name":"unibg.robotics.tca.TaskInterface","operations":[{"name":"schedule","arguments":[],"reply":null},"#,
            r#"{"name":"scheduleFor","arguments":[{"name":"milliseconds","type":"uint64"}],"reply":null},"#,
            r#"{"name":"unschedule","arguments":[],"reply":null},{"name":"isRunning","arguments":[],"reply":"bool"}]}"#,
        )
    );
}

#[test]
fn a_class_declares_everything() {
    let expected = [
        r#"{"contract":1,"class":"example.Robot","doc":"A robot with \\ and \"quotes\".","kind":"periodic","#,
        r#""also":[{"class":"example.Robot001","preset":{"number":"1","discharge":"-0.5","isAwake":"false","title":"first"}},"#,
        r#"{"class":"example.Plain","preset":{}}],"properties":["#,
        r#"{"name":"number","type":"integer","doc":"The robot's number.\nNot twice.","min":1,"max":99,"required":true,"unique":"robot"},"#,
        r#"{"name":"discharge","type":"float","doc":"Charge that it \"loses\".","unit":"%","min":0.0,"exclusiveMax":100.0,"default":"2.5"},"#,
        r#"{"name":"late","type":"enumeration","default":"use","allowed":["use","dropSilently","ask-me"]},"#,
        r#"{"name":"waitTime","type":"duration","min":"1ms","default":"1.5s"},"#,
        r#"{"name":"color","type":"string","default":"red","allowed":["red","blue"]},"#,
        r#"{"name":"title","type":"string","required":true,"nonEmpty":true},"#,
        r#"{"name":"chargeAt","type":"complex","properties":["#,
        r#"{"name":"x","type":"integer","min":-2147483648,"max":2147483647,"required":true},"#,
        r#"{"name":"y","type":"integer","min":-2147483648,"max":2147483647,"default":"0"}]},"#,
        r#"{"name":"stops","type":"integer","min":0,"max":65535,"many":true},"#,
        r#"{"name":"isAwake","type":"boolean","default":"true"}],"#,
        r#""publishes":[{"topic":"POS\"TOPIC","kind":"state","message":"Position","schema":"#,
        POSITION_SCHEMA,
        r#"},{"topic":"ALARM","kind":"event","message":"Nothing","schema":{"name":"Nothing","fields":[]},"optional":true}],"#,
        r#""subscribes":[{"topic":"ALARM","kind":"event","message":"Nothing","schema":{"name":"Nothing","fields":[]},"optional":true}],"#,
        r#""services":[{"name":"wheels","interface":"#,
        WHEELS,
        r#"}],"references":[{"name":"other","interface":"#,
        WHEELS,
        r#","optional":false},{"name":"spare","interface":"#,
        WHEELS,
        r#","optional":true}]}"#,
    ];
    assert_eq!(Robot::DECLARATION, expected.concat());
    assert_eq!(
        Passive::DECLARATION,
        concat!(
            r#"{"contract":1,"class":"example.Passive","kind":"passive","also":[],"properties":[],"publishes":[],"#,
            r#""subscribes":[],"services":[],"references":[]}"#
        )
    );
}

#[test]
fn declarations_are_json() {
    let json: serde_json::Value = serde_json::from_str(Robot::DECLARATION).unwrap();
    assert_eq!(json["doc"], "A robot with \\ and \"quotes\".");
    assert_eq!(json["publishes"][0]["topic"], "POS\"TOPIC");
    assert_eq!(json["properties"][0]["doc"], "The robot's number.\nNot twice.");
}

#[test]
fn linked_classes_register_themselves() {
    let mut linked: Vec<_> = Registration::linked().map(Registration::declaration).collect();
    linked.sort_unstable();
    for class in [Passive::DECLARATION, Robot::DECLARATION] {
        assert_eq!(linked.iter().filter(|one| **one == class).count(), 1, "{class}");
    }
    // The classes of all modules of this program: no other one registers itself.
    let name = |declaration: &str| declaration.split('"').nth(5).unwrap_or_default().to_owned();
    let names: Vec<String> = linked.into_iter().map(name).collect();
    let own = ["example.Passive", "example.Robot"];
    let others = [
        "example.Car", "extends.Car", "extends.LoudCar", "long.Counter", "short.Counter", "short.Lamp",
        "short.LoudCounter", "short.Remembering", "short.Silent", "test.Busy", "test.Echo", "test.Receiver",
    ];
    let mut expected = [&own[..], &others[..]].concat();
    expected.sort_unstable();
    assert_eq!(names, expected);
}

fn text(name: &str, value: &str) -> (SmolStr, PropertyValue) {
    (name.into(), value.into())
}

/// The least that a robot needs, and these.
fn robot(more: &[(SmolStr, PropertyValue)]) -> Result<RobotProperties, String> {
    let mut values = vec![text("number", "7"), text("title", "seven")];
    values.retain(|(name, _)| more.iter().all(|(other, _)| other != name));
    values.extend_from_slice(more);
    RobotProperties::from_values(&values).map_err(|failure| failure.message().to_owned())
}

#[test]
fn absent_properties_take_their_defaults() {
    let expected = RobotProperties {
        number: 7,
        discharge: 2.5,
        late: Late::Use,
        wait_time: Duration::from_millis(1500),
        color: "red".to_owned(),
        title: "seven".to_owned(),
        charge_at: None,
        stops: Vec::new(),
        awake: true,
    };
    assert_eq!(robot(&[]), Ok(expected));
}

#[test]
fn given_properties_are_read() {
    let charger = PropertyValue::Complex([text("x", "-3")].into());
    let stops = PropertyValue::Many(["1".into(), " 2 ".into()].into());
    let read = robot(&[
        text("discharge", "99.5"),
        text("late", "ask-me"),
        text("waitTime", "2 min"),
        text("color", "blue"),
        ("chargeAt".into(), charger),
        ("stops".into(), stops),
        text("isAwake", "0"),
    ])
    .unwrap();
    assert_eq!((read.discharge, read.late, read.wait_time), (99.5, Late::Ask, Duration::from_secs(120)));
    assert_eq!((read.color.as_str(), read.awake), ("blue", false));
    assert_eq!((read.charge_at, read.stops), (Some(Charger { x: -3, y: 0 }), vec![1, 2]));
}

#[test]
fn wrong_properties_say_what_was_found_and_expected() {
    let many = |name: &str, values: &[&str]| {
        (name.into(), PropertyValue::Many(values.iter().map(|value| (*value).into()).collect()))
    };
    let cases = [
        (text("number", "0"), "property `number`: `0` is out of range: expected a whole number from 1 to 99"),
        (text("number", "1e3"), "property `number`: `1e3` is not a whole number: expected a whole number from 1 to 99"),
        (text("number", " "), "property `number`: the value is empty: expected a whole number from 1 to 99"),
        (
            text("number", "99999999999999999999999999999999999999999999"),
            "property `number`: `99999999999999999999999999999999999999999999` is out of range: expected a whole number from 1 to 99",
        ),
        (many("number", &["1", "2"]), "property `number`: found a list: expected a whole number from 1 to 99"),
        (
            text("discharge", "100"),
            "property `discharge`: `100` is out of range: expected a number from 0.0 to below 100.0 [%]",
        ),
        (
            text("discharge", "NaN"),
            "property `discharge`: `NaN` is not a number: expected a number from 0.0 to below 100.0 [%]",
        ),
        (text("late", "Use"), "property `late`: `Use` is not allowed: expected `use`, `dropSilently` or `ask-me`"),
        (
            text("waitTime", "10us"),
            "property `waitTime`: `10us` is out of range: expected a duration, at least 1ms (in ms, or with a unit: ns, us, ms, s, min, h)",
        ),
        (text("color", "green"), "property `color`: `green` is not allowed: expected `red` or `blue`"),
        (text("title", ""), "property `title`: the value is empty: expected a text that is not empty"),
        (text("chargeAt", "3"), "property `chargeAt`: found `3`: expected the properties x, y"),
        (
            ("chargeAt".into(), PropertyValue::Complex([text("y", "1")].into())),
            "property `chargeAt`: property `x` is missing: expected a whole number from -2147483648 to 2147483647",
        ),
        (
            many("stops", &["1", "x"]),
            "property `stops`: `x` is not a whole number: expected a whole number from 0 to 65535",
        ),
        (text("isAwake", "yes"), "property `isAwake`: `yes` is not a boolean: expected `true` or `false`"),
        (
            text("colour", "red"),
            "property `colour` is unknown: expected number, discharge, late, waitTime, color, title, chargeAt, stops, isAwake",
        ),
    ];
    for (value, expected) in cases {
        assert_eq!(robot(&[value]), Err(expected.to_owned()));
    }
    assert_eq!(robot(&[text("color", "red"), text("color", "red")]), Err("property `color` is given twice".to_owned()));
    let missing = RobotProperties::from_values(&[]).unwrap_err();
    assert_eq!(missing.message(), "property `number` is missing: expected a whole number from 1 to 99");
}

#[derive(Debug, PartialEq, Properties)]
struct LabelProperties {
    #[property(required_text)]
    name: SmolStr,
    #[property(allowed("red", "blue"))]
    color: String,
    #[property(default = "none")]
    note: SmolStr,
    title: Option<SmolStr>,
}

#[test]
fn texts_are_held_to_their_rules_and_stay_as_they_are() {
    let read = |values: &[(&str, &str)]| {
        let values: Vec<_> = values.iter().map(|(name, value)| text(name, value)).collect();
        LabelProperties::from_values(&values).map_err(|failure| failure.message().to_owned())
    };
    let label = |name: &str, note: &str, title: Option<&str>| LabelProperties {
        name: name.into(),
        color: "red".to_owned(),
        note: note.into(),
        title: title.map(SmolStr::from),
    };
    assert_eq!(read(&[("name", "A"), ("color", "red")]), Ok(label("A", "none", None)));
    assert_eq!(
        read(&[("title", " of all "), ("name", " A "), ("note", ""), ("color", "red")]),
        Ok(label(" A ", "", Some(" of all ")))
    );
    for (name, color, expected) in [
        ("", "red", "property `name`: the value is empty: expected a text that is not empty"),
        (" ", "red", "property `name`: the value is empty: expected a text that is not empty"),
        ("A", "green", "property `color`: `green` is not allowed: expected `red` or `blue`"),
        ("A", "", "property `color`: `` is not allowed: expected `red` or `blue`"),
    ] {
        assert_eq!(read(&[("name", name), ("color", color)]), Err(expected.to_owned()), "{name:?} {color:?}");
    }
}
