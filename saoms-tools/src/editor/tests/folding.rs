//! Folding, growing selections, and links.

use crate::editor::links::links;
use crate::editor::testing::{composite, scene, scene_of};
use crate::editor::{folds, selections};

/// The lines that can be folded, from and to, counted from 1.
fn folded(text: &str) -> Vec<(usize, usize)> {
    let scene = scene_of(text, &[]);
    folds(scene.file()).into_iter().map(|one| (one.start + 1, one.end + 1)).collect()
}

#[test]
fn elements_and_comments_of_several_lines_can_be_folded() {
    let text = "<!-- a\nb -->\n<composite\n  name=\"f\">\n<component name=\"R\"><implementation.rust\nclass=\"x\"/>\n</component>\n<wire source=\"a\"\ntarget=\"b\"/>\n<component name=\"S\">\n</component><component name=\"T\"></component>\n</composite>\n";
    // The end tag stays, so that an element without anything inside cannot be folded.
    assert_eq!(folded(text), [(1, 2), (3, 11), (5, 6), (8, 9)]);
    assert_eq!(folded(&text.replace('\n', "\r\n")), folded(text));
    // What is not closed yet is folded up to where it ends for now.
    assert_eq!(folded("<composite>\n<component name=\"R\">\n<property/>\n"), [(1, 3), (2, 3)]);
    assert_eq!(folded(""), []);
}

#[test]
fn selections_grow_by_what_belongs_together() {
    let marked = composite("<component name=\"R\"><reference name=\"r\" target=\"A B|C\"/></component> <wire/>");
    let (scene, at) = scene(&marked, &[]);
    let file = scene.file();
    let found = selections(file, at);
    let shown: Vec<&str> = found.iter().map(|range| &file.text[range.clone()]).collect();
    let tag = "<reference name=\"r\" target=\"A BC\"/>";
    let component = format!("<component name=\"R\">{tag}</component>");
    assert_eq!(shown[..5], ["BC", "A BC", "target=\"A BC\"", tag, component.as_str()]);
    assert_eq!(shown[5], format!("{component} <wire/>"));
    assert_eq!(shown.last().unwrap().len(), file.text.len());
}

#[test]
fn names_of_files_are_links() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("plan.txt"), "").unwrap();
    let text = composite(
        "<component name=\"R\"><property name=\"scenario\" file=\"plan.txt\"/><property name=\"x\" file=\"none.txt\"/></component>",
    );
    let scene = crate::editor::testing::scene_at(&folder.path().join("f.composite"), &text);
    let found: Vec<&str> = links(&scene).into_iter().map(|(at, _)| &scene.file().text[at]).collect();
    assert_eq!(found, ["plan.txt"], "of those that are there");
    let inner = composite("").replace("name=\"fleet\"", "name=\"inner\"");
    let scene = scene_of(
        &composite(
            "<include name=\"inner\"/><include name=\"none\"/><component name=\"I\"><implementation.composite name=\"inner\"/></component>",
        ),
        &[("inner.composite", &inner)],
    );
    let found = links(&scene);
    assert_eq!(found.len(), 2);
    assert!(found.iter().all(|(_, path)| path.ends_with("inner.composite")), "{found:?}");
}
