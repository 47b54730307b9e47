use super::*;

fn recalled(told: Option<Progress>) -> HardwareClient {
    HardwareClient {
        wired: true,
        entered: true,
        catching_up: true,
        is_recalled: true,
        told,
        running: Some(Action::move_to(Block::new(1, 2))),
        ..HardwareClient::default()
    }
}

/// The next instance in the same program.
fn next(client: &HardwareClient) -> HardwareClient {
    let mut next = HardwareClient { wired: true, ..HardwareClient::default() };
    next.restore(client.memory());
    next
}

#[test]
fn an_action_of_an_earlier_program_stays_open_over_failures_until_its_end_is_known() {
    let mut client = next(&next(&recalled(None)));
    assert!(client.is_recalled && client.is_catching_up() && client.running.is_some());
    client.caught_up(None);
    assert!(!next(&client).is_recalled);
    // What the present program begins is polled after a failure.
    client.running = Some(Action::move_to(Block::new(1, 3)));
    assert!(next(&client).is_catching_up() && !next(&client).is_recalled);
}

#[test]
fn a_robot_that_had_not_entered_has_nothing_to_recall() {
    let never = HardwareClient { entered: false, running: None, ..recalled(None) };
    let mut later = HardwareClient { wired: true, is_recalled: true, ..HardwareClient::default() };
    later.restore(never.memory());
    assert!(!later.is_recalled);
}

#[test]
fn what_a_person_said_is_known_until_it_was_used() {
    let mut client = next(&recalled(Some(Progress::Failed)));
    assert_eq!(client.told, Some(Progress::Failed));
    client.caught_up(None);
    assert_eq!((client.told, client.asks_a_person), (None, false));
    assert_eq!(next(&client).told, None);
}
