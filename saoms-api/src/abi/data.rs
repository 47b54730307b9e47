use std::ffi::c_void;
use std::ptr;
use std::slice;

use crate::{Failure, PropertyValue, Record, SmolStr, Value};

/// What the other side says to be longer than this is refused: no message, text or reply is.
pub const MAX_BYTES: usize = 64 << 20;

/// Bytes that are lent for the time of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bytes {
    /// The first byte; may be null when there are none.
    pub data: *const u8,
    /// How many there are.
    pub length: usize,
}

impl Bytes {
    /// No bytes.
    pub const NONE: Bytes = Bytes { data: ptr::null(), length: 0 };

    /// Lends bytes.
    pub const fn lend(bytes: &[u8]) -> Bytes {
        Bytes { data: bytes.as_ptr(), length: bytes.len() }
    }

    /// Lends text.
    pub const fn text(text: &str) -> Bytes {
        Bytes::lend(text.as_bytes())
    }

    /// The bytes.
    ///
    /// # Errors
    /// There are more than [`MAX_BYTES`].
    ///
    /// # Safety
    /// They are readable for as long as the result is used.
    pub unsafe fn get<'a>(self) -> Result<&'a [u8], Failure> {
        if self.length > MAX_BYTES {
            return Err(Failure::new(format!("found {} bytes, expected at most {MAX_BYTES}", self.length)));
        }
        if self.data.is_null() || self.length == 0 {
            return Ok(&[]);
        }
        // SAFETY: the caller promises that they are readable; the length was checked.
        Ok(unsafe { slice::from_raw_parts(self.data, self.length) })
    }

    /// The bytes as text.
    ///
    /// # Errors
    /// There are too many, or they are not UTF-8.
    ///
    /// # Safety
    /// As [`get`](Bytes::get).
    pub unsafe fn get_text<'a>(self) -> Result<&'a str, Failure> {
        // SAFETY: as the caller promises.
        let bytes = unsafe { self.get() }?;
        std::str::from_utf8(bytes)
            .map_err(|error| Failure::new(format!("found text that is not UTF-8: {error}")))
    }
}

/// A list that is lent for the time of a call.
///
/// # Errors
/// It is longer than [`MAX_BYTES`].
///
/// # Safety
/// It is readable for as long as the result is used.
pub(super) unsafe fn list<'a, T>(first: *const T, count: usize) -> Result<&'a [T], Failure> {
    if count.saturating_mul(size_of::<T>()) > MAX_BYTES {
        return Err(Failure::new(format!("found a list of {count}, which is more than {MAX_BYTES} bytes")));
    }
    if first.is_null() || count == 0 {
        return Ok(&[]);
    }
    // SAFETY: the caller promises that it is readable; the length was checked.
    Ok(unsafe { slice::from_raw_parts(first, count) })
}

/// Where a callee puts text or bytes for its caller. What is put is copied at once; putting again appends.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sink {
    /// What belongs to the caller.
    pub state: *mut c_void,
    /// Appends bytes.
    pub put: unsafe extern "C" fn(state: *mut c_void, bytes: Bytes),
}

/// What a callee put.
#[derive(Debug, Default)]
pub(super) struct Buffer {
    pub(super) bytes: Vec<u8>,
    /// Whether it was more than [`MAX_BYTES`].
    overflowed: bool,
}

impl Buffer {
    /// # Safety
    /// The bytes are readable.
    pub(super) unsafe fn take(&mut self, bytes: Bytes) {
        // SAFETY: as the caller promises.
        match unsafe { bytes.get() } {
            Ok(bytes) if self.bytes.len() + bytes.len() <= MAX_BYTES => self.bytes.extend_from_slice(bytes),
            _ => self.overflowed = true,
        }
    }

    /// All that was put.
    pub(super) fn get(&self) -> Result<&[u8], Failure> {
        if self.overflowed {
            return Err(Failure::new(format!(
                "found more than {MAX_BYTES} bytes, or bytes that cannot be read"
            )));
        }
        Ok(&self.bytes)
    }

    /// Makes it empty; memory for more than this many bytes is given back.
    pub(super) fn reset(&mut self, kept: usize) {
        self.bytes.clear();
        self.bytes.shrink_to(kept);
        self.overflowed = false;
    }
}

impl Sink {
    /// A sink into a buffer, for a callee that is known to put only while it is called.
    pub(super) fn into(buffer: &mut Buffer) -> Sink {
        unsafe extern "C" fn put(state: *mut c_void, bytes: Bytes) {
            // SAFETY: `state` is the buffer of `Sink::into`, which only this call uses; the callee lends the bytes to it.
            unsafe { (*state.cast::<Buffer>()).take(bytes) }
        }
        Sink { state: ptr::from_mut(buffer).cast(), put }
    }

    /// Appends bytes.
    ///
    /// # Safety
    /// The sink's owner still waits for the call that it was given to.
    pub unsafe fn put(self, bytes: &[u8]) {
        // SAFETY: as the caller promises.
        unsafe { (self.put)(self.state, Bytes::lend(bytes)) }
    }
}

/// How a call went. Every value that is not `OK` comes with a text in the call's sink for errors.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status(pub u32);

impl Status {
    /// It is done.
    pub const OK: Status = Status(0);
    /// A failure.
    pub const FAILED: Status = Status(1);
    /// The code of the callee panicked.
    pub const PANICKED: Status = Status(2);
    /// The reference is not wired; the text is its name.
    pub const NOT_WIRED: Status = Status(3);
    /// The provider is in the middle of something; the text is its name.
    pub const BUSY: Status = Status(4);
    /// The provider is not running; the text is its name.
    pub const NOT_RUNNING: Status = Status(5);
    /// The provider knows no such service, operation or arguments.
    pub const MISMATCH: Status = Status(6);
    /// The provider failed; the text is its name, a zero byte, and its words.
    pub const PROVIDER_FAILED: Status = Status(7);
}

/// The value of a property.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PropertyView {
    /// The property's name; empty for one of many values.
    pub name: Bytes,
    /// 0: `text` counts; 1: `children` are its many values; 2: `children` are the properties of a complex one.
    pub kind: u32,
    /// The text.
    pub text: Bytes,
    /// What it consists of.
    pub children: *const PropertyView,
    /// How many those are.
    pub child_count: usize,
}

/// The views of property values. Those below the top are kept alive beside them.
pub(super) struct PropertyViews {
    pub(super) top: Vec<PropertyView>,
    /// Only held: the views above point into it.
    _below: Vec<PropertyViews>,
}

impl PropertyViews {
    pub(super) fn of(values: &[(SmolStr, PropertyValue)]) -> PropertyViews {
        PropertyViews::of_each(&mut values.iter().map(|(name, value)| (name.as_str(), value)))
    }

    fn of_each<'a>(values: &mut dyn Iterator<Item = (&'a str, &'a PropertyValue)>) -> PropertyViews {
        let (mut top, mut below) = (Vec::new(), Vec::new());
        for (name, value) in values {
            let (kind, text, children) = match value {
                PropertyValue::Text(text) => (0, text.as_str(), None),
                PropertyValue::Many(values) => {
                    (1, "", Some(PropertyViews::of_each(&mut values.iter().map(|value| ("", value)))))
                }
                PropertyValue::Complex(values) => (2, "", Some(PropertyViews::of(values))),
            };
            let list = children.as_ref().map_or(&[][..], |children| &children.top);
            top.push(PropertyView {
                name: Bytes::text(name),
                kind,
                text: Bytes::text(text),
                children: list.as_ptr(),
                child_count: list.len(),
            });
            below.extend(children);
        }
        PropertyViews { top, _below: below }
    }
}

impl PropertyView {
    /// The values of a list of views.
    ///
    /// # Errors
    /// A text is no text, or a kind is unknown.
    ///
    /// # Safety
    /// The list, and everything it leads to, is readable.
    pub(super) unsafe fn read(
        list: *const PropertyView,
        count: usize,
    ) -> Result<Vec<(SmolStr, PropertyValue)>, Failure> {
        // SAFETY: as the caller promises.
        let views = unsafe { super::data::list(list, count) }?;
        let mut values = Vec::with_capacity(views.len());
        for view in views {
            // SAFETY: as the caller promises.
            let (name, text, children) = unsafe {
                (
                    view.name.get_text()?,
                    view.text.get_text()?,
                    PropertyView::read(view.children, view.child_count)?,
                )
            };
            let value = match view.kind {
                0 => text.into(),
                1 => PropertyValue::Many(children.into_iter().map(|(_, value)| value).collect()),
                2 => PropertyValue::Complex(children.into()),
                other => {
                    return Err(Failure::new(format!(
                        "found {other} for the kind of a property value, expected 0 to 2"
                    )));
                }
            };
            values.push((name.into(), value));
        }
        Ok(values)
    }
}

/// A message that arrived.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct MessageView {
    /// Its CDR form.
    pub bytes: Bytes,
    /// When it was sent, in nanoseconds of the run.
    pub sent: u64,
    /// The record of the journal that says why; 0 for none.
    pub cause: u64,
    /// Its key, if `has_key` is 1.
    pub key: u64,
    /// The index of its sender.
    pub sender: u32,
    /// 0 or 1.
    pub has_key: u32,
}

/// The messages that arrived for a subscription since the last execution.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Inbox {
    /// The oldest first.
    pub messages: *const MessageView,
    /// How many there are.
    pub count: usize,
}

/// A value of a record or an entry.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ValueView {
    /// 0: false or true (`bits` 0 or 1), 1: a whole number (`bits` as a signed integer), 2: a number (`bits` of its IEEE 754 form),
    /// 3: a pair (the first in the lower 32 bits of `bits`), 4: the `word`, 5: no value.
    pub kind: u32,
    /// The value.
    pub bits: u64,
    /// A word; it has to be part of the library.
    pub word: Bytes,
}

impl ValueView {
    pub(super) fn of(value: Value) -> ValueView {
        let (kind, bits, word) = match value {
            Value::Bool(value) => (0, u64::from(value), Bytes::NONE),
            Value::Integer(value) => (1, value as u64, Bytes::NONE),
            Value::Number(value) => (2, value.to_bits(), Bytes::NONE),
            Value::Pair(x, y) => (3, u64::from(x as u32) | u64::from(y as u32) << 32, Bytes::NONE),
            Value::Word(word) => (4, 0, Bytes::text(word)),
            Value::Nothing => (5, 0, Bytes::NONE),
        };
        ValueView { kind, bits, word }
    }

    /// The value.
    ///
    /// # Errors
    /// It is none.
    ///
    /// # Safety
    /// A word is part of a library that stays loaded.
    pub(super) unsafe fn read(self) -> Result<Value, Failure> {
        Ok(match self.kind {
            0 => Value::Bool(self.bits != 0),
            1 => Value::Integer(self.bits as i64),
            2 => Value::Number(f64::from_bits(self.bits)),
            3 => Value::Pair(self.bits as u32 as i32, (self.bits >> 32) as u32 as i32),
            // SAFETY: as the caller promises.
            4 => Value::Word(unsafe { self.word.get_text() }?),
            5 => Value::Nothing,
            other => {
                return Err(Failure::new(format!("found {other} for the kind of a value, expected 0 to 5")));
            }
        })
    }
}

/// A record of the journal. Text and names have to be part of the library.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RecordView {
    /// The text, with `{name}` where a value goes.
    pub text: Bytes,
    /// The names of the values, each with a comma behind it.
    pub names: Bytes,
    /// The values.
    pub values: *const ValueView,
    /// How many values there are, at most 6.
    pub count: usize,
}

impl RecordView {
    /// # Safety
    /// The view is readable, and its texts are for as long as the program runs.
    pub(super) unsafe fn read(&self) -> Result<Record, Failure> {
        let mut values = [crate::Value::Bool(false); 6];
        if self.count > values.len() {
            return Err(Failure::new(format!(
                "found {} values, expected at most {}",
                self.count,
                values.len()
            )));
        }
        // SAFETY: as the caller promises.
        unsafe {
            for (place, value) in values.iter_mut().enumerate().take(self.count) {
                *value = ValueView::read(*self.values.add(place))?;
            }
            Ok(Record::new(self.text.get_text()?, self.names.get_text()?, values))
        }
    }
}
