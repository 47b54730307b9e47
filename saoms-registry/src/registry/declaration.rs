//! Declarations of classes, read from text (see [`saoms_api::host::declaration`]).

use std::sync::{Arc, LazyLock};

use saoms_api::TaskInterface;
use saoms_api::host::declaration::{Bound, PropertyKind, Rule, Scalar};
use saoms_api::host::{Interface, PropertyValue, TopicKind};
use serde::Deserialize;
use serde::de::{Deserializer, Error};
use serde_json::Value;
use smol_str::SmolStr;

use super::{DefaultLoops, KnowledgeDeclaration, SpeakerField};

/// All that a class declares.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ClassDeclaration {
    /// The name that composite files use.
    #[serde(rename = "class")]
    pub name: String,
    /// The purpose of the class.
    #[serde(default)]
    pub doc: String,
    /// Periodic or passive.
    pub kind: ClassKind,
    /// Further names.
    #[serde(default)]
    pub also: Vec<Alias>,
    /// Its own properties in order; the task properties of a periodic class are not among them.
    #[serde(default)]
    pub properties: Vec<PropertyDeclaration>,
    /// The topics it publishes.
    #[serde(default)]
    pub publishes: Vec<ClassTopic>,
    /// The topics it subscribes to.
    #[serde(default)]
    pub subscribes: Vec<ClassTopic>,
    /// The events that it takes from outside the fleet.
    #[serde(default)]
    pub takes: Vec<TakenEvent>,
    /// The services it implements; [`ClassDeclaration::offers`] also has what the host serves for it.
    #[serde(default)]
    pub services: Vec<ServiceDeclaration>,
    /// The references it can call through.
    #[serde(default)]
    pub references: Vec<ReferenceDeclaration>,
    /// True if its components can react to messages at once.
    #[serde(default)]
    pub reacts: bool,
    /// True if its components never run on the thread of the timer.
    #[serde(default)]
    pub apart: bool,
    /// True if its components execute between those of others: half a period later, where a composite gives no `delay`.
    #[serde(default)]
    pub alternates: bool,
    /// True if its components can save their state after each execution.
    #[serde(default)]
    pub saves: bool,
    /// True if its components register functions that stop their hardware.
    #[serde(default)]
    pub stops: bool,
    /// The knowledge of its loops; `None` for a class without loops.
    pub knowledge: Option<KnowledgeDeclaration>,
    /// The loops that its components have unless a composite says otherwise.
    #[serde(default)]
    pub loops: DefaultLoops,
    /// The names of the classes that it extends, the nearest first. What they have is among the above.
    #[serde(skip)]
    pub extends: Vec<String>,
}

/// The kind of a class: periodic or passive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ClassKind {
    /// In each period; such a class has the task properties.
    Periodic,
    /// Never: only called.
    Passive,
}

/// A further name of a class.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Alias {
    /// The name.
    #[serde(rename = "class")]
    pub name: String,
    /// Values for properties that the composite does not give.
    #[serde(default)]
    pub preset: std::collections::BTreeMap<String, String>,
}

/// A property.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct PropertyDeclaration {
    /// Its name.
    pub name: String,
    /// Its type.
    #[serde(rename = "type", deserialize_with = "property_kind")]
    pub kind: PropertyKind,
    /// The purpose.
    #[serde(default)]
    pub doc: String,
    /// Its unit, where it has one.
    pub unit: Option<String>,
    /// The least value.
    #[serde(default, deserialize_with = "bound")]
    pub min: Option<String>,
    /// The greatest value.
    #[serde(default, deserialize_with = "bound")]
    pub max: Option<String>,
    /// The value below which it has to stay.
    #[serde(default, deserialize_with = "bound")]
    pub exclusive_max: Option<String>,
    /// The value that counts where the composite gives none.
    pub default: Option<String>,
    /// True if the composite has to give a value.
    #[serde(default)]
    pub required: bool,
    /// The texts that are allowed; empty where all are.
    #[serde(default)]
    pub allowed: Vec<String>,
    /// True if the text must not be empty.
    #[serde(default)]
    pub non_empty: bool,
    /// True if it can be changed while the component runs.
    #[serde(default)]
    pub live: bool,
    /// True if its value is a secret, which nothing prints.
    #[serde(default)]
    pub secret: bool,
    /// True if it takes any number of values.
    #[serde(default)]
    pub many: bool,
    /// The word that it shares with all properties of the fleet that must not have its value, too.
    pub unique: Option<String>,
    /// True if it says as whom the component speaks: as its number, or as the digits at the end of its text.
    #[serde(default)]
    pub speaker: bool,
    /// The language of its text (see [`PropertyLanguage`](saoms_api::extension::PropertyLanguage)).
    pub language: Option<String>,
    /// The words of the language whose events the class plays itself.
    #[serde(default)]
    pub plays: Vec<String>,
    /// The properties of a complex one.
    #[serde(default)]
    pub properties: Vec<PropertyDeclaration>,
}

impl PropertyDeclaration {
    /// Reads one value and checks it.
    ///
    /// # Errors
    /// An error says what was found and what was expected, in one line.
    pub fn check(&self, text: impl Into<SmolStr>) -> Result<Scalar, String> {
        self.with_rule(|rule| rule.check(text))
    }

    /// The values at both ends of what it allows; `None` where it has none.
    pub fn ends(&self) -> Option<[PropertyValue; 2]> {
        /// Numbers beyond this are as good as this: constructors may make room for them.
        const LARGE: f64 = 1_000_000.0;
        let both = |least: &str, most: &str| {
            let value = |text: &str| self.check(text).ok().map(PropertyValue::from);
            Some([value(least)?, value(most)?])
        };
        match (self.kind, &self.allowed[..]) {
            _ if self.many => None,
            (_, [first, .., last]) => both(first, last),
            (PropertyKind::Boolean, _) => both("false", "true"),
            _ if !self.is_number() => None,
            _ => match self.max.as_deref()? {
                most if most.parse().is_ok_and(|number: f64| number > LARGE) => {
                    both(self.min.as_deref()?, &LARGE.to_string())
                }
                most => both(self.min.as_deref()?, most),
            },
        }
    }

    /// True if it is a number or a duration.
    pub fn is_number(&self) -> bool {
        matches!(self.kind, PropertyKind::Integer | PropertyKind::Float | PropertyKind::Duration)
    }

    /// The expected value in words, as in `a whole number from 1 to 99 [%]`.
    pub fn expected(&self) -> String {
        if self.kind == PropertyKind::Complex {
            let names: Vec<&str> = self.properties.iter().map(|inner| inner.name.as_str()).collect();
            return format!("the properties {}", names.join(", "));
        }
        self.with_rule(|rule| rule.expected())
    }

    fn bound<'t>(&self, text: &'t Option<String>) -> Option<Bound<'t>> {
        Bound::read(self.kind, text.as_deref()?)
    }

    fn with_rule<R>(&self, ask: impl FnOnce(&Rule<'_>) -> R) -> R {
        // Few have any.
        let allowed = match &self.allowed[..] {
            [] => Vec::new(),
            allowed => allowed.iter().map(String::as_str).collect(),
        };
        ask(&Rule {
            kind: self.kind,
            min: self.bound(&self.min),
            max: self.bound(&self.max),
            exclusive_max: self.bound(&self.exclusive_max),
            unit: self.unit.as_deref(),
            allowed: &allowed,
            non_empty: self.non_empty,
        })
    }
}

/// A topic that a class publishes or subscribes to.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ClassTopic {
    /// Its name before any `topicRename`.
    #[serde(rename = "topic")]
    pub name: String,
    /// State or event.
    #[serde(deserialize_with = "topic_kind")]
    pub kind: TopicKind,
    /// The name of the message type.
    pub message: String,
    /// The schema of the message type: two ends agree when these are equal.
    #[serde(deserialize_with = "schema")]
    pub schema: Arc<Value>,
    /// True if its publishers need no reader.
    #[serde(default)]
    pub optional: bool,
    /// The fields of its messages that say who speaks.
    #[serde(default)]
    pub speakers: Vec<SpeakerField>,
}

/// An event that a class takes from outside the fleet.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct TakenEvent {
    /// Its name.
    pub event: String,
    /// The topic, among those to which the class subscribes, by whose messages it comes.
    pub topic: String,
    /// Its meaning.
    #[serde(default)]
    pub doc: String,
}

/// A service.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ServiceDeclaration {
    /// Its name.
    pub name: String,
    /// Its interface.
    pub interface: InterfaceDeclaration,
}

/// A reference.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct ReferenceDeclaration {
    /// Its name.
    pub name: String,
    /// Its interface.
    pub interface: InterfaceDeclaration,
    /// True if a component works without a target for it: multiplicity `0..` rather than `1..`.
    #[serde(default)]
    pub optional: bool,
    /// True if it takes any number of targets: multiplicity `..n` rather than `..1`.
    #[serde(default)]
    pub many: bool,
}

/// An interface: two ends agree when these are equal.
#[derive(Clone, Debug, Deserialize)]
#[serde(from = "InterfaceFields")]
pub struct InterfaceDeclaration {
    /// The name that composite files use.
    pub name: String,
    /// The operations with their argument and reply types.
    pub operations: Value,
    /// The operations as text: each wire of a fleet compares them, which is quicker with one text than part by part.
    text: String,
}

#[derive(Deserialize)]
struct InterfaceFields {
    name: String,
    operations: Value,
}

impl From<InterfaceFields> for InterfaceDeclaration {
    fn from(InterfaceFields { name, operations }: InterfaceFields) -> Self {
        Self { text: operations.to_string(), name, operations }
    }
}

impl InterfaceDeclaration {
    /// In words, how an interface of this name whose operations differ from those of this one does so.
    pub fn difference(&self, other: &InterfaceDeclaration) -> String {
        let of = |one: &InterfaceDeclaration| one.operations.as_array().cloned().unwrap_or_default();
        let (own, others) = (of(self), of(other));
        let Some(place) = (0..own.len().max(others.len())).find(|place| own.get(*place) != others.get(*place)) else {
            return "its operations differ".to_owned();
        };
        match (own.get(place), others.get(place)) {
            (Some(own), None) => format!("it has no operation `{}`", signature(own)),
            (None, Some(other)) => format!("it also has the operation `{}`", signature(other)),
            (Some(own), Some(other)) if signature(own) != signature(other) => {
                format!("its operation is `{}`, expected `{}`", signature(other), signature(own))
            }
            (Some(own), _) => format!("a type in its operation `{}` has other fields", signature(own)),
            (None, None) => String::new(),
        }
    }
}

/// An operation as authors write it: `where(robot: uint32) -> Block`.
pub fn signature(operation: &Value) -> String {
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let arguments = operation["arguments"].as_array().into_iter().flatten();
    let arguments: Vec<String> =
        arguments.map(|one| format!("{}: {}", word(&one["name"]), type_name(&one["type"]))).collect();
    let reply = match type_name(&operation["reply"]) {
        none if none.is_empty() => none,
        reply => format!(" -> {reply}"),
    };
    format!("{}({}){reply}", word(&operation["name"]), arguments.join(", "))
}

/// The short form of a type of schemas: `int32`, `sequence of Block`.
pub fn type_name(value: &Value) -> String {
    let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    type_words(value, &|value| match (value.get("name"), value.get("enumeration")) {
        (Some(name), _) => word(name),
        (_, Some(of)) => format!("one of a {} enumeration", word(of)),
        _ => word(value),
    })
}

/// A type of schemas in words, where `name` gives those of a type that is not made of another one.
pub fn type_words(value: &Value, name: &dyn Fn(&Value) -> String) -> String {
    let Some(inner) = inner_type(value) else { return name(value) };
    if let (Some(most), Some(element)) = (value.get("most"), inner.get("sequence")) {
        return format!("sequence of at most {most} {}", type_words(element, name));
    }
    let words = type_words(inner, name);
    match (value.get("sequence"), value.get("length"), value.get("most")) {
        (Some(_), ..) => format!("sequence of {words}"),
        (_, Some(length), _) => format!("array of {length} {words}"),
        (.., Some(most)) => format!("{words} of at most {most} bytes"),
        _ => format!("{words}, or none"),
    }
}

/// The type of the elements of a sequence, of an array and so on; `None` for a type that is not made of another one.
pub fn inner_type(value: &Value) -> Option<&Value> {
    ["optional", "sequence", "array", "bounded"].into_iter().find_map(|kind| value.get(kind))
}

impl PartialEq for InterfaceDeclaration {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.text == other.text
    }
}

/// The service that the host serves for every component of a periodic class.
#[expect(clippy::expect_used, reason = "the declaration is a constant, which every test of the checker reads")]
static TASK_SERVICE: LazyLock<ServiceDeclaration> = LazyLock::new(|| ServiceDeclaration {
    name: "TaskInterface".to_owned(),
    // Proof: the macro writes the text while `saoms-api` compiles, and no input reaches it; any test that registers a
    // periodic class reads it.
    interface: serde_json::from_str(<dyn TaskInterface as Interface>::DECLARATION)
        .expect("the interface declares itself in JSON"),
});

impl ClassDeclaration {
    /// True if components of it are executed in each period.
    pub fn is_periodic(&self) -> bool {
        self.kind == ClassKind::Periodic
    }

    /// The services that components of it offer: its own, and `TaskInterface` of a periodic class, which the host
    /// serves.
    pub fn offers(&self) -> impl Iterator<Item = &ServiceDeclaration> {
        let own = |service: &ServiceDeclaration| service.name == TASK_SERVICE.name;
        let task = (self.is_periodic() && !self.services.iter().any(own)).then(|| &*TASK_SERVICE);
        self.services.iter().chain(task)
    }

    /// The loops of a component that has these values, unless its composite says otherwise.
    pub fn loops_of(&self, values: &[(SmolStr, PropertyValue)]) -> &[String] {
        let chosen =
            self.loops.property.as_ref().and_then(|property| match values.iter().find(|(name, _)| name == property) {
                Some((_, PropertyValue::Scalar(value))) => Some(value.text()),
                _ => self.property(property)?.default.as_ref().map(SmolStr::from),
            });
        self.loops.of(chosen.as_deref())
    }

    /// The number as which a component with these values speaks: that of the first property that says so and has a
    /// number, or else the digits at the end of the first that has a text. `None` if its class declares none.
    pub fn speaker(&self, values: &[(SmolStr, PropertyValue)]) -> Option<i128> {
        let named = self.properties.iter().filter(|property| property.speaker);
        let given = named.filter_map(|property| match values.iter().find(|(name, _)| *name == property.name) {
            // Its type may not have been read yet.
            Some((_, PropertyValue::Scalar(Scalar::Text(text)))) => property.check(text.clone()).ok(),
            Some((_, PropertyValue::Scalar(value))) => Some(value.clone()),
            _ => property.check(property.default.as_ref()?).ok(),
        });
        let given: Vec<Scalar> = given.collect();
        let number = |value: &Scalar| if let Scalar::Integer(number) = value { Some(number.get()) } else { None };
        given.iter().find_map(number).or_else(|| {
            let text = given.iter().find_map(Scalar::as_text)?.trim();
            text[text.trim_end_matches(|sign: char| sign.is_ascii_digit()).len()..].parse().ok()
        })
    }

    /// Its property of this name.
    pub fn property(&self, name: &str) -> Option<&PropertyDeclaration> {
        self.properties.iter().find(|property| property.name == name)
    }
}

impl ServiceDeclaration {
    /// True if the host serves it, not the component.
    pub fn is_of_host(&self) -> bool {
        std::ptr::eq(self, &*TASK_SERVICE)
    }
}

fn property_kind<'de, D: Deserializer<'de>>(from: D) -> Result<PropertyKind, D::Error> {
    let name = String::deserialize(from)?;
    PropertyKind::from_name(&name).ok_or_else(|| D::Error::custom(format!("`{name}` is not a type of properties")))
}

fn topic_kind<'de, D: Deserializer<'de>>(from: D) -> Result<TopicKind, D::Error> {
    let name = String::deserialize(from)?;
    let kinds = [TopicKind::State, TopicKind::Event];
    let found = kinds.into_iter().find(|kind| kind.name() == name);
    found.ok_or_else(|| D::Error::custom(format!("`{name}` is neither `state` nor `event`")))
}

fn schema<'de, D: Deserializer<'de>>(from: D) -> Result<Arc<Value>, D::Error> {
    Value::deserialize(from).map(Arc::new)
}

/// A bound as text: numbers are written as numbers, durations as text.
fn bound<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
    match Value::deserialize(from)? {
        Value::Null => Ok(None),
        Value::Number(number) => Ok(Some(number.to_string())),
        Value::String(text) => Ok(Some(text)),
        other => Err(D::Error::custom(format!("`{other}` is not a bound of a range"))),
    }
}
