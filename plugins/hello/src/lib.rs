//! The smallest plugin: a component that greets in each period.

use saoms_api::{Class, Component, Context, Failure, Own, info};

/// A greeter, which logs a greeting in each period.
#[derive(Debug, Class)]
#[class(name = "hello.Greeter", periodic)]
pub struct Greeter {
    /// Name to greet.
    #[property(default = "world")]
    name: String,
}

impl Component for Greeter {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        info!(context, "hello, {}", self.name);
        Ok(())
    }
}

saoms_api::plugin! {
    classes: [Greeter],
}
