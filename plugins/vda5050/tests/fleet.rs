//! Robots whose hardware is a simulated vehicle at mosquitto.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, and so do its helpers")]

use std::net::{TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use saoms_api::{Class, Component, Context, Failure, info};
use saoms_components::grid::Block;
use saoms_components::hardware::{Action, Hardware, HardwareReference, Progress};
use saoms_components::messages::{EVENT_LUGGAGE, EventLuggage};
use saoms_components::robot::Robot;
use saoms_testkit::Bench;
use saoms_transport::mqtt::Mqtt;
use saoms_transport::tls::Files;
use saoms_transport::{Listener, Message, Session, Settings, Transport};
use saoms_vda5050::Vehicle;
use serde_json::{Value, json};
use tempfile::TempDir;

const MOSQUITTO: &str = "/usr/sbin/mosquitto";

/// A broker with a configuration of its own.
struct Broker {
    folder: TempDir,
    port: u16,
    running: Child,
}

impl Broker {
    /// `None` if it is not installed, and the test is to be skipped.
    #[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
    fn start() -> Option<Broker> {
        if !std::path::Path::new(MOSQUITTO).exists() {
            let missing = "mosquitto is not installed (apt-get install mosquitto)";
            assert!(std::env::var("SAOMS_PEERS").as_deref() != Ok("required"), "{missing}");
            println!("skipped: {missing}");
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
        let text = format!("user root\nlistener {port} 127.0.0.1\nallow_anonymous true\n");
        std::fs::write(folder.path().join("mosquitto.conf"), text).unwrap();
        let running = spawn(&folder, port);
        Some(Broker { folder, port, running })
    }

    fn url(&self) -> String {
        format!("mqtt://127.0.0.1:{}", self.port)
    }

    /// Kills it, and starts it again.
    fn restart(&mut self) {
        let _ = self.running.kill();
        let _ = self.running.wait();
        self.running = spawn(&self.folder, self.port);
    }
}

fn spawn(folder: &TempDir, port: u16) -> Child {
    let mut command = Command::new(MOSQUITTO);
    command.arg("-c").arg(folder.path().join("mosquitto.conf")).stdout(Stdio::null()).stderr(Stdio::null());
    let running = command.spawn().unwrap();
    let begin = Instant::now();
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        assert!(begin.elapsed() < Duration::from_secs(60), "mosquitto does not listen");
        thread::sleep(Duration::from_millis(5));
    }
    running
}

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.running.kill();
        let _ = self.running.wait();
    }
}

/// A vehicle as a manufacturer would make it: what it is told comes by its listener, and a thread drives it.
struct Simulated {
    _session: Arc<Session<Mqtt>>,
    told: Arc<Mutex<Vec<String>>>,
}

struct Ears(Mutex<mpsc::Sender<(u64, Value)>>);

impl Listener for Ears {
    fn deliver(&self, token: u64, message: Message<'_>) -> bool {
        let _ = self.0.lock().unwrap().send((token, serde_json::from_slice(message.message).unwrap()));
        true
    }

    fn link(&self, _: bool, _: &str) {}
}

const ORDER: u64 = 1;

/// What a vehicle does with an order.
enum Conduct {
    Obeys,
    Refuses,
    /// It drives until it has heard the second time that it is to stop, since the first one is lost; then it stands at
    /// this place between its nodes, where 1 is that of the target.
    Drives(f64),
}

impl Simulated {
    /// A vehicle at (0,0). `conduct` says what it does with its orders, by their numbers, from 1.
    fn start(url: &str, conduct: impl Fn(usize) -> Conduct + Send + 'static) -> Simulated {
        let (ears, heard) = mpsc::channel();
        let settings = Settings::new(url.to_owned(), None, Files::default());
        let session = Session::<Mqtt>::join(settings, Box::new(Ears(Mutex::new(ears)))).map_err(|e| e.text).unwrap();
        let session = Arc::new(session);
        for (topic, token) in [("order", ORDER), ("instantActions", 2)] {
            session.subscribe(&format!("uagv/v2/ACME/7/{topic}"), token).map_err(|e| e.text).unwrap();
        }
        let (own, told) = (Arc::clone(&session), Arc::<Mutex<Vec<String>>>::default());
        let noted = Arc::clone(&told);
        thread::spawn(move || {
            let mut state = json!({
                "headerId": 0, "version": "2.0.0", "manufacturer": "ACME", "serialNumber": "7", "orderId": "",
                "orderUpdateId": 0, "lastNodeId": "0-0", "lastNodeSequenceId": 0, "nodeStates": [], "edgeStates": [],
                "driving": false, "operatingMode": "AUTOMATIC", "actionStates": [], "errors": [],
                "batteryState": {"batteryCharge": 81.5, "charging": false},
                "agvPosition": {"x": 0.0, "y": 0.0, "theta": 0.0, "mapId": "hall", "positionInitialized": true},
            });
            let say = |state: &Value| {
                let text = serde_json::to_vec(state).unwrap();
                let _ = own.put("uagv/v2/ACME/7/state", &text, &[], false);
            };
            let (mut orders, mut drives, mut cancel) = (0, None, None);
            while let Ok((token, message)) = heard.recv() {
                if token != ORDER {
                    for action in message["actions"].as_array().unwrap() {
                        noted.lock().unwrap().push(action["actionType"].as_str().unwrap().to_owned());
                        if action["actionType"] == "cancelOrder" && drives.is_some() {
                            let Some(first) = &cancel else {
                                cancel = Some(action["actionId"].clone());
                                continue;
                            };
                            assert_eq!(first, &action["actionId"]);
                            let (x, node): (f64, Value) = drives.take().unwrap();
                            (state["nodeStates"], state["driving"]) = (json!([]), json!(false));
                            state["agvPosition"]["x"] = json!(x);
                            if x == 1.0 {
                                state["lastNodeId"] = node;
                            }
                        }
                        let done = json!({"actionId": action["actionId"], "actionStatus": "FINISHED"});
                        state["actionStates"].as_array_mut().unwrap().push(done);
                    }
                    say(&state);
                    continue;
                }
                orders += 1;
                let nodes = message["nodes"].as_array().unwrap();
                let last = nodes.last().unwrap();
                // The way begins where the vehicle is, and is one block long at most.
                assert_eq!(nodes[0]["nodeId"], state["lastNodeId"], "{message}");
                assert_eq!(
                    (nodes.len() - 1, nodes.len() - 1),
                    (message["edges"].as_array().unwrap().len(), nodes.len() - 1)
                );
                let actions = last["actions"].as_array().unwrap();
                let what = actions.first().map_or("move", |action| action["actionType"].as_str().unwrap());
                noted.lock().unwrap().push(format!("{what} {}", last["nodeId"].as_str().unwrap()));
                state["orderId"] = message["orderId"].clone();
                state["errors"] = json!([]);
                let conduct = conduct(orders);
                if matches!(conduct, Conduct::Refuses) {
                    state["errors"] = json!([{"errorType": "orderError", "errorLevel": "WARNING", "errorDescription": "no",
                        "errorReferences": [{"referenceKey": "orderId", "referenceValue": message["orderId"]}]}]);
                    say(&state);
                    continue;
                }
                (state["nodeStates"], state["driving"]) = (json!([last]), json!(nodes.len() > 1));
                say(&state);
                if let Conduct::Drives(x) = conduct {
                    drives = Some((x, last["nodeId"].clone()));
                    continue;
                }
                let finished = |action: &Value| json!({"actionId": action["actionId"], "actionStatus": "FINISHED"});
                state["actionStates"] = actions.iter().map(finished).collect();
                (state["nodeStates"], state["driving"]) = (json!([]), json!(false));
                state["lastNodeId"] = last["nodeId"].clone();
                state["agvPosition"]["x"] = last["nodePosition"]["x"].clone();
                say(&state);
            }
        });
        Simulated { _session: session, told }
    }

    fn told(&self) -> Vec<String> {
        self.told.lock().unwrap().iter().filter(|text| *text != "stateRequest").cloned().collect()
    }
}

/// A robot that begins to collect, and then to move, and asks each time once more.
#[derive(Class)]
#[class(name = "test.Caller", periodic, reference("world": Hardware))]
struct Caller {
    world: HardwareReference,
    calls: u32,
    said: Vec<Progress>,
}

impl Component for Caller {
    type Properties = ();

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.world = context.reference("world")?;
        self.world.enter(context, 1, "Caller".to_owned(), Block::new(0, 0))?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let (collect, move_to) = (Action::collect(1, Block::new(0, 0)), Action::move_to(Block::new(1, 0)));
        match self.calls {
            0 => {
                self.world.begin(context, 1, collect)?;
            }
            1 | 4 => match self.world.poll(context, 1)? {
                Progress::Running => return Ok(()),
                progress => self.said.push(progress),
            },
            2 | 5 => self.said.push(self.world.poll(context, 1)?),
            3 => {
                self.said.push(self.world.begin(context, 1, collect)?);
                self.world.begin(context, 1, move_to)?;
            }
            _ => info!(context, "heard {:?}", self.said),
        }
        self.calls += 1;
        Ok(())
    }
}

/// A robot with this vehicle, which is to carry luggage from (1,0) to (2,0).
fn robot(url: &str, patience: &str) -> Bench {
    let given = [("broker", url), ("manufacturer", "ACME"), ("serialNumber", "7"), ("patience", patience)];
    let mut vehicle = Bench::of::<Vehicle>(&given).unwrap();
    vehicle.start().unwrap();
    let robot = Bench::of::<Robot>(&[("ID", "Robot1"), ("discharge", "0")]).unwrap();
    let mut robot = robot.period(Duration::from_millis(2)).wire("world", vehicle, "hardware");
    robot.start().unwrap();
    robot.deliver(&EVENT_LUGGAGE, EventLuggage::request(1, Block::new(1, 0), Block::new(2, 0)));
    robot
}

/// Executes the robot until it has written a line with these words, in at most about a minute: all lines until then.
fn execute_until(robot: &mut Bench, words: &str) -> Vec<String> {
    let mut lines = Vec::new();
    for _ in 0..30_000 {
        robot.execute().unwrap();
        lines.extend(robot.log().iter().map(|line| (*line).to_owned()));
        if lines.iter().any(|line| line.contains(words)) {
            return lines;
        }
        thread::sleep(Duration::from_millis(2));
    }
    panic!("no `{words}` in {}", robot.transcript());
}

#[test]
fn a_vehicle_brings_the_luggage() {
    let Some(broker) = Broker::start() else { return };
    let vehicle = Simulated::start(&broker.url(), |_| Conduct::Obeys);
    let mut robot = robot(&broker.url(), "2s");
    execute_until(&mut robot, "deposited luggage 1 at (2,0)");
    robot.shutdown().unwrap();
    assert_eq!(vehicle.told(), ["move 1-0", "pick 1-0", "move 2-0", "drop 2-0"]);
}

#[test]
fn an_order_that_a_vehicle_refuses_is_given_again() {
    let Some(broker) = Broker::start() else { return };
    let conduct = |number| if number == 1 { Conduct::Refuses } else { Conduct::Obeys };
    let vehicle = Simulated::start(&broker.url(), conduct);
    let mut robot = robot(&broker.url(), "2s");
    execute_until(&mut robot, "could not move to (1,0)");
    execute_until(&mut robot, "deposited luggage 1 at (2,0)");
    robot.shutdown().unwrap();
    assert_eq!(vehicle.told()[..3], ["move 1-0", "cancelOrder", "move 1-0"]);
}

#[test]
fn a_vehicle_whose_broker_is_killed_goes_on_when_that_is_there_again() {
    let Some(mut broker) = Broker::start() else { return };
    let _vehicle = Simulated::start(&broker.url(), |_| Conduct::Obeys);
    let mut robot = robot(&broker.url(), "2s");
    execute_until(&mut robot, "collected luggage 1");
    broker.restart();
    execute_until(&mut robot, "deposited luggage 1 at (2,0)");
    robot.shutdown().unwrap();
}

/// Its robot keeps both blocks until it is known on which one it stands.
#[test]
fn a_move_that_takes_too_long_has_failed_only_when_the_vehicle_stands() {
    let Some(broker) = Broker::start() else { return };
    let conduct = |number| if number == 1 { Conduct::Drives(0.4) } else { Conduct::Obeys };
    let vehicle = Simulated::start(&broker.url(), conduct);
    let mut robot = robot(&broker.url(), "200ms");
    execute_until(&mut robot, "could not move to (1,0)");
    let told = vehicle.told();
    assert!(told[0] == "move 1-0" && told[1..].len() > 1, "{told:?}");
    assert!(told[1..].iter().all(|what| what == "cancelOrder"), "{told:?}");
    execute_until(&mut robot, "deposited luggage 1 at (2,0)");
    robot.shutdown().unwrap();
}

/// The patience is so long that only the stop ends the move, which came to its end nevertheless.
#[test]
fn a_move_that_is_stopped_from_outside_is_done_if_the_vehicle_stands_at_its_end() {
    let Some(broker) = Broker::start() else { return };
    let conduct = |number| if number == 1 { Conduct::Drives(1.0) } else { Conduct::Obeys };
    let vehicle = Simulated::start(&broker.url(), conduct);
    let mut robot = robot(&broker.url(), "10min");
    while vehicle.told().is_empty() {
        robot.execute().unwrap();
        thread::sleep(Duration::from_millis(2));
    }
    robot.stop_hardware().unwrap();
    let log = execute_until(&mut robot, "deposited luggage 1 at (2,0)");
    robot.shutdown().unwrap();
    assert!(!log.iter().any(|line| line.contains("could not")), "{log:?}");
    let mut told = vehicle.told();
    assert!(told.iter().filter(|what| *what == "cancelOrder").count() > 1, "{told:?}");
    told.dedup();
    assert_eq!(told, ["move 1-0", "cancelOrder", "pick 1-0", "move 2-0", "drop 2-0"]);
}

/// Where it stands is known to nobody before.
#[test]
fn a_robot_that_ends_waits_until_its_vehicle_stands() {
    let Some(broker) = Broker::start() else { return };
    let vehicle = Simulated::start(&broker.url(), |_| Conduct::Drives(1.0));
    let mut robot = robot(&broker.url(), "10min");
    while vehicle.told().is_empty() {
        robot.execute().unwrap();
        thread::sleep(Duration::from_millis(2));
    }
    robot.shutdown().unwrap();
    assert!(vehicle.told().iter().filter(|what| *what == "cancelOrder").count() > 1);
}

#[test]
fn a_password_leaves_this_machine_with_tls_alone() {
    let judge = |broker: &str, more: &[(&str, &str)]| {
        let given = [("broker", broker), ("manufacturer", "ACME"), ("serialNumber", "7")];
        Bench::of::<Vehicle>(&[&given[..], more].concat()).map(drop).map_err(|failure| failure.to_string())
    };
    let account = [("user", "fleet"), ("password", "$VEHICLE_PASSWORD")];
    for (broker, more, expected) in [
        ("ssl://10.0.0.5:8883", &[][..], "expected `mqtt://host:port`, or `mqtts://host:port` with TLS"),
        ("mqtt://10.0.0.5:1883", &account[..], "a password is for `mqtt://10.0.0.5:1883`, which has no TLS"),
        ("mqtt://10.0.0.5:1883", &account[..1], "`user` and `password` are given together"),
    ] {
        let found = judge(broker, more).unwrap_err();
        assert!(found.contains(expected), "{found}");
    }
    for (broker, more) in [("mqtts://10.0.0.5:8883", &account[..]), ("mqtt://localhost:1883", &account[..])] {
        assert_eq!(judge(broker, more), Ok(()), "{broker}");
    }
}

/// As one does that failed before it heard the answer.
#[test]
fn a_robot_that_asks_again_hears_how_the_action_ended() {
    let Some(broker) = Broker::start() else { return };
    let conduct = |number| if number == 1 { Conduct::Obeys } else { Conduct::Refuses };
    let vehicle = Simulated::start(&broker.url(), conduct);
    let given = [("broker", &*broker.url()), ("manufacturer", "ACME"), ("serialNumber", "7")];
    let mut hardware = Bench::of::<Vehicle>(&given).unwrap();
    hardware.start().unwrap();
    let mut caller = Bench::of::<Caller>(&[]).unwrap().wire("world", hardware, "hardware");
    caller.start().unwrap();
    let log = execute_until(&mut caller, "heard");
    assert!(log.last().unwrap().contains("heard [Done, Done, Done, Failed, Failed]"), "{log:?}");
    assert_eq!(vehicle.told()[..2], ["pick 0-0", "move 1-0"]);
}

#[test]
fn a_vehicle_that_says_nothing_does_not_start() {
    let Some(broker) = Broker::start() else { return };
    let given = [("broker", &*broker.url()), ("manufacturer", "ACME"), ("serialNumber", "7")];
    let mut vehicle = Bench::of::<Vehicle>(&given).unwrap();
    vehicle.start().unwrap();
    let mut robot = Bench::of::<Robot>(&[("ID", "Robot1")]).unwrap().wire("world", vehicle, "hardware");
    let failure = robot.start().unwrap_err();
    assert!(failure.to_string().contains("vehicle ACME/7 cannot be reached at"), "{failure}");
}
