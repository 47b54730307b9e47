//! Values of properties as bytes: each scalar is the text that its property reads.

use saoms_api::host::declaration::Scalar;
use saoms_api::host::{PropertyValue, SmolStr};
use serde_json::{Value, json};

type Values = [(SmolStr, PropertyValue)];

/// Values as bytes.
pub(crate) fn values_as_bytes(values: &Values) -> Vec<u8> {
    named(values).to_string().into_bytes()
}

/// The values that such bytes say; `None` where they say none.
pub(crate) fn values_of_bytes(bytes: &[u8]) -> Option<Vec<(SmolStr, PropertyValue)>> {
    of_named(&serde_json::from_slice(bytes).ok()?)
}

/// A class of a loop with values, as bytes.
pub(crate) fn with_loop(class: &str, values: &Values) -> Vec<u8> {
    json!([class, named(values)]).to_string().into_bytes()
}

/// The class of a loop and the values that such bytes say.
pub(crate) fn loop_of_bytes(bytes: &[u8]) -> Option<(String, Vec<(SmolStr, PropertyValue)>)> {
    let value: Value = serde_json::from_slice(bytes).ok()?;
    Some((value.get(0)?.as_str()?.to_owned(), of_named(value.get(1)?)?))
}

/// Pairs of names and values: those of an object would have no order.
fn named(values: &Values) -> Value {
    Value::Array(values.iter().map(|(name, value)| json!([name.as_str(), json(value)])).collect())
}

fn json(value: &PropertyValue) -> Value {
    match value {
        PropertyValue::Scalar(scalar) => Value::from(scalar.text().as_str()),
        PropertyValue::Many(values) => json!({ "many": values.iter().map(json).collect::<Vec<_>>() }),
        PropertyValue::Complex(values) => named(values),
    }
}

fn of_named(value: &Value) -> Option<Vec<(SmolStr, PropertyValue)>> {
    let pair = |pair: &Value| Some((pair.get(0)?.as_str()?.into(), of_json(pair.get(1)?)?));
    value.as_array()?.iter().map(pair).collect()
}

fn of_json(value: &Value) -> Option<PropertyValue> {
    Some(match value {
        Value::String(text) => Scalar::Text(text.into()).into(),
        Value::Object(of) => {
            PropertyValue::Many(of.get("many")?.as_array()?.iter().map(of_json).collect::<Option<_>>()?)
        }
        complex => PropertyValue::Complex(of_named(complex)?.into()),
    })
}
