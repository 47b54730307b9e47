//! Limits on the files that a search reads.

use std::fs;
use std::path::Path;

use super::head::LOOKED_AT;
use super::index::Index;
use super::*;
use crate::diagnostic::Diagnostics;
use crate::load::{MAX_SIZE, load_file, read};
use crate::model::{Composite, Contribution, Link, Naming, Version};
use crate::source::{OpenTexts, Sources};

fn composite(name: &str, includes: &[String]) -> String {
    let includes: String = includes.iter().map(|name| format!("<include name='t:{name}'/>")).collect();
    format!(
        "<composite xmlns='{}' xmlns:t='urn:t' name='{name}' targetNamespace='urn:t'>{includes}</composite>",
        Version::Osoa10.namespace()
    )
}

fn load(path: &Path, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<Composite> {
    let file = read(path, MAX_SIZE, sources, diagnostics)?;
    load_file(file, sources, diagnostics)
}

#[test]
fn the_fleets_of_a_folder_read_each_first_tag_once() {
    const FLEETS: usize = 60;
    let folder = tempfile::tempdir().unwrap();
    for number in 0..FLEETS {
        let includes = [format!("part{number}"), format!("none{number}")];
        let path = |kind: &str| folder.path().join(format!("{kind}-{number}.composite"));
        fs::write(path("fleet"), composite(&format!("fleet{number}"), &includes)).unwrap();
        fs::write(path("part"), composite(&format!("part{number}"), &[])).unwrap();
    }
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let mut finder = Finder::new(OpenTexts::default());
    let fleets = finder.load_folder(folder.path(), MAX_SIZE, &mut sources, &mut diagnostics);
    assert_eq!(fleets.len(), FLEETS);
    let before = LOOKED_AT.get();
    for fleet in fleets {
        let first = load(&fleet.files[0], &mut sources, &mut diagnostics).unwrap();
        let mut all = Contribution::of(vec![first]);
        finder.load_named(&mut all, MAX_SIZE, &mut sources, &mut diagnostics);
        assert_eq!(all.composites().len(), 2);
    }
    assert_eq!(LOOKED_AT.get() - before, 2 * FLEETS);
    assert!(diagnostics.is_empty());
}

#[test]
fn right_names_are_looked_at_a_million_times_for_wrong_ones() {
    const NAMES: usize = 1500;
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("part.composite"), composite("part", &[])).unwrap();
    for number in 0..NAMES - 1 {
        let path = folder.path().join(format!("{number}.composite"));
        fs::write(path, composite(&format!("quite-another-one-{number}"), &[])).unwrap();
    }
    let wrong = vec!["prat".to_owned(); NAMES];
    let path = folder.path().join("fleet.composite");
    fs::write(&path, composite("fleet", &wrong)).unwrap();
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let mut all = Contribution::of(vec![load(&path, &mut sources, &mut diagnostics).unwrap()]);
    Finder::new(OpenTexts::default()).load_named(&mut all, MAX_SIZE, &mut sources, &mut diagnostics);
    let has_near = |include| match all.link(Naming::of_include(include).unwrap().origin) {
        Some(Link::Missing(missing)) => !missing.near.is_empty(),
        link => panic!("{link:?}"),
    };
    let proposed: Vec<bool> = all.asked_for()[0].includes.iter().map(has_near).collect();
    let most = 1_000_000 / (NAMES + 1);
    assert!(proposed[..most].iter().all(|one| *one) && !proposed[most..].contains(&true));
}

#[test]
fn what_lies_beyond_the_entries_that_are_looked_at_is_said_to() {
    let folder = tempfile::tempdir().unwrap();
    for number in 0..5 {
        let path = folder.path().join(format!("c{number}.composite"));
        fs::write(path, composite(&format!("c{number}"), &[])).unwrap();
    }
    for (entries, is_complete) in [(4, false), (5, true)] {
        let mut index = Index::new(OpenTexts::default());
        index.limit(entries);
        assert_eq!(index.find(folder.path(), None, "hall"), None);
        assert_eq!(!index.is_cut, is_complete);
        assert_eq!(index.searched(folder.path()).contains("searched only the first"), !is_complete);
        assert_eq!(index.names_around(folder.path()).len(), entries);
    }
}

#[test]
fn below_the_root_of_the_file_system_nothing_is_searched() {
    let mut index = Index::new(OpenTexts::default());
    assert_eq!(index.folders(Path::new("/"), |_| true).0, [Path::new("/")]);
}

#[test]
fn a_description_of_another_name_is_told_in_a_folder() {
    let told = |name: &str, text: &str| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("fleet.composite"), composite("fleet", &[])).unwrap();
        fs::write(folder.path().join(name), text).unwrap();
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        Finder::new(OpenTexts::default()).load_folder(folder.path(), MAX_SIZE, &mut sources, &mut diagnostics);
        diagnostics.iter().map(|one| format!("{} {}", one.code.id, one.help.join("; "))).collect::<String>()
    };
    let text = format!("<contribution xmlns='{}'/>", Version::Osoa10.namespace());
    let expected = "S1001 rename the file to `sca-contribution.xml`";
    assert_eq!(told("sca_contribution.xml", &text), expected);
    assert_eq!(told("contribution.xml", &text), expected);
    assert_eq!(told("sca-contribution.xml", &text), "");
    // Other programs have contributions of their own.
    assert_eq!(told("contribution.xml", "<contribution/>"), "");
}
