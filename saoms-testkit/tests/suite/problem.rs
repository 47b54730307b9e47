//! Problems of the League of Robot Runners, and random luggage.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use saoms_components::grid::{Block, Map};
use saoms_testkit::{Fleet, Problem, ProblemFleet, Task};

const TRAPS: &str = "../benches/problems/traps";

/// A folder with a problem on a map of three blocks and a wall: `.@` above `..`.
fn folder(json: &str, agents: &str, tasks: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in
        [("p.json", json), ("m.map", "height 2\nwidth 2\nmap\n.@\n..\n"), ("a.agents", agents), ("t.tasks", tasks)]
    {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join("p.json");
    (folder, path)
}

const JSON: &str = r#"{"mapFile": "m.map", "agentFile": "a.agents", "teamSize": 2, "taskFile": "t.tasks",
 "numTasksReveal": 1.5}"#;

/// What is wrong with a problem: the place and the message of each fault.
fn faults(json: &str, agents: &str, tasks: &str) -> Vec<String> {
    let (_folder, path) = folder(json, agents, tasks);
    let faults = Problem::read(&path).unwrap_err();
    let shown = faults.iter().map(|fault| {
        let name = fault.file.file_name().unwrap().to_string_lossy().into_owned();
        let place = fault.place.map_or_else(String::new, |(line, column)| format!(":{line}:{column}"));
        format!("{name}{place} {}", fault.message)
    });
    shown.collect()
}

#[test]
fn both_years_are_read() {
    let (_folder, path) = folder(JSON, "# 2024\n2\n0\n3\n", "# 2024\n3\n2,3\n0\n3,2,0\n");
    let problem = Problem::read(&path).unwrap();
    let block = Block::new;
    assert_eq!(problem.starts, [block(0, 0), block(1, 1)]);
    assert_eq!(problem.revealed, Some(3), "1.5 for each of two robots");
    let visits = [vec![block(0, 1), block(1, 1)], vec![block(0, 0)], vec![block(1, 1), block(0, 1), block(0, 0)]];
    assert_eq!(problem.tasks, visits.map(Task::Visit));

    let json = JSON.replace("1.5", "1, \"taskAssignmentStrategy\": \"roundrobin\"");
    let (_folder, path) = folder(&json, "2\n0\n3\n", "3\n2\n3\n0\n");
    let problem = Problem::read(&path).unwrap();
    let turns = [(block(0, 1), 0), (block(1, 1), 1), (block(0, 0), 0)];
    assert_eq!(problem.tasks, turns.map(|(stop, robot)| Task::VisitBy(stop, robot)));
}

#[test]
fn faults_are_told_at_their_place() {
    let (agents, tasks) = ("2\n0\n3\n", "1\n2\n");
    assert_eq!(faults("{", agents, tasks)[0].split(' ').next(), Some("p.json:1:1"));
    let missing = &faults(&JSON.replace("m.map", "no.map"), agents, tasks)[0];
    assert!(missing.starts_with("p.json:1:13 cannot read `") && missing.contains("no.map"), "{missing}");
    let wrong = [
        (agents.replace('3', "1"), tasks, "a.agents:3:1 found cell 1, which is the wall at (1,0)"),
        (agents.replace('3', "9"), tasks, "a.agents:3:1 found cell 9, outside the map, whose last cell is 3"),
        (agents.replace('3', "0"), tasks, "a.agents:3:1 found a second robot at (0,0), expected one robot on a block"),
        ("2\n0\n".to_owned(), tasks, "a.agents:1:1 found 1 lines, expected 2 as this says"),
        (agents.to_owned(), "2\n0,2,x\n3\n", "t.tasks:2:5 found `x`, expected the number of a cell"),
        (agents.to_owned(), "x\n", "t.tasks:1:1 found `x`, expected the number of lines that follow"),
    ];
    for (agents, tasks, expected) in wrong {
        assert_eq!(faults(JSON, &agents, tasks)[0], expected);
    }
    let team = JSON.replace("\"teamSize\": 2", "\"teamSize\": \"2\"");
    assert_eq!(
        faults(&team, agents, tasks),
        ["p.json:1:59 found no number `teamSize`, expected the number of robots, from 1 to 100000"]
    );
}

#[test]
fn a_fleet_visits_all_blocks_of_a_problem() {
    for trap in ["string", "corners"] {
        let problem = Problem::read(&Path::new(TRAPS).join(trap).with_extension("json")).unwrap();
        let run = Fleet::of_text(problem.composite(&ProblemFleet::default())).run(1, Duration::from_secs(300));
        assert_eq!(run.sections["errands"]["finished"], 2, "{trap}:\n{}", run.log());
        assert_eq!(run.sections["collisions"]["vertex"], 0, "{trap}");
    }
}

#[test]
fn random_luggage_follows_from_map_and_seed() {
    let map = || Map::read("...@.\n...@.\n...@.").unwrap();
    let one = Problem::of_luggage(map(), 4, 9, 7);
    let (again, other) = (Problem::of_luggage(map(), 4, 9, 7), Problem::of_luggage(map(), 4, 9, 8));
    assert_eq!((&one.starts, &one.tasks), (&again.starts, &again.tasks));
    assert_ne!(one.tasks, other.tasks);
    let stops = one.tasks.iter().flat_map(Task::stops);
    assert!(stops.chain(one.starts.clone()).all(|block| block.x < 3), "the right part cannot be reached");
    let run = Fleet::of_text(one.composite(&ProblemFleet::default())).run(7, Duration::from_secs(500));
    assert_eq!(run.sections["luggage"]["delivered"], 9, "{}", run.log());
}
