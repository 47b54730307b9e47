//! Rules over whole fleets, as `saoms components` lists them.

use std::fmt::Write;

use saoms_lang::registry::RegisteredRule;
use serde_json::{Value, json};

/// A line per rule that a plugin brings; those that ship are in the manual of diagnostics.
pub(super) fn listed(rules: &[RegisteredRule]) -> String {
    let mut text = String::new();
    let of_plugins: Vec<&RegisteredRule> = rules.iter().filter(|rule| rule.origin().is_some()).collect();
    let width = of_plugins.iter().map(|rule| rule.code().name.len()).max().unwrap_or(0);
    for rule in &of_plugins {
        let code = rule.code();
        let start = if text.is_empty() { "\nRules of plugins over whole fleets:\n" } else { "" };
        let meaning = code.meaning.trim_end_matches('.');
        let _ = writeln!(text, "{start}{}  {:width$}  {meaning}", code.id, code.name);
    }
    text
}

pub(super) fn as_json(rule: &RegisteredRule) -> Value {
    let code = rule.code();
    json!({
        "code": code.id,
        "name": code.name,
        "meaning": code.meaning,
        "severity": code.severity.name(),
        "library": rule.origin(),
    })
}
