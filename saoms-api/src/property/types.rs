use std::time::Duration;

use super::{PropertyField, PropertyShape};
use crate::host::declaration::{PropertyKind, Rule, Scalar};
use crate::host::{PropertyValue, SmolStr, format_duration};

/// Reads a scalar through its rule.
fn scalar(value: &PropertyValue, rule: &Rule<'_>) -> Result<Scalar, String> {
    let found = match value {
        PropertyValue::Text(text) => return rule.check(text),
        PropertyValue::Many(_) => "a list",
        PropertyValue::Complex(_) => "a complex value",
    };
    Err(format!("found {found}: expected {}", rule.expected()))
}

macro_rules! scalars {
    ($($type:ty, $rule:expr, $variant:ident($value:ident) => $result:expr $(, $text:ident => $from_text:expr)?
        ; $own:ident => $written:expr;)*) => {
        $(impl PropertyField for $type {
            const TYPE: PropertyShape = PropertyShape::scalar($rule);

            fn from_value(value: &PropertyValue) -> Result<Self, String> {
                const RULE: Rule<'static> = <$type as PropertyField>::TYPE.rule;
                let read = Self::from_scalar(scalar(value, &RULE)?);
                read.unwrap_or_else(|| Err(format!("expected {}", RULE.expected())))
            }

            #[inline]
            fn from_scalar(scalar: Scalar) -> Option<Result<Self, String>> {
                match scalar {
                    Scalar::$variant($value) => Some($result),
                    _ => None,
                }
            }

            $(#[inline]
            fn from_text($text: &SmolStr) -> Option<Self> {
                Some($from_text)
            })?

            fn to_value(&self) -> Option<PropertyValue> {
                let $own = self;
                Some(PropertyValue::Text($written.into()))
            }
        })*
    };
}

scalars! {
    bool, Rule::of(PropertyKind::Boolean), Boolean(value) => Ok(value); own => own.to_string();
    String, Rule::of(PropertyKind::String), Text(value) => Ok(value), text => text.to_string(); own => own.as_str();
    SmolStr, Rule::of(PropertyKind::String), Text(value) => Ok(value.into()), text => text.clone(); own => own.as_str();
    Duration, Rule::of(PropertyKind::Duration), Duration(value) => Ok(value); own => format_duration(*own);
    f64, Rule::of(PropertyKind::Float), Float(value) => Ok(value); own => own.to_string();
    f32, Rule::of(PropertyKind::Float), Float(value) => match value as f32 {
        narrow if narrow.is_finite() => Ok(narrow),
        _ => Err(format!("`{value}` is out of range: expected at most {}", f32::MAX)),
    }; own => own.to_string();
}

macro_rules! integers {
    ($($type:ty, $min:literal, $max:literal;)*) => {
        scalars! { $(
            $type, Rule { min: Some($min), max: Some($max), ..Rule::of(PropertyKind::Integer) },
                Integer(value) => <$type>::try_from(value).map_err(|error| error.to_string()); own => own.to_string();
        )* }
    };
}

integers! {
    i8, "-128", "127";
    i16, "-32768", "32767";
    i32, "-2147483648", "2147483647";
    i64, "-9223372036854775808", "9223372036854775807";
    u8, "0", "255";
    u16, "0", "65535";
    u32, "0", "4294967295";
    u64, "0", "18446744073709551615";
    usize, "0", "18446744073709551615";
}

impl<T: PropertyField> PropertyField for Option<T> {
    const TYPE: PropertyShape = PropertyShape { optional: true, ..T::TYPE };

    fn from_value(value: &PropertyValue) -> Result<Self, String> {
        T::from_value(value).map(Some)
    }

    #[inline]
    fn from_scalar(scalar: Scalar) -> Option<Result<Self, String>> {
        T::from_scalar(scalar).map(|read| read.map(Some))
    }

    #[inline]
    fn from_text(text: &SmolStr) -> Option<Self> {
        T::from_text(text).map(Some)
    }

    fn from_choice(text: &str) -> Option<Self> {
        T::from_choice(text).map(Some)
    }

    fn absent() -> Option<Self> {
        Some(None)
    }

    fn to_value(&self) -> Option<PropertyValue> {
        self.as_ref()?.to_value()
    }
}

impl<T: PropertyField> PropertyField for Vec<T> {
    const TYPE: PropertyShape = PropertyShape { many: true, optional: true, ..T::TYPE };

    fn from_value(value: &PropertyValue) -> Result<Self, String> {
        match value {
            PropertyValue::Many(values) => values.iter().map(T::from_value).collect(),
            one => T::from_value(one).map(|value| vec![value]),
        }
    }

    fn absent() -> Option<Self> {
        Some(Vec::new())
    }

    fn to_value(&self) -> Option<PropertyValue> {
        Some(PropertyValue::Many(self.iter().filter_map(T::to_value).collect()))
    }
}
