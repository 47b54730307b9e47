//! The two ends of a delivery.

use std::hint::black_box;
use std::sync::atomic::{AtomicU64, Ordering};

use saoms_api::{Class, Component, Context, Failure, Message, Properties, Publisher, Subscription, Topic};

/// A message of the size of a robot's position with its time.
#[derive(Clone, Debug, Message)]
pub(crate) struct Position {
    robot: u32,
    x: i32,
    y: i32,
    time: u64,
}

/// A topic that loses nothing.
pub(crate) const EVENTS: Topic<Position> = Topic::event("BENCHMARK");

/// Number of messages that arrived at all receivers together.
pub(crate) static RECEIVED: AtomicU64 = AtomicU64::new(0);

/// Properties of a sender.
#[derive(Properties)]
pub(crate) struct SenderProperties {
    /// Number of messages in each execution.
    messages: u32,
}

/// Sends messages in each execution.
#[derive(Class)]
#[class(name = "bench.Sender", periodic, publishes(EVENTS))]
pub(crate) struct Sender {
    messages: u32,
    topic: Publisher<Position>,
}

impl Component for Sender {
    type Properties = SenderProperties;

    fn new(properties: SenderProperties) -> Result<Self, Failure> {
        Ok(Self { messages: properties.messages, topic: Publisher::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.topic = context.publish(&EVENTS)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let time = context.now().as_nanos();
        for robot in 0..self.messages {
            context.send(&self.topic, Position { robot, x: 3, y: 10, time })?;
        }
        Ok(())
    }
}

/// Reads every message that arrived.
#[derive(Class)]
#[class(name = "bench.Receiver", periodic, subscribes(EVENTS))]
pub(crate) struct Receiver {
    topic: Subscription<Position>,
}

impl Component for Receiver {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Self { topic: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.topic = context.subscribe(&EVENTS)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let mut count = 0;
        for message in context.receive(&self.topic) {
            black_box((message.robot, message.x, message.y, message.time));
            count += 1;
        }
        // One thread writes, so that no read-modify-write is needed.
        RECEIVED.store(RECEIVED.load(Ordering::Relaxed) + count, Ordering::Relaxed);
        Ok(())
    }
}
