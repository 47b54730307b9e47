//! Numbered events, and readers that hold what they receive to what was sent; walkers that hear who is near.

use std::collections::BTreeMap;
use std::thread::sleep;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Field, Message, Publisher, Region, Subscription, Topic, Work};

/// A numbered event.
#[derive(Clone, Debug, Message)]
pub struct Number {
    sender: String,
    /// From 1.
    number: u32,
    filler: String,
    /// Another form of it.
    #[cfg(feature = "other")]
    more: u32,
}

/// A reader that is there.
#[derive(Clone, Debug, Message)]
pub struct Present {
    reader: String,
}

const NUMBERS: Topic<Number> = Topic::event("NUMBERS").optional();
const PRESENT: Topic<Present> = Topic::state("PRESENT").optional();

/// Executions between the last reader that it hears of and the first event.
const PAUSE: u64 = 3;

/// Sends numbered events once all readers are there.
#[derive(Class)]
#[class(name = "numbers.Sender", periodic)]
pub struct Sender {
    /// The events that it sends.
    #[property]
    count: u32,
    /// Those in each execution.
    #[property]
    each: u32,
    /// The readers that it waits for.
    #[property(default = 1)]
    readers: u32,
    /// The letters of a text in each event.
    #[property(default = 0)]
    size: u32,
    #[publishes(NUMBERS)]
    numbers: Publisher<Number>,
    #[subscribes(PRESENT)]
    present: Subscription<Present>,
    heard: BTreeMap<String, u64>,
    sent: u32,
}

impl Component for Sender {
    type Properties = saoms_api::Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let sent = context.kept().get(&0).and_then(|bytes| (*bytes).try_into().ok());
        self.sent = sent.map_or(0, u32::from_le_bytes);
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for Present { reader } in context.receive(&self.present) {
            self.heard.entry(reader.clone()).or_insert(context.execution());
        }
        let last = self.heard.values().max().copied().unwrap_or_default();
        if self.heard.len() >= self.readers as usize && context.execution() >= last + PAUSE && self.sent < self.count {
            if self.sent == 0 {
                context.info("begins");
            }
            // It goes on from there with a state folder.
            context.keep(0, &(self.sent + self.each.min(self.count - self.sent)).to_le_bytes())?;
            for _ in 0..self.each.min(self.count - self.sent) {
                self.sent += 1;
                let (sender, filler) = (context.name().to_owned(), "x".repeat(self.size as usize));
                #[cfg(feature = "other")]
                let event = Number { sender, number: self.sent, filler, more: 0 };
                #[cfg(not(feature = "other"))]
                let event = Number { sender, number: self.sent, filler };
                context.send(&self.numbers, event)?;
            }
            if self.sent == self.count {
                context.info(format!("has sent 1 to {}", self.sent));
            }
        }
        context.vote(if self.sent == self.count { Work::Done } else { Work::Open });
        Ok(())
    }
}

/// Receives numbered events until it has the last one of each sender, and says what of them is not as it should be.
#[derive(Class)]
#[class(name = "numbers.Reader", periodic)]
pub struct Reader {
    /// The last number of each sender.
    #[property]
    count: u32,
    /// The senders.
    #[property(default = 1)]
    senders: u32,
    /// The letters of the text in each event.
    #[property(default = 0)]
    size: u32,
    /// Milliseconds that it takes to initialize.
    #[property(default = 0)]
    prepares: u32,
    #[subscribes(NUMBERS)]
    numbers: Subscription<Number>,
    #[publishes(PRESENT)]
    present: Publisher<Present>,
    last: BTreeMap<String, u32>,
    /// What it had received before it was started again: that may come again, at first.
    before: BTreeMap<String, u32>,
    complete: u32,
}

impl Component for Reader {
    type Properties = saoms_api::Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for bytes in context.kept().into_values() {
            let text = String::from_utf8_lossy(bytes);
            let (sender, last) = text.split_once(' ').unwrap_or_default();
            self.last.insert(sender.to_owned(), last.parse().unwrap_or_default());
        }
        self.complete = self.last.values().filter(|last| **last == self.count).count() as u32;
        self.before = self.last.clone();
        if self.prepares > 0 {
            sleep(Duration::from_millis(self.prepares.into()));
            context.info("is ready");
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.execution() == 0 {
            context.send(&self.present, Present { reader: context.name().to_owned() })?;
        }
        for Number { sender, number, filler, .. } in context.receive(&self.numbers) {
            if self.before.get(sender).is_some_and(|before| number <= before) {
                context.info(format!("receives {number} of {sender} again"));
                continue;
            }
            self.before.remove(sender);
            let last = self.last.entry(sender.clone()).or_default();
            if *number != *last + 1 {
                context.warn(format!("wrong: received {number} of {sender}, expected {}", *last + 1));
            }
            if filler.len() != self.size as usize || filler.bytes().any(|letter| letter != b'x') {
                context.warn(format!("wrong: the text of {number} of {sender} has {} letters", filler.len()));
            }
            *last = *number;
            if *last == self.count {
                context.info(format!("has received 1 to {number} of {sender}"));
                self.complete += 1;
            }
        }
        for (place, (sender, last)) in (0..).zip(&self.last) {
            context.keep(place, format!("{sender} {last}").as_bytes())?;
        }
        context.vote(if self.complete == self.senders { Work::Done } else { Work::Open });
        Ok(())
    }
}

/// A block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
#[field(pair)]
pub struct Spot {
    x: i32,
    y: i32,
}

/// Where a walker is.
#[derive(Clone, Debug, Message)]
#[message(place = "at")]
pub struct Step {
    walker: String,
    at: Spot,
    filler: String,
}

const STEPS: Topic<Step> = Topic::state("STEPS").optional();

/// Walks along a row, once others are there, and says whom it meets within four blocks.
#[derive(Class)]
#[class(name = "numbers.Walker", periodic)]
pub struct Walker {
    /// Where it begins.
    #[property]
    from: i32,
    /// Where it ends.
    #[property]
    to: i32,
    /// The letters of a text in each of its messages.
    #[property(default = 0)]
    size: u32,
    #[publishes(STEPS)]
    own: Publisher<Step>,
    #[subscribes(STEPS)]
    others: Subscription<Step>,
    #[subscribes(PRESENT)]
    present: Subscription<Present>,
    walked: i32,
    met: BTreeMap<u32, String>,
    may_go: bool,
}

impl Component for Walker {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let x = self.from + self.walked * (self.to - self.from).signum();
        context.set_region(&self.others, Some(Region::around((x, 0), 4)))?;
        for (header, Step { walker, at, .. }) in context.receive(&self.others).with_headers() {
            if walker != context.name() && self.met.insert(header.sender, walker.clone()).is_none() {
                context.info(format!("meets {walker} at {}", at.x));
            }
        }
        for departed in context.departed(&self.others).to_vec() {
            if let Some(walker) = self.met.remove(&departed.sender) {
                context.info(format!("hears {walker} no more"));
            }
        }
        self.may_go |= context.receive(&self.present).next().is_some();
        if self.may_go && x != self.to {
            self.walked += 1;
        }
        let (walker, filler) = (context.name().to_owned(), "x".repeat(self.size as usize));
        context.send(&self.own, Step { walker, at: Spot { x, y: 0 }, filler })?;
        context.vote(Work::Open);
        Ok(())
    }
}

/// Lets walkers go.
#[derive(Class)]
#[class(name = "numbers.Starter", periodic)]
pub struct Starter {
    #[publishes(PRESENT)]
    present: Publisher<Present>,
}

impl Component for Starter {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.execution() == 0 {
            context.send(&self.present, Present { reader: context.name().to_owned() })?;
        }
        Ok(())
    }
}

saoms_api::plugin! {
    classes: [Sender, Reader, Walker, Starter],
}
