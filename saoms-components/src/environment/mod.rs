//! Events outside the fleet, played from a scenario.

#[cfg(test)]
mod class_events_tests;
mod memory;
mod open_job;
mod outside;
mod player;
mod scenario;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use saoms_api::{
    Class, Component, Context, Failure, Level, Properties, Publisher, Record, Saved, Subscription, Time, Work, info,
    record, warn,
};

use crate::console::Timestamp;
use crate::grid::Map;
use crate::hardware::Area;
use crate::messages::{
    AREA, CRITICAL_SITUATION, CriticalSituation, ENVIRONMENT, EVENT_LUGGAGE, EnvironmentEvent, EventLuggage,
    ExceptionalKind, FIRST_VISIT, Fault, LuggageStage, REMOVAL, ROBOT_LIST, Removal, RobotList, VISIT, Visit,
};
use crate::report::pieces;
use crate::validation::MessageValidator;

use open_job::{KnownRobot, OpenJob};
use player::Player;

pub use player::ScenarioEvent;
pub(crate) use scenario::bare_times;
pub use scenario::{Continuation, EventSpec, Line, RandomRange, Scenario, Spanned, Spot, continuations};

/// Properties of an environment.
#[derive(Clone, Debug, Properties)]
pub struct EnvironmentProperties {
    /// Events and their times since the environment's first execution, one event a line: `at 6s luggage (3,1) to
    /// (3,10)`, `then 500ms luggage (10,8) to (1,8)` (after the line before), `at 3s landing 4`, `at 3s takeoff 4`, `at
    /// 9s breakdown Robot002`, `at 30s gone Robot002` (off the floor), `at 5s visit (3,1) then (5,2) by Robot002`;
    /// repeated events: `from 10s every 5s 100 times luggage random to random`. Two values with `..` between them are a
    /// range from which a value is drawn: `every 2s..8s`, `luggage (1,0)..(10,10) to (3,1)`. Events that components of
    /// other classes take have the fields of their messages: `at 5s fire at=(3,4) size=1..3`. `;` ends a line, too, and
    /// `#` starts a comment. Without a scenario nothing happens. A long scenario can be in a file:
    /// `file="scenario.txt"`.
    #[property(language = "scenario", plays("luggage", "visit", "landing", "takeoff", "breakdown", "gone", "end"))]
    pub(crate) scenario: Vec<String>,
    /// Greatest number of pieces of luggage and visits that are open at once. While so many are, the events of the
    /// scenario that are due wait.
    #[property(range = 1..)]
    pub(crate) most_open: Option<u32>,
}

/// Plays a scenario: publishes its events at their times. Random values follow from the seed of the run.
///
/// Votes that the run is done when the scenario is over and all its luggage is delivered or given up, and that work was
/// given up if any of it was.
#[derive(Debug, Class)]
#[class(name = "saoms.Environment", periodic, saves, also("launch.Environment"))]
pub struct Environment {
    scenario: Scenario,
    playing: Option<(Time, Player)>,
    played: usize,
    /// Luggage and visits that are published, but not done yet.
    open: BTreeMap<u32, OpenJob>,
    most_open: usize,
    /// What is known of robots, by number.
    robots_known: BTreeMap<u32, KnownRobot>,
    luggage: u32,
    visits: u32,
    map: Option<Map>,
    validator: MessageValidator,
    has_world: bool,
    #[publishes(ENVIRONMENT)]
    events: Publisher<EnvironmentEvent>,
    #[publishes(VISIT)]
    visits_asked: Publisher<Visit>,
    #[subscribes(ROBOT_LIST)]
    robots: Subscription<RobotList>,
    #[subscribes(EVENT_LUGGAGE)]
    responses: Subscription<EventLuggage>,
    #[subscribes(AREA)]
    area: Subscription<Area>,
    #[subscribes(REMOVAL)]
    removals: Subscription<Removal>,
    #[subscribes(CRITICAL_SITUATION)]
    situations: Subscription<CriticalSituation>,
    done: bool,
}

/// Greatest number of events in one execution; others that are due follow in the next ones. So a queue of 1024 messages
/// does not overflow, even if its reader has eight times the period.
const MAX_EVENTS: usize = 128;

impl Component for Environment {
    type Properties = EnvironmentProperties;

    fn new(properties: EnvironmentProperties) -> Result<Self, Failure> {
        Ok(Environment {
            scenario: Scenario::read(&properties.scenario).map_err(Failure::of_findings)?,
            playing: None,
            played: 0,
            open: BTreeMap::new(),
            robots_known: BTreeMap::new(),
            most_open: properties.most_open.map_or(usize::MAX, |most| most as usize),
            luggage: 0,
            visits: 0,
            visits_asked: Publisher::default(),
            map: None,
            validator: MessageValidator::default(),
            has_world: false,
            events: Publisher::default(),
            robots: Subscription::default(),
            responses: Subscription::default(),
            area: Subscription::default(),
            removals: Subscription::default(),
            situations: Subscription::default(),
            done: false,
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.goes_on() {
            // It has said all this, and voted.
            return Ok(());
        }
        let now = Timestamp::now(context);
        context.console(format_args!("Environment tests start at {now}"));
        if self.scenario.lines().is_empty() {
            info!(context, "has no scenario: publishes nothing");
            self.done = true;
        } else {
            context.console(format_args!("Environment: ready to test at {now}"));
            context.vote(Work::Open);
        }
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.done {
            return Ok(());
        }
        self.listen(context);
        let Some((start, mut player)) = self.playing.take().or_else(|| self.begin(context)) else {
            return Ok(());
        };
        let now = context.due().since(start);
        self.publish_again(context)?;
        for _ in 0..MAX_EVENTS {
            if self.open.len() >= self.most_open {
                break;
            }
            let Some(event) = player.next(now, self.map.as_ref()) else { break };
            self.publish(context, event)?;
        }
        if player.is_over() && self.open.is_empty() {
            self.done = true;
            context.vote(Work::Done);
        }
        self.playing = Some((start, player));
        Ok(())
    }

    fn save(&mut self) -> Result<Saved, Failure> {
        Ok(self.save_state())
    }

    fn restore(&mut self, saved: &Saved) -> Result<(), Failure> {
        self.restore_state(saved)
    }

    fn waits_for(&self) -> Option<String> {
        if self.done {
            return Some("nothing: its scenario is over".to_owned());
        }
        let Some((_, player)) = &self.playing else {
            let waits = self.scenario.needs_area() && self.map.is_none();
            return waits.then(|| "a `saoms.World`, which defines the area".to_owned());
        };
        let (first, job) = self.open.first_key_value().filter(|_| player.is_over())?;
        let pieces = pieces(*first, self.open.len() - 1);
        Some(match job.passed_on {
            true if job.is_visit => format!("a robot to do {pieces}"),
            true => format!("a robot to carry {pieces}"),
            false => format!("a master of the environment to pass on {pieces} on `{}`", EVENT_LUGGAGE.name()),
        })
    }
}

impl Environment {
    fn listen(&mut self, context: &mut Context<'_>) {
        for (header, area) in context.receive(&self.area).with_headers() {
            if self.validator.accepts(area, header, None, context) {
                // A world counts the luggage itself, also what was published before it was heard.
                if !std::mem::replace(&mut self.has_world, true) {
                    let counted = self.open.values().filter(|job| !job.is_visit).count();
                    context.count("luggage.open", -i64::try_from(counted).unwrap_or_default());
                }
                self.map = area.clone().into();
            }
        }
        // The components that speak for each robot.
        for (header, robot) in context.receive(&self.robots).with_headers() {
            self.validator.accepts(robot, header, self.map.as_ref(), context);
        }
        for (header, situation) in context.receive(&self.situations).with_headers() {
            // Masters and robots report impossible ones.
            if self.validator.judge(situation, header, self.map.as_ref(), context).is_ok() {
                self.hear_situation(situation, header, context.execution());
            }
        }
        for (header, removal) in context.receive(&self.removals).with_headers() {
            if self.validator.accepts(removal, header, self.map.as_ref(), context) {
                self.open.retain(|luggage, _| !removal.delivered.contains(luggage));
                let execution = context.execution();
                let out = &mut self.robots_known.entry(removal.robot).or_default().out;
                *out = (*out).max(Some(removal.since));
                self.open.iter_mut().for_each(|(number, job)| job.hear_removal(*number, removal, execution));
            }
        }
        for (header, response) in context.receive(&self.responses).with_headers() {
            if !self.validator.accepts(response, header, self.map.as_ref(), context) {
                continue;
            }
            // Luggage that is given up counts as open in the report, but is not waited for.
            let counted = match response.stage {
                LuggageStage::Delivered => -1,
                LuggageStage::GivenUp => 0,
                _ => {
                    self.hear_of_job(response, header, context.execution());
                    continue;
                }
            };
            let Some(job) = self.open.remove(&response.luggage) else { continue };
            if job.is_visit {
                context.count("errands.open", counted);
                context.count(if counted == 0 { "errands.given_up" } else { "errands.finished" }, 1);
            }
            if counted == 0 {
                context.vote(Work::GivenUp);
            }
            if job.is_visit {
                continue;
            }
            // The world may be in another program, whose report has its counts.
            context.count("scenario.delivered", -counted);
            if !self.has_world {
                context.count("luggage.open", counted);
                context.count("luggage.given_up", 1 + counted);
            }
        }
    }

    /// Starts the scenario, once the area is known if the scenario needs it.
    fn begin(&self, context: &mut Context<'_>) -> Option<(Time, Player)> {
        if self.scenario.needs_area() && self.map.is_none() {
            if context.execution() == 0 {
                warn!(context, "waits for a world, which defines the area");
            }
            return None;
        }
        Some((context.due(), Player::new(&self.scenario, context.chance())))
    }

    fn publish(&mut self, context: &mut Context<'_>, event: Option<ScenarioEvent>) -> Result<(), Failure> {
        self.played += 1;
        let (test, now) = (self.played, Timestamp::now(context));
        match event {
            None => {
                context.count("luggage.ignored", 1);
                context.log(Level::Error, format_args!("finds no free block for luggage in the range of the scenario"));
                Ok(())
            }
            Some(ScenarioEvent::Luggage { from, to }) => {
                self.luggage += 1;
                let request = EventLuggage::request(self.luggage, from, to);
                let job = OpenJob::new(vec![from, to], (false, 0), context.execution());
                self.open.insert(self.luggage, job);
                context.count("scenario.luggage", 1);
                if !self.has_world {
                    context.count("luggage.open", 1);
                }
                context.console(format_args!("Environment: Test{test}: {request} at {now}"));
                let luggage = self.luggage;
                tell(
                    context,
                    record!(new_luggage: "luggage {luggage} waits at {from} to go to {to}", luggage, from, to),
                );
                context.send(&self.events, request.into())
            }
            Some(ScenarioEvent::Visit { stops, by }) => {
                self.visits += 1;
                let visit = Visit { visit: FIRST_VISIT + self.visits, robot: by.unwrap_or(0), stops };
                let job = OpenJob::new(visit.stops.clone(), (true, visit.robot), context.execution());
                self.open.insert(visit.visit, job);
                context.count("errands.requested", 1);
                context.count("errands.open", 1);
                context.console(format_args!("Environment: Test{test}: {visit} at {now}"));
                let ([from, to], number) = (visit.ends(), visit.count());
                tell(context, record!(new_visit: "visit {number} is to do: from {from} to {to}", number, from, to));
                context.send(&self.visits_asked, visit)
            }
            Some(ScenarioEvent::Exceptional(event)) => {
                context.console(format_args!("Environment: Test{test}: New event: {event}."));
                let pieces = event.pieces;
                let record = match event.kind {
                    ExceptionalKind::Landing => record!(
                        airplane_lands: "an airplane lands with {pieces} {pieces:piece|pieces} of luggage",
                        pieces
                    ),
                    ExceptionalKind::Takeoff => record!(
                        airplane_takes_off: "an airplane takes off with {pieces} {pieces:piece|pieces} of luggage",
                        pieces
                    ),
                };
                tell(context, record);
                context.send(&self.events, event.into())
            }
            Some(ScenarioEvent::Raised(event)) => {
                context.console(format_args!("Environment: Test{test}: New event: {event}."));
                info!(context, "{event}");
                context.raise(&event)
            }
            Some(ScenarioEvent::End) => Ok(()),
            Some(ScenarioEvent::Breakdown(robot)) => {
                let fault = Fault::breakdown(robot);
                context.console(format_args!("Environment: Test{test}: New event: {fault}."));
                tell(context, record!(robot_breaks_down: "robot {robot} breaks down", robot));
                context.send(&self.events, fault.into())
            }
            Some(ScenarioEvent::Gone(robot)) => {
                let fault = Fault::gone(robot);
                context.console(format_args!("Environment: Test{test}: New event: {fault}."));
                tell(context, record!(robot_is_gone: "robot {robot} is gone", robot));
                context.send(&self.events, fault.into())
            }
        }
    }
}

/// Writes an event to the log and, as the root of what follows from it, to the journal.
fn tell(context: &mut Context<'_>, event: Record) {
    info!(context, "{event}");
    context.symptom(event);
}
