//! Laws that hold for any input of a check.

use saoms_lang::assembly::{Assembly, ComponentSpec};
use saoms_lang::diagnostic::{Diagnostic, Edit, codes};
use saoms_lang::project::Compilation;
use saoms_lang::registry::Registry;
use saoms_lang::source::FileId;
use saoms_tools::diagnostics::human_of;
use saoms_tools::expand::expanded;

use super::input::{Input, Settings, kind, kinds};
use super::{draw, parsed, show};

/// A fleet as the command checks it.
const KNOWN: Settings = |project| project;

/// A fleet with classes as given, its wiring judged, and values from outside for properties that it may have.
const GIVEN: Settings = |project| project.assume_classes(true).wiring(true).set_all(["p=2", "site=north"]);

/// Checks a fleet as the command does, and draws it.
///
/// The same is found when the files are formatted. What the fleet comes to is written out, and comes to the same. What
/// is suggested mends what is wrong.
pub(crate) fn holds(input: &Input, registry: &Registry) {
    let fleet = examined(input, KNOWN, registry);
    assert_eq!(fleet.output.is_none(), fleet.has_errors(), "{}", human_of(&fleet));
    draw(&input.counted(KNOWN, registry), registry);
    mended(input, &fleet, KNOWN, registry);
    if let Some(assembly) = &fleet.output {
        written_out(input, &fleet, assembly, registry);
    }
    let fleet = examined(input, GIVEN, registry);
    assert!(fleet.output.is_none() || !fleet.has_errors(), "{}", human_of(&fleet));
    mended(input, &fleet, GIVEN, registry);
}

fn examined(input: &Input, settings: Settings, registry: &Registry) -> Compilation {
    let fleet = input.compiled(settings, registry);
    show(&fleet.diagnostics, &fleet.sources);
    let formatted = input.formatted();
    let (found, again) = (kinds(&fleet), kinds(&formatted.compiled(settings, registry)));
    assert!(found == again, "{:#?}\n{:#?}\n{formatted:#?}", without(&found, &again), without(&again, &found));
    fleet
}

/// Those of some that are not among others.
fn without<'k>(some: &'k [String], others: &[String]) -> Vec<&'k String> {
    some.iter().filter(|one| !others.contains(one)).collect()
}

/// The expansion of a fleet gives the same assembly as the fleet.
fn written_out(input: &Input, fleet: &Compilation, assembly: &Assembly, registry: &Registry) {
    let text = expanded(fleet).unwrap();
    let alone = Input::Text(text.clone()).compiled(KNOWN, registry);
    assert!(alone.output.is_some(), "{}{input:#?}{text}", human_of(&alone));
    let Some(other) = &alone.output else { return };
    assert_eq!(facts(assembly), facts(other), "{input:#?}{text}");
    assert_eq!(Some(text), expanded(&alone), "{input:#?}");
}

/// An assembly without the declarations of its classes.
fn facts(assembly: &Assembly) -> Vec<String> {
    let fact = |one: &ComponentSpec| {
        let loops = one.loops.iter().map(|one| (&one.name, one.class.name(), &one.values));
        let loops: Vec<_> = loops.collect();
        let (class, library) = (one.class.name(), &one.library);
        format!("{} {class} {library:?} {:?} {:?} {:?} {loops:?}", one.path, one.values, one.task, one.references)
    };
    assembly.components.iter().map(fact).collect()
}

/// Follows one of the suggestions; which one, the length of the text says. What it is for is there once less.
fn mended(input: &Input, fleet: &Compilation, settings: Settings, registry: &Registry) {
    let Input::Text(text) = input else { return };
    let is_here = |file: FileId| fleet.sources.get(file).path() == "x";
    let all = fleet.diagnostics.iter().flat_map(|one| one.suggestions.iter().map(move |way| (one, way)));
    let all: Vec<_> = all.filter(|(_, way)| way.edits.iter().all(|edit| is_here(edit.location.file))).collect();
    let Some((one, way)) = all.get(text.len() % all.len().max(1)) else { return };
    let edited = edited(text, &way.edits);
    let context = || format!("{way:?} for {one:?}\n{text}\nbecame\n{edited}\n");
    assert!(parsed(text).is_none() || parsed(&edited).is_some(), "{}", context());
    let after = Input::Text(edited.clone()).compiled(settings, registry);
    let number = |fleet: &Compilation| kinds(fleet).iter().filter(|kind_| **kind_ == kind(one)).count();
    // Where tags do not fit at several places, which of them is wrong is a guess: when one is mended, another may be
    // the wrong one.
    let is_mismatch = |one: &&Diagnostic| one.code == &codes::XML_TAG_MISMATCH;
    if one.code == &codes::XML_TAG_MISMATCH && fleet.diagnostics.iter().filter(is_mismatch).count() > 1 {
        return;
    }
    if one.code.id.starts_with("S01") || one.code == &codes::NAMESPACE_NEAR || parsed(text).is_none() {
        // The first of these is reported, and where tags do not fit, the text before that is read: the same may be
        // wrong again further on.
        let start = |one: &Diagnostic| one.location.span.start as usize;
        let is_further =
            |next: &Diagnostic| start(next) > start(one) || edited.len() - start(next) < text.len() - start(one);
        let alike = |fleet: &Compilation| {
            let alike = fleet.diagnostics.iter().filter(|next| kind(next) == kind(one));
            alike.filter(|next| !is_further(next)).count()
        };
        let here = fleet.diagnostics.iter().filter(|next| kind(next) == kind(one) && start(next) <= start(one));
        assert!(alike(&after) < here.count(), "{}{}", context(), human_of(&after));
        return;
    }
    assert!(number(&after) < number(fleet), "{}{}", context(), human_of(&after));
}

/// A text after edits, which must not overlap.
fn edited(text: &str, edits: &[Edit]) -> String {
    let mut edits: Vec<&Edit> = edits.iter().collect();
    edits.sort_by_key(|edit| edit.location.span.start);
    let (mut out, mut at) = (String::new(), 0);
    for edit in &edits {
        let (start, end) = (edit.location.span.start as usize, edit.location.span.end as usize);
        assert!(at <= start, "{edits:?} overlap");
        out += &text[at..start];
        out += &edit.replacement;
        at = end;
    }
    out + &text[at..]
}
