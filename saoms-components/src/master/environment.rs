use saoms_api::{
    Cause, Class, Component, Context, Failure, Header, Message, Publisher, ReportValue, Saved, Subscription, Work,
    info, record,
};

use super::event_filter::EventFilter;
use super::open_luggage::{OpenLuggage, OpenMemory};
use crate::console::Timestamp;
use crate::hardware::Area;
use crate::messages::{
    AREA, CRITICAL_SITUATION, CriticalSituation, ENVIRONMENT, EVENT_LUGGAGE, EXCEPTIONAL_EVENT, EnvironmentEvent,
    EventLuggage, ExceptionalEvent, FAULT, FIRST_VISIT, Fault, FaultKind, LuggageStage, REMOVAL, ROBOT_LIST, Removal,
    RobotList, VISIT, Visit,
};
use crate::report::pieces;
use crate::state::Numbers;
use crate::validation::{MessageValidator, Problem, SpeakerMemory, Validate};

/// The kind of alerts about luggage that no robot can carry.
const GIVEN_UP: &str = "given_up";

/// Distributes the events of the environment to their topics: luggage and faults to the robots, exceptional events to
/// the master of the robots.
///
/// Any component may publish on the environment's topic. Impossible events, such as luggage outside the area of the
/// world, are reported with their sender, counted, and dropped. Luggage that all robots refuse, or for which no robot
/// is left, is reported as given up. A robot that starts later gets the requests that still wait. The luggage of a
/// robot that somebody took off the floor waits again.
#[derive(Debug, Class)]
#[class(name = "saoms.MasterEnvironment", periodic, saves, also("unibg.saoms.MasterEnvironmentManagingSystem"))]
pub struct MasterEnvironment {
    validator: MessageValidator,
    filter: EventFilter,
    open: OpenLuggage,
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
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[publishes(CRITICAL_SITUATION)]
    situations: Publisher<CriticalSituation>,
    #[publishes(EXCEPTIONAL_EVENT)]
    exceptional: Publisher<ExceptionalEvent>,
    #[publishes(FAULT)]
    faults: Publisher<Fault>,
}

/// State of a master, for the one that takes its place after a failure.
#[derive(Clone, Debug, Message)]
struct MasterMemory {
    speakers: SpeakerMemory,
    known: Numbers,
    open: OpenMemory,
}

impl Component for MasterEnvironment {
    type Properties = ();

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.count("luggage.requested", 0);
        context.count("luggage.ignored", 0);
        let now = Timestamp::now(context);
        context.console(format_args!("MasterEnvironmentManagingSystem starts at {now}"));
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for (header, area) in context.receive(&self.area).with_headers() {
            if self.validator.accepts(area, header, None, context) {
                self.filter.learn(area.clone().into());
            }
        }
        let mut started = Vec::new();
        for (header, robot) in context.receive(&self.robots).with_headers() {
            if self.validator.accepts(robot, header, self.filter.area(), context) && self.open.hear_robot(robot, header)
            {
                started.push((header.cause, robot.robot));
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
            if !is_own && self.validator.accepts(situation, header, self.filter.area(), context) {
                self.open.hear_situation(situation);
            }
        }
        for (header, removal) in context.receive(&self.removals).with_headers() {
            if self.validator.accepts(removal, header, self.filter.area(), context) {
                self.open.hear_removal(removal);
            }
        }
        for (robot, request) in self.open.open_again(self.filter.area().is_some()) {
            let (luggage, from) = (request.luggage, request.from);
            context.effect(record!(
                opens_luggage_again: "luggage {luggage} waits again at {from}: robot {robot} is gone",
                luggage,
                from,
                robot
            ));
            info!(context, "luggage {luggage} waits again at {from}: robot {robot} is gone");
            context.send(&self.luggage, request)?;
        }
        for request in self.open.visit_again() {
            let visit = request.luggage - FIRST_VISIT;
            info!(context, "visit {visit} waits again: its robot left it");
            context.send(&self.luggage, request)?;
        }
        for (cause, robot) in started {
            context.because(cause);
            self.repeat_for(robot, context)?;
        }
        context.because(Cause::default());
        for (luggage, from, to) in self.open.take_hopeless(context.now()) {
            context.alert(
                GIVEN_UP,
                luggage,
                format_args!("gives up luggage {luggage} from {from} to {to}: no robot can carry it"),
            );
            context.vote(Work::GivenUp);
            context.send(&self.luggage, EventLuggage::given_up(luggage, from, to))?;
        }
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(Saved::of(&MasterMemory {
            speakers: self.validator.memory(),
            known: self.filter.known().clone(),
            open: self.open.memory(),
        }))
    }

    /// Goes on from a saved state; the area comes again from its topic.
    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        let Some(memory) = saved.read::<MasterMemory>()? else { return Ok(()) };
        self.validator.restore(memory.speakers);
        self.filter = EventFilter::of(memory.known);
        self.open = OpenLuggage::of(memory.open);
        Ok(())
    }

    fn status(&self) -> Vec<(String, ReportValue)> {
        self.open.status()
    }

    fn waits_for(&self) -> Option<String> {
        Some(match self.open.first() {
            None => "events".to_owned(),
            Some((first, more)) => format!("a robot to carry {}", pieces(first, more)),
        })
    }
}

impl MasterEnvironment {
    fn sort(&mut self, context: &mut Context<'_>, header: Header, event: &EnvironmentEvent) -> Result<(), Failure> {
        for request in &event.luggage {
            let EventLuggage { luggage, from, to, .. } = *request;
            match self.filter.luggage(request) {
                Ok(()) => {
                    self.open.add(luggage, from, to);
                    context.count("luggage.requested", 1);
                    context.send(&self.luggage, EventLuggage::request(luggage, from, to))?;
                }
                Err(refusal) => {
                    context.count("luggage.ignored", 1);
                    self.validator.log_rejection(context, header, request, refusal.problem);
                    if refusal.is_lost {
                        context.send(&self.luggage, EventLuggage::given_up(luggage, from, to))?;
                    }
                }
            }
        }
        for exceptional in &event.exceptional {
            context.send(&self.exceptional, exceptional.clone())?;
        }
        for fault in &event.faults {
            if let Err(problem) = fault.validate(header.sender, &mut self.validator, self.filter.area()) {
                context.count("faults.ignored", 1);
                self.validator.log_rejection(context, header, fault, problem);
            } else {
                match fault.kind {
                    FaultKind::Breakdown => self.open.break_down(fault.robot, context.now()),
                    FaultKind::Gone => {
                        let header = Header { sent: context.due(), ..header };
                        self.open.take_away(fault.robot, header);
                    }
                }
                context.send(&self.faults, fault.clone())?;
            }
        }
        Ok(())
    }

    /// Asks the robots for a visit, if it is possible and new.
    fn ask_to_visit(&mut self, context: &mut Context<'_>, header: Header, visit: &Visit) -> Result<(), Failure> {
        if header.sender == context.sender() {
            return Ok(());
        }
        let known = self.filter.knows(visit.visit).then_some(Problem::KnownLuggage);
        let judged = visit.validate(header.sender, &mut self.validator, self.filter.area());
        if let Some(problem) = known.or(judged.err()) {
            context.count("errands.ignored", 1);
            self.validator.log_rejection(context, header, visit, problem);
            let [first, last] = visit.ends();
            return match known {
                Some(_) => Ok(()),
                None => context.send(&self.luggage, EventLuggage::given_up(visit.visit, first, last)),
            };
        }
        self.filter.note(visit.visit);
        self.open.add_visit(visit);
        context.send(&self.luggage, visit.request())
    }

    /// Repeats what waits, for a robot that has just started.
    fn repeat_for(&self, robot: u32, context: &mut Context<'_>) -> Result<(), Failure> {
        let (luggage, helps) = self.open.waiting_for(robot);
        for request in luggage {
            if let Some(visit) = self.open.visit(request.luggage) {
                context.send(&self.visits, visit)?;
            }
            context.send(&self.luggage, request.again_for(robot))?;
        }
        for situation in helps {
            context.send(&self.situations, situation.again_for(robot))?;
        }
        // Topics keep what robots that are gone said before.
        let gone: Vec<u32> = self.open.gone().filter(|gone| *gone != robot).collect();
        for gone in gone {
            context.send(&self.faults, Fault::gone(gone))?;
        }
        Ok(())
    }

    /// Handles a message about luggage from a robot, or from another component on the robots' topic.
    fn hear(&mut self, context: &mut Context<'_>, header: Header, said: &EventLuggage) {
        if header.sender == context.sender() || !self.validator.accepts(said, header, self.filter.area(), context) {
            return;
        }
        if said.stage == LuggageStage::Delivered {
            context.alert_over(GIVEN_UP, said.luggage);
        }
        if said.stage == LuggageStage::Request {
            self.filter.note(said.luggage);
            self.open.hear_response(said);
        } else if self.filter.knows(said.luggage) {
            self.open.hear_response(said);
        } else {
            context.count("messages.ignored", 1);
            self.validator.log_rejection(context, header, said, Problem::UnknownLuggage);
        }
    }
}
