//! The output of `saoms expand` runs as the fleet did.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use saoms_api::{Class, Component, Context, Failure, interface};
use saoms_core::report::RunReport;
use saoms_testkit::Fleet;

use crate::support::{root, saoms, saoms_in, shipped};

/// Everything that is reported of a run: the digest of all effects, and the counts of every component.
fn facts(report: &RunReport) -> (Option<String>, Vec<(String, u64)>) {
    let components = report.components.iter().map(|one| (one.name.to_string(), one.executions));
    (report.trace_hash.clone(), components.collect())
}

fn runs_the_same(fleet: &Fleet) {
    let text = fleet.expanded();
    let alone = Fleet::of_text(text.as_str());
    assert_eq!(alone.expanded(), text);
    let (before, after) = (fleet.run(7, Duration::from_secs(60)), alone.run(7, Duration::from_secs(60)));
    assert!(before.trace_hash.is_some());
    assert_eq!(facts(&before), facts(&after), "{text}");
}

#[test]
fn shipped_fleets_run_the_same_when_they_are_expanded() {
    let of_composites =
        ["teams/teams.composite", "sites/sites.composite"].map(|path| root().join("composites").join(path));
    for path in shipped().into_iter().chain(of_composites) {
        runs_the_same(&Fleet::of_file(&path));
    }
}

#[test]
fn a_fleet_comes_to_what_it_came_to() {
    let tests = root().join("tests/fleets");
    let pair = Fleet::of_file(tests.join("pair.composite")).set("period", "50");
    pair.expect_expanded(tests.join("pair.expanded"));
}

/// Counts what it is asked.
#[interface(name = "expand.Lamp")]
trait Lamp {
    /// Switches it; how often that was.
    fn switch(&mut self, context: &mut Context<'_>) -> Result<u32, Failure>;
}

/// A lamp.
#[derive(Class)]
#[class(name = "expand.LampImpl", passive, service("lamp": Lamp))]
struct LampImpl {
    count: u32,
}

impl Component for LampImpl {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(LampImpl { count: 0 })
    }
}

impl Lamp for LampImpl {
    fn switch(&mut self, context: &mut Context<'_>) -> Result<u32, Failure> {
        self.count += 1;
        let path = format!("lamps.{}", context.name().replace('/', "-"));
        context.report(&path, i64::from(self.count));
        Ok(self.count)
    }
}

/// Switches all lamps it is wired to, in order.
#[derive(Class)]
#[class(name = "expand.Switch", periodic, reference("lamps": Lamp, optional, many))]
struct Switch {
    lamps: Vec<LampReference>,
}

impl Component for Switch {
    type Properties = ();

    fn new((): ()) -> Result<Self, Failure> {
        Ok(Switch { lamps: Vec::new() })
    }

    fn initialize(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        self.lamps = context.references("lamps")?;
        let first: LampReference = context.reference("lamps")?;
        assert_eq!(context.is_wired(&first), !self.lamps.is_empty());
        Ok(())
    }

    fn execute(&mut self, context: &mut Context<'_>) -> Result<(), Failure> {
        for lamp in &self.lamps {
            assert!(context.is_wired(lamp));
            lamp.switch(context)?;
        }
        Ok(())
    }
}

/// A house of floors, each a composite with two lamps, in files beside each other.
fn house() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let composite = |name: &str, inside: &str| {
        let text = format!(
            "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' targetNamespace='urn:h' xmlns:h='urn:h' name='{name}'>{inside}</composite>"
        );
        fs::write(folder.path().join(format!("{name}.composite")), text).unwrap();
    };
    composite(
        "house",
        "<property name='pace'>100ms</property><include name='h:cellar'/>
         <component name='up'><implementation.composite name='h:floor'/></component>
         <component name='down'><implementation.composite name='h:floor'/></component>
         <component name='switch'><implementation.java class='expand.Switch'/><property name='ID'>s</property><property name='period' source='$pace'/>
            <reference name='lamps' target='up/left up/right down/left'/></component>",
    );
    composite(
        "floor",
        "<service name='left' promote='a/lamp'/><service name='right' promote='b'/>
         <component name='a'><implementation.java class='expand.LampImpl'/></component>
         <component name='b'><implementation.java class='expand.LampImpl'/></component>",
    );
    composite(
        "cellar",
        "<component name='night'><implementation.java class='expand.Switch'/><property name='ID'>n</property><property name='period' source='$pace'/></component>
         <wire source='night/lamps' target='down/right'/>",
    );
    let path = folder.path().join("house.composite");
    (folder, path)
}

#[test]
fn composites_in_composites_run_and_call_all_targets_of_a_reference() {
    let (_folder, path) = house();
    let fleet = Fleet::of_file(&path);
    assert_eq!(fleet.diagnostics(), "");
    let report = fleet.run(1, Duration::from_secs(1));
    let lamps = serde_json::to_value(&*report).unwrap()["lamps"].clone();
    assert_eq!(lamps, serde_json::json!({"up-a": 10, "up-b": 10, "down-a": 10, "down-b": 10}));
    runs_the_same(&fleet);
    runs_the_same(&fleet.set("pace", "20"));
}

#[test]
fn the_command_writes_a_composite_that_checks() {
    let output = saoms(&["expand", "composites/airport.composite", "--set", "period=20"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flat.composite");
    fs::write(&path, &output.stdout).unwrap();
    let path = path.display().to_string();
    assert_eq!(saoms(&["check", &path]).status.code(), Some(0));
    assert_eq!(saoms(&["expand", &path]).stdout, output.stdout, "nothing is left to expand");
    assert_eq!(saoms(&["fmt", "--check", &path]).status.code(), Some(0), "it is in the one layout");
    assert_eq!(saoms(&["expand", "composites/none.composite"]).status.code(), Some(2));
}

#[test]
fn composites_of_another_contribution_are_found_from_every_folder() {
    let folder = tempfile::tempdir().unwrap();
    let write = |path: &str, text: String| {
        let path = folder.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    let sca = "http://docs.oasis-open.org/ns/opencsa/sca/200912";
    let description = |inside: &str| format!("<contribution xmlns='{sca}'>{inside}</contribution>");
    write("fleet/sca-contribution.xml", description("<import namespace='urn:h'/>"));
    let composite = |namespace: &str, name: &str, inside: &str| {
        format!(
            "<composite xmlns='{sca}' targetNamespace='{namespace}' xmlns:h='urn:h' name='{name}'>{inside}</composite>"
        )
    };
    write("fleet/part/fleet.composite", composite("urn:f", "fleet", "<include name='h:pair'/>"));
    write("halls/sca-contribution.xml", description("<export namespace='urn:h'/>"));
    write(
        "halls/pair.composite",
        composite(
            "urn:h",
            "pair",
            "<component name='m'><implementation.java class='unibg.robotics.tca.MessageBrokerImpl'/></component>",
        ),
    );
    for (inside, path) in
        [("", "fleet/part/fleet.composite"), ("fleet", "part/fleet.composite"), ("fleet/part", "fleet.composite")]
    {
        let output = saoms_in(&folder.path().join(inside), &["expand", path]);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.contains("name=\"m\""), "{path}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
