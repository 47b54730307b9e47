//! The message broker of the manual's figure 6.25.

use saoms_api::{Class, Component, Context, Failure, Properties, info, interface};

/// Service by which other components learn where the broker is.
#[interface(name = "unibg.robotics.tca.MessageBroker")]
pub trait MessageBrokerInterface {
    /// The address as `host:port`, which the property `url` of a task names.
    fn address(&mut self, context: &mut Context<'_>) -> Result<String, Failure>;
}

/// Properties of a message broker.
#[derive(Debug, Properties)]
pub struct MessageBrokerProperties {
    /// The name or address of the machine.
    #[property(name = "IP", default = "localhost", required_text)]
    host: String,
    /// The port.
    #[property(default = 61616, range = 1..=65535)]
    port: u16,
}

/// Carries the topics of all tasks whose `url` names this broker. The topics are served inside this process.
#[derive(Debug, Class)]
#[class(
    name = "saoms.MessageBroker",
    passive,
    service("MessageBroker": MessageBrokerInterface),
    also("unibg.robotics.tca.MessageBrokerImpl")
)]
pub struct MessageBroker {
    address: String,
}

impl Component for MessageBroker {
    type Properties = MessageBrokerProperties;

    fn new(properties: MessageBrokerProperties) -> Result<Self, Failure> {
        Ok(MessageBroker { address: format!("{}:{}", properties.host.trim(), properties.port) })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        info!(context, "serves the topics of {} inside this process", self.address);
        Ok(())
    }
}

impl MessageBrokerInterface for MessageBroker {
    fn address(&mut self, _context: &mut Context<'_>) -> Result<String, Failure> {
        Ok(self.address.clone())
    }
}
