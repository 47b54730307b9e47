mod leases;
mod requests;

use std::collections::VecDeque;

use saoms_api::{
    Cause, Class, Component, Context, Failure, Header, Loops, Message, Properties, Publisher, ReportValue, Saved,
    SavedLoops, Subscription, Time, Work, info, record,
};

use super::assignment::{AssignmentPolicy, Crew, MasterAssignment, MasterEnvironmentKnowledge};
use super::event_filter::EventFilter;
use super::open_luggage::{OpenLuggage, OpenMemory};
use super::part::{Early, Part};
use super::unanswered::Unanswered;
use crate::console::Timestamp;
use crate::hardware::Area;
use crate::messages::{
    AREA, ASSIGNMENT, Assignment, CRITICAL_SITUATION, CriticalSituation, ENVIRONMENT, EVENT_LUGGAGE, EXCEPTIONAL_EVENT,
    EnvironmentEvent, EventLuggage, ExceptionalEvent, FAULT, FIRST_VISIT, Fault, FaultKind, LEASE, Lease, LuggageStage,
    POSITION, Position, REMOVAL, REMOVAL_ASKED, ROBOT_LIST, Removal, RobotList, TERRITORY, VISIT, Visit, is_visit,
    job_name,
};
use crate::report::pieces;
use crate::state::Numbers;
use crate::validation::{Problem, SpeakerMemory};
use requests::MAX_REQUESTS;

/// The kind of alerts about luggage that no robot can carry.
const GIVEN_UP: &str = "given_up";

/// Properties of the master of the environment.
#[derive(Clone, Debug, Properties)]
pub struct MasterEnvironmentProperties {
    /// Who decides which robot brings which luggage: `robots`, which declare their interest and take what they are the
    /// closest to; or the master, `oldest` luggage first to the closest robot, or `optimal`, with the least total way.
    #[property(default = "robots")]
    pub(crate) assignment: AssignmentPolicy,
    /// Number of a zone: the master assigns the luggage alone that is collected there, and knows the robots around
    /// alone. Each zone of the site has such a master then; that of zone 1 also passes on landings, take-offs and
    /// faults.
    #[property(range = 1..)]
    pub(crate) zone: Option<u32>,
}

/// Distributes the events of the environment to their topics: luggage and faults to the robots, exceptional events to
/// the master of the robots.
///
/// Any component may publish on the environment's topic. Impossible events, such as luggage outside the area of the
/// world, are reported with their sender, counted, and dropped. Luggage that all robots refuse, or for which no robot
/// is left, is reported as given up. A robot that starts later gets the requests that still wait. The luggage of a
/// robot that somebody took off the floor waits again. With `zone`, several masters divide the luggage of a site.
#[derive(Debug, Class)]
#[class(
    name = "saoms.MasterEnvironment",
    periodic,
    saves,
    knowledge = MasterEnvironmentKnowledge,
    loops(MasterAssignment),
    subscribes(POSITION, TERRITORY),
    also("unibg.saoms.MasterEnvironmentManagingSystem")
)]
pub struct MasterEnvironment {
    knowledge: MasterEnvironmentKnowledge,
    loops: Loops,
    /// Requests that are not published yet.
    requests: VecDeque<(Cause, EventLuggage)>,
    /// Number of those that are published in this execution.
    requested: usize,
    #[subscribes(ENVIRONMENT)]
    events: Subscription<EnvironmentEvent>,
    #[subscribes(VISIT)]
    visits_asked: Subscription<Visit>,
    #[publishes(VISIT)]
    visits: Publisher<Visit>,
    #[subscribes(AREA)]
    area: Subscription<Area>,
    #[subscribes(EVENT_LUGGAGE)]
    responses: Subscription<EventLuggage>,
    #[subscribes(ROBOT_LIST)]
    robots: Subscription<RobotList>,
    #[subscribes(CRITICAL_SITUATION)]
    situations_heard: Subscription<CriticalSituation>,
    #[subscribes(REMOVAL)]
    removals: Subscription<Removal>,
    #[publishes(REMOVAL_ASKED)]
    removals_asked: Publisher<Fault>,
    unanswered: Unanswered,
    #[subscribes(LEASE)]
    leases: Subscription<Lease>,
    /// Time of the last execution.
    executed_at: Option<Time>,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[publishes(CRITICAL_SITUATION)]
    situations: Publisher<CriticalSituation>,
    #[publishes(EXCEPTIONAL_EVENT)]
    exceptional: Publisher<ExceptionalEvent>,
    #[publishes(FAULT)]
    faults: Publisher<Fault>,
    #[publishes(ASSIGNMENT)]
    assignments: Publisher<Assignment>,
    /// Where robots are, if the master assigns luggage by that.
    positions: Option<Subscription<Position>>,
}

/// State of a master, for the one that takes its place after a failure.
#[derive(Clone, Debug, Message)]
struct MasterMemory {
    speakers: SpeakerMemory,
    known: Numbers,
    heard: Numbers,
    open: OpenMemory,
    requests: Vec<EventLuggage>,
    loops: SavedLoops,
}

impl Component for MasterEnvironment {
    type Properties = MasterEnvironmentProperties;

    fn new(properties: MasterEnvironmentProperties) -> Result<Self, Failure> {
        let mut knowledge = MasterEnvironmentKnowledge::new(properties.assignment);
        knowledge.part = properties.zone.map(Part::of);
        Ok(MasterEnvironment {
            knowledge,
            loops: Loops::default(),
            requests: VecDeque::new(),
            requested: 0,
            events: Subscription::default(),
            visits_asked: Subscription::default(),
            visits: Publisher::default(),
            area: Subscription::default(),
            responses: Subscription::default(),
            robots: Subscription::default(),
            situations_heard: Subscription::default(),
            removals: Subscription::default(),
            removals_asked: Publisher::default(),
            unanswered: Unanswered::default(),
            leases: Subscription::default(),
            executed_at: None,
            luggage: Publisher::default(),
            situations: Publisher::default(),
            exceptional: Publisher::default(),
            faults: Publisher::default(),
            assignments: Publisher::default(),
            positions: None,
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.count("luggage.requested", 0);
        context.count("luggage.ignored", 0);
        let now = Timestamp::now(context);
        context.console(format_args!("MasterEnvironmentManagingSystem starts at {now}"));
        if self.knowledge.policy != AssignmentPolicy::Robots {
            self.positions = Some(context.subscribe(&POSITION)?);
        }
        if let Some(part) = &mut self.knowledge.part {
            part.initialize(context)?;
            self.knowledge.validator.hear_a_part();
        }
        self.loops = context.loops()?;
        self.loops.initialize(&mut self.knowledge, context)
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.requested = 0;
        for _ in 0..self.requests.len().min(MAX_REQUESTS) {
            let Some((cause, request)) = self.requests.pop_front() else { break };
            context.because(cause);
            self.request(request, context)?;
        }
        context.because(Cause::default());
        for (header, area) in context.receive(&self.area).with_headers() {
            if self.knowledge.validator.accepts(area, header, None, context) {
                self.knowledge.filter.learn(area.clone().into());
            }
        }
        // Robots that have started again since say so below.
        for (header, event) in context.receive(&self.events).with_headers() {
            for fault in event.faults.iter().filter(|fault| fault.is_failure()) {
                self.note_failure(fault, header, context);
            }
        }
        for departed in context.departed(&self.robots) {
            if let Ok(robot) = u32::try_from(departed.key) {
                self.knowledge.crew.lose(robot);
                self.knowledge.validator.forget_speaker(robot);
            }
        }
        let mut started = Vec::new();
        for (header, robot) in context.receive(&self.robots).with_headers() {
            if self.knowledge.accepts(robot, header, context) && self.knowledge.hear_robot(robot, header) {
                started.push((header.cause, robot.robot, robot.began));
            }
        }
        for (header, early) in self.knowledge.part.as_mut().map_or_else(Vec::new, |part| part.learn(context)) {
            context.because(header.cause);
            match early {
                Early::Luggage(request) => self.admit(context, header, &request)?,
                Early::Visit(visit) => self.ask_to_visit(context, header, &visit)?,
            }
        }
        let now = Timestamp::now(context);
        for (header, event) in context.receive(&self.events).with_headers() {
            context.because(header.cause);
            self.sort(context, header, event)?;
            context.console(format_args!("MasterEnvironmentManagingSystem: new event received and managed at {now}"));
        }
        for (header, visit) in context.receive(&self.visits_asked).with_headers() {
            context.because(header.cause);
            self.ask_to_visit(context, header, visit)?;
        }
        context.because(Cause::default());
        for (header, said) in context.receive(&self.responses).with_headers() {
            self.hear(context, header, said);
        }
        for (header, situation) in context.receive(&self.situations_heard).with_headers() {
            let is_own = header.sender == context.sender();
            if !is_own && self.knowledge.accepts(situation, header, context) {
                self.knowledge.hear_situation(situation, header.sent);
            }
        }
        for (header, removal) in context.receive(&self.removals).with_headers() {
            if self.knowledge.accepts(removal, header, context) {
                self.hear_removal(removal, header, context)?;
            }
        }
        self.hear_leases(context)?;
        self.open_again(context)?;
        for fault in self.unanswered.due(&self.knowledge, context) {
            context.send(&self.removals_asked, fault)?;
        }
        for request in self.knowledge.open.ask_again() {
            self.request(request, context)?;
        }
        for request in self.knowledge.open.visit_again() {
            let visit = request.luggage - FIRST_VISIT;
            info!(context, "visit {visit} waits again: its robot left it");
            self.request(request, context)?;
        }
        for (cause, robot, began) in started {
            context.because(cause);
            for visit in self.knowledge.open.taken_before(robot, began) {
                context.send(&self.visits, visit)?;
            }
            self.repeat_for(robot, context)?;
        }
        context.because(Cause::default());
        for (luggage, from, to) in self.knowledge.take_hopeless(context.now()) {
            let (what, does) = (job_name(luggage), if is_visit(luggage) { "do" } else { "carry" });
            let line = format_args!("gives up {what} from {from} to {to}: no robot can {does} it");
            context.alert(GIVEN_UP, luggage, line);
            context.vote(Work::GivenUp);
            context.send(&self.luggage, EventLuggage::given_up(luggage, from, to))?;
        }
        self.assign(context)
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.loops.shutdown(&mut self.knowledge, context)
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&MasterMemory {
            speakers: self.knowledge.validator.memory(),
            known: self.knowledge.filter.known().clone(),
            heard: self.knowledge.filter.heard().clone(),
            open: self.knowledge.open.memory(),
            requests: self.requests.iter().map(|(_, request)| request.clone()).collect(),
            loops: self.loops.save(&self.knowledge)?,
        }))
    }

    /// Goes on from a saved state; the area comes again from its topic.
    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let Some(memory) = saved.read::<MasterMemory>()? else { return Ok(()) };
        self.knowledge.validator.restore(memory.speakers);
        self.knowledge.filter = EventFilter::of(memory.known, memory.heard);
        self.knowledge.open = OpenLuggage::of(memory.open);
        self.knowledge.crew = Crew::with_jobs(self.knowledge.open.jobs(), self.knowledge.open.asked());
        self.requests = memory.requests.into_iter().map(|request| (Cause::default(), request)).collect();
        self.loops.restore(&mut self.knowledge, &memory.loops)
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        self.knowledge.open.status()
    }

    fn waits_for(&self) -> Option<String> {
        if let Some(robot) = self.unanswered.first() {
            return Some(format!("the world to say what robot {robot} left, and where"));
        }
        Some(match self.knowledge.open.first() {
            None => "events".to_owned(),
            Some((first, more)) if is_visit(first) => format!("a robot to do {}", pieces(first, more)),
            Some((first, more)) => format!("a robot to carry {}", pieces(first, more)),
        })
    }
}

impl MasterEnvironment {
    fn sort(&mut self, context: &mut Context<'_>, header: Header, event: &EnvironmentEvent) -> Result<(), Failure> {
        for request in &event.luggage {
            self.admit(context, header, request)?;
        }
        let is_alone = self.knowledge.speaks_for_all();
        for exceptional in event.exceptional.iter().filter(|_| is_alone) {
            context.send(&self.exceptional, exceptional.clone())?;
        }
        for fault in event.faults.iter().filter(|fault| !fault.is_failure()) {
            let MasterEnvironmentKnowledge { validator, filter, .. } = &mut self.knowledge;
            if let Err(problem) = validator.judge(fault, header, filter.area(), context) {
                context.count("faults.ignored", i64::from(is_alone));
                self.knowledge.validator.log_rejection(context, header, fault, problem);
            } else {
                match fault.kind {
                    FaultKind::Breakdown => {
                        context.count("faults.applied.breakdown", i64::from(is_alone));
                        self.knowledge.open.break_down(fault.robot, context.now());
                        self.knowledge.crew.remove(fault.robot);
                    }
                    FaultKind::Gone => {
                        context.count("faults.applied.gone", i64::from(is_alone));
                        let header = Header { sent: context.due(), ..header };
                        self.knowledge.take_away(fault, header);
                    }
                    FaultKind::Failed | FaultKind::Restarting => {}
                }
                if is_alone {
                    context.send(&self.faults, fault.clone())?;
                }
            }
        }
        Ok(())
    }

    /// The component of a robot failed. One that nobody has heard of has nothing to take over.
    fn note_failure(&mut self, fault: &Fault, header: Header, context: &Context<'_>) {
        let MasterEnvironmentKnowledge { validator, filter, .. } = &mut self.knowledge;
        if validator.judge(fault, header, filter.area(), context).is_ok() {
            self.knowledge.take_away(fault, header);
        }
    }

    /// The world says what a robot left that is out. A master that began since has not heard that it is.
    fn hear_removal(&mut self, removal: &Removal, header: Header, context: &mut Context<'_>) -> Result<(), Failure> {
        if let Some(fault) = self.knowledge.open.missed(removal) {
            self.knowledge.take_away(&fault, header);
            if fault.kind == FaultKind::Gone && self.knowledge.speaks_for_all() {
                context.send(&self.faults, fault)?;
            }
        }
        self.knowledge.open.hear_removal(removal);
        Ok(())
    }

    /// Tells the robots of those that failed, and requests the luggage of robots that are out again.
    fn open_again(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let has_world = self.knowledge.filter.area().is_some();
        let is_alone = self.knowledge.speaks_for_all();
        for fault in self.knowledge.open.untold(has_world).into_iter().filter(|_| is_alone) {
            context.send(&self.faults, fault)?;
        }
        for (robot, request) in self.knowledge.open.open_again(has_world) {
            let (luggage, from) = (request.luggage, request.from);
            let record = match self.knowledge.open.is_off_floor(robot) {
                true => record!(
                    opens_luggage_again: "luggage {luggage} waits again at {from}: robot {robot} is gone",
                    luggage,
                    from,
                    robot
                ),
                false => record!(
                    opens_luggage_of_failed: "luggage {luggage} waits again at {from}: robot {robot} has failed",
                    luggage,
                    from,
                    robot
                ),
            };
            info!(context, "{record}");
            context.effect(record);
            self.request(request, context)?;
        }
        self.knowledge.open.forget_failures();
        Ok(())
    }

    /// Lets the loops assign what waits.
    fn assign(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = context.now();
        let heard = self.positions.map(|positions| context.receive(&positions).with_headers());
        for (header, position) in heard.into_iter().flatten() {
            if self.knowledge.accepts(position, header, context) {
                self.knowledge.hear_position(position, now);
            }
        }
        self.knowledge.expire(now);
        if let Some(positions) = &self.positions {
            self.knowledge.look_around((positions, &self.robots), context)?;
        }
        self.loops.monitor(&mut self.knowledge, context)?;
        self.loops.adapt(&mut self.knowledge, context)?;
        for agreed in std::mem::take(&mut self.knowledge.agreed) {
            context.send(&self.assignments, agreed)?;
        }
        for assignment in std::mem::take(&mut self.knowledge.assignments) {
            self.knowledge.note_assigned(&assignment, now);
            context.send(&self.assignments, assignment)?;
        }
        Ok(())
    }

    /// Repeats what waits, for a robot that has just started.
    fn repeat_for(&mut self, robot: u32, context: &mut Context<'_>) -> Result<(), Failure> {
        let (luggage, helps) = self.knowledge.open.waiting_for(robot);
        // On a large map it hears of little luggage, and the master assigns what nobody takes.
        let is_large = self.knowledge.is_large();
        for request in luggage.into_iter().filter(|request| !is_large || is_visit(request.luggage)) {
            if let Some(visit) = self.knowledge.open.visit(request.luggage) {
                context.send(&self.visits, visit)?;
            }
            self.request(request.again_for(robot), context)?;
        }
        for situation in helps {
            context.send(&self.situations, situation.again_for(robot))?;
        }
        // Topics keep what robots that are gone said before.
        let gone: Vec<u32> = self.knowledge.open.gone().filter(|gone| *gone != robot).collect();
        for gone in gone {
            context.send(&self.faults, self.knowledge.open.gone_since(gone))?;
        }
        if self.knowledge.part.is_some() {
            // Who comes from elsewhere was told, and those that failed may be back there.
            return Ok(());
        }
        let failures: Vec<Fault> = self.knowledge.open.failures(robot).cloned().collect();
        failures.into_iter().try_for_each(|fault| context.send(&self.faults, fault))
    }

    /// Handles a message about luggage from a robot, or from another component on the robots' topic.
    fn hear(&mut self, context: &mut Context<'_>, header: Header, said: &EventLuggage) {
        if header.sender == context.sender() {
            return;
        }
        if !self.knowledge.is_own(said.luggage) {
            return self.knowledge.hear_elsewhere(said, header, context);
        }
        if !self.knowledge.accepts(said, header, context) {
            return;
        }
        if said.stage == LuggageStage::Delivered {
            context.alert_over(GIVEN_UP, said.luggage);
        }
        if said.stage == LuggageStage::Request {
            self.knowledge.filter.hear(said.luggage);
            self.knowledge.hear_response(said, header.sent, context.now());
        } else if self.knowledge.filter.knows(said.luggage) {
            if matches!(said.stage, LuggageStage::Delivered | LuggageStage::GivenUp) {
                self.knowledge.filter.note(said.luggage);
            }
            self.knowledge.hear_response(said, header.sent, context.now());
        } else {
            context.count("messages.ignored", 1);
            self.knowledge.validator.log_rejection(context, header, said, Problem::UnknownLuggage);
        }
    }
}
