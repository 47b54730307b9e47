//! Robots whose hardware measures the battery.

use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Properties, Time};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, ActionKind, Area, Hardware, Progress};
use saoms_components::messages::ROBOT_LIST;
use saoms_components::robot::Robot;
use saoms_testkit::{Bench, Fleet};

/// Properties of the driver.
#[derive(Debug, Properties)]
struct GaugedProperties {
    /// Level at the start, in percent; a negative one is no number, and none is a driver without a gauge.
    level: Option<f64>,
    /// Discharge of a move, in percent.
    #[property(default = 4.0)]
    per_move: f64,
}

/// Hardware with a gauge, which charges at (0,0).
#[derive(Debug, Class)]
#[class(name = "test.GaugedDriver", passive, service("hardware": Hardware))]
struct Gauged {
    properties: GaugedProperties,
    block: Block,
    asked: Option<Time>,
}

impl Component for Gauged {
    type Properties = GaugedProperties;

    fn new(properties: GaugedProperties) -> Result<Self, Failure> {
        Ok(Gauged { properties, block: Block::default(), asked: None })
    }
}

impl Hardware for Gauged {
    fn enter(&mut self, _: &mut Context<'_>, _: u32, _: String, block: Block) -> Result<Block, Failure> {
        self.block = block;
        Ok(block)
    }

    fn area(&mut self, _: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(Area::from(&Map::new(11, 11)))
    }

    fn begin(&mut self, context: &mut Context<'_>, _: u32, action: Action) -> Result<Progress, Failure> {
        if action.kind == ActionKind::Move {
            self.block = action.block;
            self.properties.level = self.properties.level.map(|level| level - self.properties.per_move);
        }
        if action.kind == ActionKind::Deposit {
            context.count("luggage.delivered", 1);
        }
        Ok(Progress::Done)
    }

    fn poll(&mut self, _: &mut Context<'_>, _: u32) -> Result<Progress, Failure> {
        Ok(Progress::Done)
    }

    fn cancel(&mut self, _: &mut Context<'_>, _: u32) -> Result<(), Failure> {
        Ok(())
    }

    fn retire(&mut self, _: &mut Context<'_>, _: u32) -> Result<Block, Failure> {
        Ok(self.block)
    }

    fn battery(&mut self, context: &mut Context<'_>, _: u32) -> Result<Option<f64>, Failure> {
        context.count("asked", 1);
        if self.asked.replace(context.now()) == Some(context.now()) {
            return Err("it is asked twice in one execution".into());
        }
        let Some(level) = &mut self.properties.level else { return Ok(None) };
        if *level < 0.0 {
            return Ok(Some(f64::NAN));
        }
        if self.block == Block::default() {
            *level = (*level + 5.0).min(100.0);
        }
        context.report("gauge", *level);
        Ok(Some(*level))
    }
}

fn fleet(level: &str, robot: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="hall" targetNamespace="urn:hall">
          <component name="Driver"><implementation.rust class="test.GaugedDriver"/>{level}</component>
          <component name="Environment">
            <implementation.rust class="saoms.Environment"/>
            <property name="ID">Environment</property>
            <property name="period">100ms</property>
            <property name="scenario">at 1s luggage (3,1) to (3,3); at 9s luggage (1,4) to (2,2)</property>
          </component>
          <component name="Master">
            <implementation.rust class="saoms.MasterEnvironment"/>
            <property name="ID">Master</property>
            <property name="period">100ms</property>
          </component>
          <component name="Robot1">
            <implementation.rust class="saoms.Robot"/>
            <property name="ID">Robot1</property>
            <property name="period">100ms</property>
            <property name="chargeX">0</property>
            <property name="chargeY">0</property>
            {robot}
            <reference name="world" target="Driver"/>
          </component>
        </composite>"#,
    ))
}

const LEVEL: &str = r#"<property name="level">80</property>"#;

#[test]
fn a_robot_goes_by_the_level_that_its_hardware_measures() {
    for policy in ["safe", "classic"] {
        // By its own count the battery would last for ever.
        let robot = format!(
            r#"<property name="policy">{policy}</property><property name="dischargePerBlock">0.001</property>
               <property name="dischargePerSecond">0.001</property><property name="chargePerSecond">0.001</property>"#
        );
        let run = fleet(LEVEL, &robot).run(0, Duration::from_secs(60));
        assert_eq!(run.count("luggage.delivered"), 2, "{policy}: {}", run.log());
        let row = &run.sections["robots"]["by_path"]["Robot1"];
        assert!(row["blocks"].as_u64().unwrap() >= 12, "{policy}: {row}");
        assert_eq!(row["battery"], run.sections["gauge"], "{policy}: {row}");
        let journal = serde_json::to_string(run.journal()).unwrap();
        assert!(policy == "classic" || journal.contains("battery"), "{policy}: {journal}");
    }
}

#[test]
fn a_low_measured_level_sends_the_robot_to_its_charger() {
    // It lasts for a few blocks, by the robot's estimate of what a block takes; its own count would be 100 %.
    let robot = r#"<property name="dischargePerBlock">4</property><property name="dischargePerSecond">0</property>
        <property name="chargePerSecond">50</property>"#;
    let measured = fleet(r#"<property name="level">60</property>"#, robot).run(0, Duration::from_secs(60));
    let counted = fleet("", robot).run(0, Duration::from_secs(60));
    let at_first_pick = |log: Vec<String>| log.iter().position(|line| line.contains("collected luggage 1"));
    for run in [&measured, &counted] {
        assert_eq!(run.count("luggage.delivered"), 2, "{}", run.log());
        assert!(at_first_pick(run.log_of("Robot1")).is_some());
    }
    let first = "starts charging (battery 65.0 %)";
    assert!(measured.log_of("Robot1")[0] == first, "by the gauge, not by the count: {}", measured.log());
    let why = serde_json::to_string(measured.journal()).unwrap();
    assert!(why.contains("65"), "the level of the gauge is in the journal: {why}");
    assert!(!serde_json::to_string(counted.journal()).unwrap().contains("\"65"), "the robot counted from 100 %");
}

fn robot(level: Option<&str>) -> Bench {
    let values: Vec<(&str, &str)> = level.map(|level| ("level", level)).into_iter().collect();
    let driver = Bench::of::<Gauged>(&values).unwrap();
    let values = [("ID", "Robot1"), ("chargeX", "5"), ("chargeY", "5"), ("discharge", "2"), ("battery", "90")];
    let mut robot = Bench::of::<Robot>(&values).unwrap().wire("world", driver, "hardware");
    robot.start().unwrap();
    robot
}

/// The level that the robot tells at its end.
fn battery(mut robot: Bench) -> f64 {
    robot.shutdown().unwrap();
    robot.sent(&ROBOT_LIST).last().unwrap().battery
}

fn execute(robot: &mut Bench, times: u32) {
    for _ in 0..times {
        robot.execute().unwrap();
    }
}

#[test]
fn it_asks_once_in_an_execution_and_keeps_the_last_level_while_the_hardware_is_busy() {
    let mut gauged = robot(Some("70"));
    execute(&mut gauged, 3);
    gauged.set_busy("world", true);
    execute(&mut gauged, 5);
    gauged.set_busy("world", false);
    assert_eq!(battery(gauged), 70.0);
}

#[test]
fn without_a_gauge_or_a_number_the_robot_counts() {
    for level in [None, Some("-1")] {
        let mut counting = robot(level);
        execute(&mut counting, 8);
        // It rests at its charger, and gains.
        assert!(battery(counting) > 90.0, "{level:?}");
    }
}
