//! Diagnostics for machines.

use super::grouping::like_earlier;
use saoms_lang::diagnostic::Diagnostic;
use saoms_lang::source::{Location, Sources};
use serde_json::{Value, json};

/// An object for each diagnostic, with 1-based lines and columns in Unicode scalars, ends exclusive.
///
/// `rule` is null when the diagnostic stems from no rule of the SCA specification. `help` holds what people are shown
/// below the picture, the descriptions of suggestions included, a line each; it is null when there is nothing. Where
/// the severity was set, `set` says to what, where and why; what is allowed is there with the severity that it would
/// have. Of many that are alike, of which people see one, each but the first has `like`: the index of the first.
pub fn json(diagnostics: &[Diagnostic], sources: &Sources) -> Vec<Value> {
    let all = diagnostics.iter().zip(like_earlier(diagnostics));
    all.map(|(one, like)| {
        let mut object = diagnostic(one, sources);
        if let Some(like) = like {
            object["like"] = like.into();
        }
        object
    })
    .collect()
}

fn diagnostic(one: &Diagnostic, sources: &Sources) -> Value {
    let labels = one.labels.iter().map(|label| placed(label.location, sources, "text", &label.text));
    let suggestions = one.suggestions.iter().map(|suggestion| {
        let edits = suggestion.edits.iter();
        let edits: Vec<Value> =
            edits.map(|edit| placed(edit.location, sources, "replacement", &edit.replacement)).collect();
        json!({ "description": suggestion.description, "edits": edits })
    });
    let help = one.suggestions.iter().map(|suggestion| suggestion.description.as_str());
    let help: Vec<&str> = help.chain(one.help.iter().map(String::as_str)).collect();
    let help = (!help.is_empty()).then(|| help.join("\n"));
    let mut object = placed(one.location, sources, "message", &one.message);
    object["severity"] = one.severity.name().into();
    object["code"] = one.code.id.into();
    object["rule"] = one.rule.into();
    object["help"] = help.into();
    object["labels"] = labels.collect();
    object["suggestions"] = suggestions.collect();
    if let Some(set) = &one.set {
        let mut by = placed(set.at, sources, "level", set.level.name());
        by["reason"] = set.reason.as_deref().into();
        object["set"] = by;
    }
    object
}

fn placed(location: Location, sources: &Sources, key: &str, text: &str) -> Value {
    let file = sources.get(location.file);
    let range = file.range(location.span);
    json!({
        "file": file.path(),
        "line": range.start.line,
        "column": range.start.column,
        "end_line": range.end.line,
        "end_column": range.end.column,
        key: text,
    })
}
