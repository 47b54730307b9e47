use std::cmp::Reverse;

use saoms_api::{
    Cause, Context, Failure, Loop, LoopClass, Publisher, Record, Recordable, Saved, Subscription, info, record,
};

use crate::messages::{
    CRITICAL_SITUATION, CriticalKind, CriticalSituation, CriticalStage, EVENT_LUGGAGE, EventLuggage, FAULT, Fault,
    LuggageStage, POSITION, Position, ROBOT_LIST, ROBOT_STATE, RobotList, RobotState,
};
use crate::robot::memory::lasting::lasting;
use crate::robot::{ASSISTANCE, Help, RobotKnowledge, Trouble};

/// Asks for help when the robot cannot go on, and heals other robots (listings 6.7 to 6.10).
///
/// A robot that can heal another one offers that. In its next execution it knows the others' offers: the closest robot
/// takes over the job of the broken robot and wakes a substitute for itself.
#[derive(Debug, Default, LoopClass)]
#[looping(
    name = "saoms.classic.CriticalSituationMS",
    knowledge = RobotKnowledge,
    senses(
        "battery", "block", "transporter", "readyToGoUnderCharge", "hasLuggage", "standsInFor", "robots", "helpRequests"
    ),
    effects("critical", "healer", "busy", "transporter", "job", "inCharge", "asleep", "standsInFor")
)]
pub struct ClassicCriticalSituation {
    #[subscribes(FAULT)]
    faults: Subscription<Fault>,
    #[publishes(CRITICAL_SITUATION)]
    situations: Publisher<CriticalSituation>,
    #[subscribes(CRITICAL_SITUATION)]
    situations_heard: Subscription<CriticalSituation>,
    #[publishes(ROBOT_STATE)]
    states: Publisher<RobotState>,
    #[publishes(ROBOT_LIST)]
    robots: Publisher<RobotList>,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[publishes(POSITION)]
    positions: Publisher<Position>,
    /// Cause of the robot's breakdown.
    cause: Cause,
    /// Cause of the robot's last offer; its next decision about that robot follows from it.
    said: Cause,
}

/// Critical situations that a robot can react to.
#[derive(Clone, Copy, Debug)]
pub enum ClassicCriticalSymptom {
    /// This robot cannot continue.
    Broken(CriticalKind),
    /// Another robot, or this one, waits for a healer.
    NeedsHelp(u32),
    /// The robot offered to heal that one, and no other robot is closer.
    Closest(u32),
    /// Another robot is closer, or heals it.
    Beaten,
}

/// Reaction to a critical situation.
#[derive(Clone, Copy, Debug)]
pub enum ClassicCriticalDecision {
    /// Ask for help, and shut down.
    AskForHelp(CriticalKind),
    /// Offer to heal that robot.
    Intend(u32),
    /// Heal that robot.
    Heal(u32),
    /// Become free again.
    Forget,
}

impl Recordable for ClassicCriticalSymptom {
    fn record(&self) -> Record {
        match *self {
            ClassicCriticalSymptom::Broken(CriticalKind::CarriesLuggage) => {
                record!(breaks_down_while_carrying: "breaks down while carrying luggage")
            }
            ClassicCriticalSymptom::Broken(CriticalKind::OnTheWay) => {
                record!(breaks_down_while_fetching: "breaks down while fetching luggage")
            }
            ClassicCriticalSymptom::Broken(CriticalKind::Idle) => {
                record!(breaks_down_while_idle: "breaks down while idle")
            }
            ClassicCriticalSymptom::NeedsHelp(robot) => record!(robot_needs_help: "robot {robot} needs help", robot),
            ClassicCriticalSymptom::Closest(robot) => {
                record!(closest_to_robot: "no other robot that offers to help robot {robot} is closer", robot)
            }
            ClassicCriticalSymptom::Beaten => {
                record!(other_robot_closer_to_robot: "another robot is closer to the one that needs help")
            }
        }
    }
}

impl Recordable for ClassicCriticalDecision {
    fn record(&self) -> Record {
        match *self {
            ClassicCriticalDecision::AskForHelp(_) => record!(asks_for_help: "asks for help and shuts down"),
            ClassicCriticalDecision::Intend(robot) => record!(offers_help: "offers to help robot {robot}", robot),
            ClassicCriticalDecision::Heal(robot) => record!(helps_robot: "helps robot {robot}", robot),
            ClassicCriticalDecision::Forget => record!(is_free: "is free again"),
        }
    }
}

lasting! {
    ClassicCriticalSituation as CriticalMemory { cause: Cause, said: Cause }
}

impl Loop for ClassicCriticalSituation {
    type Properties = ();
    type Knowledge = RobotKnowledge;
    type Symptom = ClassicCriticalSymptom;
    type Decision = ClassicCriticalDecision;

    fn monitor(&mut self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        for (header, situation) in context.receive(&self.situations_heard).with_headers() {
            if knowledge.accepts(situation, header, context) {
                knowledge.lists.helps.hear(situation, header);
            }
        }
        knowledge.lists.helps.drop_contested();
        for (header, fault) in context.receive(&self.faults).with_headers() {
            let is_mine = knowledge.accepts(fault, header, context) && fault.breaks(knowledge.number);
            if is_mine && !knowledge.variables.critical {
                knowledge.variables.critical = true;
                self.cause = header.cause;
            }
        }
        // Hardware that fails again and again, as it does before a blocked block, is a breakdown, too.
        if knowledge.trouble.is_some() && !knowledge.variables.critical {
            knowledge.variables.critical = true;
            self.cause = context.cause();
        }
        Ok(())
    }

    fn analyze(
        &mut self,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<Option<ClassicCriticalSymptom>, Failure> {
        let (variables, helps) = (&knowledge.variables, &knowledge.lists.helps);
        if variables.critical {
            context.because(self.cause);
            return Ok(Some(ClassicCriticalSymptom::Broken(knowledge.critical_kind())));
        }
        if variables.healer {
            context.because(self.said);
            let closest = helps.claimed().filter(|help| is_closest(knowledge, help));
            let symptom = closest.map(|help| ClassicCriticalSymptom::Closest(help.situation.critical));
            return Ok(symptom.or(Some(ClassicCriticalSymptom::Beaten)));
        }
        if variables.busy || variables.transporter || variables.ready_to_go_under_charge {
            return Ok(None);
        }
        let emulated = knowledge.stands_in_for.take();
        let emulated = helps.open().iter().find(|help| Some(help.situation.critical) == emulated);
        let Some(help) = emulated.or(helps.open().first()) else { return Ok(None) };
        context.because(help.cause);
        Ok(Some(ClassicCriticalSymptom::NeedsHelp(help.situation.critical)))
    }

    fn plan(
        &mut self,
        symptom: ClassicCriticalSymptom,
        _knowledge: &mut RobotKnowledge,
        _context: &mut Context<'_>,
    ) -> Result<Option<ClassicCriticalDecision>, Failure> {
        Ok(Some(match symptom {
            ClassicCriticalSymptom::Broken(kind) => ClassicCriticalDecision::AskForHelp(kind),
            ClassicCriticalSymptom::NeedsHelp(robot) => ClassicCriticalDecision::Intend(robot),
            ClassicCriticalSymptom::Closest(robot) => ClassicCriticalDecision::Heal(robot),
            ClassicCriticalSymptom::Beaten => ClassicCriticalDecision::Forget,
        }))
    }

    fn execute(
        &mut self,
        decision: ClassicCriticalDecision,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        match decision {
            ClassicCriticalDecision::AskForHelp(kind) => self.ask_for_help(kind, knowledge, context),
            ClassicCriticalDecision::Intend(robot) => self.intend(robot, knowledge, context),
            ClassicCriticalDecision::Heal(_) => self.heal(knowledge, context),
            ClassicCriticalDecision::Forget => {
                knowledge.lists.helps.settle();
                knowledge.variables.healer = false;
                // A charging robot is busy until its battery is full.
                knowledge.variables.busy = knowledge.variables.in_charge && !knowledge.battery.is_full();
                Ok(())
            }
        }
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.saved())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.go_on(saved)
    }
}

impl ClassicCriticalSituation {
    fn ask_for_help(
        &self,
        kind: CriticalKind,
        knowledge: &mut RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        knowledge.retire(context)?;
        context.send(&self.situations, knowledge.situation(kind))?;
        let block = knowledge.block;
        let what = knowledge.trouble.map_or("breaks down", Trouble::words);
        context.alert(ASSISTANCE, "", format_args!("{what} at {block}: asks for help, and for human assistance"));
        // The luggage that the robot was interested in waits again, for robots that dropped it because of that.
        if let Some(request) = knowledge.lists.requests.settle() {
            let job = request.job;
            let release = job.response(knowledge.number, knowledge.block, LuggageStage::Release);
            context.send(&self.luggage, release)?;
            context.send(&self.luggage, EventLuggage::request(job.luggage, job.from, job.to))?;
        }
        // So does the robot that it offered to heal.
        if let Some(help) = knowledge.lists.helps.settle() {
            context.send(&self.situations, help.situation)?;
        }
        let block = knowledge.block;
        context.send(&self.positions, Position { next: block, wanted: block, ..knowledge.position() })?;
        context.send(&self.robots, knowledge.robot(false))?;
        knowledge.shut_down = true;
        Ok(())
    }

    fn intend(&mut self, robot: u32, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let helps = &mut knowledge.lists.helps;
        let Some(situation) = helps.get(robot).map(|help| help.situation.clone()) else { return Ok(()) };
        helps.claim(&situation);
        (knowledge.variables.healer, knowledge.variables.busy) = (true, true);
        self.said = context.cause();
        context.console(format_args!("Robot{} is a new healer for Robot{robot}", knowledge.number));
        self.respond(situation, CriticalStage::Intention, knowledge, context)
    }

    fn heal(&self, knowledge: &mut RobotKnowledge, context: &mut Context<'_>) -> Result<(), Failure> {
        let Some(Help { situation, .. }) = knowledge.lists.helps.settle() else { return Ok(()) };
        let critical = situation.critical;
        let (job, name) = (situation.job(), &knowledge.name);
        let variables = &mut knowledge.variables;
        let asleep = std::mem::take(&mut variables.in_charge);
        variables.asleep = false;
        (variables.healer, variables.busy, variables.transporter) = (false, job.is_some(), job.is_some());
        knowledge.job = job;
        if asleep {
            context.console(format_args!("{name} is a healer and now is awake"));
        } else {
            context.console(format_args!("{name} is a healer and awakes another robot"));
            if let Some(robot) = best_charged(knowledge, critical) {
                let state = RobotState { robot, awake: true, emulate: critical };
                context.effect(record!(wakes_robot: "wakes robot {robot}", robot));
                context.send(&self.states, state)?;
            } else {
                context.effect(record!(no_robot_to_wake: "finds no robot to wake"));
            }
        }
        match job {
            Some(job) => {
                info!(context, "helps robot {critical}: takes luggage {} from {} to {}", job.luggage, job.from, job.to)
            }
            None => info!(context, "helps robot {critical}"),
        }
        self.respond(situation, CriticalStage::Taken, knowledge, context)
    }

    fn respond(
        &self,
        situation: CriticalSituation,
        stage: CriticalStage,
        knowledge: &RobotKnowledge,
        context: &mut Context<'_>,
    ) -> Result<(), Failure> {
        let (healer, healer_block) = (knowledge.number, knowledge.block);
        context.send(&self.situations, CriticalSituation { stage, healer, healer_block, ..situation })
    }
}

/// True if the robot is the closest by straight-line distance; of equally close robots the one with the lowest number
/// is.
fn is_closest(knowledge: &RobotKnowledge, help: &Help) -> bool {
    let to = help.situation.block;
    let mine = (knowledge.block.straight_squared(to), knowledge.number);
    help.rivals.iter().all(|rival| mine < (rival.block.straight_squared(to), rival.robot))
}

/// The sleeping robot with the highest battery level, of equal ones the one with the lowest number, without the robot
/// that needs help.
fn best_charged(knowledge: &RobotKnowledge, critical: u32) -> Option<u32> {
    let others = knowledge.lists.active.iter().filter(|other| other.can_be_woken() && other.robot != critical);
    let best = others
        .max_by(|one, other| one.battery.total_cmp(&other.battery).then(Reverse(one.robot).cmp(&Reverse(other.robot))));
    best.map(|robot| robot.robot)
}
