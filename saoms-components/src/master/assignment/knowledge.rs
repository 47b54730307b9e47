//! Knowledge of the master of the environment, which its loops share.

use std::time::Duration;

use saoms_api::host::cdr::{DecodeError, Reader, Writer};
use saoms_api::host::declaration::ConstText;
use saoms_api::{Context, Extras, Failure, Field, Header, Knowledge, Subscription, Time};

use super::AssignmentPolicy;
use super::crew::Crew;
use super::matching::Candidate;
use crate::grid::Block;
use crate::master::event_filter::EventFilter;
use crate::master::open_luggage::{Lapsed, OpenLuggage, WaitingPiece};
use crate::master::part::{Early, Part};
use crate::messages::{
    Assignment, CriticalSituation, EventLuggage, Fault, Lease, LuggageStage, Position, RobotList, is_visit,
};
use crate::robot::{HEARD, Job};
use crate::validation::{MessageValidator, Validate};

/// Number of periods of the slowest robot for which robots decide among themselves about luggage that one of them is
/// interested in.
const DISCUSSION: u32 = 6;

/// Knowledge of the master of the environment: the open luggage, and the robots that can bring it.
#[derive(Debug, Knowledge)]
#[knowledge(name = "saoms.MasterEnvironment")]
pub struct MasterEnvironmentKnowledge {
    /// Luggage that waits and that no robot was asked to bring, oldest first.
    #[entry(name = "waiting")]
    pub(in crate::master) open: OpenLuggage,
    /// The active robots, by number.
    #[entry]
    pub(in crate::master) crew: Crew,
    /// What a loop assigns to robots in this execution.
    #[entry(effector, quiet)]
    pub assignments: Vec<Assignment>,
    /// What is to be said to robots that took visits by themselves.
    pub(in crate::master) agreed: Vec<Assignment>,
    /// Who decides which robot brings which luggage.
    pub(in crate::master) policy: AssignmentPolicy,
    /// Checks what others publish.
    pub(in crate::master) validator: MessageValidator,
    pub(in crate::master) filter: EventFilter,
    /// The blocks whose luggage it assigns; all where there is none.
    pub(in crate::master) part: Option<Part>,
    #[extras]
    extras: Extras,
}

impl MasterEnvironmentKnowledge {
    /// Knowledge without luggage and robots.
    pub fn new(policy: AssignmentPolicy) -> MasterEnvironmentKnowledge {
        MasterEnvironmentKnowledge {
            policy,
            open: OpenLuggage::default(),
            crew: Crew::default(),
            assignments: Vec::new(),
            agreed: Vec::new(),
            validator: MessageValidator::default(),
            filter: EventFilter::default(),
            part: None,
            extras: Extras::default(),
        }
    }
}

/// As an entry, a `Vec` of [`WaitingPiece`].
impl Field for OpenLuggage {
    const TYPE: ConstText = <Vec<WaitingPiece> as Field>::TYPE;
    const LEAST_SIZE: usize = <Vec<WaitingPiece> as Field>::LEAST_SIZE;

    fn write(&self, writer: &mut Writer) {
        let all: Vec<WaitingPiece> = self.waiting().collect();
        all.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Err(DecodeError::new("the master keeps this list itself, by the messages that it hears", reader.offset()))
    }
}

impl MasterEnvironmentKnowledge {
    /// True if the message is possible and sent by the robot that it names. Rejected messages are logged.
    pub(in crate::master) fn accepts<M: Validate>(
        &mut self,
        message: &M,
        header: Header,
        context: &mut Context<'_>,
    ) -> bool {
        self.validator.accepts(message, header, self.filter.area(), context)
    }

    /// True if robots hear only a part of the map.
    pub(in crate::master) fn is_large(&self) -> bool {
        self.filter.area().is_some_and(|area| area.size() > HEARD)
    }

    /// Handles the state of a robot; true if it was not active before.
    pub(in crate::master) fn hear_robot(&mut self, robot: &RobotList, header: Header) -> bool {
        let is_new = self.open.hear_robot(robot, header);
        if !self.open.is_out(robot.robot) {
            self.crew.hear_robot(robot);
        }
        is_new
    }

    /// Handles what a robot said about luggage. A robot that takes what another one has taken has to give it back.
    pub(in crate::master) fn hear_response(&mut self, said: &EventLuggage, sent: Time, now: Time) {
        if self.crew.is_outdated(said, sent) || self.crew.note_answer(said, now) {
            return;
        }
        match said.stage {
            LuggageStage::Interest => {
                self.open.discuss(said.luggage, now + self.crew.slowest().saturating_mul(DISCUSSION));
            }
            LuggageStage::Release => self.open.discuss(said.luggage, now),
            LuggageStage::Taken => {
                let bearer = self.open.bearer(said.luggage);
                self.crew.hear_response(said, now);
                if let Some(bearer) = bearer.filter(|bearer| *bearer != said.robot) {
                    return self.withdraw_from_one(said, bearer);
                }
                if is_visit(said.luggage) && bearer.is_none() {
                    self.agree(said);
                }
                return self.open.hear_response(said);
            }
            _ => {}
        }
        self.crew.hear_response(said, now);
        self.open.hear_response(said);
    }

    /// Two robots want to bring the same luggage: the one that took it later, or that has not taken it yet, or may not
    /// collect it yet, gives it back.
    fn withdraw_from_one(&mut self, said: &EventLuggage, bearer: u32) {
        // Who is asked to do a visit may have done it.
        let has_taken = is_visit(said.luggage)
            || self.crew.get(bearer).is_some_and(|member| member.job == Some(said.luggage))
                && !self.open.may_leave(said.luggage, bearer);
        let other = if has_taken { said.robot } else { bearer };
        if !has_taken {
            self.open.hear_response(said);
        }
        self.open.contend(said.luggage, other);
        self.assign(other, said.luggage, (said.from, said.to), true);
    }

    /// A robot took a visit by itself, and does not end it before it knows that no other robot does it. One that comes
    /// too late hands it back.
    fn agree(&mut self, said: &EventLuggage) {
        let EventLuggage { robot, luggage, from, to, block, .. } = *said;
        let charger = self.crew.get(robot).map_or(block, |member| member.charger);
        let withdrawn = self.open.job(luggage).is_none();
        self.agreed.push(Assignment { robot, luggage, withdrawn, from, to, charger, lease: 0 });
    }

    /// True if robots decide by themselves at present who takes the luggage.
    pub(super) fn is_discussed(&self, piece: &WaitingPiece, now: Time) -> bool {
        self.open.is_discussed(piece.job.luggage, now)
    }

    /// Robots on the way to luggage that they have not collected, and that may be asked to bring other luggage.
    pub(super) fn on_the_way(&self, now: Time) -> Vec<(Candidate, WaitingPiece)> {
        let on_the_way = self.crew.members().filter(|member| {
            let is_told = member.asked.is_some() || member.withdrawn.is_some() || member.until > now;
            !(member.collected || is_told)
        });
        let with_piece = on_the_way.filter_map(|member| {
            let piece = self.open.job(member.job?).filter(|piece| piece.only.is_none())?;
            Some((Candidate::of(member), piece))
        });
        with_piece.collect()
    }

    /// Robots that carry luggage, with the job.
    pub(super) fn carrying(&self) -> Vec<(Candidate, Job)> {
        let carrying = self.crew.members().filter(|member| member.collected);
        let with_job = carrying.filter_map(|member| {
            let piece = self.open.job(member.job?)?;
            Some((Candidate::of(member), piece.job))
        });
        with_job.collect()
    }

    /// Handles where a robot is.
    pub(in crate::master) fn hear_position(&mut self, said: &Position, now: Time) {
        let job = self.crew.get(said.robot).and_then(|member| member.job);
        let from = job.and_then(|luggage| self.open.job(luggage)).map(|piece| piece.job.from);
        self.crew.hear_position(said, from, now);
        if self.part.is_some() {
            self.crew.engage(said.robot, said.priority.is_for_work());
        }
    }

    /// Assigns luggage to a robot, or takes it back.
    pub(super) fn assign(&mut self, robot: u32, luggage: u32, (from, to): (Block, Block), withdrawn: bool) {
        let Some(member) = self.crew.get(robot) else { return };
        let charger = member.charger;
        self.assignments.push(Assignment { robot, luggage, withdrawn, from, to, charger, lease: 0 });
    }

    /// Notes what is sent to robots.
    pub(in crate::master) fn note_assigned(&mut self, assignment: &Assignment, now: Time) {
        if assignment.withdrawn {
            self.crew.withdraw(assignment.robot, assignment.luggage);
        } else {
            self.open.ask(assignment.luggage, assignment.robot);
            self.crew.ask(assignment.robot, assignment.luggage, now);
        }
    }

    /// Luggage that was assigned to robots that do not answer waits again.
    pub(in crate::master) fn expire(&mut self, now: Time) {
        for (robot, luggage) in self.crew.take_silent(now) {
            self.open.hand_back(luggage, robot);
            self.crew.changed = true;
        }
    }

    /// Handles what a robot of another program has on a lease. Gives the answer, if it gets one. Masters of zones
    /// answer for their own luggage alone.
    pub(in crate::master) fn hear_lease(&mut self, lease: &Lease, now: Time) -> Option<Assignment> {
        self.crew.hear_lease(lease.robot);
        if self.part.is_some() && self.open.job(lease.luggage).is_none() {
            return None;
        }
        let duration = Lease::duration(self.crew.get(lease.robot)?.period());
        let may = self.open.hear_lease(lease, duration, now)?;
        self.answer(lease.robot, lease.luggage, lease.number, may)
    }

    fn answer(&self, robot: u32, luggage: u32, lease: u64, may: bool) -> Option<Assignment> {
        let charger = self.crew.get(robot)?.charger;
        Some(Assignment { robot, luggage, withdrawn: !may, charger, lease, ..Assignment::default() })
    }

    /// Luggage on leases that are over waits again. Gives it, with what its robots are told.
    pub(in crate::master) fn take_lapsed(&mut self, now: Time, held_up: Duration) -> Vec<(Lapsed, Option<Assignment>)> {
        let lapsed = self.open.take_lapsed(now, held_up);
        let told = lapsed.into_iter().map(|lapsed| {
            self.crew.lapse(lapsed.robot, lapsed.request.luggage);
            let told = self.answer(lapsed.robot, lapsed.request.luggage, lapsed.number, false);
            (lapsed, told)
        });
        told.collect()
    }

    /// A robot is off the floor, or its component failed.
    pub(in crate::master) fn take_away(&mut self, fault: &Fault, header: Header) {
        self.open.take_away(fault, header);
        self.crew.remove(fault.robot);
    }

    /// True if what begins at this block is for this master; `None` while it does not know that.
    pub(in crate::master) fn is_for_this(&self, from: Block) -> Option<bool> {
        let Some(part) = &self.part else { return Some(true) };
        part.contains(from, self.filter.area())
    }

    /// Keeps what is requested before the master knows what is for it.
    pub(in crate::master) fn keep_early(&mut self, header: Header, early: Early) {
        if let Some(part) = &mut self.part {
            part.keep(header, early);
        }
    }

    /// True if it passes on what belongs to no block.
    pub(in crate::master) fn speaks_for_all(&self) -> bool {
        self.part.as_ref().is_none_or(Part::is_first)
    }

    /// True unless this is luggage of another master.
    pub(in crate::master) fn is_own(&self, luggage: u32) -> bool {
        self.part.is_none() || self.open.job(luggage).is_some()
    }

    /// Handles what a robot said about luggage of another master, which judges the message.
    pub(in crate::master) fn hear_elsewhere(&mut self, said: &EventLuggage, header: Header, context: &Context<'_>) {
        let is_known = self.crew.get(said.robot).is_some();
        if is_known && self.validator.judge(said, header, self.filter.area(), context).is_ok() {
            self.crew.hear_elsewhere(said, header.sent);
        }
    }

    /// Handles a call for help, or who follows it. Of two robots that take the same job over, the later one gives it
    /// back.
    pub(in crate::master) fn hear_situation(&mut self, situation: &CriticalSituation, sent: Time) {
        let is_own = situation.job().is_none_or(|job| self.is_own(job.luggage));
        self.crew.hear_situation(situation, sent, is_own);
        match situation.job().filter(|job| self.open.is_taken_over(job.luggage, situation)) {
            Some(Job { luggage, from, to }) => {
                self.open.contend(luggage, situation.healer);
                self.assign(situation.healer, luggage, (from, to), true);
            }
            None => self.open.hear_situation(situation),
        }
    }

    /// Hears of robots around the part, farther away the longer luggage waits.
    ///
    /// # Errors
    /// The region of hearing cannot be set.
    pub(in crate::master) fn look_around(
        &mut self,
        topics: (&Subscription<Position>, &Subscription<RobotList>),
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let (step, oldest) = (self.crew.step(), self.open.oldest());
        let Some(part) = &mut self.part else { return Ok(()) };
        part.look_around(oldest.map(|since| context.now().since(since)), step, topics, context)
    }

    /// Removes luggage that no robot can bring, as far as all robots are known. Returns number, origin and destination
    /// of each piece.
    pub(in crate::master) fn take_hopeless(&mut self, now: Time) -> Vec<(u32, Block, Block)> {
        // Robots that decide by themselves are all heard.
        let knows_all = |part: &Part| self.policy == AssignmentPolicy::Robots || part.knows_all(self.filter.area());
        if self.part.as_ref().is_none_or(knows_all) { self.open.take_hopeless(now) } else { Vec::new() }
    }
}
