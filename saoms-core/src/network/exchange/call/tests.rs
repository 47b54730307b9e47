//! Calls over a network that loses, repeats and delays what it carries.

use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::{MOST_WAITING, Outcome, OwnCall};
use crate::network::exchange::tests::lossy::{Lossy, MILLISECOND, Weather};

const SECOND: u64 = 1_000 * MILLISECOND;

fn call(line: u64, deadline: Option<u64>) -> OwnCall {
    OwnCall { line, deadline, ..OwnCall::default() }
}

fn calm(programs: usize) -> Lossy {
    let mut network = Lossy::new(programs, Weather::calm(), 1);
    network.run(500 * MILLISECOND);
    network
}

#[test]
fn a_call_is_answered_and_the_next_one_of_its_line_waits_for_that() {
    let mut network = calm(2);
    network.service_time = 300 * MILLISECOND;
    assert_eq!(network.call(0, "1", call(7, None)), 1);
    assert_eq!(network.call(0, "1", call(7, None)), 2);
    assert_eq!(network.call(0, "1", call(8, None)), 1);
    assert!(network.programs[0].exchange.awaits_answers());
    network.run(350 * MILLISECOND);
    assert_eq!(network.ran, [(1, 0, 7, 1), (1, 0, 8, 1), (1, 0, 7, 2)], "put again meanwhile, and run once");
    network.run(SECOND);
    let reply = |number: u64| Outcome::Reply { program: 1, bytes: number.to_le_bytes().to_vec() };
    assert_eq!(network.outcomes_of(0), [(7, 1, reply(1)), (8, 1, reply(1)), (7, 2, reply(2))]);
    assert!(!network.programs[0].exchange.awaits_answers());
}

#[test]
fn a_call_waits_for_a_program_until_its_deadline() {
    let mut network = calm(1);
    network.call(0, "gate", call(1, Some(SECOND)));
    network.call(0, "gate", call(2, Some(SECOND)));
    network.call(0, "gate", call(3, None));
    network.run(500 * MILLISECOND);
    assert_eq!(network.outcomes_of(0), []);
    network.run(SECOND);
    assert_eq!(network.outcomes_of(0), [1, 2].map(|line| (line, 1, Outcome::Late { was_there: false })));
    network.join_as("gate", "Gate", 0);
    network.run(SECOND);
    assert_eq!(network.ran, [(1, 0, 3, 1)]);
}

#[test]
fn a_call_whose_program_is_killed_is_not_made_to_the_next_one() {
    let mut network = calm(1);
    network.join_as("gate", "Gate", 0);
    network.run(500 * MILLISECOND);
    network.service_time = 10 * SECOND;
    network.call(0, "gate", call(1, None));
    network.call(0, "gate", call(1, None));
    network.run(200 * MILLISECOND);
    network.programs[1].is_stopped = true;
    network.run(5 * SECOND);
    assert_eq!(network.outcomes_of(0), [], "it may come back");
    network.service_time = 0;
    network.join_as("gate", "Gate", 0);
    network.run(2 * SECOND);
    let outcomes = network.outcomes_of(0);
    assert_eq!(outcomes[0], (1, 1, Outcome::Gone));
    assert!(matches!(outcomes[1], (1, 2, Outcome::Reply { program: 2, .. })), "{outcomes:?}");
    assert_eq!(network.ran, [(1, 0, 1, 1), (2, 0, 1, 2)]);
    // One that is for the first start alone is for none.
    network.call(0, "gate", OwnCall { program: Some(1), ..call(1, None) });
    network.run(MILLISECOND);
    assert_eq!(network.outcomes_of(0)[2], (1, 3, Outcome::Gone));
}

#[test]
fn a_call_to_a_program_that_ends_is_gone() {
    let mut network = calm(2);
    network.service_time = SECOND;
    network.call(0, "1", call(1, None));
    network.run(100 * MILLISECOND);
    network.leave(1);
    network.programs[1].is_stopped = true;
    network.run(200 * MILLISECOND);
    assert_eq!(network.outcomes_of(0), [(1, 1, Outcome::Gone)]);
}

#[test]
fn what_a_stopped_program_finds_in_its_queues_does_not_begin() {
    let mut network = calm(2);
    // All that is on its way arrives ten seconds later.
    network.delay = 10 * SECOND;
    network.call(0, "1", call(1, Some(SECOND)));
    network.run(2 * SECOND);
    assert_eq!(network.outcomes_of(0), [(1, 1, Outcome::Late { was_there: true })]);
    network.delay = 0;
    network.run(20 * SECOND);
    assert_eq!(network.ran, []);
    network.call(0, "1", call(1, Some(SECOND)));
    network.run(SECOND);
    assert_eq!(network.ran, [(1, 0, 1, 2)]);
}

#[test]
fn a_call_that_did_not_begin_in_time_is_taken_when_it_comes_again() {
    let mut network = calm(2);
    network.service_time = 60 * SECOND;
    network.call(0, "1", call(1, None));
    network.run(50 * MILLISECOND);
    assert_eq!(network.ran.len(), 1, "it waits for its component");
    network.programs[1].exchange.unserved(0, 1, 1);
    network.run(SECOND);
    assert_eq!(network.ran, [(1, 0, 1, 1), (1, 0, 1, 1)]);
}

#[test]
fn a_call_that_overtakes_ends_the_others_of_its_line() {
    let mut network = calm(2);
    network.service_time = SECOND;
    network.call(0, "1", call(1, None));
    network.call(0, "1", call(1, None));
    network.run(100 * MILLISECOND);
    network.call(0, "1", OwnCall { overtakes: true, ..call(1, None) });
    network.run(100 * MILLISECOND);
    assert_eq!(network.outcomes_of(0), [(1, 1, Outcome::Dropped), (1, 2, Outcome::Dropped)]);
    assert_eq!(network.ran, [(1, 0, 1, 1), (1, 0, 1, 3)]);
}

#[test]
fn calls_that_wait_are_bounded() {
    let mut network = calm(1);
    for _ in 0..=MOST_WAITING {
        network.call(0, "1", call(1, None));
    }
    assert_eq!(network.outcomes_of(0), []);
    let number = network.call(0, "1", call(1, None));
    network.run(MILLISECOND);
    assert_eq!(network.outcomes_of(0), [(1, number, Outcome::Dropped)]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn a_call_runs_at_most_once_and_has_one_outcome(
        (loss, repeats, jitter) in (0..40_u32, 0..40_u32, 0..200_u64),
        service_time in 0..1_500_u64,
        seed in any::<u64>(),
        steps in prop::collection::vec((0..10_u8, 0..3_u64, 1..3_000_u64, 0..300_u64), 1..60),
    ) {
        let mut network = Lossy::new(1, Weather::calm(), seed);
        network.join_as("gate", "Gate", 0);
        network.run(800 * MILLISECOND);
        network.change(Weather { loss, repeats, jitter });
        network.service_time = service_time * MILLISECOND;
        let mut made = BTreeSet::new();
        for (what, line, deadline, pause) in steps {
            let present = network.programs.len() - 1;
            match what {
                0 => network.is_cut = !network.is_cut,
                // It is stopped, and goes on.
                1 => network.programs[present].is_stopped = !network.programs[present].is_stopped,
                // It is killed, and another one begins.
                2 if network.programs.len() < 5 => {
                    network.programs[present].is_stopped = true;
                    network.join_as("gate", "Gate", 0);
                }
                _ => {
                    // Those of line 0 have no deadline.
                    let deadline = (line > 0).then_some(deadline * MILLISECOND);
                    made.insert((line, network.call(0, "gate", call(line, deadline))));
                }
            }
            network.run(pause * MILLISECOND);
        }
        network.is_cut = false;
        network.change(Weather::calm());
        let present = network.programs.len() - 1;
        network.programs[present].is_stopped = false;
        network.run(90 * SECOND + 70 * network.service_time);
        let mut ran = BTreeMap::<(u64, u64), Vec<usize>>::new();
        for (server, _, line, number) in &network.ran {
            ran.entry((*line, *number)).or_default().push(*server);
        }
        for (call, servers) in &ran {
            prop_assert_eq!(servers.len(), 1, "call {:?} ran in {:?}", call, servers);
        }
        let outcomes = network.outcomes_of(0);
        let ended: BTreeSet<(u64, u64)> = outcomes.iter().map(|(line, number, _)| (*line, *number)).collect();
        prop_assert_eq!(ended.len(), outcomes.len(), "two outcomes of one call: {:?}", &outcomes);
        prop_assert_eq!(&ended, &made);
        for (line, number, outcome) in outcomes {
            if let Outcome::Reply { bytes, .. } = outcome {
                prop_assert_eq!(bytes, number.to_le_bytes().to_vec());
                prop_assert!(ran.contains_key(&(line, number)));
            }
        }
    }
}
