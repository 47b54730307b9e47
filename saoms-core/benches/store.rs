//! Cost of what components keep: `cargo bench -p saoms-core --bench store`.
//!
//! First, in virtual time on one core, ns per execution of a component that sends a message and keeps nothing, keeps
//! 150 bytes in memory, or keeps them and lets the message wait for a commit: the best of seven. Then, in real time,
//! fleets that keep 150 bytes in each execution in a folder in `target`: how many executions were committed in a
//! second, and how long their messages waited for the disk, from the execution to the reaction of their reader.

mod common;

use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use common::{Result, component};
use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Subscription, Topic};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_core::store::Store;
use saoms_lang::assembly::Assembly;
use saoms_lang::registry::Registry;

/// Says that something was kept.
#[derive(Clone, Debug, Default, Message)]
struct Done {
    number: u64,
}

const DONE: Topic<Done> = Topic::event("DONE");

#[derive(Class)]
#[class(name = "load.Keeper", periodic)]
struct Keeper {
    /// Number of bytes that it keeps in each execution.
    #[property(default = 0)]
    bytes: u32,
    #[publishes(DONE)]
    done: Publisher<Done>,
}

impl Component for Keeper {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> std::result::Result<(), Failure> {
        let number = context.execution();
        if self.bytes > 0 {
            context.keep(number % 8, &[number as u8; 1024][..self.bytes as usize])?;
        }
        context.send(&self.done, Done { number })
    }
}

/// Waits of messages, in microseconds.
static WAITS: Mutex<Vec<u64>> = Mutex::new(Vec::new());

#[derive(Class)]
#[class(name = "load.Reader", periodic)]
struct Reader {
    #[subscribes(DONE)]
    done: Subscription<Done>,
}

impl Component for Reader {
    type Properties = Own<Self>;

    fn react(&mut self, context: &mut Context<'_>) -> std::result::Result<(), Failure> {
        let now = context.now();
        let waits =
            context.receive(&self.done).with_headers().map(|(header, _)| now.since(header.sent).as_micros() as u64);
        WAITS.lock().map_err(|error| Failure::new(error.to_string()))?.extend(waits);
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> std::result::Result<(), Failure> {
        self.react(context)
    }
}

#[expect(clippy::print_stdout, reason = "a benchmark tells its result")]
fn main() -> Result<()> {
    for (name, bytes, delay) in
        [("that keeps nothing", "0", 0), ("that keeps in memory", "150", 0), ("that waits for a commit", "150", 100)]
    {
        println!("{:6.1} ns per execution {name}", best(bytes, Duration::from_millis(delay))?);
    }
    for (components, period) in [(1, "10ms"), (10, "10ms"), (100, "10ms"), (1000, "100ms")] {
        println!("{}", on_disk(components, period)?);
    }
    Ok(())
}

/// Nanoseconds per execution of a keeper in virtual time.
fn best(bytes: &str, commit_delay: Duration) -> Result<f64> {
    let fleet = RunningFleet::start(
        fleet(1, "1s", bytes, &[])?,
        Settings { commit_delay, ..Settings::simulated(1) },
        Vec::new(),
    )?;
    Ok(common::best(&fleet))
}

/// A fleet in real time for three seconds that keeps something on a disk.
fn on_disk(components: usize, period: &str) -> Result<String> {
    let folder = tempfile::tempdir_in(Path::new(env!("CARGO_MANIFEST_DIR")).join("../target"))?;
    let store = Store::open(folder.path())?;
    let settings = Settings { limit: Some(Duration::from_secs(3)), ..Settings::default() };
    let reader = [("trigger", "DONE"), ("period", "10s"), ("queue", "100000")];
    let assembly = fleet(components, period, "150", &reader)?;
    let fleet = RunningFleet::start_with(assembly, settings, Vec::new(), |handle| handle.use_store(store))?;
    let report = fleet.run_to_end();
    let mut waits = std::mem::take(&mut *WAITS.lock().map_err(|error| error.to_string())?);
    waits.sort_unstable();
    let at = |share: f64| waits.get((waits.len() as f64 * share) as usize).copied().unwrap_or_default();
    Ok(format!(
        "{components} components each {period}: {} executions committed in a second, waits {} us in the median, {} us at 99 %; {} missed",
        waits.len() / 3,
        at(0.5),
        at(0.99),
        report.components.iter().map(|one| one.missed).sum::<u64>()
    ))
}

/// Keepers, and a reader if it has properties.
fn fleet(keepers: usize, period: &str, bytes: &str, reader: &[(&str, &str)]) -> Result<Assembly> {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Keeper>())?;
    registry.add(Registration::of::<Reader>())?;
    let keeper = |number| {
        let path = format!("K{number}");
        component(&registry, (&path, "load.Keeper"), &[("bytes", bytes)], &[("period", period)])
    };
    let mut components = (0..keepers).map(keeper).collect::<Result<Vec<_>>>()?;
    if !reader.is_empty() {
        components.push(component(&registry, ("Reader", "load.Reader"), &[], reader)?);
    }
    Ok(Assembly { components, ..Assembly::default() })
}
