//! Events that classes take from outside the fleet: `fire at=(3,4) size=2 to Hall1`.
//!
//! A class takes an event at a subscription: the event has a name, and its fields are those of the message.
//!
//! ```
//! use saoms_api::{Class, Component, Context, Failure, Message, Subscription, Topic, info};
//!
//! /// A fire.
//! #[derive(Clone, Debug, Message)]
//! pub struct Fire {
//!     /// Number of sprinklers that it needs.
//!     pub size: u8,
//! }
//!
//! pub const FIRE: Topic<Fire> = Topic::event("FIRE");
//!
//! /// Puts out fires.
//! #[derive(Class)]
//! #[class(name = "example.Sprinkler", periodic)]
//! struct Sprinkler {
//!     /// A fire breaks out.
//!     #[takes("fire", FIRE)]
//!     fires: Subscription<Fire>,
//! }
//!
//! impl Component for Sprinkler {
//!     type Properties = ();
//!
//!     fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
//!         for fire in context.receive(&self.fires) {
//!             info!(context, "puts out a fire of size {}", fire.size);
//!         }
//!         Ok(())
//!     }
//! }
//! ```
//!
//! Whoever plays events (a class with [`Context::raise`](crate::Context::raise), or `saoms run --events`) reads them as
//! an [`EventCall`], and judges them by the [`Events`] that are known.

mod call;
mod draw;
pub mod fault;
mod field;
mod known;
mod receiver;

pub use call::{Argument, EventCall, Word};
pub use field::{EventField, FieldType, FieldValue};
pub use known::{Event, Events, ORDERS, STOP, is_event_name};
pub use receiver::receiver;
