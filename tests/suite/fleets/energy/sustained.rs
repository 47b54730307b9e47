//! Endless work and the charge of the robots: what the checker refuses piles up in the simulation, and what it says
//! nothing about is worked off.

use std::fmt::Write as _;
use std::time::Duration;

use saoms_testkit::Fleet;

/// A fleet on an area of 16 x 16 blocks with chargers along the left edge, and luggage for ever.
#[derive(Clone, Copy)]
struct Setting {
    robots: u32,
    discharge: &'static str,
    /// Milliseconds of a move, and of collecting or depositing.
    times: (u32, u32),
    luggage: &'static str,
}

impl Setting {
    /// The same with a piece each so many milliseconds, so often or for ever.
    fn fleet(&self, every: u32, often: &str) -> Fleet {
        let Setting { robots, discharge, times: (moving, handling), luggage } = *self;
        let mut text = "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:t\" name=\"t\">\n".to_owned();
        let mut add = |name: &str, class: &str, inside: &str| {
            writeln!(text, "<component name=\"{name}\"><implementation.java class=\"{class}\"/><property name=\"ID\">{name}</property><property name=\"period\">100</property>{inside}</component>").unwrap();
        };
        let property = |name: &str, value: &str| format!("<property name=\"{name}\">{value}</property>");
        let times = [("width", 16), ("height", 16), ("moveTime", moving), ("handlingTime", handling)]
            .map(|(name, value)| property(name, &value.to_string()))
            .concat();
        let scenario = format!("from 1s every {every}ms {often} luggage {luggage}");
        add("World", "saoms.World", &times);
        add("Master", "saoms.MasterEnvironment", "");
        add("Environment", "saoms.Environment", &property("scenario", &scenario));
        for robot in 1..=robots {
            let world = "<reference name=\"world\" target=\"World\"/>";
            add(&format!("Robot{robot}"), "saoms.Robot", &(property("discharge", discharge) + world));
        }
        Fleet::of_text(text + "</composite>")
    }

    /// The findings of the checker.
    fn severity(&self, every: u32) -> String {
        let found = self.fleet(every, "").diagnostics();
        assert!(found.lines().count() <= 1 && (found.is_empty() || found.contains(" S5006 ")), "{found}");
        found.split(' ').next().unwrap_or("").to_owned()
    }

    /// The number of pieces that wait after so many seconds.
    fn backlog(&self, every: u32, seconds: u64) -> u64 {
        // The checker says nothing about work that ends some time.
        let report = self.fleet(every, "1000000 times").run(1, Duration::from_secs(seconds));
        report.sections["luggage"]["open"].as_u64().unwrap()
    }
}

const ONE: Setting = Setting { robots: 1, discharge: "2", times: (0, 0), luggage: "(5,1) to (10,1)" };
const SLOW: Setting = Setting { robots: 1, discharge: "0.5", times: (100, 300), luggage: "(5,1) to (10,8)" };
/// A move takes three executions: 250 ms are over in the third one.
const FOUR: Setting =
    Setting { robots: 4, discharge: "0.3", times: (250, 500), luggage: "(3,0)..(15,15) to (3,0)..(15,15)" };
const TIRELESS: Setting = Setting { discharge: "0", times: (0, 0), ..FOUR };

#[test]
fn what_is_refused_piles_up_and_what_is_not_told_is_worked_off() {
    for (setting, holds, likely, never) in
        [(ONE, 3200, 2800, 1100), (SLOW, 5600, 4400, 3500), (FOUR, 4000, 3500, 900), (TIRELESS, 700, 600, 230)]
    {
        let Setting { luggage, robots, .. } = setting;
        let said = [holds, likely, never].map(|every| setting.severity(every));
        assert_eq!(said, ["", "warning", "error"], "{robots} robots, {luggage}");
        let end = setting.backlog(holds, 300);
        assert!(end <= 2 * u64::from(robots), "{robots} robots, {luggage}: {end} pieces wait");
        let [middle, end] = [100, 200].map(|seconds| setting.backlog(never, seconds));
        let asked = u64::from(200_000 / never);
        assert!(
            end > asked / 10 && end > middle * 3 / 2,
            "{robots} robots, {luggage}: {middle}, then {end} of {asked}"
        );
    }
}

#[test]
fn what_is_in_reach_is_brought_and_what_is_not_is_given_up() {
    // 300 ms of handling are three executions, and a full battery lasts for 50: 19 moves there and back, two to be sure
    // and a third of the way.
    let far = Setting { times: (0, 300), luggage: "", ..ONE };
    let brought = |luggage: &'static str| {
        let fleet = Setting { luggage, ..far }.fleet(60_000, "1 times");
        let found = fleet.diagnostics();
        let report = fleet.with_severity("S5006", "warning").run(1, Duration::from_secs(900));
        (found.split(' ').next().unwrap_or("").to_owned(), report.sections["luggage"]["delivered"].as_u64().unwrap())
    };
    assert_eq!(brought("(1,1) to (14,6)"), (String::new(), 1), "19 moves from (0,1)");
    assert_eq!(brought("(1,1) to (15,6)..(15,7)"), ("error".to_owned(), 0), "20 moves or more");
}

#[test]
fn only_endless_work_is_too_much() {
    let often = ONE.fleet(500, "10000 times").diagnostics();
    assert_eq!(often, "");
    let shown = ONE.fleet(500, "").shown();
    for part in ["each piece takes at least 1.2 s of a robot's time", "use 3 robots, each with its own charger"] {
        assert!(shown.contains(part), "{shown}");
    }
}
