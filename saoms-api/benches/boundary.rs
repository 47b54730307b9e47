//! Cost of the boundary to plugins: `cargo bench -p saoms-api --bench boundary`.
//!
//! The best of 999, in ns: an empty execution called directly and through the tables of C functions that a library
//! exports, and a message of 128 bytes from its sender's value to its reader's value, the component on one side and the
//! host on the other.

#![expect(clippy::unwrap_used, reason = "a benchmark ends with what it did not expect")]

#[allow(dead_code, reason = "the tests use the rest")]
#[path = "../tests/suite/components/host.rs"]
mod host;

use std::hint::black_box;
use std::time::Instant;

use saoms_api::boundary::class_table;
use saoms_api::host::{DynComponent, Registration, SharedMessage};
use saoms_api::{Cause, Class, Component, Context, Failure, Header, Message, Publisher, Subscription, Time, Topic};
use saoms_core::plugin::ImportedClass;

use host::FakeHost;

/// 128 bytes in CDR.
#[derive(Clone, Debug, PartialEq, Message)]
struct Sample {
    robot: u32,
    values: Vec<f64>,
}

const SAMPLES: Topic<Sample> = Topic::event("SAMPLES");

fn sample() -> Sample {
    Sample { robot: 7, values: vec![1.5; 14] }
}

/// Does nothing.
#[derive(Class)]
#[class(name = "bench.Empty", periodic)]
struct Empty;

impl Component for Empty {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Empty)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        black_box(context);
        Ok(())
    }
}

/// Sends a message in each execution.
#[derive(Class)]
#[class(name = "bench.Sender", periodic, publishes(SAMPLES))]
struct Sender {
    sample: Sample,
    samples: Publisher<Sample>,
}

impl Component for Sender {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Sender { sample: sample(), samples: Publisher::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.samples = context.publish(&SAMPLES)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.send(&self.samples, self.sample.clone())
    }
}

/// Reads what arrived.
#[derive(Class)]
#[class(name = "bench.Reader", periodic, subscribes(SAMPLES))]
struct Reader {
    samples: Subscription<Sample>,
    sum: f64,
}

impl Component for Reader {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Reader { samples: Subscription::default(), sum: 0.0 })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.samples = context.subscribe(&SAMPLES)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.sum += context.receive(&self.samples).map(|sample| sample.values[0]).sum::<f64>();
        Ok(())
    }
}

/// A component of the class, called directly and across the boundary, initialized.
fn both<C: Class>(host: &mut FakeHost) -> [Box<dyn DynComponent>; 2] {
    let linked = Registration::of::<C>().construct(&[]).unwrap();
    // SAFETY: the tables are made by this crate, whose functions keep the rules.
    let imported = unsafe { ImportedClass::new(&class_table::<C>(), "bench") }.construct(&[]).unwrap();
    [linked, imported].map(|mut component| {
        component.initialize(&mut Context::new(host, &[])).unwrap();
        component
    })
}

fn best(mut code: impl FnMut(u32)) -> f64 {
    // Short enough to lie between two interruptions, with luck.
    const CALLS: u32 = 2_000;
    let mut round = || {
        let start = Instant::now();
        code(CALLS);
        start.elapsed().as_nanos() as f64 / f64::from(CALLS)
    };
    (0..999).map(|_| round()).fold(f64::INFINITY, f64::min)
}

#[expect(clippy::print_stdout, reason = "the result of the benchmark")]
fn main() {
    let mut host = FakeHost::new();
    let [execution, crossing] = both::<Empty>(&mut host).map(|mut component| {
        best(|calls| {
            for _ in 0..calls {
                black_box(&mut component).execute(&mut Context::new(&mut host, &[])).unwrap();
            }
        })
    });
    println!(
        "an empty execution: direct {execution:.1} ns, across {crossing:.1} ns, more by {:.1} ns",
        crossing - execution
    );

    let [sending, sending_across] = both::<Sender>(&mut host).map(|mut component| {
        best(|calls| {
            for _ in 0..calls {
                component.execute(&mut Context::new(&mut host, &[])).unwrap();
                host.sent.clear();
            }
        })
    });
    println!(
        "a message out: direct {sending:.1} ns, across {sending_across:.1} ns, more by {:.1} ns",
        sending_across - sending
    );

    let header = Header { sender: 1, sent: Time::START, cause: Cause::default() };
    let [reading, reading_across] = both::<Reader>(&mut host).map(|mut component| {
        let message = sample();
        best(|calls| {
            for _ in 0..calls {
                let inboxes = [vec![SharedMessage::new(header, message.clone())]];
                component.execute(&mut Context::new(&mut host, &inboxes)).unwrap();
            }
        })
    });
    println!(
        "a message in: direct {reading:.1} ns, across {reading_across:.1} ns, more by {:.1} ns",
        reading_across - reading
    );
}
