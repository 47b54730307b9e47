use std::fmt;

use saoms_api::{Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, Subscription, Time, info, record};

use crate::console::JavaList;
use crate::messages::{EXCEPTIONAL_EVENT, ExceptionalEvent, ROBOT_STATE, RobotState};

use super::MasterRobotKnowledge;

/// Wakes robots in proportion to the expected pieces of luggage, and sends as many to charge again when the counter of
/// their shift ends (listing 6.12).
///
/// If one shift ends as another begins, its robots stay for the new one.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.master.AwakeAsleepMS",
    knowledge = MasterRobotKnowledge,
    senses("piecesPerRobot", "counter", "robots", "asleep", "active"),
    effects("onShift")
)]
pub struct MasterAwakeAsleep {
    #[subscribes(EXCEPTIONAL_EVENT)]
    events: Subscription<ExceptionalEvent>,
    #[publishes(ROBOT_STATE)]
    states: Publisher<RobotState>,
}

/// Change of the workload: newly expected pieces of luggage, and robots that are not needed any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Workload {
    /// Newly expected pieces.
    pub pieces: u32,
    /// Number of robots that they need.
    pub needed: u32,
    /// Robots whose shift is over.
    pub released: u32,
    /// Pieces that have waited for long, if that is why robots are needed.
    pub waiting: u32,
}

/// Robots to wake or to send to charge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AwakeAsleepDecision {
    /// Wake robots.
    Awake {
        /// Number of robots to wake.
        robots: u32,
        /// Number of robots of an ended shift that stay for the next.
        stay: u32,
    },
    /// Send robots to charge.
    Asleep {
        /// Number of robots to send.
        robots: u32,
        /// Number of robots that stay for the next shift.
        stay: u32,
    },
}

impl Recordable for Workload {
    fn record(&self) -> Record {
        let Workload { pieces, needed, released, waiting } = *self;
        match (needed, released) {
            _ if waiting > 0 => record!(
                luggage_neglected:
                    "{waiting} {waiting:piece|pieces} of luggage waited for long: needs {needed} \
                     {needed:robot|robots} more",
                waiting,
                needed
            ),
            (0, _) => {
                record!(shift_ends: "the shift of {released} {released:robot|robots} ends", released)
            }
            (_, 0) => record!(
                luggage_expected:
                    "expects {pieces} more {pieces:piece|pieces} of luggage: needs {needed} {needed:robot|robots}",
                pieces,
                needed
            ),
            _ => record!(
                luggage_expected_as_shift_ends:
                    "expects {pieces} more {pieces:piece|pieces} of luggage: needs {needed} {needed:robot|robots}; \
                     the shift of {released} ends",
                pieces,
                needed,
                released
            ),
        }
    }
}

impl Recordable for AwakeAsleepDecision {
    fn record(&self) -> Record {
        match *self {
            AwakeAsleepDecision::Awake { robots: count, .. } => {
                record!(wakes_robots: "wakes {count} {count:robot|robots}", count)
            }
            AwakeAsleepDecision::Asleep { robots: count, .. } => {
                record!(sends_robots_to_charge: "sends {count} {count:robot|robots} to charge", count)
            }
        }
    }
}

impl Loop for MasterAwakeAsleep {
    type Properties = ();
    type Knowledge = MasterRobotKnowledge;
    type Symptom = Workload;
    type Decision = AwakeAsleepDecision;

    fn analyze(
        &mut self,
        knowledge: &mut MasterRobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<Workload>, Failure> {
        let (ended, started) = knowledge.end_shifts();
        context.because(started);
        let (mut pieces, mut needed, mut waiting) = (0_u32, 0_u32, 0_u32);
        for (header, event) in context.receive(&self.events).with_headers() {
            context.because(header.cause);
            pieces = pieces.saturating_add(event.pieces);
            needed = needed.saturating_add(event.pieces.div_ceil(knowledge.pieces_per_robot));
            let active = JavaList(knowledge.active());
            context.console(format_args!("MasterRobotManagingSystem updated active robot list: {active}"));
        }
        let released = if knowledge.counts_alone() {
            ended
        } else {
            knowledge.due = knowledge.due.saturating_add(ended);
            knowledge.work.end_period();
            knowledge.work.announce(pieces, knowledge.counter);
            let counter = context.period().saturating_mul(knowledge.counter);
            let before = context.now().as_nanos().checked_sub(u64::try_from(counter.as_nanos()).unwrap_or(u64::MAX));
            let neglects = before.and_then(|before| knowledge.neglects(Time::from_nanos(before)));
            match neglects.filter(|_| needed == 0) {
                Some((neglected, robots, cause)) => {
                    context.because(cause);
                    (waiting, needed) = (neglected, robots);
                    0
                }
                // Robots whose shift is over stay for the next one.
                None if knowledge.due > 0 => {
                    let released = if needed > 0 { needed } else { knowledge.surplus() };
                    let released = released.min(knowledge.due);
                    knowledge.due -= released;
                    released
                }
                None => 0,
            }
        };
        Ok((needed > 0 || released > 0).then_some(Workload { pieces, needed, released, waiting }))
    }

    fn plan(
        &mut self,
        symptom: Workload,
        _knowledge: &mut MasterRobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<AwakeAsleepDecision>, Failure> {
        let Workload { needed, released, .. } = symptom;
        Ok(Some(if needed >= released {
            AwakeAsleepDecision::Awake { robots: needed - released, stay: released }
        } else {
            AwakeAsleepDecision::Asleep { robots: released - needed, stay: needed }
        }))
    }

    fn execute(
        &mut self,
        decision: AwakeAsleepDecision,
        knowledge: &mut MasterRobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let cause = context.cause();
        match decision {
            AwakeAsleepDecision::Awake { robots, stay } => {
                let woken = self.call(robots, true, knowledge, context)?;
                knowledge.start_shift(stay.saturating_add(woken), cause);
            }
            AwakeAsleepDecision::Asleep { robots, stay } => {
                self.call(robots, false, knowledge, context)?;
                knowledge.start_shift(stay, cause);
            }
        }
        Ok(())
    }
}

impl MasterAwakeAsleep {
    /// Calls up to `count` robots; returns the number of those called.
    fn call(
        &self,
        count: u32,
        awake: bool,
        knowledge: &mut MasterRobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<u32, Failure> {
        let mut called = Vec::new();
        while called.len() < count as usize {
            let next = if awake { knowledge.next_to_awake() } else { knowledge.next_to_charge() };
            let Some(robot) = next else { break };
            knowledge.note_call(robot, awake);
            context.effect(match awake {
                true => record!(wakes_robot: "wakes robot {robot}", robot),
                false => record!(sends_robot_to_charge: "sends robot {robot} to charge", robot),
            });
            context.send(&self.states, RobotState { robot, awake, emulate: 0 })?;
            called.push(robot);
        }
        match (&called[..], awake) {
            ([], _) => {}
            (called, true) => info!(context, "wakes {}", Robots(called)),
            (called, false) => info!(context, "sends {} to charge", Robots(called)),
        }
        let missing = (count as usize).saturating_sub(called.len());
        if missing > 0 && awake {
            let missing = u32::try_from(missing).unwrap_or(u32::MAX);
            let robots = robots(missing);
            info!(context, "needs {missing} more {robots}, but none is asleep");
            context.effect(record!(
                too_few_robots_asleep: "needs {missing} more {missing:robot|robots}, but none is asleep",
                missing
            ));
        }
        Ok(u32::try_from(called.len()).unwrap_or(u32::MAX))
    }
}

/// The noun for a number of robots.
const fn robots(count: u32) -> &'static str {
    if count == 1 { "robot" } else { "robots" }
}

/// Robots as a list in a sentence.
struct Robots<'a>(&'a [u32]);

impl fmt::Display for Robots<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            [] => formatter.write_str("no robot"),
            [one] => write!(formatter, "robot {one}"),
            [first @ .., last] => {
                formatter.write_str("robots ")?;
                for (place, robot) in first.iter().enumerate() {
                    let comma = if place > 0 { ", " } else { "" };
                    write!(formatter, "{comma}{robot}")?;
                }
                write!(formatter, " and {last}")
            }
        }
    }
}
