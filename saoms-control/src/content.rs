//! What messages say, for browsers.

use saoms_core::observe::SentMessage;
use saoms_lang::schema::Schema;
use serde_json::Value;

/// The greatest number that a browser has exactly.
const GREATEST: u64 = 1 << 53;

/// The fields of a message. Numbers that a browser does not have are texts.
pub(crate) fn content(sent: &SentMessage, schema: &Schema) -> Value {
    let mut message = schema.decode(sent.message.bytes()).unwrap_or_default();
    exact(&mut message);
    message
}

/// Makes whole numbers that a browser would round texts.
fn exact(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(exact),
        Value::Object(fields) => fields.values_mut().for_each(exact),
        Value::Number(number) => {
            let is_greater = number.as_u64().is_some_and(|one| one > GREATEST)
                || number.as_i64().is_some_and(|one| one.unsigned_abs() > GREATEST);
            if is_greater {
                *value = Value::from(number.to_string());
            }
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn numbers_that_a_browser_would_round_are_texts() {
        let mut value = json!({"a": [u64::MAX, GREATEST, -1.5], "b": i64::MIN, "c": "18446744073709551615"});
        exact(&mut value);
        let expected = json!({
            "a": ["18446744073709551615", GREATEST, -1.5], "b": "-9223372036854775808", "c": "18446744073709551615",
        });
        assert_eq!(value, expected);
    }
}
