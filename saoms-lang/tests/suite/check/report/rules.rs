//! `docs/rules.md`: what is held to which rule, generated from the table of codes and from the rules of SCA Assembly
//! 1.1.
//!
//! `UPDATE_EXPECT=1 cargo test -p saoms-lang --test suite rules` writes the page anew.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use expect_test::expect_file;
use saoms_lang::diagnostic::codes;

use crate::check::corpus::{MESSAGES, MORE_MESSAGES};

/// A rule of SCA Assembly 1.1, in our own words, and what holds it here.
struct Rule {
    id: &'static str,
    meaning: &'static str,
    codes: Vec<&'static str>,
    note: &'static str,
}

const HEAD: &str = "\
# Rules

These are the rules for composites. [diagnostics.md](diagnostics.md) describes each code, with an example. The example is
also the test of the code: it has this fault and no other. The examples are in `saoms-lang/tests/suite/check/examples`, for
`S50` in `tests/rules`, each in a file with the name of its code. `saoms-lang/tests/suite/check/report/reference.rs` makes
those of `S0001` to `S0009`, `S2035`, `S2072`, `S2073`, `S3016`, `S4028` and `S4031`, which cannot be files.

## Codes

| code | name | meaning | rules of SCA Assembly 1.1 | messages of Apache Tuscany |
| --- | --- | --- | --- | --- |
";

const SECOND: &str = "
## Rules of SCA Assembly 1.1

If a rule has no code, the last column gives the reason. SCA 1.0 has no numbers for its rules. Where it allows what 1.1 forbids, the diagnostic is a warning in
files of 1.0. Faults of the services and references of a composite of SCA 1.0 are warnings, too, if no other composite uses it: no component depends on them.

The XML schemas of both versions (ASM13001) are followed. Some things that they forbid are accepted, because other programs accept them, too:

- elements in another order: an implementation after services and references, an interface after bindings, an include after components;
- elements of other namespaces at any place;
- a composite's reference of 1.1 without `multiplicity`, which the schema requires: it takes one target (`1..1`), as in 1.0;
- a name that is not an XML name: it is a warning (S1011) if its first character is wrong, or if it has a colon or a blank. Other characters are accepted in names of components, properties, services and references. Names of classes and interfaces
  follow the rules of their languages;
- bindings, implementations and policies that the core schemas do not describe, such as those for JMS, EJB or BPEL: they are not checked.

`--assume-classes` is for composites of other programs, whose other files may be elsewhere. With it, a composite (S2030, S2031), a file of a value (S0001) or a
value of a composite property (S2025) that is missing is a warning, not an error.

| rule | meaning | codes | remark |
| --- | --- | --- | --- |
";

#[test]
fn every_rule_has_its_code_or_says_why_not() {
    let rules = rules();
    let mut page = HEAD.to_owned();
    for code in codes::ALL {
        let mut rules: BTreeSet<&str> =
            rules.iter().filter(|rule| rule.codes.contains(&code.id)).map(|rule| rule.id).collect();
        rules.extend(code.rule);
        let messages = MESSAGES
            .iter()
            .map(|(message, id, _)| (message, id))
            .chain(MORE_MESSAGES.iter().map(|(message, id)| (message, id)));
        let messages: BTreeSet<&str> =
            messages.filter(|(_, id)| **id == code.id).map(|(message, _)| *message).collect();
        let join = |all: BTreeSet<&str>| all.into_iter().collect::<Vec<_>>().join(", ");
        let _ =
            writeln!(page, "| {} | {} | {} | {} | {} |", code.id, code.name, code.meaning, join(rules), join(messages));
    }
    // Those of rules over whole fleets are of crates of components, which the core does not know:
    // `tests/suite/check/rules.rs` writes them.
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/rules.md");
    let present = fs::read_to_string(path).unwrap_or_default();
    for row in present.lines().filter(|line| line.starts_with("| S5")) {
        let _ = writeln!(page, "{row}");
    }
    page += SECOND;
    for rule in &rules {
        for code in &rule.codes {
            assert!(codes::ALL.iter().any(|known| known.id == *code), "{code} of {}", rule.id);
        }
        assert!(!rule.codes.is_empty() || !rule.note.is_empty(), "{} has neither code nor reason", rule.id);
        let _ = writeln!(
            page,
            "| {} | {} | {} | {} |",
            rule.id,
            rule.meaning.replace('|', "\\|"),
            rule.codes.join(", "),
            rule.note
        );
    }
    expect_file!["../../../../../docs/rules.md"].assert_eq(&page);
}

#[test]
fn rules_are_those_of_the_table_once_each() {
    assert!(rules().iter().map(|rule| rule.id).is_sorted_by(|one, next| one < next));
    for code in codes::ALL {
        assert!(
            code.rule.is_none_or(|id| rules().iter().any(|rule| rule.id == id)),
            "{} names an unknown rule",
            code.id
        );
    }
}

/// The rules in `rules.tsv`: number, meaning in our own words, codes, remark.
fn rules() -> Vec<Rule> {
    let rule = |line: &'static str| {
        let columns: Vec<&str> = line.split('\t').collect();
        let codes = columns[2].split(", ").filter(|code| !code.is_empty()).collect();
        Rule { id: columns[0], meaning: columns[1], codes, note: columns[3] }
    };
    include_str!("rules.tsv").lines().skip(1).map(rule).collect()
}
