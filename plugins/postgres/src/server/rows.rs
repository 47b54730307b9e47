//! Rows as PostgreSQL takes them.

use std::borrow::Cow;

use postgres::types::ToSql;
use saoms_api::extension::HistoryValue;
use serde::de::IgnoredAny;
use serde_json::Value;

use super::names::quoted;
use crate::table::{Kind, Row, Table};

/// The values of a column in several rows.
pub(super) type Values<'a> = Box<dyn ToSql + Sync + 'a>;

/// The statement that adds rows to a table, or brings those up to date that it has: a list of values for each column.
pub(super) fn statement(schema: &str, table: &Table) -> String {
    let names: Vec<String> = table.columns.iter().map(|column| quoted(&column.name)).collect();
    let list = names.join(", ");
    let (mut places, mut taken) = (Vec::new(), Vec::new());
    for ((place, column), name) in table.columns.iter().enumerate().zip(&names) {
        let kind = if column.kind == Kind::Json { Kind::Text } else { column.kind };
        places.push(format!("${}::{}[]", place + 1, kind.in_postgres()));
        taken.push(if column.kind == Kind::Json { format!("{name}::jsonb") } else { name.clone() });
    }
    let (places, taken) = (places.join(", "), taken.join(", "));
    let table_name = format!("{}.{}", quoted(schema), quoted(&table.name));
    let insert =
        format!("INSERT INTO {table_name} AS known ({list}) SELECT {taken} FROM unnest({places}) AS new ({list})");
    if table.key.is_empty() {
        return insert;
    }
    let key = table.key_names().map(quoted).collect::<Vec<_>>().join(", ");
    let others: Vec<&String> =
        names.iter().enumerate().filter(|(place, _)| !table.key.contains(place)).map(|(_, name)| name).collect();
    if others.is_empty() {
        return format!("{insert} ON CONFLICT ({key}) DO NOTHING");
    }
    let of = |of: &str| others.iter().map(|name| format!("{of}.{name}")).collect::<Vec<_>>().join(", ");
    let changes = others.iter().map(|name| format!("{name} = excluded.{name}")).collect::<Vec<_>>().join(", ");
    let (known, new) = (of("known"), of("excluded"));
    format!("{insert} ON CONFLICT ({key}) DO UPDATE SET {changes} WHERE ({known}) IS DISTINCT FROM ({new})")
}

/// The values of each column in some rows.
pub(super) fn columns<'a>(table: &Table, rows: &'a [Row]) -> Vec<Values<'a>> {
    let values = |place: usize| rows.iter().map(move |row| row.get(place).unwrap_or(&HistoryValue::Null));
    let column = |(place, kind): (usize, Kind)| -> Values<'a> {
        match kind {
            Kind::Integer => Box::new(values(place).map(integer).collect::<Vec<_>>()),
            Kind::Real => Box::new(values(place).map(real).collect::<Vec<_>>()),
            Kind::Text | Kind::Json => Box::new(values(place).map(text).collect::<Vec<_>>()),
        }
    };
    table.columns.iter().map(|column| column.kind).enumerate().map(column).collect()
}

fn integer(value: &HistoryValue) -> Option<i64> {
    match value {
        HistoryValue::Integer(value) => Some(*value),
        HistoryValue::Real(value) => Some(*value as i64),
        HistoryValue::Null | HistoryValue::Text(_) => None,
    }
}

fn real(value: &HistoryValue) -> Option<f64> {
    match value {
        HistoryValue::Integer(value) => Some(*value as f64),
        HistoryValue::Real(value) => Some(*value),
        HistoryValue::Null | HistoryValue::Text(_) => None,
    }
}

fn text(value: &HistoryValue) -> Option<Cow<'_, str>> {
    match value {
        HistoryValue::Null => None,
        HistoryValue::Integer(value) => Some(Cow::Owned(value.to_string())),
        HistoryValue::Real(value) => Some(Cow::Owned(value.to_string())),
        HistoryValue::Text(text) => Some(Cow::Borrowed(text)),
    }
}

/// Makes a row what PostgreSQL takes: it has no character NUL, in no text and in no JSON. Where there is one, U+FFFD
/// takes its place; what is no JSON where there should be some becomes a string. True if something was replaced.
pub(crate) fn make_fit(table: &Table, row: &mut Row) -> bool {
    let mut is_changed = false;
    for (column, value) in table.columns.iter().zip(row) {
        let HistoryValue::Text(text) = value else { continue };
        let replaced = match column.kind {
            Kind::Json => json_that_fits(text),
            _ => text.contains('\0').then(|| without_nul(text)),
        };
        if let Some(replaced) = replaced {
            *text = replaced;
            is_changed = true;
        }
    }
    is_changed
}

fn without_nul(text: &str) -> String {
    text.replace('\0', "\u{fffd}")
}

/// JSON in place of a text, if it does not fit.
fn json_that_fits(text: &str) -> Option<String> {
    let is_json = serde_json::from_str::<IgnoredAny>(text).is_ok();
    if is_json && !text.contains("\\u0000") {
        return None;
    }
    let found = serde_json::from_str::<Value>(text).unwrap_or_else(|_| Value::from(text));
    let fitting = value_without_nul(found.clone());
    // An escaped `\` before `u0000` is none.
    (!is_json || fitting != found).then(|| fitting.to_string())
}

fn value_without_nul(value: Value) -> Value {
    match value {
        Value::String(text) => Value::String(without_nul(&text)),
        Value::Array(values) => Value::Array(values.into_iter().map(value_without_nul).collect()),
        Value::Object(members) => Value::Object(
            members.into_iter().map(|(name, value)| (without_nul(&name), value_without_nul(value))).collect(),
        ),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_has_no_nul_and_is_json() {
        for (given, expected) in [
            (r#"{"a":"b"}"#, None),
            (r#"{"a\u0000":["\u0000b"]}"#, Some("{\"a\u{fffd}\":[\"\u{fffd}b\"]}")),
            (r#"{"a":"\\u0000"}"#, None),
            ("", Some("\"\"")),
            ("not\0json", Some("\"not\u{fffd}json\"")),
        ] {
            assert_eq!(json_that_fits(given).as_deref(), expected, "{given}");
        }
    }
}
