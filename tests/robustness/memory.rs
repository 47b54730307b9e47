//! Whatever a file holds, reading and checking it takes at most 16 MB, 20 times its size, and 4 kB for each component.
//!
//! Counted are the bytes allocated at the peak, by the thread of the check.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use saoms_components as _;
use saoms_lang::project::{Compilation, Project};
use saoms_lang::registry::Registry;
use saoms_tools::diagnostics::{human, json};
use saoms_tools::graph::{Diagram, Picture, dot, mermaid, svg};
use tempfile::TempDir;

use crate::targets::memory::{peak, within};
use crate::{below, of_collection};

thread_local! {
    static REGISTRY: Registry = Registry::linked().unwrap();
    static FOLDER: TempDir = tempfile::tempdir().unwrap();
}

/// Reads, checks and tells what is wrong, as `saoms check` does; whether it could be run.
fn checked(bytes: &[u8]) -> bool {
    REGISTRY.with(|registry| {
        let path = FOLDER.with(|folder| folder.path().join("x.composite"));
        fs::write(&path, bytes).unwrap();
        let compilation = Project::new().file(path).compile(registry);
        let Compilation { output, diagnostics, sources, .. } = &compilation;
        drop(human(diagnostics, sources, false));
        drop(json(diagnostics, sources));
        output.is_some()
    })
}

#[track_caller]
fn holds(what: &str, bytes: &[u8]) {
    let components = bytes.windows(10).filter(|part| part == b"<component").count();
    within(what, bytes.len() + components * COMPONENT / 20, || _ = checked(bytes));
}

const HEAD: &str = "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='c' targetNamespace='u'>";

/// So much of a part in a composite.
fn composite(size: usize, before: &str, part: impl Fn(usize) -> String, after: &str) -> String {
    let mut text = format!("{HEAD}{before}");
    let mut number = 0;
    while text.len() < size {
        text += &part(number);
        number += 1;
    }
    text + after + "</composite>"
}

/// The composites of this repository, and some of the larger collection beside it.
fn files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = below(&root.join("composites"));
    paths.extend(of_collection(20));
    paths
}

#[test]
fn real_files_whole_cut_off_and_with_bits_flipped() {
    let files = files();
    assert!(files.len() > 10);
    for (number, path) in files.iter().enumerate() {
        let what = path.display().to_string();
        let mut bytes = fs::read(path).unwrap();
        holds(&what, &bytes);
        // Another place in each file.
        let at = number.wrapping_mul(7919) % bytes.len();
        holds(&what, &bytes[..at]);
        bytes[at] ^= 1 << (number % 8);
        holds(&what, &bytes);
    }
}

fn same(part: &'static str) -> impl Fn(usize) -> String {
    move |_| part.to_owned()
}

const SCENARIO: &str = "<component name='E'><implementation.java class='saoms.Environment'/>\
    <property name='ID'>E</property><property name='period'>1s</property><property name='scenario'>";

/// Inputs that take the most memory for their size.
#[test]
fn files_made_to_take_much() {
    const SIZE: usize = 1_000_000;
    for (what, text) in [
        ("elements", composite(SIZE, "", same("<a/>"), "")),
        ("components", composite(SIZE, "", same("<component name='a'/>"), "")),
        ("an expression", composite(SIZE, "<component name='g${", same("("), "}'/>")),
        ("a scenario", composite(SIZE, SCENARIO, same("at 1s x\n"), "</property></component>")),
        ("promoted", composite(SIZE, "<reference name='b' promote='", same("a "), "'/>")),
    ] {
        holds(what, text.as_bytes());
    }
}

/// Memory that a component may take beside 20 times its text, in bytes.
const COMPONENT: usize = 4_000;

/// Without faults the 16 MB are not needed: the limit here holds for fleets of any size.
#[test]
fn fleets_by_their_size_alone() {
    const SIZE: usize = 300_000;
    // The classes of the program are no part of what a file takes.
    REGISTRY.with(|_| ());
    for class in ["saoms.Robot", "robot.Robot001"] {
        let robot = |place: usize| {
            let number = place + 1;
            format!(
                "<component name='R{number}'><implementation.java class='{class}'/><property name='ID'>{number}</property><property name='period'>9</property><property name='number'>{number}</property></component>"
            )
        };
        let text = composite(SIZE, "", robot, "");
        let mut is_sound = false;
        let taken = peak(|| is_sound = checked(text.as_bytes()));
        assert!(is_sound, "nothing is wrong with {class}");
        assert!(taken <= 20 * text.len(), "{class}: {taken} bytes for {} of the file", text.len());
    }
}

/// The same where nearly everything is wrong: little is taken but by the size and the number of components.
#[test]
fn files_of_one_kind_by_their_size() {
    const SIZE: usize = 1_000_000;
    const REST: usize = 4_000_000;
    let component = "<component name='a'>";
    let end = "</component>";
    for (what, text) in [
        ("nothing of components", composite(SIZE, "", same("<component/>"), "")),
        ("components", composite(SIZE, "", |n| format!("<component name='c{n}'/>"), "")),
        ("wires", composite(SIZE, "", same("<wire/>"), "")),
        ("includes", composite(SIZE, "", same("<include/>"), "")),
        ("properties", composite(SIZE, component, same("<property/>"), end)),
        ("services", composite(SIZE, component, same("<service/>"), end)),
        ("references", composite(SIZE, component, same("<reference/>"), end)),
        ("loops", composite(SIZE, component, same("<s:loop xmlns:s='urn:saoms:1'/>"), end)),
    ] {
        let taken = peak(|| _ = checked(text.as_bytes()));
        let limit = REST + 20 * text.len() + COMPONENT * text.matches("<component").count();
        assert!(taken <= limit, "{what}: {taken} bytes for {} of the file, {limit} at most", text.len());
    }
}

/// Contents of one attribute.
#[test]
fn lists_as_long_as_they_can_be() {
    const SIZE: usize = 2_100_000;
    let target = "<component name='a'><reference name='b' target='";
    holds("targets", composite(SIZE, target, same("a "), "'/></component>").as_bytes());
}

/// The size of a component's picture does not depend on the number of others of its class.
#[test]
fn pictures_by_the_size_of_their_fleet() {
    const SIZE: usize = 300_000;
    let robot = |place: usize| {
        let number = place + 1;
        format!(
            "<component name='Robot{number}'><implementation.java class='saoms.Robot'/><property name='ID'>{number}</property><property name='period'>9</property><property name='number'>{number}</property><reference name='world' target='Robot{}/World{place}'/></component>",
            place / 2
        )
    };
    let text = composite(SIZE, "", robot, "");
    // The classes of the program are no part of what a file takes.
    REGISTRY.with(|_| ());
    for (what, draw) in [("svg", svg as fn(&Diagram) -> Picture<'_>), ("mermaid", mermaid), ("dot", dot)] {
        let taken = peak(|| {
            let diagram = REGISTRY.with(|registry| {
                let fleet = Project::new().in_memory().text("x.composite", text.as_str()).census(registry);
                Diagram::of(&fleet.contribution, registry, &fleet.output.unwrap())
            });
            write!(io::sink(), "{}", draw(&diagram)).unwrap();
        });
        assert!(taken <= 20 * text.len(), "{what}: {taken} bytes for {} of the file", text.len());
    }
}

/// Inputs that could take memory quadratic in their size.
#[test]
fn files_with_very_many_of_one_kind() {
    const SIZE: usize = 50_000;
    let component = |inside: &str| format!("<component name='a'>{inside}");
    let end = "</component>";
    let property = component("<property name='a'>");
    for (what, text) in [
        ("deep components", format!("{HEAD}{}", "<component name='a'>".repeat(SIZE / 20))),
        ("deep elements", "<a>".repeat(SIZE / 3)),
        ("deep values", format!("{HEAD}{property}{}", "<v>".repeat(SIZE / 3))),
        ("wires", composite(SIZE, "", same("<wire source='a' target='b'/>"), "")),
        ("includes", composite(SIZE, "", same("<include name='a'/>"), "")),
        ("properties", composite(SIZE, &component(""), same("<property name='a'/>"), end)),
        ("composite properties", composite(SIZE, "", |n| format!("<property name='{n}'/>"), "")),
        ("values", composite(SIZE, &property, same("<value/>"), "</property></component>")),
        ("services", composite(SIZE, &component(""), same("<service name='a'/>"), end)),
        ("references", composite(SIZE, &component(""), same("<reference name='a'/>"), end)),
        ("promotions", composite(SIZE, "", same("<service name='a' promote='b'/>"), "")),
        ("intents", composite(SIZE, "<component name='a' requires='", same("a "), "'/>")),
        ("attributes", composite(SIZE, "<component name='a' ", |n| format!("a{n}='' "), "/>")),
        ("namespaces", composite(SIZE, "<component name='a' ", |n| format!("xmlns:a{n}='{n}' "), "/>")),
        ("namespaces over and over", composite(SIZE, "", |n| format!("<b xmlns='{n}'/>"), "")),
        ("loops", composite(SIZE, &component(""), same("<s:loop xmlns:s='urn:saoms:1' name='a'/>"), end)),
        ("sections", composite(SIZE, "<property name='a'>", same("<![CDATA[<]]>"), "</property>")),
        ("unknown entities", composite(SIZE, "<property name='a'>", same("&a;"), "</property>")),
        ("less than", "<".repeat(SIZE)),
        ("no text", "\u{1}".repeat(SIZE)),
    ] {
        holds(what, text.as_bytes());
    }
}
