//! An airport in real time is changed again and again by `saoms apply`, and every third change is made to fail: no
//! robots collide, no luggage is lost, and what does not change misses nothing.
//!
//! `SAOMS_CHANGES=200` makes it a long one, and `SAOMS_SEED` another one.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::time::{Duration, Instant};

use saoms_api::Chance;
use serde_json::Value;

use super::{Running, component};
use crate::boundary::build::library;
use crate::support::{code, project, stdout, text};

/// Number of changes, unless `SAOMS_CHANGES` says another one.
const CHANGES: usize = 30;

/// First column and row, and number of columns and rows, of each zone.
const BORDERS: [&[[u32; 4]]; 3] =
    [&[[0, 0, 11, 11]], &[[0, 0, 5, 11], [5, 0, 6, 11]], &[[0, 0, 11, 5], [0, 5, 4, 6], [4, 5, 7, 6]]];

/// What changes.
const KINDS: [&str; 10] =
    ["added", "removed", "replaced", "lost", "class", "set", "wires", "topics", "zone", "borders"];

/// How a change fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Planted {
    /// A new component misbehaves so in its code, at this place among the others.
    Trap(&'static str, &'static str, usize),
    /// A component does not save its state.
    Save,
    /// A component refuses a value.
    Value,
}

/// What the airport is to be.
#[derive(Clone, Debug)]
struct Wish {
    robots: BTreeSet<u32>,
    /// Number of changes of each kind, from which its values follow.
    made: BTreeMap<&'static str, usize>,
    planted: Option<Planted>,
}

impl Wish {
    fn with(&self, kind: &'static str, chance: &mut Chance) -> Wish {
        let mut next = Wish { planted: None, ..self.clone() };
        *next.made.entry(kind).or_default() += 1;
        let mut one_of = |all: Vec<u32>| all[chance.below(all.len() as u64) as usize];
        match kind {
            "added" => _ = next.robots.insert(one_of((1..=10).filter(|robot| !self.robots.contains(robot)).collect())),
            "removed" => _ = next.robots.remove(&one_of(self.robots.iter().copied().collect())),
            _ => {}
        }
        next
    }

    fn plant(&mut self, chance: &mut Chance) {
        let place = chance.below(1000) as usize;
        let planted = match chance.below(5) {
            0 => Planted::Trap("initialize", "fail", place),
            1 => Planted::Trap("initialize", "panic", place),
            2 => Planted::Trap("initialize", "never", place),
            3 => Planted::Save,
            _ => Planted::Value,
        };
        self.planted = Some(planted);
    }

    /// How often it has changed so.
    fn times(&self, kind: &str) -> usize {
        self.made.get(kind).copied().unwrap_or(0)
    }

    /// Its composite: that of the airport, with these robots.
    fn composite(&self) -> String {
        let airport = project("composites/airport.composite");
        let (head, scenario) = airport.split_once("<property name=\"scenario\">").unwrap();
        let (_, tail) = scenario.split_once("</property>").unwrap();
        let work = "<property name=\"scenario\">at 500ms luggage (3,1) to (9,10)</property>";
        let world = "<property name=\"moveTime\">100ms</property><property name=\"handlingTime\">100ms</property>";
        let text = format!("{head}{work}{tail}").replacen(
            "<property name=\"width\"",
            &format!("{world}<property name=\"width\""),
            1,
        );
        let parts: Vec<&str> = text.split("<component name=").collect();
        let is_odd = |kind: &str| self.times(kind) % 2 == 1;
        let is_planted = |planted: Planted| self.planted == Some(planted);
        let value = |name: &str, value: &str| format!("<property name=\"{name}\">{value}</property>");
        let mut components: Vec<String> = Vec::new();
        for part in &parts[1..] {
            let part = part.replace("</composite>", "");
            let robot = part.strip_prefix("\"Robot").and_then(|rest| rest[..3].parse::<u32>().ok());
            match robot {
                Some(robot) if !self.robots.contains(&robot) => {}
                // Its battery lasts for ever: it moves faster than one is made for.
                Some(_) => components.push(part.replacen("<reference", &(value("discharge", "0") + "<reference"), 1)),
                _ if part.starts_with("\"MasterEnvironment\"") && is_odd("replaced") => components
                    .push(part.replace("<property name=\"period\" source=\"$period\"/>", &value("period", "200"))),
                _ if part.starts_with("\"Zone\"") => components.extend(self.zones(&part)),
                _ => components.push(part),
            }
        }
        let test = |name: &str, class: &str, more: &str| {
            // What it says is read by nobody else.
            let topic = if more.contains("topicRename") {
                String::new()
            } else {
                value("topicRename", &format!("WORDS,{name}"))
            };
            let more = [more, &topic, &value("queue", "100000")].concat();
            let whole = component(name, class, &more).replace("period\">50<", "period\">100<");
            whole.trim_start_matches("<component name=").to_owned()
        };
        let period =
            |fleet: String, slow: bool| if slow { fleet.replace("period\">100<", "period\">200<") } else { fleet };
        let planted = |at: &str, does: &str| value("at", at) + &value("does", does);
        components.push(test("Still", "bad.Actor", ""));
        components.push(period(test("Plain", "bad.Actor", ""), is_odd("lost")));
        components.push(test("Changeling", if is_odd("class") { "bad.Motor" } else { "bad.Actor" }, ""));
        components.push(test("Dial", "bad.Motor", &value("speed", &self.times("set").to_string())));
        let callee = if is_odd("wires") { "Callee1" } else { "Callee2" };
        let wire = format!("<reference name=\"callee\" target=\"{callee}/callee\"/>");
        components.push(test("Caller", "bad.Actor", &wire));
        components.push(test("Callee1", "bad.Actor", ""));
        components.push(test("Callee2", "bad.Actor", ""));
        components.push(test("Namer", "bad.Actor", &value("topicRename", &format!("WORDS,N{}", self.times("topics")))));
        components.push(period(test("Miser", "bad.Motor", &planted("save", "fail")), is_planted(Planted::Save)));
        let speed = value("speed", if is_planted(Planted::Value) { "1" } else { "0" });
        components.push(test("Stubborn", "bad.Motor", &[planted("update", "fail"), speed].concat()));
        if let Some(Planted::Trap(at, does, place)) = self.planted {
            components.insert(place % components.len(), test("Trap", "bad.Actor", &planted(at, does)));
        }
        let components: String = components.iter().map(|one| format!("<component name={one}")).collect();
        format!("{}{components}</composite>", parts[0])
    }

    /// Its zones, from the only one of the airport.
    fn zones(&self, zone: &str) -> impl Iterator<Item = String> {
        let ahead = if self.times("zone") % 2 == 1 { 2 } else { 3 };
        (1..).zip(BORDERS[self.times("borders") % BORDERS.len()]).map(move |(number, place)| {
            let value = |(name, value): (&str, u32)| format!("<property name=\"{name}\">{value}</property>");
            let [x, y, width, height] = *place;
            let values =
                [("ahead", ahead), ("number", number), ("x", x), ("y", y), ("width", width), ("height", height)];
            let values = values.map(value).concat();
            let zone = zone.replacen("\"Zone\"", &format!("\"Zone{number}\""), 1);
            let zone = zone.replace(">Zone<", &format!(">Zone{number}<"));
            zone.replacen("<reference", &format!("{values}<reference"), 1)
        })
    }
}

/// The time of the run in milliseconds; and of each component how often it was due, and its period in milliseconds.
fn due(running: &Running) -> (f64, BTreeMap<String, (u64, f64)>) {
    let answer: Value = serde_json::from_str(&running.told(&["status", "--format", "json"])).unwrap();
    let status = &answer["status"];
    let all = status["components"].as_array().unwrap().iter().map(|one| {
        let number = |name: &str| one[name].as_u64().unwrap();
        let period = one["period_ms"].as_f64().unwrap_or(f64::INFINITY);
        (one["name"].as_str().unwrap().to_owned(), (number("executions") + number("missed"), period))
    });
    (status["time_s"].as_f64().unwrap() * 1e3, all.collect())
}

/// Checks that components were due as often as the time of the run says: none was left out, and none twice. The last
/// execution may be on its way.
fn compare(
    before: &(f64, BTreeMap<String, (u64, f64)>),
    after: &(f64, BTreeMap<String, (u64, f64)>),
    but: &BTreeSet<String>,
    told: &str,
) {
    for (name, (count, period)) in after.1.iter().filter(|(name, _)| !but.contains(*name)) {
        let (known, _) = before.1.get(name).unwrap_or_else(|| panic!("{told}: {name} is new"));
        let expected = (after.0 - before.0) / period;
        let difference = (count - known) as f64 - expected;
        assert!(difference.abs() <= 2.0, "{told}: {name} was due {} times, and not {expected}", count - known);
    }
}

/// The components of a plan.
fn touched(plan: &Value) -> BTreeSet<String> {
    let of = |kind: &str| plan[kind].as_array().cloned().unwrap_or_default();
    let all = ["added", "removed", "replaced", "set"].map(of).concat();
    all.iter().map(|one| one["component"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn an_airport_that_is_applied_again_and_again_loses_nothing() {
    let number = |name: &str| std::env::var(name).ok().and_then(|number| number.parse::<u64>().ok());
    let changes = number("SAOMS_CHANGES").map_or(CHANGES, |changes| changes as usize);
    let mut chance = Chance::new(number("SAOMS_SEED").unwrap_or(24));
    let mut present = Wish { robots: (1..=8).collect(), made: BTreeMap::new(), planted: None };
    let plugin = library("bad");
    let arguments = ["--stay", "--invariants", "--grace", "1s", "--plugin", plugin.to_str().unwrap()];
    let running = Running::start(&present.composite(), &arguments);
    running.until("Robot001", |robot| robot["executions"].as_u64() > Some(3));
    let (begin, mut never, mut sent, mut failed) = (due(&running), BTreeSet::new(), 1, 0);
    for change in 0..changes {
        let kind = KINDS[change % KINDS.len()];
        let mut wanted = present.with(kind, &mut chance);
        if change % 3 == 0 {
            wanted.plant(&mut chance);
        }
        let [x, y, to_x, to_y] = [5, 11, 4, 11].map(|end| chance.below(end));
        running.told(&["send", &format!("luggage ({},{y}) to ({},{to_y})", x + 2, to_x + 7)]);
        sent += 1;
        fs::write(running.folder().join("other.composite"), wanted.composite()).unwrap();
        let planned = running.ask(&["plan", "other.composite", "--format", "json"]);
        assert_eq!(code(&planned), 3, "{change}, {kind}: {}", text(&planned));
        let plan: Value = serde_json::from_str(&stdout(&planned)).unwrap();
        let before = due(&running);
        // Each other robot that leaves has no time for it, and hands its job over.
        let wait = if wanted.times("removed") % 2 == 1 { "0s" } else { "60s" };
        let applied = running.ask(&["apply", "other.composite", "--allow-loss", "--wait", wait]);
        let told = format!("change {change}, {kind}, {:?}: {}", wanted.planted, text(&applied));
        assert_eq!(code(&applied), i32::from(wanted.planted.is_some()), "{told}");
        let ran = if wanted.planted.is_some() { "fleet.composite" } else { "other.composite" };
        assert_eq!(running.told(&["plan", ran]), "nothing to do\n", "{told}");
        let touched = touched(&plan["plan"]);
        compare(&before, &due(&running), &touched, &told);
        never.extend(touched);
        if wanted.planted.is_some() {
            failed += 1;
            continue;
        }
        // Somebody takes away who left: where it stands it would be in the way of others.
        for robot in present.robots.difference(&wanted.robots) {
            running.told(&["send", &format!("gone Robot{robot:03}")]);
        }
        fs::rename(running.folder().join("other.composite"), running.folder().join("fleet.composite")).unwrap();
        present = wanted;
    }
    assert!(3 * failed >= changes, "{failed} of {changes} failed");
    // Over the whole time, too.
    let end = due(&running);
    assert!(["World", "Environment", "Still"].iter().all(|name| !never.contains(*name)), "{never:?}");
    compare(&begin, &end, &never, "all changes");
    let until = Instant::now() + Duration::from_secs(120);
    while running.component("World")["values"]["delivered"] != sent {
        assert!(Instant::now() < until, "{sent} were sent: {}", running.component("World"));
    }
    assert_eq!(running.component("World")["values"]["given_up"], 0);
    running.told(&["down"]);
    let (code, text) = running.end();
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains(&format!("{sent} of {sent} pieces of luggage delivered, no collision")), "{text}");
}
