//! Programs that are killed and start again with their state folder.

use proptest::prelude::*;

use super::lossy::{Lossy, MILLISECOND, Weather};

/// The numbers that a component has given to its events, as programs received them, in this order.
fn heard(network: &Lossy, senders: &[usize], readers: &[usize]) -> Vec<u64> {
    let events = network.delivered.iter().filter(|one| &*one.topic == "EVENTS");
    let events = events.filter(|one| senders.contains(&one.sender) && readers.contains(&one.reader));
    events.map(|one| one.number).collect()
}

fn told(network: &Lossy, program: usize, what: &[&str]) -> Vec<String> {
    let told = network.told(program).into_iter();
    told.filter(|line| what.iter().any(|what| line.starts_with(what))).collect()
}

const WRONG: [&str; 7] = ["Lost", "Overflow", "Anew", "Twice", "Older", "GivenUp", "Differs"];

/// A program with a state folder, and one that reads what it sends.
fn pair() -> Lossy {
    let mut network = Lossy::new(0, Weather::calm(), 1);
    network.join_with_folder();
    network.join();
    network.run(500 * MILLISECOND);
    network
}

#[test]
fn what_a_killed_program_had_accepted_arrives_once_when_it_starts_again() {
    let mut network = pair();
    (0..10).for_each(|_| network.send(0, "EVENTS"));
    network.run(300 * MILLISECOND);
    network.is_cut = true;
    (0..10).for_each(|_| network.send(0, "EVENTS"));
    network.run(50 * MILLISECOND);
    let again = network.start_again(0);
    network.is_cut = false;
    network.send(again, "EVENTS");
    network.run(3_000 * MILLISECOND);
    network.send(again, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0, again], &[1]), (1..=22).collect::<Vec<u64>>());
    assert_eq!(told(&network, 1, &["GoesOn"]), [format!("GoesOn {again}")]);
    assert_eq!(told(&network, 1, &WRONG), Vec::<String>::new());
    // The folder keeps the number with which the next start goes on, and no more.
    let events = &network.programs[again].folder.as_ref().unwrap().events["EVENTS"];
    assert_eq!(events.keys().copied().collect::<Vec<u64>>(), [22]);
}

#[test]
fn a_program_that_did_not_hear_of_several_starts_receives_all() {
    let mut network = pair();
    network.programs[1].is_stopped = true;
    let mut sender = 0;
    let mut senders = vec![0];
    for _ in 0..3 {
        (0..5).for_each(|_| network.send(sender, "EVENTS"));
        network.run(1_500 * MILLISECOND);
        sender = network.start_again(sender);
        senders.push(sender);
    }
    network.programs[1].is_stopped = false;
    network.run(3_000 * MILLISECOND);
    assert_eq!(heard(&network, &senders, &[1]), (1..=15).collect::<Vec<u64>>());
    assert_eq!(told(&network, 1, &WRONG), Vec::<String>::new());
}

#[test]
fn a_killed_reader_with_a_state_folder_receives_what_it_had_not() {
    let mut network = Lossy::new(0, Weather::calm(), 1);
    network.join();
    network.join_with_folder();
    network.run(500 * MILLISECOND);
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.run(500 * MILLISECOND);
    network.programs[1].is_stopped = true;
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.run(5_000 * MILLISECOND);
    let again = network.start_again(1);
    network.run(1_000 * MILLISECOND);
    network.send(0, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0], &[1, again]), (1..=11).collect::<Vec<u64>>());
    assert_eq!(told(&network, again, &WRONG), Vec::<String>::new());
}

#[test]
fn what_a_killed_reader_had_not_carried_out_comes_again() {
    let mut network = Lossy::new(0, Weather::calm(), 1);
    network.join();
    network.join_with_folder();
    network.run(500 * MILLISECOND);
    (0..3).for_each(|_| network.send(0, "EVENTS"));
    network.run(500 * MILLISECOND);
    network.is_busy = true;
    (0..4).for_each(|_| network.send(0, "EVENTS"));
    network.run(2_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0], &[1]), (1..=7).collect::<Vec<u64>>());
    assert!(!network.programs[0].exchange.is_complete(), "they may be needed again");
    network.is_busy = false;
    let again = network.start_again(1);
    network.run(2_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0], &[again]), (4..=7).collect::<Vec<u64>>());
    assert!(network.programs[0].exchange.is_complete());
}

#[test]
fn both_ends_can_be_killed() {
    let mut network = Lossy::new(0, Weather::calm(), 1);
    network.join_with_folder();
    network.join_with_folder();
    network.run(500 * MILLISECOND);
    network.programs[1].is_stopped = true;
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.run(500 * MILLISECOND);
    let (sender, reader) = (network.start_again(0), network.start_again(1));
    network.run(2_000 * MILLISECOND);
    network.send(sender, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0, sender], &[1, reader]), (1..=6).collect::<Vec<u64>>());
    assert_eq!(told(&network, reader, &WRONG), Vec::<String>::new());
}

#[test]
fn a_program_that_ended_and_starts_again_goes_on_with_its_numbers() {
    let mut network = pair();
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.run(500 * MILLISECOND);
    // The folder does not know of all that was received.
    let folder = network.programs[0].folder.clone();
    network.send(0, "EVENTS");
    network.run(500 * MILLISECOND);
    let events = network.programs[0].folder.as_ref().unwrap().events.clone();
    network.leave(0);
    network.run(500 * MILLISECOND);
    let folder = folder.map(|folder| crate::network::exchange::Memory { events, ..folder });
    let again = network.start_again_from(0, folder);
    network.run(1_000 * MILLISECOND);
    network.send(again, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0, again], &[1]), (1..=7).collect::<Vec<u64>>());
    assert_eq!(told(&network, 1, &WRONG), Vec::<String>::new());
}

#[test]
fn what_nobody_received_before_the_end_arrives_after_the_next_start() {
    let mut network = pair();
    network.is_cut = true;
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.leave(0);
    assert_eq!(told(&network, 0, &["Later", "Unreceived"]), ["Later 1 EVENTS 5"]);
    let again = network.start_again(0);
    network.is_cut = false;
    network.run(2_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0, again], &[1]), (1..=5).collect::<Vec<u64>>());
    assert_eq!(told(&network, 1, &WRONG), Vec::<String>::new());
}

#[test]
fn what_stays_in_the_state_folder_of_a_sender_that_ends_is_not_lost_for_its_readers() {
    let mut network = pair();
    network.is_cut = true;
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.is_cut = false;
    network.leave(0);
    network.run(500 * MILLISECOND);
    assert_eq!(told(&network, 1, &["Stays", "Left"]), ["Stays 0 EVENTS 5", "Left 0"]);
    let again = network.start_again(0);
    network.run(2_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0, again], &[1]), (1..=5).collect::<Vec<u64>>());
    assert_eq!(told(&network, 1, &WRONG), Vec::<String>::new());
    assert_eq!((network.programs[0].lost, network.programs[1].lost), (0, 0));
}

#[test]
fn what_a_restored_state_folder_does_not_have_any_more_is_lost() {
    let mut network = pair();
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.run(500 * MILLISECOND);
    let before = network.programs[0].folder.clone();
    network.is_cut = true;
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.is_cut = false;
    network.leave(0);
    network.run(500 * MILLISECOND);
    let again = network.start_again_from(0, before);
    network.run(1_000 * MILLISECOND);
    network.send(again, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0, again], &[1]), [1, 2, 3, 4, 5, 11]);
    assert_eq!(told(&network, 1, &["Lost"]), [format!("Lost {again} EVENTS 5")]);
}

#[test]
fn a_late_sign_of_an_earlier_start_changes_nothing() {
    let mut network = Lossy::new(0, Weather::calm(), 1);
    network.join_with_folder();
    network.join();
    network.run(500 * MILLISECOND);
    let again = network.start_again(0);
    network.run(500 * MILLISECOND);
    // Who joins now has not heard of the first start.
    network.join();
    network.run(500 * MILLISECOND);
    network.programs[0].is_stopped = false;
    network.run(500 * MILLISECOND);
    network.programs[0].is_stopped = true;
    network.send(again, "EVENTS");
    network.run(500 * MILLISECOND);
    assert_eq!(heard(&network, &[0, again], &[1]), [1]);
    assert_eq!(heard(&network, &[0, again], &[3]), [1]);
    assert_eq!(told(&network, 3, &["GoesOn"]), Vec::<String>::new());
}

#[test]
fn a_state_folder_that_was_restored_is_told_and_what_is_new_arrives() {
    let mut network = pair();
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.run(500 * MILLISECOND);
    let before = network.programs[0].folder.clone();
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    network.run(500 * MILLISECOND);
    let again = network.start_again_from(0, before);
    network.run(1_000 * MILLISECOND);
    network.send(again, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(heard(&network, &[again], &[1]), [11]);
    assert_eq!(told(&network, 1, &["Older"]), ["Older 0 EVENTS 10"]);
}

#[test]
fn a_program_that_was_not_known_receives_what_is_new() {
    let mut network = pair();
    network.is_cut = true;
    (0..5).for_each(|_| network.send(0, "EVENTS"));
    let again = network.start_again(0);
    network.join();
    network.is_cut = false;
    network.run(2_000 * MILLISECOND);
    network.send(again, "EVENTS");
    network.run(1_000 * MILLISECOND);
    assert_eq!(heard(&network, &[0, again], &[3]), [6]);
    assert_eq!(heard(&network, &[0, again], &[1]), (1..=6).collect::<Vec<u64>>());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn nothing_accepted_is_lost_doubled_or_reordered(
        loss in 0..40_u32, repeats in 0..30_u32, jitter in 0..120_u64,
        seed in any::<u64>(),
        steps in prop::collection::vec((0..10_u8, 0..60_u64), 1..200),
    ) {
        let mut network = Lossy::new(0, Weather::calm(), seed);
        network.join_with_folder();
        network.join();
        network.run(800 * MILLISECOND);
        network.change(Weather { loss, repeats, jitter });
        let (mut senders, mut sender) = (vec![0], 0);
        for (what, time) in steps {
            match what {
                0 => {
                    sender = network.start_again(sender);
                    senders.push(sender);
                }
                1 => network.is_cut = !network.is_cut,
                2 => network.put(sender, "STATES", 1),
                _ => network.send(sender, "EVENTS"),
            }
            network.run(time * MILLISECOND);
        }
        network.is_cut = false;
        for round in 0..10 {
            if round < 2 || !network.programs[sender].exchange.is_complete() {
                network.run(10_000 * MILLISECOND);
            }
        }
        let last = network.sent(sender, "EVENTS");
        prop_assert_eq!(heard(&network, &senders, &[1]), (1..=last).collect::<Vec<u64>>());
        prop_assert_eq!(told(&network, 1, &WRONG), Vec::<String>::new());
    }
}
