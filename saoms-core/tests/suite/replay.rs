//! A component runs again alone, on what it got then.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex};

use saoms_api::host::{DynComponent, PropertyValue, Registration, SmolStr};
use saoms_api::{Class, Component, Context, Failure, Message, Own, Publisher, Saved, Subscription, Time, record};
use saoms_core::observe::Observer;
use saoms_core::replay::{Replay, Side};
use saoms_core::schedule::{RunningFleet, Settings};
use saoms_core::tape::{Step, StepKind};
use saoms_lang::registry::{Provider, Registry};

use crate::actor::{Actor, Callee, EchoReference, TALK, Words};
use crate::fleet::{assembly_of, real, simulated};

/// Keeps the tapes of all components.
#[derive(Default)]
struct Tapes(Mutex<BTreeMap<String, Vec<Step>>>);

impl Observer for Tapes {
    fn wants_tape(&self, _: &str) -> bool {
        true
    }

    fn step(&self, component: &str, step: &Step) {
        self.0.lock().unwrap().entry(component.to_owned()).or_default().push(step.clone());
    }
}

#[derive(Clone, Debug, Message)]
struct State {
    seen: u64,
}

macro_rules! guard {
    ($name:ident, $class:literal, $limit:literal) => {
        /// Sounds an alarm when it has seen too much.
        #[derive(Class)]
        #[class(name = $class, periodic, saves)]
        struct $name {
            /// What it adds in each execution.
            #[property(default = 1, live)]
            step: u64,
            /// Its execution that fails.
            #[property(default = 0)]
            fails: u64,
            #[reference(optional)]
            peer: EchoReference,
            #[publishes(TALK)]
            words: Publisher<Words>,
            #[subscribes(TALK)]
            heard: Subscription<Words>,
            seen: u64,
        }

        impl Component for $name {
            type Properties = Own<Self>;

            fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                let (kept, goes_on) = (context.kept().len(), context.goes_on());
                context.symptom(record!(begins: "begins with {kept}, goes on: {goes_on}", kept, goes_on));
                Ok(())
            }

            fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                for (header, words) in context.receive(&self.heard).with_headers() {
                    let by = context.sender_name(header).unwrap_or("nobody").to_owned();
                    context.because(header.cause);
                    context.symptom(record!("hears {words} by {by}", words = words.text.len() as u64, by = by.as_str()));
                }
                self.seen += self.step;
                let chance = context.chance().below(100);
                let text = match self.peer.echo(context, format!("{chance}")) {
                    Ok(answer) => answer,
                    Err(error) => error.to_string(),
                };
                if context.execution() + 1 == self.fails {
                    return Err("it was told to".into());
                }
                if self.seen > $limit {
                    context.symptom(record!(too_much: "has seen {seen}", seen = self.seen));
                    context.decision(record!(alarm: "sounds the alarm"));
                    let (now, due, date) = (context.now(), context.due(), context.date().is_some());
                    let text = format!("{text} at {} of {} {date}", now.as_nanos(), due.as_nanos());
                    context.keep(self.seen, text.as_bytes())?;
                    context.send(&self.words, Words { text })?;
                    context.effect(record!("has said so"));
                    context.count("alarms", 1);
                }
                Ok(())
            }

            fn save(&mut self) -> Result<Saved, Failure> {
                Ok(Saved::of(&State { seen: self.seen }))
            }

            fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
                self.seen = saved.read::<State>()?.map_or(0, |state| state.seen);
                Ok(())
            }
        }
    };
}

guard!(Guard, "guard", 5);
guard!(PatientGuard, "patient", 7);

/// Another build of the class `guard`.
#[derive(Debug)]
struct Rebuilt;

impl Provider for Rebuilt {
    fn construct(&self, values: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        Registration::of::<PatientGuard>().construct(values)
    }

    fn origin(&self) -> Option<&Path> {
        None
    }
}

fn registry() -> Registry {
    let mut registry = Registry::new();
    for class in [Registration::of::<Actor>(), Registration::of::<Callee>(), Registration::of::<Guard>()] {
        registry.add(class).unwrap();
    }
    registry
}

fn recorded(fleet: &str, settings: Settings) -> BTreeMap<String, Vec<Step>> {
    let tapes = Arc::new(Tapes::default());
    let fleet = assembly_of(fleet, &registry());
    RunningFleet::start(fleet, settings, vec![tapes.clone()]).unwrap().run_to_end();
    let steps = tapes.0.lock().unwrap();
    steps.clone()
}

/// A fleet of which something fails, is served, reacts, begins again and ends.
const FLEET: &str = "G guard peer=C period=10 restart=15/3 fails=9
     C callee publishes=TALK called=[say served; say-random; count calls 2]
     A actor period=10 delay=5 publishes=[TALK TABLE] subscribes=TALK first=[say begins; number; time] \
       each=[say-random; put 1 2; random; hear-from; 3: panic on purpose] last=[say ends; done] restart=5/9
     B actor period=20 task=G peer=G subscribes=[TALK TABLE] trigger=TALK reacts=[hear; ask busy; running] \
       each=[read; record 2; decide 1; 4: unschedule; 8: schedule]";

#[test]
fn each_component_does_what_it_did() {
    for settings in [simulated(400), real(150)] {
        let tapes = recorded(FLEET, settings);
        assert_eq!(tapes.keys().map(String::as_str).collect::<Vec<_>>(), ["A", "B", "C", "G"]);
        for (component, steps) in &tapes {
            let mut replay = Replay::new(component, registry());
            for step in steps {
                assert_eq!(replay.step(step), None, "{component}");
            }
            let counts = replay.counts();
            assert_eq!((counts.replayed, &counts.ends[..]), (steps.len() as u64, &[][..]), "{component}");
        }
        let kinds = |component: &str, kind| tapes[component].iter().filter(|step| step.kind == kind).count();
        assert!(kinds("C", StepKind::Serve) > 5 && kinds("B", StepKind::React) > 5);
        assert!(kinds("A", StepKind::Start) > 1 && kinds("B", StepKind::Shutdown) > 0);
    }
    let tapes = recorded(FLEET, simulated(400));
    assert!(
        tapes["G"].iter().filter(|step| step.kind == StepKind::Start).count() > 2,
        "it fails, and is scheduled again"
    );
    assert_eq!(recorded(FLEET, simulated(400)), tapes, "equal runs have equal tapes");
}

#[test]
fn another_build_differs_where_it_decides_otherwise() {
    let tapes = recorded("G guard peer=C period=10\nC callee", simulated(100));
    let mut rebuilt = Registry::new();
    rebuilt.add_provided(Registration::of::<Guard>().declaration(), Arc::new(Rebuilt)).unwrap();
    let mut replay = Replay::new("G", rebuilt);
    let differences: Vec<_> = tapes["G"].iter().filter_map(|step| replay.step(step)).collect();
    let places: Vec<_> = differences.iter().map(|one| (one.time, one.execution)).collect();
    let at = |milliseconds: u64| Time::from_nanos(milliseconds * 1_000_000);
    assert_eq!(places[..2], [(at(50), 5), (at(60), 6)]);
    let lines = &differences[0].lines;
    let told: String = lines.iter().map(|(side, line)| format!("{side:?} {line}\n")).collect();
    assert!(told.starts_with("Both calls peer.echo {\"text\":\""), "{told}");
    assert!(told.contains("Then symptom: has seen 6\nThen decision: sounds the alarm\nThen keeps under 6 "), "{told}");
    assert!(told.contains("Then sends TALK {\"text\":\"") && told.contains("Then effect: has said so\n"), "{told}");
    assert!(!lines.iter().any(|(side, _)| *side == Side::Now), "{told}");
    assert_eq!(replay.counts().differing, differences.len() as u64);
}

#[test]
fn a_composite_of_today_gives_other_values_and_live_ones_change_then() {
    let tapes = recorded("G guard peer=C period=10\nC callee", simulated(100));
    let spec = assembly_of("G guard peer=C period=10 step=6\nC callee", &registry()).components.remove(0);
    let mut replay = Replay::new("G", registry()).with(spec);
    let differences: Vec<_> = tapes["G"].iter().filter_map(|step| replay.step(step)).collect();
    assert_eq!(differences[0].execution, 0);
    assert!(differences[0].lines.iter().any(|line| *line == (Side::Now, "symptom: has seen 6".to_owned())));
}

#[test]
fn a_step_that_was_lost_ends_a_replay_until_the_next_start() {
    let steps = &recorded(FLEET, simulated(400))["G"];
    let starts: Vec<usize> = (0..steps.len()).filter(|place| steps[*place].kind == StepKind::Start).collect();
    let mut replay = Replay::new("G", registry());
    for (_, step) in steps.iter().enumerate().filter(|(place, _)| *place != 3) {
        assert_eq!(replay.step(step), None);
    }
    let counts = replay.counts();
    assert_eq!(counts.replayed, (3 + steps.len() - starts[1]) as u64);
    assert_eq!(counts.ends.len(), 1);
    assert_eq!(counts.ends[0].why, "the recording lacks 1 of its steps, which were lost");

    let mut replay = Replay::new("G", registry());
    steps[1..].iter().for_each(|step| drop(replay.step(step)));
    assert_eq!(replay.counts().ends[0].why, "the recording begins in the middle of its run");
    let mut replay = Replay::new("G", Registry::new());
    let difference = steps.iter().find_map(|step| replay.step(step)).unwrap();
    assert_eq!(
        difference.lines.last().unwrap(),
        &(Side::Now, "fails: there is no class `guard`: name its library by `--plugin`".to_owned())
    );
}
