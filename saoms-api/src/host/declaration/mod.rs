//! The declaration of a class: one JSON text, made while it is compiled.
//!
//! The registry, the checker, editors and documentation know a component by this text alone, whether it is linked in or
//! lies in a library that is not loaded yet. `#[derive(Class)]` writes it; this is its shape, in the words of the
//! derives.
//!
//! # A class
//! ```json
//! {
//!   "contract": 1,
//!   "class": "saoms.Robot",
//!   "doc": "A robot that carries luggage.",
//!   "kind": "periodic",
//!   "also": [{"class": "robot.Robot001", "preset": {"number": "1"}}],
//!   "properties": [],
//!   "publishes": [{"topic": "POSTOPIC", "kind": "state", "message": "Position",
//!                  "schema": {"name": "Position", "fields": []}}],
//!   "subscribes": [],
//!   "services": [{"name": "move", "interface": {"name": "resources.robotEnvironment.Robot", "operations": []}}],
//!   "references": [{"name": "world", "interface": {"name": "saoms.World", "operations": []},
//!                   "optional": true, "many": true}],
//!   "stops": true,
//!   "reacts": true,
//!   "apart": true,
//!   "saves": true,
//!   "knowledge": {"name": "saoms.Robot", "entries": []},
//!   "loops": {"property": "policy", "lists": {"safe": ["saoms.CollisionMS"], "classic": []}},
//!   "extends": {"contract": 1, "class": "saoms.Machine", "kind": "periodic"}
//! }
//! ```
//! - `contract` is the version of this shape.
//! - `kind` is `periodic` or `passive`. A periodic class has the properties of a task beside its own, which are not
//!   listed.
//! - `also` are further names of the class; the properties in `preset` have these texts, as if the composite had set
//!   them.
//! - The `kind` of a topic is `state` or `event`; its name is the one before any `topicRename`. `"optional": true` in
//!   one that is published declares that it needs no reader.
//! - `"speakers": [{"field": "robot", "only": {"stage": "TAKEN"}, "unless": {"stage": "SEEN"}, "instead": "..."}]` in a
//!   topic names the integer fields that say who speaks, and the constants of enumerations with which they do. A
//!   message from outside in the name of a component that publishes the topic is refused; `instead` ends the sentence
//!   that says what to do. It is no part of the schema: two ends need not agree in it.
//! - `stops`, where it is `true`: its components register functions that stop their hardware.
//! - `reacts`, where it is `true`: its components have a function for messages that trigger them.
//! - `apart`, where it is `true`: its components never run on the thread of the timer.
//! - `saves`, where it is `true`: its components can save their state after each execution.
//! - `knowledge` is what its loops work on, and `loops` names those that it has unless a composite changes them, in
//!   their order: either `{"default": [...]}`, or one list for each value of a property. A class without loops has
//!   neither.
//! - `extends` is the whole declaration of the class that this one extends; absent where there is none. The class has
//!   the topics, services and references of that one, too, and its knowledge and loops; it has neither `knowledge` nor
//!   `loops` itself. `properties` are all of its own.
//! - `doc`, here and below, is absent where the author wrote none.
//!
//! # A loop
//! ```json
//! {
//!   "contract": 1,
//!   "loop": "saoms.CollisionMS",
//!   "doc": "Gives way.",
//!   "knowledge": "saoms.Robot",
//!   "properties": [],
//!   "senses": ["block", "next"],
//!   "effects": ["stopAPeriod"],
//!   "entries": [{"name": "waits", "type": "uint32", "value": "integer", "doc": "For how long it has waited.",
//!                "unit": "executions"}],
//!   "publishes": [],
//!   "subscribes": [],
//!   "references": []
//! }
//! ```
//! - What follows the last dot of the name is the name of the loop within a component, unless the composite gives
//!   another.
//! - `knowledge` is absent for a loop that works on any knowledge that has the entries which it senses and effects.
//! - `direct` is `true` for a loop that works on the struct of the knowledge and not entry by entry: it can work in
//!   components alone whose class is built into the same library.
//! - `entries` are those that it adds to the knowledge; it may change them without saying so under `effects`.
//! - Its topics and references are those of the component that has the loop.
//!
//! # An entry
//! | member | meaning |
//! | --- | --- |
//! | `name` | unique in the knowledge |
//! | `type` | a type of schemas, see below |
//! | `value` | `bool`, `integer`, `number`, `pair` or `word`: it is a single value; absent where it crosses a boundary as CDR alone |
//! | `doc`, `unit` | for people |
//! | `effector` | `true`: of the loops of a component only one may change it |
//! | `quiet` | `true`: its changes are not written to the journal |
//!
//! An entry is known by its place: those of the knowledge in order, then those that loops add, loop by loop.
//!
//! # A property
//! | member | meaning |
//! | --- | --- |
//! | `name` | as the composite writes it |
//! | `type` | the name of a [`PropertyKind`] |
//! | `doc`, `unit` | for people |
//! | `min`, `max`, `exclusiveMax` | numbers, or texts where the type is `duration`; integers without a range have the bounds of their Rust type |
//! | `default` | the text that counts when the composite gives none |
//! | `required` | `true`: it has to be given |
//! | `allowed` | the only texts, for enumerations and some strings |
//! | `nonEmpty` | `true`: the text must not be empty or blank |
//! | `live` | `true`: it can be changed while the component runs |
//! | `many` | `true`: any number of values; everything else applies to each |
//! | `unique` | a word: no two components have the same value for properties with this word |
//! | `speaker` | `true`: it says as whom the component speaks; a number counts before the digits at the end of a text |
//! | `properties` | those of a `complex` one |
//!
//! Fields that do not apply are absent. [`Rule`] defines exactly which texts a scalar property accepts, for the checker
//! and the component alike.
//!
//! # A schema
//! The schema of a message is `{"name", "fields": [{"name", "type"}]}`, with `"key"`, the name of a field, where a
//! state topic keeps one message for each value of that field, `"place"`, the name of the field that is its block, and
//! `"constants": [{"name", "type", "value"}]` where the message has such. A type is one of
//!
//! | type | meaning |
//! | --- | --- |
//! | `"bool"`, `"int8"` to `"int64"`, `"uint8"` to `"uint64"`, `"float32"`, `"float64"`, `"string"` | the types of ROS 2 interfaces |
//! | `"time"` | a time of the run: a `uint64`, in nanoseconds since its start, and since 1970 on a network |
//! | `{"sequence": type}` | any number of these |
//! | `{"array": type, "length": 36}` | as many of these |
//! | `{"bounded": type, "most": 10}` | a string of at most so many bytes, or a sequence of at most so many elements |
//! | `{"optional": type}` | one of these or none; encoded as a sequence of at most one |
//! | `{"enumeration": "uint8", "values": {"LANDING": 0}}` | an integer with named constants |
//! | `{"name", "fields"}` | a nested message |
//!
//! Schemas carry no docs, so that equal text means equal encoding: see [`crate::host::cdr`].
//!
//! # An interface
//! `{"name", "operations": [{"name", "arguments": [{"name", "type"}], "reply": type}]}`; the reply is `null` where
//! there is none. The number of an operation is its place. Arguments are encoded like the fields of a message.

mod bound;
mod kind;
mod rule;
mod scalar;
mod text;

/// The part of a topic's declaration that marks it as [optional](crate::Topic::optional).
pub const fn optional_topic(is_optional: bool) -> ConstText {
    match is_optional {
        true => ConstText::Plain(",\"optional\":true"),
        false => ConstText::EMPTY,
    }
}

/// What stands before the [fields that say who speaks](crate::Message::SPEAKERS) in the declaration of a topic.
pub const fn speakers_of_topic(speakers: &str) -> ConstText {
    match speakers.is_empty() {
        true => ConstText::EMPTY,
        false => ConstText::Plain(",\"speakers\":"),
    }
}

pub use crate::property::PropertyShape;
pub use bound::Bound;
pub use kind::PropertyKind;
pub use rule::Rule;
pub(crate) use scalar::trim;
pub use scalar::{Integer, Scalar, parse_scalar};
pub(crate) use text::escape;
pub use text::{ConstText, text};
