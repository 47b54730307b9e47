use std::fmt::{self, Write};

use crate::host::declaration::escape;

/// A value in the run's report.
#[derive(Clone, Debug, PartialEq)]
pub enum ReportValue {
    /// Not known.
    Null,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Float(f64),
    /// Text.
    Text(String),
    /// A list.
    List(Vec<ReportValue>),
    /// Named values.
    Map(Vec<(String, ReportValue)>),
}

/// The value as JSON. Numbers that JSON cannot write, such as infinity, are `null`.
///
/// ```
/// use saoms_api::ReportValue;
///
/// let values = vec![("level".to_owned(), 80.5.into()), ("at".to_owned(), ReportValue::from("door \"A\""))];
/// assert_eq!(ReportValue::Map(values).to_string(), r#"{"level":80.5,"at":"door \"A\""}"#);
/// ```
impl fmt::Display for ReportValue {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReportValue::Bool(value) => value.fmt(formatter),
            ReportValue::Integer(value) => value.fmt(formatter),
            // As precise as it is, and with a decimal point: `1.0`.
            ReportValue::Float(value) if value.is_finite() => write!(formatter, "{value:?}"),
            ReportValue::Null | ReportValue::Float(_) => formatter.write_str("null"),
            ReportValue::Text(text) => quoted(text, formatter),
            ReportValue::List(values) => {
                formatter.write_char('[')?;
                for (place, value) in values.iter().enumerate() {
                    formatter.write_str(if place == 0 { "" } else { "," })?;
                    value.fmt(formatter)?;
                }
                formatter.write_char(']')
            }
            ReportValue::Map(values) => {
                formatter.write_char('{')?;
                for (place, (name, value)) in values.iter().enumerate() {
                    formatter.write_str(if place == 0 { "" } else { "," })?;
                    quoted(name, formatter)?;
                    formatter.write_char(':')?;
                    value.fmt(formatter)?;
                }
                formatter.write_char('}')
            }
        }
    }
}

/// Writes a text as a JSON string.
fn quoted(text: &str, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
    formatter.write_char('"')?;
    for letter in text.chars() {
        match u8::try_from(letter).map(escape) {
            Ok((escaped, length)) if letter.is_ascii() => {
                escaped[..length].iter().try_for_each(|byte| formatter.write_char(char::from(*byte)))?;
            }
            _ => formatter.write_char(letter)?,
        }
    }
    formatter.write_char('"')
}

macro_rules! from {
    ($($type:ty => $variant:ident),* $(,)?) => {
        $(impl From<$type> for ReportValue {
            fn from(value: $type) -> ReportValue {
                ReportValue::$variant(value.into())
            }
        })*
    };
}

from!(bool => Bool, i64 => Integer, i32 => Integer, u32 => Integer, f64 => Float, &str => Text, String => Text);

impl ReportValue {
    /// Named values, as [`ReportValue::Map`] and [`Component::status`](crate::Component::status) have them.
    pub fn named<const N: usize>(values: [(&str, ReportValue); N]) -> Vec<(String, ReportValue)> {
        values.map(|(name, value)| (name.to_owned(), value)).into()
    }
}

/// Vote of a component about the work that is left, for [`Context::vote`](crate::Context::vote).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// There is work left.
    Open,
    /// As far as this component sees, the work is done.
    Done,
    /// Some work was given up for good. The run is incomplete then, whatever ends it. This is independent of the work
    /// that is left: `Open` or `Done` does, before or after it.
    GivenUp,
}
