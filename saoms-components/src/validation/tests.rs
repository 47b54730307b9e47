use super::*;
use crate::grid::Block;
use crate::messages::{EventLuggage, Grant, LuggageStage, Position, RobotList, RobotState, Territory};

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
    assert_eq!(position(ROBOT).validate(1.into(), &mut validator, None), Ok(()));
    assert_eq!(list(50.0).validate(1.into(), &mut validator, None), Ok(()));
    let foreign = Err(Problem::Foreign { robot: ROBOT, speaker: 1 });
    assert_eq!(position(ROBOT).validate(2.into(), &mut validator, None), foreign);
    assert_eq!(list(50.0).validate(2.into(), &mut validator, None), foreign);
    // One component may speak for several robots, for example one that drives them all.
    assert_eq!(position(8).validate(1.into(), &mut validator, None), Ok(()));
}

/// The component with the index 4 of a fleet, which has the number of a robot.
fn known(number: u32) -> Option<u32> {
    (number == ROBOT).then_some(4)
}

#[test]
fn for_a_robot_of_the_fleet_nobody_else_speaks_whoever_is_first() {
    let mut validator = MessageValidator::default();
    let mut says =
        |component: u32, robot: u32| position(robot).validate(Sender::among(&known, component), &mut validator, None);
    let foreign = Err(Problem::Foreign { robot: ROBOT, speaker: 4 });
    assert_eq!(says(2, ROBOT), foreign);
    assert_eq!(says(4, ROBOT), Ok(()));
    assert_eq!(says(2, ROBOT), foreign);
    // Of a robot that the fleet does not know, the first one is taken for it.
    assert_eq!((says(2, 8), says(4, 8)), (Ok(()), Err(Problem::Foreign { robot: 8, speaker: 2 })));
}

#[test]
fn a_lie_about_a_robot_of_the_fleet_does_not_announce_it() {
    let mut validator = MessageValidator::default();
    let other = RobotList { robot: 8, ..list(50.0) };
    assert_eq!(other.validate(Sender::among(&known, 5), &mut validator, None), Ok(()));
    let lie = list(50.0).validate(Sender::among(&known, 2), &mut validator, None);
    assert_eq!(lie, Err(Problem::Foreign { robot: ROBOT, speaker: 4 }));
    assert_eq!(validator.check_known(ROBOT), Err(Problem::Unknown { robot: ROBOT }));
}

#[test]
fn a_robot_that_joins_the_fleet_gets_its_number_back() {
    let mut validator = MessageValidator::default();
    // Before, the fleet did not know it, and a component used its number.
    assert_eq!(position(ROBOT).validate(2.into(), &mut validator, None), Ok(()));
    assert_eq!(position(ROBOT).validate(Sender::among(&known, 4), &mut validator, None), Ok(()));
    let lie = position(ROBOT).validate(Sender::among(&known, 2), &mut validator, None);
    assert_eq!(lie, Err(Problem::Foreign { robot: ROBOT, speaker: 4 }));
    // Another component takes its place, under another name.
    let replaced = |number: u32| (number == ROBOT).then_some(9);
    assert_eq!(position(ROBOT).validate(Sender::among(&replaced, 9), &mut validator, None), Ok(()));
    let late = position(ROBOT).validate(Sender::among(&replaced, 4), &mut validator, None);
    assert_eq!(late, Err(Problem::Foreign { robot: ROBOT, speaker: 9 }));
}

#[test]
fn zones_are_those_of_the_fleet_alone() {
    let mut validator = MessageValidator::default();
    let mut says = |component: u32, zone: u32| {
        let territory = Territory { zone, ..Territory::default() };
        territory.validate(Sender::among(&known, component), &mut validator, None)
    };
    assert_eq!(says(2, ROBOT), Err(Problem::ForeignZone { zone: ROBOT, speaker: 4 }));
    assert_eq!([8, 0].map(|zone| says(2, zone)), [8, 0].map(|zone| Err(Problem::UnknownZone { zone })));
    assert_eq!(says(4, ROBOT), Ok(()));
    validator.expect_introductions();
    let mut grants = |component: u32, zone: u32| {
        let grant = Grant { zone, robot: 1, ..Grant::default() };
        grant.validate(Sender::among(&known, component), &mut validator, None)
    };
    assert_eq!(grants(4, ROBOT), Ok(()));
    assert_eq!(grants(2, ROBOT), Err(Problem::ForeignZone { zone: ROBOT, speaker: 4 }));
    assert!(grants(2, 8).is_err());
}

#[test]
fn a_state_that_cannot_be_makes_nobody_known() {
    let mut validator = MessageValidator::default();
    for battery in [f64::NAN, f64::INFINITY, -0.1, 100.1] {
        assert!(matches!(list(battery).validate(2.into(), &mut validator, None), Err(Problem::Battery { .. })));
    }
    assert_eq!(list(100.0).validate(1.into(), &mut validator, None), Ok(()));
}

#[test]
fn robots_are_unknown_only_where_robots_say_that_they_are_there() {
    let here = Block::new(0, 0);
    let taken =
        EventLuggage { robot: 3, stage: LuggageStage::Taken, ..EventLuggage::request(1, here, Block::new(1, 0)) };
    let call = RobotState { robot: 4, awake: true, emulate: 0 };
    let mut validator = MessageValidator::default();
    assert_eq!(taken.validate(1.into(), &mut validator, None), Ok(()));
    assert_eq!(call.validate(1.into(), &mut validator, None), Ok(()));
    assert_eq!(list(50.0).validate(1.into(), &mut validator, None), Ok(()));
    assert_eq!(call.validate(1.into(), &mut validator, None), Err(Problem::Unknown { robot: 4 }));
    assert_eq!(taken.validate(2.into(), &mut validator, None), Err(Problem::Foreign { robot: 3, speaker: 1 }));
}

#[test]
fn luggage_that_a_broken_robot_has_at_its_destination_is_requested_from_there_by_robots_alone() {
    let there = EventLuggage::request(1, Block::new(3, 10), Block::new(3, 10));
    let mut validator = MessageValidator::default();
    assert_eq!(list(50.0).validate(1.into(), &mut validator, None), Ok(()));
    assert_eq!(there.validate(1.into(), &mut validator, None), Ok(()), "a healer leaves it to the others");
    assert_eq!(
        there.clone().again_for(ROBOT).validate(2.into(), &mut validator, None),
        Ok(()),
        "the master repeats it"
    );
    let refused = Err(Problem::There { block: Block::new(3, 10) });
    assert_eq!(
        there.validate(2.into(), &mut validator, None),
        refused,
        "nobody needs a robot for new luggage that is there"
    );
}
