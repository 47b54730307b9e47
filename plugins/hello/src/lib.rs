//! The smallest plugin: a component that greets in each period.

use saoms_api::{Class, Component, Context, Failure, Properties};

/// Properties of a greeter.
#[derive(Debug, Properties)]
pub struct GreeterProperties {
    /// Name to greet.
    #[property(default = "world")]
    name: String,
}

/// A greeter, which logs a greeting in each period.
#[derive(Debug, Class)]
#[class(name = "hello.Greeter", periodic)]
pub struct Greeter {
    properties: GreeterProperties,
}

impl Component for Greeter {
    type Properties = GreeterProperties;

    fn new(properties: GreeterProperties) -> Result<Self, Failure> {
        Ok(Greeter { properties })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.info(format_args!("hello, {}", self.properties.name));
        Ok(())
    }
}

saoms_api::plugin! {
    classes: [Greeter],
}
