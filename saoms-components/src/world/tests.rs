use std::time::Duration;

use saoms_api::Time;

use super::luggage::{HandlingOutcome, Stock};
use super::referee::{Referee, Slowness};
use crate::grid::{Block, Map};
use crate::hardware::Progress;
use crate::messages::Collision;

fn block(x: i32, y: i32) -> Block {
    Block::new(x, y)
}

fn name(robot: u32) -> String {
    format!("Robot{robot}")
}

/// A referee with robots 1, 2, ... on these blocks of a map of 4 x 3 with (3,2) blocked.
fn referee(starts: &[Block]) -> Referee {
    let mut referee = Referee::new(Map::read("....\n....\n...@").unwrap());
    for (robot, start) in (1..).zip(starts) {
        assert_eq!(referee.enter(robot, name(robot), *start, Time::START), Ok(*start));
    }
    referee
}

/// A move that is done at once.
fn hop(referee: &mut Referee, robot: u32, to: Block) -> Option<Collision> {
    let collision = referee.begin_move(robot, to, (Time::START, Time::START)).unwrap().unwrap();
    assert_eq!(referee.progress(robot, Time::START), Progress::Done);
    collision
}

#[test]
fn robots_start_on_free_blocks_of_the_map() {
    let mut referee = referee(&[block(0, 0)]);
    for (start, reason) in [
        (block(4, 0), "outside the map from (0,0) to (3,2)"),
        (block(0, -1), "outside the map from (0,0) to (3,2)"),
        (block(3, 2), "which is blocked on the map"),
        (block(0, 0), "where robot 1 is already"),
    ] {
        let failure = referee.enter(2, name(2), start, Time::START).unwrap_err();
        let expected = format!("robot 2 starts at {start}, {reason}: give it another charge block");
        assert_eq!(failure.message(), expected);
    }
    assert!(referee.block(2).is_err());
}

#[test]
fn a_robot_that_starts_again_is_where_it_was() {
    let mut referee = referee(&[block(0, 0)]);
    hop(&mut referee, 1, block(1, 0));
    let later = Time::START + Duration::from_secs(1);
    referee.begin_move(1, block(2, 0), (Time::START, later)).unwrap().unwrap();
    assert_eq!(referee.enter(1, name(1), block(0, 0), Time::START), Ok(block(1, 0)));
    assert_eq!(referee.is_running(1), Ok(false));
    assert_eq!(
        referee.enter(2, name(2), block(2, 0), Time::START),
        Ok(block(2, 0)),
        "what the stopped robot held is free"
    );
}

#[test]
fn moves_lead_to_free_blocks_beside() {
    let mut referee = referee(&[block(2, 2)]);
    for (to, reason) in [
        (block(0, 2), "(0,2) is not beside (2,2)"),
        (block(2, 2), "(2,2) is not beside (2,2)"),
        (block(3, 1), "(3,1) is not beside (2,2)"),
        (block(3, 2), "(3,2) is not a free block of the map"),
        (block(2, 3), "(2,3) is not a free block of the map"),
    ] {
        assert_eq!(referee.begin_move(1, to, (Time::START, Time::START)), Ok(Err(reason.to_owned())));
    }
    assert_eq!(referee.block(1), Ok(block(2, 2)));
}

#[test]
fn two_robots_on_one_block_collide_once() {
    let mut referee = referee(&[block(0, 0), block(1, 0)]);
    let collision = Collision { robot: 1, other: 2, block: block(1, 0), swap: false };
    assert_eq!(hop(&mut referee, 1, block(1, 0)), Some(collision));
    assert_eq!(hop(&mut referee, 2, block(2, 0)), None);
    assert_eq!(hop(&mut referee, 1, block(0, 0)), None);
    assert_eq!(hop(&mut referee, 2, block(1, 0)), None, "the block is free again");
}

#[test]
fn robots_that_exchange_their_blocks_collide_by_that_alone() {
    let mut referee = referee(&[block(0, 0), block(1, 0)]);
    assert!(hop(&mut referee, 1, block(1, 0)).is_some());
    let swap = Collision { robot: 1, other: 2, block: block(1, 0), swap: true };
    assert_eq!(hop(&mut referee, 2, block(0, 0)), Some(swap));
    assert_eq!(hop(&mut referee, 1, block(2, 0)), None);
}

#[test]
fn a_moving_robot_holds_both_blocks_until_it_is_there() {
    let mut referee = referee(&[block(0, 0), block(0, 1), block(2, 0)]);
    let (now, later) = (Time::START, Time::START + Duration::from_secs(1));
    assert_eq!(referee.begin_move(1, block(1, 0), (Time::START, later)), Ok(Ok(None)));
    assert_eq!(referee.progress(1, now), Progress::Running);
    assert_eq!(hop(&mut referee, 2, block(0, 0)).map(|collision| collision.block), Some(block(0, 0)));
    assert_eq!(hop(&mut referee, 3, block(1, 0)).map(|collision| collision.block), Some(block(1, 0)));
    referee.settle(later);
    assert_eq!(referee.block(1), Ok(block(1, 0)));
    assert_eq!(referee.progress(1, later), Progress::Done);
    assert_eq!(hop(&mut referee, 2, block(0, 1)), None);
    assert_eq!(hop(&mut referee, 2, block(0, 0)), None, "the first robot left it");
}

#[test]
fn luggage_is_delivered_once_and_only_by_who_carries_it() {
    let mut stock = Stock::default();
    let (from, to) = (block(1, 0), block(2, 0));
    stock.add(7, from, to);
    stock.add(7, to, from);
    assert!(!stock.is_settled());
    assert_eq!(stock.collect(7, 1, to, |_| false), Err("luggage 7 is not here: it is at (1,0)".into()));
    assert_eq!(stock.collect(7, 1, from, |_| false), Ok(HandlingOutcome::Handled));
    assert_eq!(stock.collect(7, 2, from, |_| false), Err("luggage 7 is on robot 1".into()));
    assert_eq!(stock.deposit(7, 2, to), Err("it does not carry luggage 7".into()));
    assert_eq!(stock.deposit(7, 1, block(0, 0)), Ok(HandlingOutcome::Handled), "it lies on the way");
    assert_eq!(stock.collect(7, 2, block(0, 0), |_| false), Ok(HandlingOutcome::Handled));
    assert_eq!(stock.deposit(7, 2, to), Ok(HandlingOutcome::Delivered { given_up: false }));
    assert!(stock.is_settled());
    assert_eq!(stock.collect(7, 1, to, |_| false), Err("luggage 7 is delivered already".into()));
    assert_eq!(stock.deposit(7, 2, to), Err("it does not carry luggage 7".into()));
}

#[test]
fn luggage_on_a_robot_that_is_out_of_order_is_collected_where_that_stands() {
    let (mut stock, here) = (Stock::default(), block(1, 0));
    stock.add(7, here, block(2, 0));
    stock.collect(7, 1, here, |_| false).unwrap();
    assert_eq!(stock.collect(7, 2, here, |other| other == 3), Err("luggage 7 is on robot 1".into()));
    assert_eq!(stock.collect(7, 2, here, |other| other == 1), Ok(HandlingOutcome::Handled));
    assert_eq!(stock.deposit(7, 1, block(2, 0)), Err("it does not carry luggage 7".into()));
    assert_eq!(stock.deposit(7, 2, block(2, 0)), Ok(HandlingOutcome::Delivered { given_up: false }));
}

#[test]
fn a_robot_that_is_out_of_order_stays_until_it_starts_again() {
    let mut referee = referee(&[block(0, 0)]);
    let later = Time::START + Duration::from_secs(1);
    referee.begin_move(1, block(1, 0), (Time::START, later)).unwrap().unwrap();
    referee.retire(1).unwrap();
    referee.settle(later);
    assert!(referee.is_retired(1) && referee.is_retired_at(block(0, 0)) && !referee.is_retired_at(block(1, 0)));
    assert_eq!(referee.enter(1, name(1), block(0, 0), Time::START), Ok(block(0, 0)));
    assert!(!referee.is_retired(1));
}

#[test]
fn luggage_that_the_world_has_yet_to_hear_of_is_waited_for() {
    let mut stock = Stock::default();
    assert_eq!(stock.collect(7, 1, block(1, 0), |_| false), Ok(HandlingOutcome::Unknown));
    stock.add(7, block(1, 0), block(2, 0));
    stock.settle();
    assert_eq!(stock.collect(7, 1, block(1, 0), |_| false), Ok(HandlingOutcome::Handled));
    assert_eq!(stock.collect(8, 1, block(1, 0), |_| false), Ok(HandlingOutcome::Unknown));
    stock.settle();
    assert_eq!(stock.collect(8, 1, block(1, 0), |_| false), Err("there is no luggage 8".into()));
}

#[test]
fn a_number_belongs_to_one_robot() {
    let mut referee = Referee::new(Map::read("...").unwrap());
    assert_eq!(referee.enter(7, "A7".to_owned(), block(0, 0), Time::START), Ok(block(0, 0)));
    assert_eq!(
        referee.enter(7, "A7".to_owned(), block(0, 0), Time::START),
        Ok(block(0, 0)),
        "a restarted robot is still there"
    );
    let failure = referee.enter(7, "B7".to_owned(), block(1, 0), Time::START).unwrap_err();
    assert_eq!(failure.message(), "robots `A7` and `B7` both have the number 7: give one of them another `number`");
}

#[test]
fn luggage_that_is_given_up_is_no_open_work() {
    let mut stock = Stock::default();
    let (from, to) = (block(1, 0), block(2, 0));
    assert!(stock.add(7, from, to) && stock.add(8, from, to) && !stock.add(8, to, from));
    assert!(stock.give_up(7) && !stock.give_up(7) && !stock.give_up(9));
    assert!(!stock.is_settled());
    assert!(stock.give_up(8));
    assert!(stock.is_settled());
    assert_eq!(stock.collect(7, 1, from, |_| false), Ok(HandlingOutcome::Handled), "it can be brought all the same");
    assert_eq!(stock.deposit(7, 1, to), Ok(HandlingOutcome::Delivered { given_up: true }));
    assert!(stock.is_settled() && !stock.give_up(7));
}

#[test]
fn an_action_goes_on_at_its_usual_speed_when_slowness_ends() {
    let mut referee = referee(&[block(0, 0)]);
    referee.note_period(1, 100_000);
    let seconds = Duration::from_secs_f64;
    let slow =
        |factor: f64, until: Option<f64>| Slowness { factor, until: until.map(|end| Time::START + seconds(end)) };
    for (slowness, usual, expected) in [
        (slow(3.0, Some(5.0)), 1.0, 3.0),
        (slow(10.0, Some(5.0)), 1.0, 5.5),
        (slow(1000.0, Some(5.0)), 1.0, 5.995),
        (slow(1000.0, Some(5.0)), 0.0, 5.0),
        (slow(1000.0, None), 1.0, 1000.0),
    ] {
        referee.slow_down(1, slowness);
        assert_eq!(referee.lasting(1, seconds(usual), Time::START), seconds(expected), "{slowness:?}");
    }
}
