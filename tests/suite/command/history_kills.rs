//! The history of a fleet with a state folder that is killed again and again: each delivery once, with its beginning.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

use super::history::ask as ask_history;
use super::memory::{Dice, start_with, wait_for_pieces};
use super::state::crossing;
use crate::support::{ask, code, empty_folder, saoms_in, text};

const KILLS: u64 = 10;
/// Most pieces that are open at once, so that the robots keep up.
const MOST_OPEN: u64 = 8;

/// The only value that answers a question.
fn number(folder: &Path, question: &str) -> u64 {
    ask_history(folder, question).remove(0).remove(0).parse().unwrap()
}

#[test]
fn each_delivery_is_there_once_with_its_begin_however_often_the_program_is_killed() {
    let folder = empty_folder("history-kills");
    let fleet = crossing().replace("at 0.1s 80 times luggage random to random", "at 0.1s luggage (1,1) to (2,2)");
    fs::write(folder.join("f.composite"), fleet).unwrap();
    let socket = folder.join("socket");
    let mut dice = Dice(11);
    let mut accepted = 1;
    for _ in 0..KILLS {
        let mut program = start_with(&folder, &["--history", "h.db"]);
        let (_, open) = wait_for_pieces(&mut program, &socket, accepted);
        for _ in open..MOST_OPEN {
            let [x, y, to] = [dice.below(6), dice.below(6), dice.below(5)];
            let line = format!("luggage ({x},{y}) to ({},{y})", (x + 1 + to) % 6);
            ask(&socket, "POST", "/v1/events", &line).unwrap();
            accepted += 1;
        }
        sleep(Duration::from_millis(200 + dice.below(700)));
        drop(program);
    }
    let arguments = ["run", "f.composite", "--state", "state", "--history", "h.db", "--control", "none"];
    let output = saoms_in(&folder, &arguments);
    assert_eq!(code(&output), 0, "{}", text(&output));
    let lasting =
        "from deliveries d join runs r using (run) where (r.undone_from_s is null or d.time_s < r.undone_from_s)";
    let rows = number(&folder, &format!("select count(*) {lasting}"));
    let pieces = number(&folder, &format!("select count(distinct coalesce(site, '') || piece || number) {lasting}"));
    assert_eq!(rows, pieces);
    // Those that were on their way to the file at a kill are missing.
    assert!(rows <= accepted && rows + MOST_OPEN * KILLS > accepted, "{rows} of {accepted}");
    let without = format!("select count(*) {lasting} and (asked_s is null or from_x is null or to_x is null)");
    assert_eq!(number(&folder, &without), 0);
    assert_eq!(number(&folder, &format!("select count(*) {lasting} and taken_s is null")), 0);
    // Pieces that were asked for before a kill are among them.
    let earlier = format!("select count(*) {lasting} and asked_s < r.goes_on_from_s");
    assert!(number(&folder, &earlier) > 0);
    // The runs know of each other.
    let runs = "select count(*), count(distinct state), count(goes_on_from_s), count(undone_from_s) from runs";
    let [all, states, later, undone] = <[String; 4]>::try_from(ask_history(&folder, runs).remove(0)).unwrap();
    assert_eq!((all.as_str(), states.as_str()), ("11", "1"));
    assert_eq!((later.as_str(), undone.as_str()), ("10", "10"));
    let order = "select count(*) from runs r join runs s on s.run > r.run where r.undone_from_s > s.goes_on_from_s";
    assert_eq!(number(&folder, order), 0);
}
