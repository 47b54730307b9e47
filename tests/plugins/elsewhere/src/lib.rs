//! Sends and hears the messages of `good`, built with another copy of `saoms-api`.

use saoms_api::{Class, Component, Context, Failure, Message, Publisher, Subscription, Topic};

/// As `good` has it.
#[derive(Clone, Debug, Message)]
#[message(key = "number")]
pub struct Reading {
    number: u32,
    values: Vec<f64>,
    text: String,
}

const READINGS: Topic<Reading> = Topic::event("READINGS");

/// Sends a reading for each that it hears from others.
#[derive(Debug, Class)]
#[class(name = "elsewhere.Echo", periodic, publishes(READINGS), subscribes(READINGS))]
pub struct Echo {
    sent: Publisher<Reading>,
    heard: Subscription<Reading>,
}

impl Component for Echo {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Echo { sent: Publisher::default(), heard: Subscription::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.sent = context.publish(&READINGS)?;
        self.heard = context.subscribe(&READINGS)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let own = context.name().to_owned();
        let others: Vec<Reading> = context
            .receive(&self.heard)
            .with_headers()
            .filter(|(header, _)| context.sender_name(*header) != Some(&*own))
            .map(|(_, reading)| reading.clone())
            .collect();
        for reading in others {
            context.send(&self.sent, Reading { number: reading.number + 1000, ..reading })?;
        }
        Ok(())
    }
}

saoms_api::plugin! {
    classes: [Echo],
}
