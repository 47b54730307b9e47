//! Values as short texts.

use std::fmt::Write;

use serde_json::Value;

/// Writes a value as JSON. Numbers with a fraction have three digits of it, small ones four digits in all: more is not
/// seen, and would differ in each sample.
pub(super) fn write(value: &Value, text: &mut String) {
    match value {
        Value::Array(values) => {
            text.push('[');
            for (place, value) in values.iter().enumerate() {
                if place > 0 {
                    text.push(',');
                }
                write(value, text);
            }
            text.push(']');
        }
        Value::Object(fields) => {
            text.push('{');
            for (place, (name, value)) in fields.iter().enumerate() {
                if place > 0 {
                    text.push(',');
                }
                // Nothing fails in memory.
                let _ = write!(text, "{}:", Value::from(name.as_str()));
                write(value, text);
            }
            text.push('}');
        }
        Value::Number(number) => {
            let _ = match number.as_f64().filter(|_| number.is_f64()) {
                Some(fraction) => write!(text, "{}", rounded(fraction)),
                None => write!(text, "{number}"),
            };
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {
            let _ = write!(text, "{value}");
        }
    }
}

fn rounded(number: f64) -> f64 {
    let size = number.abs();
    if size >= 1e12 || size == 0.0 {
        return number;
    }
    let digits = if size >= 1.0 { 3 } else { 3 - size.log10().floor() as i32 };
    let scale = 10_f64.powi(digits.min(300));
    (number * scale).round() / scale
}
