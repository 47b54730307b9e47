//! A component that counts, and publishes its count on a topic of its own.

use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Topic, info};

/// The count of a component.
#[derive(Clone, Debug, Default, PartialEq, Message)]
pub struct Count {
    /// The number.
    pub number: u32,
}

/// The newest number.
pub const COUNT: Topic<Count> = Topic::state("COUNT");

/// A component that counts.
#[derive(Debug, Class)]
#[class(name = "my_plugin.MyPlugin", periodic)]
pub struct MyPlugin {
    /// Number that is added in each period.
    #[property(default = 1, range = 1..=100)]
    step: u32,
    #[publishes(COUNT)]
    count: Publisher<Count>,
    number: u32,
}

impl Component for MyPlugin {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.number = self.number.wrapping_add(self.step);
        info!(context, "counts to {}", self.number);
        context.send(&self.count, Count { number: self.number })
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
    fn it_counts_in_steps() -> Result<(), Failure> {
        let mut counter = Bench::of::<MyPlugin>(&[("step", "5")])?;
        counter.start()?;
        counter.execute()?;
        counter.execute()?;
        assert_eq!(counter.sent(&COUNT), [Count { number: 10 }]);
        Ok(())
    }

    #[test]
    fn it_keeps_what_every_component_keeps() {
        saoms_testkit::comply::<MyPlugin>(&[]);
    }
}
