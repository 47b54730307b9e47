//! What a component keeps is committed before its messages leave, and outlives the program in a store.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use saoms_api::host::Registration;
use saoms_api::{Class, Component, Context, Failure, Own, Publisher, Time};
use saoms_core::schedule::{ChangeOptions, RunningFleet, Settings};
use saoms_core::store::Store;
use saoms_lang::registry::Registry;

use crate::actor::{Actor, TALK, Words};
use crate::fleet::{Diary, assembly_of, outcome, real, simulated, unindent};

/// Counts what it kept, says so, and has no other memory.
#[derive(Class)]
#[class(name = "ledger", periodic)]
struct Ledger {
    /// Executions that keep something, by times in milliseconds with blanks around them; without this, all.
    #[property(default = "")]
    keeps: String,
    /// Executions that fail.
    #[property(default = "")]
    fails: String,
    /// The number of executions after which its work is done.
    #[property(default = 1000)]
    most: u32,
    #[publishes(TALK)]
    words: Publisher<Words>,
    count: u32,
}

impl Component for Ledger {
    type Properties = Own<Self>;

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.count = context.kept().get(&5).map_or(0, |bytes| u32::from_le_bytes(bytes.to_vec().try_into().unwrap()));
        let of = if context.kept_by_earlier_program() { ", of an earlier program" } else { "" };
        let count = |bytes: &[u8]| u32::from_le_bytes(bytes.to_vec().try_into().unwrap());
        let left: Vec<u32> = context.kept_by_others().iter().map(|other| count(other.kept[&5])).collect();
        let left = if left.is_empty() { String::new() } else { format!(", others kept {left:?}") };
        context.info(format!("begins with {}{of}{left}", self.count));
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = format!(" {} ", context.now().as_nanos() / 1_000_000);
        if self.fails.contains(&now) {
            return Err("it was told to".into());
        }
        self.count += 1;
        if self.keeps.is_empty() || self.keeps.contains(&now) {
            context.keep(5, &self.count.to_le_bytes())?;
        }
        context.vote(if self.count >= self.most { saoms_api::Work::Done } else { saoms_api::Work::Open });
        context.send(&self.words, Words { text: self.count.to_string() })
    }
}

fn start(fleet: &str, settings: Settings, folder: Option<&Path>) -> (RunningFleet, Arc<Diary>) {
    let mut registry = Registry::new();
    registry.add(Registration::of::<Actor>()).unwrap();
    registry.add(Registration::of::<Ledger>()).unwrap();
    let diary = Arc::new(Diary::default());
    let assembly = assembly_of(fleet, &registry);
    let fleet = RunningFleet::start_with(assembly, settings, vec![diary.clone()], |handle| {
        folder.map_or(Ok(()), |folder| handle.use_store(Store::open(folder).unwrap()))
    });
    (fleet.unwrap(), diary)
}

#[track_caller]
fn check(fleet: &str, settings: Settings, expected: &str) {
    let (fleet, diary) = start(fleet, settings, None);
    let report = fleet.run_to_end();
    assert_eq!(format!("{}{}", diary.lines(), outcome(&report)), unindent(expected));
}

fn with_delay(milliseconds: u64, delay: u64) -> Settings {
    Settings { commit_delay: Duration::from_millis(delay), ..simulated(milliseconds) }
}

#[test]
fn messages_wait_in_their_order_for_what_was_kept_before_them() {
    check(
        "A ledger period=10 keeps=[ 0 30 ]
         B actor period=10 subscribes=TALK each=[hear]",
        with_delay(70, 25),
        "[0.000 s] A: begins with 0
         [0.000 s] B: hears []
         [0.010 s] B: hears []
         [0.020 s] B: hears []
         [0.030 s] B: hears [1, 2, 3]
         [0.040 s] B: hears []
         [0.050 s] B: hears []
         [0.060 s] B: hears [4, 5, 6, 7]
         Elapsed after 0.07 s",
    );
    check(
        "A ledger period=10
         B actor period=10 subscribes=TALK each=[hear]",
        with_delay(20, 0),
        "[0.000 s] A: begins with 0
         [0.000 s] B: hears [1]
         [0.010 s] B: hears [2]
         Elapsed after 0.02 s",
    );
}

#[test]
fn what_others_kept_is_left_to_those_of_their_class_that_begin_in_a_change() {
    let (fleet, diary) = start(
        "A ledger period=10
         B ledger period=5
         C ledger period=1
         D ledger period=10 startup=false
         X actor period=10",
        simulated(60),
        None,
    );
    let mut registry = Registry::new();
    registry.add(Registration::of::<Actor>()).unwrap();
    registry.add(Registration::of::<Ledger>()).unwrap();
    fleet.run_until(Time::from_nanos(24_000_000));
    let wanted = "A ledger period=20
        C ledger period=1
        D ledger period=20 startup=false
        E ledger period=10
        F ledger period=10 startup=false
        X actor period=20";
    let changed = fleet.handle().apply(&assembly_of(wanted, &registry), ChangeOptions::allowing_loss()).unwrap();
    assert_eq!((changed.added.len(), changed.removed.len(), changed.replaced.len()), (2, 1, 3));
    // Those that did not run have it when they begin.
    fleet.handle().schedule("D").unwrap();
    fleet.handle().schedule("F").unwrap();
    fleet.run_to_end();
    let lines = diary.lines();
    let left = lines.lines().filter(|line| line.contains("others kept"));
    let left: Vec<&str> = left.filter_map(|line| Some(line.split_once("] ")?.1)).collect();
    let expected = [
        "A: begins with 3, others kept [5]",
        "E: begins with 0, others kept [5, 3]",
        "D: begins with 0, others kept [5, 3]",
        "F: begins with 0, others kept [5, 3]",
    ];
    assert_eq!(left, expected, "{lines}");
}

#[test]
fn what_was_left_to_one_that_did_not_begin_is_left_again_also_to_whom_it_came_from() {
    let fleet = |periods: [u32; 2]| {
        let [first, second] = periods;
        format!("B ledger period={first}\nD ledger period={second} startup=false\nX actor period=10")
    };
    let (running, diary) = start(&fleet([5, 10]), simulated(60), None);
    let mut registry = Registry::new();
    registry.add(Registration::of::<Actor>()).unwrap();
    registry.add(Registration::of::<Ledger>()).unwrap();
    let change = |at: u64, periods: [u32; 2]| {
        running.run_until(Time::from_nanos(at * 1_000_000));
        let wanted = assembly_of(&fleet(periods), &registry);
        assert_eq!(running.handle().apply(&wanted, ChangeOptions::allowing_loss()).unwrap().replaced.len(), 2);
    };
    change(24, [6, 20]);
    change(37, [7, 30]);
    running.handle().schedule("D").unwrap();
    // By then, it has kept something of its own.
    change(45, [8, 40]);
    running.run_to_end();
    let lines = diary.lines();
    let begins = lines.lines().filter_map(|line| Some(line.split_once("] ")?.1)).filter(|line| line.contains("begins"));
    let expected = [
        "B: begins with 0",
        "B: begins with 5",
        "B: begins with 7, others kept [5]",
        "D: begins with 0, others kept [7, 5]",
        "B: begins with 8, others kept [1]",
        "D: begins with 1, others kept [8]",
    ];
    assert_eq!(begins.collect::<Vec<_>>(), expected, "{lines}");
}

#[test]
fn what_an_earlier_program_kept_is_left_to_all_of_that_class_that_begin() {
    let folder = tempfile::tempdir().unwrap();
    let run = |fleet: &str| {
        let (running, diary) = start(fleet, Settings::default(), Some(folder.path()));
        running.run_to_end();
        let lines = diary.lines();
        let begins = lines.lines().filter_map(|line| Some(line.split_once("] ")?.1));
        begins.filter(|line| line.contains("begins with")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(run("A ledger period=5 most=3\nB ledger period=2 most=20"), ["A: begins with 0", "B: begins with 0"]);
    let [first, second] = &run("A ledger period=5 most=3\nC ledger period=5 most=1")[..] else { panic!() };
    let (own, others) = first.split_once(", of an earlier program, others kept ").unwrap();
    let own = own.strip_prefix("A: begins with ").unwrap();
    let other = others.trim_matches(['[', ']']);
    assert!(own.parse::<u32>().unwrap() >= 3 && other.parse::<u32>().unwrap() >= 20, "{first}");
    assert_eq!(*second, format!("C: begins with 0, others kept [{own}, {other}]"));
}

#[test]
fn a_failure_in_virtual_time_loses_what_was_not_committed_with_its_messages() {
    check(
        "A ledger period=10 fails=[ 30 ] restart=5/3
         B actor period=10 subscribes=TALK each=[hear]",
        with_delay(80, 15),
        "[0.000 s] A: begins with 0
         [0.000 s] B: hears []
         [0.010 s] B: hears []
         [0.020 s] B: hears [1]
         [0.030 s] A: failed and is restarted in 5ms: it was told to (messages that waited for what it kept, and are not sent: 1)
         [0.030 s] B: hears [2]
         [0.035 s] A: begins with 2
         [0.035 s] A: restarted (1)
         [0.040 s] B: hears []
         [0.050 s] B: hears [3]
         [0.060 s] B: hears [4]
         [0.070 s] B: hears [5]
         Elapsed after 0.08 s",
    );
}

/// In the change it got what A had kept, and made something of it that was committed before it failed.
#[test]
fn what_was_left_to_one_that_loses_its_last_execution_is_left_to_no_other_one() {
    let settings = Settings { commit_delay: Duration::from_millis(15), ..simulated(100) };
    let (running, diary) = start("A ledger period=10\nX actor period=10", settings, None);
    let mut registry = Registry::new();
    registry.add(Registration::of::<Actor>()).unwrap();
    registry.add(Registration::of::<Ledger>()).unwrap();
    let change = |at: u64, fleet: &str| {
        running.run_until(Time::from_nanos(at * 1_000_000));
        running.handle().apply(&assembly_of(fleet, &registry), ChangeOptions::allowing_loss()).unwrap();
    };
    change(25, "E ledger period=10 fails=[ 55 ] restart=20/3\nX actor period=10");
    change(57, "E ledger period=20 fails=[ 55 ] restart=20/3\nF ledger period=10\nX actor period=10");
    running.run_to_end();
    let lines = diary.lines();
    let told = lines.lines().filter_map(|line| Some(line.split_once("] ")?.1));
    let told = told.filter(|line| line.starts_with("F: begins") || line.contains("failed"));
    let expected = [
        "E: failed and is restarted in 20ms: it was told to (messages that waited for what it kept, and are not sent: 1)",
        "F: begins with 0, others kept [2]",
    ];
    assert_eq!(told.collect::<Vec<_>>(), expected, "{lines}");
}

#[test]
fn a_run_ends_after_the_last_commit() {
    check(
        "A ledger period=10 most=2
         B actor period=10 subscribes=TALK each=[hear]",
        with_delay(1000, 35),
        "[0.000 s] A: begins with 0
         [0.000 s] B: hears []
         [0.010 s] B: hears []
         [0.020 s] B: hears []
         [0.030 s] B: hears []
         [0.040 s] B: hears [1]
         [0.050 s] B: hears [2]
         [0.060 s] B: hears [3]
         [0.070 s] B: hears [4]
         Done after 0.075 s",
    );
}

#[test]
fn a_store_outlives_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let run = |fleet: &str| {
        let (fleet, diary) = start(fleet, real(5_000), Some(folder.path()));
        let report = fleet.run_to_end();
        let begins = diary.lines().lines().map(|line| line[10..].trim().to_owned()).collect::<Vec<_>>();
        (begins.join("; "), report.outcome.reasons)
    };
    let first = run("A ledger period=1 most=20\nB ledger period=1 most=3");
    assert_eq!(first, ("A: begins with 0; B: begins with 0".to_owned(), vec![]));
    let unknown = "the state folder has what `B` kept, and the fleet has no such component: it stays there";
    let (told, reasons) = run("A ledger period=1 most=30");
    assert!(told.contains(unknown) && told.contains("A: begins with"), "{told}");
    assert_eq!(reasons, Vec::<String>::new());
    let (told, _) = run("A ledger period=1 most=31\nB ledger period=1 most=5");
    let count = |name: &str| -> u32 {
        let (_, rest) = told.split_once(&format!("{name}: begins with ")).unwrap();
        assert!(rest.contains(", of an earlier program"), "{rest}");
        rest.split(',').next().unwrap().parse().unwrap()
    };
    assert!(count("A") >= 30 && count("B") >= 3, "{told}");
}

#[test]
fn what_a_removed_component_kept_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let (fleet, _) = start("A ledger period=1\nB ledger period=1", real(5_000), Some(folder.path()));
    std::thread::sleep(Duration::from_millis(20));
    let mut registry = Registry::new();
    registry.add(Registration::of::<Ledger>()).unwrap();
    fleet.handle().apply(&assembly_of("A ledger period=1", &registry), ChangeOptions::default()).unwrap();
    fleet.handle().stop();
    fleet.run_to_end();
    let (fleet, diary) = start("A ledger period=1\nB ledger period=1", real(5_000), Some(folder.path()));
    fleet.handle().stop();
    fleet.run_to_end();
    assert!(diary.lines().contains("B: begins with 0"), "{}", diary.lines());
    assert!(!diary.lines().contains("A: begins with 0"), "{}", diary.lines());
}

/// The folder in which a killed program keeps something; without it, this is no such program.
const FOLDER: &str = "SAOMS_TEST_STORE";

/// The program that [`nothing_that_was_sent_is_lost_by_a_kill`] kills: it prints what B hears of A.
#[test]
fn program_that_is_killed() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let fleet = "A ledger period=1\nB actor period=1 subscribes=TALK each=[hear]";
    let (fleet, diary) = start(fleet, real(20_000), Some(Path::new(&folder)));
    let mut printed = 0;
    loop {
        std::thread::sleep(Duration::from_millis(1));
        let lines = diary.lines();
        lines.lines().skip(printed).for_each(|line| eprintln!("{line}"));
        printed = lines.lines().count();
        if fleet.handle().progress().time.as_nanos() > 19_000_000_000 {
            return;
        }
    }
}

#[test]
fn nothing_that_was_sent_is_lost_by_a_kill() {
    let folder = tempfile::tempdir().unwrap();
    let mut most = 0;
    for milliseconds in [60, 75, 90, 61, 80, 66, 94, 72, 69, 85] {
        let mut program = Command::new(std::env::current_exe().unwrap());
        program.args(["--exact", "store::program_that_is_killed", "--nocapture"]).env(FOLDER, folder.path());
        let mut program = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut lines = BufReader::new(program.stderr.take().unwrap()).lines().map_while(Result::ok);
        let begins = lines.find(|line| line.contains("begins with")).unwrap();
        let kept: u32 = begins.split("begins with ").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
        assert!(kept >= most, "it kept {kept}, and had said {most}");
        std::thread::sleep(Duration::from_millis(milliseconds));
        program.kill().unwrap();
        program.wait().unwrap();
        let said =
            |line: String| line.rsplit_once("hears [")?.1.trim_end_matches(']').rsplit(", ").next()?.parse().ok();
        most = lines.filter_map(said).max().unwrap_or(kept);
    }
    assert!(most > 10, "{most}");
}
