use super::*;
use crate::grid::Block;
use crate::messages::{EventLuggage, LuggageStage, Position, RobotList, RobotState};

const ROBOT: u32 = 7;

fn list(battery: f64) -> RobotList {
    RobotList { robot: ROBOT, active: true, battery, ..RobotList::default() }
}

fn position(robot: u32) -> Position {
    Position { robot, ..Position::default() }
}

#[test]
fn the_first_that_says_something_as_a_robot_speaks_for_it() {
    let mut validator = MessageValidator::default();
    assert_eq!(position(ROBOT).validate(1, &mut validator, None), Ok(()));
    assert_eq!(list(50.0).validate(1, &mut validator, None), Ok(()));
    let foreign = Err(Problem::Foreign { robot: ROBOT, speaker: 1 });
    assert_eq!(position(ROBOT).validate(2, &mut validator, None), foreign);
    assert_eq!(list(50.0).validate(2, &mut validator, None), foreign);
    // One component may speak for several robots, for example one that drives them all.
    assert_eq!(position(8).validate(1, &mut validator, None), Ok(()));
}

#[test]
fn a_state_that_cannot_be_makes_nobody_known() {
    let mut validator = MessageValidator::default();
    for battery in [f64::NAN, f64::INFINITY, -0.1, 100.1] {
        assert!(matches!(list(battery).validate(2, &mut validator, None), Err(Problem::Battery { .. })));
    }
    assert_eq!(list(100.0).validate(1, &mut validator, None), Ok(()));
}

#[test]
fn robots_are_unknown_only_where_robots_say_that_they_are_there() {
    let here = Block::new(0, 0);
    let taken =
        EventLuggage { robot: 3, stage: LuggageStage::Taken, ..EventLuggage::request(1, here, Block::new(1, 0)) };
    let call = RobotState { robot: 4, awake: true, emulate: 0 };
    let mut validator = MessageValidator::default();
    assert_eq!(taken.validate(1, &mut validator, None), Ok(()));
    assert_eq!(call.validate(1, &mut validator, None), Ok(()));
    assert_eq!(list(50.0).validate(1, &mut validator, None), Ok(()));
    assert_eq!(call.validate(1, &mut validator, None), Err(Problem::Unknown { robot: 4 }));
    assert_eq!(taken.validate(2, &mut validator, None), Err(Problem::Foreign { robot: 3, speaker: 1 }));
}

#[test]
fn luggage_that_a_broken_robot_has_at_its_destination_is_requested_from_there_by_robots_alone() {
    let there = EventLuggage::request(1, Block::new(3, 10), Block::new(3, 10));
    let mut validator = MessageValidator::default();
    assert_eq!(list(50.0).validate(1, &mut validator, None), Ok(()));
    assert_eq!(there.validate(1, &mut validator, None), Ok(()), "a healer leaves it to the others");
    assert_eq!(there.clone().again_for(ROBOT).validate(2, &mut validator, None), Ok(()), "the master repeats it");
    let refused = Err(Problem::There { block: Block::new(3, 10) });
    assert_eq!(there.validate(2, &mut validator, None), refused, "nobody needs a robot for new luggage that is there");
}
