//! The proxy over a line whose calls are answered by hand.

use std::any::Any;
use std::collections::BTreeMap;

use saoms_api::extension::{CallLine, CallOutcome, CallProxy as _};
use saoms_api::host::{Arguments, Interface, Operation, ServiceCall, cdr};
use saoms_api::{CallError, Field};

use super::*;
use crate::hardware::Area;

/// The calls that were made, with the programs that they are for, and their outcomes.
#[derive(Default)]
struct Line {
    made: Vec<(Operation, Option<u64>)>,
    outcomes: BTreeMap<u64, CallOutcome>,
    is_ending: bool,
}

impl CallLine for Line {
    fn start(&mut self, operation: Operation, _: Vec<u8>, program: Option<u64>) -> u64 {
        self.made.push((operation, program));
        self.made.len() as u64
    }

    fn outcome(&mut self, call: u64) -> Option<CallOutcome> {
        self.outcomes.remove(&call)
    }

    fn provider(&self) -> &'static str {
        "World"
    }

    fn is_ending(&self) -> bool {
        self.is_ending
    }
}

impl Line {
    /// The last call has this reply of a program.
    fn reply<R: Field>(&mut self, program: u64, reply: R) {
        self.end(CallOutcome::Reply { program, bytes: cdr::encode(&reply) });
    }

    fn end(&mut self, outcome: CallOutcome) {
        self.outcomes.insert(self.made.len() as u64, outcome);
    }

    /// The calls since the last time.
    fn made(&mut self) -> Vec<(Operation, Option<u64>)> {
        std::mem::take(&mut self.made)
    }
}

struct Call {
    operation: Operation,
    arguments: Vec<u8>,
    reply: Option<Vec<u8>>,
}

impl ServiceCall for Call {
    fn operation(&self) -> Operation {
        self.operation
    }

    fn typed(&mut self) -> Option<(&mut dyn Any, &mut dyn Any)> {
        None
    }

    fn arguments(&mut self) -> Vec<u8> {
        self.arguments.clone()
    }

    fn reply(&mut self, bytes: &[u8]) -> Result<(), CallError> {
        self.reply = Some(bytes.to_vec());
        Ok(())
    }
}

/// A robot that calls its proxy.
#[derive(Default)]
struct Client {
    proxy: HardwareProxy,
    line: Line,
}

impl Client {
    fn call<A: Arguments, R: Field>(&mut self, operation: Operation, all: A) -> Result<R, CallError> {
        let mut call = Call { operation, arguments: arguments(all), reply: None };
        self.proxy.call(&mut self.line, &mut call)?;
        Ok(cdr::decode(&call.reply.unwrap()).unwrap())
    }

    fn enter(&mut self, block: Block) -> Result<Block, CallError> {
        self.call(ENTER, (7_u32, "Robot7".to_owned(), block))
    }

    fn begin(&mut self, action: Action) -> Result<Progress, CallError> {
        self.call(BEGIN, (7_u32, action))
    }

    fn poll(&mut self) -> Result<Progress, CallError> {
        self.call(POLL, (7_u32,))
    }

    /// A robot that entered at (1,1), with program 5.
    fn entered() -> Client {
        let mut client = Client::default();
        assert_eq!(client.enter(Block::new(1, 1)), Err(busy()));
        client.line.reply(5, Block::new(1, 1));
        assert_eq!(client.enter(Block::new(1, 1)), Ok(Block::new(1, 1)));
        client.line.made.push((0, None));
        client
    }
}

fn busy() -> CallError {
    CallError::Busy { provider: "World".to_owned() }
}

fn step() -> Action {
    Action::move_to(Block::new(2, 1))
}

#[test]
fn the_operations_have_their_numbers() {
    let declared = <dyn Hardware as Interface>::DECLARATION;
    let names = ["enter", "area", "begin", "poll", "cancel", "retire", "battery", "isOnFloor"];
    let places: Vec<_> = names.iter().map(|name| declared.find(&format!("\"name\":\"{name}\"")).unwrap()).collect();
    assert!(places.is_sorted(), "{declared}");
    assert_eq!([ENTER, AREA, BEGIN, POLL, CANCEL, RETIRE, BATTERY], [0, 1, 2, 3, 4, 5, 6]);
}

#[test]
fn an_action_runs_until_its_hardware_says_that_it_has_ended() {
    let mut robot = Client::entered();
    assert_eq!(robot.begin(step()), Ok(Progress::Running));
    for _ in 0..3 {
        assert_eq!(robot.poll(), Ok(Progress::Running), "the call that began it is not answered");
    }
    robot.line.reply(5, Progress::Running);
    assert_eq!(robot.poll(), Ok(Progress::Running));
    assert_eq!(robot.poll(), Ok(Progress::Running), "nobody asks twice at a time");
    assert_eq!(robot.line.made()[2..], [(BEGIN, Some(5)), (POLL, Some(5))]);
    robot.line.made = vec![(0, None); 4];
    robot.line.reply(5, Progress::Done);
    assert_eq!(robot.poll(), Ok(Progress::Done));
    assert_eq!(robot.poll(), Ok(Progress::Done), "as it ended");
}

#[test]
fn what_the_hardware_did_not_begin_is_begun_again() {
    let mut robot = Client::entered();
    assert_eq!(robot.begin(step()), Ok(Progress::Running));
    robot.line.end(CallOutcome::Refused(CallError::NotRunning { provider: "World".to_owned() }));
    assert_eq!(robot.poll(), Ok(Progress::Running));
    assert_eq!(robot.line.made()[2..], [(BEGIN, Some(5)), (BEGIN, Some(5))]);
}

#[test]
fn a_program_that_begins_anew_gets_the_robot_again() {
    let mut robot = Client::entered();
    assert_eq!(robot.begin(step()), Ok(Progress::Running));
    robot.line.end(CallOutcome::Gone);
    assert_eq!(robot.poll(), Ok(Progress::Failed), "never done");
    robot.line.made();
    assert_eq!(robot.begin(step()), Err(busy()));
    assert_eq!(robot.line.made, [(ENTER, None)]);
    robot.line.reply(6, Block::new(1, 1));
    assert_eq!(robot.begin(step()), Ok(Progress::Running));
    assert_eq!(robot.line.made, [(ENTER, None), (BEGIN, Some(6))]);
}

#[test]
fn a_robot_that_is_found_elsewhere_does_not_drive_on() {
    let mut robot = Client::entered();
    assert_eq!(robot.begin(step()), Ok(Progress::Running));
    robot.line.end(CallOutcome::Gone);
    assert_eq!(robot.poll(), Ok(Progress::Failed));
    assert_eq!(robot.begin(step()), Err(busy()));
    robot.line.reply(6, Block::new(2, 1));
    let error = robot.begin(step()).unwrap_err().to_string();
    assert!(error.contains("robot 7 is at (2,1) rather than (1,1)"), "{error}");
}

#[test]
fn what_a_stop_overtook_has_failed() {
    let mut robot = Client::entered();
    assert_eq!(robot.begin(step()), Ok(Progress::Running));
    robot.line.end(CallOutcome::Stopped);
    assert_eq!(robot.poll(), Ok(Progress::Failed));
    assert_eq!(robot.begin(step()), Ok(Progress::Running));
}

#[test]
fn other_answers_are_fresh_ones() {
    let mut robot = Client::default();
    let is_on_floor = |robot: &mut Client| robot.call::<_, bool>(7, (7_u32,));
    for answer in [true, false] {
        assert_eq!(is_on_floor(&mut robot), Err(busy()));
        assert_eq!(is_on_floor(&mut robot), Err(busy()));
        robot.line.reply(5, answer);
        assert_eq!(is_on_floor(&mut robot), Ok(answer));
    }
    assert_eq!(robot.call::<_, Area>(AREA, ()), Err(busy()));
}

#[test]
fn the_battery_has_its_newest_level() {
    let mut robot = Client::entered();
    let battery = |robot: &mut Client| robot.call::<_, Option<f64>>(BATTERY, (7_u32,));
    assert_eq!(battery(&mut robot), Err(busy()));
    robot.line.reply(5, Some(80.0));
    assert_eq!(battery(&mut robot), Ok(Some(80.0)));
    assert_eq!(battery(&mut robot), Ok(Some(80.0)), "the next answer is on its way");
    robot.line.reply(5, Some(79.0));
    assert_eq!(battery(&mut robot), Ok(Some(79.0)));
}

#[test]
fn at_its_end_a_robot_does_not_wait() {
    let mut robot = Client::entered();
    let retire = |robot: &mut Client| robot.call::<_, Block>(RETIRE, (7_u32,));
    assert_eq!(retire(&mut robot), Err(busy()));
    robot.line.is_ending = true;
    assert_eq!(retire(&mut robot), Ok(Block::new(1, 1)));
    let mut other = Client { line: Line { is_ending: true, ..Line::default() }, ..Client::default() };
    assert_eq!(retire(&mut other), Err(CallError::NotRunning { provider: "World".to_owned() }));
}
