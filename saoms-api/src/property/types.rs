use std::time::Duration;

use super::{PropertyField, PropertyShape};
use crate::host::declaration::{Bound, Integer, PropertyKind, Rule, Scalar};
use crate::host::{PropertyValue, SmolStr};

macro_rules! scalars {
    ($($type:ty, $rule:expr, $variant:ident($value:ident) => $result:expr; $own:ident => $written:expr;)*) => {
        $(impl PropertyField for $type {
            const TYPE: PropertyShape = PropertyShape::scalar($rule);

            #[inline]
            fn from_scalar(scalar: &Scalar) -> Option<Result<Self, String>> {
                match scalar {
                    Scalar::$variant($value) => Some($result),
                    _ => None,
                }
            }

            fn to_value(&self) -> Option<PropertyValue> {
                let $own = self;
                Some(Scalar::$variant($written).into())
            }
        })*
    };
}

scalars! {
    bool, Rule::of(PropertyKind::Boolean), Boolean(value) => Ok(*value); own => *own;
    String, Rule::of(PropertyKind::String), Text(value) => Ok(value.to_string()); own => own.into();
    SmolStr, Rule::of(PropertyKind::String), Text(value) => Ok(value.clone()); own => own.clone();
    Duration, Rule::of(PropertyKind::Duration), Duration(value) => Ok(*value); own => *own;
    f64, Rule::of(PropertyKind::Float), Float(value) => Ok(*value); own => *own;
    f32, Rule::of(PropertyKind::Float), Float(value) => match *value as f32 {
        narrow if narrow.is_finite() => Ok(narrow),
        _ => Err(format!("`{value}` is out of range: expected at most {}", f32::MAX)),
    }; own => f64::from(*own);
}

macro_rules! integers {
    ($($type:ty, $min:literal, $max:literal;)*) => {
        scalars! { $(
            $type,
            Rule {
                min: Bound::of_literal(PropertyKind::Integer, $min, None),
                max: Bound::of_literal(PropertyKind::Integer, $max, None),
                ..Rule::of(PropertyKind::Integer)
            },
            Integer(value) => <$type>::try_from(value.get()).map_err(|error| error.to_string());
            own => Integer::from(*own as i128);
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

    fn from_value(value: &PropertyValue, rule: &Rule<'_>) -> Result<Self, String> {
        T::from_value(value, rule).map(Some)
    }

    #[inline]
    fn from_scalar(scalar: &Scalar) -> Option<Result<Self, String>> {
        T::from_scalar(scalar).map(|read| read.map(Some))
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

    fn from_value(value: &PropertyValue, rule: &Rule<'_>) -> Result<Self, String> {
        match value {
            PropertyValue::Many(values) => values.iter().map(|value| T::from_value(value, rule)).collect(),
            one => T::from_value(one, rule).map(|value| vec![value]),
        }
    }

    fn absent() -> Option<Self> {
        Some(Vec::new())
    }

    fn to_value(&self) -> Option<PropertyValue> {
        Some(PropertyValue::Many(self.iter().filter_map(T::to_value).collect()))
    }
}
