//! Robots that cannot go on, and those that help them.

mod records;
mod substitute;

use saoms_api::{Cause, Context, Failure, Level, Loop, LoopClass, Publisher, Subscription};

use crate::grid::Block;
use crate::messages::{
    CRITICAL_SITUATION, CriticalKind, CriticalSituation, CriticalStage, EVENT_LUGGAGE, EventLuggage, FAULT,
    Fault, LuggageStage, ROBOT_STATE, RobotState,
};
use crate::robot::{Help, Rival, RobotKnowledge, Trouble};

use super::energy::Means;
use super::patience::Idle;

use records::doing;
pub(super) use records::{CriticalDecision, CriticalSymptom};
use substitute::Substitution;

/// Looks after robots that cannot go on.
///
/// *This robot*: when it breaks, it says what it was doing, stays where it is, and is silent from then on.
///
/// *Others*: a free robot says that it would help, from where it is, and helps once no other robot that would is known; where there are several, all
/// but the closest leave it. As with luggage (see [`EventLuggageMS`](super::EventLuggageMS)) no two robots help one, however late messages are. The helper
/// takes over the whole job and awakes a robot in place of the broken one. Only robots without a job take one over; for a broken robot that
/// had none, any robot that is awake awakes another one.
///
/// *Charging*: where others sleep, a robot that has to charge awakes one of them in its place, and sleeps when it is charged.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.CriticalSituationMS",
    knowledge = RobotKnowledge,
    senses("battery", "block", "inCharge", "asleep", "transporter", "hasLuggage"),
    effects("job", "busy", "healer", "critical"),
    publishes(CRITICAL_SITUATION, ROBOT_STATE, EVENT_LUGGAGE),
    subscribes(CRITICAL_SITUATION, FAULT)
)]
pub struct CriticalSituationMS {
    situations: Publisher<CriticalSituation>,
    situations_heard: Subscription<CriticalSituation>,
    faults: Subscription<Fault>,
    luggage: Publisher<EventLuggage>,
    states: Publisher<RobotState>,
    /// Why the robot broke.
    cause: Cause,
    /// From where it said that it would help.
    said_at: Block,
    /// Why: what it decides about that robot next follows from this.
    said: Cause,
    /// Whether it brought another robot's luggage already then.
    was_healer: bool,
    substitution: Option<Substitution>,
    /// Why another robot has to be awaked.
    missing: Cause,
    /// Whether it was in charge in the last execution.
    was_in_charge: bool,
    idle: Idle,
}

impl Loop for CriticalSituationMS {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = CriticalSymptom;
    type Decision = CriticalDecision;

    fn new((): ()) -> Result<Self, Failure> {
        Ok(CriticalSituationMS::default())
    }

    fn initialize(
        &mut self,
        _knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        self.situations = context.publish(&CRITICAL_SITUATION)?;
        self.situations_heard = context.subscribe(&CRITICAL_SITUATION)?;
        self.faults = context.subscribe(&FAULT)?;
        self.luggage = context.publish(&EVENT_LUGGAGE)?;
        self.states = context.publish(&ROBOT_STATE)?;
        Ok(())
    }

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        for (header, fault) in context.receive(&self.faults).with_headers() {
            let is_mine = knowledge.lets_in(fault, header, context) && fault.robot == knowledge.number;
            if is_mine && knowledge.trouble.is_none() {
                knowledge.trouble = Some(Trouble::Breakdown);
                self.cause = header.cause;
            }
        }
        for (header, situation) in context.receive(&self.situations_heard).with_headers() {
            if !knowledge.lets_in(situation, header, context) {
                continue;
            }
            // A robot that only charges looks for its substitute itself.
            if situation.critical != knowledge.number {
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
    ) -> Result<Option<CriticalSymptom>, Failure> {
        if knowledge.variables.critical {
            return Ok(None);
        }
        if let Some(trouble) = knowledge.trouble {
            context.because(self.cause);
            let (kind, block) = (knowledge.critical_kind(), knowledge.block);
            return Ok(Some(CriticalSymptom::Broken { trouble, kind, block }));
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
            return Ok(Some(CriticalSymptom::Awaked { emulates }));
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
            return Ok(Some(CriticalSymptom::InVain(situation)));
        }
        let mut found = look_for_help_requests(knowledge);
        if found.is_none() && (knowledge.energy.must_charge() || knowledge.relieved) {
            found = look_for_hopeless_requests(knowledge);
        }
        if let Some((symptom, cause)) = found {
            context.because(cause);
            return Ok(Some(symptom));
        }
        let left = knowledge.battery.executions_left();
        let low = left < knowledge.battery.executions_when_full() / 2;
        let charges = starts_to_charge && low && knowledge.is_free() && !knowledge.relieved;
        let battery = knowledge.battery.percent();
        let substituted = charges && self.substitution.is_none();
        let better = || knowledge.best_sleeper(&[]).is_some_and(|sleeper| sleeper.battery > battery);
        Ok((substituted && better()).then_some(CriticalSymptom::Charges { battery }))
    }

    fn plan(
        &mut self,
        symptom: CriticalSymptom,
        knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<CriticalDecision>, Failure> {
        Ok(Some(match symptom {
            CriticalSymptom::Broken { trouble, kind, .. } => CriticalDecision::CallForHelp { trouble, kind },
            CriticalSymptom::NeedsHelp { situation, .. } => match situation.job() {
                None => CriticalDecision::Offer(situation),
                Some(job) => match knowledge.means(&job) {
                    Means::Enough => CriticalDecision::Offer(situation),
                    Means::Needs(needs) => CriticalDecision::Postpone { critical: situation.critical, needs },
                    Means::Never => CriticalDecision::Refuse(situation),
                },
            },
            CriticalSymptom::InVain(situation) => CriticalDecision::Refuse(situation),
            CriticalSymptom::Alone(situation) => CriticalDecision::Heal(situation),
            CriticalSymptom::Beaten { situation, .. } => CriticalDecision::Release(situation),
            CriticalSymptom::Gone => CriticalDecision::Forget,
            CriticalSymptom::Awaked { emulates } => CriticalDecision::StandIn { critical: emulates },
            CriticalSymptom::Charges { .. } => CriticalDecision::AskForSubstitute,
            CriticalSymptom::Missing { robot, sleeper, .. } => CriticalDecision::Awake { sleeper, robot },
            CriticalSymptom::Substituted { robot, .. } => CriticalDecision::Rest { robot },
        }))
    }

    fn execute(
        &mut self,
        decision: CriticalDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision {
            CriticalDecision::CallForHelp { trouble, kind } => {
                return self.call_for_help(knowledge, context, trouble, kind);
            }
            CriticalDecision::Offer(situation) => {
                knowledge.lists.helps.claim(situation.critical);
                knowledge.offers_help = true;
                self.was_healer = std::mem::replace(&mut knowledge.variables.healer, true);
                knowledge.variables.busy = true;
                (self.said_at, self.said) = (knowledge.block, context.cause());
                self.respond(knowledge, context, situation, CriticalStage::Intention)?;
            }
            CriticalDecision::Postpone { critical, needs } => {
                knowledge.lists.helps.postpone(critical, needs);
            }
            CriticalDecision::Refuse(situation) => {
                knowledge.lists.helps.refuse(situation.critical);
                if let Some(job) = situation.job() {
                    let refused = job.response(knowledge.number, knowledge.block, LuggageStage::Refused);
                    context.send(&self.luggage, refused)?;
                }
            }
            CriticalDecision::Heal(situation) => self.heal(knowledge, context, situation)?,
            CriticalDecision::Release(situation) => {
                knowledge.lists.helps.put_back();
                knowledge.end_offer(self.was_healer);
                self.respond(knowledge, context, situation, CriticalStage::Release)?;
            }
            CriticalDecision::Forget => knowledge.end_offer(self.was_healer),
            CriticalDecision::StandIn { critical } => {
                knowledge.stands_in_for = None;
                let (kind, block) = (CriticalKind::Idle, knowledge.block);
                let situation = CriticalSituation { critical, kind, block, ..CriticalSituation::default() };
                self.respond(knowledge, context, situation, CriticalStage::StandsIn)?;
            }
            CriticalDecision::AskForSubstitute => {
                self.substitution = Some(Substitution::of(knowledge.number));
                self.missing = context.cause();
                context.send(&self.situations, knowledge.situation(CriticalKind::Idle))?;
            }
            CriticalDecision::Awake { sleeper, robot } => {
                if let Some(substitution) = &mut self.substitution {
                    substitution.ask(sleeper);
                }
                context.info(format_args!("awakes robot {sleeper} in place of robot {robot}"));
                self.awake(context, sleeper, robot)?;
            }
            CriticalDecision::Rest { robot } => {
                self.substitution = None;
                knowledge.relieved |= robot == knowledge.number;
            }
        }
        Ok(())
    }

    fn shutdown(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        // Somebody has to take over what is not done.
        if knowledge.job.is_some() && !knowledge.variables.critical {
            context.send(&self.situations, knowledge.situation(knowledge.critical_kind()))?;
        }
        Ok(())
    }
}

impl CriticalSituationMS {
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

    /// Awakes a robot in place of another one.
    fn awake(&self, context: &mut Context<'_>, robot: u32, emulate: u32) -> Result<(), Failure> {
        context.send(&self.states, RobotState { robot, awake: true, emulate })
    }

    /// How the robot stands that this one would help; `None` while it waits for others to leave it.
    fn look_at_claimed(&self, knowledge: &RobotKnowledge) -> Option<CriticalSymptom> {
        let Some(request) = knowledge.lists.helps.claimed() else { return Some(CriticalSymptom::Gone) };
        let situation = request.situation.clone();
        if situation.kind != CriticalKind::Idle && knowledge.energy.must_charge() {
            return Some(CriticalSymptom::Beaten { situation, by: None });
        }
        let by = closer_rival(request, self.said_at, knowledge.number);
        if by.is_some() {
            return Some(CriticalSymptom::Beaten { situation, by });
        }
        request.rivals.is_empty().then_some(CriticalSymptom::Alone(situation))
    }

    /// A request that waits in vain for this robot, and what caused it.
    fn look_at_idleness(
        &mut self,
        knowledge: &RobotKnowledge,
        context: &Context<'_>,
    ) -> Option<(CriticalSituation, Cause)> {
        let oldest = knowledge.lists.helps.open().iter().find(|help| help.situation.job().is_some());
        self.idle.note(oldest.is_some() && knowledge.job.is_none());
        let oldest = oldest.filter(|help| self.idle.is_in_vain(help.since, context))?;
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
            knowledge.job = Some(job);
            (knowledge.variables.busy, knowledge.variables.healer) = (true, true);
            knowledge.set_out(&job);
            let luggage = job.luggage;
            context.info(format_args!("takes over luggage {luggage} from robot {critical}"));
        }
        self.substitution = Some(Substitution::of(critical));
        self.missing = context.cause();
        self.respond(knowledge, context, situation, CriticalStage::Taken)
    }

    /// Says what is open, and shuts down. Where the hardware cannot be reached, it is tried again in the next execution.
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
        context.log(Level::Error, format_args!("{what} at {block} {doing}: needs assistance"));
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

/// The oldest request that this robot can answer, and what caused it.
fn look_for_help_requests(knowledge: &mut RobotKnowledge) -> Option<(CriticalSymptom, Cause)> {
    if knowledge.lists.helps.open().is_empty() {
        return None;
    }
    let free = knowledge.is_free()
        && !knowledge.energy.must_charge()
        && !knowledge.relieved
        && knowledge.hooks.running().is_none();
    if free {
        knowledge.keep_usual_reserve();
    }
    let (left, emulates) = (knowledge.battery.executions_left(), knowledge.stands_in_for);
    let can = |request: &&Help| {
        let idle = request.situation.kind == CriticalKind::Idle;
        let means = if idle { knowledge.lists.sleepers().next().is_some() } else { free };
        means
            && request.needs <= left
            && knowledge.is_to_be_helped(request)
            && closer_rival(request, knowledge.block, knowledge.number).is_none()
    };
    let requests = knowledge.lists.helps.open().iter().filter(can);
    // Who was awaked for a robot helps that one first.
    let request = requests.min_by_key(|request| emulates != Some(request.situation.critical))?;
    let (situation, cause) = (request.situation.clone(), request.cause);
    let distance = knowledge.block.distance(start(&situation));
    Some((CriticalSymptom::NeedsHelp { situation, distance }, cause))
}

/// A request with a job that is out of this robot's reach: others may have to know that nobody can do it, also where this one takes none now.
fn look_for_hopeless_requests(knowledge: &mut RobotKnowledge) -> Option<(CriticalSymptom, Cause)> {
    let open = knowledge.lists.helps.open().len();
    (0..open).find_map(|place| {
        let request = knowledge.lists.helps.open().get(place)?;
        let (situation, cause) = (request.situation.clone(), request.cause);
        if knowledge.means(&situation.job()?) != Means::Never {
            return None;
        }
        let distance = knowledge.block.distance(start(&situation));
        Some((CriticalSymptom::NeedsHelp { situation, distance }, cause))
    })
}

/// A robot that would help and is closer; at the same distance the lower number is.
fn closer_rival(request: &Help, block: Block, number: u32) -> Option<u32> {
    let start = start(&request.situation);
    let mine = (block.distance(start), number);
    let closer = |rival: &&Rival| (rival.block.distance(start), rival.robot) < mine;
    request.rivals.iter().find(closer).map(|rival| rival.robot)
}

/// Where the help begins.
fn start(situation: &CriticalSituation) -> Block {
    situation.job().map_or(situation.block, |job| job.from)
}

impl RobotKnowledge {
    /// Whether a request is open: its robot is broken. Robots that only charge find their substitutes themselves.
    pub(super) fn is_to_be_helped(&self, request: &Help) -> bool {
        let CriticalSituation { kind, critical, .. } = request.situation;
        kind != CriticalKind::Idle || !self.lists.is_active(critical)
    }

    fn needs_help(&self, critical: u32) -> bool {
        self.lists.helps.get(critical).is_some_and(|request| self.is_to_be_helped(request))
    }

    /// Would not help any more, or does it now.
    fn end_offer(&mut self, was_healer: bool) {
        self.offers_help = false;
        self.stands_in_for = None;
        self.variables.busy = self.job.is_some();
        self.variables.healer = was_healer;
    }
}
