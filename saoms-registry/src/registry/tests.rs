use std::time::Duration;

use saoms_api::host::declaration::{PropertyKind, Scalar};
use saoms_api::host::{DynLoop, PropertyValue, Registration};
use saoms_api::{Class, Component, Failure, Message, Properties, Topic};
use serde_json::{Value, json};
use smol_str::SmolStr;

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
    assert_eq!(first.presets(), [("number".into(), Scalar::Integer(1.into()).into())]);
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
    let offered: Vec<_> = declaration.offers().map(|service| (service.name.as_str(), service.is_of_host())).collect();
    assert_eq!(offered, [("TaskInterface", true)]);
}

#[test]
fn a_name_stands_for_one_class_and_a_refused_class_leaves_nothing_behind() {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Eye>()).unwrap();
    let twice = registry.add(Registration::of::<Eye>()).unwrap_err();
    assert_eq!(twice.to_string(), "class `a.Eye` is registered twice");
    let taken = registry.add(Registration::of::<Lamp>()).unwrap_err();
    assert_eq!(taken.to_string(), "the name `a.Eye001` is used by class `a.Eye` and by class `b.Lamp`");
    assert_eq!(names(&registry), ["a.Eye", "a.Eye001"]);
}

/// An eye of another package.
#[derive(Class)]
#[class(name = "a.far.away.Eye", passive, also("a.GlassEye"))]
struct FarEye;

impl Component for FarEye {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(FarEye)
    }
}

#[test]
fn unknown_names_get_the_nearest_ones() {
    let mut registry = Registry::new();
    registry.add(Registration::of::<FarEye>()).unwrap();
    registry.add(Registration::of::<Eye>()).unwrap();
    assert_eq!(registry.nearest("a.Eye01"), ["a.Eye001"], "by what follows the package");
    assert_eq!(registry.nearest("A.eye"), ["a.Eye"], "nothing else beside the same but for case");
    assert_eq!(registry.nearest("Eye"), ["a.Eye", "a.far.away.Eye"], "the shorter first");
    assert_eq!(registry.nearest("org.example.robots.eye"), ["a.Eye", "a.far.away.Eye"], "another package");
    assert_eq!(registry.nearest("a.far.awy.Eye"), ["a.far.away.Eye", "a.Eye"], "nearly this package");
    assert_eq!(registry.nearest("Eye1"), ["a.Eye", "a.far.away.Eye"], "spelt alike without its package");
    assert_eq!(registry.nearest("Glass"), ["a.GlassEye"], "the start of a name");
    assert!(registry.nearest("Wheel").is_empty());
    assert!(registry.nearest("x.").is_empty());
}

fn read_text(text: &str) -> String {
    let error = Registry::new().add_provided(text, Arc::new(Registration::of::<Eye>()));
    error.unwrap_err().to_string()
}

/// The error of a good declaration after `change`.
fn refused(change: impl FnOnce(&mut Value)) -> String {
    let mut declaration: Value = serde_json::from_str(Eye::DECLARATION).unwrap();
    change(&mut declaration);
    read_text(&declaration.to_string())
}

#[test]
fn a_malformed_declaration_is_refused_with_its_class() {
    let malformed = |what: &str| format!("the declaration of class `a.Eye` is malformed: {what}");
    assert_eq!(
        refused(|eye| eye["contract"] = json!(2)),
        "class `a.Eye` was built for contract 2, this program has contract 1: build both from one version"
    );
    assert!(refused(|eye| eye["kind"] = json!("sometimes")).contains("`a.Eye` is malformed: unknown variant"));
    assert!(refused(|eye| eye["properties"][0]["type"] = json!("colour")).contains("`colour` is not a type"));
    assert_eq!(
        refused(|eye| eye["properties"][1]["default"] = json!("7")),
        malformed("the default of property `reach`: `7` is out of range: expected a number from 0.0 to below 1.0 [m]")
    );
    assert_eq!(
        refused(|eye| eye["properties"][2]["min"] = json!("soon")),
        malformed("the bound `soon` of property `patience` is not a duration")
    );
    assert_eq!(
        refused(|eye| {
            eye["properties"][1]["default"] = json!(null);
            eye["properties"][1]["min"] = json!("9.5");
        }),
        malformed(
            "property `reach` can have no value: `9.5` is out of range: expected a number from 9.5 to below 1.0 [m]"
        )
    );
    assert_eq!(
        refused(|eye| eye["properties"][1]["name"] = json!("number")),
        malformed("property `number` is declared twice")
    );
    assert_eq!(
        refused(|eye| eye["also"][0]["preset"] = json!({"numbr": "1"})),
        malformed("`a.Eye001` presets `numbr`, which is not a property")
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
    let error = read_text("{ this is no JSON, and longer than can be shown");
    assert!(error.starts_with("the declaration of class `{ this is no JSON, and longer than can b` is malformed:"));
}

fn loops() -> Value {
    let entry = |name: &str, effector| json!({"name": name, "type": "bool", "effector": effector});
    json!({
        "contract": 1, "class": "c.Cart", "kind": "periodic",
        "properties": [{"name": "mood", "type": "enumeration", "default": "calm", "allowed": ["calm", "wild"]}],
        "knowledge": {"name": "c.Cart", "entries": [entry("busy", false), entry("stopped", true)]},
        "loops": {"property": "mood", "lists": {"calm": ["c.Driver", "c.Saver"], "wild": ["c.Driver"]}}
    })
}

#[test]
fn who_speaks_has_to_be_an_integer_field_and_a_number_or_a_text() {
    let refused = |speaker: Value, kind: &str| {
        let schema = json!({"name": "Said", "fields": [{"name": "who", "type": "uint32"}, {"name": "what", "type": "string"},
            {"name": "stage", "type": {"enumeration": "uint8", "values": {"REQUEST": 0, "ANSWER": 1}}}]});
        let class = json!({
            "contract": 1, "class": "d.Speaker", "kind": "passive",
            "properties": [{"name": "id", "type": kind, "required": true, "speaker": true}],
            "publishes": [{"topic": "SAID", "kind": "event", "message": "Said", "schema": schema, "speakers": [speaker]}]
        });
        let added = Registry::new().add_provided(&class.to_string(), Arc::new(Registration::of::<Eye>()));
        let head = "the declaration of class `d.Speaker` is malformed: ";
        added.map_or_else(|error| error.to_string().replace(head, ""), |()| "fits".to_owned())
    };
    for (speaker, kind, words) in [
        (json!({"field": "who", "unless": {"stage": "REQUEST"}}), "string", "fits"),
        (json!({"field": "who", "only": {"stage": "ANSWER"}, "instead": "ask"}), "integer", "fits"),
        (json!({"field": "whom"}), "string", "topic `SAID`: `speakers` names `whom`, which is not a field of `Said`"),
        (
            json!({"field": "what"}),
            "string",
            "topic `SAID`: `speakers` names `what` of `Said`, which is not an integer",
        ),
        (
            json!({"field": "who", "unless": {"stage": "Request"}}),
            "string",
            "topic `SAID`: `speakers` names `Request`, which is not a constant of `stage` of `Said`",
        ),
        (json!({"field": "who"}), "float", "property `id` cannot be `speaker`: it is neither one integer nor one text"),
    ] {
        assert_eq!(refused(speaker, kind), words);
    }
}

fn driver() -> Value {
    json!({"contract": 1, "loop": "c.Driver", "knowledge": "c.Cart", "senses": ["busy"], "effects": ["stopped"]})
}

fn saver() -> Value {
    json!({
        "contract": 1, "loop": "c.Saver", "senses": ["busy"], "effects": ["busy"],
        "entries": [{"name": "saved", "type": "uint32", "value": "integer"}]
    })
}

/// The error of a registry about two loops and a class that has them.
fn refused_loops(change: impl FnOnce(&mut Value, &mut Value, &mut Value)) -> String {
    let (mut class, mut driver, mut saver) = (loops(), driver(), saver());
    change(&mut class, &mut driver, &mut saver);
    let mut registry = Registry::new();
    for text in [driver, saver] {
        if let Err(error) = registry.add_loop_provided(&text.to_string(), Arc::new(Nowhere)) {
            return error.to_string();
        }
    }
    let added = registry.add_provided(&class.to_string(), Arc::new(Registration::of::<Eye>()));
    added.map_or_else(|error| error.to_string(), |()| "fits".to_owned())
}

#[derive(Debug)]
struct Nowhere;

impl LoopProvider for Nowhere {
    fn construct(&self, _: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynLoop>, Failure> {
        Err("nowhere".into())
    }

    fn origin(&self) -> Option<&std::path::Path> {
        None
    }
}

#[test]
fn loops_of_a_class_have_to_fit_together() {
    let of_class = |what: &str| format!("the declaration of class `c.Cart` is malformed: {what}");
    let not_together = |what: &str| of_class(&format!("its loops for `calm` do not fit together: {what}"));
    assert_eq!(refused_loops(|_, _, _| {}), "fits");
    assert_eq!(
        refused_loops(|_, _, saver| saver["effects"] = json!(["stopped"])),
        not_together("`c.Driver` and `c.Saver` both effect `stopped`")
    );
    assert_eq!(
        refused_loops(|_, _, saver| saver["senses"] = json!(["bussy"])),
        not_together("`c.Saver` senses `bussy`, and there is no such entry")
    );
    assert_eq!(
        refused_loops(|_, _, saver| saver["entries"][0]["name"] = json!("busy")),
        not_together("`c.Saver` adds the entry `busy`, which the class has already")
    );
    assert_eq!(
        refused_loops(|_, driver, _| driver["knowledge"] = json!("c.Boat")),
        not_together("`c.Driver` works on another knowledge")
    );
    let reference = |interface: &str| json!([{"name": "gps", "interface": {"name": interface, "operations": []}}]);
    assert_eq!(
        refused_loops(|class, driver, saver| {
            driver["references"] = reference("a.Gps");
            saver["references"] = reference("b.Gps");
            class["references"] = json!([]);
        }),
        not_together("`c.Saver` and `c.Driver` have different references `gps`")
    );
    assert_eq!(
        refused_loops(|_, _, saver| saver["properties"] = json!([{"name": "x", "type": "float", "required": true}])),
        of_class("its loop `c.Saver` has to be given `x`")
    );
    assert_eq!(
        refused_loops(|class, _, _| class["loops"]["lists"]["calm"] = json!(["c.Saver", "d.Saver"])),
        of_class("loop `Saver` is declared twice")
    );
    assert_eq!(
        refused_loops(|class, _, _| class["loops"]["lists"]["merry"] = json!([])),
        of_class("its loops are chosen by `mood`, which cannot be `merry`")
    );
    assert_eq!(
        refused_loops(|_, driver, saver| *driver = saver.clone()),
        "fits",
        "the very same loop twice is one, and loops that are not there yet are not looked at"
    );
    assert_eq!(
        refused_loops(|_, driver, saver| {
            *driver = saver.clone();
            driver["doc"] = json!("another");
        }),
        "loop `c.Saver` is registered twice"
    );
    assert_eq!(
        refused_loops(|class, _, _| class["class"] = json!("c.Saver")),
        "the name `c.Saver` is used by loop `c.Saver` and by class `c.Saver`"
    );
    assert_eq!(
        refused_loops(|_, _, saver| saver["loop"] = json!("c.")),
        "the declaration of loop `c.` is malformed: the loop has no name"
    );
}
