//! Events from outside the fleet: scenarios in files, events of any publisher, breakdowns.

use std::fs;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Publisher, ReportValue};
use saoms_components::environment::Environment;
use saoms_components::grid::{Block, Map};
use saoms_components::hardware::Area;
use saoms_components::messages::{
    AREA, ENVIRONMENT, EVENT_LUGGAGE, EnvironmentEvent, EventLuggage, Fault, LuggageStage,
};
use saoms_core::report::{RunReport, RunStatus};
use saoms_testkit::{Bench, Fleet};
use serde_json::{Value, json};

const HOUR: Duration = Duration::from_secs(3600);

/// A fleet of two robots in a world of 5 x 4 blocks with a wall in (2,2), and these components too.
fn fleet(scenario: &str, more: &str) -> String {
    let task = |id: &str| format!("<property name=\"ID\">{id}</property><property name=\"period\">100</property>");
    let robot = |number: u32| {
        format!(
            "<component name=\"Robot{number}\"><implementation.java class=\"saoms.Robot\"/>{}<reference name=\"world\" target=\"World\"/></component>\n",
            task(&format!("Robot{number}"))
        )
    };
    let component = |name: &str, class: &str, inside: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"{class}\"/>{}{inside}</component>\n",
            task(name)
        )
    };
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"t\" targetNamespace=\"urn:t\">\n{}{}{}{}{}{more}</composite>",
        component("World", "saoms.World", "<property name=\"map\">.....\n.....\n..@..\n.....</property>"),
        component("Master", "saoms.MasterEnvironment", ""),
        component("Environment", "saoms.Environment", scenario),
        robot(1),
        robot(2),
    )
}

fn with_scenario(scenario: &str) -> String {
    fleet(&format!("<property name=\"scenario\">{scenario}</property>"), "")
}

fn section<'a>(report: &'a RunReport, name: &str) -> &'a Value {
    report.sections.get(name).unwrap_or(&Value::Null)
}

/// Publishes impossible events, once.
#[derive(Class)]
#[class(name = "test.Prankster", periodic, publishes(ENVIRONMENT))]
struct Prankster {
    events: Publisher<EnvironmentEvent>,
}

impl Component for Prankster {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Prankster { events: Publisher::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.events = context.publish(&ENVIRONMENT)?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        if context.execution() != 12 {
            return Ok(());
        }
        let (here, there) = (Block::new(1, 0), Block::new(3, 3));
        let luggage = vec![
            EventLuggage::request(50, here, Block::new(i32::MAX, -7)),
            EventLuggage::request(51, Block::new(2, 2), there),
            EventLuggage { stage: LuggageStage::Delivered, ..EventLuggage::request(1, here, there) },
            // This one is right, and brought like any other.
            EventLuggage::request(52, here, there),
            EventLuggage::request(52, there, here),
            EventLuggage::request(53, there, there),
        ];
        let faults = vec![Fault::breakdown(0), Fault::breakdown(99)];
        context.send(&self.events, EnvironmentEvent { luggage, exceptional: Vec::new(), faults })
    }
}

#[test]
fn impossible_events_are_ignored_and_the_run_ends_by_itself() {
    let prankster = "<component name=\"P\"><implementation.java class=\"test.Prankster\"/><property name=\"ID\">P</property><property name=\"period\">100</property></component>";
    let scenario = "<property name=\"scenario\">at 1s luggage (1,0) to (4,3); at 3s luggage (1,1) to (4,1)</property>";
    let report = Fleet::of_text(fleet(scenario, prankster)).run(1, HOUR);
    assert_eq!(report.outcome.status, RunStatus::Done, "{:?}", report.outcome);
    let luggage = json!({"requested": 3, "delivered": 3, "open": 0, "given_up": 0, "ignored": 5});
    assert_eq!(section(&report, "luggage"), &luggage);
    assert_eq!(section(&report, "faults"), &json!({"ignored": 2}));
    assert!(report.components.iter().all(|component| component.failures == 0));
}

#[test]
fn luggage_that_nobody_is_left_for_stays_open_and_the_run_ends_incomplete() {
    let scenario =
        "at 1s luggage (1,0) to (4,3); at 2s breakdown 1; at 2s breakdown Robot2; at 3s luggage (1,1) to (4,1)";
    let report = Fleet::of_text(with_scenario(scenario)).run(1, HOUR);
    assert_eq!(report.outcome.status, RunStatus::Incomplete, "{:?}", report.outcome);
    assert_eq!(report.votes.given_up, ["World", "Master", "Environment"]);
    let luggage = json!({"requested": 2, "delivered": 0, "open": 2, "given_up": 2, "ignored": 0});
    assert_eq!(section(&report, "luggage"), &luggage);
    assert_eq!(section(&report, "robots")["broken"], json!(2));
}

#[test]
fn a_breakdown_that_is_the_last_event_of_a_scenario_happens_before_the_run_ends() {
    for scenario in ["at 3s breakdown 2", "at 1s luggage (1,0) to (1,1); at 20s breakdown 2"] {
        let report = Fleet::of_text(with_scenario(scenario)).run(1, HOUR);
        assert_eq!(section(&report, "robots")["broken"], json!(1), "{scenario}");
        assert_eq!(section(&report, "robots")["by_path"]["Robot2"]["state"], json!("broken"), "{scenario}");
    }
}

#[test]
fn a_robot_that_breaks_down_twice_is_one_broken_robot() {
    let scenario = "at 1s breakdown 1; at 2s breakdown 1; at 3s breakdown 2; at 4s end";
    let report = Fleet::of_text(with_scenario(scenario)).run(1, HOUR);
    assert_eq!(section(&report, "robots")["broken"], json!(2));
}

#[test]
fn a_scenario_is_drawn_from_the_seed_within_the_map() {
    let fleet = Fleet::of_text(with_scenario("from 1s every 1s..4s 20 times luggage random to (3,0)..(4,3)"));
    let report = fleet.run(5, HOUR);
    assert_eq!(report.outcome.status, RunStatus::Done, "{:?}", report.outcome);
    let luggage = json!({"requested": 20, "delivered": 20, "open": 0, "given_up": 0, "ignored": 0});
    assert_eq!(section(&report, "luggage"), &luggage);
    assert_eq!(report.trace_hash, fleet.run(5, HOUR).trace_hash);
    assert_ne!(report.trace_hash, fleet.run(6, HOUR).trace_hash);
}

#[test]
fn a_scenario_may_lie_in_a_file_beside_the_composite() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fleet.composite");
    fs::write(&path, fleet("<property name=\"scenario\" file=\"morning.txt\"/>", "")).unwrap();
    fs::write(folder.path().join("morning.txt"), "# Early.\nat 1s luggage (1,0) to (4,3)\n").unwrap();
    let report = Fleet::of_file(&path).run(1, HOUR);
    assert_eq!(section(&report, "luggage")["delivered"], json!(1));
    fs::write(folder.path().join("morning.txt"), "at 1s luggage (1,0) to (4,3)\nthen 1s lading 4\n").unwrap();
    let found = Fleet::of_file(&path).diagnostics();
    assert!(
        found.starts_with("error S3014 2:9 component `Environment`: property `scenario`: found `lading`"),
        "{found}"
    );
}

#[test]
fn much_luggage_at_once_overflows_no_queue() {
    let run = Fleet::of_text(with_scenario("at 1s 3000 times luggage (0,0)..(4,1) to (0,3)..(4,3)"))
        .run(1, Duration::from_secs(10));
    assert_eq!(run.outcome.status, RunStatus::Elapsed, "{:?}", run.outcome);
    assert_eq!(section(&run, "luggage")["requested"], 3000);
    assert_eq!(run.components.iter().map(|one| one.dropped).sum::<u64>(), 0);
}

/// A master that crashes may have heard of luggage and passed nothing on; the one that takes its place knows nothing.
#[test]
fn luggage_that_a_crashed_master_lost_is_asked_for_again() {
    for at in 80..120 {
        let scenario = format!(
            "at 1s luggage (0,0) to (4,3); at 1s visit (3,3) then (0,1); at {}ms crash Master restart 1s",
            10 * at
        );
        let report = Fleet::of_text(with_scenario(&scenario)).run(at, Duration::from_secs(200)).into_report();
        let context = format!("crash at {} ms", 10 * at);
        assert_eq!(section(&report, "luggage")["delivered"], 1, "{context}");
        assert_eq!(section(&report, "errands")["finished"], 1, "{context}");
        let count = |of: &str, name: &str| section(&report, of)[name].as_i64().unwrap_or_default();
        assert!(count("luggage", "requested") - count("scenario", "repeated") <= 1, "{context}");
        assert_eq!(report.outcome.status, RunStatus::Done, "{context}");
    }
}

/// A master that has forgotten what a robot was to bring does not request it when that robot is gone.
#[test]
fn luggage_of_a_robot_that_is_gone_is_asked_for_again_although_no_master_knows_it() {
    for (at, assignment) in [("1900ms", "robots"), ("4s", "robots"), ("1900ms", "oldest"), ("4s", "optimal")] {
        // Robot 1 is on its way to the luggage, or carries it.
        let scenario =
            format!("at 1s luggage (4,0) to (0,3); at 1500ms crash Master restart 200ms; at {at} gone Robot1");
        let master = format!("<property name=\"assignment\">{assignment}</property>");
        let class = "<implementation.java class=\"saoms.MasterEnvironment\"/>";
        let text = with_scenario(&scenario).replacen(class, &[class, &master].concat(), 1);
        let report = Fleet::of_text(text).run(1, Duration::from_secs(200)).into_report();
        assert_eq!(section(&report, "luggage")["delivered"], 1, "{at}, {assignment}");
    }
}

/// Nobody hears of luggage whose announcement is late for ever.
#[test]
fn luggage_that_no_master_hears_of_counts_as_not_delivered() {
    let scenario = "from 1s every 1s 6 times luggage (3,0) to (4,3)\nat 3.5s delay 1h on ETOPIC";
    let mut text = String::new();
    for (id, more) in [
        ("World", ""),
        ("MasterEnvironment", ""),
        ("Environment", &*format!(r#"<property name="scenario">{scenario}</property>"#)),
        ("Robot", r#"<reference name="world" target="World"/>"#),
    ] {
        text += &format!(
            r#"<component name="{id}"><implementation.rust class="saoms.{id}"/>
            <property name="ID">{id}1</property><property name="period">100</property>{more}</component>"#
        );
    }
    let fleet = Fleet::of_text(format!(
        r#"<composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" name="f" targetNamespace="urn:f">
{text}</composite>"#
    ));
    let run = fleet.run(1, Duration::from_secs(60));
    assert_eq!((run.count("luggage.requested"), run.count("scenario.luggage")), (3, 6), "{}", run.log());
}

/// As the program of the world does where it starts later than that of the environment.
#[test]
fn a_world_that_is_heard_late_counts_all_luggage_itself() {
    let scenario = "at 0s 2 times luggage (1,1) to (2,1); at 0s visit (3,1); at 10s landing 4";
    let mut environment = Bench::of::<Environment>(&[("scenario", scenario)]).unwrap();
    environment.start().unwrap();
    environment.execute().unwrap();
    assert_eq!(environment.report("luggage.open"), Some(&ReportValue::Integer(2)), "there may be no world");
    environment.deliver(&AREA, Area::from(&Map::new(5, 5)));
    let delivered = EventLuggage::request(1, Block::new(1, 1), Block::new(2, 1));
    let delivered = EventLuggage { stage: LuggageStage::Delivered, robot: 1, ..delivered };
    environment.deliver(&EVENT_LUGGAGE, delivered);
    environment.execute().unwrap();
    let counts = ["luggage.open", "errands.open"].map(|count| environment.report(count).cloned());
    assert_eq!(counts, [0, 1].map(|count| Some(ReportValue::Integer(count))));
}
