//! Texts that take long where an answer takes time with the square of their size.

use std::time::Duration;

use crate::common::composite::{Airport, Phases, airport};

/// A group of open files, of which the last one is asked about.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) files: Vec<(String, String)>,
    /// The bytes of the last file that are asked about.
    pub(crate) places: Vec<usize>,
    /// Maximum time of an answer, in ms.
    pub(crate) goal_ms: f64,
}

/// Number of elements in each other.
const DEPTH: usize = 100_000;
/// Number of bytes of a line.
const LINE: usize = 1_000_000;
/// Number of open files.
const FILES: usize = 1000;

const HEAD: &str = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" \
    xmlns:s=\"http://saoms/1.0\" targetNamespace=\"http://saoms/bench\" name=\"";

pub(crate) fn cases() -> Vec<Case> {
    let composite = |inside: &str| format!("{HEAD}fleet\">{inside}</composite>");
    let nested = |open: &str, close: &str| composite(&format!("{}{}", open.repeat(DEPTH), close.repeat(DEPTH)));
    let component = "<component name=\"Ä\">";
    let period = Duration::from_millis(100);
    let fleet = airport(Airport::new(1500, period, Phases::Together), Duration::from_secs(1));
    let fleet = fleet.replacen("<component", "<!-- ä --><component", 1).replace('\n', " ");
    let world = "<component name=\"World\"><implementation.java class=\"saoms.World\"/></component>";
    let repeated = |text: &str| text.repeat(LINE / text.len());
    vec![
        text("nested elements", nested("<ä>", "</ä>"), "<ä>", 1000.0),
        text("nested components", nested(component, "</component>"), "name=\"", 1000.0),
        text("nested components without ends", nested(component, ""), "name=\"", 1000.0),
        text("a fleet on one line", fleet, "target=\"", 1000.0),
        text(
            "a value on one line",
            composite(&format!(
                "<!-- ä -->{world}<component name=\"R\"><implementation.java \
            class=\"saoms.Robot\"/><reference name=\"world\" target=\"{}\"/></component>",
                repeated("World ")
            )),
            "World",
            1000.0,
        ),
        text(
            "a source on one line",
            composite(&format!(
                "<!-- ä --><property name=\"x\">1</property><component name=\"R\">\
            <implementation.java class=\"saoms.Robot\"/><property name=\"ID\" source=\"{}\"/></component>",
                repeated("$x/a[b='c']")
            )),
            "$x",
            1000.0,
        ),
        text(
            "a scenario on one line",
            composite(&format!(
                "<!-- ä --><component name=\"E\"><implementation.java \
            class=\"launch.Environment\"/><property name=\"scenario\">{}</property></component>",
                repeated("at 1s breakdown Ä; ")
            )),
            "breakdown ",
            1000.0,
        ),
        text(
            "attributes on one line",
            composite(&format!(
                "<component {}/>",
                (0..LINE / 10).map(|at| format!("ä{at:05}=\"\" ")).collect::<String>()
            )),
            "=\"",
            1000.0,
        ),
        fleets(),
        parts(),
    ]
}

/// One text, asked about at the first, a middle and the last place behind these characters.
fn text(name: &str, text: String, behind: &str, goal_ms: f64) -> Case {
    let all: Vec<usize> = text.match_indices(behind).map(|(at, found)| at + found.len()).collect();
    let places = [all.first(), all.get(all.len() / 2), all.last()].into_iter().flatten().copied().collect();
    Case { name: name.to_owned(), files: vec![("fleet.composite".to_owned(), text)], places, goal_ms }
}

/// A composite with a world and a robot.
fn small(name: &str) -> String {
    format!(
        "{HEAD}{name}\">\n  <component name=\"World\"><implementation.java class=\"saoms.World\"/></component>\n  \
         <component name=\"R\"><implementation.java class=\"saoms.Robot\"/>\n    \
         <reference name=\"world\" target=\"World\"/></component>\n</composite>\n"
    )
}

/// Fleets in one folder.
fn fleets() -> Case {
    let one = |at| (format!("fleet{at:04}.composite"), small(&format!("fleet{at:04}")));
    Case { files: (0..FILES).map(one).collect(), ..text("1,000 open fleets", small("fleet0999"), "target=\"", 100.0) }
}

/// One fleet of many files.
fn parts() -> Case {
    let one = |at| (format!("part{at:04}.composite"), small(&format!("part{at:04}")));
    let used = (1..FILES).map(|at| {
        format!("\n  <component name=\"C{at}\"><implementation.composite xmlns:b=\"http://saoms/bench\" name=\"b:part{at:04}\"/></component>")
    });
    let outer = format!("{HEAD}outer\">{}\n</composite>\n", used.collect::<String>());
    let all = std::iter::once(("outer.composite".to_owned(), outer)).chain((1..FILES).map(one));
    Case { files: all.collect(), ..text("1,000 open files of a fleet", small("part0999"), "target=\"", 100.0) }
}
