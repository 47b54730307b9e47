//! Components that ship fail once, at every moment that there is, and go on: nothing is lost, nothing is done twice.

use std::fs;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Knowledge, Loop, LoopClass, Own, Properties, Record};
use saoms_components::world::World;
use saoms_core::report::{RunReport, RunStatus};
use saoms_testkit::Fleet;
use serde_json::{Value, json};

use crate::support::root;

const PERIOD: Duration = Duration::from_millis(100);
const HOUR: Duration = Duration::from_secs(3600);

/// Three robots that bring six pieces, each component with `restart`.
fn hall(policy: &str, times: (u32, u32), loops: &str) -> String {
    let (move_time, handling_time) = times;
    let robots: String = [(1, 1), (2, 5), (3, 9)]
        .into_iter()
        .map(|(number, charger)| {
            format!(
                r#"<component name="Robot{number}">
                  <implementation.rust class="saoms.Robot"/>
                  <property name="ID">Robot{number}</property>
                  PERIOD
                  <property name="policy">{policy}</property>
                  <property name="discharge">0.3</property>
                  <property name="chargeX">0</property>
                  <property name="chargeY">{charger}</property>
                  <reference name="world" target="World"/>
                  {loops}
                </component>"#
            )
        })
        .collect();
    let text = format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:saoms="urn:saoms:1" name="hall"
            targetNamespace="urn:hall">
          <component name="World">
            <implementation.rust class="saoms.World"/>
            <property name="ID">World</property>
            PERIOD
            <property name="moveTime">{move_time}ms</property>
            <property name="handlingTime">{handling_time}ms</property>
          </component>
          <component name="Environment">
            <implementation.rust class="saoms.Environment"/>
            <property name="ID">Environment</property>
            PERIOD
            <property name="scenario">
              at 0s luggage (3,1) to (3,6)
              at 500ms luggage (3,6) to (6,1)
              then 300ms every 700ms 4 times luggage (2,2)..(7,8) to (2,2)..(7,8)
            </property>
          </component>
          <component name="Master">
            <implementation.rust class="saoms.MasterEnvironment"/>
            <property name="ID">Master</property>
            PERIOD
          </component>
          {robots}
        </composite>"#
    );
    text.replace("PERIOD", &periods(r#"value="100ms""#))
}

fn periods(value: &str) -> String {
    format!(
        r#"<property name="period" {value}/><property name="restart">onFailure</property>
        <property name="restartBackoff">250ms</property>"#
    )
}

fn section<'a>(report: &'a RunReport, name: &str) -> &'a Value {
    report.sections.get(name).unwrap_or(&Value::Null)
}

/// All pieces were delivered once, without a collision, and exactly these components failed.
#[track_caller]
fn assert_delivered(report: &RunReport, pieces: u32, failed: &[(&str, u64)], context: &str) {
    let sections = &report.sections;
    assert_eq!(report.outcome.status, RunStatus::Done, "{context}: {:?}, {sections:?}", report.outcome);
    let luggage = json!({"requested": pieces, "delivered": pieces, "open": 0, "given_up": 0, "ignored": 0});
    assert_eq!(section(report, "luggage"), &luggage, "{context}");
    assert_eq!(section(report, "collisions"), &json!({"vertex": 0, "swap": 0}), "{context}");
    assert_eq!(section(report, "stranded"), &json!(0), "{context}");
    let rows = section(report, "robots")["by_path"].as_object().unwrap();
    let delivered: u64 = rows.values().map(|row| row["delivered"].as_u64().unwrap()).sum();
    // A robot that is out when the run ends has no row.
    let robots = report.components.iter().filter(|one| one.name.starts_with("Robot")).count();
    assert!(delivered == u64::from(pieces) || rows.len() < robots, "{context}: {rows:?}");
    for component in &report.components {
        let expected = failed.iter().find(|(name, _)| *name == component.name).map_or(0, |(_, failures)| *failures);
        assert_eq!((component.failures, component.dropped), (expected, 0), "{context}: {}", component.name);
    }
}

/// How long a run takes in which nothing fails.
fn duration(composite: &str, seed: u64) -> Duration {
    let report = Fleet::of_text(composite).run(seed, HOUR).into_report();
    assert_eq!(report.outcome.status, RunStatus::Done, "{:?}", report.outcome);
    Duration::from_secs_f64(report.time_s)
}

/// Instants of a run of this length: all of them with `SAOMS_THOROUGH`, otherwise some that differ from case to case.
fn instants(end: Duration, case: usize) -> impl Iterator<Item = Duration> {
    let step = if std::env::var_os("SAOMS_THOROUGH").is_some() { 1 } else { 7 };
    let periods = u32::try_from(end.as_millis() / PERIOD.as_millis()).unwrap();
    (0..periods).skip(case % step).step_by(step).map(|period| PERIOD * period)
}

/// Each component fails in each of its executions, one in a run.
fn fail_everywhere(composite: &str, seed: u64, components: &[&str], pieces: u32) {
    let end = duration(composite, seed);
    for (case, component) in components.iter().enumerate() {
        for at in instants(end, case + seed as usize) {
            let fleet = Fleet::of_text(composite).fail(component, at);
            let report = fleet.run(seed, HOUR).into_report();
            assert_delivered(&report, pieces, &[(component, 1)], &format!("{component} fails at {at:?}, seed {seed}"));
        }
    }
}

const ALL: [&str; 6] = ["World", "Environment", "Master", "Robot1", "Robot2", "Robot3"];

#[test]
fn each_component_fails_in_each_execution() {
    fail_everywhere(&hall("safe", (0, 0), ""), 1, &ALL, 6);
}

#[test]
fn each_component_fails_in_each_execution_while_actions_take_their_time() {
    fail_everywhere(&hall("safe", (250, 450), ""), 2, &ALL, 6);
}

#[test]
fn robots_of_the_manual_fail_in_each_execution() {
    // They collide even if nothing fails, so that there is one alone.
    let one = |text: String| {
        let start = text.find(r#"<component name="Robot2""#).unwrap();
        format!("{}</composite>", &text[..start])
    };
    for times in [(0, 0), (250, 450)] {
        fail_everywhere(&one(hall("classic", times, "")), 3, &["World", "Environment", "Master", "Robot1"], 6);
    }
}

/// Properties of what fails in the middle.
#[derive(Debug, Properties)]
struct FragileProperties {
    /// Time from which on the first execution fails, in milliseconds.
    #[property(default = 0)]
    at: u64,
    /// Length of a period, in milliseconds.
    #[property(default = 100)]
    period: u64,
}

impl FragileProperties {
    /// Panics in the one execution that starts in this period.
    fn break_at_its_time(&self, context: &Context<'_>) {
        let now = context.now().as_nanos() / 1_000_000;
        assert!(!(self.at..self.at + self.period).contains(&now), "it breaks at {now} ms");
    }
}

/// Breaks once, after the loops before it have acted.
#[derive(Debug, LoopClass)]
#[looping(name = "test.Fragile")]
struct Fragile {
    properties: FragileProperties,
}

impl Loop for Fragile {
    type Properties = FragileProperties;
    type Knowledge = dyn Knowledge;
    type Symptom = Record;
    type Decision = Record;

    fn new(properties: FragileProperties) -> Result<Self, Failure> {
        Ok(Fragile { properties })
    }

    fn analyze(&mut self, _: &mut dyn Knowledge, context: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        self.properties.break_at_its_time(context);
        Ok(None)
    }

    fn plan(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<Option<Record>, Failure> {
        Ok(None)
    }

    fn execute(&mut self, _: Record, _: &mut dyn Knowledge, _: &mut Context<'_>) -> Result<(), Failure> {
        Ok(())
    }
}

/// A world that breaks once, after its work.
#[derive(Class)]
#[class(name = "test.FragileWorld", periodic, saves)]
struct FragileWorld {
    /// Time from which on the first execution fails, in milliseconds.
    #[property(default = 0)]
    breaks: u64,
    #[extends]
    world: World,
}

impl Component for FragileWorld {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.world.execute(context)?;
        FragileProperties { at: self.breaks, period: 100 }.break_at_its_time(context);
        Ok(())
    }
}

#[test]
fn robots_fail_after_they_have_begun_an_action() {
    for (times, seed) in [((0, 0), 4), ((250, 450), 5)] {
        for place in ["GripperMS", "PathFollowerMS"] {
            let broken = |at: u128| {
                let fragile = format!(
                    r#"<saoms:loop name="Fragile" class="test.Fragile" after="{place}">
                      <property name="at">{at}</property></saoms:loop>"#
                );
                hall("safe", times, &fragile)
            };
            let end = duration(&hall("safe", times, ""), seed);
            for at in instants(end, place.len()) {
                let report = Fleet::of_text(broken(at.as_millis())).run(seed, HOUR).into_report();
                let failed = [("Robot1", 1), ("Robot2", 1), ("Robot3", 1)];
                assert_delivered(&report, 6, &failed, &format!("all after {place} at {at:?}, {times:?}"));
            }
        }
    }
}

#[test]
fn a_world_fails_after_its_work() {
    let composite = hall("safe", (250, 450), "");
    let end = duration(&composite, 6);
    for at in instants(end, 3) {
        let fragile = format!(r#""test.FragileWorld"/><property name="breaks">{}</property>"#, at.as_millis());
        let composite = composite.replace(r#""saoms.World"/>"#, &fragile);
        let report = Fleet::of_text(composite).run(6, HOUR).into_report();
        assert_delivered(&report, 6, &[("World", 1)], &format!("at {at:?}"));
    }
}

/// The airport, each component with `restart`.
fn airport() -> String {
    let text = fs::read_to_string(root().join("composites/airport.composite")).unwrap();
    let before = r#"<property name="period" source="$period"/>"#;
    text.replace(before, &periods(r#"source="$period""#))
}

#[test]
fn the_airport_survives_a_failure_of_any_component_at_any_time() {
    let names = [
        "World", "Zone", "Environment", "MasterEnvironment", "MasterRobot", "Robot001", "Robot002", "Robot003",
        "Robot004", "Robot005", "Robot007", "Robot010",
    ];
    for (case, name) in names.into_iter().enumerate() {
        let seed = case as u64;
        for at in instants(Duration::from_secs(11), case).step_by(4) {
            let report = Fleet::of_text(airport()).fail(name, at).run(seed, HOUR).into_report();
            let context = format!("{name} fails at {at:?}, seed {seed}");
            // A run may end before.
            let failures = report.components.iter().find(|one| one.name == name).unwrap().failures;
            assert!(failures == 1 || at > Duration::from_secs(8), "{context}");
            assert_delivered(&report, 14, &[(name, failures)], &context);
        }
    }
}

#[test]
fn without_restart_all_is_as_it_was() {
    let composite = hall("safe", (0, 0), "").replace(r#"<property name="restart">onFailure</property>"#, "");
    let composite = composite.replace(r#"<property name="restartBackoff">250ms</property>"#, "");
    let report = Fleet::of_text(composite).fail("Robot2", Duration::from_secs(2)).run(1, HOUR).into_report();
    assert_eq!(report.outcome.status, RunStatus::Failed, "{:?}", report.outcome);
}
