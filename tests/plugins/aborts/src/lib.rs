//! Is built with `panic = "abort"`.

use saoms_api::{Class, Component, Failure};

/// Says nothing.
#[derive(Debug, Class)]
#[class(name = "aborts.Quiet", periodic)]
pub struct Quiet;

impl Component for Quiet {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Quiet)
    }
}

saoms_api::plugin! {
    classes: [Quiet],
}
