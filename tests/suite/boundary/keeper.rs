//! Components of a library that keep bytes, save their state, take new values while they run, or receive the messages
//! of a region.

use saoms_testkit::Bench;

use super::build::library;
use super::run::{component, property, second};

#[test]
fn a_library_takes_new_values_and_keeps_bytes() {
    let mut keeper = Bench::of_library(&library("good"), "good.Keeper", &[]).unwrap();
    keeper.start().unwrap();
    keeper.execute().unwrap();
    let kept = |keeper: &Bench| keeper.kept().clone().into_iter().collect::<Vec<_>>();
    assert_eq!(kept(&keeper), [(7, vec![1, 0xff])]);
    keeper.set("step", "5").unwrap();
    keeper.execute().unwrap();
    assert_eq!((keeper.log(), kept(&keeper)), (vec!["counts 6"], vec![(7, vec![6, 0xff])]));
    let mut refused = |name, value| keeper.set(name, value).unwrap_err().to_string();
    assert_eq!(refused("step", "8"), "not eight");
    assert!(refused("step", "11").contains("out of range"));
    assert!(refused("failsAt", "1").contains("is not `live`"));
    keeper.execute().unwrap();
    assert_eq!(keeper.log(), ["counts 11"]);
}

#[test]
fn a_restart_of_a_library_goes_on_from_what_it_saved_and_kept() {
    let restart = property("restart", "onFailure") + &property("failsAt", "3");
    let run = second(&component("K", "good.Keeper", &restart), &[library("good")]);
    let lines: Vec<&str> = run.text.lines().filter(|line| line.contains(" K ")).collect();
    let told = lines.join("\n");
    assert!(told.contains("kept {7: [2, 255]}") && told.contains("restarted (1), and continues"), "{}", run.text);
    let counts: Vec<&str> =
        lines.iter().filter_map(|line| line.split_once("counts ")).map(|(_, count)| count).collect();
    assert_eq!(counts[..4], ["1", "2", "3", "4"], "{}", run.text);
}

#[test]
fn a_library_receives_the_messages_of_a_region_and_what_left_it() {
    let run = second(&component("S", "good.Spotter", ""), &[library("good")]);
    let lines: Vec<&str> = run.text.lines().filter_map(|line| Some(line.split_once("sees ")?.1)).collect();
    let expected = ["[], []", "[], []", "[], []", "[2], []", "[3], []", "[4], []"];
    assert_eq!(lines[..6], expected, "{}", run.text);
    assert_eq!(lines[6..8], ["[], [Departed { sender: 0, key: 7 }]", "[], []"], "{}", run.text);
}
