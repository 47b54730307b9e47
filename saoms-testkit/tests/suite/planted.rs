//! The invariants find a bug that somebody planted, within 100 seeds, and nothing where there is none.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use saoms_api::{Class, Component, Context, Failure, Properties, Publisher};
use saoms_components::grid::Block;
use saoms_components::messages::{
    CRITICAL_SITUATION, CriticalKind, CriticalSituation, EVENT_LUGGAGE, EventLuggage, LuggageStage, POSITION, Position,
    ROBOT_LIST, RobotList,
};
use saoms_testkit::Fleet;

/// The bug of a [`Planted`] robot.
#[derive(Clone, Debug, Properties)]
struct Bug {
    /// What it does wrong, from some execution on.
    bug: String,
}

/// A robot that says of itself what must not be.
#[derive(Class)]
#[class(name = "test.Planted", periodic)]
struct Planted {
    bug: String,
    #[publishes(POSITION)]
    positions: Publisher<Position>,
    #[publishes(ROBOT_LIST)]
    states: Publisher<RobotList>,
    #[publishes(EVENT_LUGGAGE)]
    luggage: Publisher<EventLuggage>,
    #[publishes(CRITICAL_SITUATION)]
    helps: Publisher<CriticalSituation>,
}

const ROBOT: u32 = 99;

fn at(block: Block) -> Position {
    Position { robot: ROBOT, block, next: block, wanted: block, ..Position::default() }
}

fn says(stage: LuggageStage) -> EventLuggage {
    EventLuggage { robot: ROBOT, stage, ..EventLuggage::request(50, Block::new(1, 1), Block::new(2, 2)) }
}

impl Component for Planted {
    type Properties = Bug;

    fn new(bug: Bug) -> Result<Self, Failure> {
        Ok(Planted {
            bug: bug.bug,
            positions: Publisher::default(),
            states: Publisher::default(),
            luggage: Publisher::default(),
            helps: Publisher::default(),
        })
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let wrong = context.chance().below(20) == 0;
        let (near, far) = (Block::new(1, 1), Block::new(3, 1));
        let battery = if self.bug == "battery" && wrong { 0.0 } else { 80.0 };
        let state = RobotList { robot: ROBOT, active: true, battery, period: 100_000, ..RobotList::default() };
        context.send(&self.states, state)?;
        context.send(&self.positions, at(if self.bug == "jump" && wrong { far } else { near }))?;
        if context.execution() == 0 && self.bug != "battery" && self.bug != "jump" {
            context.send(&self.luggage, EventLuggage { robot: 0, ..says(LuggageStage::Request) })?;
        }
        match self.bug.as_str() {
            "twice" if wrong => context.send(&self.luggage, says(LuggageStage::Delivered)),
            "deadlock" if context.execution() == 1 => context.send(&self.luggage, says(LuggageStage::Taken)),
            "broken" if context.execution() == 1 => context.send(
                &self.helps,
                CriticalSituation {
                    critical: ROBOT,
                    luggage: 50,
                    kind: CriticalKind::CarriesLuggage,
                    ..CriticalSituation::default()
                },
            ),
            "clock" => {
                let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
                let battery = f64::from(now.subsec_nanos() % 100);
                let state = RobotList { robot: ROBOT, active: false, battery, ..RobotList::default() };
                context.send(&self.states, state)
            }
            _ => Ok(()),
        }
    }
}

fn planted(bug: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="planted" targetNamespace="urn:planted">
  <component name="Planted">
    <implementation.rust class="test.Planted"/>
    <property name="ID">Planted</property>
    <property name="period">100ms</property>
    <property name="bug">{bug}</property>
  </component>
</composite>"#
    ))
}

/// The violations of the first of 100 seeds that has any.
fn found(fleet: &Fleet, limit: u64) -> String {
    let limit = Duration::from_secs(limit);
    let found = (0..100).map(|seed| fleet.violations(seed, limit)).find(|found| !found.is_empty());
    found.unwrap_or_default()
}

#[test]
fn robots_that_hear_of_each_other_too_late_meet_and_exchange_their_blocks() {
    // Without its zone, safety rests on messages that are faster than a period.
    let text = std::fs::read_to_string("../composites/airport.composite").unwrap();
    let (before, after) = text.split_once("<component name=\"Zone\">").unwrap();
    let fleet = Fleet::of_text([before, after.split_once("</component>").unwrap().1].concat());
    let late = fleet.with_fault(Duration::from_secs(1), "for 20s delay 50ms to 300ms");
    let found: String = (0..20).map(|seed| late.violations(seed, Duration::from_secs(60))).collect();
    assert!(found.contains("] 1 no two robots in a block: robots ") && found.contains(" collide at ("), "{found}");
    assert!(found.contains("] 2 no two robots exchange their blocks: robots "), "{found}");
}

#[test]
fn a_planted_bug_is_found_within_100_seeds() {
    for (bug, limit, expected) in [
        ("jump", 60, "3 a move is one block to a free neighbour: robot 99 was at (1,1), and is at (3,1)"),
        ("twice", 60, "4 luggage is delivered exactly once: robot 99 delivers luggage 50, which was delivered at "),
        ("battery", 60, "5 no battery is empty away from a charger: the battery of robot 99 is empty"),
        ("deadlock", 90, "6 no robot with a job stands still for ever: robot 99 has stood at (1,1) for 6"),
        ("deadlock", 900, "7 requests are finished once faults are over: luggage 50 is not delivered"),
        ("broken", 90, "8 the luggage of a broken robot is taken over: nobody takes over luggage 50 of robot 99"),
    ] {
        let found = found(&planted(bug), limit);
        assert!(found.contains(expected), "{bug}: {found}");
    }
}

#[test]
fn a_component_that_looks_at_another_clock_has_another_trace() {
    let fleet = planted("clock");
    let hash = || fleet.run(1, Duration::from_secs(10)).trace_hash.clone();
    assert_ne!(hash(), hash());
}

#[test]
fn fleets_of_the_safe_policy_keep_the_invariants() {
    Fleet::of_file("../composites/airport.composite").expect_invariants(0..3, Duration::from_secs(3600));
    Fleet::of_file("../composites/hall.composite").expect_invariants(0..3, Duration::from_secs(60));
}
