//! Generated composite files.

use std::fmt::Write as _;
use std::time::Duration;

use saoms_api::host::format_duration;
use serde::{Deserialize, Serialize};

/// The text of a composite, component by component.
pub(crate) struct Composite {
    text: String,
}

/// Task of a component of a [`Composite`].
pub(crate) struct Task {
    pub(crate) class: &'static str,
    pub(crate) name: String,
    pub(crate) period: Duration,
    pub(crate) delay: Duration,
}

impl Composite {
    pub(crate) fn new() -> Self {
        let text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
            <composite xmlns=\"http://www.osoa.org/xmlns/sca/1.0\" targetNamespace=\"urn:benchmark\" name=\"benchmark\">\n";
        Self { text: text.to_owned() }
    }

    /// Adds a periodic component with `properties` beside those of its task, which are written as the original's files
    /// do.
    pub(crate) fn add(&mut self, task: &Task, properties: &[(&str, &str)]) {
        self.open(task, properties);
        self.close();
    }

    fn open(&mut self, task: &Task, properties: &[(&str, &str)]) {
        let Task { class, name, period, delay } = task;
        let (period, delay) = (format_duration(*period), format_duration(*delay));
        let common = [
            ("ID", name.as_str()),
            ("period", &period),
            ("delay", &delay),
            ("runOnStartup", "true"),
            ("mayInterruptIfRunning", "true"),
            ("useJMS", "true"),
        ];
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "  <component name=\"{name}\">\n    <implementation.java class=\"{class}\"/>");
        for (property, value) in common.iter().chain(properties) {
            let _ = writeln!(self.text, "    <property name=\"{property}\">{value}</property>");
        }
    }

    fn close(&mut self) {
        self.text.push_str("  </component>\n");
    }

    /// The whole file.
    pub(crate) fn finish(mut self) -> String {
        self.text.push_str("</composite>\n");
        self.text
    }
}

/// Blocks between the chargers of two neighbours.
const SPACING: u32 = 5;
/// Number of periods from one piece of luggage to the next, for each robot.
const LUGGAGE_EVERY: u32 = 25;

/// Phases of the robots of a fleet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Phases {
    /// One after the other, spread evenly over the period.
    Spread,
    /// All at the same time.
    Together,
}

/// An airport of robots, spread over a map.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Airport {
    pub(crate) robots: u32,
    pub(crate) period: Duration,
    pub(crate) phases: Phases,
    /// Time from one piece of luggage near a robot to the next.
    pub(crate) luggage_every: Duration,
    /// True if a zone grants the blocks of the map.
    pub(crate) zone: bool,
}

impl Airport {
    /// An airport without a zone, with much luggage.
    pub(crate) fn new(robots: u32, period: Duration, phases: Phases) -> Self {
        Self { robots, period, phases, luggage_every: period * LUGGAGE_EVERY, zone: false }
    }
}

/// The composite of an airport. Luggage appears repeatedly near each robot, during `lasting`. The masters and the
/// environment act twice as often as a robot, as in the original's files.
pub(crate) fn airport(airport: Airport, lasting: Duration) -> String {
    let Airport { robots, period, phases, luggage_every, zone } = airport;
    let columns = (1..).find(|columns| columns * columns >= robots).unwrap_or(1);
    let side = (columns * SPACING + 1).to_string();
    let place = |robot: u32| (robot % columns * SPACING, robot / columns * SPACING);
    let mut composite = Composite::new();
    let task = |class, name: &str, period| Task { class, name: name.to_owned(), period, delay: Duration::ZERO };
    composite.add(&task("saoms.World", "World", period), &[("width", &side), ("height", &side)]);
    let half = period / 2;
    composite.add(&task("unibg.saoms.MasterEnvironmentManagingSystem", "MasterEnvironment", half), &[]);
    composite.add(&task("unibg.saoms.MasterRobotManagingSystem", "MasterRobot", half), &[]);
    if zone {
        composite.open(&task("saoms.Zone", "Zone", period), &[]);
        composite.text.push_str("    <reference name=\"world\" target=\"World\"/>\n");
        composite.close();
    }
    let mut scenario = String::new();
    // The last wave comes after the end, so that there is always open work.
    let waves = lasting.as_nanos() / luggage_every.as_nanos() + 2;
    for robot in 0..robots {
        let ((x, y), every) = (place(robot), format_duration(luggage_every));
        let (from, to) = ((x + 1, y + 2), (x + 4, y + 3));
        let _ = writeln!(
            scenario,
            "from 0s every {every} {waves} times luggage ({},{}) to ({},{})",
            from.0, from.1, to.0, to.1
        );
    }
    composite.add(&task("launch.Environment", "Environment", half), &[("scenario", &scenario)]);
    for robot in 0..robots {
        let (x, y) = place(robot);
        let name = format!("Robot{:05}", robot + 1);
        let delay = if phases == Phases::Spread { period * robot / robots } else { Duration::ZERO };
        let properties = [("chargeX", x), ("chargeY", y)].map(|(name, value)| (name, value.to_string()));
        composite.open(
            &Task { class: "saoms.Robot", name, period, delay },
            &properties.each_ref().map(|(name, value)| (*name, value.as_str())),
        );
        composite.text.push_str("    <reference name=\"world\" target=\"World\"/>\n");
        composite.close();
    }
    composite.finish()
}
