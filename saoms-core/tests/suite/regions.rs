//! Subscriptions that receive the messages of a region alone.

use std::sync::Arc;

use saoms_api::host::Registration;
use saoms_api::{
    Class, Component, Context, Failure, Field, Message, Own, Publisher, Region, Subscription, Time, Topic,
};
use saoms_core::schedule::{ChangeOptions, RunningFleet};
use saoms_lang::registry::Registry;

use crate::fleet::{Diary, assembly_of, outcome, simulated, unindent};

#[derive(Clone, Copy, Debug, PartialEq, Field)]
#[field(pair)]
struct Block {
    x: i32,
    y: i32,
}

/// Where a mover is.
#[derive(Clone, Debug, Message)]
#[message(key = "number", place = "block")]
struct Seen {
    number: u32,
    block: Block,
}

const SEEN: Topic<Seen> = Topic::state("SEEN");
const MOVED: Topic<Seen> = Topic::event("MOVED");

/// Moves one block in each execution.
#[derive(Class)]
#[class(name = "mover", periodic)]
struct Mover {
    #[property(default = 1)]
    number: u32,
    #[publishes(SEEN)]
    seen: Publisher<Seen>,
    #[publishes(MOVED)]
    moved: Publisher<Seen>,
}

impl Component for Mover {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let block = Block { x: context.execution() as i32, y: 0 };
        let message = Seen { number: self.number, block };
        context.send(&self.seen, message.clone())?;
        context.send(&self.moved, message)
    }
}

/// Watches two blocks around one that moves after some executions.
#[derive(Class)]
#[class(name = "watcher", periodic, reacts)]
struct Watcher {
    #[property(default = 0)]
    moves_at: u64,
    #[property(default = false)]
    restless: bool,
    /// The middle of its region at first.
    #[property(default = 3)]
    column: i32,
    #[subscribes(SEEN)]
    seen: Subscription<Seen>,
    #[subscribes(MOVED)]
    moved: Subscription<Seen>,
}

impl Watcher {
    fn report(&self, context: &mut Context<'_>) {
        let show = |message: &Seen| format!("{}@{}", message.number, message.block.x);
        let came: Vec<String> = context.receive(&self.seen).map(show).collect();
        let moved: Vec<String> = context.receive(&self.moved).map(show).collect();
        let left: Vec<u64> = context.departed(&self.seen).iter().map(|departed| departed.key).collect();
        context.info(format!("sees {came:?}, moved {moved:?}, left {left:?}"));
    }
}

impl Component for Watcher {
    type Properties = Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.set_region(&self.seen, Some(Region::around((self.column, 0), 1)))?;
        context.set_region(&self.moved, Some(Region::around((self.column, 0), 1)))
    }

    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.report(context);
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.restless && context.execution() == 4 {
            return Err("it has seen enough".into());
        }
        self.report(context);
        if self.moves_at == context.execution() && self.moves_at > 0 {
            context.set_region(&self.seen, Some(Region::around((30, 0), 5)))?;
            context.set_region(&self.moved, None)?;
        }
        Ok(())
    }
}

#[track_caller]
fn check(fleet: &str, milliseconds: u64, expected: &str) {
    check_change(fleet, None, milliseconds, expected);
}

/// The same with a fleet that becomes another one at a time, in milliseconds.
#[track_caller]
fn check_change(fleet: &str, change: Option<(u64, &str)>, milliseconds: u64, expected: &str) {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Mover>()).unwrap();
    registry.add(Registration::of::<Watcher>()).unwrap();
    let diary = Arc::new(Diary::default());
    let fleet = RunningFleet::start(assembly_of(fleet, &registry), simulated(milliseconds), vec![diary.clone()]);
    let fleet = fleet.unwrap();
    if let Some((time, wanted)) = change {
        fleet.run_until(Time::from_nanos(time * 1_000_000));
        fleet.handle().apply(&assembly_of(wanted, &registry), ChangeOptions::allowing_loss()).unwrap();
    }
    let report = fleet.run_to_end();
    assert_eq!(format!("{}{}", diary.lines(), outcome(&report)), unindent(expected));
}

#[test]
fn a_new_instance_has_the_region_that_it_sets() {
    check_change(
        "A mover period=10
         W watcher period=10",
        Some((
            25,
            "A mover period=10
             W watcher period=10 column=5",
        )),
        70,
        "[0.000 s] W: sees [], moved [], left []
         [0.010 s] W: sees [], moved [], left []
         [0.020 s] W: sees [\"1@2\"], moved [\"1@2\"], left []
         [0.025 s] W: is replaced, and starts without the earlier state
         [0.030 s] W: sees [], moved [], left []
         [0.040 s] W: sees [\"1@4\"], moved [\"1@4\"], left []
         [0.050 s] W: sees [\"1@5\"], moved [\"1@5\"], left []
         [0.060 s] W: sees [\"1@6\"], moved [\"1@6\"], left []
         Elapsed after 0.07 s",
    );
}

#[test]
fn a_reader_sees_who_comes_into_its_region_and_who_leaves_it() {
    check(
        "A mover period=10
         W watcher period=10 movesAt=7",
        90,
        "[0.000 s] W: sees [], moved [], left []
         [0.010 s] W: sees [], moved [], left []
         [0.020 s] W: sees [\"1@2\"], moved [\"1@2\"], left []
         [0.030 s] W: sees [\"1@3\"], moved [\"1@3\"], left []
         [0.040 s] W: sees [\"1@4\"], moved [\"1@4\"], left []
         [0.050 s] W: sees [], moved [], left [1]
         [0.060 s] W: sees [], moved [], left []
         [0.070 s] W: sees [], moved [], left []
         [0.080 s] W: sees [], moved [\"1@8\"], left []
         Elapsed after 0.09 s",
    );
}

#[test]
fn a_region_that_moves_leaves_behind_and_finds_what_is_there() {
    check(
        "A mover period=1s number=1
         B mover period=10 number=2
         W watcher period=10 movesAt=3 delay=25",
        90,
        "[0.025 s] W: sees [\"2@2\"], moved [\"2@2\"], left []
         [0.035 s] W: sees [\"2@3\"], moved [\"2@3\"], left []
         [0.045 s] W: sees [\"2@4\"], moved [\"2@4\"], left []
         [0.055 s] W: sees [], moved [], left [2]
         [0.065 s] W: sees [], moved [\"2@6\"], left []
         [0.075 s] W: sees [], moved [\"2@7\"], left []
         [0.085 s] W: sees [], moved [\"2@8\"], left []
         Elapsed after 0.09 s",
    );
}

#[test]
fn messages_outside_its_region_trigger_nobody_and_a_restart_sees_what_is_there() {
    check(
        "A mover period=10
         W watcher period=1s delay=5 trigger=[SEEN MOVED]",
        70,
        "[0.005 s] W: sees [], moved [], left []
         [0.020 s] W: sees [\"1@2\"], moved [\"1@2\"], left []
         [0.030 s] W: sees [\"1@3\"], moved [\"1@3\"], left []
         [0.040 s] W: sees [\"1@4\"], moved [\"1@4\"], left []
         [0.050 s] W: sees [], moved [], left [1]
         Elapsed after 0.07 s",
    );
    check(
        "A mover period=10
         W watcher period=10 restless=true restart=5/1",
        50,
        "[0.000 s] W: sees [], moved [], left []
         [0.010 s] W: sees [], moved [], left []
         [0.020 s] W: sees [\"1@2\"], moved [\"1@2\"], left []
         [0.030 s] W: sees [\"1@3\"], moved [\"1@3\"], left []
         [0.040 s] W: failed and is restarted in 5ms: it has seen enough
         [0.045 s] W: restarted (1)
         [0.045 s] W: sees [\"1@4\"], moved [], left []
         Elapsed after 0.05 s",
    );
}
