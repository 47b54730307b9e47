//! What a record takes as a value.

use saoms_api::{Record, Value, record};

#[test]
fn all_numbers_are_values() {
    let whole: [Value; 11] = [
        7i8.into(),
        7u8.into(),
        7i16.into(),
        7u16.into(),
        7i32.into(),
        7u32.into(),
        7i64.into(),
        7u64.into(),
        7usize.into(),
        7isize.into(),
        7i128.into(),
    ];
    assert_eq!(whole, [Value::Integer(7); 11]);
    assert_eq!(Value::from(u64::MAX), Value::Number(u64::MAX as f64));
    for (float, text) in [(0.1f32, "0.1"), (-12.25, "-12.25"), (1e30, "1000000015047466200000000000000"), (0.0, "0")] {
        assert_eq!(Value::from(float).to_string(), text);
    }
    assert!(matches!(Value::from(f32::NAN), Value::Number(number) if number.is_nan()));
    assert_eq!(Value::from(f32::INFINITY), Value::Number(f64::INFINITY));
}

#[test]
fn all_texts_are_values_and_a_record_is_still_copied() {
    let name = "Robot12".to_owned();
    let answer = "the controller does not answer any more".to_owned();
    let told: Record = record!(
        told: "{name} says: {answer}, {word}, {none}",
        name = &name,
        answer = answer.as_str(),
        word = "stop",
        none = None::<String>
    );
    let copy = told;
    drop((name, answer));
    let text = "Robot12 says: the controller does not answer any more, stop, none";
    assert_eq!((told.to_string(), copy.to_string()), (text.to_owned(), text.to_owned()));
    assert_eq!(Value::from("stop"), Value::Word("stop"), "however a text is held");
    assert!(Value::from("stop").is_same(Value::Word("stop")) && Value::from("stop") != Value::Word("stops"));
    assert_eq!(Value::from(&"x".repeat(100)).as_text(), Some(&*"x".repeat(100)));
}
