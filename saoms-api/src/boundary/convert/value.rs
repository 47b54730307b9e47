use saoms_abi::{Bytes, RecordView, ValueView};

use crate::boundary::null::given;
use crate::{Failure, Record, Value};

/// The view of a value, which it lends its text.
pub(in crate::boundary) fn value_view(value: &Value) -> ValueView {
    let (kind, bits, word) = match value {
        Value::Bool(value) => (0, u64::from(*value), Bytes::NONE),
        Value::Integer(value) => (1, *value as u64, Bytes::NONE),
        Value::Number(value) => (2, value.to_bits(), Bytes::NONE),
        Value::Pair(x, y) => (3, u64::from(*x as u32) | u64::from(*y as u32) << 32, Bytes::NONE),
        Value::Word(word) => (4, 0, Bytes::text(word)),
        Value::Nothing => (5, 0, Bytes::NONE),
        Value::Text(text) => (6, 0, Bytes::text(text.as_str())),
    };
    ValueView { kind, bits, word }
}

/// The value.
///
/// # Errors
/// It is none.
///
/// # Safety
/// A word is part of a library that stays loaded, a text is lent for this call.
pub(in crate::boundary) unsafe fn read_value(view: ValueView) -> Result<Value, Failure> {
    Ok(match view.kind {
        0 => Value::Bool(view.bits != 0),
        1 => Value::Integer(view.bits as i64),
        2 => Value::Number(f64::from_bits(view.bits)),
        3 => Value::Pair(view.bits as u32 as i32, (view.bits >> 32) as u32 as i32),
        // SAFETY: as the caller promises.
        4 => Value::Word(unsafe { view.word.get_text() }?),
        5 => Value::Nothing,
        // SAFETY: as the caller promises.
        6 => Value::from(unsafe { view.word.get_text() }?),
        other => {
            return Err(Failure::new(format!("found {other} for the kind of a value, expected 0 to 6")));
        }
    })
}

/// The record behind a view.
///
/// # Errors
/// It has too many values, or one of them, or a text, cannot be read.
///
/// # Safety
/// The view is readable, and its texts are for as long as the program runs.
pub(in crate::boundary) unsafe fn read_record(view: &RecordView) -> Result<Record, Failure> {
    let mut values = [Value::Bool(false); 6];
    if view.count > values.len() {
        return Err(Failure::new(format!("found {} values, expected at most {}", view.count, values.len())));
    }
    // SAFETY: as the caller promises.
    unsafe {
        if view.count > 0 {
            given(view.values, "the values")?;
        }
        for (place, value) in values.iter_mut().enumerate().take(view.count) {
            *value = read_value(*view.values.add(place))?;
        }
        let text = view.text.get_text()?;
        let id = if view.id.length == 0 { text } else { view.id.get_text()? };
        Ok(Record::new(id, text, view.names.get_text()?, &values[..view.count]))
    }
}
