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

/// An airport with `robots` robots of this period, spread over a map. Luggage appears repeatedly near each of them,
/// during `lasting`. The masters and the environment act twice as often as a robot, as in the original's files.
pub(crate) fn airport(robots: u32, period: Duration, phases: Phases, lasting: Duration) -> String {
    let columns = (1..).find(|columns| columns * columns >= robots).unwrap_or(1);
    let side = (columns * SPACING + 1).to_string();
    let place = |robot: u32| (robot % columns * SPACING, robot / columns * SPACING);
    let mut composite = Composite::new();
    let task = |class, name: &str, period| Task { class, name: name.to_owned(), period, delay: Duration::ZERO };
    composite.add(&task("saoms.World", "World", period), &[("width", &side), ("height", &side)]);
    let half = period / 2;
    composite.add(&task("unibg.saoms.MasterEnvironmentManagingSystem", "MasterEnvironment", half), &[]);
    composite.add(&task("unibg.saoms.MasterRobotManagingSystem", "MasterRobot", half), &[]);
    let mut scenario = String::new();
    let periods = u32::try_from(lasting.as_nanos() / period.as_nanos()).unwrap_or(u32::MAX);
    // The last wave comes after the end, so that there is always open work.
    for wave in 0..=periods / LUGGAGE_EVERY + 1 {
        for robot in 0..robots {
            let ((x, y), at) = (place(robot), format_duration(period * LUGGAGE_EVERY * wave));
            let _ = writeln!(scenario, "at {at} luggage ({},{}) to ({},{})", x + 1, y + 2, x + 4, y + 3);
        }
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
