//! Composites in, text out.

use std::fmt::Write as _;

use saoms_lang::assembly::Assembly;
use saoms_lang::check::{Options, Setting, check};
use saoms_lang::diagnostic::{Diagnostic, Diagnostics};
use saoms_lang::load::load_file;
use saoms_lang::model::Contribution;
use saoms_lang::source::{Location, Sources};

use crate::check::classes::registry;

/// A composite of SCA 1.1 around `inside`, which starts in line 2.
pub(crate) fn fleet(inside: &str) -> String {
    composite("http://docs.oasis-open.org/ns/opencsa/sca/200912", inside)
}

/// The same of SCA 1.0.
pub(crate) fn fleet_1_0(inside: &str) -> String {
    composite("http://www.osoa.org/xmlns/sca/1.0", inside)
}

fn composite(namespace: &str, inside: &str) -> String {
    format!(
        "<composite xmlns=\"{namespace}\" targetNamespace=\"urn:t\" name=\"fleet\">\n{}\n</composite>",
        inside.trim_matches('\n')
    )
}

/// Loads and checks texts as one fleet.
pub(crate) fn run(texts: &[&str], settings: &[&str]) -> (Option<Assembly>, Vec<Diagnostic>, Sources) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let names = ["fleet.composite", "more.composite"];
    let files: Vec<_> = texts.iter().zip(names).map(|(text, name)| sources.add(name, *text)).collect();
    let settings: Vec<_> = settings
        .iter()
        .filter_map(|text| Setting::parse("--set", text, &mut sources, &mut diagnostics))
        .collect();
    let composites: Vec<_> =
        files.iter().filter_map(|file| load_file(*file, &sources, &mut diagnostics)).collect();
    let assembly = check(
        &Contribution::of(composites),
        &registry(),
        &Options::with_settings(settings),
        &sources,
        &mut diagnostics,
    );
    (assembly, diagnostics.into_sorted(), sources)
}

/// Loads and checks the first text as a fleet that can name what is in the others; each is called as it says it is.
pub(crate) fn nested(
    texts: &[&str],
    settings: &[&str],
    assume_classes: bool,
) -> (Option<Assembly>, Vec<Diagnostic>, Sources) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let name = |text: &str| {
        text.split(" name=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap().to_owned()
    };
    let files: Vec<_> = texts.iter().map(|text| sources.add(name(text), *text)).collect();
    let settings =
        settings.iter().filter_map(|text| Setting::parse("--set", text, &mut sources, &mut diagnostics));
    let options = Options { settings: settings.collect(), assume_classes, ..Options::default() };
    let mut composites: Vec<_> =
        files.iter().filter_map(|file| load_file(*file, &sources, &mut diagnostics)).collect();
    let others = composites.split_off(1);
    let fleet = Contribution::with(composites, others);
    let assembly = check(&fleet, &registry(), &options, &sources, &mut diagnostics);
    (assembly, diagnostics.into_sorted(), sources)
}

/// A composite of SCA 1.1 of this name, for [`nested`]: attributes, then what is inside from line 2.
pub(crate) fn part(name: &str, attributes: &str, inside: &str) -> String {
    let inside = inside.trim_matches('\n');
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:t\" xmlns:t=\"urn:t\" name=\"{name}\" {attributes}>\n{inside}\n</composite>"
    )
}

/// What the first of these texts comes to, after what is wrong with it: components, values as text, targets.
pub(crate) fn outcome(texts: &[&str], settings: &[&str]) -> String {
    let (assembly, diagnostics, sources) = nested(texts, settings, false);
    let mut out: String = diagnostics.iter().map(|one| shown(one, &sources)).collect();
    for component in assembly.iter().flat_map(|assembly| &assembly.components) {
        let _ = write!(out, "{} ({})", component.path, component.class.name());
        for (name, value) in &component.values {
            let _ = write!(out, " {name}={value:?}");
        }
        for wire in &component.references {
            let assembly = assembly.as_ref().unwrap();
            let of = |target: &saoms_lang::assembly::Target| {
                format!("{}/{}", assembly.components[target.component].path, target.service)
            };
            let targets: Vec<String> = wire.targets.iter().map(of).collect();
            let _ = write!(out, " {}->{}", wire.reference, targets.join("+"));
        }
        out.push('\n');
    }
    out
}

/// What is wrong with a composite, with `inside` in one of SCA 1.1.
pub(crate) fn faults(inside: &str) -> String {
    faults_of(&[&fleet(inside)], &[])
}

/// What is wrong with texts and settings.
pub(crate) fn faults_of(texts: &[&str], settings: &[&str]) -> String {
    let (assembly, diagnostics, sources) = run(texts, settings);
    let has_errors = diagnostics.iter().any(|one| one.severity.name() == "error");
    assert_eq!(assembly.is_none(), has_errors, "there is an assembly exactly where there is no error");
    diagnostics.iter().map(|one| shown(one, &sources)).collect()
}

/// One diagnostic, a line for each part of it.
pub(crate) fn shown(one: &Diagnostic, sources: &Sources) -> String {
    let mut out =
        format!("{} {} {}: {}\n", at(one.location, sources), one.severity.name(), one.code.id, one.message);
    for label in &one.labels {
        let _ = writeln!(out, "  {} {}", at(label.location, sources), label.text);
    }
    for help in &one.help {
        let _ = writeln!(out, "  help: {help}");
    }
    for suggestion in &one.suggestions {
        let _ = write!(out, "  fix: {}", suggestion.description);
        for edit in &suggestion.edits {
            let _ = write!(out, " [{} {:?}]", at(edit.location, sources), edit.replacement);
        }
        out.push('\n');
    }
    out
}

/// `line:column-column`, or `line:column-line:column`, with the file unless it is the first.
fn at(location: Location, sources: &Sources) -> String {
    let file = sources.get(location.file);
    let range = file.range(location.span);
    let (start, end) = (range.start, range.end);
    let name = if location.file.0 == 0 { String::new() } else { format!("{}:", file.path()) };
    if start.line == end.line {
        return format!("{name}{}:{}-{}", start.line, start.column, end.column);
    }
    format!("{name}{}:{}-{}:{}", start.line, start.column, end.line, end.column)
}
