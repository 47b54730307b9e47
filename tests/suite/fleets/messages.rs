//! Impossible messages on the topics that the shipped components read: reported with their sender, once, and ignored.

use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Properties, Publisher};
use saoms_components::grid::Block;
use saoms_components::hardware::Area;
use saoms_components::messages::{
    AREA, CRITICAL_SITUATION, CriticalKind, CriticalSituation, CriticalStage, ENVIRONMENT, EVENT_LUGGAGE,
    EnvironmentEvent, EventLuggage, FAULT, Fault, LuggageStage, POSITION, Position, ROBOT_LIST, ROBOT_STATE, RobotList,
    RobotState,
};
use saoms_core::report::RunStatus;
use saoms_testkit::{Fleet, Run};
use serde_json::json;

/// Says what cannot be, on one topic, again and again.
#[derive(Class)]
#[class(
    name = "test.Liar",
    periodic,
    publishes(ENVIRONMENT, EVENT_LUGGAGE, ROBOT_STATE, CRITICAL_SITUATION, POSITION, ROBOT_LIST, FAULT, AREA)
)]
struct Liar {
    topic: String,
    events: Publisher<EnvironmentEvent>,
    luggage: Publisher<EventLuggage>,
    states: Publisher<RobotState>,
    situations: Publisher<CriticalSituation>,
    positions: Publisher<Position>,
    robots: Publisher<RobotList>,
    faults: Publisher<Fault>,
    areas: Publisher<Area>,
}

#[derive(Properties)]
struct LiarProperties {
    #[property(required_text)]
    topic: String,
}

const LOW: Block = Block::new(i32::MIN, i32::MIN);
const HIGH: Block = Block::new(i32::MAX, i32::MAX);
const HERE: Block = Block::new(1, 0);
const THERE: Block = Block::new(4, 3);
const WALL: Block = Block::new(2, 2);

/// The numbers of robots that are not there.
const NOBODY: [u32; 3] = [0, 77, u32::MAX];

impl Component for Liar {
    type Properties = LiarProperties;

    fn new(properties: LiarProperties) -> Result<Self, Failure> {
        Ok(Liar {
            topic: properties.topic,
            events: Publisher::default(),
            luggage: Publisher::default(),
            states: Publisher::default(),
            situations: Publisher::default(),
            positions: Publisher::default(),
            robots: Publisher::default(),
            faults: Publisher::default(),
            areas: Publisher::default(),
        })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.events = context.publish(&ENVIRONMENT)?;
        self.luggage = context.publish(&EVENT_LUGGAGE)?;
        self.states = context.publish(&ROBOT_STATE)?;
        self.situations = context.publish(&CRITICAL_SITUATION)?;
        self.positions = context.publish(&POSITION)?;
        self.robots = context.publish(&ROBOT_LIST)?;
        self.faults = context.publish(&FAULT)?;
        self.areas = context.publish(&AREA)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if !(5..40).contains(&context.execution()) {
            return Ok(());
        }
        let turn = usize::try_from(context.execution()).unwrap_or(0);
        match &*self.topic {
            "ETOPIC" => {
                let request = |from, to| EventLuggage::request(900, from, to);
                let mut luggage = vec![request(LOW, HERE), request(HERE, WALL), request(HERE, HERE)];
                luggage.push(EventLuggage { robot: 1, ..request(HERE, THERE) });
                let faults = NOBODY.map(Fault::breakdown).to_vec();
                context.send(&self.events, EnvironmentEvent { luggage, exceptional: Vec::new(), faults })?;
            }
            "ELMSTOPIC" => {
                for (from, to) in [(LOW, HERE), (HERE, HIGH), (WALL, HERE), (HERE, HERE)] {
                    context.send(&self.luggage, EventLuggage::request(900, from, to))?;
                }
                for (robot, luggage) in [(0, 1), (77, 1), (1, 1), (2, 2), (u32::MAX, u32::MAX)] {
                    let said = EventLuggage { robot, ..EventLuggage::request(luggage, HERE, THERE) };
                    for stage in
                        [LuggageStage::Interest, LuggageStage::Taken, LuggageStage::Delivered, LuggageStage::Refused]
                    {
                        context.send(&self.luggage, EventLuggage { stage, ..said.clone() })?;
                        context.send(&self.luggage, EventLuggage { stage, block: LOW, ..said.clone() })?;
                    }
                    if robot > 0 {
                        let stage = LuggageStage::GivenUp;
                        context.send(&self.luggage, EventLuggage { stage, ..said })?;
                    }
                }
            }
            "RMSTOPIC" => {
                for robot in NOBODY {
                    context.send(&self.states, RobotState { robot, awake: false, emulate: 0 })?;
                }
                context.send(&self.states, RobotState { robot: 1, awake: true, emulate: 77 })?;
            }
            "CSMSTOPIC" => {
                for critical in [0, 77, 1, 2] {
                    let request = CriticalSituation {
                        critical,
                        block: HERE,
                        luggage: 1,
                        from: HERE,
                        to: THERE,
                        kind: CriticalKind::OnTheWay,
                        ..CriticalSituation::default()
                    };
                    context.send(&self.situations, request.clone())?;
                    context.send(&self.situations, CriticalSituation { block: HIGH, ..request.clone() })?;
                    for healer in [0, 77, 2] {
                        let stage = CriticalStage::Taken;
                        context.send(&self.situations, CriticalSituation { stage, healer, ..request.clone() })?;
                    }
                }
            }
            // Of state topics a reader gets what was said last.
            "POSTOPIC" => {
                let all = |(block, next, wanted)| {
                    [0, 1, 2].map(|robot| Position { robot, block, next, wanted, ..Position::default() })
                };
                let moves = [(LOW, LOW, LOW), (HERE, HIGH, HERE), (HERE, THERE, THERE), (HERE, HERE, HERE)];
                for position in all(moves[turn % moves.len()]) {
                    context.send(&self.positions, position)?;
                }
            }
            "RLMSTOPIC" => {
                let list = RobotList { robot: 1, charger: HERE, battery: 50.0, ..RobotList::default() };
                let lies = [
                    RobotList { battery: f64::NAN, active: true, ..list.clone() },
                    RobotList { battery: f64::INFINITY, active: true, ..list.clone() },
                    RobotList { battery: -1.0, active: true, ..list.clone() },
                    RobotList { battery: 100.5, active: true, ..list.clone() },
                    RobotList { charger: LOW, ..list.clone() },
                    RobotList { period: u64::MAX, ..list.clone() },
                    RobotList { robot: 0, ..list.clone() },
                    list,
                ];
                context.send(&self.robots, lies[turn % lies.len()].clone())?;
            }
            "FAULTTOPIC" => {
                for robot in NOBODY {
                    context.send(&self.faults, Fault::breakdown(robot))?;
                }
            }
            "AREATOPIC" => {
                let (width, height) = [(0, 0), (5, 4), (u32::MAX, u32::MAX)][turn % 3];
                context.send(&self.areas, Area { width, height, blocked: vec![0; 3] })?;
            }
            other => return Err(Failure::new(format!("there are no lies for {other}"))),
        }
        Ok(())
    }
}

/// Two robots bring two pieces of luggage, while somebody lies on a topic.
fn run(policy: &str, topic: &str) -> Run {
    let component = |name: &str, class: &str, inside: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"{class}\"/><property name=\"ID\">{name}</property><property name=\"period\">100</property>{inside}</component>\n"
        )
    };
    let robot = format!("<property name=\"policy\">{policy}</property><reference name=\"world\" target=\"World\"/>");
    let scenario = "<property name=\"scenario\">at 1s luggage (1,0) to (4,3); at 3s luggage (1,1) to (4,1)</property>";
    let text = [
        component("World", "saoms.World", "<property name=\"map\">.....\n.....\n..@..\n.....</property>"),
        component("Master", "saoms.MasterEnvironment", ""),
        component("Crew", "saoms.MasterRobot", ""),
        component("Environment", "saoms.Environment", scenario),
        component("Robot1", "saoms.Robot", &robot),
        component("Robot2", "saoms.Robot", &robot),
        component("Liar", "test.Liar", &format!("<property name=\"topic\">{topic}</property>")),
    ];
    let start =
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"t\" targetNamespace=\"urn:t\">";
    Fleet::of_text(format!("{start}\n{}</composite>", text.concat())).run(1, Duration::from_secs(600))
}

/// Holds that the work is done whatever is said on a topic, and that each of these readers says each of these things,
/// once.
fn ignored(topic: &str, readers: &[(&str, &[&str])]) {
    for policy in ["safe", "classic"] {
        let report = run(policy, topic);
        let log = report.log();
        assert_eq!(report.outcome.status, RunStatus::Done, "{policy} {:?}\n{log}", report.outcome);
        assert!(report.components.iter().all(|component| component.failures == 0), "{log}");
        let luggage = report.sections.get("luggage").cloned().unwrap_or_default();
        assert_eq!((&luggage["delivered"], &luggage["open"]), (&json!(2), &json!(0)), "{policy}\n{log}");
        let mut told: Vec<&str> = log.lines().filter(|line| line.contains("ignores what ")).collect();
        assert!(told.iter().all(|line| line.contains("ignores what `Liar` sent, ")), "{log}");
        for (reader, lies) in readers {
            let lines = report.log_of(reader);
            for lie in *lies {
                let count = lines.iter().filter(|line| line.contains(lie)).count();
                assert_eq!(count, 1, "{policy} {reader}: {lie}\n{log}");
            }
            told.retain(|line| !line.contains(&format!("{reader}: ")));
        }
        assert!(told.is_empty(), "others said something, too: {told:?}");
        let counted = ["messages", "luggage", "faults"]
            .map(|name| report.sections.get(name).and_then(|section| section["ignored"].as_u64()).unwrap_or(0));
        assert!(counted.iter().sum::<u64>() >= 35, "{counted:?}");
    }
}

const NO_ROBOT: &str = "found robot 0, expected a number from 1 on";
const UNKNOWN: &str = "which has not announced itself, expected a robot that has";

#[test]
fn events_of_the_environment() {
    let all = [
        "expected a block of the area from (0,0) to (4,3)",
        "found (2,2), which is blocked",
        "found (1,0) twice",
        "found a response of robot 1, expected a request",
        NO_ROBOT,
        UNKNOWN,
    ];
    ignored("ETOPIC", &[("Master", &all)]);
}

#[test]
fn luggage() {
    let all: &[&str] = &[
        "expected a block of the area from (0,0) to (4,3)",
        "which is blocked",
        "(1,0) twice",
        NO_ROBOT,
        UNKNOWN,
        "it has the number of robot",
    ];
    let readers = ["Master", "World", "Environment", "Robot1", "Robot2"];
    ignored("ELMSTOPIC", &readers.map(|reader| (reader, all)));
}

#[test]
fn calls() {
    let all: &[&str] = &[NO_ROBOT, UNKNOWN];
    ignored("RMSTOPIC", &["Robot1", "Robot2"].map(|reader| (reader, all)));
}

#[test]
fn critical_situations() {
    let all: &[&str] = &[NO_ROBOT, UNKNOWN, "it has the number of robot", "expected a block of the area"];
    ignored("CSMSTOPIC", &["Robot1", "Robot2", "Master"].map(|reader| (reader, all)));
}

#[test]
fn positions() {
    let all: &[&str] = &[
        "expected a block of the area",
        "found (4,3) after (1,0)",
        "it has the number of robot 1, which `Robot1` uses",
    ];
    ignored("POSTOPIC", &["Robot1", "Robot2"].map(|reader| (reader, all)));
}

#[test]
fn states_of_robots() {
    let all: &[&str] = &[
        "found a battery of NaN %",
        "found a period of 18446744073709551615 us",
        "expected a block of the area",
        NO_ROBOT,
        "it has the number of robot 1, which `Robot1` uses",
    ];
    ignored("RLMSTOPIC", &["Robot1", "Robot2", "Master", "Environment", "World", "Crew"].map(|reader| (reader, all)));
}

#[test]
fn faults() {
    let all: &[&str] = &[NO_ROBOT, UNKNOWN];
    ignored("FAULTTOPIC", &["Robot1", "Robot2"].map(|reader| (reader, all)));
}

#[test]
fn areas() {
    let all: &[&str] = &["blocks: found another number of blocks than the expected"];
    ignored("AREATOPIC", &["Master", "Environment"].map(|reader| (reader, all)));
}
