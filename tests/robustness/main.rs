//! Whatever a file holds, the program answers: no panic and no hang, for real composites with bytes changed, cut off,
//! or put elsewhere.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

#[path = "../../saoms-lang/tests/suite/load/collection.rs"]
mod collection;
mod memory;
mod targets;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use proptest::prelude::*;
use proptest::sample::{Index, select};
use saoms_components as _;

/// The step through the files of the larger collection.
const EVERY: usize = 12;

/// The composites of this repository, and some of the larger collection beside it.
static FILES: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = below(&root.join("composites"));
    paths.extend(below(&root.join("saoms-lang/tests")));
    paths.extend(of_collection(EVERY));
    paths.into_iter().map(|path| fs::read(path).unwrap()).collect()
});

/// Of the larger collection, where it is there, every file of so many.
fn of_collection(every: usize) -> impl Iterator<Item = PathBuf> {
    let files = collection::collection().map(|folder| below(&folder.join("files")));
    files.unwrap_or_default().into_iter().step_by(every)
}

fn below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(below(&path));
        } else if path.extension().is_some_and(|extension| extension == "composite") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn holds(bytes: &[u8]) {
    targets::load(bytes);
    targets::check(bytes);
    targets::fmt(bytes);
}

#[test]
fn every_file_as_it_is() {
    assert!(FILES.len() > 80);
    FILES.iter().for_each(|bytes| holds(bytes));
}

/// The number of cases of each kind; `PROPTEST_CASES` in the environment gives another one.
fn cases() -> u32 {
    std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(60)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_bit_flipped(file in any::<Index>(), at in any::<Index>(), bit in 0..8_u32) {
        let mut bytes = file.get(&FILES).clone();
        if !bytes.is_empty() {
            let at = at.index(bytes.len());
            bytes[at] ^= 1 << bit;
        }
        holds(&bytes);
    }

    #[test]
    fn a_file_cut_off(file in any::<Index>(), at in any::<Index>()) {
        let bytes = file.get(&FILES);
        holds(&bytes[..at.index(bytes.len() + 1)]);
    }

    #[test]
    fn a_part_of_one_file_in_another(from in any::<Index>(), to in any::<Index>(), start in any::<Index>(), at in any::<Index>(), length in 1..200_usize) {
        let (from, mut to) = (from.get(&FILES), to.get(&FILES).clone());
        let start = start.index(from.len() + 1);
        let part = &from[start..from.len().min(start + length)];
        let at = at.index(to.len() + 1);
        to.splice(at..at, part.iter().copied());
        holds(&to);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases() / 3, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_fleet_out_of_the_grammar(bytes in proptest::collection::vec(any::<u8>(), 0..1200)) {
        targets::fleet(&bytes);
    }

    #[test]
    fn values_and_expressions(pieces in proptest::collection::vec(select(PIECES), 0..12), first in 0..6_usize) {
        let text = pieces.concat();
        targets::expression(text.as_bytes());
        targets::value(format!("{}\n{text}", "x".repeat(first)).as_bytes());
    }
}

/// Parts of values and expressions.
const PIECES: &[&str] = &[
    "at ",
    "then ",
    "from ",
    "every ",
    "1s",
    "500ms",
    " 3 times ",
    "luggage ",
    "(1,2)",
    "..",
    " to ",
    "random",
    "landing ",
    "breakdown R1",
    "\n",
    ";",
    "#",
    ".",
    "@",
    "type octile\nheight 2\nwidth 2\nmap\n",
    ",",
    "::",
    "COLLISIONTOPIC",
    "ETOPIC",
    "localhost",
    ":",
    "61616",
    "[::1]",
    "://",
    "${",
    "}",
    "$",
    "$${",
    "index",
    "large",
    "site",
    "is",
    " + ",
    " * ",
    "-",
    "%",
    "/",
    " and ",
    " or ",
    "not ",
    "==",
    "<",
    "'north'",
    "'",
    "(",
    ")",
    "0",
    "7",
    "9223372036854775807",
    ":03",
    "é",
    "🤖",
    " ",
];

#[test]
fn a_journal_with_parts_missing() {
    let whole = r#"{"components":[{"id":"R","name":"R"}],"journal":1}
{"id":1,"time_s":0.5,"component":"R","phase":"symptom","text":"t","values":{"battery":[1]}}
{"id":2,"time_s":1,"component":"R","loop":"l","phase":"decision","text":"u","cause":1}
{"end":{"time_s":2.0,"lost":0}}
"#;
    for (at, _) in whole.char_indices() {
        targets::journal(&whole.as_bytes()[..at]);
        targets::journal(format!("{}9{}", &whole[..at], &whole[at..]).as_bytes());
        targets::journal(format!("{}{}", &whole[..at], &whole[at + 1..]).as_bytes());
    }
}

/// Inputs that could take time quadratic in their size, or exhaust the stack.
#[test]
fn large_and_deep_files() {
    let composite = |content: &str| {
        format!(
            "<composite xmlns='http://www.osoa.org/xmlns/sca/1.0' xmlns:s='urn:saoms:1' name='c' targetNamespace='u'>{content}</composite>"
        )
    };
    let robot =
        |inside: &str| format!("<component name='R'><implementation.java class='robot.Robot001'/>{inside}</component>");
    let many = |of: &dyn Fn(usize) -> String| (0..1500).map(of).collect::<String>();
    let prefixes = many(&|at| format!(" xmlns:p{at}='u{at}'"));
    for text in [
        "<a>".repeat(30_000),
        composite(&"<component>".repeat(5_000)),
        composite(&robot("<reference name='world' target='R'/>").repeat(800)),
        composite(&format!("<component name='{}'/>", "x".repeat(100_000))),
        composite(&format!("<property name='p'>{}</property>", "<![CDATA[x]]>&lt;".repeat(5_000))),
        composite(&format!("<service name='s' promote='{}'/>", "a/b ".repeat(5_000))),
        composite(&"<!-- - -->\r\r\n".repeat(20_000)),
        composite(&many(&|at| format!("<component name='C{at}'/><wire source='X{at}/world' target='Y{at}'/>"))),
        composite(&many(&|at| {
            format!(
                "<component name='C{at}'><implementation.java class='C{at}'/><property name='p' source='$p{at}'/></component>"
            )
        })),
        composite(&format!(
            "<component name='C'{prefixes}>{}</component>",
            "<implementation.composite name='q:c'/>".repeat(1500)
        )),
        composite(&robot(&many(&|at| format!("<s:loop name='l{at}' class='saoms.BatteryMS' after='l{}'/>", at / 2)))),
        composite(&robot(&format!("<property name='topicRename'>{}</property>", many(&|at| format!("A{at},b::"))))),
        composite(&robot(&format!("<reference name='world' target='{}'/>", many(&|at| format!("R{at} "))))),
        composite(&format!(
            "<component name='R${{index}}' s:count='1'><property name='p'>{}</property></component>",
            "${x} ".repeat(5_000)
        )),
        composite(&many(&|at| {
            format!("<component name='C{at}'><s:severity code='S1010' level='note' reason='r{at}'/></component>")
        })),
    ] {
        holds(text.as_bytes());
    }
}
