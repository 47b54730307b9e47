//! The message broker of the manual's figure 6.25.

use saoms_api::extension::{RouterClass, submit};
use saoms_api::{Class, Component, Context, Failure, Properties, interface};

/// Service by which other components learn where the broker is.
#[interface(name = "unibg.robotics.tca.MessageBroker")]
pub trait MessageBrokerInterface {
    /// The address as the property `url` of a task names it.
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
    /// The transport, as the `url` of the tasks names it before `://`; without one, that for `host:port`.
    transport: Option<String>,
}

/// Carries the topics of all tasks whose `url` names this broker, in this program and in others: the program listens at
/// its address.
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
        let transport = properties.transport.as_deref().map(str::trim).filter(|transport| !transport.is_empty());
        let transport = transport.map(|transport| format!("{transport}://")).unwrap_or_default();
        Ok(MessageBroker { address: format!("{transport}{}:{}", properties.host.trim(), properties.port) })
    }
}

submit! {
    RouterClass {
        class: "saoms.MessageBroker",
        address: |values| Ok(MessageBroker::new(MessageBrokerProperties::from_values(values)?)?.address),
    }
}

impl MessageBrokerInterface for MessageBroker {
    fn address(&mut self, _context: &mut Context<'_>) -> Result<String, Failure> {
        Ok(self.address.clone())
    }
}
