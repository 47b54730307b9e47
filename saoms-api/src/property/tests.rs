use super::shape::{bounds_fit, default_fits};
use super::*;
use crate::host::declaration::{PropertyKind, Rule, Scalar};

#[test]
fn each_type_reads_its_text_and_no_other() {
    let cases = [
        (PropertyKind::Boolean, " true ", Ok(Scalar::Boolean(true))),
        (PropertyKind::Boolean, "TRUE", Err("`TRUE` is not a boolean: expected `true` or `false`")),
        (PropertyKind::Integer, "+7", Ok(Scalar::Integer(7))),
        (PropertyKind::Integer, "7.0", Err("`7.0` is not a whole number: expected a whole number")),
        (PropertyKind::Integer, "-", Err("`-` is not a whole number: expected a whole number")),
        (PropertyKind::Float, "-1e3", Ok(Scalar::Float(-1000.0))),
        (PropertyKind::Float, "1e999", Err("`1e999` is out of range: expected a number")),
        (PropertyKind::Float, "inf", Err("`inf` is not a number: expected a number")),
        (PropertyKind::Float, "", Err("the value is empty: expected a number")),
        (PropertyKind::String, " as it is ", Ok(Scalar::Text(" as it is ".to_owned()))),
        (PropertyKind::String, "", Ok(Scalar::Text(String::new()))),
        (PropertyKind::Duration, "2 s", Ok(Scalar::Duration(std::time::Duration::from_secs(2)))),
        (
            PropertyKind::Duration,
            "-2 s",
            Err("`-2 s` is negative: expected a duration (in ms, or with a unit: ns, us, ms, s, min, h)"),
        ),
        (PropertyKind::Complex, "x", Err("`x` is a single value: expected properties of its own")),
    ];
    for (kind, text, expected) in cases {
        assert_eq!(Rule::of(kind).check(text), expected.map_err(str::to_owned), "{text}");
        assert_eq!(PropertyKind::from_name(kind.name()), Some(kind));
    }
}

#[test]
fn bounds_are_part_of_the_message() {
    let integer = Rule::of(PropertyKind::Integer);
    let cases = [
        (Rule { min: Some("1"), ..integer }, "0", "1", ", at least 1"),
        (Rule { max: Some("5"), ..integer }, "6", "5", ", at most 5"),
        (Rule { exclusive_max: Some("5"), ..integer }, "5", "4", ", below 5"),
        (Rule { min: Some("1"), exclusive_max: Some("5"), ..integer }, "5", "4", " from 1 to below 5"),
        (Rule { min: Some("-2"), max: Some("5"), unit: Some("m"), ..integer }, "-3", "-2", " from -2 to 5 [m]"),
    ];
    for (rule, outside, inside, expected) in cases {
        assert!(rule.check(inside).is_ok());
        let message = format!("`{outside}` is out of range: expected a whole number{expected}");
        assert_eq!(rule.check(outside), Err(message));
    }
}

#[test]
fn the_bounds_of_integers_are_those_of_their_types() {
    fn bounds<T: PropertyField>() -> (Option<&'static str>, Option<&'static str>) {
        (T::TYPE.rule.min, T::TYPE.rule.max)
    }
    macro_rules! same {
        ($($type:ty)*) => { $(
            let (min, max) = (<$type>::MIN.to_string(), <$type>::MAX.to_string());
            assert_eq!(bounds::<$type>(), (Some(min.as_str()), Some(max.as_str())));
        )* };
    }
    same!(i8 i16 i32 i64 u8 u16 u32 u64 usize);
    assert_eq!(u8::from_value(&"255".into()), Ok(255));
    assert_eq!(
        u8::from_value(&"256".into()).unwrap_err(),
        "`256` is out of range: expected a whole number from 0 to 255"
    );
    assert!(f32::from_value(&"1e39".into()).is_err());
}

#[test]
fn many_takes_any_number_of_values() {
    assert_eq!(Vec::<u8>::absent(), Some(Vec::new()));
    assert_eq!(Vec::<u8>::from_value(&"3".into()), Ok(vec![3]));
    assert_eq!(Vec::<u8>::from_value(&PropertyValue::Many([].into())), Ok(Vec::new()));
    assert!(u8::from_value(&PropertyValue::Many(["3".into()].into())).is_err());
    assert!(u8::from_value(&PropertyValue::Complex([].into())).is_err());
}

#[test]
fn defaults_and_bounds_are_checked_while_compiling() {
    let wait = Rule { min: Some("1ms"), exclusive_max: Some("1h"), ..Rule::of(PropertyKind::Duration) };
    let choice = Rule { allowed: &["use", "drop"], ..Rule::of(PropertyKind::Enumeration) };
    let text = Rule::of(PropertyKind::String);
    let cases = [
        (wait, "1ms", true),
        (wait, "999us", false),
        (wait, "59.9 min", true),
        (wait, "60min", false),
        (wait, "soon", false),
        (Rule { max: Some("5"), ..wait }, "6", false),
        (choice, "drop", true),
        (choice, "dropp", false),
        (choice, "dro", false),
        (text, "anything", true),
        (u8::TYPE.rule, "255", true),
        (u8::TYPE.rule, "256", false),
        (u8::TYPE.rule, "-1", false),
        (Option::<i64>::TYPE.rule, "-1", true),
        (Rule { exclusive_max: Some("9"), ..Rule::of(PropertyKind::Integer) }, "9", false),
        (Rule::of(PropertyKind::Integer), "1.0", false),
        (Rule::of(PropertyKind::Float), "-1.5", true),
        (Rule::of(PropertyKind::Float), "wide", false),
        (Rule::of(PropertyKind::Boolean), "true", true),
        (Rule::of(PropertyKind::Boolean), "5", false),
        (Rule::of(PropertyKind::Complex), "anything", false),
    ];
    for (rule, default, fits) in cases {
        assert_eq!(default_fits(&rule, default), fits, "{default}");
    }
    assert!(bounds_fit(&wait) && bounds_fit(&text));
    assert!(!bounds_fit(&Rule { min: Some("soon"), ..wait }));
    assert!(!bounds_fit(&Rule { exclusive_max: Some("1 parsec"), ..wait }));
    assert!(!bounds_fit(&Rule { min: Some("1"), ..text }));
}
