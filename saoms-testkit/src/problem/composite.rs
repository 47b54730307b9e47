//! The composite of a problem.

use std::fmt::Write as _;
use std::time::Duration;

use saoms_api::host::format_duration;
use saoms_components::grid::{Block, Map};

use super::{Problem, Task};

/// The times and policies of a fleet that solves a [`Problem`].
#[derive(Clone, Copy, Debug)]
pub struct ProblemFleet {
    /// Time of a move to the next block.
    pub step: Duration,
    /// Number of executions of robots, master and environment in a step.
    pub executions: u32,
    /// Number of steps that the run lasts: no more tasks are written than robots can do in that time.
    pub steps: u32,
    /// True if a zone grants the robots the blocks that they enter; otherwise they agree among themselves.
    pub zone: bool,
    /// Who assigns luggage: the property `assignment` of the master.
    pub assignment: &'static str,
}

impl Default for ProblemFleet {
    /// Five executions in a step of one second, for a thousand steps, with a zone and the optimal assignment.
    fn default() -> ProblemFleet {
        ProblemFleet { step: Duration::from_secs(1), executions: 5, steps: 1000, zone: true, assignment: "optimal" }
    }
}

impl Problem {
    /// A composite that solves the problem: robots without a battery on a `saoms.World`, and an environment with the
    /// tasks as its scenario. They appear after the first step: then the robots know each other.
    pub fn composite(&self, fleet: &ProblemFleet) -> String {
        let period = fleet.step / fleet.executions.max(1);
        // Requests of one execution of the robots are answered before the next one, though grants wait for a commit.
        let delay = format_duration(period - period / 10);
        let period = format_duration(period);
        let step = format_duration(fleet.step);
        let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
            <composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:problem\" \
            name=\"problem\">\n"
            .to_owned();
        let map = rows(&self.map);
        component(&mut text, "World", "World", &[("period", &step), ("moveTime", &step), ("map", &map)], "");
        let world = "    <reference name=\"world\" target=\"World\"/>\n";
        if fleet.zone {
            component(&mut text, "Zone", "Zone", &[("period", &period), ("delay", &delay)], world);
        }
        let master = [("period", period.as_str()), ("assignment", fleet.assignment)];
        component(&mut text, "Master", "MasterEnvironment", &master, "");
        let scenario = self.scenario(fleet);
        let most = self.revealed.map(|most| most.to_string());
        let most = most.as_deref().map(|most| ("mostOpen", most));
        let properties: Vec<(&str, &str)> =
            [("period", period.as_str()), ("scenario", &scenario)].into_iter().chain(most).collect();
        component(&mut text, "Environment", "Environment", &properties, "");
        for (index, start) in self.starts.iter().enumerate() {
            let (x, y) = (start.x.to_string(), start.y.to_string());
            let properties = [("period", period.as_str()), ("chargeX", &x), ("chargeY", &y), ("discharge", "0")];
            component(&mut text, &format!("Robot{}", index + 1), "Robot", &properties, world);
        }
        text.push_str("</composite>\n");
        text
    }

    /// The tasks as lines of a scenario, no more than robots can do: a task takes at least as many steps as its blocks
    /// are apart.
    fn scenario(&self, fleet: &ProblemFleet) -> String {
        let mut text = String::new();
        let start = format_duration(fleet.step);
        let steps = u64::from(fleet.steps);
        let mut left = vec![steps; self.starts.len()];
        let mut at = self.starts.clone();
        // Short tasks may be done first.
        let mut work = 2 * steps * self.starts.len() as u64;
        for (index, task) in self.tasks.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = match task {
                Task::Luggage(from, to) => writeln!(text, "at {start} luggage {from} to {to}"),
                Task::VisitBy(stop, robot) => {
                    let distance = u64::from(at[*robot].distance(*stop));
                    if left[*robot] == 0 {
                        continue;
                    }
                    left[*robot] = left[*robot].saturating_sub(distance);
                    at[*robot] = *stop;
                    writeln!(text, "at {start} visit {stop} by {}", robot + 1)
                }
                Task::Visit(stops) => {
                    if work == 0 && index > self.revealed.unwrap_or(usize::MAX) {
                        break;
                    }
                    let moves = stops.windows(2).map(|two| u64::from(two[0].distance(two[1]))).sum();
                    work = work.saturating_sub(moves);
                    let stops: Vec<String> = stops.iter().map(Block::to_string).collect();
                    writeln!(text, "at {start} visit {}", stops.join(" then "))
                }
            };
        }
        text
    }
}

fn component(text: &mut String, name: &str, class: &str, properties: &[(&str, &str)], more: &str) {
    let _ = write!(
        text,
        "  <component name=\"{name}\">\n    <implementation.rust class=\"saoms.{class}\"/>\n    \
         <property name=\"ID\">{name}</property>\n"
    );
    for (property, value) in properties {
        let _ = writeln!(text, "    <property name=\"{property}\">{value}</property>");
    }
    let _ = writeln!(text, "{more}  </component>");
}

fn rows(map: &Map) -> String {
    let sign = |place: usize| if map.is_free(map.block(place)) { '.' } else { '@' };
    let width = map.width() as usize;
    let rows = (0..map.height() as usize).map(|row| (row * width..(row + 1) * width).map(sign).collect::<String>());
    rows.fold(String::new(), |text, row| text + "\n" + &row) + "\n"
}
