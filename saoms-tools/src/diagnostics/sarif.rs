//! Diagnostics for code scanning: SARIF.

use saoms_lang::diagnostic::{Code, Diagnostic, Edit, Suggestion, codes};
use saoms_lang::source::{FileId, Location, Sources};
use serde::Serialize;
use serde_json::{Map, Value, json};

/// A log in the Static Analysis Results Interchange Format (OASIS SARIF 2.1.0), as code scanning services and editors
/// read it: one run, with every code as a rule and each suggestion as a fix.
#[derive(Debug, Serialize)]
pub struct Sarif<P> {
    #[serde(rename = "$schema")]
    schema: &'static str,
    runs: [Run<P>; 1],
    version: &'static str,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "camelCase")]
struct Run<P> {
    column_kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    properties: Option<P>,
    results: Vec<Value>,
    tool: Value,
}

/// The log of these diagnostics, with further properties of the run where there are some.
///
/// `version` is that of the program. Paths become URIs: relative ones stay relative to where the program ran.
pub fn sarif<P>(diagnostics: &[Diagnostic], sources: &Sources, version: &str, properties: Option<P>) -> Sarif<P> {
    let mut codes: Vec<&Code> = codes::ALL.to_vec();
    // Those of crates of components are known by what they found.
    for one in diagnostics {
        if !codes.iter().any(|code| code.id == one.code.id) {
            codes.push(one.code);
        }
    }
    let rules: Vec<Value> = codes.iter().map(|code| rule(code)).collect();
    let driver = json!({ "name": "saoms", "semanticVersion": version, "rules": rules });
    let run = Run {
        column_kind: "unicodeCodePoints",
        properties,
        results: diagnostics.iter().map(|one| result(one, &codes, sources)).collect(),
        tool: json!({ "driver": driver }),
    };
    Sarif { schema: "https://json.schemastore.org/sarif-2.1.0.json", runs: [run], version: "2.1.0" }
}

fn rule(code: &Code) -> Value {
    let anchor = format!("docs/diagnostics.md#{}-{}", code.id.to_lowercase(), code.name);
    let mut rule = json!({
        "id": code.id,
        "name": code.name,
        "shortDescription": message(code.meaning),
        "fullDescription": message(code.meaning),
        "help": message(&format!("{} An example of it is in {anchor}.", code.meaning)),
        "defaultConfiguration": { "level": code.severity.name() },
    });
    if let Some(sca) = code.rule {
        rule["properties"] = json!({ "tags": [sca] });
    }
    rule
}

fn result(one: &Diagnostic, codes: &[&Code], sources: &Sources) -> Value {
    let suggested = one.suggestions.iter().map(|suggestion| &suggestion.description);
    let lines = [&one.message].into_iter().chain(suggested).chain(&one.help);
    let text = lines.map(String::as_str).collect::<Vec<_>>().join("\n");
    let mut result = json!({
        "ruleId": one.code.id,
        "level": one.severity.name(),
        "message": message(&text),
        "locations": [{ "physicalLocation": place(one.location, sources) }],
    });
    if let Some(index) = codes.iter().position(|code| code.id == one.code.id) {
        result["ruleIndex"] = index.into();
    }
    if let Some(sca) = one.rule {
        result["properties"] = json!({ "tags": [sca] });
    }
    if let Some(set) = &one.set {
        // The command line gives no reason.
        let kind = if set.is_option { "external" } else { "inSource" };
        if one.is_allowed() {
            let mut suppression = json!({ "kind": kind, "location": { "physicalLocation": place(set.at, sources) } });
            if let Some(reason) = &set.reason {
                suppression["justification"] = reason.as_str().into();
            }
            result["suppressions"] = json!([suppression]);
        } else {
            result["properties"]["severityReason"] = set.reason.as_deref().into();
        }
    }
    if !one.labels.is_empty() {
        let labels = one.labels.iter();
        let related = labels.map(
            |label| json!({ "physicalLocation": place(label.location, sources), "message": message(&label.text) }),
        );
        result["relatedLocations"] = related.collect();
    }
    if !one.suggestions.is_empty() {
        result["fixes"] = one.suggestions.iter().map(|suggestion| fix(suggestion, sources)).collect();
    }
    result
}

fn fix(suggestion: &Suggestion, sources: &Sources) -> Value {
    let mut files: Vec<(FileId, Vec<Value>)> = Vec::new();
    for edit in &suggestion.edits {
        let file = edit.location.file;
        match files.iter_mut().find(|(known, _)| *known == file) {
            Some((_, replacements)) => replacements.push(replacement(edit, sources)),
            None => files.push((file, vec![replacement(edit, sources)])),
        }
    }
    let changes = files.into_iter().map(
        |(file, replacements)| json!({ "artifactLocation": artifact(file, sources), "replacements": replacements }),
    );
    json!({ "description": message(&suggestion.description), "artifactChanges": changes.collect::<Vec<_>>() })
}

fn replacement(edit: &Edit, sources: &Sources) -> Value {
    let mut replacement = json!({ "deletedRegion": region(edit.location, sources) });
    if !edit.replacement.is_empty() {
        replacement["insertedContent"] = json!({ "text": edit.replacement });
    }
    replacement
}

fn place(at: Location, sources: &Sources) -> Value {
    let mut place = Map::new();
    place.insert("artifactLocation".to_owned(), artifact(at.file, sources));
    // A file that could not be read has no regions.
    if !sources.get(at.file).text().is_empty() {
        place.insert("region".to_owned(), region(at, sources));
    }
    place.into()
}

fn region(at: Location, sources: &Sources) -> Value {
    let range = sources.get(at.file).range(at.span);
    json!({
        "startLine": range.start.line,
        "startColumn": range.start.column,
        "endLine": range.end.line,
        "endColumn": range.end.column,
    })
}

fn artifact(file: FileId, sources: &Sources) -> Value {
    json!({ "uri": uri(sources.get(file).path()) })
}

/// A path as a URI reference (RFC 3986): absolute ones of the scheme `file`, relative ones as they are.
fn uri(path: &str) -> String {
    let mut uri = String::from(if path.starts_with('/') { "file://" } else { "" });
    // A colon in the first part of a relative reference would end a scheme.
    if path.split('/').next().is_some_and(|first| first.contains(':')) {
        uri.push_str("./");
    }
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/!$&'()*+,;=:@".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    uri
}

/// A message string; braces would be placeholders (SARIF, 3.11.5).
fn message(text: &str) -> Value {
    json!({ "text": text.replace('{', "{{").replace('}', "}}") })
}
