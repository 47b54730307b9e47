//! One slip of the pen in a shipped fleet is reported, with as few diagnostics as possible.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;

use saoms_components as _;
use saoms_lang::diagnostic::Severity;
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_lang::source::{OpenTexts, Sources, Span};
use saoms_lang::syntax::{self, Document, Element};
use saoms_testkit::Fleet;

use crate::support::{project, shipped};

/// The places of each kind in a file where a slip is tried.
const PLACES: usize = 4;
/// The most diagnostics that one slip gives.
const MOST: usize = 4;
/// Of a hundred slips, so many give one diagnostic at least.
const ONE: usize = 95;

/// The bytes of a well-formed text that are markup, by what they are.
fn markup(document: &Document) -> Vec<(&'static str, Vec<usize>)> {
    let elements = || document.elements();
    let spans = |all: Vec<Span>| all.into_iter().flat_map(|span| span.start as usize..span.end as usize).collect();
    let tags: Vec<Span> =
        elements().flat_map(|one| [Some(one.start_tag_span()), one.end_tag_span()]).flatten().collect();
    let values: Vec<Span> = elements().flat_map(Element::written_attributes).map(|one| one.value_span()).collect();
    let slash = |one: Element<'_>| match one.end_tag_span() {
        Some(tag) => tag.start as usize + 1,
        None => one.start_tag_span().end as usize - 2,
    };
    let quotes = values.iter().flat_map(|value| [value.start as usize - 1, value.end as usize]);
    vec![
        ("<", tags.iter().map(|tag| tag.start as usize).collect()),
        (">", tags.iter().map(|tag| tag.end as usize - 1).collect()),
        ("/", elements().map(slash).collect()),
        ("quote", quotes.collect()),
        ("element", spans(elements().map(Element::name_span).collect())),
        ("end tag", spans(elements().filter_map(Element::end_name_span).collect())),
        ("attribute", spans(elements().flat_map(Element::attributes).map(|one| one.name_span()).collect())),
    ]
}

/// So many of all places, spread evenly.
fn some(all: &[usize], seed: usize) -> impl Iterator<Item = usize> {
    (0..PLACES.min(all.len())).map(move |place| all[(place * all.len() / PLACES + seed * 7) % all.len()])
}

#[test]
fn one_slip_gives_few_diagnostics() {
    let registry = Registry::linked().unwrap();
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    let (mut worst, mut seed) = (String::new(), 1);
    for path in shipped() {
        let text = fs::read_to_string(&path).unwrap();
        let check = |text: &str| {
            let mut open = OpenTexts::default();
            open.insert(&path, text.to_owned());
            let found = Project::new().file(&path).open_texts(open).compile(&registry).diagnostics;
            let told = found.into_iter().filter(|one| one.severity != Severity::Note && !one.is_allowed());
            told.map(|one| format!("{} {}", one.code.id, one.message)).collect::<Vec<String>>()
        };
        let before: BTreeSet<String> = check(&text).into_iter().collect();
        let mut sources = Sources::new();
        let document = syntax::parse(sources.add("", ""), &text.clone().into()).well_formed().unwrap();
        for (what, places) in markup(&document) {
            for at in some(&places, seed) {
                for is_twice in [false, true] {
                    let letter = if is_twice { &text[at..=at].repeat(2) } else { "" };
                    let slip = format!("{}{letter}{}", &text[..at], &text[at + 1..]);
                    let told: Vec<String> = check(&slip).into_iter().filter(|one| !before.contains(one)).collect();
                    *counts.entry(told.len()).or_default() += 1;
                    // A `>` more is text, which a value may be.
                    let is_text = what == ">" && is_twice;
                    if told.is_empty() && !is_text || told.len() > MOST {
                        let line = slip[..at].matches('\n').count();
                        let shown = slip.lines().nth(line).unwrap_or_default().trim();
                        let name = path.file_name().unwrap().to_string_lossy();
                        let how = if is_twice { "twice" } else { "none" };
                        let _ = writeln!(worst, "{name}:{} {what} {how}: {shown}", line + 1);
                        told.iter().for_each(|one| _ = writeln!(worst, "    {one}"));
                    }
                }
            }
            seed += 1;
        }
    }
    let all: usize = counts.values().sum();
    assert!(worst.is_empty(), "{worst}\n{counts:?}");
    assert!(counts[&1] * 100 >= all * ONE, "{counts:?}");
}

/// An end tag too many takes nothing away, and a name given twice hides at most one name: all else is judged, before it
/// and behind it.
#[test]
fn a_tag_or_a_name_too_many_hides_no_other_mistake() {
    let hall = project("composites/hall.composite");
    let mistakes = [
        ("luggage (3,1)", "lugage (3,1)", "S3014"),
        ("(3,10)<", "(3,10)\n at 2s breakdown Robot20<", "S5005"),
        ("target=\"World\"", "target=\"Wrld\"", "S2011"),
        ("<reference name=\"world\"", "<property name=\"dicharge\" value=\"1\"/><reference name=\"world\"", "S3004"),
        ("<reference name=\"world\"", "<property name=\"discharge\" source=\"$d\"/><reference name=\"world\"", "S2024"),
    ];
    let master = "<component name=\"Master\"";
    let world = "<property name=\"ID\" value=\"World\"/>";
    let late = "<component name=\"Late\"><implementation.rust class=\"saoms.MasterRobot\"/>\
        <property name=\"ID\" value=\"Late\"/><property name=\"period\" value=\"100ms\"/></component>\n";
    let slips = [
        (master, format!("</component>\n{master}"), "S0102"),
        (master, format!("{master} name=\"Mster\""), "S0106"),
        (master, format!("</composite>\n{master}"), "S0104"),
        (master, master.replace('<', "< "), "S0107"),
        (world, world.replace('/', "\\"), "S0101"),
        ("</composite>\n", format!("</composite>\n{late}"), "S0104"),
    ];
    for (place, slip, of_slip) in slips {
        let slip = hall.replacen(place, &slip, 1);
        assert_ne!(slip, hall, "{place}");
        for (right, wrong, code) in mistakes {
            let found = Fleet::of_text(slip.replacen(right, wrong, 1)).diagnostics();
            let codes: Vec<&str> = found.lines().filter_map(|line| line.split(' ').nth(1)).collect();
            assert!(codes.contains(&of_slip) && codes.contains(&code), "{code}: {found}");
        }
    }
}

#[test]
fn a_component_in_a_namespace_that_is_nearly_that_of_sca_is_told_once() {
    let hall = fs::read_to_string("composites/hall.composite").unwrap();
    let root = "xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\"";
    assert!(hall.contains(root), "{hall}");
    let place = hall.find("<component name=\"Master\"").unwrap();
    let end = place + hall[place..].find("</component>").unwrap();
    let slip = "http://docs.oasis-open.org/ns/openscsa/sca/200912";
    let text = format!("{}<s:{}</s:{}", &hall[..place], &hall[place + 1..end], &hall[end + 2..]);
    let told = Fleet::of_text(text.replacen(root, &format!("{root} xmlns:s=\"{slip}\""), 1)).diagnostics();
    assert!(told.starts_with("warning S1013"), "{told}");
    assert_eq!(told.lines().filter(|line| line.starts_with(char::is_alphabetic)).count(), 1, "{told}");
}
