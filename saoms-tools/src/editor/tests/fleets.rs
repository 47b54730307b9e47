//! Composites that are checked together.

use super::marked::renamed;
use crate::editor::testing::{composite, scene_of};

fn named(name: &str, inside: &str) -> String {
    composite(inside).replacen("name=\"fleet\"", &format!("name=\"{name}\""), 1)
}

/// The fleets that `fleet.composite` is part of, each as its files, those that may be parts of others with a `?`.
fn fleets(inside: &str, others: &[(&str, &str)]) -> Vec<String> {
    let scene = scene_of(&composite(inside), others);
    let name = |file: &usize| scene.files[*file].path.file_stem().unwrap().to_str().unwrap().to_owned();
    let all = scene.fleets().into_iter().map(|fleet| {
        let files: Vec<String> = fleet.files.iter().map(name).collect();
        format!("{}{}", files.join(" "), if fleet.may_be_part { "?" } else { "" })
    });
    all.collect()
}

#[test]
fn a_composite_is_checked_with_those_that_use_it() {
    assert_eq!(fleets("", &[]), ["fleet"]);
    let outer = named("outer", r#"<component name="I"><implementation.composite name="fleet"/></component>"#);
    let other = named("other", "<include name=\"fleet\"/>");
    assert_eq!(fleets("", &[("outer.composite", &outer)]), ["outer"]);
    assert_eq!(fleets("", &[("outer.composite", &outer), ("other.composite", &other)]), ["outer?", "other?"]);
    // One that nothing has to do with is a fleet of its own, and so this one may be meant for others.
    assert_eq!(fleets("", &[("apart.composite", &named("apart", ""))]), ["fleet?"]);
    let round = named("round", "<include name=\"fleet\"/>");
    assert_eq!(fleets("<include name=\"round\"/>", &[("round.composite", &round)]), ["fleet"]);
}

const DESCRIPTION: &str = r#"<contribution xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" xmlns:f="urn:f"><deployable composite="f:fleet"/><deployable composite="f:second"/></contribution>"#;

#[test]
fn what_is_deployable_together_is_one_fleet() {
    let (second, library) = (named("second", "<include name=\"inner\"/>"), named("library", ""));
    let inner = named("inner", "");
    let all = [
        ("second.composite", second.as_str()),
        ("library.composite", &library),
        ("inner.composite", &inner),
        ("sca-contribution.xml", DESCRIPTION),
    ];
    assert_eq!(fleets("", &all), ["fleet second"]);
    let of_inner = |others: &[(&str, &str)]| {
        let scene = scene_of(&inner, others);
        scene.fleets().iter().map(|fleet| (fleet.files.len(), fleet.may_be_part)).collect::<Vec<_>>()
    };
    let whole = composite("");
    let others = [("fleet.composite", whole.as_str()), all[0], all[1], all[3]];
    assert_eq!(of_inner(&others), [(2, false)]);
    let of_library = scene_of(&library, &[("fleet.composite", &whole), all[0], all[2], all[3]]);
    assert!(of_library.fleets()[0].may_be_part);
}

#[test]
fn what_is_exported_may_be_a_part_although_nothing_else_is_there() {
    let exports = |namespace: &str, deployable: &str| {
        let inside = format!("<export namespace=\"{namespace}\"/>{deployable}");
        let text = format!(
            "<contribution xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:f=\"urn:f\">{inside}</contribution>"
        );
        fleets("", &[("sca-contribution.xml", &text)])
    };
    assert_eq!(exports("urn:f", ""), ["fleet?"]);
    assert_eq!(exports("urn:other", ""), ["fleet"]);
    // What runs is whole.
    assert_eq!(exports("urn:f", "<deployable composite=\"f:fleet\"/>"), ["fleet"]);
}

#[test]
fn descriptions_follow_composites_that_are_renamed() {
    let marked = composite("").replace("name=\"fleet", "name=\"fl|eet");
    let all = renamed(&marked, &[("sca-contribution.xml", DESCRIPTION)], "port").unwrap();
    assert_eq!(all[1], DESCRIPTION.replace("f:fleet", "f:port"));
}
