//! Composites in, text out.

use std::fmt::Write as _;
use std::path::Path;

use saoms_lang::assembly::Assembly;
use saoms_lang::diagnostic::Diagnostic;
use saoms_lang::project::{Compilation, Project, SET, SEVERITY};
use saoms_lang::source::{Location, Sources};

use crate::check::classes::registry;

/// The name of the first text.
const FIRST: &str = "fleet.composite";

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

/// The outcome of a project with the classes of these tests.
pub(crate) fn compiled(project: &Project) -> (Option<Assembly>, Vec<Diagnostic>, Sources) {
    let Compilation { output, mut diagnostics, sources, .. } = project.compile(&registry());
    diagnostics.retain(|one| !one.is_allowed());
    (output, diagnostics, sources)
}

/// Loads and checks texts as one fleet.
pub(crate) fn run(texts: &[&str], settings: &[&str]) -> (Option<Assembly>, Vec<Diagnostic>, Sources) {
    let project = Project::new().in_memory().set_all(settings.iter().copied());
    let named = texts.iter().zip([FIRST, "more.composite"]);
    compiled(&named.fold(project, |project, (text, name)| project.text(name, *text)))
}

/// Loads and checks the first text as a fleet that can name what is in the others; each is called as it says it is.
pub(crate) fn nested(
    texts: &[&str],
    settings: &[&str],
    assume_classes: bool,
) -> (Option<Assembly>, Vec<Diagnostic>, Sources) {
    let name = |text: &str| text.split(" name=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap().to_owned();
    let project = Project::new().in_memory().assume_classes(assume_classes);
    let project = project.set_all(settings.iter().copied()).text(name(texts[0]), texts[0]);
    compiled(&texts[1..].iter().fold(project, |project, text| project.other_text(name(text), *text)))
}

/// A composite of SCA 1.1 of this name, for [`nested`]: attributes, then what is inside from line 2.
pub(crate) fn part(name: &str, attributes: &str, inside: &str) -> String {
    let inside = inside.trim_matches('\n');
    format!(
        "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" targetNamespace=\"urn:t\" xmlns:t=\"urn:t\" name=\"{name}\" {attributes}>\n{inside}\n</composite>"
    )
}

/// The assembly of the first of these texts, after its diagnostics: components, values as text, targets.
pub(crate) fn outcome(texts: &[&str], settings: &[&str]) -> String {
    let (assembly, diagnostics, sources) = nested(texts, settings, false);
    let mut out = told(&diagnostics, &sources);
    for component in assembly.iter().flat_map(|assembly| &assembly.components) {
        let _ = write!(out, "{} ({})", component.path, component.class.name());
        for (name, value) in &component.values {
            let _ = write!(out, " {name}={value:?}");
        }
        for wire in &component.references {
            let assembly = assembly.as_ref().unwrap();
            let of = |target: &saoms_lang::assembly::WireTarget| {
                format!("{}/{}", assembly.components[target.component].path, target.service)
            };
            let targets: Vec<String> = wire.targets.iter().map(of).collect();
            let _ = write!(out, " {}->{}", wire.reference, targets.join("+"));
        }
        out.push('\n');
    }
    out
}

/// The diagnostics of a composite, with `inside` in one of SCA 1.1.
pub(crate) fn faults(inside: &str) -> String {
    faults_of(&[&fleet(inside)], &[])
}

/// The diagnostics of texts and settings.
pub(crate) fn faults_of(texts: &[&str], settings: &[&str]) -> String {
    let (assembly, diagnostics, sources) = run(texts, settings);
    let has_errors = diagnostics.iter().any(|one| one.severity.name() == "error");
    assert_eq!(assembly.is_none(), has_errors, "there is an assembly exactly where there is no error");
    told(&diagnostics, &sources)
}

/// The assembly of a project whose files are in a folder, and its diagnostics without that folder's name.
pub(crate) fn compiled_in(folder: &Path, project: &Project) -> (Option<Assembly>, String) {
    let (assembly, diagnostics, sources) = compiled(project);
    (assembly, told(&diagnostics, &sources).replace(&format!("{}/", folder.display()), ""))
}

/// All of these diagnostics.
pub(crate) fn told(diagnostics: &[Diagnostic], sources: &Sources) -> String {
    diagnostics.iter().map(|one| shown(one, sources)).collect()
}

/// One diagnostic, a line for each part of it.
pub(crate) fn shown(one: &Diagnostic, sources: &Sources) -> String {
    let mut out = format!("{} {} {}: {}\n", at(one.location, sources), one.severity.name(), one.code.id, one.message);
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
    let first = sources.iter().find(|(_, file)| ![SET, SEVERITY].contains(&file.path()));
    let is_first = first.is_some_and(|(id, _)| id == location.file);
    let name = if is_first { String::new() } else { format!("{}:", file.path()) };
    if start.line == end.line {
        return format!("{name}{}:{}-{}", start.line, start.column, end.column);
    }
    format!("{name}{}:{}-{}:{}", start.line, start.column, end.line, end.column)
}
