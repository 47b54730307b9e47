//! Robots that say of themselves what must not be, or do it, for one invariant after the other.

mod greedy;

use std::time::{SystemTime, UNIX_EPOCH};

use saoms_api::{Class, Component, Context, Failure, Own, Publisher};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::Area;
use saoms_components::messages::{
    AREA, CRITICAL_SITUATION, CriticalKind, CriticalSituation, EVENT_LUGGAGE, EventLuggage, HANDLING, Handling,
    LuggageStage, POSITION, Position, ROBOT_LIST, RobotList,
};

/// A robot with a bug, which shows itself with some seeds alone.
#[derive(Class)]
#[class(name = "test.Planted", periodic)]
struct Planted {
    /// What it does wrong.
    #[property]
    bug: String,
    #[publishes(POSITION)]
    positions: Publisher<Position>,
    #[publishes(ROBOT_LIST)]
    states: Publisher<RobotList>,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[publishes(CRITICAL_SITUATION)]
    helps: Publisher<CriticalSituation>,
    #[publishes(AREA)]
    areas: Publisher<Area>,
    #[publishes(HANDLING)]
    handlings: Publisher<Handling>,
    /// The execution in which it does so.
    bad: Option<u64>,
}

const ROBOT: u32 = 99;
/// One of so many seeds has a bad execution, which is one of the first ones.
const SEEDS: u64 = 5;
const EXECUTIONS: u64 = 100;

/// The execution from which on a component is bad, with the seeds of a run that have one.
fn bad_execution(context: &mut Context<'_>) -> Option<u64> {
    let (is_bad, at) = (context.chance().below(SEEDS) == 0, 2 + context.chance().below(EXECUTIONS));
    is_bad.then_some(at)
}

fn says(stage: LuggageStage) -> EventLuggage {
    EventLuggage { robot: ROBOT, stage, ..EventLuggage::request(50, Block::new(1, 1), Block::new(2, 2)) }
}

impl Component for Planted {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = context.execution();
        if now == 0 {
            self.bad = bad_execution(context);
            context.send(&self.luggage, EventLuggage { robot: 0, ..says(LuggageStage::Request) })?;
        }
        let (is_bad, bug) = (self.bad == Some(now), self.bug.as_str());
        if now == 0 && bug == "uncounted" {
            // It is the world, too, which counts what is delivered.
            context.send(&self.areas, Area::from(&Map::new(5, 5)))?;
        }
        let battery = match bug {
            "battery" if is_bad => 0.0,
            "clock" => {
                let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
                f64::from(now.subsec_nanos() % 100)
            }
            _ => 80.0,
        };
        // One that looks at the clock is none that has to do something.
        let state =
            RobotList { robot: ROBOT, active: bug != "clock", battery, period: 100_000, ..RobotList::default() };
        context.send(&self.states, state)?;
        let block = if bug == "jump" && is_bad { Block::new(3, 1) } else { Block::new(1, 1) };
        let at = Position { robot: ROBOT, block, next: block, wanted: block, ..Position::default() };
        context.send(&self.positions, at)?;
        match bug {
            // It has delivered it before, as it says.
            "twice" if is_bad => context.send(&self.luggage, says(LuggageStage::Delivered)),
            // As a world would say it that gives a piece to two robots, or to one that is elsewhere.
            "bearers" | "elsewhere" if is_bad => {
                let block = if bug == "elsewhere" { Block::new(3, 3) } else { Block::new(1, 1) };
                let collected = |robot| Handling { luggage: 50, robot, block, ..Handling::default() };
                context.send(&self.handlings, collected(ROBOT))?;
                if bug == "bearers" { context.send(&self.handlings, collected(98)) } else { Ok(()) }
            }
            "deadlock" if is_bad => context.send(&self.luggage, says(LuggageStage::Taken)),
            "broken" if is_bad => {
                let critical = CriticalSituation {
                    critical: ROBOT,
                    luggage: 50,
                    kind: CriticalKind::CarriesLuggage,
                    ..CriticalSituation::default()
                };
                context.send(&self.helps, critical)
            }
            // What it was asked for is done, but with a bad seed.
            "open" if self.bad.is_some() => Ok(()),
            "clock" | "deadlock" | "broken" => Ok(()),
            _ if now == 1 => {
                context.count("luggage.delivered", i64::from(bug != "uncounted" || self.bad.is_none()));
                context.send(&self.luggage, says(LuggageStage::Delivered))
            }
            _ => Ok(()),
        }
    }
}

saoms_api::plugin! { classes: [Planted, greedy::Greedy] }
