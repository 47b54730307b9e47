mod flat;
mod read;
mod reserved;
mod secret;
mod shape;
#[cfg(test)]
mod tests;
mod types;

pub(crate) use flat::values_of;
pub use flat::{all_names, are_distinct, continued, count, list};
pub use read::{Values, complex, flat, property, read, scalar};
pub use reserved::{RESERVED, refuse_reserved};
pub use secret::Secret;
pub use shape::{PropertyField, PropertyShape, contains, default_fits, equal};

use std::fmt;

use crate::Failure;
use crate::host::SmolStr;
use crate::host::declaration::Scalar;

/// A value as the composite gives it, once `source` and `file` are resolved.
#[derive(Clone, PartialEq)]
pub enum PropertyValue {
    /// One value of the type that the property has.
    Scalar(Scalar),
    /// The values of a property that takes many.
    Many(Box<[PropertyValue]>),
    /// The named values of a complex property.
    Complex(Box<[(SmolStr, PropertyValue)]>),
}

const _: () = assert!(size_of::<PropertyValue>() == size_of::<SmolStr>(), "large fleets have many values");

impl PropertyValue {
    /// The text; `None` where it is not one.
    #[inline]
    pub fn as_text(&self) -> Option<&SmolStr> {
        match self {
            PropertyValue::Scalar(scalar) => scalar.as_text(),
            _ => None,
        }
    }
}

/// As `Integer(7)`: of one value there is nothing else to show.
impl fmt::Debug for PropertyValue {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PropertyValue::Scalar(scalar) => scalar.fmt(formatter),
            PropertyValue::Many(values) => formatter.debug_tuple("Many").field(values).finish(),
            PropertyValue::Complex(values) => formatter.debug_tuple("Complex").field(values).finish(),
        }
    }
}

impl From<Scalar> for PropertyValue {
    fn from(scalar: Scalar) -> PropertyValue {
        PropertyValue::Scalar(scalar)
    }
}

/// A text as a composite writes it, which its taker reads.
impl From<&str> for PropertyValue {
    fn from(text: &str) -> PropertyValue {
        PropertyValue::Scalar(Scalar::Text(text.into()))
    }
}

/// The properties of a component, which a composite sets. Derive it on a struct whose fields are [`PropertyField`]s.
///
/// ```
/// use std::time::Duration;
/// use saoms_api::{Properties, PropertyField};
///
/// /// What to do with late messages.
/// #[derive(Debug, PartialEq, PropertyField)]
/// enum Late {
///     /// Use them.
///     Use,
///     /// Forget them.
///     DropSilently,
/// }
///
/// #[derive(Properties)]
/// struct GuardProperties {
///     /// The number of the guard.
///     #[property(range = 1..=99, unique = "guard")]
///     number: u8,
///     /// How long to wait.
///     #[property(default = "500ms", range = "1ms"..="1h")]
///     wait_time: Duration,
///     /// Late messages.
///     #[property(default = "use")]
///     late: Late,
///     /// What to call it on screens.
///     #[property(name = "label")]
///     title: Option<String>,
/// }
///
/// let values = [("number".into(), "7".into()), ("late".into(), "dropSilently".into())];
/// let properties = GuardProperties::from_values(&values).unwrap();
/// assert_eq!((properties.number, properties.wait_time), (7, Duration::from_millis(500)));
/// assert_eq!((properties.late, properties.title), (Late::DropSilently, None));
///
/// let failure = GuardProperties::from_values(&[("number".into(), "100".into())]).err().unwrap();
/// assert_eq!(failure.message(), "property `number`: `100` is out of range: expected a whole number from 1 to 99");
/// ```
///
/// # Attributes
/// A property's name is the field's name in lowerCamelCase, its doc is the field's. `#[property(...)]` takes:
///
/// | attribute | meaning |
/// | --- | --- |
/// | `name = "..."` | another name |
/// | `default = 5` | a literal, as the composite would write it; text for durations and enumerations |
/// | `range = 1..=99` | for numbers; also `0.0..1.0`, `1..`, `..=9`, and `"1ms"..="1h"` for durations |
/// | `unit = "m"` | shown to people |
/// | `allowed("a", "b")` | for strings |
/// | `speaker` | it says as whom the component speaks, in [messages](crate::Message#who-speaks) that name their speaker |
/// | `unique = "robot"` | no two components of a composite have the same value for properties with this word |
/// | `required_text` | for strings: not empty, not blank |
/// | `flatten` | the field is a property struct itself, whose properties stand here |
///
/// A property without a default is required, unless its type is an `Option` or a `Vec`.
///
/// A default or a bound that is no value of its property does not compile:
///
/// ```compile_fail
/// #[derive(saoms_api::Properties)]
/// struct Wrong {
///     #[property(default = "5 parsecs")]
///     wait_time: std::time::Duration,
/// }
/// ```
pub trait Properties: Sized {
    /// The properties as a JSON array, in the shape of [`crate::host::declaration`].
    const DECLARATION: &'static str;
    /// Their names, in order.
    const NAMES: &'static [&'static str];

    /// Reads the values; absent ones take their defaults.
    ///
    /// # Errors
    /// A value is missing, unknown, given twice, or not what the declaration allows: its name, what was found, what was
    /// expected.
    fn from_values(values: &[(SmolStr, PropertyValue)]) -> Result<Self, Failure>;
}

/// Properties that can be written as a composite gives them. Derive it beside [`Properties`], where no field is
/// complex.
///
/// ```
/// use saoms_api::Properties;
/// use saoms_api::host::WriteProperties;
///
/// #[derive(Properties, WriteProperties)]
/// struct GuardProperties {
///     number: u8,
///     #[property(default = "500ms")]
///     wait_time: std::time::Duration,
///     title: Option<String>,
/// }
///
/// let guard = GuardProperties::from_values(&[("number".into(), "+7".into())]).unwrap();
/// assert_eq!(format!("{:?}", guard.to_values()), r#"[("number", Integer(7)), ("waitTime", Duration(500ms))]"#);
/// ```
pub trait WriteProperties: Properties {
    /// The values in the order of the declaration, defaults included; without those that are absent.
    fn to_values(&self) -> Vec<(SmolStr, PropertyValue)>;
}

/// No properties.
impl Properties for () {
    const DECLARATION: &'static str = "[]";
    const NAMES: &'static [&'static str] = &[];

    fn from_values(values: &[(SmolStr, PropertyValue)]) -> Result<Self, Failure> {
        read::only_known(values, Self::NAMES)
    }
}
