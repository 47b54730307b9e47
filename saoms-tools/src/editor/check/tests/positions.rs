//! Diagnostics stand in editors at the bytes where the checker found them.

use std::path::Path;

use proptest::prelude::*;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_lang::source::{ColumnUnit, LineIndex, OpenTexts};

use crate::editor::check::diagnostic::reported;
use crate::editor::testing::composite;

const INSIDE: &str = "<!-- ü🤖 -->\r\n<component name=\"R🤖${index:03}\" s:count=\"2 * n\">\r\
    <implementation.rust class=\"saoms.Robto\"/><property name=\"ü\" value=\"🤖\"/><property name=\"peroid\">1</property>\n\
    </component><component name=\"W\"><implementation.rust class=\"saoms.World\"/></component>\n<wire source=\"🤖/x\" target=\"W\"/>";

/// Checks that every diagnostic of a text has the same bytes in an editor.
fn hold(text: &str) -> usize {
    let path = Path::new("/nowhere/fleet.composite");
    let mut open = OpenTexts::default();
    open.insert(path, text.to_owned());
    let found = Project::new().file(path).open_texts(open).compile(&Registry::linked().unwrap());
    let all: Vec<_> = found.reported().cloned().collect();
    let told: Vec<_> = reported(&all, &found.sources).collect();
    assert_eq!(all.len(), told.len());
    let lines = LineIndex::new(text, ColumnUnit::Utf16);
    for (one, (path, told)) in all.iter().zip(&told) {
        assert_eq!(one.suggestions.len(), told.fixes.len());
        assert_eq!(path, Path::new("/nowhere/fleet.composite"));
        let range = told.range;
        let bytes = [range.start, range.end].map(|end| lines.offset(text, end) as u32);
        // Editors do not show a mark at the start.
        let mark = if text.starts_with('\u{feff}') { 3 } else { 0 };
        let known = [one.location.span.start, one.location.span.end].map(|end| end.max(mark));
        assert_eq!(bytes, known, "{one:?} in {text:?}");
    }
    all.len()
}

#[test]
fn diagnostics_stand_where_the_checker_found_them() {
    let text = composite(INSIDE);
    assert!(hold(&text) > 3);
    assert!(hold(&format!("\u{feff}{text}")) > 3);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn diagnostics_of_disturbed_texts_stand_where_the_checker_found_them(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0usize..12, "(<|>|\"|&|/|=|ä|🤖|\r\n|\r|\n| ){0,2}"), 1..6),
    ) {
        let mut text = composite(INSIDE);
        for (at, length, piece) in edits {
            let start = text.floor_char_boundary(at.index(text.len() + 1));
            let end = text.floor_char_boundary((start + length).min(text.len())).max(start);
            text.replace_range(start..end, &piece);
        }
        hold(&text);
    }
}
