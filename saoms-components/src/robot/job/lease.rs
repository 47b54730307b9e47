//! Luggage that a master of another program requested or assigned, which the robot has on a lease.
//!
//! The master may not hear the robot, and think that it is not there: then it gives luggage that the robot did not
//! collect to another one. So the robot collects nothing before the master has answered that it may. From then on the
//! luggage is the robot's until it says itself what became of it, or a person does. No clock is needed for that: a
//! robot whose program was stopped for any time between the answer and the collecting collects what is still its own.

use saoms_api::{Context, Failure, Field, Header, KnownPublisher, Time};

use super::Job;
use crate::hardware::{Action, ActionKind};
use crate::messages::{ASSIGNMENT, Assignment, Lease, is_visit};
use crate::robot::RobotKnowledge;

/// How often in a lease the robot says that it has it.
const TIMES: u32 = 5;

/// Distance from the luggage at which the robot asks, in blocks: the answer is there when it arrives.
const ASKS_AT: u32 = 1;

/// Luggage on a lease.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Field)]
pub(crate) struct Leased {
    luggage: u32,
    number: u64,
    /// True once the robot has asked whether it may collect it.
    asks: bool,
    /// True if it may.
    may: bool,
    /// When it said so last.
    said: Option<Time>,
}

impl Leased {
    /// A lease of this luggage, with a number that no other lease of the robot has.
    pub(crate) fn of(luggage: u32, number: u64) -> Leased {
        Leased { luggage, number: number.max(1), ..Leased::default() }
    }

    /// Asks whether it may collect the luggage. True if that is news.
    pub(crate) fn ask(&mut self) -> bool {
        !std::mem::replace(&mut self.asks, true)
    }

    /// Takes an answer; true if the luggage is for another robot.
    pub(crate) fn answer(&mut self, number: u64, withdrawn: bool) -> bool {
        let is_own = number == self.number;
        self.may |= is_own && !withdrawn;
        is_own && withdrawn
    }

    /// True if the robot may not do this yet.
    pub(crate) fn forbids(&self, action: Action) -> bool {
        !self.may && action.kind == ActionKind::Collect && action.luggage == self.luggage
    }

    /// What the robot says.
    pub(crate) fn say(&self, robot: u32) -> Lease {
        Lease { robot, luggage: self.luggage, number: self.number, collects: self.asks }
    }
}

impl RobotKnowledge {
    /// Has luggage on a lease that was announced from another program.
    pub(in crate::robot) fn lease(&mut self, luggage: u32, now: Time) {
        let is_leased = self.lists.requests.is_of_elsewhere(luggage) && !is_visit(luggage);
        self.lease = is_leased.then(|| Box::new(Leased::of(luggage, now.as_nanos())));
    }

    /// Has luggage on a lease that it takes over from a robot that cannot go on, if a master is in another program:
    /// robots of several programs may do so at once, where they do not hear each other.
    pub(in crate::robot) fn lease_taken_over(&mut self, luggage: u32, context: &Context<'_>) {
        let is_leased = context.publishers(&ASSIGNMENT).iter().any(KnownPublisher::is_elsewhere) && !is_visit(luggage);
        self.lease = is_leased.then(|| Box::new(Leased::of(luggage, context.now().as_nanos())));
    }

    /// Takes what a master answers about a lease. One that ends takes the luggage back.
    pub(in crate::robot) fn hear_lease(&mut self, answer: &Assignment, header: Header) {
        let is_over = self.lease.as_mut().is_some_and(|lease| lease.answer(answer.lease, answer.withdrawn));
        if let Some(Job { luggage, from, to }) = self.job.filter(|_| is_over) {
            let withdrawn = Assignment { luggage, from, to, ..answer.clone() };
            self.lists.requests.hear_assignment(&withdrawn, header);
        }
    }

    /// True if the master has not said yet that the robot may do this.
    pub(in crate::robot) fn waits_for_master(&self, action: Action) -> bool {
        self.lease.as_ref().is_some_and(|lease| lease.forbids(action))
    }

    /// Says now and then what the robot has on a lease, and asks whether it may collect it when it is there.
    pub(in crate::robot) fn renew_lease(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let Some(job) = self.job.filter(|_| self.lease.is_some()) else { return Ok(()) };
        let (is_near, now) = (self.next.distance(job.from) <= ASKS_AT, context.now());
        let Some(lease) = self.lease.as_mut().filter(|lease| lease.luggage == job.luggage) else { return Ok(()) };
        let interval = Lease::duration(self.period) / TIMES;
        let is_due = lease.said.is_none_or(|said| now.since(said) >= interval);
        if is_near && lease.ask() || is_due {
            lease.said = Some(now);
            return context.send(&self.leases, lease.say(self.number));
        }
        Ok(())
    }
}
