//! The problems of the table, and what is published about them.

use std::fs;
use std::path::{Path, PathBuf};

use saoms_components::grid::Map;
use saoms_testkit::Problem;

use crate::common::Outcome;

/// A row of the table.
pub(crate) struct Instance {
    pub(crate) name: String,
    pub(crate) source: Source,
    pub(crate) steps: u32,
    /// Numbers of others, or of earlier, with their names.
    pub(crate) published: &'static str,
}

/// Where a problem comes from.
pub(crate) enum Source {
    /// The JSON file of the League of Robot Runners.
    File(PathBuf),
    /// A map, robots and pieces of luggage that are all there from the start; one problem for each seed.
    Luggage { map: PathBuf, robots: usize, pieces: usize, seeds: u64 },
}

impl Source {
    pub(crate) fn seeds(&self) -> u64 {
        match self {
            Source::File(_) => 1,
            Source::Luggage { seeds, .. } => *seeds,
        }
    }

    pub(crate) fn problem(&self, seed: u64) -> Outcome<Problem> {
        match self {
            Source::File(path) => read(path),
            Source::Luggage { map, robots, pieces, .. } => {
                let text = fs::read_to_string(map).map_err(|error| format!("{}: {error}", map.display()))?;
                let map = Map::read(&text).map_err(|faults| format!("{}: {}", map.display(), faults[0].message))?;
                Ok(Problem::of_luggage(map, *robots, *pieces, seed))
            }
        }
    }

    /// True if it is judged by when all is done, rather than by how much is done in time.
    pub(crate) fn is_finite(&self) -> bool {
        matches!(self, Source::Luggage { .. })
    }
}

/// Reads a problem; an error has all its faults.
pub(crate) fn read(path: &Path) -> Outcome<Problem> {
    Problem::read(path).map_err(|faults| {
        let all: Vec<String> = faults.iter().map(ToString::to_string).collect();
        all.join("\n").into()
    })
}

/// Steps after which luggage that is not delivered never will be.
const WHOLE: u32 = 3000;

/// All instances whose files are there: the traps, and those of the folder with the data of others.
pub(crate) fn instances(data: &Path, seeds: u64) -> Vec<Instance> {
    let movingai = |name: &str| data.join("movingai").join(name);
    let lorr = |name: &str| data.join("lorr").join(name);
    let luggage = |name: &str, map: PathBuf, robots: usize, pieces: usize, published: &'static str| Instance {
        name: format!("{name}, {robots} robots, {pieces} pieces"),
        source: Source::Luggage { map, robots, pieces, seeds },
        steps: WHOLE,
        published,
    };
    let warehouse = lorr("2023/warehouse.domain/maps/warehouse_small.map");
    let mut all = vec![
        luggage("empty-16-16", movingai("empty-16-16.map"), 10, 100, "oldest 220, nearest 155.6, Hungarian 155.1"),
        luggage("warehouse_small", warehouse, 10, 100, "oldest 634, nearest 425, Hungarian 417"),
        luggage("random-32-32-10", movingai("random-32-32-10.map"), 10, 100, "-"),
        luggage("random-32-32-10", movingai("random-32-32-10.map"), 50, 500, "-"),
        luggage("random-32-32-10", movingai("random-32-32-10.map"), 100, 500, "-"),
        luggage("maze-32-32-4", movingai("maze-32-32-4.map"), 50, 200, "-"),
    ];
    let runner = |name: &str, path: PathBuf, steps: u32, published: &'static str| Instance {
        name: name.to_owned(),
        source: Source::File(path),
        steps,
        published,
    };
    for (robots, published) in
        [(10, "bound 324, PIBT 318"), (50, "bound 1588, PIBT 1450"), (100, "bound 3260, PIBT 2607")]
    {
        let path = lorr(&format!("2023/warehouse.domain/warehouse_small_{robots}.json"));
        all.push(runner(&format!("LoRR 2023 warehouse_small, {robots} robots"), path, 1000, published));
    }
    let path = lorr("2024/random.domain/random_32_32_20_100.json");
    let published = "oldest 979-1010, nearest 1538, Hungarian 1576-1590";
    all.push(runner("LoRR 2024 random, 100 robots", path, 500, published));
    for trap in ["string", "tree", "tunnel", "corners"] {
        let path = PathBuf::from(format!("benches/problems/traps/{trap}.json"));
        all.push(runner(trap, path, 500, "solvable"));
    }
    all.retain(|one| match &one.source {
        Source::File(path) | Source::Luggage { map: path, .. } => path.exists(),
    });
    all
}
