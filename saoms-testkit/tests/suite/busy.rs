//! Providers that a test makes busy.

use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Subscription, interface};
use saoms_components::grid::Block;
use saoms_components::messages::{EVENT_LUGGAGE, EventLuggage};
use saoms_components::robot::Robot;
use saoms_testkit::{Bench, Fleet};

/// Says how high it is.
#[interface(name = "busy.Altimeter")]
pub(crate) trait Altimeter {
    /// The height, in metres.
    fn height(&mut self, context: &mut Context<'_>) -> Result<u32, Failure>;
}

#[derive(Class)]
#[class(name = "busy.Sensor", passive, service("height": Altimeter))]
struct Sensor;

impl Component for Sensor {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Sensor)
    }
}

impl Altimeter for Sensor {
    fn height(&mut self, _: &mut Context<'_>) -> Result<u32, Failure> {
        Ok(7)
    }
}

/// Asks for the height and hears luggage, in each execution.
#[derive(Class)]
#[class(name = "busy.Climber", periodic, subscribes(EVENT_LUGGAGE), reference("sensor": Altimeter))]
struct Climber {
    luggage: Subscription<EventLuggage>,
    sensor: AltimeterReference,
}

impl Component for Climber {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Climber { luggage: Subscription::default(), sensor: AltimeterReference::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.luggage = context.subscribe(&EVENT_LUGGAGE)?;
        self.sensor = context.reference("sensor")?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let height = self.sensor.height(context)?;
        let heard = context.receive(&self.luggage).count();
        context.info(format_args!("height {height}, {heard} pieces"));
        Ok(())
    }
}

#[test]
fn an_execution_is_skipped_while_the_bench_keeps_the_provider_busy() {
    let sensor = Bench::of::<Sensor>(&[]).unwrap();
    let mut climber = Bench::of::<Climber>(&[]).unwrap().wire("sensor", sensor, "height");
    climber.start().unwrap();
    climber.set_busy("sensor", true);
    climber.deliver(&EVENT_LUGGAGE, EventLuggage::request(1, Block::new(2, 1), Block::new(4, 1)));
    climber.execute().unwrap();
    climber.deliver(&EVENT_LUGGAGE, EventLuggage::request(2, Block::new(2, 1), Block::new(4, 1)));
    climber.execute().unwrap();
    assert!(climber.log().is_empty());
    climber.set_busy("sensor", false);
    climber.execute().unwrap();
    assert_eq!(climber.log(), ["height 7, 2 pieces"]);
    assert_eq!(climber.transcript().matches("skipped: component `sensor` is busy").count(), 2);
}

#[test]
#[should_panic(expected = "no provider is wired to the reference `wheels`")]
fn a_reference_without_a_wire_has_no_provider_to_be_busy() {
    Bench::of::<Robot>(&[("ID", "Robot1")]).unwrap().set_busy("wheels", true);
}

#[test]
fn a_slow_world_delays_its_robots_and_fails_none() {
    let fleet = Fleet::of_text(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet" targetNamespace="urn:fleet">
          <component name="World">
            <implementation.java class="saoms.World"/>
            <property name="ID">World</property><property name="period">100ms</property>
          </component>
          <component name="Robot1">
            <implementation.java class="saoms.Robot"/>
            <property name="ID">Robot1</property><property name="period">100ms</property>
            <reference name="world" target="World"/>
          </component>
          <component name="Environment">
            <implementation.java class="saoms.Environment"/>
            <property name="ID">Environment</property><property name="period">100ms</property>
            <property name="scenario">at 1s luggage (2,1) to (4,1)</property>
          </component>
          <component name="Master">
            <implementation.java class="saoms.MasterEnvironment"/>
            <property name="ID">Master</property><property name="period">100ms</property>
          </component></composite>"#,
    );
    let end = |fleet: &Fleet| {
        let report = fleet.run(0, Duration::from_secs(120)).into_report();
        assert_eq!(report.count("luggage.delivered"), 1, "{:?}", report.outcome);
        assert!(report.components.iter().all(|one| one.failures == 0));
        report.time_s
    };
    let quick = end(&fleet);
    let slow = end(&fleet.slow("World", Duration::from_millis(1200), Duration::from_secs(2)));
    assert!(slow > quick + 1.5, "{quick} {slow}");
}
