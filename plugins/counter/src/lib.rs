//! A component with a period, a property that is checked, a message and a topic of its own, and a service.

use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Topic, interface};

/// A count.
#[derive(Clone, Debug, PartialEq, Message)]
pub struct Count {
    /// The number.
    pub number: u32,
}

/// The newest count of each counter.
pub const COUNT: Topic<Count> = Topic::state("COUNT");

/// A component that counts in steps.
#[derive(Class)]
#[class(name = "counter.Counter", periodic, service("numbers": Numbers))]
pub struct Counter {
    /// Number that is added in each period.
    #[property(default = 1, range = 1..=100)]
    step: u32,
    #[publishes(COUNT)]
    count: Publisher<Count>,
    number: u32,
}

impl Component for Counter {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.number += self.step;
        context.send(&self.count, Count { number: self.number })
    }
}

/// The count for callers.
#[interface(name = "counter.Numbers")]
impl Numbers for Counter {
    fn number(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        Ok(self.number)
    }
}

saoms_api::plugin! { classes: [Counter] }
