//! Shipped robots with hardware that no program takes back: after kills at random moments nothing was done twice,
//! nothing was lost, and no robot has entered a block where another one was.
//!
//! The hardware notes outside of the program what it does, and goes on while there is no program. It knows what became
//! of an action, or does not: then somebody looks at it, and says so.

mod yard;

use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::event::fault::FaultCall;
use saoms_core::observe::{Interest, Observer, Occurrence, RunEvent};
use saoms_core::schedule::{Order, RunningFleet, Settings};
use saoms_core::store::Store;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use serde_json::json;

use yard::Yard;

use crate::support::Program;

/// The folder of a program that is killed; without it, this is no such program.
pub(super) const FOLDER: &str = "SAOMS_TEST_MACHINES";
/// True if the hardware does not know what became of its last action.
pub(super) const FORGETS: &str = "SAOMS_TEST_MACHINES_FORGET";
/// A number from which follows when components crash; without it, none does.
const CRASHES: &str = "SAOMS_TEST_MACHINES_CRASHES";
/// Number of kills, unless `SAOMS_KILLS` says another one.
const KILLS: u64 = 15;
/// Components that crash.
const CRASHING: [&str; 6] = ["Robot1", "Robot2", "Robot3", "Zone", "Master", "Environment"];
/// Number of pieces for each kill.
const PIECES: u64 = 2;
/// Time within which another piece is brought after the last kill, and time after which no program is left.
const PATIENCE: Duration = Duration::from_secs(30);
const LONG: Duration = Duration::from_secs(3600);

/// A fleet with a zone and this number of pieces.
fn fleet(pieces: u64, restart: bool) -> String {
    let restart = if restart { r#"<property name="restart">onFailure</property>"# } else { "" };
    let component = |id: &str, class: &str, more: &str| {
        format!(
            r#"<component name="{id}"><implementation.rust class="{class}"/><property name="ID">{id}</property>
            <property name="period">10</property>{restart}{more}</component>"#
        )
    };
    let world = r#"<reference name="world" target="Yard"/>"#;
    let mut components = r#"<component name="Yard"><implementation.rust class="test.Yard"/></component>"#.to_owned();
    components += &component("Zone", "saoms.Zone", world);
    components += &component("Master", "saoms.MasterEnvironment", "");
    let scenario =
        format!(r#"<property name="scenario">at 0.1s {pieces} times luggage (0,0)..(4,4) to (0,0)..(4,4)</property>"#);
    components += &component("Environment", "saoms.Environment", &scenario);
    for (robot, x, y) in [("Robot1", 0, 0), ("Robot2", 4, 0), ("Robot3", 0, 4)] {
        let place = [("chargeX", x.to_string()), ("chargeY", y.to_string()), ("discharge", "0.01".to_owned())];
        let place: String =
            place.iter().map(|(name, value)| format!(r#"<property name="{name}">{value}</property>"#)).collect();
        components += &component(robot, "saoms.Robot", &(place + world));
    }
    format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
        {components}</composite>"#
    )
}

/// The robots that ask what became of an action, each with what it asks.
#[derive(Default)]
struct Questions(Mutex<Vec<(String, String)>>);

impl Observer for Questions {
    #[expect(clippy::print_stderr, reason = "the program that kills this one counts crashes by these lines")]
    fn event(&self, event: &RunEvent) {
        if let (Some(component), Occurrence::Alert { kind, text: Some(text), .. }) = (&event.component, &event.what)
            && &**kind == "open_action"
        {
            self.0.lock().unwrap().push((component.to_string(), text.clone()));
        }
        if let Occurrence::Failed { message, .. } = &event.what {
            eprintln!("{message}");
        }
    }

    fn interest(&self) -> Interest {
        Interest::NONE
    }
}

/// The program that is killed, with the person who answers robots.
#[test]
fn program_that_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let folder = Path::new(&folder);
    let pieces = std::fs::read_to_string(folder.join("pieces")).unwrap().parse().unwrap();
    let seed = std::env::var(CRASHES).ok().and_then(|seed| seed.parse().ok());
    let project = Project::new().text("f.composite", fleet(pieces, seed.is_some()));
    let compilation = project.compile(&Registry::linked().unwrap());
    let assembly = compilation.output.unwrap_or_else(|| panic!("{:?}", compilation.diagnostics));
    let questions: Arc<Questions> = Arc::default();
    let store = Store::open(&folder.join("state")).unwrap();
    let settings = Settings { limit: Some(LONG), ..Settings::default() };
    let fleet = RunningFleet::start_with(assembly, settings, vec![questions.clone()], |handle| handle.use_store(store))
        .unwrap();
    let until = Instant::now() + LONG;
    let mut chance = seed.map(|seed| saoms_api::Chance::for_component(seed, "crashes"));
    // One after the other: who crashes twice before it has executed loses what it heard.
    let mut crashing = CRASHING.iter().cycle().skip(seed.unwrap_or_default() as usize);
    while Instant::now() < until {
        if let Some(chance) = &mut chance
            && chance.below(40) == 0
        {
            let who = crashing.next().unwrap();
            let crash = FaultCall::read(&format!("crash {who} restart {}ms", 1 + chance.below(40))).unwrap();
            // Once all is done, nothing crashes any more.
            let _ = fleet.handle().disturb("", &crash, None, "it crashes".to_owned());
        }
        questions.0.lock().unwrap().retain(|(robot, text)| {
            let Some(done) = Yard::look(&folder.join("noted"), robot, text) else { return true };
            let (component, operation) = (robot.clone(), "settle".to_owned());
            let arguments = vec![("done".to_owned(), json!(done))];
            let order = Order::Call { component, operation, arguments };
            let is_heard = fleet.handle().order(order, None).unwrap().wait(Duration::from_secs(5)).is_ok();
            if is_heard {
                let mut answers = OpenOptions::new().create(true).append(true).open(folder.join("answers")).unwrap();
                writeln!(answers, "{robot} {done}").unwrap();
            }
            !is_heard
        });
        sleep(Duration::from_millis(2));
    }
}

fn kill_at_random_moments(forgets: bool, crashes: bool) {
    let folder = tempfile::tempdir().unwrap();
    let kills = std::env::var("SAOMS_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(KILLS);
    std::fs::write(folder.path().join("pieces"), (kills * PIECES).to_string()).unwrap();
    let noted = folder.path().join("noted");
    let mut chance = saoms_api::Chance::for_component(kills, "kills");
    let mut has_crashed = false;
    for kill in 0..=kills {
        let mut program = Command::new(std::env::current_exe().unwrap());
        program.args(["--exact", "fleets::machines::program_that_is_killed", "--nocapture"]);
        program.env(FOLDER, folder.path()).env(FORGETS, forgets.to_string());
        if crashes {
            program.env(CRASHES, kill.to_string());
        }
        let told = std::fs::File::create(folder.path().join("told")).unwrap();
        let mut program = Program(program.stdout(Stdio::null()).stderr(told).spawn().unwrap());
        let before = yard::deposits(&noted);
        if kill < kills {
            sleep(Duration::from_millis(80 + chance.below(500)));
        } else {
            let mut last = (before, Instant::now());
            while last.0 < kills * PIECES && last.1.elapsed() < PATIENCE {
                sleep(Duration::from_millis(50));
                let now = yard::deposits(&noted);
                last = if now > last.0 { (now, Instant::now()) } else { last };
            }
        }
        let ended = program.0.try_wait().unwrap();
        drop(program);
        let told = std::fs::read_to_string(folder.path().join("told")).unwrap();
        assert_eq!(ended, None, "kill {kill}, {before} deposits: {told}");
        has_crashed |= told.contains("it crashes by fault injection");
        yard::check(&noted);
    }
    assert_eq!(yard::deposits(&noted), kills * PIECES, "all is delivered, each piece once");
    assert_eq!(has_crashed, crashes);
    let answers = std::fs::read_to_string(folder.path().join("answers")).unwrap_or_default();
    assert_eq!(answers.contains("true") && answers.contains("false"), forgets, "{answers}");
}

#[test]
fn hardware_that_knows_what_became_of_its_actions_does_nothing_twice() {
    kill_at_random_moments(false, false);
}

#[test]
fn hardware_that_a_person_looks_at_does_nothing_twice() {
    kill_at_random_moments(true, false);
}

#[test]
fn hardware_of_robots_that_crash_does_nothing_twice() {
    kill_at_random_moments(false, true);
}
