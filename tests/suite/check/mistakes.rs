//! Mistakes that people make in fleets that are right: each is reported once, at its place, and what is suggested makes
//! the fleet right again.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use expect_test::{ExpectFile, expect_file};
use saoms_components as _;
use saoms_lang::diagnostic::{Diagnostic, Edit};
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_lang::source::Sources;

/// A fleet: the files of it, by their names, the composite first.
type Files = Vec<(&'static str, String)>;

/// A checker, with the folder for the files of a fleet.
struct Checker {
    registry: Registry,
    folder: tempfile::TempDir,
}

impl Checker {
    fn new() -> Self {
        Self { registry: Registry::linked().unwrap(), folder: tempfile::tempdir().unwrap() }
    }

    /// The diagnostics of a fleet.
    fn faults(&self, files: &Files) -> (Vec<Diagnostic>, Sources) {
        for (name, text) in files {
            fs::write(self.folder.path().join(name), text).unwrap();
        }
        let compilation = Project::new().file(self.folder.path().join(files[0].0)).compile(&self.registry);
        (compilation.reported().cloned().collect(), compilation.sources)
    }

    /// The report of a mistake: each diagnostic with the text that it marks, its help, and the texts after its
    /// suggestions.
    fn outcome(&self, files: &Files) -> String {
        let (found, sources) = self.faults(files);
        let mut out = String::new();
        for one in &found {
            let marked = sources.snippet(one.location).lines().next().unwrap_or_default();
            let _ = writeln!(out, "{} {} [{marked}] {}", one.severity.name(), one.code.id, one.message);
            for suggestion in &one.suggestions {
                let (left, _) = self.faults(&applied(files, &suggestion.edits, &sources));
                let left: Vec<&str> = left.iter().map(|one| one.message.as_str()).collect();
                let left = if left.is_empty() { String::new() } else { format!(" -> {}", left.join("; ")) };
                let _ = writeln!(out, "  fix: {}{left}", suggestion.description);
            }
        }
        out
    }
}

fn applied(files: &Files, edits: &[Edit], sources: &Sources) -> Files {
    let mut edits: Vec<&Edit> = edits.iter().collect();
    edits.sort_by_key(|edit| edit.location.span.start);
    let mut files = files.clone();
    for edit in edits.iter().rev() {
        let path = Path::new(sources.get(edit.location.file).path());
        let (_, text) = files.iter_mut().find(|(name, _)| path.ends_with(name)).unwrap();
        let span = edit.location.span;
        text.replace_range(span.start as usize..span.end as usize, &edit.replacement);
    }
    files
}

/// Holds the checker to a list of mistakes in a fleet: their names, what is replaced and by what, and what comes of it.
fn hold(files: &Files, mistakes: &str, expected: &ExpectFile) {
    let checker = Checker::new();
    assert_eq!(checker.outcome(files), "", "the fleet is right");
    let (mut all, mut wrong) = (String::new(), String::new());
    for mistake in mistakes.split("\n\n").filter(|mistake| !mistake.trim().is_empty()) {
        let mut lines = mistake.trim_start().lines();
        let name = lines.next().unwrap();
        let part = |line: &str, mark: &str| line.strip_prefix(mark).unwrap().replace("\\n", "\n");
        let (from, to) = (part(lines.next().unwrap(), "- "), part(lines.next().unwrap(), "+ "));
        let mut files = files.clone();
        let place = files.iter().position(|(_, text)| text.contains(&from)).unwrap_or(usize::MAX);
        assert!(place < files.len(), "{name}: the fleet has no {from}");
        files[place].1 = files[place].1.replacen(&from, &to, 1);
        let outcome = checker.outcome(&files);
        let told = outcome.lines().filter(|line| !line.starts_with(' ')).count();
        if told != 1 || outcome.contains(" -> ") {
            let _ = writeln!(wrong, "{name}\n{outcome}");
        }
        let (from, to) = (from.replace('\n', "\\n"), to.replace('\n', "\\n"));
        let _ = write!(all, "{name}\n- {from}\n+ {to}\n{outcome}\n");
    }
    expected.assert_eq(&all);
    assert_eq!(wrong, "", "each is told once, and what is suggested makes the fleet right");
}

macro_rules! files {
    ($folder:literal: $($name:literal)*) => {
        vec![$(($name, include_str!(concat!("../../mistakes/", $folder, "/", $name)).to_owned())),*]
    };
}

#[test]
fn in_one_composite() {
    let files = files!("depot": "depot.composite");
    hold(&files, include_str!("../../mistakes/depot/mistakes.txt"), &expect_file!["../../mistakes/depot/mistakes.txt"]);
}

#[test]
fn in_composites_of_composites() {
    let files = files!("terminal": "terminal.composite" "hall.composite" "tower.composite" "hall.csv");
    let mistakes = include_str!("../../mistakes/terminal/mistakes.txt");
    hold(&files, mistakes, &expect_file!["../../mistakes/terminal/mistakes.txt"]);
}

#[test]
fn in_a_composite_with_policies() {
    let files = files!("guarded": "guarded.composite" "definitions.xml");
    let mistakes = include_str!("../../mistakes/guarded/mistakes.txt");
    hold(&files, mistakes, &expect_file!["../../mistakes/guarded/mistakes.txt"]);
}

#[test]
fn in_a_fleet_on_networks() {
    let files = files!("networks": "networks.composite");
    let mistakes = include_str!("../../mistakes/networks/mistakes.txt");
    hold(&files, mistakes, &expect_file!["../../mistakes/networks/mistakes.txt"]);
}

macro_rules! shipped {
    ($folder:literal: $($name:literal)*) => {
        vec![$(($name, include_str!(concat!("../../../composites/", $folder, $name)).to_owned())),*]
    };
}

#[test]
fn in_the_fleet_of_the_readme() {
    let mistakes = include_str!("../../mistakes/hall/mistakes.txt");
    hold(&shipped!("": "hall.composite"), mistakes, &expect_file!["../../mistakes/hall/mistakes.txt"]);
}

#[test]
fn in_a_fleet_of_teams() {
    let files = shipped!("teams/": "teams.composite" "area.composite" "team.composite");
    let mistakes = include_str!("../../mistakes/teams/mistakes.txt");
    hold(&files, mistakes, &expect_file!["../../mistakes/teams/mistakes.txt"]);
}

#[test]
fn in_a_fleet_of_sites() {
    let files = shipped!("sites/": "sites.composite" "warehouse.composite" "north.csv" "south.csv");
    let mistakes = include_str!("../../mistakes/sites/mistakes.txt");
    hold(&files, mistakes, &expect_file!["../../mistakes/sites/mistakes.txt"]);
}
