//! What a component that goes on after a failure has: what it heard in vain, what calls changed, and its counts once.

use std::sync::Arc;

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Message, Own, Saved, Subscription};
use saoms_core::schedule::RunningFleet;
use saoms_lang::registry::Registry;

use crate::actor::{Actor, Echo, TALK, Words};
use crate::fleet::{Diary, assembly_of, outcome, simulated, unindent};

#[derive(Clone, Debug, Message)]
struct Entries {
    words: Vec<String>,
    calls: u32,
}

/// Writes down all that it hears, and how often it is called.
#[derive(Class)]
#[class(name = "ledger", periodic, saves, reacts, service("echo": Echo))]
struct Ledger {
    /// Executions that fail after their work, by numbers with blanks around them.
    #[property(default = "")]
    fails: String,
    /// The word that it cannot stand.
    #[property(default = "poison")]
    hates: String,
    #[subscribes(TALK)]
    talk: Subscription<Words>,
    words: Vec<String>,
    calls: u32,
    has_told: bool,
}

impl Ledger {
    fn hear(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for Words { text } in context.receive(&self.talk) {
            self.words.push(text.clone());
            context.count("ledger.words", 1);
            if *text == self.hates {
                return Err("it hears poison".into());
            }
        }
        Ok(())
    }
}

impl Component for Ledger {
    type Properties = Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.info(format!("goes on: {}", context.goes_on()));
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.hear(context)?;
        let now = format!(" {} ", context.now().as_nanos() / 1_000_000);
        if self.fails.contains(&now) {
            return Err("it was told to".into());
        }
        context.info(format!("{} words, {} calls", self.words.join(" "), self.calls));
        Ok(())
    }

    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let fails = !self.has_told && self.fails.contains("reaction");
        self.hear(context)?;
        if fails && self.words.len() == 2 {
            return Err("its reaction was told to".into());
        }
        context.info(format!("reacts: {}", self.words.join(" ")));
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Entries { words: self.words.clone(), calls: self.calls }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        if let Some(Entries { words, calls }) = saved.read()? {
            (self.words, self.calls, self.has_told) = (words, calls, true);
        }
        Ok(())
    }
}

impl Echo for Ledger {
    fn echo(&mut self, _: &mut Context<'_>, text: String) -> Result<String, Failure> {
        self.calls += 1;
        if text == "panic" {
            panic!("it was told to"); // PANIC
        }
        Ok(text)
    }
}

#[track_caller]
fn check(fleet: &str, milliseconds: u64, words: u64, expected: &str) {
    let mut registry = Registry::new();
    for class in [Registration::of::<Actor>(), Registration::of::<Ledger>()] {
        registry.add(class).unwrap();
    }
    let diary = Arc::new(Diary::default());
    let assembly = assembly_of(fleet, &registry);
    let fleet = RunningFleet::start(assembly, simulated(milliseconds), vec![diary.clone()]).unwrap();
    let report = fleet.run_to_end();
    let panics = include_str!("goes_on.rs").lines().position(|line| line.ends_with("// PANIC")).unwrap() + 1;
    let expected = unindent(expected).replace("LINE", &panics.to_string());
    assert_eq!(format!("{}{}", diary.lines(), outcome(&report)), expected);
    let counted = report.sections.get("ledger").map_or(0, |ledger| ledger["words"].as_u64().unwrap());
    assert_eq!(counted, words);
}

#[test]
fn what_an_execution_heard_in_vain_is_heard_again_and_counted_once() {
    check(
        "L ledger period=10 restart=15/3 fails=[ 20 ]
         B actor period=10 publishes=TALK each=[0: say a; 1: say b; 2: say c; 3: say d; 4: say e]",
        60,
        5,
        "[0.000 s] L: goes on: false
         [0.000 s] L:  words, 0 calls
         [0.010 s] L: a words, 0 calls
         [0.020 s] L: failed and is restarted in 15ms: it was told to
         [0.035 s] L: goes on: true
         [0.035 s] L: restarted (1), and continues
         [0.035 s] L: a b words, 0 calls
         [0.045 s] L: a b c d e words, 0 calls
         [0.055 s] L: a b c d e words, 0 calls
         Elapsed after 0.06 s",
    );
}

#[test]
fn the_first_execution_can_fail_too() {
    check(
        "B actor period=10 publishes=TALK first=[say a]
         L ledger period=10 delay=5 restart=10/3 fails=[ 5 ]
         C actor period=10 peer=L each=[ask one]",
        20,
        0,
        "[0.000 s] L: goes on: false
         [0.000 s] C: is told \"one\"
         [0.005 s] L: failed and is restarted in 10ms: it was told to
         [0.010 s] C: is told nothing: component `L` is not running
         [0.015 s] L: goes on: true
         [0.015 s] L: restarted (1), and continues
         Elapsed after 0.02 s",
    );
}

#[test]
fn what_makes_it_fail_twice_is_not_heard_a_third_time() {
    check(
        "L ledger period=10 restart=1/5
         B actor period=10 publishes=TALK each=[0: say a; 1: say poison; 1: say b; 2: say c]",
        50,
        2,
        "[0.000 s] L: goes on: false
         [0.000 s] L:  words, 0 calls
         [0.010 s] L: a words, 0 calls
         [0.020 s] L: failed and is restarted in 1ms: it hears poison
         [0.021 s] L: goes on: true
         [0.021 s] L: restarted (1), and continues
         [0.021 s] L: failed and is restarted in 2ms: it hears poison
         [0.023 s] L: goes on: true
         [0.023 s] L: restarted (2), and continues
         [0.023 s] L: a c words, 0 calls
         [0.033 s] L: a c words, 0 calls
         [0.043 s] L: a c words, 0 calls
         Elapsed after 0.05 s",
    );
}

#[test]
fn what_calls_changed_is_not_lost_but_for_the_one_that_failed() {
    check(
        "L ledger period=10 restart=1/5 fails=[ 20 ]
         C actor period=10 delay=4 peer=L each=[ask one; ask two; 2: ask panic]",
        40,
        0,
        "[0.000 s] L: goes on: false
         [0.000 s] L:  words, 0 calls
         [0.004 s] C: is told \"one\"
         [0.004 s] C: is told \"two\"
         [0.010 s] L:  words, 2 calls
         [0.014 s] C: is told \"one\"
         [0.014 s] C: is told \"two\"
         [0.020 s] L: failed and is restarted in 1ms: it was told to
         [0.021 s] L: goes on: true
         [0.021 s] L: restarted (1), and continues
         [0.021 s] L:  words, 4 calls
         [0.024 s] C: is told \"one\"
         [0.024 s] C: is told \"two\"
         [0.024 s] L: failed and is restarted in 2ms: panicked at saoms-core/tests/suite/goes_on.rs:LINE:13: it was told to
         [0.024 s] C: is told nothing: component `L` could not serve the call: panicked at saoms-core/tests/suite/goes_on.rs:LINE:13: it was told to
         [0.026 s] L: goes on: true
         [0.026 s] L: restarted (2), and continues
         [0.026 s] L:  words, 6 calls
         [0.034 s] C: is told \"one\"
         [0.034 s] C: is told \"two\"
         [0.036 s] L:  words, 8 calls
         Elapsed after 0.04 s",
    );
}

#[test]
fn a_reaction_that_failed_comes_again() {
    check(
        "L ledger period=100 restart=1/5 trigger=TALK fails=[reaction]
         B actor period=10 publishes=TALK each=[0: say a; 1: say b; 2: say c]",
        30,
        3,
        "[0.000 s] L: goes on: false
         [0.000 s] L:  words, 0 calls
         [0.000 s] L: reacts: a
         [0.010 s] L: failed and is restarted in 1ms: its reaction was told to
         [0.011 s] L: goes on: true
         [0.011 s] L: restarted (1), and continues
         [0.011 s] L: reacts: a b
         [0.011 s] L: a b words, 0 calls
         [0.020 s] L: reacts: a b c
         Elapsed after 0.03 s",
    );
}
