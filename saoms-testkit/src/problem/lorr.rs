//! Problems of the League of Robot Runners, as its JSON files describe them.
//!
//! 2023: each task is a cell to visit; with `roundrobin` robot i does the tasks i, i + N, i + 2 N. 2024: each task is a
//! list of cells to visit in order, by any robot. A cell is `row * width + column`.

use std::fs;
use std::path::{Path, PathBuf};

use saoms_components::grid::{Block, Map};
use serde_json::Value;

use super::{Problem, ProblemFault, Task};

/// The greatest number of faults that are reported.
const MOST_FAULTS: usize = 20;

impl Problem {
    /// Reads the JSON file of a problem, and the files that it names, from its folder.
    ///
    /// # Errors
    /// Everything that is wrong with them: a missing file, a robot on a wall, a cell outside the map.
    pub fn read(path: &Path) -> Result<Problem, Vec<ProblemFault>> {
        let one = |fault| vec![fault];
        let text = load(path, "name the JSON file of a problem").map_err(one)?;
        let json: Value = serde_json::from_str(&text).map_err(|error| {
            let place = Some((error.line(), error.column().max(1)));
            let (message, help) = (format!("this is no JSON: {error}"), "correct the file".to_owned());
            one(ProblemFault { file: path.to_owned(), place, message, help })
        })?;
        let main = Main { path, text: &text, json };
        let (map_path, map_text) = main.file("mapFile").map_err(one)?;
        let map = Map::read(&map_text).map_err(|faults| {
            let fault = |fault: saoms_components::text::TextFault| {
                let help = fault.help.as_deref().unwrap_or("correct the map");
                ProblemFault::at(&map_path, &map_text, fault.bytes.start, fault.message.clone(), help)
            };
            faults.into_iter().take(MOST_FAULTS).map(fault).collect::<Vec<_>>()
        })?;
        let team = main.number("teamSize").map_err(one)?;
        let revealed = main.revealed(team).map_err(one)?;
        let by_turns = main.by_turns().map_err(one)?;
        let (agents_path, agents_text) = main.file("agentFile").map_err(one)?;
        let (tasks_path, tasks_text) = main.file("taskFile").map_err(one)?;
        let mut faults = Vec::new();
        let agents = Cells { path: &agents_path, text: &agents_text, map: &map };
        let starts = agents.starts(team, &mut faults);
        let tasks = Cells { path: &tasks_path, text: &tasks_text, map: &map };
        let tasks = tasks.lists(usize::MAX, "a robot cannot be there", &mut faults);
        if !faults.is_empty() {
            faults.truncate(MOST_FAULTS);
            return Err(faults);
        }
        let task = |(index, stops): (usize, Vec<(Block, usize)>)| match stops[..] {
            [(stop, _)] if by_turns => Task::VisitBy(stop, index % team),
            _ => Task::Visit(stops.into_iter().map(|(stop, _)| stop).collect()),
        };
        // A robot that does its own tasks in their order needs no more than the next one.
        let revealed = Some(revealed).filter(|_| !by_turns);
        Ok(Problem { map, starts, tasks: tasks.into_iter().enumerate().map(task).collect(), revealed })
    }
}

fn load(path: &Path, help: &str) -> Result<String, ProblemFault> {
    let fault = |error| ProblemFault {
        file: path.to_owned(),
        place: None,
        message: format!("cannot read this file: {error}"),
        help: help.to_owned(),
    };
    fs::read_to_string(path).map_err(fault)
}

/// The JSON file.
struct Main<'a> {
    path: &'a Path,
    text: &'a str,
    json: Value,
}

impl Main<'_> {
    /// A fault at the value of a field, or at the start of the file where it is missing.
    fn fault(&self, field: &str, message: String, help: &str) -> ProblemFault {
        let key = format!("\"{field}\"");
        let value = self.text.find(&key).map(|at| {
            let behind = at + key.len();
            let rest = &self.text[behind..];
            behind + rest.find(|sign: char| sign != ':' && !sign.is_whitespace()).unwrap_or(0)
        });
        ProblemFault::at(self.path, self.text, value.unwrap_or(0), message, help)
    }

    /// The path and the text of the file that a field names.
    fn file(&self, field: &str) -> Result<(PathBuf, String), ProblemFault> {
        let help = "name a file, by its path from the folder of this one";
        let Some(name) = self.json[field].as_str() else {
            let message = format!("found no text `{field}`, expected the name of a file");
            return Err(self.fault(field, message, help));
        };
        let path = self.path.parent().unwrap_or(Path::new("")).join(name);
        match fs::read_to_string(&path) {
            Ok(text) => Ok((path, text)),
            Err(error) => Err(self.fault(field, format!("cannot read `{}`: {error}", path.display()), help)),
        }
    }

    fn number(&self, field: &str) -> Result<usize, ProblemFault> {
        let number = self.json[field].as_u64().filter(|number| (1..=100_000).contains(number));
        number.and_then(|number| usize::try_from(number).ok()).ok_or_else(|| {
            let message = format!("found no number `{field}`, expected the number of robots, from 1 to 100000");
            self.fault(field, message, "write the number of robots")
        })
    }

    /// Number of tasks that a team of this size sees at once.
    fn revealed(&self, team: usize) -> Result<usize, ProblemFault> {
        let field = "numTasksReveal";
        let each = match &self.json[field] {
            Value::Null => Some(1.0),
            value => value.as_f64().filter(|each| (0.001..=1e6).contains(each)),
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is positive and below 1e11")]
        let all = each.map(|each| ((each * team as f64).floor() as usize).max(1));
        all.ok_or_else(|| {
            let message = format!("found `{}` for `{field}`, expected a positive number", self.json[field]);
            self.fault(field, message, "write how many tasks for each robot are visible at once, such as 1.5")
        })
    }

    /// True if the robots take the tasks by turns.
    fn by_turns(&self) -> Result<bool, ProblemFault> {
        let field = "taskAssignmentStrategy";
        match self.json[field].as_str() {
            None if self.json[field].is_null() => Ok(false),
            Some("roundrobin") => Ok(true),
            Some("greedy") => Ok(false),
            _ => {
                let message = format!("found {} for `{field}`, expected `roundrobin` or `greedy`", self.json[field]);
                Err(self.fault(
                    field,
                    message,
                    "with `roundrobin` robots take the tasks by turns, else whoever is best",
                ))
            }
        }
    }
}

/// A file with a count, and then one or more cells a line.
struct Cells<'a> {
    path: &'a Path,
    text: &'a str,
    map: &'a Map,
}

impl Cells<'_> {
    /// The cells of each line, with their bytes; of `most` lines at most.
    fn lists(&self, most: usize, why: &str, faults: &mut Vec<ProblemFault>) -> Vec<Vec<(Block, usize)>> {
        let mut lines = self.lines();
        let Some((at, count)) = lines.next() else {
            let message = "found no line, expected the number of lines".to_owned();
            faults.push(ProblemFault::at(self.path, self.text, 0, message, "begin with the number of lines"));
            return Vec::new();
        };
        let Ok(count) = count.parse::<usize>() else {
            let message = format!("found `{count}`, expected the number of lines that follow");
            faults.push(ProblemFault::at(self.path, self.text, at, message, "begin with the number of lines"));
            return Vec::new();
        };
        let mut all = Vec::new();
        for (at, line) in lines.take(count.min(most)) {
            let start = faults.len();
            let mut cells = Vec::new();
            for word in line.split(',') {
                let at = at + (word.as_ptr() as usize - line.as_ptr() as usize);
                match self.cell(word.trim()) {
                    Ok(block) => cells.push((block, at)),
                    Err(problem) => {
                        let help = format!("{why}; a cell is row * width + column, and free");
                        faults.push(ProblemFault::at(self.path, self.text, at, problem, &help));
                    }
                }
            }
            if faults.len() >= MOST_FAULTS {
                return all;
            }
            if faults.len() == start {
                all.push(cells);
            }
        }
        let present = self.lines().skip(1).take(count).count();
        if present < count && faults.is_empty() {
            let message = format!("found {present} lines, expected {count} as this says");
            faults.push(ProblemFault::at(self.path, self.text, at, message, "correct the number, or add the lines"));
        }
        all
    }

    /// The lines that say something, with their bytes.
    fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let base = self.text.as_ptr() as usize;
        let lines = self.text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
        lines.map(move |line| (line.as_ptr() as usize - base, line))
    }

    fn cell(&self, word: &str) -> Result<Block, String> {
        let size = self.map.size();
        let cell: usize = word.parse().map_err(|_| format!("found `{word}`, expected the number of a cell"))?;
        if cell >= size {
            return Err(format!("found cell {cell}, outside the map, whose last cell is {}", size.saturating_sub(1)));
        }
        let block = self.map.block(cell);
        match self.map.is_free(block) {
            true => Ok(block),
            false => Err(format!("found cell {cell}, which is the wall at {block}")),
        }
    }

    /// The starts of a team of this size.
    fn starts(&self, team: usize, faults: &mut Vec<ProblemFault>) -> Vec<Block> {
        let before = faults.len();
        let lists = self.lists(team, "a robot cannot start there", faults);
        let mut starts: Vec<Block> = Vec::with_capacity(lists.len());
        let mut taken = std::collections::HashSet::new();
        for (block, at) in lists.iter().filter_map(|cells| cells.first().copied()) {
            if !taken.insert(block) {
                let message = format!("found a second robot at {block}, expected one robot on a block");
                faults.push(ProblemFault::at(self.path, self.text, at, message, "choose another cell"));
            }
            starts.push(block);
        }
        if starts.len() < team && faults.len() == before {
            let message = format!("found {} robots, expected the {team} of `teamSize`", starts.len());
            faults.push(ProblemFault::at(self.path, self.text, 0, message, "add robots, or reduce `teamSize`"));
        }
        starts
    }
}
