//! Faults that scenarios put into the fleet: what concerns moves the world plays, the rest robots do.

use std::mem;

use saoms_api::{Cause, Context, Field, Header, Time, record, warn};

use super::World;
use super::referee::Slowness;
use crate::messages::{Outage, end_of};
use crate::validation::{Problem, Validate};

/// Most faults that wait for robots to enter the floor.
const MOST_EARLY: usize = 10_000;

/// A fault of a robot that is not on the floor yet: it acts once the robot enters.
#[derive(Clone, Copy, Debug, PartialEq, Field)]
pub(super) struct EarlyFault {
    robot: u32,
    began: Time,
    /// How slow the robot will be; none if its battery is drained, which the robot does.
    slow: Option<Slowness>,
    /// The record of the journal that is the reason; 0 is none.
    cause: u64,
}

impl World {
    /// Takes in what makes robots slow, drains their batteries, or ends their chargers.
    pub(super) fn take_strain(&mut self, context: &mut Context<'_>) {
        self.take_early(context);
        for (header, slow) in context.receive(&self.slowed).with_headers() {
            if self.can_be(context, header, slow) {
                let slowness = Slowness { factor: slow.factor, until: end_of(header.sent, slow.lasting.as_ref()) };
                self.apply(context, header, (slow, EarlyFault::of(slow.robot, Some(slowness), header)));
            }
        }
        for (header, drain) in context.receive(&self.drained).with_headers() {
            if self.can_be(context, header, drain) {
                self.apply(context, header, (drain, EarlyFault::of(drain.robot, None, header)));
            }
        }
        for (header, outage) in context.receive(&self.outages).with_headers() {
            if self.can_be(context, header, outage) {
                let Outage { charger, .. } = *outage;
                context.count("faults.applied.outage", 1);
                context.because(header.cause);
                context.effect(record!(charger_is_out: "the charger at {charger} gives nothing", charger));
                context.because(Cause::default());
                warn!(
                    context,
                    "the charger at {charger} gives nothing {}",
                    lasting(header.sent, end_of(header.sent, outage.lasting.as_ref()))
                );
            }
        }
    }

    /// True if a fault is possible. Others are counted.
    fn can_be<M: Validate>(&mut self, context: &mut Context<'_>, header: Header, fault: &M) -> bool {
        match self.validator.judge(fault, header, Some(self.referee.map()), context) {
            Ok(()) => true,
            Err(problem) => self.ignore(context, header, (fault, problem)),
        }
    }

    /// Applies a fault of a robot, or keeps it until the robot enters the floor.
    fn apply<M: Validate>(&mut self, context: &mut Context<'_>, header: Header, (message, fault): (&M, EarlyFault)) {
        if self.referee.block(fault.robot).is_ok() {
            self.act(context, fault);
        } else if self.early.len() < MOST_EARLY {
            self.early.push(fault);
        } else {
            self.ignore(context, header, (message, Problem::Unknown { robot: fault.robot }));
        }
    }

    /// Applies the faults of robots that have entered the floor since.
    fn take_early(&mut self, context: &mut Context<'_>) {
        if self.early.is_empty() {
            return;
        }
        let (entered, early) = mem::take(&mut self.early)
            .into_iter()
            .partition::<Vec<_>, _>(|fault| self.referee.block(fault.robot).is_ok());
        self.early = early;
        for fault in entered {
            self.act(context, fault);
        }
    }

    /// Counts and names the faults of robots that never entered the floor.
    pub(super) fn end_early(&mut self, context: &mut Context<'_>) {
        for EarlyFault { robot, .. } in mem::take(&mut self.early) {
            context.count("faults.ignored", 1);
            warn!(context, "ignores a fault of robot {robot}, which never entered the floor");
        }
    }

    #[cold]
    fn ignore<M: Validate>(
        &mut self,
        context: &mut Context<'_>,
        header: Header,
        (fault, problem): (&M, Problem),
    ) -> bool {
        context.count("faults.ignored", 1);
        self.validator.log_rejection(context, header, fault, problem);
        false
    }

    /// Applies a fault of a robot on the floor.
    fn act(&mut self, context: &mut Context<'_>, EarlyFault { robot, began, slow, cause }: EarlyFault) {
        let Some(slowness) = slow else { return context.count("faults.applied.drain", 1) };
        let Slowness { factor, until } = slowness;
        self.referee.slow_down(robot, slowness);
        context.count("faults.applied.slow", 1);
        context.because(Cause(cause));
        context.effect(record!(slows_robot: "robot {robot} takes {factor} times as long", robot, factor));
        context.because(Cause::default());
        warn!(context, "robot {robot} takes {factor} times as long {}", lasting(began, until));
    }
}

impl EarlyFault {
    fn of(robot: u32, slow: Option<Slowness>, header: Header) -> EarlyFault {
        EarlyFault { robot, began: header.sent, slow, cause: header.cause.0 }
    }
}

/// How long a fault lasts, in words.
fn lasting(began: Time, end: Option<Time>) -> String {
    match end {
        Some(end) => format!("for {} s", end.since(began).as_secs_f64()),
        None => "to the end of the run".to_owned(),
    }
}
