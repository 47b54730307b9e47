//! The status of a component of a library, which it writes as JSON.

use std::fmt;

use saoms_api::{Failure, ReportValue};
use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};

/// The named values of a status. A name that stands twice is kept twice, so that whoever shows them finds it.
pub(super) fn read_status(bytes: &[u8]) -> Result<Vec<(String, ReportValue)>, Failure> {
    if bytes.is_empty() {
        return Ok(Vec::new());
    }
    let refused = |error: &dyn fmt::Display| Failure::new(format!("its status is not one JSON object: {error}"));
    match serde_json::from_slice(bytes) {
        Ok(Json(ReportValue::Map(values))) => Ok(values),
        Ok(_) => Err(refused(&"it is another value")),
        Err(error) => Err(refused(&error)),
    }
}

/// A value that was written as JSON.
struct Json(ReportValue);

impl<'de> Deserialize<'de> for Json {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Json, D::Error> {
        deserializer.deserialize_any(JsonVisitor).map(Json)
    }
}

struct JsonVisitor;

impl<'de> Visitor<'de> for JsonVisitor {
    type Value = ReportValue;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a value")
    }

    fn visit_unit<E: Error>(self) -> Result<ReportValue, E> {
        Ok(ReportValue::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<ReportValue, E> {
        Ok(value.into())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<ReportValue, E> {
        Ok(value.into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<ReportValue, E> {
        Ok(i64::try_from(value).map_or_else(|_| ReportValue::Float(value as f64), ReportValue::from))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<ReportValue, E> {
        Ok(value.into())
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<ReportValue, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<ReportValue, A::Error> {
        let mut list = Vec::new();
        while let Some(Json(value)) = values.next_element()? {
            list.push(value);
        }
        Ok(ReportValue::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut values: A) -> Result<ReportValue, A::Error> {
        let mut map = Vec::new();
        while let Some((name, Json(value))) = values.next_entry()? {
            map.push((name, value));
        }
        Ok(ReportValue::Map(map))
    }
}
