use std::time::Duration;

use super::shape::default_fits;
use super::*;
use crate::host::declaration::{Bound, PropertyKind, Rule, Scalar};

/// Reads a value through the rule of its type.
fn read<T: PropertyField>(value: impl Into<PropertyValue>) -> Result<T, String> {
    T::from_value(&value.into(), &T::TYPE.rule)
}

#[test]
fn each_type_reads_its_text_and_no_other() {
    let cases = [
        (PropertyKind::Boolean, " true ", Ok(Scalar::Boolean(true))),
        (PropertyKind::Boolean, "TRUE", Err("`TRUE` is not a boolean: expected `true` or `false`")),
        (PropertyKind::Integer, "+7", Ok(Scalar::Integer(7.into()))),
        (PropertyKind::Integer, "7.0", Err("`7.0` is not a whole number: expected a whole number")),
        (PropertyKind::Integer, "-", Err("`-` is not a whole number: expected a whole number")),
        (PropertyKind::Float, "-1e3", Ok(Scalar::Float(-1000.0))),
        (PropertyKind::Float, "1e999", Err("`1e999` is out of range: expected a number")),
        (PropertyKind::Float, "inf", Err("`inf` is not a number: expected a number")),
        (PropertyKind::Float, "", Err("the value is empty: expected a number")),
        (PropertyKind::String, " as it is ", Ok(Scalar::Text(" as it is ".into()))),
        (PropertyKind::String, "", Ok(Scalar::Text("".into()))),
        (PropertyKind::Duration, "2 s", Ok(Scalar::Duration(Duration::from_secs(2)))),
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
    let bound = |text| Bound::read(PropertyKind::Integer, text);
    let cases = [
        (Rule { min: bound("1"), ..integer }, "0", "1", ", at least 1"),
        (Rule { max: bound("5"), ..integer }, "6", "5", ", at most 5"),
        (Rule { exclusive_max: bound("5"), ..integer }, "5", "4", ", below 5"),
        (Rule { min: bound("1"), exclusive_max: bound("5"), ..integer }, "5", "4", " from 1 to below 5"),
        (Rule { min: bound("-2"), max: bound("5"), unit: Some("m"), ..integer }, "-3", "-2", " from -2 to 5 [m]"),
    ];
    for (rule, outside, inside, expected) in cases {
        assert!(rule.check(inside).is_ok());
        let message = format!("`{outside}` is out of range: expected a whole number{expected}");
        assert_eq!(rule.check(outside), Err(message));
    }
}

#[test]
fn the_bounds_of_integers_are_those_of_their_types() {
    fn bounds<T: PropertyField>() -> [Option<&'static str>; 2] {
        [T::TYPE.rule.min, T::TYPE.rule.max].map(|bound| bound.map(|bound| bound.text()))
    }
    macro_rules! same {
        ($($type:ty)*) => { $(
            let (min, max) = (<$type>::MIN.to_string(), <$type>::MAX.to_string());
            assert_eq!(bounds::<$type>(), [Some(min.as_str()), Some(max.as_str())]);
            assert_eq!((read(&*min), read(&*max)), (Ok(<$type>::MIN), Ok(<$type>::MAX)));
        )* };
    }
    same!(i8 i16 i32 i64 u8 u16 u32 u64 usize);
    assert_eq!(read::<u8>("256").unwrap_err(), "`256` is out of range: expected a whole number from 0 to 255");
    assert!(read::<f32>("1e39").is_err());
}

#[test]
fn many_takes_any_number_of_values() {
    assert_eq!(Vec::<u8>::absent(), Some(Vec::new()));
    assert_eq!(read("3"), Ok(vec![3]));
    assert_eq!(read(PropertyValue::Many([].into())), Ok(Vec::<u8>::new()));
    assert!(read::<u8>(PropertyValue::Many(["3".into()].into())).is_err());
    assert!(read::<u8>(PropertyValue::Complex([].into())).is_err());
}

#[test]
fn a_value_that_was_read_is_taken_as_it_is() {
    let value = |scalar: Scalar| PropertyValue::from(scalar);
    assert_eq!(read(Scalar::Boolean(true)), Ok(true));
    assert_eq!(read(Scalar::Integer(u64::MAX.into())), Ok(u64::MAX));
    assert_eq!(read(Scalar::Float(-0.5)), Ok(-0.5));
    assert_eq!(read(Scalar::Duration(Duration::MAX)), Ok(Duration::MAX), "longer than any text says");
    assert_eq!(read(Scalar::Text(" as it is ".into())), Ok(SmolStr::new(" as it is ")));
    let both = PropertyValue::Many([value(Scalar::Integer(1.into())), "2".into()].into());
    assert_eq!(read(both), Ok(vec![1, 2]));
    // Bounds hold for it, too.
    assert_eq!(
        read::<u8>(Scalar::Integer(256.into())).unwrap_err(),
        "`256` is out of range: expected a whole number from 0 to 255"
    );
    // A value of another type is what it would be in a file.
    assert_eq!(read(Scalar::Integer(250.into())), Ok(Duration::from_millis(250)));
    assert_eq!(read(Scalar::Integer(2.into())), Ok(2.0));
    assert_eq!(read(Scalar::Duration(Duration::from_millis(1500))), Ok("1500ms".to_owned()));
    assert!(read::<bool>(Scalar::Integer(7.into())).is_err());
}

#[test]
fn the_usual_text_of_a_value_is_read_as_this_value() {
    let cases = [
        (PropertyKind::Boolean, "0", "false"),
        (PropertyKind::Integer, "+007", "7"),
        (PropertyKind::Integer, "-9223372036854775808", "-9223372036854775808"),
        (PropertyKind::Integer, "170141183460469231731687303715884105727", "170141183460469231731687303715884105727"),
        (PropertyKind::Float, " 1e3 ", "1000"),
        (PropertyKind::Float, "0.10", "0.1"),
        (PropertyKind::Duration, "1000", "1s"),
        (PropertyKind::Duration, "0.5 ms", "500us"),
        (PropertyKind::String, " a ", " a "),
        (PropertyKind::Enumeration, " a ", "a"),
    ];
    for (kind, text, usual) in cases {
        let value = Rule::of(kind).check(text).unwrap();
        assert_eq!(value.text(), usual);
        assert_eq!(Rule::of(kind).check(usual), Ok(value), "{text}");
    }
}

#[test]
fn defaults_and_bounds_are_checked_while_compiling() {
    const fn bound(kind: PropertyKind, text: &str) -> Option<Bound<'_>> {
        Bound::of_literal(kind, text, None)
    }
    let duration = |text| bound(PropertyKind::Duration, text);
    let wait = Rule { min: duration("1ms"), exclusive_max: duration("1h"), ..Rule::of(PropertyKind::Duration) };
    let choice = Rule { allowed: &["use", "drop"], ..Rule::of(PropertyKind::Enumeration) };
    let text = Rule::of(PropertyKind::String);
    let below = |text| Rule { exclusive_max: bound(PropertyKind::Integer, text), ..Rule::of(PropertyKind::Integer) };
    let cases = [
        (wait, "1ms", true),
        (wait, "999us", false),
        (wait, "59.9 min", true),
        (wait, "60min", false),
        (wait, "soon", false),
        (Rule { max: duration("5"), ..wait }, "6", false),
        (choice, "drop", true),
        (choice, "dropp", false),
        (choice, "dro", false),
        (text, "anything", true),
        (u8::TYPE.rule, "255", true),
        (u8::TYPE.rule, "256", false),
        (u8::TYPE.rule, "-1", false),
        (Option::<i64>::TYPE.rule, "-1", true),
        (below("9"), "9", false),
        (below("9"), "8", true),
        (Rule::of(PropertyKind::Integer), "1.0", false),
        (Rule::of(PropertyKind::Float), "-1.5", true),
        (Rule::of(PropertyKind::Float), "wide", false),
        (Rule::of(PropertyKind::Boolean), "true", true),
        (Rule::of(PropertyKind::Boolean), "5", false),
        (Rule::of(PropertyKind::Complex), "anything", false),
    ];
    for (rule, default, fits) in cases {
        let literal = Scalar::of_literal(rule.kind, default, default.parse().ok());
        assert_eq!(default_fits(&rule, default, &literal), fits, "{default}");
    }
    assert_eq!(duration("1h").map(|bound| bound.text()), Some("1h"));
    assert_eq!([duration("soon"), duration("1 parsec"), bound(PropertyKind::String, "1")], [None; 3]);
    assert_eq!(Bound::of_literal(PropertyKind::Float, "0.5", Some(0.5)), Bound::read(PropertyKind::Float, "0.5"));
}
