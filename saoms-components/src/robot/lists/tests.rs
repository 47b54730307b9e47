use std::time::Duration;

use saoms_api::{Cause, Header, Time};

use super::{Lists, Peers, Requests, Rival};
use crate::grid::Block;
use crate::messages::{EventLuggage, LuggageStage, Position, RobotList};

const MINE: u32 = 2;

fn at(seconds: u64) -> Header {
    Header { sender: 0, sent: Time::START + Duration::from_secs(seconds), cause: Cause::default() }
}

fn request(luggage: u32) -> EventLuggage {
    EventLuggage::request(luggage, Block::new(1, 1), Block::new(5, 5))
}

fn response(luggage: u32, robot: u32, stage: LuggageStage) -> EventLuggage {
    EventLuggage { robot, stage, block: Block::new(0, robot as i32), ..request(luggage) }
}

/// Lists with luggage 1, 2 and 3, requested a second apart.
fn lists() -> Lists {
    let mut lists = Lists::new(MINE);
    for luggage in 1..=3 {
        lists.requests.hear(&request(luggage), at(luggage.into()));
        lists.requests.hear(&request(luggage), at(3));
    }
    lists
}

fn open(lists: &Lists) -> Vec<u32> {
    lists.requests.open().iter().map(|request| request.job.luggage).collect()
}

#[test]
fn taken_luggage_leaves_the_list() {
    let mut lists = lists();
    lists.requests.hear(&response(2, 1, LuggageStage::Taken), at(4));
    lists.requests.hear(&response(3, MINE, LuggageStage::Taken), at(4));
    lists.requests.hear(&response(8, 1, LuggageStage::Taken), at(4));
    assert_eq!(open(&lists), [1], "whichever loop of this robot took it");
    lists.requests.hear(&response(1, 1, LuggageStage::Delivered), at(5));
    assert_eq!(open(&lists), [0; 0]);
}

#[test]
fn luggage_that_was_taken_before_it_was_requested_again_waits() {
    let mut lists = lists();
    lists.requests.hear(&request(2), at(7));
    lists.requests.hear(&response(2, 1, LuggageStage::Taken), at(6));
    lists.requests.hear(&request(4), at(7));
    lists.requests.hear(&response(4, 1, LuggageStage::Taken), at(6));
    assert_eq!(open(&lists), [1, 2, 3, 4]);
    lists.requests.hear(&response(2, 1, LuggageStage::Taken), at(8));
    lists.requests.hear(&response(4, 1, LuggageStage::Taken), at(7));
    assert_eq!(open(&lists), [1, 3]);
}

#[test]
fn luggage_that_was_delivered_does_not_wait_again() {
    let mut lists = lists();
    lists.requests.hear(&response(2, 1, LuggageStage::Delivered), at(4));
    // A robot that took it too late, and could not collect it.
    lists.requests.hear(&request(2), at(5));
    lists.requests.hear(&request(4), at(5));
    lists.requests.hear(&response(4, 1, LuggageStage::Delivered), at(5));
    assert_eq!(open(&lists), [1, 3]);
}

#[test]
fn a_request_that_is_repeated_for_a_robot_is_for_that_one_and_opens_nothing_again() {
    let mut lists = lists();
    lists.requests.hear(&request(4).again_for(MINE), at(4));
    lists.requests.hear(&request(5).again_for(7), at(4));
    lists.requests.hear(&response(1, 1, LuggageStage::Taken), at(4));
    lists.requests.hear(&request(1).again_for(MINE), at(5));
    assert_eq!(open(&lists), [2, 3, 4]);
    lists.requests.hear(&request(1), at(6));
    assert_eq!(open(&lists), [2, 3, 4, 1], "who took it offers it to all");
}

#[test]
fn luggage_that_this_robot_refused_does_not_wait_for_it_again() {
    let mut lists = lists();
    lists.requests.hear(&response(2, MINE, LuggageStage::Refused), at(4));
    lists.requests.hear(&request(2), at(5));
    assert_eq!(open(&lists), [1, 3]);
}

#[test]
fn interests_of_others_are_known_until_they_take_them_back() {
    let mut lists = lists();
    for robot in [1, MINE, 3, 3] {
        lists.requests.hear(&response(1, robot, LuggageStage::Interest), at(4));
    }
    let rivals = |lists: &Lists| lists.requests.open()[0].rivals.clone();
    let rival = |robot| Rival { robot, block: Block::new(0, robot as i32), until: None };
    assert_eq!(rivals(&lists), [rival(1), rival(3)]);
    lists.requests.hear(&response(1, 1, LuggageStage::Release), at(5));
    assert_eq!(rivals(&lists), [rival(3)]);
    lists.hear_robot(&RobotList { robot: 3, active: true, ..RobotList::default() });
    lists.hear_robot(&RobotList { robot: 3, active: false, ..RobotList::default() });
    assert_eq!(rivals(&lists), []);
    lists.requests.hear(&response(1, 1, LuggageStage::Interest), at(6));
    lists.requests.drop_contested();
    assert_eq!(open(&lists), [2, 3]);
}

#[test]
fn what_a_robot_claims_leaves_the_list_and_comes_back_to_its_place() {
    let mut lists = lists();
    assert_eq!(lists.requests.claim(1).map(|request| request.job.luggage), Some(2));
    assert_eq!(open(&lists), [1, 3]);
    lists.requests.hear(&request(2), at(9));
    lists.requests.hear(&response(2, 1, LuggageStage::Interest), at(4));
    assert_eq!(lists.requests.claimed().map(|claimed| claimed.rivals.len()), Some(1));
    lists.requests.put_back();
    assert_eq!(open(&lists), [1, 2, 3]);
    assert!(lists.requests.claimed().is_none());

    lists.requests.claim(0);
    lists.requests.hear(&response(1, 3, LuggageStage::Taken), at(5));
    assert!(lists.requests.claimed().is_none());
    lists.requests.put_back();
    assert_eq!(open(&lists), [2, 3]);
}

#[test]
fn active_robots_are_listed_by_number_without_oneself() {
    let mut lists = Lists::new(MINE);
    let mut hear = |robot, active| lists.hear_robot(&RobotList { robot, active, ..RobotList::default() });
    for (robot, active) in [(4, true), (1, true), (MINE, true), (3, true), (4, true), (1, false), (9, false)] {
        hear(robot, active);
    }
    assert_eq!(lists.active.iter().map(|robot| robot.robot).collect::<Vec<_>>(), [3, 4]);
}

#[test]
fn the_newest_position_of_each_counts() {
    let mut lists = Lists::new(MINE);
    let position = |robot, x| Position { robot, block: Block::new(x, 0), ..Position::default() };
    let hear = |peers: &mut Peers, all: &[Position]| peers.hear(all.iter().map(|position| (position, Time::START)));
    hear(&mut lists.peers, &[position(3, 0), position(1, 4), position(MINE, 7), position(3, 1)]);
    hear(&mut lists.peers, &[position(3, 2)]);
    let shown = |peers: Vec<&Position>| peers.iter().map(|peer| (peer.robot, peer.block.x)).collect::<Vec<_>>();
    assert_eq!(shown(lists.peers.all().collect()), [(1, 4), (3, 2)]);
    assert_eq!(shown(lists.peers.heard().collect()), [(3, 2)]);
    let on = |x| lists.peers.on(Block::new(x, 0)).map(|peer| peer.robot);
    assert_eq!((on(4), on(7)), (Some(1), None));
}

#[test]
fn interest_of_another_program_that_says_nothing_more_ends() {
    let at = |seconds| Time::START + Duration::from_secs(seconds);
    let from = |sender, seconds| Header { sender, sent: at(seconds), cause: Cause::default() };
    let mut requests = Requests::new(1);
    requests.hear(&EventLuggage::request(1, Block::new(3, 1), Block::new(3, 9)), from(0, 1));
    let interest = |robot| EventLuggage { robot, luggage: 1, stage: LuggageStage::Interest, ..EventLuggage::default() };
    requests.hear(&interest(2), from(0, 1));
    requests.hear(&interest(3), from(saoms_api::host::FIRST_ELSEWHERE, 2));
    let rivals = |requests: &Requests| requests.open()[0].rivals.iter().map(|rival| rival.robot).collect::<Vec<_>>();
    requests.forget_silent(at(11));
    assert_eq!(rivals(&requests), [2, 3]);
    requests.forget_silent(at(12));
    assert_eq!(rivals(&requests), [2], "of its own program a robot hears all");
}

#[test]
fn an_interest_that_arrives_after_its_end_does_not_count() {
    let rivals = |lists: &Lists| lists.requests.open()[1].rivals.iter().map(|rival| rival.robot).collect::<Vec<_>>();
    for end in [LuggageStage::Release, LuggageStage::Refused] {
        let mut lists = lists();
        lists.requests.hear(&response(2, 7, end), at(6));
        lists.requests.hear(&response(2, 7, LuggageStage::Interest), at(5));
        assert_eq!(rivals(&lists), [0; 0], "{end:?}");
    }
    let mut lists = lists();
    lists.requests.hear(&response(2, 7, LuggageStage::Interest), at(7));
    lists.requests.hear(&response(2, 7, LuggageStage::Release), at(6));
    assert_eq!(rivals(&lists), [7], "it is interested again");
    // Before the request, too.
    lists.requests.hear(&response(4, 7, LuggageStage::Release), at(6));
    lists.requests.hear(&request(4), at(4));
    lists.requests.hear(&response(4, 7, LuggageStage::Interest), at(5));
    assert_eq!(lists.requests.open().last().map(|request| request.rivals.len()), Some(0));
}
