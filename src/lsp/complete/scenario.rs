//! Scenarios: what happens to a fleet from outside.

use std::ops::Range;

use lsp_types::CompletionItemKind;
use saoms_components::environment::{Next, next};
use saoms_lang::expression::{Value, render};

use super::values::UNITS;
use super::{Proposal, value};
use crate::lsp::outline::Component;
use crate::lsp::scene::Scene;

/// The class that plays scenarios, and its property.
const ENVIRONMENT: (&str, &str) = ("saoms.Environment", "scenario");
/// The class of what breaks down.
const ROBOT: &str = "saoms.Robot";

/// Whether a property of a component of a file is a scenario.
pub(super) fn is_one(scene: &Scene, file: usize, property: usize) -> bool {
    let of = &scene.files[file];
    let name = of.tree.value(&of.text, property, "name").map(|at| &of.text[at]);
    name == Some(ENVIRONMENT.1)
        && scene.component_in(file, property).is_some_and(|one| is_a(scene, one, ENVIRONMENT.0))
}

fn is_a(scene: &Scene, component: &Component, class: &str) -> bool {
    let declaration = scene.class(component).map(|class| class.declaration());
    declaration.is_some_and(|one| one.name == class || one.extends.iter().any(|other| other == class))
}

/// What can stand at a byte of a scenario of a composite.
pub(super) fn complete(scene: &Scene, composite: usize, range: Range<usize>, at: usize) -> Vec<Proposal> {
    let text = &scene.file().text;
    let line =
        text[range.start..at].rfind(['\n', '\r', ';']).map_or(range.start, |found| range.start + found + 1);
    let before = &text[line..at];
    if before.contains('#') {
        return Vec::new();
    }
    // A block is one word, also where it has blanks.
    let start = match (before.rfind('('), before.rfind(')')) {
        (Some(open), close) if close.is_none_or(|close| close < open) => open,
        _ => {
            let blank = before.trim_end_matches(|c: char| !c.is_whitespace()).len();
            before.rfind("..").map_or(0, |dots| dots + 2).max(blank)
        }
    };
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let typed = before[start..].trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let rest = &text[at..range.end];
    let end = at + rest.find(|c: char| c.is_whitespace() || ";.)<".contains(c)).unwrap_or(rest.len());
    let end = end + usize::from(before[start..].starts_with('(') && text[end..].starts_with(')'));
    let word = line + start..end;
    let mut all = Vec::new();
    for (one, rank) in next(&before[..start]).into_iter().zip(0..) {
        match one {
            Next::Word(name) => {
                let one = Proposal::new(name, CompletionItemKind::KEYWORD, &word);
                all.push(one.detail(meaning(name)).rank(rank));
            }
            Next::Time if is_number(typed) => {
                all.extend(UNITS.iter().zip(1..).map(|((unit, what), rank)| {
                    value(format!("{typed}{unit}"), &word).detail(*what).rank(rank)
                }))
            }
            Next::Time => all.push(value("1s", &word).detail("a time: `500ms`, `6s`, or a range `2s..8s`")),
            Next::Times => {
                let number = if is_number(typed) { typed } else { "3" };
                all.push(value(format!("{number} times"), &word).detail("how often").rank(6));
            }
            Next::Pieces => {
                all.push(value("4", &word).detail("how many pieces of luggage, or a range `2..8`"))
            }
            Next::Place => {
                let block = Proposal::new("(0,0)", CompletionItemKind::VALUE, &word);
                all.push(
                    block
                        .detail("column and row of a block, or a range `(0,0)..(9,9)`")
                        .snippet("(${1:0},${2:0})"),
                );
                all.push(value("random", &word).detail("any block of the area"));
            }
            Next::Robot => all.extend(
                robots(scene, composite)
                    .into_iter()
                    .map(|name| Proposal::new(name, CompletionItemKind::VARIABLE, &word)),
            ),
        }
    }
    all
}

/// The names of the robots of a composite; of replicas that of the first.
fn robots(scene: &Scene, composite: usize) -> Vec<String> {
    let robots = scene.components_of(composite).filter(|(_, one)| is_a(scene, one, ROBOT));
    let first = |name: &str| render(name, &mut |_| Ok(Value::Integer(1))).ok();
    robots.filter_map(|(_, one)| first(&one.name.text)).collect()
}

fn meaning(word: &str) -> &'static str {
    match word {
        "at" => "once, at a time from the start",
        "from" => "again and again, from a time on",
        "then" => "after the event of the line before",
        "every" => "the time from one event to the next",
        "until" => "the time after which there are no more",
        "luggage" => "luggage waits at a block to be brought `to` another one",
        "landing" => "an airplane lands, and so many pieces are expected",
        "takeoff" => "an airplane is about to take off, and so many pieces are expected",
        "breakdown" => "a robot breaks down where it is",
        "end" => "nothing; the run goes on until then",
        _ => "",
    }
}
