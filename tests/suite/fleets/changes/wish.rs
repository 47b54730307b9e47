//! What a changing airport is to be, and the failures that are planted in its changes.

use std::collections::BTreeMap;

use saoms_api::Chance;

use super::gauges::How;
use crate::support::project;

/// What the airport is to be.
#[derive(Clone, Debug)]
pub(super) struct Wish {
    /// The robots, and their periods.
    pub(super) robots: BTreeMap<u32, u32>,
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
    pub(super) failure: Option<Planted>,
}

/// The step of a change at which it fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Step {
    /// A new component initializes, at some place among the others.
    Initialize,
    /// The same, and another new one is to shut down again.
    Undo,
    /// A new instance restores the state of the present one.
    Restore,
    /// A component saves its state.
    Save,
    /// A component takes a value.
    Level,
    /// A component is to leave.
    Leaving,
    /// A component that is removed shuts down: the change is made.
    Shutdown,
}

/// A failure that is planted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planted {
    pub(super) step: Step,
    pub(super) how: How,
    /// Where it is among the components.
    place: usize,
}

impl Planted {
    /// One at a step drawn at random, after which the change is not made.
    pub(super) fn drawn(chance: &mut Chance) -> Planted {
        let steps = [Step::Initialize, Step::Undo, Step::Restore, Step::Save, Step::Level, Step::Leaving];
        let step = steps[chance.below(steps.len() as u64) as usize];
        let how = match chance.below(6) {
            // Each waits for half a second at least. What leaves does so between its executions, on the timer.
            0 if step != Step::Leaving => How::Hangs,
            1 | 2 => How::Withdraws,
            _ => How::Fails,
        };
        Planted { step, how, place: chance.below(1000) as usize }
    }

    /// One of a component that the change has removed.
    pub(super) fn of_removed() -> Planted {
        Planted { step: Step::Shutdown, how: How::Fails, place: 0 }
    }
}

/// What changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
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

pub(super) const KINDS: [Kind; 10] = [
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
    /// What it is at first.
    pub(super) fn first() -> Wish {
        Wish {
            robots: (1..=8).map(|robot| (robot, 100)).collect(),
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
        }
    }

    /// One that differs in this.
    pub(super) fn with(&self, kind: Kind, chance: &mut Chance) -> Wish {
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
    pub(super) fn composite(&self, pieces: usize) -> String {
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
        let is_planted = |step: Step| self.failure.is_some_and(|planted| planted.step == step);
        let number = |number: u32| number.to_string();
        let desk = format!("<reference name=\"desk\" target=\"Desk{}\"/>", self.desk);
        let topic = value("topicRename", &format!("LEVELS,LEVELS{}", self.topic));
        components.push(gauge(
            "Gauge",
            &[value("level", &number(self.level)), value("size", &number(self.size)), topic].concat(),
        ));
        components.push(gauge("Asker", &desk));
        components.push(gauge("Still", ""));
        let restore = if is_planted(Step::Restore) { "restore" } else { "" };
        components.push(gauge("Restorer", &[value("fails", restore), value("topicRename", "LEVELS,R")].concat()));
        let size = number(u32::from(is_planted(Step::Save)));
        components.push(gauge("Miser", &[value("fails", "save"), value("size", &size)].concat()));
        let level = number(u32::from(is_planted(Step::Level)));
        components.push(gauge("Stubborn", &[value("fails", "level"), value("level", &level)].concat()));
        if !is_planted(Step::Leaving) {
            components.push(gauge("Settler", &value("fails", "leaving")));
        }
        let class = if self.is_plain { "test.Plain" } else { "test.Gauge" };
        components.push(gauge("Changeling", &value("size", "1")).replace("test.Gauge", class));
        components.push(gauge("Plain", &value("size", &number(self.plain))).replace("test.Gauge", "test.Plain"));
        for desk in [1, 2] {
            components.push(format!("\"Desk{desk}\"><implementation.rust class=\"test.DeskImpl\"/></component>"));
        }
        if !is_planted(Step::Shutdown) {
            components.push(gauge("Quitter", &value("fails", "shutdown")));
        }
        if let Some(Planted { step: Step::Initialize | Step::Undo, place, .. }) = self.failure {
            let trap =
                gauge("Trap", &[&value("fails", "initialize"), "<reference name=\"desk\" target=\"Desk1\"/>"].concat());
            let place = place % components.len();
            if is_planted(Step::Undo) {
                components.insert(place, gauge("Faller", &value("fails", "shutdown")));
                components.push(trap);
            } else {
                components.insert(place, trap);
            }
        }
        let components: String = components.iter().map(|one| format!("<component name={one}")).collect();
        format!("{}{components}</composite>", parts[0])
    }
}
