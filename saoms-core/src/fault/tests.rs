use saoms_api::event::fault::FaultCall;
use saoms_api::{Message, Topic};

use super::{Arrival, End, FaultPlay, OnLink};
use crate::bus::Bus;

#[derive(Clone, Debug, Message)]
struct Words {
    text: String,
}

/// What arrives of ten messages that are sent every ten milliseconds, in milliseconds.
fn arrivals(faults: &[&str], is_event: bool) -> Vec<Vec<u64>> {
    let mut bus = Bus::default();
    let declared = Topic::<Words>::event("TALK").declaration();
    let topic = bus.publisher("TALK", &declared, &"A".into()).unwrap();
    let mut play = FaultPlay::new(3);
    for fault in faults {
        play.begin_messages(&FaultCall::read(fault).unwrap(), "", 0);
    }
    let end = |number, path| End { number, path, site: "", node: if path == "A" { "floor" } else { "traffic" } };
    let on_link = OnLink { topic: (topic, "TALK"), link: topic, is_event, from: end(1, "A"), to: end(2, "B") };
    let mut all = Vec::new();
    for at in (0..10).map(|place| place * 10_000_000) {
        let arrivals = play.arrivals(&on_link, at);
        all.push(arrivals.into_iter().map(|Arrival { at, .. }| at / 1_000_000).collect());
    }
    all
}

#[test]
fn a_message_that_nothing_concerns_arrives_at_once() {
    let usual: Vec<Vec<u64>> = (0..10).map(|place| vec![place * 10]).collect();
    for other in
        ["lose 100 % on TABLE", "lose 100 % from B", "cut B from C", "lose 0 %", "delay 0s", "cut @floor from @*"]
    {
        assert_eq!(arrivals(&[other], true), usual, "{other}");
    }
}

#[test]
fn a_lost_state_is_lost_and_a_lost_event_comes_after_the_round_trip() {
    let lost: Vec<Vec<u64>> = arrivals(&["lose 50 %"], false);
    assert!(lost.iter().any(Vec::is_empty) && !lost.iter().all(Vec::is_empty), "{lost:?}");
    let late = arrivals(&["lose 50 %", "delay 2ms"], true);
    assert!(late.iter().all(|one| one.len() == 1));
    let ways: Vec<u64> = late.iter().zip(0..).map(|(one, place)| one[0] - place * 10).collect();
    assert!(ways.contains(&2) && ways.contains(&6), "{ways:?}");
    assert!(arrivals(&["violate 100 %"], true).iter().all(Vec::is_empty));
}

#[test]
fn what_is_cut_off_waits_for_the_end_of_it() {
    let cut = arrivals(&["for 35ms cut B from A"], true);
    assert_eq!(cut, [[36], [36], [36], [36], [40], [50], [60], [70], [80], [90]]);
    assert_eq!(arrivals(&["for 35ms part A, C from B"], true), cut);
    assert_eq!(arrivals(&["for 35ms part @floor from @traf*"], true), cut);
    assert_eq!(arrivals(&["for 35ms cut @traffic from @*"], true), cut);
    assert!(arrivals(&["cut B from A"], true).iter().all(Vec::is_empty));
    assert_eq!(arrivals(&["for 35ms cut A from B"], true)[0], [0], "the other way is open");
}

#[test]
fn messages_stay_in_order_unless_that_is_what_goes_wrong() {
    let late = arrivals(&["delay 1ms to 60ms", "jitter 30ms", "duplicate 50 %"], true);
    let all: Vec<u64> = late.concat();
    assert!(all.is_sorted() && all.len() > 10, "{late:?}");
    let mixed = arrivals(&["reorder 50 % by 60ms"], true).concat();
    assert!(!mixed.is_sorted() && mixed.len() == 10, "{mixed:?}");
}
