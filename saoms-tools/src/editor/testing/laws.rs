//! Laws of editors: what has to hold whatever the text.

use saoms_lang::check::{Options, count};
use saoms_lang::contribution::{load, load_named};
use saoms_lang::diagnostic::{Diagnostic, Diagnostics, Severity, human};
use saoms_lang::load::MAX_SIZE;
use saoms_lang::model::Contribution;
use saoms_lang::source::{OpenTexts, Sources};

use crate::editor::{Scene, rename};

/// A name that no text has.
const FRESH: &str = "freshName";

/// What the checker says of the files of a scene.
fn checked(scene: &Scene, texts: &[String]) -> (Vec<Diagnostic>, Sources) {
    let mut open = OpenTexts::default();
    for (file, text) in scene.files.iter().zip(texts) {
        open.insert(&file.path, text.as_str());
    }
    let (mut sources, mut diagnostics) = (Sources::with_open(open), Diagnostics::new());
    let composite = load(&scene.file().path, &mut sources, &mut diagnostics);
    let mut contribution = Contribution::of(composite.into_iter().collect());
    load_named(&mut contribution, MAX_SIZE, &mut sources, &mut diagnostics);
    let options = Options { assume_classes: true, ..Options::default() };
    count(&contribution, &scene.registry, &options, &sources, &mut diagnostics);
    (diagnostics.into_sorted(), sources)
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
