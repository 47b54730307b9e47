//! Robots that cannot continue, and robots that help them.

mod records;
mod substitute;

use saoms_api::{Cause, Context, Failure, Loop, LoopClass, Publisher, Saved, Subscription, info};

use crate::grid::Block;
use crate::messages::{
    CRITICAL_SITUATION, CriticalKind, CriticalSituation, CriticalStage, EVENT_LUGGAGE, EventLuggage, FAULT, Fault,
    LuggageStage, ROBOT_STATE, RobotState,
};
use crate::robot::lists::WAY_CLOSED;
use crate::robot::memory::lasting::lasting;
use crate::robot::{ASSISTANCE, Help, Rival, RobotKnowledge, Trouble};

use super::energy::Feasibility;
use super::patience::Idle;

use records::doing;
pub(super) use records::{SafeCriticalDecision, SafeCriticalSymptom};
use substitute::Substitution;

/// Looks after robots that cannot go on.
///
/// *This robot*: when it breaks, it reports its job, stays where it is, and is silent from then on.
///
/// *Others*: a free robot offers help with its position, and helps once no other offer is known. If there are several
/// offers, all robots but the closest take theirs back. As with luggage (see
/// [`saoms.EventLuggageMS`](super::SafeEventLuggage)) no two robots help the same robot, however late messages are. The
/// helper takes over the whole job and wakes a substitute for the broken robot. Only robots without a job take one
/// over; if the broken robot had no job, any robot that is awake wakes another one.
///
/// *Charging*: a robot that has to charge wakes a sleeping robot as its substitute, and sleeps when it is charged.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.CriticalSituationMS",
    knowledge = RobotKnowledge,
    senses(
        "battery", "block", "inCharge", "asleep", "transporter", "hasLuggage", "lasts", "mustCharge", "relieved",
        "standsInFor", "moving", "handling", "loaded", "robots", "helpRequests"
    ),
    effects(
        "job", "busy", "transporter", "hasLuggage", "healer", "critical", "asleep", "inCharge", "offersHelp",
        "standsInFor", "relieved", "trouble", "reserve"
    )
)]
pub struct SafeCriticalSituation {
    #[publishes(CRITICAL_SITUATION)]
    situations: Publisher<CriticalSituation>,
    #[subscribes(CRITICAL_SITUATION)]
    situations_heard: Subscription<CriticalSituation>,
    #[subscribes(FAULT)]
    faults: Subscription<Fault>,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[publishes(ROBOT_STATE)]
    states: Publisher<RobotState>,
    /// Cause of the robot's breakdown.
    cause: Cause,
    /// Position of the robot at its offer to help.
    said_at: Block,
    /// Cause of the offer; its next decision about that robot follows from it.
    said: Cause,
    /// True if it was bringing another robot's luggage at the time of the offer.
    was_healer: bool,
    substitution: Option<Substitution>,
    /// Cause for waking another robot.
    missing: Cause,
    /// True if it was charging in the last execution.
    was_in_charge: bool,
    idle: Idle,
}

lasting! {
    SafeCriticalSituation as CriticalMemory { cause: Cause, said_at: Block, said: Cause, was_healer: bool, substitution: Option<Substitution>, missing: Cause, was_in_charge: bool, idle: Idle }
}

impl Loop for SafeCriticalSituation {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = SafeCriticalSymptom;
    type Decision = SafeCriticalDecision;

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        for (header, fault) in context.receive(&self.faults).with_headers() {
            let is_mine = knowledge.accepts(fault, header, context) && fault.breaks(knowledge.number);
            if is_mine && knowledge.trouble.is_none() {
                knowledge.trouble = Some(Trouble::Breakdown);
                self.cause = header.cause;
            }
        }
        for (header, situation) in context.receive(&self.situations_heard).with_headers() {
            let is_over =
                situation.stage == CriticalStage::Intention && knowledge.lists.gone.is_over(situation.healer, header);
            if !knowledge.accepts(situation, header, context) || is_over {
                continue;
            }
            // A robot that only charges looks for its substitute itself. One that started again learns from the master
            // which job it left.
            if situation.critical != knowledge.number || situation.is_again() {
                knowledge.lists.helps.hear(situation, header);
            }
            if situation.stage == CriticalStage::StandsIn
                && let Some(substitution) = &mut self.substitution
            {
                substitution.hear(situation.critical, situation.healer);
            }
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<SafeCriticalSymptom>, Failure> {
        if knowledge.variables.critical {
            return Ok(None);
        }
        if let Some(trouble) = knowledge.trouble {
            context.because(self.cause);
            let (kind, block) = (knowledge.critical_kind(), knowledge.block);
            return Ok(Some(SafeCriticalSymptom::Broken { trouble, kind, block }));
        }
        let starts_to_charge = knowledge.variables.in_charge && !self.was_in_charge;
        self.was_in_charge = knowledge.variables.in_charge;
        if knowledge.offers_help {
            context.because(self.said);
            return Ok(self.look_at_claimed(knowledge));
        }
        if knowledge.variables.asleep {
            return Ok(look_for_hopeless_requests(knowledge).map(|(symptom, cause)| {
                context.because(cause);
                symptom
            }));
        }
        if let Some(emulates) = knowledge.stands_in_for
            && !knowledge.needs_help(emulates)
        {
            return Ok(Some(SafeCriticalSymptom::Woken { emulates }));
        }
        if let Some(substitution) = &mut self.substitution {
            let symptom = substitution.look(knowledge);
            if symptom.is_some() {
                context.because(self.missing);
                return Ok(symptom);
            }
            if !substitution.is_waiting() {
                self.substitution = None;
            }
        }
        if let Some((situation, cause)) = self.look_at_idleness(knowledge, context) {
            context.because(cause);
            return Ok(Some(SafeCriticalSymptom::InVain(situation)));
        }
        if knowledge.stopped {
            return Ok(None);
        }
        let mut found = look_for_help_requests(knowledge);
        if found.is_none() && (knowledge.must_charge || knowledge.relieved) {
            found = look_for_hopeless_requests(knowledge);
        }
        if let Some((symptom, cause)) = found {
            context.because(cause);
            return Ok(Some(symptom));
        }
        let left = knowledge.executions_left();
        let low = left < knowledge.executions_when_full() / 2;
        let charges = starts_to_charge && low && knowledge.is_free() && !knowledge.relieved;
        let battery = knowledge.battery.percent();
        let substituted = charges && self.substitution.is_none();
        let better = || knowledge.best_sleeper(&[]).is_some_and(|sleeper| sleeper.battery > battery);
        Ok((substituted && better()).then_some(SafeCriticalSymptom::Charges { battery }))
    }

    fn plan(
        &mut self,
        symptom: SafeCriticalSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<SafeCriticalDecision>, Failure> {
        Ok(Some(match symptom {
            SafeCriticalSymptom::Broken { trouble, kind, .. } => SafeCriticalDecision::CallForHelp { trouble, kind },
            SafeCriticalSymptom::NeedsHelp { situation, .. } => match situation.job() {
                None => SafeCriticalDecision::Offer(situation),
                Some(job) => match knowledge.means(&job) {
                    Feasibility::Enough => SafeCriticalDecision::Offer(situation),
                    Feasibility::Needs(needs) => SafeCriticalDecision::Postpone { situation, needs },
                    Feasibility::Later => SafeCriticalDecision::AwaitWay(situation),
                    Feasibility::Never => SafeCriticalDecision::Refuse(situation),
                },
            },
            SafeCriticalSymptom::InVain(situation) => SafeCriticalDecision::Refuse(situation),
            SafeCriticalSymptom::Alone(situation) => SafeCriticalDecision::Heal(situation),
            SafeCriticalSymptom::Beaten { situation, .. } => SafeCriticalDecision::Release(situation),
            SafeCriticalSymptom::Gone => SafeCriticalDecision::Forget,
            SafeCriticalSymptom::Woken { emulates } => SafeCriticalDecision::StandIn { critical: emulates },
            SafeCriticalSymptom::Charges { .. } => SafeCriticalDecision::AskForSubstitute,
            SafeCriticalSymptom::Missing { robot, sleeper, .. } => SafeCriticalDecision::Awake { sleeper, robot },
            SafeCriticalSymptom::Substituted { robot, .. } => SafeCriticalDecision::Rest { robot },
        }))
    }

    fn execute(
        &mut self,
        decision: SafeCriticalDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision {
            SafeCriticalDecision::CallForHelp { trouble, kind } => {
                return self.call_for_help(knowledge, context, trouble, kind);
            }
            SafeCriticalDecision::Offer(situation) => {
                knowledge.lists.helps.claim(&situation);
                knowledge.offers_help = true;
                self.was_healer = std::mem::replace(&mut knowledge.variables.healer, true);
                knowledge.variables.busy = true;
                (self.said_at, self.said) = (knowledge.block, context.cause());
                let critical = situation.critical;
                context.console(format_args!("Robot{} is a new healer for Robot{critical}", knowledge.number));
                self.respond(knowledge, context, situation, CriticalStage::Intention)?;
            }
            SafeCriticalDecision::Postpone { situation, needs } => {
                knowledge.lists.helps.postpone(&situation, needs);
            }
            SafeCriticalDecision::AwaitWay(situation) => {
                knowledge.lists.helps.postpone(&situation, WAY_CLOSED);
            }
            SafeCriticalDecision::Refuse(situation) => {
                knowledge.lists.helps.refuse(&situation);
                if let Some(job) = situation.job() {
                    let refused = job.response(knowledge.number, knowledge.block, LuggageStage::Refused);
                    context.send(&self.luggage, refused)?;
                }
            }
            SafeCriticalDecision::Heal(situation) => self.heal(knowledge, context, situation)?,
            SafeCriticalDecision::Release(situation) => {
                knowledge.lists.helps.put_back();
                knowledge.end_offer(self.was_healer);
                self.respond(knowledge, context, situation, CriticalStage::Release)?;
            }
            SafeCriticalDecision::Forget => knowledge.end_offer(self.was_healer),
            SafeCriticalDecision::StandIn { critical } => {
                knowledge.stands_in_for = None;
                let (kind, block) = (CriticalKind::Idle, knowledge.block);
                let situation = CriticalSituation { critical, kind, block, ..CriticalSituation::default() };
                self.respond(knowledge, context, situation, CriticalStage::StandsIn)?;
            }
            SafeCriticalDecision::AskForSubstitute => {
                self.substitution = Some(Substitution::of(knowledge.number));
                self.missing = context.cause();
                context.send(&self.situations, knowledge.situation(CriticalKind::Idle))?;
            }
            SafeCriticalDecision::Awake { sleeper, robot } => {
                if let Some(substitution) = &mut self.substitution {
                    substitution.ask(sleeper);
                }
                info!(context, "wakes robot {sleeper} to stand in for robot {robot}");
                let name = &knowledge.name;
                context.console(format_args!("{name} is a healer and awakes another robot"));
                self.awake(context, sleeper, robot)?;
            }
            SafeCriticalDecision::Rest { robot } => {
                self.substitution = None;
                knowledge.relieved |= robot == knowledge.number;
            }
        }
        Ok(())
    }

    fn shutdown(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        // Another robot has to take over the rest of the job.
        if knowledge.job.is_some() && !knowledge.visits && !knowledge.variables.critical {
            context.send(&self.situations, knowledge.situation(knowledge.critical_kind()))?;
        }
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}

impl SafeCriticalSituation {
    fn respond(
        &self,
        knowledge: &RobotKnowledge,
        context: &mut Context<'_>,
        situation: CriticalSituation,
        stage: CriticalStage,
    ) -> Result<(), Failure> {
        let (healer, healer_block) = (knowledge.number, knowledge.block);
        context.send(&self.situations, CriticalSituation { stage, healer, healer_block, ..situation })
    }

    /// Wakes a robot as a substitute for another one.
    fn awake(&self, context: &mut Context<'_>, robot: u32, emulate: u32) -> Result<(), Failure> {
        context.send(&self.states, RobotState { robot, awake: true, emulate })
    }

    /// State of the robot that this one offered to help; `None` while it waits for others to take their offers back.
    fn look_at_claimed(&self, knowledge: &RobotKnowledge) -> Option<SafeCriticalSymptom> {
        let Some(request) = knowledge.lists.helps.claimed() else { return Some(SafeCriticalSymptom::Gone) };
        let situation = request.situation.clone();
        if knowledge.lists.is_doubted || situation.kind != CriticalKind::Idle && knowledge.must_charge {
            return Some(SafeCriticalSymptom::Beaten { situation, by: None });
        }
        let by = closer_rival(request, self.said_at, knowledge.number);
        if by.is_some() {
            return Some(SafeCriticalSymptom::Beaten { situation, by });
        }
        request.rivals.is_empty().then_some(SafeCriticalSymptom::Alone(situation))
    }

    /// A request that this robot cannot answer in time, and its cause.
    fn look_at_idleness(
        &mut self,
        knowledge: &RobotKnowledge,
        context: &Context<'_>,
    ) -> Option<(CriticalSituation, Cause)> {
        let oldest = knowledge.lists.helps.open().iter().find(|help| help.situation.job().is_some());
        self.idle.note(oldest.is_some() && knowledge.job.is_none());
        let oldest =
            oldest.filter(|help| self.idle.is_in_vain(help.since, knowledge.energy.executions_of_move(), context))?;
        Some((oldest.situation.clone(), oldest.cause))
    }

    fn heal(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
        situation: CriticalSituation,
    ) -> Result<(), Failure> {
        let critical = situation.critical;
        knowledge.lists.helps.settle();
        knowledge.end_offer(self.was_healer);
        if let Some(job) = situation.job() {
            (knowledge.job, knowledge.visits, knowledge.is_assigned) = (Some(job), false, false);
            (knowledge.variables.busy, knowledge.variables.healer) = (true, true);
            knowledge.set_out(&job);
            let luggage = job.luggage;
            knowledge.lease_taken_over(luggage, context);
            if critical == knowledge.number {
                info!(context, "takes luggage {luggage} again, which it left at {}", job.from);
            } else {
                info!(context, "takes over luggage {luggage} from robot {critical}");
            }
        }
        if critical != knowledge.number {
            self.substitution = Some(Substitution::of(critical));
            self.missing = context.cause();
        }
        self.respond(knowledge, context, situation, CriticalStage::Taken)
    }

    /// Reports its open job, and shuts down. If the hardware cannot be reached, this is repeated in the next execution.
    fn call_for_help(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
        trouble: Trouble,
        kind: CriticalKind,
    ) -> Result<(), Failure> {
        if !knowledge.retire(context)? {
            return Ok(());
        }
        if let Some(request) = knowledge.lists.requests.settle() {
            let release = request.job.response(knowledge.number, knowledge.block, LuggageStage::Release);
            context.send(&self.luggage, release)?;
        }
        if let Some(request) = knowledge.lists.helps.claimed() {
            let situation = request.situation.clone();
            self.respond(knowledge, context, situation, CriticalStage::Release)?;
        }
        let situation = knowledge.situation(kind);
        context.count("assistance", 1);
        let (block, what, doing) = (knowledge.block, trouble.words(), doing(kind));
        context.alert(ASSISTANCE, "", format_args!("{what} at {block} {doing}: needs assistance"));
        context.send(&self.situations, situation)?;
        if !knowledge.lists.anybody_awake()
            && let Some(sleeper) = knowledge.best_sleeper(&[])
        {
            self.awake(context, sleeper.robot, knowledge.number)?;
        }
        knowledge.offers_help = false;
        knowledge.drop_job();
        let variables = &mut knowledge.variables;
        (variables.critical, variables.asleep, variables.in_charge) = (true, false, false);
        Ok(())
    }
}

/// The oldest request that this robot can answer, and its cause.
fn look_for_help_requests(knowledge: &mut RobotKnowledge) -> Option<(SafeCriticalSymptom, Cause)> {
    if knowledge.lists.helps.open().is_empty() {
        return None;
    }
    let free =
        knowledge.is_free() && !knowledge.must_charge && !knowledge.relieved && knowledge.hardware.running().is_none();
    if free {
        knowledge.keep_usual_reserve();
    }
    let (left, emulates) = (knowledge.executions_left(), knowledge.stands_in_for);
    let can = |request: &&Help| {
        let idle = request.situation.kind == CriticalKind::Idle;
        let means = if idle { knowledge.lists.sleepers().next().is_some() } else { free };
        means
            && request.needs <= left
            && knowledge.is_to_be_helped(request)
            && closer_rival(request, knowledge.block, knowledge.number).is_none()
    };
    let requests = knowledge.lists.helps.open().iter().filter(can);
    // A robot that was woken for another one helps that one first.
    let request = requests.min_by_key(|request| emulates != Some(request.situation.critical))?;
    let (situation, cause) = (request.situation.clone(), request.cause);
    let distance = knowledge.block.distance(start(&situation));
    Some((SafeCriticalSymptom::NeedsHelp { situation, distance }, cause))
}

/// A request whose job is out of this robot's reach, even if it takes no job now: others may have to know that no robot
/// can do it.
fn look_for_hopeless_requests(knowledge: &mut RobotKnowledge) -> Option<(SafeCriticalSymptom, Cause)> {
    let open = knowledge.lists.helps.open().len();
    (0..open).find_map(|place| {
        let request = knowledge.lists.helps.open().get(place)?;
        let (situation, cause) = (request.situation.clone(), request.cause);
        if knowledge.means(&situation.job()?) != Feasibility::Never {
            return None;
        }
        let distance = knowledge.block.distance(start(&situation));
        Some((SafeCriticalSymptom::NeedsHelp { situation, distance }, cause))
    })
}

/// A robot that offered help and is closer; of equally close robots the one with the lower number is.
fn closer_rival(request: &Help, block: Block, number: u32) -> Option<u32> {
    let start = start(&request.situation);
    let mine = (block.distance(start), number);
    let closer = |rival: &&Rival| (rival.block.distance(start), rival.robot) < mine;
    request.rivals.iter().find(closer).map(|rival| rival.robot)
}

/// Block where the help begins.
fn start(situation: &CriticalSituation) -> Block {
    situation.job().map_or(situation.block, |job| job.from)
}

impl RobotKnowledge {
    /// True if a request is open: its robot is broken. Robots that only charge find their substitutes themselves.
    pub(super) fn is_to_be_helped(&self, request: &Help) -> bool {
        let CriticalSituation { kind, critical, .. } = request.situation;
        kind != CriticalKind::Idle || !self.lists.is_active(critical)
    }

    fn needs_help(&self, critical: u32) -> bool {
        let mut requests = self.lists.helps.open().iter();
        requests.any(|request| request.is_of(critical) && self.is_to_be_helped(request))
    }

    /// Ends the offer to help.
    fn end_offer(&mut self, was_healer: bool) {
        self.offers_help = false;
        self.stands_in_for = None;
        self.variables.busy = self.job.is_some();
        self.variables.healer = was_healer;
    }
}
