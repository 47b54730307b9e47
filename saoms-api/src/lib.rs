//! The contract that authors of SAOMS components compile against.
//!
//! A component is a struct with properties that a composite file sets, topics that it publishes and reads, and services
//! that it offers and needs. It implements [`Component`]; `#[derive(Class)]` declares it to the program. Everything
//! from outside (messages, time, chance, the log, other components) reaches it through its [`Context`], so that the
//! same component runs in real time, in virtual time, in a test, linked in, or from a library that was built
//! separately.
//!
//! ```
//! use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Topic};
//!
//! /// What the thermometer measured.
//! #[derive(Clone, Debug, PartialEq, Message)]
//! pub struct Temperature {
//!     /// In degrees Celsius.
//!     pub degrees: f64,
//! }
//!
//! /// The newest measurement of each thermometer.
//! pub const TEMPERATURE: Topic<Temperature> = Topic::state("TEMPERATURE");
//!
//! /// Publishes the temperature in each period.
//! #[derive(Class)]
//! #[class(name = "example.Thermometer", periodic)]
//! pub struct Thermometer {
//!     /// Added to every measurement.
//!     #[property(default = 0.0, range = -5.0..=5.0, unit = "degrees Celsius")]
//!     offset: f64,
//!     #[publishes(TEMPERATURE)]
//!     temperature: Publisher<Temperature>,
//! }
//!
//! impl Component for Thermometer {
//!     type Properties = Own<Self>;
//!
//!     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
//!         context.send(&self.temperature, Temperature { degrees: 20.0 + self.offset })
//!     }
//! }
//! ```
//!
//! Nothing in this contract relies on sharing Rust types with a separately built library: declarations are text,
//! messages and service calls have a declared schema and a byte form ([CDR](host::cdr)) beside the shared value used
//! inside one build.

// So that the macros' paths lead here from inside, too.
extern crate self as saoms_api;

mod adaptation;
#[doc(hidden)]
pub mod boundary;
mod bounded;
pub mod builtin_interfaces;
mod chance;
mod component;
mod context;
pub mod event;
pub mod extension;
mod failure;
mod field;
mod finding;
pub mod host;
mod message;
mod property;
mod report;
pub mod rule;
mod service;
mod time;

pub use adaptation::{
    Adaptation, Cause, Effector, Entries, Entry, Extras, Knowledge, Loop, LoopClass, Loops, Record, Recordable,
    SavedLoops, SimpleLoop, Value,
};
pub use bounded::Bounded;
pub use chance::Chance;
pub use component::{Class, Component, Own, Saved, StopFunction, TaskInterface, TaskInterfaceReference};
pub use context::{Context, KeptByOther, Level};
pub use failure::{CallError, Failure};
pub use field::Field;
pub use finding::{Finding, Place};
pub use message::{Departed, Header, KnownPublisher, Message, Messages, Publisher, Region, Subscription, Topic};
pub use property::{Properties, PropertyField, Secret};
pub use report::{ReportValue, Work};
pub use time::Time;

pub use saoms_derive::{Class, Entries, Field, Knowledge, LoopClass, Message, Properties, PropertyField, interface};

/// For the code that the macros generate.
#[doc(hidden)]
pub mod generated {
    pub use crate::adaptation::{are_unique, decode_field, fits, joined, member, no_entry, set_field};
    pub use crate::boundary::{API, class_table, loop_class_table, rule_table};
    pub use crate::component::derived::{DefaultOf, Different, NoDefault, Same, no_update, parts};
    pub use crate::host::contain::install_hook;
    pub use crate::host::declaration::ConstText;
    pub use crate::message::{Key, is_pair, pair_of};
    pub use crate::property::{
        PropertyShape, Values, all_names, are_distinct, complex, contains, continued, count, default_fits, equal, flat,
        list, property, read, refuse_reserved, scalar,
    };
    pub use crate::rule::LinkedRule;
    pub use crate::service::{no_operation, no_service};
    pub use inventory;
    pub use saoms_abi::{ClassTable, LoopClassTable, PluginTable, RuleTable};
}
