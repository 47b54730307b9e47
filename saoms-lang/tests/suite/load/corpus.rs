//! Diagnostics of the loader for real files, and for damaged ones.

use std::collections::BTreeMap;
use std::fs;

use proptest::prelude::*;
use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::load::{MAX_SIZE, read};
use saoms_lang::source::Sources;

use crate::load::collection::collection;
use crate::load::files::{self, Sample};
use crate::load::oracle::judge;
use crate::load::places::checked;
use crate::load::support::load;

/// The diagnostics of the files of this repository, apart from warnings that a composite has no target namespace.
#[test]
fn the_shipped_files_get_what_they_deserve() {
    let expected = BTreeMap::from([
        ("all-1.0.composite", vec![]),
        // SCA 1.1 does not know `operation`, which SCA 1.0 has.
        ("all-1.1.composite", vec!["warning S1004 [operation]"]),
        ("archetype.composite", vec![]),
        ("bigbank-calculator.composite", vec![]),
        ("draft.composite", vec![]),
        // A schema violation that Tuscany's own test of validation asks to be found.
        ("misplaced-binding.composite", vec!["error S1005 [binding.ws]"]),
    ]);
    for Sample { name, text } in files::shipped() {
        let mut found = checked(&name, &text);
        found.retain(|one| one != "warning S1009 [composite]");
        assert_eq!(found, expected[&*name], "{name}");
    }
}

/// Files that the collection calls valid, or that only the schema accepts.
#[test]
fn files_that_are_valid_have_no_errors() {
    let Some(folder) = collection() else { return };
    let table = fs::read_to_string(folder.join("verdicts.tsv")).unwrap();
    let mut seen = 0;
    for row in table.lines().skip(1) {
        let columns: Vec<&str> = row.split('\t').collect();
        let (path, schema, verdict) = (columns[0], columns[3], columns[4]);
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        let composite = load(&folder.join("files").join(path), &mut sources, &mut diagnostics);
        assert!(composite.is_some(), "{path} is well-formed");
        if schema == "valid" && verdict != "invalid" {
            assert!(!diagnostics.has_errors(), "{path}: {:?}", diagnostics.iter().next());
            seen += 1;
        }
    }
    assert!(seen > 500, "{seen} rows were looked at");
}

/// Violations of the schema that the loader knows are found, at the very element.
#[test]
fn files_that_are_invalid_by_the_vocabulary_have_an_error_there() {
    let Some(folder) = collection() else { return };
    let samples = files::all();
    for (path, expected) in [
        ("itest/validation/src/main/resources/XsdValidation/Calculator.composite", "error S1005 [binding.ws]"),
        ("assemblyxml/UnexpectedImplementationElement/Calculator.composite", "error S1005 [implementation.java]"),
        ("contribution/java/AttributePackageMissing/Calculator.composite", "error S1004 [export.java]"),
        ("DuplicateImplementationPropertyName/Calculator.composite", "error S1005 [property]"),
        ("DuplicateImplementationReferenceName/Calculator.composite", "error S1005 [reference]"),
        // Only warnings, as Tuscany gives them for SCA 1.0.
        ("NoComponentImplementation/Calculator.composite", "warning S1010 [component]"),
        ("NoCompositeNamespace/Calculator.composite", "warning S1009 [composite]"),
    ] {
        let sample = samples.iter().find(|one| one.name.ends_with(path));
        let sample = sample.unwrap_or_else(|| panic!("{path} is in {}", folder.display()));
        let found = checked(path, &sample.text);
        assert!(found.iter().any(|one| one == expected), "{path}: {found:?}");
    }
}

#[test]
fn every_file_is_read_with_right_places_and_as_another_parser_reads_it() {
    for Sample { name, text } in files::all() {
        checked(&name, &text);
        judge(&text);
    }
}

/// Cut and changed at places that are the same in each run: a few of each file of the collection.
#[test]
fn what_is_left_of_a_file_is_read_or_refused() {
    let mut state: u64 = 1;
    let mut random = |below: usize| {
        // Steele, Lea, Flood: Fast splittable pseudorandom number generators (2014); the mixing of SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) % below as u64) as usize
    };
    for Sample { name, text } in files::all() {
        for _ in 0..2 {
            broken(&name, &text.as_bytes()[..random(text.len())]);
            let mut bytes = text.clone().into_bytes();
            let at = random(bytes.len());
            bytes[at] ^= 1 << random(8);
            broken(&name, &bytes);
        }
    }
}

fn broken(name: &str, bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    checked(name, &text);
    judge(&text);
}

/// Some of a file's text, in another place of it or of another file.
fn transplant() -> impl Strategy<Value = String> {
    let texts: Vec<String> = files::shipped().into_iter().map(|sample| sample.text).collect();
    let text = || proptest::sample::select(texts.clone());
    let index = any::<proptest::sample::Index>;
    (text(), text(), index(), index(), 0..60_usize).prop_map(|(mut into, from, to, at, length)| {
        let start = from.floor_char_boundary(at.index(from.len()));
        let end = from.floor_char_boundary((start + length).min(from.len()));
        let to = into.floor_char_boundary(to.index(into.len()));
        let replaced = into.floor_char_boundary((to + length / 2).min(into.len()));
        into.replace_range(to..replaced, &from[start..end]);
        into
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn files_sewn_together_are_read_or_refused(text in transplant()) {
        checked("sewn", &text);
        judge(&text);
    }

    #[test]
    fn bytes_of_any_kind_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..60), xml in any::<bool>()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x");
        let start: &[u8] = if xml { b"<?xml version='1.0' encoding='latin1'?><a>" } else { b"" };
        fs::write(&path, [start, &bytes].concat()).unwrap();
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        let file = read(&path, MAX_SIZE, &mut sources, &mut diagnostics);
        prop_assert_eq!(file.is_none(), diagnostics.has_errors());
        for one in &diagnostics {
            let end = one.location.span.end as usize;
            prop_assert!(sources.get(one.location.file).text().is_char_boundary(end));
        }
    }
}
