//! Ways to mend what is wrong.

use std::path::Path;
use std::sync::Arc;

use saoms_lang::source::{LineColumn, LineRange};

use super::{Desk, FOLDER, named};
use crate::editor::check::{EditorDiagnostic, fix_all, fixes, touching};
use crate::editor::testing::scene_at;

const INSIDE: &str = "<component name=\"A\"><implementation.java class=\"saoms.Wrold\"/></component>\n\
                      <component name=\"B\" autowrie=\"true\"><implementation.java class=\"saoms.Robto\"/></component>\n";

fn diagnostics(text: &str) -> Arc<Vec<EditorDiagnostic>> {
    let mut desk = Desk::new(&[("fleet.composite", text)]);
    desk.updates(true).pop().unwrap().into_values().next().unwrap()
}

/// A range of whole lines, the last one not included.
fn lines(start: u32, end: u32) -> LineRange {
    LineRange { start: LineColumn { line: start, column: 1 }, end: LineColumn { line: end, column: 1 } }
}

/// The line of `INSIDE` that begins so.
fn line_of(text: &str, what: &str) -> u32 {
    text.lines().zip(1..).find(|(line, _)| line.contains(what)).unwrap().1
}

#[test]
fn each_diagnostic_of_the_range_has_its_fixes_and_what_can_be_allowed_is() {
    let text = named("fleet", INSIDE);
    let all = diagnostics(&text);
    let scene = scene_at(&Path::new(FOLDER).join("fleet.composite"), &text);
    let line = line_of(&text, "autowrie");
    let titles = |range| -> Vec<String> {
        fixes(&scene, &all, range)
            .into_iter()
            .map(|one| format!("{}{}", if one.is_preferred { "! " } else { "" }, one.fix.title))
            .collect()
    };
    let found = titles(lines(line, line + 1));
    assert!(found[0].starts_with("! "), "{found:?}");
    assert!(found.iter().any(|one| one == "Allow S1007 in component `B`, with a reason"), "{found:?}");
    assert!(found.iter().all(|one| !one.contains("Wrold") && !one.contains("S3001")), "{found:?}");
    assert!(titles(lines(999, 1000)).is_empty());
    assert_eq!(touching(&all, lines(1, 1000)).count(), all.len());
}

#[test]
fn all_with_one_suggestion_are_mended_at_once() {
    let text = named("fleet", INSIDE);
    let all = diagnostics(&text);
    let path = Path::new(FOLDER).join("fleet.composite");
    let single = all.iter().filter(|one| one.fixes.len() == 1).count();
    assert!(single > 0);
    let action = fix_all(&all, &path, 1).unwrap();
    assert_eq!(action.of.len(), single);
    assert!(fix_all(&all, &path, single + 1).is_none());
    assert!(fix_all(&all, Path::new("/elsewhere"), 1).is_none(), "these change another file");
    // Edits of two diagnostics that overlap would destroy each other.
    let doubled: Vec<EditorDiagnostic> = all.iter().chain(all.iter()).cloned().collect();
    assert_eq!(fix_all(&doubled, &path, 1).unwrap().of.len(), single);
}
