//! What has to hold for editors as it does for the command, whatever the text.

use std::path::Path;

use saoms_lang::check::{Options, count};
use saoms_lang::diagnostic::{Diagnostic, Diagnostics, Severity, human};
use saoms_lang::load::{MAX_SIZE, load, load_named};
use saoms_lang::model::Contribution;
use saoms_lang::source::{OpenTexts, Sources};

use super::diagnostics::reported;
use super::rename::rename;
use super::scene::Scene;

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

/// Editors are told what the checker finds, at the same bytes. A sound fleet is sound after something in it got another name.
///
/// Gives whether something got another name.
pub(super) fn hold(scene: &Scene, at: usize) -> bool {
    let texts: Vec<String> = scene.files.iter().map(|file| file.text.to_string()).collect();
    let (all, sources) = checked(scene, &texts);
    let told: Vec<_> = reported(&all, &sources).collect();
    assert_eq!(all.len(), told.len());
    let (file, text) = (scene.file(), &texts[0]);
    for (one, (path, told)) in all.iter().zip(&told) {
        assert_eq!(one.suggestions.len(), told.fixes.len());
        if *path == file.path && Path::new(sources.get(one.location.file).path()) == file.path {
            let range = told.shown.range;
            let bytes = [range.start, range.end].map(|end| file.lines.offset(text, end) as u32);
            // Editors do not show a mark at the start.
            let mark = if text.starts_with('\u{feff}') { 3 } else { 0 };
            let known = [one.location.span.start, one.location.span.end].map(|end| end.max(mark));
            assert_eq!(bytes, known, "{one:?} in {text:?}");
        }
    }
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
