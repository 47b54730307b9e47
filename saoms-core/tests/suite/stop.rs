//! Functions that stop hardware: when they are called, and what becomes of one that fails or hangs.

use std::collections::HashMap;
use std::sync::{Arc, Condvar, LazyLock, Mutex};
use std::thread;
use std::time::Duration;

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Properties, StopFunction};
use saoms_core::observe::Occurrence;
use saoms_core::schedule::{RunningFleet, Settings, stop_hardware};
use saoms_lang::registry::Registry;

use crate::actor::{Actor, Callee, Echo, EchoReference};
use crate::fleet::{Diary, assembly_of, outcome, real, simulated};

/// What hardware of a name heard.
#[derive(Default)]
pub(crate) struct Wire {
    heard: Mutex<Vec<String>>,
    news: Condvar,
}

impl Wire {
    pub(crate) fn of(name: &str) -> Arc<Wire> {
        static ALL: LazyLock<Mutex<HashMap<String, Arc<Wire>>>> = LazyLock::new(Mutex::default);
        Arc::clone(ALL.lock().unwrap().entry(name.to_owned()).or_default())
    }

    pub(crate) fn hear(&self, what: impl Into<String>) {
        self.heard.lock().unwrap().push(what.into());
        self.news.notify_all();
    }

    fn heard(&self) -> Vec<String> {
        self.heard.lock().unwrap().clone()
    }

    pub(crate) fn count(&self, what: &str) -> usize {
        self.heard().iter().filter(|heard| *heard == what).count()
    }

    /// Waits until it has heard this, for ten seconds at most.
    pub(crate) fn wait_for(&self, what: &str) {
        let missing = |heard: &mut Vec<String>| !heard.iter().any(|heard| heard == what);
        let waited = self.news.wait_timeout_while(self.heard.lock().unwrap(), Duration::from_secs(10), missing);
        assert!(!waited.unwrap().1.timed_out(), "{what} was never heard");
    }
}

#[derive(Clone, Properties)]
pub(crate) struct MotorProperties {
    /// Name of the hardware.
    wire: String,
    /// Work of an execution or a call: nothing, `fail`, `panic` or `hang`.
    #[property(default = "")]
    work: String,
    /// Work of the function that stops: nothing, `fail`, `hang` or `panic in the heartbeat`.
    #[property(default = "")]
    stop: String,
}

pub(crate) struct Motor {
    properties: MotorProperties,
    peer: EchoReference,
}

impl Motor {
    fn begin(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if self.properties.stop == "none" {
            return Ok(());
        }
        let (wire, of_beat) = (Wire::of(&self.properties.wire), Wire::of(&self.properties.wire));
        let stop = self.properties.stop.clone();
        let function = StopFunction::new(move || {
            wire.hear("stop");
            match stop.as_str() {
                "fail" => Err("the line is dead".into()),
                "hang" => {
                    wire.wait_for("never");
                    Ok(())
                }
                _ => Ok(()),
            }
        });
        let panics = self.properties.stop == "panic in the heartbeat";
        context.register_stop(function.with_heartbeat(move |period| {
            assert!(!panics, "the line is dead");
            of_beat.hear(format!("alive for {period:?}"));
        }))
    }

    fn work(&mut self, context: &Context<'_>) -> Result<(), Failure> {
        let wire = Wire::of(&self.properties.wire);
        match self.properties.work.as_str() {
            "fail" => Err("it is broken".into()),
            "panic" => panic!("it is broken"),
            "hang" => {
                wire.hear("hangs");
                while !context.cancelled() {
                    thread::sleep(Duration::from_millis(1));
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }
}

macro_rules! motor {
    ($name:ident, $($class:tt)*) => {
        #[derive(Class)]
        #[class($($class)*)]
        pub(crate) struct $name(Motor);

        impl Component for $name {
            type Properties = MotorProperties;

            fn new(properties: MotorProperties) -> Result<Self, Failure> {
                Ok($name(Motor { properties, peer: EchoReference::default() }))
            }

            fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                self.0.peer = context.reference("peer")?;
                self.0.begin(context)
            }

            fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
                self.0.work(context)
            }

            fn shutdown(&mut self, _: &mut Context<'_>) -> Result<(), Failure> {
                Wire::of(&self.0.properties.wire).hear("shutdown");
                Ok(())
            }
        }

        impl Echo for $name {
            fn echo(&mut self, context: &mut Context<'_>, text: String) -> Result<String, Failure> {
                self.0.work(context)?;
                Ok(text)
            }
        }
    };
}

motor!(Wheel, name = "wheel", periodic, stops, service("echo": Echo), reference("peer": Echo, optional));
motor!(Arm, name = "arm", passive, stops, service("echo": Echo), reference("peer": Echo, optional));
motor!(Undeclared, name = "undeclared", periodic, service("echo": Echo), reference("peer": Echo, optional));

/// Starts a fleet in which `@` stands for the name of the wire.
pub(crate) fn start(
    wire: &str,
    fleet: &str,
    settings: Settings,
) -> (Result<RunningFleet, String>, Arc<Wire>, Arc<Diary>) {
    let mut registry = Registry::new();
    for class in [
        Registration::of::<Actor>(),
        Registration::of::<Callee>(),
        Registration::of::<Wheel>(),
        Registration::of::<Arm>(),
        Registration::of::<Undeclared>(),
    ] {
        registry.add(class).unwrap();
    }
    let diary = Arc::new(Diary::default());
    let assembly = assembly_of(&fleet.replace('@', wire), &registry);
    let fleet = RunningFleet::start(assembly, settings, vec![diary.clone()]);
    (fleet.map_err(|error| error.to_string()), Wire::of(wire), diary)
}

/// Runs such a fleet to its end; gives its outcome and what the hardware heard.
fn run(wire: &str, fleet: &str, settings: Settings) -> (String, Arc<Wire>) {
    let (fleet, wire, _) = start(wire, fleet, settings);
    (outcome(&fleet.unwrap().run_to_end()), wire)
}

#[test]
fn hardware_hears_a_heartbeat_of_each_execution_and_is_stopped_before_the_shutdown() {
    let (told, wire) = run("beat", "A wheel period=10 wire=@", simulated(30));
    assert_eq!(told, "Elapsed after 0.03 s");
    let heard = wire.heard();
    assert_eq!(heard[..3], ["alive for 10ms", "alive for 10ms", "alive for 10ms"]);
    assert!(heard.contains(&"stop".to_owned()) && heard.contains(&"shutdown".to_owned()), "{heard:?}");
}

#[test]
fn hardware_of_a_component_that_fails_or_panics_is_stopped() {
    for work in ["fail", "panic"] {
        let wire = format!("broken-{work}");
        let fleet = format!("A wheel period=10 wire=@ work={work}\nB actor period=10");
        let (told, wire) = run(&wire, &fleet, simulated(30));
        assert!(told.starts_with("Failed"), "{told}");
        assert!(wire.count("stop") >= 1 && wire.count("alive for 10ms") == 0, "{:?}", wire.heard());
    }
}

#[test]
fn a_heartbeat_that_panics_fails_who_executes() {
    for fleet in [
        "A wheel period=10 wire=@ stop=[panic in the heartbeat]",
        "A actor period=10 peer=D\nD arm wire=@ stop=[panic in the heartbeat]",
    ] {
        let (told, wire) = run("silent", fleet, simulated(30));
        assert!(told.starts_with("Failed") && told.contains("`A` failed: the heartbeat of the hardware of"), "{told}");
        assert!(told.contains("the line is dead") && wire.count("stop") >= 1, "{told}");
    }
}

#[test]
fn hardware_is_stopped_when_the_last_component_that_uses_it_fails() {
    let one = "D arm wire=@\nA actor period=10 peer=D each=[2: fail]\nB actor period=10 peer=D each=[]";
    let (fleet, wire, _) = start("shared", one, real(60_000));
    let fleet = fleet.unwrap();
    wire.wait_for("alive for 10ms");
    while fleet.handle().progress().periods < 100 {
        thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(wire.count("stop"), 0, "another component uses it");
    fleet.handle().unschedule("B").unwrap();
    wire.wait_for("stop");
    fleet.handle().stop();
    fleet.run_to_end();
}

#[test]
fn hardware_of_code_that_hangs_is_stopped_while_it_hangs() {
    let (fleet, wire, diary) = start("hang", "A wheel period=10 wire=@ work=hang", real(60_000));
    let fleet = fleet.unwrap();
    wire.wait_for("hangs");
    wire.wait_for("stop");
    fleet.handle().stop();
    let report = fleet.run_to_end();
    assert_eq!(diary.count(|event| matches!(event.what, Occurrence::Hangs { .. })), 1, "{}", diary.lines());
    assert_eq!(report.outcome.reasons, Vec::<String>::new());
}

#[test]
fn a_service_that_hangs_is_stopped_as_its_caller_is() {
    let fleet = "D arm wire=@ work=hang\nA actor period=10 peer=D each=[ask it]";
    let (fleet, wire, diary) = start("service", fleet, real(60_000));
    let fleet = fleet.unwrap();
    wire.wait_for("hangs");
    wire.wait_for("stop");
    fleet.handle().stop();
    fleet.run_to_end();
    let hangs = diary.lines();
    assert!(hangs.contains("A: has not returned for") && hangs.contains("its hardware is stopped"), "{hangs}");
}

#[test]
fn a_stop_that_fails_or_hangs_fails_the_run() {
    let (told, _) = run("dead", "A wheel period=10 wire=@ stop=fail", simulated(20));
    let expected = "Failed after 0.02 s\n- component `A` could not stop its hardware: the line is dead";
    assert!(told.starts_with(expected), "{told}");
    let settings = Settings { grace: Duration::from_millis(50), ..simulated(20) };
    let (told, _) = run("stuck", "A wheel period=10 wire=@ stop=hang\nB wheel period=10 wire=stuck-too", settings);
    let expected = "component `A` could not stop its hardware: the function that stops it has not returned";
    assert!(told.contains(expected), "{told}");
    assert!(Wire::of("stuck-too").count("stop") >= 1, "one that hangs holds up no other");
}

#[test]
fn a_process_that_ends_at_once_stops_all_hardware() {
    let (fleet, wire, _) = start("exit", "A wheel period=10 wire=@", real(60_000));
    let fleet = fleet.unwrap();
    assert_eq!(stop_hardware(Duration::from_secs(10)), Vec::<String>::new());
    assert!(wire.count("stop") >= 1);
    fleet.handle().stop();
    fleet.run_to_end();
}

#[test]
fn a_class_registers_what_it_declares_and_nothing_else() {
    let refused = |wire, fleet| start(wire, fleet, simulated(10)).0.err().unwrap();
    let told = refused("none", "A wheel wire=@ stop=none");
    assert!(told.contains("declares that it `stops` its hardware, but `initialize` registered no function"), "{told}");
    let told = refused("undeclared", "A undeclared wire=@");
    assert!(told.contains("class `undeclared` does not declare that it stops hardware: write `stops`"), "{told}");
}
