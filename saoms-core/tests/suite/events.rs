//! Events that classes take, from components and from outside.

use saoms_api::event::EventCall;
use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Field, Message, Properties, Subscription, Time, Topic, Work};
use saoms_core::schedule::RunningFleet;
use saoms_lang::assembly::Assembly;
use saoms_lang::registry::Registry;

use crate::fleet::{Diary, assembly_of, simulated, unindent};

/// Column and row.
#[derive(Clone, Copy, Debug, Field)]
#[field(pair)]
struct Block {
    x: i32,
    y: i32,
}

#[derive(Clone, Copy, Debug, Field)]
enum Kind {
    Wood,
    Oil,
}

/// A fire.
#[derive(Clone, Debug, Message)]
struct Fire {
    at: Block,
    size: u8,
    kind: Option<Kind>,
    lasts: Option<f64>,
    words: Option<Vec<String>>,
}

const FIRE: Topic<Fire> = Topic::event("FIRE");

/// Hears of fires.
#[derive(Class)]
#[class(name = "hall", periodic, reacts)]
struct Hall {
    /// A fire breaks out.
    #[takes("fire", FIRE)]
    fires: Subscription<Fire>,
}

impl Hall {
    fn tell(&self, how: &str, context: &mut Context<'_>) {
        for (header, Fire { at: Block { x, y }, size, kind, lasts, words }) in
            context.receive(&self.fires).with_headers()
        {
            let (by, time) = (header.sender, header.sent);
            context.info(format_args!(
                "{how} a fire at ({x},{y}) of {size} {kind:?} {lasts:?} {words:?} by {by} at {time}"
            ));
        }
    }
}

impl Component for Hall {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Hall { fires: Subscription::default() })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.tell("sees", context);
        Ok(())
    }

    fn react(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.tell("meets", context);
        Ok(())
    }
}

#[derive(Properties)]
struct Lines {
    /// In the second execution, each between `;`.
    lines: String,
}

/// Raises events, and has done its work then.
#[derive(Class)]
#[class(name = "player", periodic)]
struct Player {
    lines: String,
}

impl Component for Player {
    type Properties = Lines;

    fn new(Lines { lines }: Lines) -> Result<Self, Failure> {
        Ok(Player { lines })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.vote(Work::Open);
        if context.execution() == 1 {
            for line in self.lines.split(';') {
                if let Err(failure) = context.raise(line.trim()) {
                    context.info(format_args!("cannot: {failure}"));
                }
            }
            context.vote(Work::Done);
        }
        Ok(())
    }
}

fn assembly(text: &str) -> Assembly {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Hall>()).unwrap();
    registry.add(Registration::of::<Player>()).unwrap();
    assembly_of(text, &registry)
}

/// What happens in a fleet with components in sites: the part of a name before `.` is its site.
fn started(text: &str) -> (RunningFleet, std::sync::Arc<Diary>) {
    let mut assembly = assembly(text);
    for one in &mut assembly.components {
        if let Some((site, _)) = one.path.split_once('.') {
            one.site = site.into();
        }
    }
    let diary = std::sync::Arc::new(Diary::default());
    let fleet = RunningFleet::start(assembly, simulated(100), vec![std::sync::Arc::clone(&diary) as _]).unwrap();
    (fleet, diary)
}

fn told(text: &str) -> (String, String) {
    let (fleet, diary) = started(text);
    let report = fleet.run_to_end();
    (diary.lines().trim().to_owned(), report.trace_hash.unwrap())
}

#[test]
fn an_event_reaches_all_that_take_it_or_the_one_that_it_is_for() {
    let text =
        "Player player period=10 lines=[fire at=(3,4) size=2; fire at=(1,2) size=1 kind=OIL lasts=0.5 to B; fire]
        A hall period=10
        B hall period=10
        C hall period=10 rename=FIRE/ALARM
        D hall period=10 trigger=FIRE";
    let (lines, hash) = told(text);
    assert_eq!(lines, unindent(
        "[0.010 s] Player: cannot: event `fire`: event `fire` needs its fields: `at` and `size` are missing; add `at=(1,1)` and `size=1`, with `(x,y)`, such as `(1,1)` for `at`, a whole number from 0 to 255 for `size`
         [0.010 s] A: sees a fire at (3,4) of 2 None None None by 0 at 0.010 s
         [0.010 s] B: sees a fire at (3,4) of 2 None None None by 0 at 0.010 s
         [0.010 s] B: sees a fire at (1,2) of 1 Some(Oil) Some(0.5) None by 0 at 0.010 s
         [0.010 s] C: sees a fire at (3,4) of 2 None None None by 0 at 0.010 s
         [0.010 s] D: meets a fire at (3,4) of 2 None None None by 0 at 0.010 s"
    ));
    assert_eq!(told(text), (lines, hash.clone()));
    assert_ne!(told(&text.replace(" to B", " to A")).1, hash);
}

/// The same fleet, with events from outside.
fn from_outside(text: &str, lines: &[&str]) -> (String, String) {
    let (fleet, diary) = started(text);
    let handle = fleet.handle();
    let mut answers = String::new();
    for line in lines {
        let (site, line) = line.split_once(": ").unwrap_or(("", line));
        let call = EventCall::read(line).unwrap();
        let at = Time::from_nanos(15_000_000);
        if let Err(error) = handle.raise(site, &call, Some(at), line.to_owned()) {
            answers.push_str(&format!("{error}\n"));
        }
    }
    let report = fleet.run_to_end();
    (answers + diary.lines().trim(), report.trace_hash.unwrap())
}

#[test]
fn events_from_outside_take_effect_at_their_time() {
    let fleet = "A hall period=10
        B hall period=10
        C hall period=10 rename=FIRE/ALARM
        D hall period=10 trigger=FIRE";
    let lines = ["fire at=(3,4) size=2", "fire at=( 1, 2 ) size=1 kind=OIL lasts=0.5 words=[\"a b\",c] to B"];
    let (told, hash) = from_outside(fleet, &lines);
    let expected = "[0.015 s] D: meets a fire at (3,4) of 2 None None None by 4294967295 at 0.015 s
        [0.020 s] A: sees a fire at (3,4) of 2 None None None by 4294967295 at 0.015 s
        [0.020 s] B: sees a fire at (3,4) of 2 None None None by 4294967295 at 0.015 s
        [0.020 s] B: sees a fire at (1,2) of 1 Some(Oil) Some(0.5) Some([\"a b\", \"c\"]) by 4294967295 at 0.015 s
        [0.020 s] C: sees a fire at (3,4) of 2 None None None by 4294967295 at 0.015 s";
    assert_eq!(told, unindent(expected));
    assert_eq!(from_outside(fleet, &lines), (told, hash.clone()));
    assert_ne!(from_outside(fleet, &lines[..1]).1, hash);
}

#[test]
fn an_event_that_does_not_fit_is_refused_with_what_is_meant() {
    let fleet = "A hall period=10
        North.B hall period=10
        North.C hall period=10";
    let (told, _) = from_outside(
        fleet,
        &[
            "fier at=(3,4) size=2",
            "fire at=(3,4) sise=2",
            "fire at=(3,4) size=300",
            "fire at=3 size=3",
            "fire at=(3,4) size=2 kind=wod",
            "fire at=(3,4)",
            "fire at=(3,4) size=2 to North.B",
            "fire at=(3,4) size=2 to AA",
            "South: fire at=(3,4) size=2",
            "North: fire at=(3,4) size=2 to A",
            "North: fire at=(3,4) size=2 to North.C",
        ],
    );
    assert_eq!(told, unindent(
        "no class takes the event `fier`; did you mean `fire`?
         event `fire` has no field `sise`; did you mean `size`?
         field `size`: `300` is out of range: expected a whole number from 0 to 255; write a value such as `size=1`
         field `at`: found `3`, expected `(x,y)`, such as `(1,1)`; write a value such as `at=(1,1)`
         field `kind`: `wod` is not allowed: expected `OIL` or `WOOD`; did you mean `WOOD`?
         event `fire` needs its fields: `size` is missing; add `size=1`, with a whole number from 0 to 255 for `size`
         no component `North.B` takes the event `fire`; remove `to`, or name a component that takes it, such as `A`
         no component `AA` takes the event `fire`; did you mean `A`?
         no component in the site `South` takes the event `fire`; it is taken in `North`: write the site first, as in `North: fire ...`
         no component `A` takes the event `fire`; remove `to`, or name a component that takes it, such as `North.B`
         [0.020 s] North.C: sees a fire at (3,4) of 2 None None None by 4294967295 at 0.015 s"
    ));
}

#[test]
fn an_event_that_nobody_takes_is_a_warning() {
    let (told, _) = told("Player player period=10 lines=[fire; flood size=1 to A]");
    assert_eq!(
        told,
        unindent(
            "[0.010 s] Player: the event `fire` has no receiver: no component that takes it runs in this site
         [0.010 s] Player: the event `flood size=1 to A` has no receiver: no component that takes it runs in this site"
        )
    );
}

#[test]
fn events_that_nobody_takes_are_told_once_in_an_execution_and_counted() {
    let names: Vec<String> = (0..20).map(|number| format!("flood{number}")).collect();
    let storms = vec!["storm size=1"; 50_000].join("; ");
    let (told, _) =
        told(&format!("Player player period=10 lines=[fire; {storms}; storm size=2; {}]", names.join("; ")));
    let lines: Vec<&str> = told.lines().collect();
    let nobody = "has no receiver: no component that takes it runs in this site";
    assert_eq!(lines[0], format!("[0.010 s] Player: the event `fire` {nobody}"));
    assert_eq!(lines[1], format!("[0.010 s] Player: the event `storm size=1` {nobody}"));
    assert_eq!(lines[15], format!("[0.010 s] Player: the event `flood13` {nobody}"));
    let counted = "\
[0.010 s] Player: 50000 more events `storm` have no receiver
[0.010 s] Player: 6 more events of other names have no receiver";
    assert_eq!(lines[16..].join("\n"), counted);
}
