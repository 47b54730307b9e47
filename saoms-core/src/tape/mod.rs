//! Tapes of components: all that a component got from its host and what it did, step by step, so that it can be run
//! again alone.
//!
//! A step is one call of a component's code. The [host](saoms_api::host::Host) is the one seam through which anything
//! reaches a component: `schedule/component/taped.rs` notes it there, for the components that an observer
//! [wants](crate::observe::Observer::wants_tape).

mod asked;
mod call;
mod deeds;
mod step;
mod values;

pub(crate) use asked::Tape;
pub(crate) use call::TapedCall;
pub(crate) use call::{answer_of, answered};
pub(crate) use deeds::{KeptForm, PublisherForm};
pub use step::{Act, ActKind, Heard, Step, StepKind};
pub(crate) use values::{loop_of_bytes, values_as_bytes, values_of_bytes, with_loop};
