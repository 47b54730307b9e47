use saoms_api::Cause;

use super::*;
use crate::messages::Fault;

fn robot(robot: u32, active: bool) -> RobotList {
    RobotList { robot, active, ..RobotList::default() }
}

fn heard(millis: u64) -> Header {
    Header { sender: 0, sent: at(millis), cause: Cause::default() }
}

fn at(millis: u64) -> Time {
    Time::START + Duration::from_millis(millis)
}

fn refusal(luggage: u32, robot: u32) -> EventLuggage {
    EventLuggage { luggage, robot, stage: LuggageStage::Refused, ..EventLuggage::default() }
}

fn hopeless(open: &mut OpenLuggage) -> Vec<u32> {
    hopeless_at(open, 0)
}

fn hopeless_at(open: &mut OpenLuggage, millis: u64) -> Vec<u32> {
    open.take_hopeless(at(millis)).into_iter().map(|(luggage, ..)| luggage).collect()
}

#[test]
fn luggage_is_given_up_once_every_robot_refused_it() {
    let mut open = OpenLuggage::default();
    for luggage in 1..=3 {
        open.add(luggage, Block::new(0, 0), Block::new(1, 0), at(0));
    }
    assert_eq!(hopeless(&mut open), [0; 0], "no robot was there yet");
    open.hear_robot(&robot(1, true), heard(0));
    open.hear_robot(&robot(2, true), heard(0));
    open.hear_response(&refusal(2, 1));
    assert_eq!(hopeless(&mut open), [0; 0]);
    open.hear_response(&refusal(2, 2));
    assert_eq!(hopeless(&mut open), [2]);
    open.hear_response(&EventLuggage { stage: LuggageStage::Delivered, luggage: 1, ..refusal(1, 1) });
    open.hear_response(&refusal(3, 1));
    open.break_down(2, at(0));
    assert_eq!(hopeless(&mut open), [3], "the other one is broken down");
}

#[test]
fn who_is_told_to_break_can_say_so_first() {
    let mut open = OpenLuggage::default();
    for number in [1, 2] {
        open.hear_robot(&RobotList { period: 500_000, ..robot(number, true) }, heard(0));
        open.add(number, Block::new(0, 0), Block::new(1, 0), at(0));
        open.break_down(number, at(1000));
    }
    assert_eq!(hopeless_at(&mut open, 1900), [0; 0]);
    open.hear_robot(&robot(2, false), heard(0));
    assert_eq!(hopeless_at(&mut open, 1950), [0; 0], "the other one may still bring it");
    assert_eq!(hopeless_at(&mut open, 2000), [1, 2], "it says nothing");
}

#[test]
fn a_robot_that_starts_later_gets_what_waits() {
    let block = |x| Block::new(x, 0);
    let help = |stage| CriticalSituation { critical: 1, luggage: 2, stage, ..CriticalSituation::default() };
    let waiting = |open: &OpenLuggage, robot| {
        let (luggage, helps) = open.waiting_for(robot);
        let luggage = luggage.iter().map(|request| request.luggage).collect::<Vec<_>>();
        (luggage, helps.iter().map(|help| help.luggage).collect::<Vec<_>>())
    };
    let mut open = OpenLuggage::default();
    for luggage in 1..=3 {
        open.add(luggage, block(0), block(1), at(0));
    }
    assert!(open.hear_robot(&robot(1, true), heard(0)));
    assert!(!open.hear_robot(&robot(1, true), heard(0)), "it was active before");
    open.hear_response(&EventLuggage { stage: LuggageStage::Taken, ..refusal(2, 1) });
    open.hear_response(&refusal(3, 2));
    assert_eq!(waiting(&open, 2), (vec![1], vec![]));
    open.hear_situation(&help(CriticalStage::Request));
    open.hear_robot(&robot(1, false), heard(0));
    assert!(open.hear_robot(&robot(1, true), heard(0)));
    assert_eq!(waiting(&open, 1), (vec![1, 3], vec![2]), "a robot that starts again knows nothing");
    open.hear_situation(&help(CriticalStage::Taken));
    assert_eq!(waiting(&open, 1), (vec![1, 3], vec![]));
    open.hear_response(&EventLuggage { stage: LuggageStage::Request, ..refusal(2, 0) });
    assert_eq!(waiting(&open, 2), (vec![1, 2], vec![]));
}

#[test]
fn luggage_is_given_up_once_no_robot_is_left() {
    let mut open = OpenLuggage::default();
    open.hear_robot(&robot(1, true), heard(0));
    open.add(1, Block::new(0, 0), Block::new(1, 0), at(0));
    assert_eq!(hopeless(&mut open), [0; 0]);
    open.hear_robot(&robot(1, false), heard(0));
    assert_eq!(hopeless(&mut open), [1]);
    open.hear_robot(&robot(1, true), heard(0));
    open.add(2, Block::new(0, 0), Block::new(1, 0), at(0));
    assert_eq!(hopeless(&mut open), [0; 0], "it is back");
}

#[test]
fn luggage_of_a_robot_that_is_gone_waits_again_where_it_lies() {
    let block = |x| Block::new(x, 0);
    let taken = |luggage| EventLuggage { stage: LuggageStage::Taken, ..refusal(luggage, 1) };
    let again = |open: &mut OpenLuggage, has_world| {
        let all = open.open_again(has_world);
        all.iter().map(|(robot, request)| (*robot, request.luggage, request.from.x)).collect::<Vec<_>>()
    };
    let mut open = OpenLuggage::default();
    open.hear_robot(&robot(1, true), heard(0));
    open.hear_robot(&robot(2, true), heard(0));
    for luggage in 1..=4 {
        open.add(luggage, block(0), block(9), at(0));
    }
    open.hear_response(&taken(1));
    open.hear_response(&taken(2));
    open.hear_response(&EventLuggage { robot: 2, ..taken(3) });
    let help = CriticalSituation { critical: 1, luggage: 2, ..CriticalSituation::default() };
    open.hear_situation(&help);
    open.take_away(&Fault::gone(1), heard(5));
    assert_eq!(again(&mut open, true), [], "the world says where it lies");
    open.hear_removal(&Removal {
        robot: 1,
        since: at(5),
        block: Some(block(4)),
        luggage: vec![1],
        ..Removal::default()
    });
    assert_eq!(again(&mut open, true), [(1, 1, 4)], "the broken robot asked for help with the other piece");
    assert_eq!(again(&mut open, true), []);
    open.hear_response(&taken(4));
    assert_eq!(again(&mut open, true), [(1, 4, 0)], "it was on its way to say so");
    assert_eq!(open.waiting_for(3).0.iter().map(|request| request.from.x).collect::<Vec<_>>(), [4, 0]);

    assert!(!open.hear_robot(&robot(1, true), heard(5)), "it said so before");
    assert!(open.hear_robot(&robot(1, true), heard(6)), "it is back");
    open.hear_response(&taken(1));
    assert_eq!(again(&mut open, true), []);
    open.take_away(&Fault::gone(1), heard(9));
    assert_eq!(again(&mut open, false), [(1, 1, 4)], "nobody else can say where it lies");
}
