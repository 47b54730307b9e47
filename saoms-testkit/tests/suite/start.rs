//! Fleets that do not start.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure};
use saoms_testkit::Fleet;

/// Opens a port that may be taken.
#[derive(Class)]
#[class(name = "start.Port", passive)]
struct Port;

#[derive(saoms_api::Properties)]
struct PortProperties {
    /// The number of the port.
    number: u32,
}

/// Remembers whether its port is free.
#[derive(Class)]
#[class(name = "start.Server", periodic)]
struct Server {
    number: u32,
}

impl Component for Port {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Port)
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.info(format_args!("opens"));
        Ok(())
    }

    fn shutdown(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.info(format_args!("closes"));
        Ok(())
    }
}

impl Component for Server {
    type Properties = PortProperties;

    fn new(properties: PortProperties) -> Result<Self, Failure> {
        Ok(Server { number: properties.number })
    }

    fn initialize(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        match self.number {
            0 => Err("port 0 is taken".into()),
            _ => Ok(()),
        }
    }
}

fn fleet(port: &str) -> Fleet {
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="fleet" targetNamespace="urn:fleet">
          <component name="Port"><implementation.rust class="start.Port"/></component>
          <component name="Server"><implementation.rust class="start.Server"/>
            <property name="ID" value="Server"/><property name="period" value="100ms"/>
            <property name="number" value="{port}"/>
          </component></composite>"#
    ))
}

/// The message with which a test fails.
fn failure(test: impl FnOnce()) -> String {
    let cause = catch_unwind(AssertUnwindSafe(test)).unwrap_err();
    cause.downcast_ref::<String>().unwrap().clone()
}

#[test]
fn a_fleet_is_held_to_not_starting() {
    fleet("0").expect_not_started("Server", "port 0 is taken");
    let found = fleet("0").try_run(0, Duration::from_secs(1)).unwrap_err();
    assert_eq!((found.component(), found.failure().unwrap().to_string().as_str()), (Some("Server"), "port 0 is taken"));
    assert_eq!(found.to_string(), "component `Server` of class `start.Server` could not start: port 0 is taken");
    assert!(found.log().contains("Port: opens") && found.log().contains("Port: closes"), "{}", found.log());
    assert!(fleet("1").try_run(0, Duration::from_secs(1)).is_ok());
}

#[test]
fn another_reason_is_told() {
    let told = failure(|| fleet("1").expect_not_started("Server", "taken"));
    assert_eq!(told, "the fleet starts, expected that `Server` does not: taken");
    let told = failure(|| fleet("0").expect_not_started("Port", "taken"));
    assert!(told.contains("expected that `Port` does not start") && told.ends_with("port 0 is taken"), "{told}");
    let told = failure(|| fleet("x").expect_not_started("Server", "taken"));
    assert!(told.contains("S3007") && told.contains("`x`"), "its mistakes are shown: {told}");
    let found = fleet("x").try_run(0, Duration::from_secs(1)).unwrap_err();
    assert!(found.component().is_none() && found.failure().is_none());
}
