//! Events on a bench.

use saoms_api::{Class, Component, Context, Failure, Message, Own, Subscription, Topic};
use saoms_testkit::{Bench, comply};

/// Water in a hall.
#[derive(Clone, Debug, PartialEq, Message)]
struct Flood {
    /// Its depth in cm.
    depth: u32,
}

const FLOOD: Topic<Flood> = Topic::event("FLOOD");

/// Raises an event for each flood that it takes.
#[derive(Class)]
#[class(name = "test.Gauge", periodic)]
struct Gauge {
    /// A field of what it raises.
    #[property(default = "depth")]
    field: String,
    /// Water comes in.
    #[takes("flood", FLOOD)]
    floods: Subscription<Flood>,
}

impl Component for Gauge {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for flood in context.receive(&self.floods) {
            context.raise(&format!("flood {}={} to Cellar", self.field, flood.depth.saturating_add(1)))?;
            context.raise("siren loud=true")?;
        }
        Ok(())
    }
}

fn gauge(field: &str) -> Bench {
    let mut gauge = Bench::of::<Gauge>(&[("field", field)]).unwrap();
    gauge.start().unwrap();
    gauge.deliver(&FLOOD, Flood { depth: 4 });
    gauge
}

#[test]
fn events_that_a_component_raises_are_seen_and_reach_nobody() {
    let mut gauge = gauge("depth");
    gauge.execute().unwrap();
    assert_eq!(gauge.raised(), ["flood depth=5 to Cellar", "siren loud=true"]);
    assert!(gauge.transcript().contains("raises flood depth=5 to Cellar\n"), "{}", gauge.transcript());
    gauge.execute().unwrap();
    assert!(gauge.raised().is_empty(), "it takes the event, and hears those of the test alone");
}

#[test]
fn an_event_with_fields_that_its_class_does_not_have_is_a_failure_as_in_a_fleet() {
    let failure = gauge("dept").execute().unwrap_err().to_string();
    assert!(failure.contains("event `flood dept=5 to Cellar`: event `flood` has no field `dept`"), "{failure}");
    let failure = gauge("").execute().unwrap_err().to_string();
    assert!(failure.contains("event `flood =5 to Cellar`: "), "{failure}");
}

#[test]
fn a_component_that_raises_events_keeps_the_rules_for_all() {
    comply::<Gauge>(&[]);
}
