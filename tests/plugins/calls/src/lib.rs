//! Calls between programs. With the feature `other` the interface has another form.

use std::collections::BTreeSet;
use std::thread::sleep;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, StopFunction, Work, interface};

#[cfg(not(feature = "other"))]
type Number = u32;
#[cfg(feature = "other")]
type Number = u64;

/// Counts calls.
#[interface(name = "calls.Counter")]
pub trait Counter {
    /// Counts a call, which has a number. Returns how many there were.
    fn count(&mut self, context: &mut Context<'_>, number: Number) -> Result<u32, Failure>;

    /// Takes so many milliseconds.
    fn rest(&mut self, context: &mut Context<'_>, time: u32) -> Result<(), Failure>;
}

/// Counts calls, and says which of them is there twice.
#[derive(Class)]
#[class(name = "calls.Tally", passive, apart, service("counter": Counter))]
pub struct Tally {
    seen: BTreeSet<Number>,
}

impl Component for Tally {
    type Properties = ();
}

impl Counter for Tally {
    fn count(&mut self, context: &mut Context<'_>, number: Number) -> Result<u32, Failure> {
        if !self.seen.insert(number) {
            context.warn(format!("wrong: call {number} runs twice"));
        }
        if number == 0 {
            return Err("nobody counts from 0".into());
        }
        Ok(self.seen.len() as u32)
    }

    fn rest(&mut self, context: &mut Context<'_>, time: u32) -> Result<(), Failure> {
        context.info("rests");
        sleep(Duration::from_millis(u64::from(time)));
        Ok(())
    }
}

/// Counts calls, and has hardware.
#[derive(Class)]
#[class(name = "calls.Motor", passive, stops, service("counter": Counter))]
pub struct Motor {
    count: u32,
}

impl Component for Motor {
    type Properties = ();

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let stop = StopFunction::new(|| {
            println!("the motor stops");
            Ok(())
        });
        context.register_stop(stop.with_heartbeat(|period| println!("the next heartbeat comes within {period:?}")))
    }
}

impl Counter for Motor {
    fn count(&mut self, _: &mut Context<'_>, _: Number) -> Result<u32, Failure> {
        self.count += 1;
        Ok(self.count)
    }

    fn rest(&mut self, _: &mut Context<'_>, _: u32) -> Result<(), Failure> {
        Ok(())
    }
}

/// Makes numbered calls, one in each execution.
#[derive(Class)]
#[class(name = "calls.Caller", periodic, apart)]
pub struct Caller {
    /// The number of calls.
    #[property]
    calls: u32,
    /// The number of the first call.
    #[property(default = 1)]
    first: u32,
    /// Milliseconds of rest before the first one.
    #[property(default = 0)]
    rest: u32,
    #[reference]
    counter: CounterReference,
    made: u32,
    answered: u32,
}

impl Component for Caller {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.rest > 0 && context.execution() == 0 {
            match self.counter.rest(context, self.rest) {
                Ok(()) => context.info("has rested"),
                Err(error) => context.info(format!("failed: {error}")),
            }
        }
        if self.made < self.calls {
            let number = self.first + self.made;
            self.made += 1;
            match self.counter.count(context, Number::from(number)) {
                Ok(_) => self.answered += 1,
                Err(error) => context.info(format!("failed: {error}")),
            }
            if self.made == self.calls {
                context.info(format!("made {} calls, {} were answered", self.made, self.answered));
            }
        }
        context.vote(if self.made == self.calls { Work::Done } else { Work::Open });
        Ok(())
    }
}

/// Calls without waiting.
#[derive(Class)]
#[class(name = "calls.Hasty", periodic)]
pub struct Hasty {
    #[reference]
    counter: CounterReference,
}

impl Component for Hasty {
    type Properties = ();

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.counter.count(context, 1).map(drop).map_err(Failure::from)
    }
}

saoms_api::plugin! {
    classes: [Tally, Motor, Caller, Hasty],
}
