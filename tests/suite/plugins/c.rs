//! Components in C, built by the system's compiler against the header: the robot of the examples, and the component of
//! `docs/c.md`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

use saoms_api::{Class, Component, Context, Failure, interface};
use saoms_components::grid::Block;
use saoms_components::messages::{EVENT_LUGGAGE, EventLuggage, LuggageStage, POSITION, Position, ROBOT_LIST};
use saoms_testkit::{Bench, comply_as};
use serde_json::Value;
use tempfile::TempDir;

use crate::support::{self, root, text};

/// The files of the robot.
const SOURCES: [&str; 4] = ["robot.c", "traffic.c", "zones.c", "areas.c"];

/// The built robot, in a folder that goes with this process.
static LIBRARY: LazyLock<(TempDir, PathBuf)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let library = folder.path().join("libpatrol.so");
    build(&SOURCES.map(|file| root().join("plugins/robot-in-c").join(file)), &library);
    (folder, library)
});

/// Builds a library as the guide says, with all warnings as errors.
fn build(sources: &[PathBuf], library: &Path) {
    let mut command = Command::new("cc");
    command
        // JSON is longer than the texts that C99 promises to take.
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wno-overlength-strings"])
        .args(["-O1", "-shared", "-fPIC", "-fvisibility=hidden", "-I", "saoms-abi/include", "-o"])
        .arg(library)
        .args(sources)
        .current_dir(root());
    match command.output() {
        Ok(output) => assert!(output.status.success(), "{command:?}: {}", text(&output)),
        Err(error) => panic!("{command:?}: {error}; this test needs the C compiler of the system, `cc`"),
    }
}

/// The robot in C.
pub(crate) fn library() -> &'static Path {
    &LIBRARY.1
}

/// Runs `saoms` with the library.
fn saoms(arguments: &[&str]) -> Output {
    support::saoms(&[arguments, &["--plugin", library().to_str().unwrap()]].concat())
}

/// The result of a run of the fleet.
fn run(composite: &Path, seed: u64) -> Value {
    let seed = seed.to_string();
    let path = composite.to_str().unwrap();
    let run = saoms(&["run", path, "--virtual", "--for", "300s", "--seed", &seed, "--quiet", "--report", "-"]);
    assert!(run.status.success(), "{}", text(&run));
    serde_json::from_slice(&run.stdout).unwrap()
}

const FLEET: &str = "plugins/robot-in-c/fleet.composite";

#[test]
fn it_is_listed_as_any_class() {
    let listed = saoms(&["components", "patrol.Robot"]);
    for expected in [
        "patrol.Robot (periodic)\n  from the library ",
        "libpatrol.so\n",
        "Types\n  Position\n      robot: uint32\n      block: Block\n",
        "  Block\n      x: int32\n      y: int32\n",
        "stage: one of a uint8 enumeration (REQUEST = 0, ",
        "number: a whole number from 1 to 4294967295, required",
        "POSTOPIC (state topic of Position)",
        "world: saoms.Hardware, optional",
    ] {
        assert!(text(&listed).contains(expected), "{}", text(&listed));
    }
}

#[test]
fn it_gets_past_the_robots_that_ship_and_they_past_it() {
    let mut turns = 0;
    for seed in 0..3 {
        let report = run(Path::new(FLEET), seed);
        assert_eq!(report["luggage"]["delivered"], 20, "seed {seed}: {report:#}");
        assert_eq!(report["collisions"], serde_json::json!({"vertex": 0, "swap": 0}), "seed {seed}: {report:#}");
        assert!(report["patrol"]["rounds"].as_u64() > Some(15), "seed {seed}: {report:#}");
        turns += report["patrol"]["turns"].as_u64().unwrap_or(0);
        assert_eq!(report["messages"]["ignored"], Value::Null, "it says nothing wrong: {report:#}");
        assert_eq!(report["trace_hash"], run(Path::new(FLEET), seed)["trace_hash"], "the same seed, the same run");
    }
    assert!(turns > 0, "robots come towards each other now and then");
}

#[test]
fn it_hands_back_luggage_that_no_robot_is_left_for() {
    let folder = tempfile::tempdir().unwrap();
    let composite = folder.path().join("fleet.composite");
    let text = fs::read_to_string(root().join(FLEET)).unwrap();
    let scenario = "at 1s breakdown 1; at 1s breakdown 2; at 1s breakdown 3; at 5s luggage (3,3) to (5,5)";
    let (start, rest) = text.split_once("      from 1s").unwrap();
    let (_, end) = rest.split_once("end\n").unwrap();
    fs::write(&composite, format!("{start}{scenario}{end}")).unwrap();
    let run = saoms(&["run", composite.to_str().unwrap(), "--virtual", "--for", "60s"]);
    assert!(support::text(&run).contains("gives up luggage 1 from (3,3) to (5,5)"), "{}", support::text(&run));
}

#[test]
fn wrong_values_are_shown_in_the_composite() {
    let folder = tempfile::tempdir().unwrap();
    let composite = folder.path().join("fleet.composite");
    let text = fs::read_to_string(root().join(FLEET)).unwrap();
    fs::write(&composite, text.replace("name=\"right\" value=\"8\"", "name=\"right\" value=\"1\"")).unwrap();
    let checked = saoms(&["check", composite.to_str().unwrap()]);
    assert_eq!(checked.status.code(), Some(2));
    let shown = support::text(&checked);
    assert!(shown.contains("right of `left`") && shown.contains("name=\"right\" value=\"1\""), "{shown}");
}

#[test]
fn it_keeps_what_every_component_keeps() {
    comply_as(|| Bench::of_library(library(), "patrol.Robot", &[("ID", "Patrol"), ("number", "9")]));
}

#[test]
fn it_says_what_a_robot_says() {
    let values = [("ID", "Patrol"), ("number", "9"), ("left", "2"), ("right", "4"), ("bottom", "2")];
    let mut patrol = Bench::of_library(library(), "patrol.Robot", &values).unwrap();
    patrol.start().unwrap();
    assert_eq!(patrol.sent(&ROBOT_LIST)[0].charger, Block::new(2, 0));
    let wants = |patrol: &Bench| patrol.sent(&POSITION).last().map(|position| (position.block, position.wanted));
    assert_eq!(wants(&patrol), Some((Block::new(2, 0), Block::new(2, 0))));
    patrol.execute().unwrap();
    assert_eq!(wants(&patrol), Some((Block::new(2, 0), Block::new(3, 0))), "says so before it goes");
    // Somebody stands in its way, and luggage waits.
    let block = Block::new(3, 0);
    patrol.deliver(&POSITION, Position { robot: 5, block, next: block, wanted: block, ..Position::default() });
    patrol.deliver(&EVENT_LUGGAGE, EventLuggage::request(7, block, block));
    patrol.execute().unwrap();
    assert_eq!(wants(&patrol), None, "waits");
    let refusal = &patrol.sent(&EVENT_LUGGAGE)[0];
    assert_eq!((refusal.robot, refusal.luggage, refusal.stage), (9, 7, LuggageStage::Refused));
    let away = Block::new(9, 9);
    patrol.deliver(&POSITION, Position { robot: 5, block: away, next: away, wanted: away, ..Position::default() });
    patrol.execute().unwrap();
    assert_eq!(wants(&patrol), Some((Block::new(3, 0), Block::new(4, 0))), "goes on");
    // Somebody comes towards it.
    let towards =
        Position { robot: 5, block: Block::new(4, 0), next: Block::new(4, 0), wanted: block, ..Position::default() };
    patrol.deliver(&POSITION, towards);
    patrol.execute().unwrap();
    assert_eq!(wants(&patrol), Some((block, Block::new(2, 0))), "turns around");
    assert_eq!(patrol.journal(), ["symptom: robot 5 is in its way", "decision: turns around"]);
}

/// Counts, in C.
#[interface(name = "counter.Count")]
trait Count {
    fn count(&mut self, context: &mut Context<'_>) -> Result<u64, Failure>;
}

/// Asks the counter in each period.
#[derive(Class)]
#[class(name = "test.Asks", periodic, reference("counter": Count))]
struct Asks {
    counter: CountReference,
}

impl Component for Asks {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Asks { counter: CountReference::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.counter = context.reference("counter")?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let count = self.counter.count(context)?;
        context.info(format_args!("hears of {count}"));
        Ok(())
    }
}

#[test]
fn the_component_of_the_guide_does_what_the_guide_says() {
    let folder = tempfile::tempdir().unwrap();
    let (source, library) = (folder.path().join("counter.c"), folder.path().join("libcounter.so"));
    let guide = fs::read_to_string(root().join("docs/c.md")).unwrap();
    let (_, code) = guide.split_once("```c\n").unwrap();
    fs::write(&source, code.split_once("```\n").unwrap().0).unwrap();
    build(&[source], &library);
    let make = |step| Bench::of_library(&library, "counter.Counter", &[("step", step)]);
    comply_as(|| make("5"));
    let refused = make("13").err().unwrap();
    assert_eq!(refused.findings()[0].place().property_name(), Some("step"));
    let mut counter = make("5").unwrap();
    counter.start().unwrap();
    counter.execute().unwrap();
    assert_eq!(counter.sent_json("COUNT"), [serde_json::json!({"number": 5})]);
    counter.deliver_json("COUNT", &serde_json::json!({"number": 5})).unwrap();
    counter.execute().unwrap();
    assert_eq!(counter.log(), ["hears 5"]);
    let mut asks = Bench::of::<Asks>(&[]).unwrap().wire("counter", counter, "count");
    asks.start().unwrap();
    asks.execute().unwrap();
    assert_eq!(asks.log(), ["hears of 10"]);
}

/// A part of a library that leaves a file where it is loaded.
const MARK: &str = "#include <stdio.h>\n__attribute__((constructor)) static void ran(void) { FILE *mark = fopen(\"RAN\", \"w\"); if (mark) fclose(mark); }\n";

#[test]
fn code_runs_only_where_somebody_named_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let site = folder.path();
    let mark = site.join("mark.c");
    fs::write(&mark, MARK).unwrap();
    let robot = SOURCES.map(|file| root().join("plugins/robot-in-c").join(file));
    fs::create_dir_all(site.join("fleet/plugins")).unwrap();
    build(&[&robot[..], &[mark]].concat(), &site.join("fleet/libpatrol.so"));
    let composite = fs::read_to_string(root().join(FLEET)).unwrap();
    fs::write(site.join("fleet/t.composite"), &composite).unwrap();
    let named = composite.replace("class=\"patrol.Robot\"", "class=\"patrol.Robot\" library=\"patrol\"");
    assert_ne!(named, composite);
    fs::write(site.join("fleet/named.composite"), named).unwrap();
    let saoms = |arguments: &[&str]| {
        let output = support::saoms_in(site, arguments);
        let has_run = fs::remove_file(site.join("RAN")).is_ok();
        (output.status.code(), has_run, text(&output))
    };
    for place in ["fleet/libpatrol.so", "fleet/plugins/libpatrol.so", "libpatrol.so", "plugins/libpatrol.so"] {
        let present = ["fleet/libpatrol.so", "fleet/plugins/libpatrol.so", "libpatrol.so", "plugins/libpatrol.so"];
        let present = present.iter().find(|path| site.join(path).exists()).unwrap();
        fs::create_dir_all(site.join(place).parent().unwrap()).unwrap();
        fs::rename(site.join(present), site.join(place)).unwrap();
        let composite = if place == "libpatrol.so" { "t.composite" } else { "fleet/t.composite" };
        if place == "libpatrol.so" {
            fs::copy(site.join("fleet/t.composite"), site.join(composite)).unwrap();
        }
        for command in [&["check"][..], &["check", "--format", "sarif"], &["expand"], &["graph", "-o", "x.svg"]] {
            let (code, has_run, text) = saoms(&[command, &[composite]].concat());
            assert_eq!((code, has_run), (Some(0), false), "{place} {command:?}: {text}");
        }
        let (code, has_run, text) = saoms(&["run", composite, "--virtual", "--for", "1s"]);
        assert_eq!((code, has_run), (Some(2), false), "{place}: {text}");
        assert!(
            text.contains("error[S3016]") && text.contains("`--plugin ") && text.contains(&format!("{place}`")),
            "{text}"
        );
        let (code, has_run, text) = saoms(&["run", composite, "--virtual", "--for", "1s", "--plugin", place]);
        assert_eq!((code, has_run), (Some(0), true), "{place}: {text}");
        let (code, has_run, text) = saoms(&["check", composite, "--plugin", place]);
        assert!(code == Some(0) && has_run && !text.contains("S3016"), "{place}: {text}");
    }
    // What a composite names itself, nobody named who trusts it.
    fs::rename(site.join("plugins/libpatrol.so"), site.join("fleet/libpatrol.so")).unwrap();
    let (code, has_run, text) = saoms(&["check", "fleet/named.composite"]);
    assert!(code == Some(0) && !has_run && text.contains("note[S3016]"), "{text}");
    let (code, has_run, text) = saoms(&["run", "fleet/named.composite", "--virtual", "--for", "1s"]);
    assert!(code == Some(2) && !has_run && text.contains("error[S3016]"), "{text}");
    let mut by_variable = support::command(&["run", "fleet/named.composite", "--virtual", "--for", "1s"]);
    let output = by_variable.env("SAOMS_PLUGIN_PATH", site.join("fleet")).current_dir(site).output().unwrap();
    assert!(output.status.success() && site.join("RAN").exists(), "{}", text);
}
