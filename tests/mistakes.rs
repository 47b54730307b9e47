//! Mistakes that people make in a fleet that is right: each is told once, at its place, and what is suggested makes the fleet right again.

use std::fmt::Write as _;

use expect_test::expect_file;
use saoms_components as _;
use saoms_core::check::{Options, check};
use saoms_core::diagnostic::{Diagnostic, Diagnostics, Edit};
use saoms_core::load::load_file;
use saoms_core::model::Contribution;
use saoms_core::registry::Registry;
use saoms_core::source::Sources;

/// The fleet, and a file of mistakes in it: their names, what is replaced and by what, and what comes of it.
const FLEET: &str = include_str!("mistakes/depot.composite");
const MISTAKES: &str = include_str!("mistakes/mistakes.txt");

/// What is wrong with a text.
fn faults(text: &str, registry: &Registry) -> (Vec<Diagnostic>, Sources) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = sources.add("depot.composite", text);
    if let Some(composite) = load_file(file, &sources, &mut diagnostics) {
        let fleet = Contribution::of(vec![composite]);
        check(&fleet, registry, &Options::default(), &sources, &mut diagnostics);
    }
    (diagnostics.into_sorted(), sources)
}

fn applied(text: &str, edits: &[Edit]) -> String {
    let mut edits: Vec<&Edit> = edits.iter().collect();
    edits.sort_by_key(|edit| edit.location.span.start);
    let mut text = text.to_owned();
    for edit in edits.iter().rev() {
        let span = edit.location.span;
        text.replace_range(span.start as usize..span.end as usize, &edit.replacement);
    }
    text
}

/// What comes of a mistake: each diagnostic with the text that it marks, its help, and what its suggestions leave.
fn outcome(text: &str, registry: &Registry) -> String {
    let (found, sources) = faults(text, registry);
    let mut out = String::new();
    for one in &found {
        let marked = sources.snippet(one.location).lines().next().unwrap_or_default();
        let _ = writeln!(out, "{} {} [{marked}] {}", one.severity.name(), one.code.id, one.message);
        for suggestion in &one.suggestions {
            let (left, _) = faults(&applied(text, &suggestion.edits), registry);
            let left: Vec<&str> = left.iter().map(|one| one.message.as_str()).collect();
            let left = if left.is_empty() { String::new() } else { format!(" -> {}", left.join("; ")) };
            let _ = writeln!(out, "  fix: {}{left}", suggestion.description);
        }
    }
    out
}

#[test]
fn each_is_told_once_and_mended_as_it_is_suggested() {
    let registry = Registry::linked().unwrap();
    assert_eq!(outcome(FLEET, &registry), "", "the fleet is right");
    let (mut all, mut wrong) = (String::new(), String::new());
    for mistake in MISTAKES.split("\n\n").filter(|mistake| !mistake.trim().is_empty()) {
        let mut lines = mistake.trim_start().lines();
        let name = lines.next().unwrap();
        let part = |line: &str, mark: &str| line.strip_prefix(mark).unwrap().replace("\\n", "\n");
        let (from, to) = (part(lines.next().unwrap(), "- "), part(lines.next().unwrap(), "+ "));
        assert!(FLEET.contains(&from), "{name}: the fleet has no {from}");
        let outcome = outcome(&FLEET.replacen(&from, &to, 1), &registry);
        let told = outcome.lines().filter(|line| !line.starts_with(' ')).count();
        if told != 1 || outcome.contains(" -> ") {
            let _ = writeln!(wrong, "{name}\n{outcome}");
        }
        let _ = write!(
            all,
            "{name}\n- {}\n+ {}\n{outcome}\n",
            from.replace('\n', "\\n"),
            to.replace('\n', "\\n")
        );
    }
    assert_eq!(wrong, "", "each is told once, and what is suggested makes the fleet right");
    expect_file!["mistakes/mistakes.txt"].assert_eq(&all);
}
