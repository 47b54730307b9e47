//! A master of the environment that does what the one that ships does, and asks for luggage by itself.

use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Finding, Own, Place, Publisher, Time, Work, info};
use saoms_components::grid::Block;
use saoms_components::master::MasterEnvironment;
use saoms_components::messages::{ENVIRONMENT, EnvironmentEvent, EventLuggage};

/// A master that asks for a piece of luggage again and again.
#[derive(Debug, Class)]
#[class(name = "my_plugin.MyPlugin", periodic)]
pub struct MyPlugin {
    /// The master that ships: its properties and topics are those of this class, too.
    #[extends]
    master: MasterEnvironment,
    /// Number of pieces that it asks for.
    #[property(default = 3, range = 1..=1000)]
    pieces: u32,
    /// Time from one piece to the next.
    #[property(default = "10s", range = "1ms"..)]
    every: Duration,
    /// Block where the luggage waits.
    #[property(default = "(3,1)")]
    from: String,
    /// Block where it has to be brought.
    #[property(default = "(3,10)")]
    to: String,
    #[publishes(ENVIRONMENT)]
    events: Publisher<EnvironmentEvent>,
    way: (Block, Block),
    asked: u32,
    start: Option<Time>,
}

impl Component for MyPlugin {
    type Properties = Own<Self>;

    fn new(properties: Own<Self>) -> Result<Self, Failure> {
        let mut master = Self::made(properties)?;
        let block = |name: &str, text: &str| {
            text.parse().map_err(|problem| Finding::new(Place::property(name), problem))
        };
        master.way = (block("from", &master.from)?, block("to", &master.to)?);
        Ok(master)
    }

    // What is not written here, as `initialize` and `shutdown`, is that of the master that ships.
    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.master.execute(context)?;
        // A run goes on while somebody has work left.
        context.vote(if self.asked < self.pieces { Work::Open } else { Work::Done });
        let start = *self.start.get_or_insert(context.due());
        if self.asked == self.pieces || context.due().since(start) < self.every * self.asked {
            return Ok(());
        }
        self.asked += 1;
        info!(context, "asks for luggage {}", self.asked);
        let luggage = vec![EventLuggage::request(self.asked, self.way.0, self.way.1)];
        // The master that ships hears this itself, as what any other component says.
        context.send(&self.events, EnvironmentEvent { luggage, ..EnvironmentEvent::default() })
    }
}

saoms_api::plugin! {
    classes: [MyPlugin],
}

#[cfg(test)]
mod tests {
    use super::*;
    use saoms_testkit::Bench;

    #[test]
    fn wrong_blocks_are_shown_at_their_property() {
        let failure = Bench::of::<MyPlugin>(&[("to", "3,10")]).err().unwrap();
        assert_eq!(failure.findings()[0].place().property_name(), Some("to"));
    }

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<MyPlugin>(&[]);
    }
}
