use std::fmt;

use super::{PropertyField, PropertyShape};
use crate::host::declaration::{ConstText, PropertyKind, Rule, Scalar};
use crate::host::{PropertyValue, SmolStr};

/// The name of the environment variable that stands for a secret where it is written.
const USUAL_VARIABLE: &str = "SAOMS_PASSWORD";

/// A secret, such as a password: a text, or `$NAME` for the environment variable `NAME`.
///
/// Nothing prints it. Where the value of a property of this type is written, as by `saoms expand`, it is the variable
/// that it came from, or else `$SAOMS_PASSWORD`.
///
/// ```
/// use saoms_api::Secret;
///
/// let secret = Secret::new("opensesame");
/// assert_eq!(secret.resolve(|_| None).unwrap(), "opensesame");
/// assert_eq!((format!("{secret:?}"), secret.shown()), ("Secret(..)".to_owned(), "$SAOMS_PASSWORD".into()));
///
/// let secret = Secret::new("$HALL_PASSWORD");
/// assert_eq!(secret.resolve(|name| (name == "HALL_PASSWORD").then(|| "sesame".to_owned())).unwrap(), "sesame");
/// assert_eq!(secret.resolve(|_| None), Err("HALL_PASSWORD"));
/// assert_eq!(secret.shown(), "$HALL_PASSWORD");
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct Secret {
    /// The text, and the variable that it came from. Boxed, since few components have one.
    parts: Box<(SmolStr, Option<SmolStr>)>,
}

impl Secret {
    /// A secret, as a composite gives it.
    pub fn new(text: impl Into<SmolStr>) -> Secret {
        Secret { parts: Box::new((text.into(), None)) }
    }

    /// The same secret, which came from an environment variable.
    #[must_use]
    pub fn from_variable(mut self, name: impl Into<SmolStr>) -> Secret {
        self.parts.1 = Some(name.into());
        self
    }

    /// The secret itself, with `get` for the values of environment variables.
    ///
    /// # Errors
    /// `get` has no value for the variable: its name.
    pub fn resolve(&self, get: impl FnOnce(&str) -> Option<String>) -> Result<String, &str> {
        match self.variable() {
            Some(name) => get(name).ok_or(name),
            None => Ok(self.parts.0.to_string()),
        }
    }

    /// True if it names an environment variable, and so gives nothing away.
    pub fn is_variable(&self) -> bool {
        self.variable().is_some()
    }

    /// What is written in its place.
    pub fn shown(&self) -> SmolStr {
        let name = self.variable().or(self.parts.1.as_deref()).unwrap_or(USUAL_VARIABLE);
        format!("${name}").into()
    }

    /// The name of the environment variable that the text names.
    fn variable(&self) -> Option<&str> {
        let name = self.parts.0.strip_prefix('$')?;
        let is_name = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
        (is_name && name.starts_with(|first: char| !first.is_ascii_digit())).then_some(name)
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("Secret(..)")
    }
}

impl PropertyField for Secret {
    const TYPE: PropertyShape =
        PropertyShape::scalar(Rule::of(PropertyKind::String)).with_details(ConstText::Plain(",\"secret\":true"));

    fn from_scalar(scalar: &Scalar) -> Option<Result<Self, String>> {
        match scalar {
            Scalar::Text(text) => Some(Ok(Secret::new(text.clone()))),
            _ => None,
        }
    }

    fn to_value(&self) -> Option<PropertyValue> {
        Some(Scalar::Text(self.shown()).into())
    }
}
