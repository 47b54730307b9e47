//! Problems of fleets: a map, robots with their starts, and what they have to do, for tests and benchmarks.

mod composite;
mod fault;
mod grid;
mod lorr;

use saoms_components::grid::{Block, Map};

pub use composite::ProblemFleet;
pub use fault::ProblemFault;

/// A map, robots, and what they have to do.
///
/// ```
/// use std::path::Path;
/// use std::time::Duration;
/// use saoms_testkit::{Fleet, ProblemFleet, Problem};
///
/// let problem = Problem::read(Path::new("../benches/problems/traps/corners.json")).unwrap();
/// let text = problem.composite(&ProblemFleet::default());
/// let run = Fleet::of_text(text).run(1, Duration::from_secs(200));
/// assert_eq!(run.sections["errands"]["finished"], 2);
/// ```
#[derive(Clone, Debug)]
pub struct Problem {
    /// The map.
    pub map: Map,
    /// Blocks where the robots start. Robot 1 is the first one. They have no battery, and rest there.
    pub starts: Vec<Block>,
    /// What they have to do, in the order of its appearance.
    pub tasks: Vec<Task>,
    /// Number of tasks that are visible at once; `None` if all are from the start.
    pub revealed: Option<usize>,
}

/// A task of a [`Problem`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Task {
    /// Luggage to bring from one block to another.
    Luggage(Block, Block),
    /// Blocks to visit in this order.
    Visit(Vec<Block>),
    /// A block that the robot with this index has to visit.
    VisitBy(Block, usize),
}

impl Task {
    /// The blocks where a robot has to be, in their order.
    pub fn stops(&self) -> Vec<Block> {
        match self {
            Task::Luggage(from, to) => vec![*from, *to],
            Task::Visit(stops) => stops.clone(),
            Task::VisitBy(stop, _) => vec![*stop],
        }
    }
}
