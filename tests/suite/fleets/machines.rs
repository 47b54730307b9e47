//! A recorder outside of the program notes what was answered "accepted" and what the hardware did, while the program is
//! killed at random moments under load. After each restart both are compared with what the fleet knows: nothing
//! accepted is lost, nothing is done twice, and no robot has entered a block where another one was.
//!
//! The hardware is a plugin that notes what it does in a file, and goes on while there is no program. It knows what
//! became of an action, or does not: then somebody looks at it, and says so. `SAOMS_KILLS=1000` makes long tests.

#[path = "../../plugins/yard/src/note.rs"]
mod note;
mod notes;

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

use saoms_api::Chance;
use saoms_components::grid::Block;
use serde_json::{Value, json};

use crate::boundary::build::library;
use crate::support::{PATIENCE, Program, ask, command, empty_folder, send};

/// Number of kills, unless `SAOMS_KILLS` says another one.
const KILLS: u64 = 10;
/// Components that crash.
const CRASHING: [&str; 6] = ["Robot1", "Robot2", "Robot3", "Zone", "Master", "Environment"];
/// Most pieces that are open at once, so that the robots keep up.
const MOST_OPEN: usize = 6;
/// Width and height of the yard, in blocks.
const SIDE: i32 = 5;

/// A fleet with a zone, whose hardware notes what it does in `noted`.
fn fleet(forgets: bool, restart: bool) -> String {
    let restart = if restart { r#"<property name="restart">onFailure</property>"# } else { "" };
    let component = |id: &str, class: &str, more: &str| {
        format!(
            r#"<component name="{id}"><implementation.rust class="{class}"/><property name="ID">{id}</property>
            <property name="period">10</property>{restart}{more}</component>"#
        )
    };
    let world = r#"<reference name="world" target="Yard"/>"#;
    let mut components = format!(
        r#"<component name="Yard"><implementation.rust class="test.Yard"/><property name="notes">noted</property>
        <property name="forgets">{forgets}</property></component>"#
    );
    components += &component("Zone", "saoms.Zone", world);
    components += &component("Master", "saoms.MasterEnvironment", "");
    components += &component("Environment", "saoms.Environment", "");
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

/// Numbers of pieces by their routes.
type Routes = BTreeMap<String, u64>;

/// The recorder outside of the program.
struct Recorder {
    folder: PathBuf,
    chance: Chance,
    /// The requests that were answered "accepted".
    accepted: Routes,
    /// Those that were sent without an answer before a kill: these may be there.
    unanswered: Routes,
    /// What a person said of open actions.
    answers: Vec<bool>,
}

impl Recorder {
    fn new(folder: PathBuf) -> Recorder {
        let chance = Chance::for_component(1, "kills");
        Recorder { folder, chance, accepted: Routes::new(), unanswered: Routes::new(), answers: Vec::new() }
    }

    fn noted(&self) -> PathBuf {
        self.folder.join("noted")
    }

    fn socket(&self) -> PathBuf {
        self.folder.join("socket")
    }

    fn start(&self) -> Program {
        let _ = fs::remove_file(self.socket());
        let told = fs::File::create(self.folder.join("told")).unwrap();
        let mut run = command(&["run", "f.composite", "--state", "state", "--stay", "--control", "socket", "--plugin"]);
        run.arg(library("yard")).current_dir(&self.folder);
        Program(run.stdout(told.try_clone().unwrap()).stderr(told).spawn().unwrap())
    }

    fn told(&self) -> String {
        fs::read_to_string(self.folder.join("told")).unwrap()
    }

    /// The pieces that the fleet knows and those that were brought, by their numbers; `None` before the fleet answers.
    fn known(&self) -> Option<BTreeMap<u32, String>> {
        let status = ask(&self.socket(), "GET", "/v1/status", "").ok()?;
        let components = status["status"]["components"].as_array()?;
        let master = components.iter().find(|one| one["name"] == "Master")?;
        let block = |value: &Value| Some(Block { x: coordinate(&value[0])?, y: coordinate(&value[1])? });
        let mut known = BTreeMap::new();
        for piece in master["values"]["luggage"].as_array()? {
            let number = u32::try_from(piece["luggage"].as_u64()?).unwrap();
            known.insert(number, notes::route(block(&piece["from"])?, block(&piece["to"])?));
        }
        known.extend(notes::deposited(&self.noted()));
        Some(known)
    }

    /// Number of pieces of each route that were sent, and those of which the fleet knows.
    fn compare(&self, known: &BTreeMap<u32, String>, told: &str) -> bool {
        let mut routes = Routes::new();
        known.values().for_each(|route| *routes.entry(route.clone()).or_default() += 1);
        for (route, count) in &routes {
            let of = |pieces: &Routes| pieces.get(route).copied().unwrap_or_default();
            let most = of(&self.accepted) + of(&self.unanswered);
            assert!(*count <= most, "{count} pieces {route}, {most} were sent: {known:?}, {told}");
        }
        self.accepted.iter().all(|(route, count)| routes.get(route).is_some_and(|there| there >= count))
    }

    /// Waits until the fleet knows all that was accepted, and checks that it knows of nothing else.
    fn wait_for_accepted(&mut self, program: &mut Program) {
        let until = Instant::now() + PATIENCE;
        loop {
            assert_eq!(program.0.try_wait().unwrap(), None, "it ended: {}", self.told());
            let known = self.known();
            if known.as_ref().is_some_and(|known| self.compare(known, &self.told())) {
                return;
            }
            assert!(Instant::now() < until, "{known:?} of {:?} are there: {}", self.accepted, self.told());
            self.answer_questions();
            sleep(Duration::from_millis(20));
        }
    }

    /// Says what became of the actions of which robots ask.
    fn answer_questions(&mut self) {
        let Ok(alerts) = ask(&self.socket(), "GET", "/v1/alerts", "") else { return };
        let all = alerts.as_array().or(alerts["alerts"].as_array()).unwrap();
        for alert in all.iter().filter(|alert| alert["kind"] == "open_action" && alert["over_s"].is_null()) {
            let [robot, question] = ["component", "text"].map(|field| alert[field].as_str().unwrap());
            let Some(done) = notes::look(&self.noted(), robot, question) else { continue };
            let operation = format!("/v1/components/{robot}/operations/settle");
            if ask(&self.socket(), "POST", &operation, &json!({"done": done}).to_string()).is_ok() {
                self.answers.push(done);
            }
        }
    }

    /// A route from one block to another one.
    fn route(&mut self) -> String {
        let mut below = |end: i32| i32::try_from(self.chance.below(u64::from(end.unsigned_abs()))).unwrap();
        let [from, on] = [below(SIDE * SIDE), 1 + below(SIDE * SIDE - 1)];
        let block = |place: i32| Block { x: place % SIDE, y: place / SIDE };
        notes::route(block(from), block((from + on) % (SIDE * SIDE)))
    }

    /// Sends requests until a moment, and lets components crash if it says which.
    fn work(&mut self, until: Instant, mut crashing: Option<&mut dyn Iterator<Item = &&'static str>>) {
        while Instant::now() < until {
            let sent: u64 = self.accepted.values().sum();
            if sent < (notes::deposited(&self.noted()).len() + MOST_OPEN) as u64 {
                let route = self.route();
                let answer = ask(&self.socket(), "POST", "/v1/events", &format!("luggage {route}")).unwrap();
                assert_eq!(answer["events"], 1);
                *self.accepted.entry(route).or_default() += 1;
            }
            if let Some(crashing) = &mut crashing
                && self.chance.below(20) == 0
            {
                let line = format!("crash {} restart {}ms", crashing.next().unwrap(), 1 + self.chance.below(40));
                ask(&self.socket(), "POST", "/v1/events", &line).unwrap();
            }
            self.answer_questions();
            sleep(Duration::from_millis(2));
        }
        // One that has no answer before the kill.
        let route = self.route();
        let _stream = send(&self.socket(), "POST", "/v1/events", &format!("luggage {route}")).unwrap();
        *self.unanswered.entry(route).or_default() += 1;
        sleep(Duration::from_micros(self.chance.below(15_000)));
    }
}

fn coordinate(value: &Value) -> Option<i32> {
    value.as_i64()?.try_into().ok()
}

fn kill_at_random_moments(folder: &str, forgets: bool, crashes: bool) {
    let mut recorder = Recorder::new(empty_folder(folder));
    fs::write(recorder.folder.join("f.composite"), fleet(forgets, crashes)).unwrap();
    let kills = std::env::var("SAOMS_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(KILLS);
    // One after the other: who crashes twice before it has executed loses what it heard.
    let mut crashing = CRASHING.iter().cycle();
    let mut has_crashed = false;
    for _ in 0..kills {
        let mut program = recorder.start();
        if recorder.chance.below(4) == 0 {
            // In its start, too.
            sleep(Duration::from_millis(recorder.chance.below(300)));
        } else {
            recorder.wait_for_accepted(&mut program);
            let until = Instant::now() + Duration::from_millis(recorder.chance.below(500));
            recorder.work(until, crashes.then_some(&mut crashing));
        }
        drop(program);
        has_crashed |= recorder.told().contains("it crashes by fault injection");
        notes::check(&recorder.noted());
    }
    assert_eq!(has_crashed, crashes);
    finish(&mut recorder);
    assert_eq!(recorder.answers.contains(&true) && recorder.answers.contains(&false), forgets);
}

/// Waits after the last kill until all is brought, and checks that each piece was brought once.
fn finish(recorder: &mut Recorder) {
    let mut program = recorder.start();
    recorder.wait_for_accepted(&mut program);
    let open = |recorder: &Recorder| {
        let known = recorder.known().unwrap();
        known.len() - notes::deposited(&recorder.noted()).len()
    };
    let mut last = (open(recorder), Instant::now());
    while last.0 > 0 {
        assert!(last.1.elapsed() < PATIENCE, "{} pieces are not brought: {}", last.0, recorder.told());
        recorder.answer_questions();
        sleep(Duration::from_millis(50));
        let now = open(recorder);
        last = if now < last.0 { (now, Instant::now()) } else { last };
    }
    drop(program);
    let brought = notes::deposited(&recorder.noted());
    assert!(recorder.compare(&brought, &recorder.told()), "{brought:?} of {:?}", recorder.accepted);
    notes::check(&recorder.noted());
}

#[test]
fn hardware_that_knows_what_became_of_its_actions_does_nothing_twice() {
    kill_at_random_moments("machines", false, false);
}

#[test]
fn hardware_that_a_person_looks_at_does_nothing_twice() {
    kill_at_random_moments("machines-forget", true, false);
}

#[test]
fn hardware_of_robots_that_crash_does_nothing_twice() {
    kill_at_random_moments("machines-crash", false, true);
}
