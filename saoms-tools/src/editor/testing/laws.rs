//! Laws of editors: what has to hold whatever the text.

use crate::diagnostics::human;
use saoms_lang::diagnostic::{Diagnostic, Severity};
use saoms_lang::project::Project;
use saoms_lang::source::{OpenTexts, Sources};

use crate::editor::{Scene, rename};

/// A name that no text has.
const FRESH: &str = "freshName";

/// The diagnostics of the files of a scene.
fn checked(scene: &Scene, texts: &[String]) -> (Vec<Diagnostic>, Sources) {
    let mut open = OpenTexts::default();
    for (file, text) in scene.files.iter().zip(texts) {
        open.insert(&file.path, text.clone());
    }
    let project = Project::new().file(&scene.file().path).open_texts(open).assume_classes(true);
    let mut found = project.compile(scene.registry.as_ref());
    found.diagnostics.retain(|one| !one.is_allowed());
    (found.diagnostics, found.sources)
}

fn is_sound(all: &[Diagnostic]) -> bool {
    all.iter().all(|one| one.severity != Severity::Error)
}

/// A sound fleet is sound after something in it got another name.
///
/// Gives whether something got another name.
pub(in crate::editor) fn hold(scene: &Scene, at: usize) -> bool {
    let texts: Vec<String> = scene.files.iter().map(|file| file.text.to_string()).collect();
    let (all, _) = checked(scene, &texts);
    if !is_sound(&all) || texts.iter().any(|text| text.contains(FRESH)) {
        return false;
    }
    let Ok(mut edits) = rename(scene, at, FRESH) else { return false };
    edits.sort_by_key(|(place, _)| std::cmp::Reverse(place.clone()));
    let mut renamed = texts;
    for (place, new) in &edits {
        renamed[place.file].replace_range(place.start..place.end, new);
    }
    let (after, sources) = checked(scene, &renamed);
    assert!(is_sound(&after), "{}{}\n{edits:?}", human(&after, &sources, false), renamed.join("\n----\n"));
    assert_eq!(all.len(), after.len(), "{}{}", human(&after, &sources, false), renamed.join("\n----\n"));
    true
}
