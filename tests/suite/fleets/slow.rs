//! What `saoms why` answers about robots whose hardware takes several periods, held to what the hardware did.

use std::fs;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Properties, Time};
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::{Action, ActionKind, Area, Hardware, Progress};
use saoms_core::journal::{Chain, Why};
use saoms_testkit::{Fleet, Run};
use serde_json::Value;

use crate::support::{saoms, stdout};

/// Properties of the driver.
#[derive(Debug, Properties)]
struct SlowProperties {
    /// Number of calls of `poll` that an action takes.
    #[property(default = 3)]
    periods: u32,
    /// True if the gripper never holds anything.
    #[property(default = false)]
    drops: bool,
    /// Number of moves that fail at first.
    #[property(default = 0)]
    jams: u32,
}

/// Hardware that takes its time, and logs what it really did.
#[derive(Debug, Class)]
#[class(name = "test.SlowDriver", passive, service("hardware": Hardware))]
struct Slow {
    properties: SlowProperties,
    block: Block,
    running: Option<(Action, u32)>,
}

impl Component for Slow {
    type Properties = SlowProperties;

    fn new(properties: SlowProperties) -> Result<Self, Failure> {
        Ok(Slow { properties, block: Block::default(), running: None })
    }
}

impl Hardware for Slow {
    fn enter(&mut self, _: &mut Context<'_>, _: u32, _: String, block: Block) -> Result<Block, Failure> {
        self.block = block;
        Ok(block)
    }

    fn area(&mut self, _: &mut Context<'_>) -> Result<Area, Failure> {
        Ok(Area::from(&Map::new(11, 11)))
    }

    fn begin(&mut self, _: &mut Context<'_>, _: u32, action: Action) -> Result<Progress, Failure> {
        self.running = Some((action, self.properties.periods));
        Ok(Progress::Running)
    }

    fn poll(&mut self, context: &mut Context<'_>, _: u32) -> Result<Progress, Failure> {
        let Some((action, left)) = &mut self.running else { return Ok(Progress::Done) };
        *left -= 1;
        if *left > 0 {
            return Ok(Progress::Running);
        }
        let Action { kind, block, .. } = *action;
        self.running = None;
        let now = context.now().as_nanos();
        let jams = kind == ActionKind::Move && self.properties.jams > 0;
        if jams || (kind == ActionKind::Collect && self.properties.drops) {
            self.properties.jams -= u32::from(jams);
            context.info(format_args!("{now} {kind:?} {block} failed"));
            return Ok(Progress::Failed);
        }
        if kind == ActionKind::Move {
            self.block = block;
        }
        context.info(format_args!("{now} {kind:?} {block} done"));
        Ok(Progress::Done)
    }

    fn cancel(&mut self, _: &mut Context<'_>, _: u32) -> Result<(), Failure> {
        self.running = None;
        Ok(())
    }

    fn retire(&mut self, _: &mut Context<'_>, _: u32) -> Result<Block, Failure> {
        self.running = None;
        Ok(self.block)
    }
}

/// Robots by number and further properties, each with a driver that has these properties.
fn fleet(scenario: &str, driver: &str, robots: &[(u32, &str)]) -> Fleet {
    let component = |id: &str, class: &str, properties: &str, rest: &str| {
        let properties = properties.split_whitespace().filter_map(|property| property.split_once('='));
        let properties: String =
            properties.map(|(name, value)| format!(r#"<property name="{name}" value="{value}"/>"#)).collect();
        format!(
            r#"<component name="{id}"><implementation.rust class="{class}"/>{properties}{rest}</component>
            "#
        )
    };
    let task = |id: &str| format!("ID={id} period=100ms");
    let scenario = format!(r#"<property name="scenario">{scenario}</property>"#);
    let mut text = component("Environment", "saoms.Environment", &task("Environment"), &scenario);
    text += &component("Master", "saoms.MasterEnvironment", &task("Master"), "");
    for (number, properties) in robots {
        let (robot, hardware) = (format!("Robot{number}"), format!("Driver{number}"));
        let wire = format!(r#"<reference name="world" target="{hardware}"/>"#);
        text += &component(&robot, "saoms.Robot", &format!("{} {properties}", task(&robot)), &wire);
        text += &component(&hardware, "test.SlowDriver", driver, "");
    }
    Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="slow" targetNamespace="urn:slow">
        {text}</composite>"#
    ))
}

/// What the hardware of a robot really did: when, what, where, and whether that went well.
fn done(run: &Run, robot: u32) -> Vec<(Time, String, String, bool)> {
    let lines = run.log_of(&format!("Driver{robot}"));
    let done = lines.iter().map(|line| {
        let mut words = line.split(' ').map(str::to_owned);
        let mut word = || words.next().unwrap();
        (Time::from_nanos(word().parse().unwrap()), word(), word(), word() == "done")
    });
    done.collect()
}

fn why(run: &Run, robot: u32, at: Time) -> Why<'_> {
    run.journal().why(&format!("Robot{robot}"), Some(at)).unwrap()
}

/// The chain of the act with this text.
#[track_caller]
fn chain<'w, 'r>(why: &'w Why<'r>, act: &str) -> &'w Chain<'r> {
    let texts = || why.chains.iter().flat_map(|chain| &chain.acts).map(|act| act.text()).collect::<Vec<_>>();
    let found = why.chains.iter().find(|chain| chain.acts.iter().any(|one| one.text() == act));
    found.unwrap_or_else(|| panic!("no `{act}` at {:?}, but {:?}", why.time, texts()))
}

fn reasons(chain: &Chain<'_>) -> Vec<String> {
    chain.reasons.iter().map(|reason| reason.text()).collect()
}

fn known(why: &Why<'_>, entry: &str) -> Option<Value> {
    why.knowledge.iter().find(|known| known.entry == entry).map(|known| known.value.clone())
}

fn pair(block: &str) -> Value {
    let inner = block.trim_matches(['(', ')']);
    inner.split(',').map(|number| number.parse::<i64>().unwrap()).collect::<Vec<_>>().into()
}

/// Each move, and each use of the gripper: at the moment when it is over, `why` has it with the decision that began it.
#[track_caller]
fn hold(run: &Run, robot: u32) {
    let mut at: Option<String> = None;
    for (time, kind, block, went_well) in done(run, robot) {
        let why = why(run, robot, time);
        assert_eq!(why.time, Some(time));
        let (act, began) = match (kind.as_str(), went_well) {
            ("Move", true) => (at.as_ref().map(|at| format!("block: {at} -> {block}")), format!("moves to {block}")),
            ("Move", false) => (Some(format!("could not move to {block}")), format!("moves to {block}")),
            ("Collect", true) => (Some("hasLuggage: no -> yes".to_owned()), "collects luggage 1".to_owned()),
            ("Collect", false) => {
                (Some(format!("could not collect luggage 1 at {block}")), "collects luggage 1".to_owned())
            }
            _ => (Some("busy: yes -> no".to_owned()), "deposits luggage 1".to_owned()),
        };
        if let Some(act) = act {
            let reasons = reasons(chain(&why, &act));
            assert_eq!(reasons[0], began, "{act} at {time}: {reasons:?}");
        }
        if kind == "Move" && went_well {
            at = Some(block);
        }
        if let Some(at) = &at {
            assert_eq!(known(&why, "block"), Some(pair(at)), "{time}");
        }
        if kind == "Collect" && went_well {
            let on_the_way = (known(&why, "hasLuggage"), known(&why, "busy"));
            assert_eq!(on_the_way, (Some(true.into()), Some(true.into())));
        }
        let battery = known(&why, "battery").and_then(|battery| battery.as_f64()).unwrap();
        assert!((0.0..=100.0).contains(&battery), "{battery}");
    }
}

#[test]
fn why_a_slow_robot_moved_and_handled_luggage() {
    for policy in ["safe", "classic"] {
        let robot = format!("policy={policy}");
        let run = fleet("at 0.5s luggage (2,1) to (2,3)", "periods=4", &[(1, &robot)]).run(1, Duration::from_secs(20));
        let moves = done(&run, 1).iter().filter(|(_, kind, ..)| kind == "Move").count();
        assert!(moves >= 4, "{policy}: {}", run.log());
        if policy == "safe" {
            hold(&run, 1);
            continue;
        }
        for (time, _, block, _) in done(&run, 1).iter().filter(|(_, kind, ..)| kind == "Move") {
            assert_eq!(known(&why(&run, 1, *time), "block"), Some(pair(block)));
        }
    }
}

#[test]
fn a_robot_that_is_still_moving_does_not_say_that_it_stays() {
    let run = fleet("at 0.5s luggage (2,1) to (2,3)", "periods=6", &[(1, "")]).run(1, Duration::from_secs(20));
    let first = done(&run, 1)[0].clone();
    let on_the_way = why(&run, 1, Time::from_nanos(first.0.as_nanos() - 500_000_000));
    let acts: Vec<String> = on_the_way.chains.iter().flat_map(|chain| &chain.acts).map(|act| act.text()).collect();
    assert!(acts.contains(&format!("is still moving to {}", first.2)), "{acts:?}");
}

#[test]
fn why_a_slow_robot_goes_to_charge() {
    let run = fleet("at 0.5s luggage (5,1) to (5,4)", "periods=3", &[(1, "")]).run(1, Duration::from_secs(100));
    let journal = run.journal().of("Robot1");
    let turned = journal.clone().of_record("goes_to_charge");
    let turned = turned.first().unwrap_or_else(|| panic!("{}", run.log()));
    // Each move from then on, up to the charger, follows from the low battery.
    let way = done(&run, 1).into_iter().filter(|(time, kind, ..)| *time > turned.time() && kind == "Move");
    let mut way: Vec<_> = way.collect();
    let home = way.iter().position(|(_, _, block, _)| block == "(0,1)").unwrap();
    way.truncate(home + 1);
    // The first of them may have begun before.
    assert!(way.len() > 2, "{way:?}");
    for (time, _, block, _) in &way[1..] {
        let why = why(&run, 1, *time);
        let chain = why.chains.iter().find(|chain| chain.acts.iter().any(|act| act.text().ends_with(block)));
        let reasons = reasons(chain.unwrap());
        assert_eq!(reasons[0], format!("moves to {block}"));
        assert!(reasons.iter().any(|reason| reason == "goes to charge"), "{time}: {reasons:?}");
        assert!(reasons.iter().any(|reason| reason.starts_with("battery at ")), "{time}: {reasons:?}");
    }
    // It charges because it is there, and is there because the battery was low.
    let charged = journal.of_record("starts_charging");
    let charged = charged.iter().find(|entry| entry.time() > turned.time()).unwrap();
    let why = why(&run, 1, charged.time());
    let reasons = reasons(chain(&why, "inCharge: no -> yes"));
    assert_eq!(reasons[0], "starts charging");
    assert!(reasons.iter().any(|reason| reason == "goes to charge"), "{reasons:?}");
}

#[test]
fn why_a_slow_robot_waits() {
    // Both go through (2,2).
    let scenario = "at 0.5s luggage (2,1) to (2,4); at 0.5s luggage (1,3) to (5,3)";
    let run =
        fleet(scenario, "periods=5", &[(1, "discharge=0.5"), (3, "discharge=0.5")]).run(1, Duration::from_secs(60));
    let mut waits = 0;
    for (robot, other) in [(1, 3), (3, 1)] {
        for entry in run.journal().of(&format!("Robot{robot}")).of_record("waits_for_robot").iter() {
            waits += 1;
            let why = why(&run, robot, entry.time());
            let reasons = reasons(chain(&why, "stopAPeriod: no -> yes"));
            assert_eq!(reasons[0], format!("waits for robot {other}"));
            let block = reasons[1].strip_prefix(&format!("robot {other} holds or wants ")).unwrap().to_owned();
            // It was there, or on its way there, or wanted to.
            let near = known(&self::why(&run, other, entry.time()), "block").unwrap();
            let (x, y) = (near[0].as_i64().unwrap(), near[1].as_i64().unwrap());
            let there = pair(&block);
            let far = (x - there[0].as_i64().unwrap()).abs() + (y - there[1].as_i64().unwrap()).abs();
            assert!(far <= 2, "{block} and {near}");
        }
    }
    assert!(waits > 0, "{}", run.log());
    for robot in [1, 3] {
        assert!(done(&run, robot).iter().any(|(_, kind, ..)| kind == "Deposit"), "{}", run.log());
    }
}

#[test]
fn why_a_slow_robot_drops_its_job() {
    let run = fleet("at 0.5s luggage (2,1) to (2,3)", "periods=3 drops=true", &[(1, "")]);
    let run = run.run(1, Duration::from_secs(30));
    hold(&run, 1);
    let failed: Vec<_> = done(&run, 1).into_iter().filter(|(_, kind, ..)| kind == "Collect").collect();
    assert_eq!(failed.len(), 3);
    let why = why(&run, 1, failed[2].0);
    let chain = chain(&why, "busy: yes -> no");
    assert!(chain.acts.iter().any(|act| act.text() == "could not collect luggage 1 at (2,1)"));
    assert_eq!(known(&why, "busy"), Some(false.into()));
    let left = run.journal().of("Robot1").of_record("leaves_luggage");
    let way = std::iter::successors(left.first(), |entry| run.journal().entry(entry.cause()));
    let way: Vec<String> = way.map(|entry| entry.text()).collect();
    assert_eq!(way[1], "cannot collect luggage 1 at (2,1)");
    assert!(way.contains(&"collects luggage 1".to_owned()), "{way:?}");
}

#[test]
fn why_a_slow_robot_tries_a_move_again() {
    let run = fleet("at 0.5s luggage (2,1) to (2,3)", "periods=3 jams=2", &[(1, "")]).run(1, Duration::from_secs(30));
    hold(&run, 1);
    let jammed = done(&run, 1).into_iter().find(|(.., went_well)| !went_well).unwrap();
    let why = why(&run, 1, jammed.0);
    assert!(chain(&why, &format!("could not move to {}", jammed.2)).acts.len() > 1, "it is where it was, too");
    assert_eq!(known(&why, "next"), Some(pair("(0,1)")));
}

#[test]
fn the_command_answers_the_same() {
    let run = fleet("at 0.5s luggage (2,1) to (2,3)", "periods=4", &[(1, "")]).run(1, Duration::from_secs(20));
    let folder = tempfile::tempdir().unwrap();
    let report = folder.path().join("report.json");
    fs::write(&report, serde_json::to_string(&*run).unwrap()).unwrap();
    let (time, _, block, _) = done(&run, 1)[1].clone();
    let at = format!("{}us", time.as_nanos() / 1000);
    let told = stdout(&saoms(&["why", "Robot1", "--at", &at, "--report", report.to_str().unwrap()]));
    let line = |words: &str| told.lines().find(|line| line.contains(words)).unwrap_or_else(|| panic!("{told}"));
    assert!(line(&format!("-> {block}")).contains("effect"), "{told}");
    assert!(line(&format!("moves to {block}")).starts_with("  2"), "{told}");
    assert!(line("  battery").contains("since"), "{told}");
}
