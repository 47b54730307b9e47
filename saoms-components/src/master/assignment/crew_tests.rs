//! How often a robot is asked that takes no luggage.

use std::time::Duration;

use saoms_api::Time;

use super::Crew;
use crate::grid::Block;
use crate::messages::{LuggageStage, RobotList};
use crate::robot::Job;

const JOB: Job = Job { luggage: 1, from: Block::new(3, 1), to: Block::new(3, 9) };
const ROBOT: u32 = 1;
const PERIODS: u64 = 20_000;

/// The times at which a robot is asked, in its periods, while luggage waits. Its battery has the level of `battery` in
/// each period. It hands the luggage back at once if it `answers`, and otherwise says nothing of it.
fn asks(battery: impl Fn(u64) -> f64, answers: bool) -> Vec<u64> {
    let period = Duration::from_millis(100);
    let mut crew = Crew::default();
    let mut asks = Vec::new();
    for number in 0..PERIODS {
        let now = Time::START + period.saturating_mul(u32::try_from(number).unwrap());
        let (battery, period) = (battery(number), 100_000);
        crew.hear_robot(&RobotList { robot: ROBOT, active: true, period, battery, ..RobotList::default() });
        crew.take_silent(now);
        if crew.free(now).next().is_none() {
            continue;
        }
        asks.push(number);
        crew.ask(ROBOT, JOB.luggage, now);
        if answers {
            let said = JOB.response(ROBOT, JOB.from, LuggageStage::Release);
            crew.note_answer(&said, now);
            crew.hear_response(&said, now);
        }
    }
    asks
}

#[test]
fn a_robot_that_hands_luggage_back_is_asked_ever_less_often() {
    let resting = asks(|_| 50.0, true);
    assert_eq!(resting, [0, 8, 24, 56, 120, 248, 504, 1016, 2040, 4088, 8184, 16376]);
    let charging = asks(|number| 10.0 + (number / 10) as f64 / 100.0, true);
    assert_eq!(charging[..7], resting[..7]);
    let rests: Vec<u64> = charging[6..].windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert_eq!((rests.len(), rests.iter().all(|rest| *rest == 512)), (38, true), "{rests:?}");
    // News after a long rest end it.
    let starts = asks(|number| if number < 8_300 { 50.0 } else { 49.0 }, true);
    assert_eq!(starts[..12], [0, 8, 24, 56, 120, 248, 504, 1016, 2040, 4088, 8184, 8696]);
}

#[test]
fn a_robot_that_is_heard_and_does_not_answer_is_not_asked_at_once() {
    let rests: Vec<u64> = asks(|_| 50.0, false).windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert_eq!(rests[..7], [72, 80, 96, 128, 192, 320, 576]);
    assert!(rests[7..].iter().all(|rest| *rest == 576), "{rests:?}");
}
