//! Faults that scenarios put into the fleet: what concerns moves the world plays, the rest robots do.

use saoms_api::{Cause, Context, Header, record, warn};

use super::World;
use super::referee::Slowness;
use crate::messages::{Outage, Slow, end_of};
use crate::validation::{Problem, Validate};

impl World {
    /// Takes in what makes robots slow, drains their batteries, or ends their chargers.
    pub(super) fn take_strain(&mut self, context: &mut Context<'_>) {
        for (header, slow) in context.receive(&self.slowed).with_headers() {
            if self.can_be(context, header, slow) {
                self.slow_down(context, header, slow);
            }
        }
        for (header, drain) in context.receive(&self.drained).with_headers() {
            if self.can_be(context, header, drain) && self.knows(context, header, (drain, drain.robot)) {
                context.count("faults.applied.drain", 1);
            }
        }
        for (header, outage) in context.receive(&self.outages).with_headers() {
            if self.can_be(context, header, outage) {
                let Outage { charger, .. } = *outage;
                context.count("faults.applied.outage", 1);
                context.because(header.cause);
                context.effect(record!(charger_is_out: "the charger at {charger} gives nothing", charger));
                context.because(Cause::default());
                warn!(context, "the charger at {charger} gives nothing {}", lasting(outage.lasting.as_ref()));
            }
        }
    }

    /// True if a fault is possible. Others are counted.
    fn can_be<M: Validate>(&mut self, context: &mut Context<'_>, header: Header, fault: &M) -> bool {
        match fault.validate(header.sender, &mut self.validator, Some(self.referee.map())) {
            Ok(()) => true,
            Err(problem) => self.ignore(context, header, (fault, problem)),
        }
    }

    /// True if a robot is in this world. Faults of others are counted.
    fn knows<M: Validate>(&mut self, context: &mut Context<'_>, header: Header, (fault, robot): (&M, u32)) -> bool {
        self.referee.block(robot).is_ok() || self.ignore(context, header, (fault, Problem::Unknown { robot }))
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

    fn slow_down(&mut self, context: &mut Context<'_>, header: Header, slow: &Slow) {
        let Slow { robot, factor, .. } = *slow;
        let until = end_of(header.sent, slow.lasting.as_ref());
        if !self.referee.slow_down(robot, Slowness { factor, until }) {
            self.ignore(context, header, (slow, Problem::Unknown { robot }));
            return;
        }
        context.count("faults.applied.slow", 1);
        context.because(header.cause);
        context.effect(record!(slows_robot: "robot {robot} takes {factor} times as long", robot, factor));
        context.because(Cause::default());
        warn!(context, "robot {robot} takes {factor} times as long {}", lasting(slow.lasting.as_ref()));
    }
}

/// How long a fault lasts, in words.
fn lasting(time: Option<&saoms_api::builtin_interfaces::Duration>) -> String {
    match end_of(saoms_api::Time::START, time) {
        Some(end) => format!("for {} s", end.as_secs_f64()),
        None => "to the end of the run".to_owned(),
    }
}
