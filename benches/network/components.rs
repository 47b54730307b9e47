//! The two ends of a network.

use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use saoms_api::{Class, Component, Context, Failure, Message, Properties, Publisher, Subscription, Topic};

/// Bytes of a message beside its time: 128 in all.
const REST: usize = 120;

/// A message of 128 bytes.
#[derive(Clone, Debug, Message)]
pub(crate) struct Sample {
    /// Wall clock of its sending, in nanoseconds.
    pub(crate) sent: u64,
    rest: [u8; REST],
}

/// A topic that loses nothing.
pub(crate) const SAMPLES: Topic<Sample> = Topic::event("BENCHMARK");

/// What arrived in this process.
#[derive(Debug, Default)]
pub(crate) struct Arrivals {
    /// From sending to arrival of each message, in nanoseconds.
    pub(crate) delays: Vec<u64>,
    /// Wall clock of the last arrival.
    pub(crate) last: u64,
}

pub(crate) static ARRIVALS: Mutex<Arrivals> = Mutex::new(Arrivals { delays: Vec::new(), last: 0 });

/// Notes messages that have arrived now.
pub(crate) fn note(sent: impl Iterator<Item = u64>) {
    let mut arrivals = ARRIVALS.lock().unwrap_or_else(PoisonError::into_inner);
    let now = wall_clock();
    arrivals.delays.extend(sent.map(|sent| now.saturating_sub(sent)));
    arrivals.last = now;
}

/// Wall clock, in nanoseconds since 1970: that of all processes of the machine.
pub(crate) fn wall_clock() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

/// Properties of a source.
#[derive(Properties)]
pub(crate) struct SourceProperties {
    /// Number of messages in each execution.
    messages: u32,
    /// Number of executions that send.
    executions: u32,
}

/// Sends messages in each execution.
#[derive(Class)]
#[class(name = "bench.Source", periodic, publishes(SAMPLES))]
pub(crate) struct Source {
    properties: SourceProperties,
    topic: Publisher<Sample>,
}

impl Component for Source {
    type Properties = SourceProperties;

    fn new(properties: SourceProperties) -> Result<Self, Failure> {
        Ok(Self { properties, topic: Publisher::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.topic = context.publish(&SAMPLES)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if let Some(left) = self.properties.executions.checked_sub(1) {
            self.properties.executions = left;
            for _ in 0..self.properties.messages {
                context.send(&self.topic, Sample { sent: wall_clock(), rest: [7; REST] })?;
            }
        }
        Ok(())
    }
}

/// Reads every message as soon as it arrives.
#[derive(Class)]
#[class(name = "bench.Sink", periodic, reacts, subscribes(SAMPLES))]
pub(crate) struct Sink {
    topic: Subscription<Sample>,
}

impl Component for Sink {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Self { topic: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.topic = context.subscribe(&SAMPLES)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        note(context.receive(&self.topic).map(|sample| sample.sent));
        Ok(())
    }

    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.execute(context)
    }
}
