use std::time::Duration;

use saoms_api::declaration::PropertyKind;
use saoms_api::{Class, Component, Failure, Message, Properties, Registration, Topic};
use serde_json::{Value, json};

use super::*;

#[derive(Clone, Debug, Message)]
struct Seen {
    count: u32,
}

const SEEN: Topic<Seen> = Topic::event("SEEN");

#[derive(Properties)]
#[expect(dead_code, reason = "only its declaration is looked at")]
struct EyeProperties {
    #[property(range = 1..=18446744073709551615, unique = "eye")]
    number: u64,
    #[property(default = 0.5, range = 0.0..1.0, unit = "m")]
    reach: f64,
    #[property(default = "1s", range = "1ms"..)]
    patience: Duration,
}

/// Looks around.
#[derive(Class)]
#[class(name = "a.Eye", periodic, publishes(SEEN), also("a.Eye001", number = 1))]
struct Eye;

impl Component for Eye {
    type Properties = EyeProperties;

    fn new(_: EyeProperties) -> Result<Self, Failure> {
        Ok(Eye)
    }
}

#[derive(Class)]
#[class(name = "b.Lamp", passive, also("a.Eye001"))]
struct Lamp;

impl Component for Lamp {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Lamp)
    }
}

fn names(registry: &Registry) -> Vec<&str> {
    registry.iter().map(|class| class.name()).collect()
}

#[test]
fn a_class_is_found_by_all_its_names_with_their_presets() {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Eye>()).unwrap();
    assert_eq!(names(&registry), ["a.Eye", "a.Eye001"]);
    let first = registry.get("a.Eye001").unwrap();
    assert!(first.is_alias() && !registry.get("a.Eye").unwrap().is_alias());
    assert_eq!(first.presets(), [("number".to_owned(), "1".into())]);
    assert!(first.construct(first.presets()).is_ok());
    assert!(first.construct(&[]).is_err(), "presets are among the values that the caller gives");

    let declaration = first.declaration();
    assert_eq!((declaration.name.as_str(), declaration.doc.as_str()), ("a.Eye", "Looks around."));
    assert_eq!(declaration.publishes[0].schema["name"], "Seen");
    let [number, reach, patience] = &declaration.properties[..] else { panic!("three properties") };
    assert_eq!((number.required, number.unique.as_deref()), (true, Some("eye")));
    assert_eq!(number.max.as_deref(), Some("18446744073709551615"));
    assert_eq!((reach.kind, reach.exclusive_max.as_deref()), (PropertyKind::Float, Some("1.0")));
    assert_eq!(reach.expected(), "a number from 0.0 to below 1.0 [m]");
    assert_eq!(patience.min.as_deref(), Some("1ms"));
    let offered: Vec<_> =
        declaration.offers().map(|service| (service.name.as_str(), service.is_of_host())).collect();
    assert_eq!(offered, [("TaskInterface", true)]);
}

#[test]
fn a_name_stands_for_one_class_and_a_refused_class_leaves_nothing_behind() {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Eye>()).unwrap();
    let twice = registry.add(Registration::of::<Eye>()).unwrap_err();
    assert_eq!(twice.to_string(), "class `a.Eye` is registered twice");
    let taken = registry.add(Registration::of::<Lamp>()).unwrap_err();
    assert_eq!(
        taken.to_string(),
        "the class name `a.Eye001` of class `b.Lamp` stands for class `a.Eye` already"
    );
    assert_eq!(names(&registry), ["a.Eye", "a.Eye001"]);
}

#[test]
fn unknown_names_get_the_nearest_ones() {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Eye>()).unwrap();
    assert_eq!(registry.nearest("a.Eye01"), ["a.Eye001", "a.Eye"]);
    assert_eq!(registry.nearest("org.example.robots.eye"), ["a.Eye"], "another package");
    assert!(registry.nearest("Wheel").is_empty());
    assert!(registry.nearest("x.").is_empty());
}

/// What `change` makes of a good declaration.
fn refused(change: impl FnOnce(&mut Value)) -> String {
    let mut declaration: Value = serde_json::from_str(Eye::DECLARATION).unwrap();
    change(&mut declaration);
    let text: &'static str = Box::leak(declaration.to_string().into_boxed_str());
    read_text(text).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn a_malformed_declaration_is_refused_with_its_class() {
    let malformed = |what: &str| format!("the declaration of class `a.Eye` is malformed: {what}");
    assert_eq!(
        refused(|eye| eye["contract"] = json!(2)),
        "class `a.Eye` was built for contract 2, this program has contract 1: build both from one version"
    );
    assert!(
        refused(|eye| eye["kind"] = json!("sometimes")).contains("`a.Eye` is malformed: unknown variant")
    );
    assert!(refused(|eye| eye["properties"][0]["type"] = json!("colour")).contains("`colour` is no type"));
    assert_eq!(
        refused(|eye| eye["properties"][1]["default"] = json!("7")),
        malformed(
            "the default of property `reach`: `7` is out of range: expected a number from 0.0 to below 1.0 [m]"
        )
    );
    assert_eq!(
        refused(|eye| eye["properties"][2]["min"] = json!("soon")),
        malformed("the bound `soon` of property `patience` is no duration")
    );
    assert_eq!(
        refused(|eye| eye["properties"][1]["name"] = json!("number")),
        malformed("property `number` is declared twice")
    );
    assert_eq!(
        refused(|eye| eye["also"][0]["preset"] = json!({"numbr": "1"})),
        malformed("`a.Eye001` presets `numbr`, which is no property")
    );
    assert_eq!(
        refused(|eye| eye["also"][0]["preset"] = json!({"number": "0"})),
        malformed(
            "`a.Eye001` presets `number`: `0` is out of range: expected a whole number from 1 to 18446744073709551615"
        )
    );
    assert_eq!(
        refused(|eye| eye["properties"][0]["type"] = json!("complex")),
        malformed("property `number` of type complex has the wrong inner properties")
    );
    let error = read_text("{ this is no JSON, and longer than can be shown").unwrap_err().to_string();
    assert!(
        error
            .starts_with("the declaration of class `{ this is no JSON, and longer than can b` is malformed:")
    );
}
