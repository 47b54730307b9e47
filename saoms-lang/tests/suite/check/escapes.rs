//! Names that hold what XML has to escape.

use crate::check::support::{nested, part, shown};

/// A text with an edit of each of some places, the last ones first.
fn edited(text: &str, mut edits: Vec<(usize, usize, &str)>) -> String {
    edits.sort_unstable();
    let mut text = text.to_owned();
    edits.iter().rev().for_each(|(start, end, new)| text.replace_range(*start..*end, new));
    text
}

#[test]
fn what_is_suggested_can_stand_in_the_file() {
    let robot = |name: &str, attributes: &str, inside: &str| {
        format!(
            "<component name=\"{name}\" {attributes}><implementation.java class=\"example.Robot\"/><property name=\"ID\">{name}</property><property name=\"period\">1</property>{inside}</component>"
        )
    };
    let inside = [
        "<property name=\"k&quot;]]&gt;&amp;\">1</property>",
        &robot("A&quot;]]&gt;'r", "", "<property name=\"number\" source='k\"]]&gt;&amp;'/>"),
        &robot("C&amp;", "saoms:count=\"2\"", ""),
        "<wire source='A\"]]&gt;&apos;t/gps' target=\"A&quot;]]&gt;'t\"/>",
        "<service name=\"s\" promote=\"A&quot;]]>'r#move\"/>",
        "<saoms:severity code=\"S&quot;\" level=\"allow&amp;\" reason=\"r\"/>",
    ]
    .join("\n");
    let text = part("fleet", "xmlns:saoms=\"urn:saoms:1\"", &inside);
    let (_, diagnostics, sources) = nested(&[&text], &[], false);
    let mut names = Vec::new();
    for one in &diagnostics {
        for suggestion in &one.suggestions {
            let edit = |edit: &'_ saoms_lang::diagnostic::Edit| {
                let span = edit.location.span;
                (span.start as usize, span.end as usize, edit.replacement.clone())
            };
            let edits: Vec<_> = suggestion.edits.iter().map(edit).collect();
            let edits = edits.iter().map(|(start, end, new)| (*start, *end, new.as_str())).collect();
            let new = edited(&text, edits);
            if let Err(fault) = roxmltree::Document::parse(&new) {
                panic!("{fault}: {}\n{new}", shown(one, &sources));
            }
            names.push(suggestion.description.clone());
        }
    }
    names.sort_unstable();
    expect_test::expect![[r#"
        insert `$`
        replace `A"]]>'r#move` with `A"]]>'r/move`
        replace `A"]]>'t` with `A"]]>'r`
        replace `A"]]>'t` with `A"]]>'r`
        replace `C&` with `C&${index}`
        replace it with `allow`
    "#]]
    .assert_eq(&(names.join("\n") + "\n"));
}
