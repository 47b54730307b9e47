//! What the hardware noted: who was where, and which pieces were brought.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use saoms_components::grid::Block;

use super::note::{TAKES, notes};

/// A route of a piece, such as `(0,1) to (2,3)`.
pub(super) fn route(from: Block, to: Block) -> String {
    format!("{from} to {to}")
}

/// The pieces that were deposited, by their numbers, with the routes on which they were brought.
pub(super) fn deposited(path: &Path) -> BTreeMap<u32, String> {
    let mut collected: BTreeMap<u32, Block> = BTreeMap::new();
    let mut brought = BTreeMap::new();
    for note in notes(path) {
        let mut words = note.what.split(' ');
        match words.next() {
            Some("collect") => drop(collected.insert(number(words.nth(1)), note.block())),
            Some("deposit") => {
                let piece = number(words.nth(1));
                brought.insert(piece, route(collected[&piece], note.block()));
            }
            _ => {}
        }
    }
    brought
}

fn number(word: Option<&str>) -> u32 {
    word.unwrap().parse().unwrap()
}

/// What a person sees who looks whether the action was done of which a robot asks; `None` while it goes on.
pub(super) fn look(path: &Path, robot: &str, question: &str) -> Option<bool> {
    let number: u32 = robot.trim_start_matches("Robot").parse().unwrap();
    let newest = notes(path).into_iter().rfind(|note| note.robot == number);
    match newest.filter(|note| question.contains(&format!("about to {}, ", note.what))) {
        Some(newest) => newest.is_over().then_some(true),
        None => Some(false),
    }
}

/// Checks that no robot began anything during an action, each move led to a free block beside, and each piece was
/// collected and deposited once at most.
pub(super) fn check(path: &Path) {
    let all = notes(path);
    let shown = || all.iter().rev().take(40).rev().map(|note| format!("{note:?}\n")).collect::<String>();
    let mut places: BTreeMap<u32, (Block, Block, Duration)> = BTreeMap::new();
    let mut handled: BTreeMap<String, u32> = BTreeMap::new();
    for note in &all {
        let to = note.block();
        for (other, (from, at, until)) in places.iter().filter(|(other, _)| **other != note.robot) {
            let leaves = note.at < *until && *from == to;
            assert!(*at != to && !leaves, "robot {} meets robot {other} at {to}: {}", note.robot, shown());
        }
        let from = match places.get(&note.robot) {
            None => to,
            Some((_, from, until)) => {
                assert!(note.at >= *until, "robot {} begins {:?} too early: {}", note.robot, note.what, shown());
                let is_move = note.what.starts_with("move");
                assert!(from.distance(to) <= 1 && (!is_move || *from != to), "{note:?} from {from}: {}", shown());
                *from
            }
        };
        places.insert(note.robot, (from, to, note.at + TAKES));
        if !note.what.starts_with("move") {
            let what = note.what.split(" at ").next().unwrap().to_owned();
            let times = handled.entry(format!("{what} {}", if what == "enters" { note.robot } else { 0 })).or_default();
            *times += 1;
            assert_eq!(*times, 1, "{note:?} twice: {}", shown());
        }
    }
}
