//! Cost of a MAPE-K loop: `cargo bench -p saoms-core --bench loops`.
//!
//! In virtual time, on one core, the best of seven: ns per execution of a component that knows 24 single values and has
//! one loop, without a loop, without a symptom, and with a decision that changes no value, one, or eight. A symptom
//! brings the snapshot, a decision the comparison, a change its record in the journal.

mod common;

use std::hint::black_box;
use std::sync::Arc;

use common::component;
use saoms_api::host::Registration;
use saoms_api::{
    Class, Component, Context, Entries, Extras, Failure, Knowledge, Loop, LoopClass, Loops, Properties, Record, record,
};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_lang::assembly::{Assembly, ComponentSpec, LoopSpec};
use saoms_lang::registry::Registry;

#[derive(Debug, Default, Entries)]
struct Eight {
    #[entry]
    a: i64,
    #[entry]
    b: i64,
    #[entry]
    c: i64,
    #[entry]
    d: i64,
    #[entry]
    e: i64,
    #[entry]
    f: i64,
    #[entry]
    g: i64,
    #[entry]
    h: i64,
}

#[derive(Debug, Default, Entries)]
struct Flags {
    #[entry]
    i: bool,
    #[entry]
    j: bool,
    #[entry]
    k: bool,
    #[entry]
    l: bool,
    #[entry]
    m: bool,
    #[entry]
    n: bool,
    #[entry]
    o: bool,
    #[entry]
    p: bool,
}

#[derive(Debug, Default, Entries)]
struct Numbers {
    #[entry]
    q: f64,
    #[entry]
    r: f64,
    #[entry]
    s: f64,
    #[entry]
    t: f64,
    #[entry]
    u: f64,
    #[entry]
    v: f64,
    #[entry]
    w: f64,
    #[entry]
    x: f64,
}

#[derive(Debug, Default, Knowledge)]
#[knowledge(name = "load")]
struct Known {
    #[entry(flatten)]
    eight: Eight,
    #[entry(flatten)]
    flags: Flags,
    #[entry(flatten)]
    numbers: Numbers,
    #[extras]
    extras: Extras,
}

#[derive(Properties)]
struct Load {
    /// Number of values to change in each execution; -1 is no symptom.
    #[property(default = -1)]
    changes: i64,
}

#[derive(LoopClass)]
#[looping(name = "load.Busy")]
struct Busy {
    changes: i64,
}

impl Loop for Busy {
    type Properties = Load;
    type Knowledge = Known;
    type Symptom = Record;
    type Decision = Record;

    fn new(load: Load) -> Result<Self, Failure> {
        Ok(Busy { changes: load.changes })
    }

    fn analyze(&mut self, _: &mut Known, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok((self.changes >= 0).then(|| record!("has {changes} to do", changes = self.changes)))
    }

    fn plan(&mut self, symptom: Record, _: &mut Known, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(Some(symptom))
    }

    fn execute(&mut self, _: Record, known: &mut Known, _: &mut Context<'_>) -> Result<(), Failure> {
        let eight = &mut known.eight;
        let all = [
            &mut eight.a, &mut eight.b, &mut eight.c, &mut eight.d, &mut eight.e, &mut eight.f, &mut eight.g,
            &mut eight.h,
        ];
        all.into_iter().take(self.changes as usize).for_each(|value| *value += 1);
        Ok(())
    }
}

#[derive(Class)]
#[class(name = "load.Robot", periodic, knowledge = Known, loops(Busy))]
struct Robot {
    known: Known,
    loops: Loops,
}

impl Component for Robot {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Robot { known: Known::default(), loops: Loops::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops = context.loops()?;
        self.loops.initialize(&mut self.known, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.monitor(&mut self.known, context)?;
        self.loops.adapt(&mut self.known, context)?;
        black_box(&mut self.known);
        Ok(())
    }
}

#[expect(clippy::print_stdout, reason = "a benchmark tells its result")]
fn main() -> common::Result<()> {
    let shapes = [
        ("without a loop", None),
        ("without a symptom", Some("-1")),
        ("with a decision that changes nothing", Some("0")),
        ("with a decision that changes one value", Some("1")),
        ("with a decision that changes eight values", Some("8")),
    ];
    for (name, changes) in shapes {
        println!("{:6.1} ns per execution {name}", common::best(&start(changes)?));
    }
    Ok(())
}

fn start(changes: Option<&str>) -> common::Result<RunningFleet> {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Robot>())?;
    let busy = registry.get_loop("load.Busy").ok_or("the loop is registered")?;
    let of = |changes: &str| LoopSpec {
        name: "Busy".to_owned(),
        class: Arc::clone(busy),
        values: vec![("changes".into(), changes.into())],
        written: Default::default(),
    };
    let robot = component(&registry, ("Robot", "load.Robot"), &[], &[("period", "1s")])?;
    let components = vec![ComponentSpec { loops: changes.map(of).into_iter().collect(), ..robot }];
    Ok(RunningFleet::start(Assembly { components, ..Assembly::default() }, Settings::simulated(1), Vec::new())?)
}
