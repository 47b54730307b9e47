//! A component that wraps another one, and property structs within others.

use saoms_api::host::{Invocation, PropertyValue, TypedCall};
use saoms_api::{CallError, Class, Component, Context, Failure, Message, Properties, Topic, interface};

use super::host::FakeHost;

#[derive(Clone, Debug, Message)]
struct Sound;

const SOUND: Topic<Sound> = Topic::event("SOUND");

/// Says its number.
#[interface(name = "extends.Numbered")]
trait Numbered {
    fn number(&mut self, context: &mut Context<'_>) -> Result<u32, Failure>;
}

/// Says its volume.
#[interface(name = "extends.Loud")]
trait Loud {
    fn volume(&mut self, context: &mut Context<'_>) -> Result<u32, Failure>;
}

#[derive(Debug, PartialEq, Properties)]
struct CarProperties {
    #[property(default = 1)]
    number: u32,
}

#[derive(Class)]
#[class(name = "extends.Car", periodic, service("number": Numbered))]
struct Car {
    number: u32,
}

impl Component for Car {
    type Properties = CarProperties;

    fn new(properties: CarProperties) -> Result<Self, Failure> {
        Ok(Car { number: properties.number })
    }
}

impl Numbered for Car {
    fn number(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        Ok(self.number)
    }
}

#[derive(Debug, PartialEq, Properties)]
struct LoudCarProperties {
    #[property(default = 5)]
    volume: u32,
    #[property(flatten)]
    car: CarProperties,
    #[property(flatten)]
    nothing: Nothing,
    #[property(default = true)]
    can_honk: bool,
}

#[derive(Debug, PartialEq, Properties)]
struct Nothing {}

/// A car with a horn.
#[derive(Class)]
#[class(name = "extends.LoudCar", periodic, publishes(SOUND), service("horn": Loud))]
struct LoudCar {
    #[extends]
    car: Car,
    volume: u32,
}

impl Component for LoudCar {
    type Properties = LoudCarProperties;

    fn new(properties: LoudCarProperties) -> Result<Self, Failure> {
        Ok(LoudCar { car: Car::new(properties.car)?, volume: properties.volume })
    }
}

impl Loud for LoudCar {
    fn volume(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        Ok(self.volume)
    }
}

fn call(car: &mut LoudCar, service: &str) -> Result<u32, CallError> {
    let mut call = TypedCall::new(0, ());
    let served = FakeHost::new().run(|context| car.serve(&mut Invocation { service, call: &mut call }, context));
    served.and_then(|()| call.into_reply())
}

#[test]
fn properties_are_flattened() {
    assert_eq!(LoudCarProperties::NAMES, ["volume", "number", "canHonk"]);
    let json: serde_json::Value = serde_json::from_str(LoudCarProperties::DECLARATION).unwrap();
    let names: Vec<_> = json.as_array().unwrap().iter().map(|property| property["name"].clone()).collect();
    assert_eq!(names, ["volume", "number", "canHonk"]);
    let value = |name: &str, text: &str| (name.into(), PropertyValue::from(text));
    let read = LoudCarProperties::from_values(&[value("number", "7"), value("canHonk", "false")]).unwrap();
    let expected =
        LoudCarProperties { volume: 5, car: CarProperties { number: 7 }, nothing: Nothing {}, can_honk: false };
    assert_eq!(read, expected);
    let unknown = LoudCarProperties::from_values(&[value("numbr", "7")]).unwrap_err();
    assert_eq!(unknown.message(), "property `numbr` is unknown: expected volume, number, canHonk");
}

#[test]
fn a_class_declares_what_it_extends_and_serves_its_services() {
    let json: serde_json::Value = serde_json::from_str(LoudCar::DECLARATION).unwrap();
    assert_eq!(json["extends"], serde_json::from_str::<serde_json::Value>(Car::DECLARATION).unwrap());
    assert_eq!(json["services"].as_array().unwrap().len(), 1, "its own alone");
    let properties = LoudCarProperties::from_values(&[("number".into(), "7".into())]).unwrap();
    let mut car = LoudCar::new(properties).unwrap();
    assert_eq!((call(&mut car, "horn"), call(&mut car, "number")), (Ok(5), Ok(7)));
    let CallError::Mismatch { message } = call(&mut car, "wings").unwrap_err() else { panic!("no such service") };
    assert!(message.contains("extends.Car"), "{message}");
}
