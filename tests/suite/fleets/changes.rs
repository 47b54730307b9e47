//! A running airport is changed again and again, and a third of the changes is made to fail: no robots collide, no
//! luggage is lost, and what does not change misses nothing.
//!
//! `SAOMS_CHANGES=2000` makes it a long one, and `SAOMS_SEED` another one.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::thread::{scope, sleep};
use std::time::Duration;

use saoms_api::host::cdr;
use saoms_api::{Chance, Class, Component, Context, Failure, Message, Publisher, Saved, Time, Topic, Work, interface};
use saoms_components::messages::{ENVIRONMENT, EnvironmentEvent, Fault};
use saoms_core::observe::InvariantWatch;
use saoms_core::report::RunStatus;
use saoms_core::schedule::{ChangeOptions, InjectedContent, Injection, PlannedChanges, RunningFleet, Settings};
use saoms_lang::assembly::Assembly;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_tools::diagnostics::human_of;
use serde_json::json;

use crate::support::project;

/// Number of changes, unless `SAOMS_CHANGES` says another one.
const CHANGES: usize = 200;

/// A time that all periods divide, in milliseconds.
const STEP: u64 = 400;

#[derive(Clone, Debug, Default, Message)]
struct Level {
    level: u32,
    executions: u32,
}

const LEVELS: Topic<Level> = Topic::state("LEVELS");

/// Says what level is asked for.
#[interface(name = "test.Desk")]
trait Desk {
    /// A number that grows with each call.
    fn ask(&mut self, context: &mut Context<'_>) -> Result<u32, Failure>;
}

/// A desk.
#[derive(Class)]
#[class(name = "test.DeskImpl", passive, saves, service("desk": Desk))]
struct DeskImpl {
    asked: u32,
}

impl Component for DeskImpl {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(DeskImpl { asked: 0 })
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&Level { level: 0, executions: self.asked }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.asked = saved.read::<Level>()?.unwrap_or_default().executions;
        Ok(())
    }
}

impl Desk for DeskImpl {
    fn ask(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        self.asked += 1;
        Ok(self.asked)
    }
}

/// Counts its executions, and fails where it is asked to.
#[derive(Class)]
#[class(name = "test.Gauge", periodic, saves)]
struct Gauge {
    /// What it says.
    #[property(default = 0, live)]
    level: u32,
    /// Another one makes another gauge of it.
    #[property(default = 0)]
    size: u32,
    /// Where it fails: `initialize`, `restore`, `save`, `level` or `leaving`.
    #[property(default = "")]
    fails: String,
    /// True if it is to leave.
    #[property(default = false, live)]
    leaving: bool,
    #[reference("desk")]
    desk: Option<DeskReference>,
    #[publishes(LEVELS)]
    levels: Publisher<Level>,
    executions: u32,
}

impl Gauge {
    fn fails_at(&self, what: &str) -> Result<(), Failure> {
        if self.fails == what { Err(Failure::new(format!("planted at {what}"))) } else { Ok(()) }
    }
}

impl Component for Gauge {
    type Properties = saoms_api::Own<Self>;

    fn initialize(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.fails_at("initialize")
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.executions += 1;
        if self.leaving {
            context.vote(Work::Done);
        }
        if let Some(desk) = &self.desk {
            desk.ask(context)?;
        }
        context.send(&self.levels, Level { level: self.level, executions: self.executions })
    }

    fn update(&mut self, properties: Self::Properties) -> Result<(), Failure> {
        if properties.level != self.level {
            self.fails_at("level")?;
        }
        if properties.leaving {
            self.fails_at("leaving")?;
        }
        (self.level, self.leaving) = (properties.level, properties.leaving);
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        self.fails_at("save")?;
        Ok(Saved::of(&Level { level: self.level, executions: self.executions }))
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.fails_at("restore")?;
        self.executions = saved.read::<Level>()?.unwrap_or_default().executions;
        Ok(())
    }
}

/// Counts, and keeps nothing.
#[derive(Class)]
#[class(name = "test.Plain", periodic)]
struct Plain {
    /// Another one makes another one of it.
    #[property(default = 0)]
    size: u32,
    executions: u32,
}

impl Component for Plain {
    type Properties = saoms_api::Own<Self>;

    fn execute(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        self.executions += self.size.min(1);
        Ok(())
    }
}

/// What the airport is to be.
#[derive(Clone, Debug)]
struct Wish {
    /// The robots, and their periods.
    robots: BTreeMap<u32, u32>,
    period_of_master: u32,
    ahead: u32,
    /// The place of its zones in `BORDERS`.
    borders: usize,
    level: u32,
    size: u32,
    plain: u32,
    is_plain: bool,
    desk: u32,
    topic: u32,
    failure: Option<Planted>,
}

/// A failure that is planted.
#[derive(Clone, Copy, Debug)]
enum Planted {
    /// A new component cannot initialize, at this place among the others.
    Initialize(u32),
    /// A new instance cannot restore the state of the present one.
    Restore,
    /// A component does not save its state now.
    Save,
    /// A component refuses a value.
    Level,
    /// A component does not leave.
    Leaving,
}

/// What changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Added,
    Removed,
    Replaced,
    Lost,
    Class,
    Set,
    Wires,
    Topics,
    Zone,
    Borders,
}

/// First column and row, and number of columns and rows, of each zone.
const BORDERS: [&[(u32, u32, u32, u32)]; 5] = [
    &[(0, 0, 11, 11)],
    &[(0, 0, 5, 11), (5, 0, 6, 11)],
    &[(0, 0, 7, 11), (7, 0, 4, 11)],
    &[(0, 0, 11, 5), (0, 5, 4, 6), (4, 5, 7, 6)],
    &[(4, 0, 7, 5), (0, 0, 4, 11), (4, 5, 7, 6)],
];

const KINDS: [Kind; 10] = [
    Kind::Added,
    Kind::Removed,
    Kind::Replaced,
    Kind::Lost,
    Kind::Class,
    Kind::Set,
    Kind::Wires,
    Kind::Topics,
    Kind::Zone,
    Kind::Borders,
];

impl Wish {
    /// One that differs in this.
    fn with(&self, kind: Kind, chance: &mut Chance) -> Wish {
        let mut next = Wish { failure: None, ..self.clone() };
        let mut one_of = |all: Vec<u32>| all[chance.below(all.len() as u64) as usize];
        let present: Vec<u32> = self.robots.keys().copied().collect();
        match kind {
            Kind::Added => {
                let absent: Vec<u32> = (1..=10).filter(|robot| !present.contains(robot)).collect();
                next.robots.insert(one_of(absent), 100);
            }
            Kind::Removed => _ = next.robots.remove(&one_of(present)),
            Kind::Replaced => match one_of(vec![0, 1, 2]) {
                0 => _ = next.robots.entry(one_of(present)).and_modify(|period| *period = 300 - *period),
                1 => next.period_of_master = 300 - self.period_of_master,
                _ => next.size += 1,
            },
            Kind::Lost => next.plain += 1,
            Kind::Class => next.is_plain = !self.is_plain,
            Kind::Set => next.level += 1,
            Kind::Wires => next.desk = 3 - self.desk,
            Kind::Topics => next.topic += 1,
            Kind::Zone => next.ahead = if self.ahead == 3 { 2 } else { 3 },
            Kind::Borders => {
                let others = (0..BORDERS.len() as u32).filter(|other| *other as usize != self.borders);
                next.borders = one_of(others.collect()) as usize;
            }
        }
        next
    }

    /// Its zones, from the only one of the airport.
    fn zones(&self, zone: &str) -> impl Iterator<Item = String> {
        (1..).zip(BORDERS[self.borders]).map(|(number, (x, y, width, height))| {
            let value = |name: &str, value: u32| format!("<property name=\"{name}\">{value}</property>");
            let place = [value("x", *x), value("y", *y), value("width", *width), value("height", *height)].concat();
            let values = [value("ahead", self.ahead), value("number", number), place].concat();
            let zone = zone.replacen("\"Zone\"", &format!("\"Zone{number}\""), 1);
            let zone = zone.replace(">Zone<", &format!(">Zone{number}<"));
            zone.replacen("<reference", &format!("{values}<reference"), 1)
        })
    }

    /// Its composite: that of the airport, with these robots.
    fn composite(&self, pieces: usize) -> String {
        let airport = project("composites/airport.composite");
        let (head, scenario) = airport.split_once("<property name=\"scenario\">").unwrap();
        let (_, tail) = scenario.split_once("</property>").unwrap();
        let work = format!(
            "from 1s every 6s {pieces} times luggage (2,0)..(4,10) to (7,0)..(10,10)\n\
             from 4s every 6s {pieces} times luggage (7,0)..(10,10) to (2,0)..(4,10)"
        );
        let text = format!("{head}<property name=\"scenario\">{work}</property>{tail}");
        let parts: Vec<&str> = text.split("<component name=").collect();
        let mut components: Vec<String> = Vec::new();
        for part in &parts[1..] {
            let part = part.replace("</composite>", "");
            let period = |text: &str, period: u32| {
                text.replace(
                    "<property name=\"period\" source=\"$period\"/>",
                    &format!("<property name=\"period\">{period}</property>"),
                )
            };
            let robot = part.strip_prefix("\"Robot").and_then(|rest| rest[..3].parse::<u32>().ok());
            let part = match robot {
                Some(robot) => match self.robots.get(&robot) {
                    Some(own) => period(&part, *own),
                    None => continue,
                },
                None if part.starts_with("\"MasterEnvironment\"") => period(&part, self.period_of_master),
                None if part.starts_with("\"Zone\"") => {
                    components.extend(self.zones(&part));
                    continue;
                }
                None => part,
            };
            components.push(part);
        }
        let gauge = |name: &str, more: &str| {
            format!(
                "\"{name}\"><implementation.rust class=\"test.Gauge\"/><property name=\"ID\">{name}</property>\
                 <property name=\"period\">50</property>{more}</component>"
            )
        };
        let value = |name: &str, value: &str| format!("<property name=\"{name}\">{value}</property>");
        let is_planted = |what: fn(&Planted) -> bool| self.failure.as_ref().is_some_and(what);
        let number = |number: u32| number.to_string();
        let desk = format!("<reference name=\"desk\" target=\"Desk{}\"/>", self.desk);
        let topic = value("topicRename", &format!("LEVELS,LEVELS{}", self.topic));
        components.push(gauge(
            "Gauge",
            &[value("level", &number(self.level)), value("size", &number(self.size)), topic].concat(),
        ));
        components.push(gauge("Asker", &desk));
        components.push(gauge("Still", ""));
        let restore = if is_planted(|one| matches!(one, Planted::Restore)) { "restore" } else { "" };
        components.push(gauge("Restorer", &[value("fails", restore), value("topicRename", "LEVELS,R")].concat()));
        let size = number(u32::from(is_planted(|one| matches!(one, Planted::Save))));
        components.push(gauge("Miser", &[value("fails", "save"), value("size", &size)].concat()));
        let level = number(u32::from(is_planted(|one| matches!(one, Planted::Level))));
        components.push(gauge("Stubborn", &[value("fails", "level"), value("level", &level)].concat()));
        if !is_planted(|one| matches!(one, Planted::Leaving)) {
            components.push(gauge("Settler", &value("fails", "leaving")));
        }
        let class = if self.is_plain { "test.Plain" } else { "test.Gauge" };
        components.push(gauge("Changeling", &value("size", "1")).replace("test.Gauge", class));
        components.push(gauge("Plain", &value("size", &number(self.plain))).replace("test.Gauge", "test.Plain"));
        for desk in [1, 2] {
            components.push(format!("\"Desk{desk}\"><implementation.rust class=\"test.DeskImpl\"/></component>"));
        }
        if let Some(Planted::Initialize(place)) = self.failure {
            let place = place as usize % components.len();
            let world = "<reference name=\"desk\" target=\"Desk1\"/>";
            components.insert(place, gauge("Trap", &[&value("fails", "initialize"), world].concat()));
        }
        let components: String = components.iter().map(|one| format!("<component name={one}")).collect();
        format!("{}{components}</composite>", parts[0])
    }
}

fn compiled(text: &str, registry: &Registry) -> Assembly {
    let compilation = Project::new().text("airport.composite", text).in_memory().compile(registry);
    let shown = human_of(&compilation);
    compilation.output.unwrap_or_else(|| panic!("{shown}\n{text}"))
}

/// The executions of each component, those that it missed, and its period in milliseconds.
fn executions(fleet: &RunningFleet) -> BTreeMap<String, (u64, u64, Option<u64>)> {
    let status = fleet.handle().status();
    let all = status.components.into_iter();
    all.map(|one| {
        (one.report.name.into(), (one.report.executions, one.report.missed, one.period_ms.map(|ms| ms as u64)))
    })
    .collect()
}

fn touched(plan: &PlannedChanges) -> BTreeSet<String> {
    let members = plan.added.iter().chain(&plan.removed).map(|one| one.component.clone());
    let replaced = plan.replaced.iter().map(|one| one.component.clone());
    members.chain(replaced).chain(plan.set.iter().map(|one| one.component.clone())).collect()
}

#[test]
fn an_airport_that_changes_again_and_again_loses_nothing() {
    let number = |name: &str| std::env::var(name).ok().and_then(|number| number.parse::<u32>().ok());
    let changes = number("SAOMS_CHANGES").map_or(CHANGES, |changes| changes as usize);
    let seed = u64::from(number("SAOMS_SEED").unwrap_or(24));
    let registry = Registry::linked().unwrap();
    let mut chance = Chance::new(seed);
    let pieces = changes / 2;
    let mut present = Wish {
        robots: (1..=10).map(|robot| (robot, 100)).collect(),
        period_of_master: 100,
        ahead: 3,
        borders: 0,
        level: 0,
        size: 0,
        plain: 0,
        is_plain: false,
        desk: 1,
        topic: 0,
        failure: None,
    };
    let watch = Arc::new(InvariantWatch::default());
    let assembly = |wish: &Wish| compiled(&wish.composite(pieces), &registry);
    let settings = Settings { limit: Some(Duration::from_secs(100_000)), ..Settings::simulated(seed) };
    let fleet = RunningFleet::start(assembly(&present), settings, vec![watch.clone()]).unwrap();
    let handle = fleet.handle();
    let hold = handle.hold();
    let (mut now, mut history) = (0, Vec::new());
    let mut made: BTreeMap<Kind, (u32, u32)> = BTreeMap::new();
    for change in 0..changes {
        now += STEP * (1 + chance.below(6));
        fleet.run_until(Time::from_nanos(now * 1_000_000));
        let (before, since) = (executions(&fleet), now);
        let mut draw = chance.clone();
        let count = |kind: &&Kind| (made.get(kind).map_or(0, |(all, _)| *all), draw.below(1000));
        let kind = match *KINDS.iter().min_by_key(count).unwrap() {
            Kind::Added if present.robots.len() == 10 => Kind::Removed,
            Kind::Removed if present.robots.len() < 6 => Kind::Added,
            kind => kind,
        };
        let mut wanted = present.with(kind, &mut chance);
        if chance.below(3) == 0 {
            wanted.failure = Some(match chance.below(5) {
                0 => Planted::Initialize(chance.below(1000) as u32),
                1 => Planted::Restore,
                2 => Planted::Save,
                3 => Planted::Level,
                _ => Planted::Leaving,
            });
        }
        let next = assembly(&wanted);
        let plan = handle.plan(&next);
        assert!(!plan.is_empty() && plan.refused.is_empty(), "{change}: {kind:?}: {plan:?}");
        let options = ChangeOptions { wait: Duration::from_secs(600), ..ChangeOptions::allowing_loss() };
        // Those that leave need time for it, which passes here.
        let result = scope(|scope| {
            let handle = handle.clone();
            let next = &next;
            let apply = scope.spawn(move || handle.apply(next, options));
            while !apply.is_finished() {
                if !plan.removed.is_empty() || kind == Kind::Class {
                    now += STEP;
                    fleet.run_until(Time::from_nanos(now * 1_000_000));
                }
                sleep(Duration::from_millis(1));
            }
            apply.join().unwrap()
        });
        let told = || format!("change {change} after {since} ms, {kind:?}, {:?}: {result:?}", wanted.failure);
        assert_eq!(result.is_err(), wanted.failure.is_some(), "{}", told());
        history.push(told());
        let made = made.entry(kind).or_default();
        (made.0, made.1) = (made.0 + 1, made.1 + u32::from(result.is_err()));
        if result.is_ok() {
            present = wanted.clone();
            // Somebody takes it away: where it stands it would be in the way of others.
            for robot in plan.removed.iter().filter_map(|one| one.component.strip_prefix("Robot")) {
                let robot: u32 = robot.parse().unwrap();
                let gone = EnvironmentEvent::from(Fault::gone(robot));
                let content = InjectedContent::Bytes(cdr::encode(&gone));
                let (topic, text) = (ENVIRONMENT.name().to_owned(), format!("gone Robot{robot:03}"));
                handle.inject(Injection { topic, content, at: None, text }).unwrap();
            }
        }
        let left = handle.plan(&assembly(&present));
        assert!(left.is_empty(), "{}: {left:?}", told());
        now += STEP;
        fleet.run_until(Time::from_nanos(now * 1_000_000));
        let after = executions(&fleet);
        let touched = touched(&plan);
        for (name, (count, missed, period)) in after.iter().filter(|(name, _)| !touched.contains(*name)) {
            let (known, missed_before, _) = before.get(name).unwrap_or_else(|| panic!("{}: {name} is new", told()));
            assert_eq!(missed, missed_before, "{}: {name}", told());
            let expected = period.map_or(0, |period| (now - since) / period);
            assert_eq!(count - known, expected, "{}: {name} from {since} ms", told());
        }
    }
    drop(hold);
    let report = fleet.run_to_end();
    assert_eq!(report.outcome.status, RunStatus::Done, "{:?}, {:?}", report.outcome, report.sections);
    let violations = watch.violations();
    let violations = violations.iter().map(|one| format!("[{}] {}: {}", one.at, one.invariant, one.text));
    let violations: Vec<String> = violations.collect();
    assert!(violations.is_empty(), "{}\nafter\n{}", violations.join("\n"), history.join("\n"));
    let luggage = report.sections.get("luggage").unwrap();
    assert_eq!((&luggage["delivered"], &luggage["given_up"]), (&luggage["requested"], &0.into()), "{luggage}");
    assert_eq!(luggage["requested"], 2 * pieces, "{luggage}");
    let collisions = report.sections.get("collisions").unwrap();
    assert_eq!(*collisions, json!({"vertex": 0, "swap": 0}));
    if changes >= 200 {
        assert!(made.values().all(|(all, _)| *all >= 15), "{made:?}");
    }
    let failed: u32 = made.values().map(|(_, failed)| failed).sum();
    assert!(failed > 0 && made.len() == KINDS.len(), "{made:?}");
}
