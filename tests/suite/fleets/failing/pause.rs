//! Robots that are unscheduled in the middle of a job and scheduled again later: they start new, and luggage is neither
//! lost nor delivered twice.

use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, Properties, TaskInterface, TaskInterfaceReference};
use saoms_core::report::RunStatus;
use saoms_testkit::Fleet;
use serde_json::json;

/// Lets a task pause.
#[derive(Class)]
#[class(name = "test.Foreman", periodic, reference("task": TaskInterface))]
struct Foreman {
    properties: ForemanProperties,
    task: TaskInterfaceReference,
}

#[derive(Properties)]
struct ForemanProperties {
    /// In which execution the pause begins, and ends.
    from: u64,
    until: u64,
}

impl Component for Foreman {
    type Properties = ForemanProperties;

    fn new(properties: ForemanProperties) -> Result<Self, Failure> {
        Ok(Foreman { properties, task: TaskInterfaceReference::default() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.task = context.reference("task")?;
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        let now = context.execution();
        if now == self.properties.from {
            self.task.unschedule(context)?;
        } else if now == self.properties.until {
            self.task.schedule(context)?;
        }
        Ok(())
    }
}

/// So many robots bring four pieces, and the first of them pauses.
fn paused(robots: u32, from: u64, length: u64) -> Fleet {
    let component = |name: &str, class: &str, inside: &str| {
        format!(
            "<component name=\"{name}\"><implementation.java class=\"{class}\"/><property name=\"ID\">{name}</property><property name=\"period\">100</property>{inside}</component>\n"
        )
    };
    let property = |name: &str, value: &str| format!("<property name=\"{name}\">{value}</property>");
    let scenario = "at 500ms luggage (3,1) to (3,5); at 500ms luggage (5,2) to (1,4); at 2s luggage (6,6) to (2,1); at 3s luggage (2,3) to (5,5)";
    let times = property("moveTime", "150") + &property("handlingTime", "250");
    let mut text = component("World", "saoms.World", &times)
        + &component("Master", "saoms.MasterEnvironment", "")
        + &component("Environment", "saoms.Environment", &property("scenario", scenario))
        + &component(
            "Foreman",
            "test.Foreman",
            &(property("from", &from.to_string())
                + &property("until", &(from + length).to_string())
                + "<reference name=\"task\" target=\"Robot1/TaskInterface\"/>"),
        );
    for robot in 1..=robots {
        let inside = property("discharge", "0.5") + "<reference name=\"world\" target=\"World\"/>";
        text += &component(&format!("Robot{robot}"), "saoms.Robot", &inside);
    }
    let start =
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" name=\"t\" targetNamespace=\"urn:t\">";
    Fleet::of_text(format!("{start}\n{text}</composite>"))
}

#[test]
fn a_robot_that_pauses_at_any_moment_loses_nothing() {
    for (robots, length) in [(2, 3), (2, 60), (3, 15), (1, 15)] {
        for from in (2..70).step_by(3) {
            let run = paused(robots, from, length).run(from, Duration::from_secs(600));
            let log = run.log();
            let context = format!("{robots} robots, paused from execution {from} for {length}:\n{log}");
            assert_eq!(run.sections["collisions"], json!({"vertex": 0, "swap": 0}), "{context}");
            let count = |name: &str| run.sections["luggage"][name].as_u64().unwrap();
            // While the only robot is away no robot is left, which is reported.
            let given_up = log.lines().filter(|line| line.contains("gives up luggage")).count() as u64;
            assert_eq!((count("delivered") + given_up, count("open")), (4, given_up), "{context}");
            assert!(robots == 1 || given_up == 0, "{context}");
            let status = if given_up > 0 { RunStatus::Incomplete } else { RunStatus::Done };
            assert_eq!(run.outcome.status, status, "{context}");
        }
    }
}
