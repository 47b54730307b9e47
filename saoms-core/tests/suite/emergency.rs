//! Emergency stops and releases.

use std::sync::{Arc, mpsc};
use std::thread;
use std::time::Duration;

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Own, Time};
use saoms_core::schedule::{ChangeOptions, Order, RunningFleet};
use saoms_lang::registry::Registry;

use crate::fleet::{Diary, assembly_of, real, simulated};
use crate::stop::{Wheel, Wire, start};

fn stop(components: &[&str]) -> Order {
    let components = components.iter().map(|path| (*path).to_owned()).collect();
    Order::EmergencyStop { components, by: Some("ada".to_owned()) }
}

fn release() -> Order {
    Order::Release { components: Vec::new(), by: None }
}

fn give(fleet: &RunningFleet, order: Order) -> String {
    fleet.handle().order(order, None).unwrap().wait(Duration::from_secs(10)).unwrap().to_string()
}

#[test]
fn hardware_stops_at_once_hears_nothing_and_goes_on_after_the_release() {
    let (fleet, wire, diary) =
        start("estop", "A wheel period=10 wire=@\nB actor period=10 each=[number]", simulated(90));
    let fleet = fleet.unwrap();
    fleet.run_until(Time::from_nanos(30_000_000));
    assert_eq!((wire.count("alive for 10ms"), wire.count("stop")), (3, 0));
    assert_eq!(give(&fleet, stop(&[])), "[\"A\"]", "B moves nothing");
    wire.wait_for("stop");
    fleet.run_until(Time::from_nanos(60_000_000));
    assert_eq!(wire.count("alive for 10ms"), 3);
    assert!(fleet.handle().status().components[0].emergency_stop);
    assert_eq!(give(&fleet, release()), "[\"A\"]");
    fleet.run_until(Time::from_nanos(90_000_000));
    assert_eq!(wire.count("alive for 10ms"), 6);
    let report = fleet.run_to_end();
    let a = &report.components[0];
    assert_eq!((a.executions, a.missed), (6, 0), "what was left out is not missed");
    assert_eq!(report.components[1].executions, 9);
    let told = diary.lines();
    assert!(told.contains("emergency stop by ada: A") && told.contains("release: A"), "{told}");
    let journal = serde_json::to_string(&report.journal).unwrap();
    assert!(journal.contains("\"estop by ada\"") && journal.contains("\"release\""), "{journal}");
}

#[test]
fn hardware_stops_while_its_code_hangs_and_once_more_when_it_returns() {
    // Too slow to be stopped since it hangs.
    let (fleet, wire, _) = start("estop-hang", "A wheel period=60s wire=@ work=hang interrupt=true", real(60_000));
    let fleet = fleet.unwrap();
    wire.wait_for("hangs");
    assert_eq!(wire.count("stop"), 0);
    assert_eq!(give(&fleet, stop(&["A"])), "[\"A\"]");
    wire.wait_for("stop");
    fleet.handle().unschedule("A").unwrap();
    while wire.count("stop") < 2 {
        thread::sleep(Duration::from_millis(1));
    }
    fleet.handle().stop();
    fleet.run_to_end();
}

#[test]
fn hardware_stops_while_a_service_that_its_component_calls_hangs() {
    let (fleet, wire, _) = start(
        "estop-call",
        "D arm wire=@ work=hang\nA actor period=60s peer=D each=[ask it] interrupt=true",
        real(60_000),
    );
    let fleet = fleet.unwrap();
    wire.wait_for("hangs");
    assert_eq!(give(&fleet, stop(&[])), "[\"A\"]", "it is wired to hardware");
    wire.wait_for("stop");
    fleet.handle().stop();
    fleet.run_to_end();
}

/// Initializes when it is let go on.
#[derive(Class)]
#[class(name = "late", periodic)]
struct Late {}

impl Component for Late {
    type Properties = ();

    fn initialize(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
        Wire::of("late").hear("initializes");
        Wire::of("late").wait_for("go on");
        Ok(())
    }
}

/// Says in each execution whether it is stopped.
#[derive(Class)]
#[class(name = "listener", periodic)]
struct Listener {
    /// True if it is stopped.
    #[property(default = false, live)]
    stopped: bool,
}

impl Component for Listener {
    type Properties = Own<Self>;

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        context.info(if self.stopped { "is stopped" } else { "moves" });
        Ok(())
    }
}

fn assembly(text: &str) -> saoms_lang::assembly::Assembly {
    let mut registry = Registry::new();
    for class in [Registration::of::<Late>(), Registration::of::<Listener>(), Registration::of::<Wheel>()] {
        registry.add(class).unwrap();
    }
    assembly_of(text, &registry)
}

#[test]
fn hardware_stops_while_another_component_hangs_in_its_initialization() {
    let wire = Wire::of("estop-start");
    let assembly = assembly("A wheel period=10 wire=estop-start\nB late period=10");
    let (handles, handle) = mpsc::channel();
    let starting = thread::spawn(move || {
        RunningFleet::start_with(assembly, real(60_000), Vec::new(), |handle| {
            handles.send(handle.clone()).unwrap();
            Ok(())
        })
        .unwrap()
    });
    let handle = handle.recv().unwrap();
    Wire::of("late").wait_for("initializes");
    handle.order(stop(&[]), None).unwrap().wait(Duration::from_secs(10)).unwrap();
    wire.wait_for("stop");
    Wire::of("late").hear("go on");
    let fleet = starting.join().unwrap();
    while fleet.handle().progress().periods < 10 {
        thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(wire.count("alive for 10ms"), 0, "it starts stopped");
    give(&fleet, release());
    wire.wait_for("alive for 10ms");
    fleet.handle().stop();
    fleet.run_to_end();
}

#[test]
fn a_component_that_hears_of_it_goes_on_also_after_a_change_of_the_fleet() {
    let diary = Arc::new(Diary::default());
    let text = "A listener period=10\nB listener period=10 delay=5";
    let fleet = RunningFleet::start(assembly(text), simulated(70), vec![diary.clone()]).unwrap();
    fleet.run_until(Time::from_nanos(10_000_000));
    assert_eq!(give(&fleet, stop(&["A"])), "[\"A\"]");
    fleet.run_until(Time::from_nanos(30_000_000));
    let wanted = assembly("A listener period=10 deadline=9\nB listener period=10 delay=5");
    fleet.handle().apply(&wanted, ChangeOptions::allowing_loss()).unwrap();
    fleet.run_until(Time::from_nanos(50_000_000));
    give(&fleet, release());
    fleet.run_to_end();
    let of_a = diary.lines().lines().filter(|line| line.contains(" A: ")).map(str::to_owned).collect::<Vec<_>>();
    let of_a: Vec<&str> = of_a
        .iter()
        .map(String::as_str)
        .filter(|line| line.contains("s moves") || line.contains("stopped") || line.ends_with("moves"))
        .collect();
    assert_eq!(
        of_a,
        [
            "[0.000 s] A: moves", "[0.010 s] A: is stopped", "[0.020 s] A: is stopped", "[0.030 s] A: is stopped",
            "[0.040 s] A: is stopped", "[0.050 s] A: moves", "[0.060 s] A: moves",
        ]
    );
}

#[test]
fn stops_of_unknown_components_are_refused() {
    let (fleet, wire, _) = start("estop-none", "A wheel period=10 wire=@", simulated(50));
    let fleet = fleet.unwrap();
    let refused = fleet.handle().order(stop(&["A", "Bb"]), None).unwrap_err().to_string();
    assert!(refused.starts_with("the fleet has no component `Bb`"), "{refused}");
    assert_eq!(wire.count("stop"), 0);
    fleet.run_to_end();
}
