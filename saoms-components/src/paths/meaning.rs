//! The content of a picture's legend: the robots, and the signs that occur.

use super::density::Shades;
use super::glyphs::Incident;
use super::lanes::Sharing;
use super::legend::{DEEDS, Entry, Group, Sign};
use super::marks::Marks;
use super::palette::look;
use super::path::{Path, Robot};
use super::picture::{Moved, Style};
use crate::report::counted;

/// More robots than that are not named each.
const NAMED: usize = 120;

/// The legend of a picture.
pub(super) fn of(marks: &Marks<'_>, style: &Style, robots: &[Moved<'_>], shades: Option<&Shades>) -> Vec<Group> {
    let mut groups = vec![Group { heading: "Robots", entries: named(style, robots) }];
    if let Some(shades) = shades {
        let entry = |(shade, text)| Entry::Sign { sign: Sign::Shade(shade), text };
        groups.push(Group { heading: "How often a block was entered", entries: shades.legend().map(entry).collect() });
    }
    groups.push(Group { heading: "Signs", entries: signs(marks, style, robots) });
    groups
}

/// The deeds of a robot, in a few words.
pub(super) fn deeds(robot: &Robot, path: &Path) -> String {
    let blocks = counted(usize::try_from(path.moves).unwrap_or(usize::MAX), "block");
    let delivered = &robot.delivered;
    if delivered.count == 0 {
        return format!("delivered nothing \u{b7} {blocks}");
    }
    let numbers = delivered.numbers(5).map(|numbers| format!("delivered {numbers} \u{b7} {blocks}"));
    numbers.filter(|deeds| deeds.chars().count() <= DEEDS).unwrap_or_else(|| {
        let pieces = counted(delivered.count, "piece");
        format!("delivered {pieces} \u{b7} {blocks}")
    })
}

fn named(style: &Style, robots: &[Moved<'_>]) -> Vec<Entry> {
    let entry = |(place, (number, robot, path)): (usize, &Moved<'_>)| {
        let (name, deeds) = (robot.name.to_string(), deeds(robot, path));
        match style {
            Style::Lines { .. } => Entry::Robot { look: look(place), number: number.to_string(), name, deeds },
            Style::Density => {
                let delivered = robot.delivered.count;
                Entry::Plain { name, deeds: format!("{delivered} delivered \u{b7} {} blocks", path.moves) }
            }
        }
    };
    let mut entries: Vec<Entry> = robots.iter().enumerate().take(NAMED).map(entry).collect();
    if robots.len() > NAMED {
        let more = format!("and {} more", robots.len() - NAMED);
        entries.push(Entry::Sign { sign: Sign::Note, text: more });
    }
    entries
}

fn signs(marks: &Marks<'_>, style: &Style, robots: &[Moved<'_>]) -> Vec<Entry> {
    let recording = marks.recording;
    let mut signs = Vec::new();
    if robots.is_empty() {
        signs.push(Entry::Sign { sign: Sign::Note, text: "No robot published its position.".to_owned() });
    }
    let mut add = |is_there: bool, sign: Sign, text: &str| {
        if is_there {
            signs.push(Entry::Sign { sign, text: text.to_owned() });
        }
    };
    let lines = matches!(style, Style::Lines { .. });
    let readable = marks.frame.cell >= 8.0;
    add(recording.map.as_ref().is_some_and(|map| !map.is_open()), Sign::Blocked, "blocked");
    add(!marks.chargers().is_empty(), Sign::Charger, "charger");
    add(lines && !robots.is_empty(), Sign::Start, "start, with the robot's number");
    add(lines && !robots.is_empty(), Sign::End, "end, with the robot's number");
    add(!lines, Sign::Start, "a robot at the end of the run");
    add(!lines && marks.frame.cell >= super::density::ARROWED, Sign::Flow, "the most frequent direction");
    let luggage = readable && marks.frame.cell >= super::marks::NUMBERED;
    let numbers = if luggage { ": numbers or count" } else { "" };
    add(readable && !recording.collected.is_empty(), Sign::Collect, &format!("luggage collected{numbers}"));
    add(readable && !recording.delivered.is_empty(), Sign::Deliver, &format!("luggage delivered{numbers}"));
    add(readable && !recording.open.is_empty(), Sign::Wait, "luggage from here is not delivered");
    let jumps = robots.iter().any(|(.., path)| path.legs.iter().any(|leg| leg.jump));
    add(jumps, Sign::Unheard, "the path of the robot is unknown here");
    for (incident, text) in [
        (Incident::Collision, "collision"),
        (Incident::Stranded, "stands with an empty battery"),
        (Incident::Breakdown, "broke down"),
    ] {
        add(marks.incidents().keys().any(|(_, found)| *found == incident), Sign::Incident(incident), text);
    }
    if let Style::Lines { sharing, .. } = style {
        let note = match sharing {
            Sharing::None => None,
            Sharing::Direction => Some("All passes of a robot in one direction share a line."),
            Sharing::Robot => Some("All passes of a robot share a line."),
        };
        signs.extend(note.map(|note| Entry::Sign { sign: Sign::Note, text: note.to_owned() }));
    }
    signs
}
