use crate::Bytes;

/// The value of a property.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct PropertyView {
    /// The property's name; empty for one of many values.
    pub name: Bytes,
    /// 0: `text` counts; 1: `children` are its many values; 2: `children` are the properties of a complex one.
    pub kind: u32,
    /// The text; of a boolean, a number or a duration the usual one, as `true`, `7`, `0.5` and `1500ms`.
    pub text: Bytes,
    /// The values that it consists of.
    pub children: *const PropertyView,
    /// Their number.
    pub child_count: usize,
}

/// A value of a record or an entry.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ValueView {
    /// 0: false or true (`bits` 0 or 1), 1: a whole number (`bits` as a signed integer), 2: a number
    /// (`bits` of its IEEE 754 form), 3: a pair (the first in the lower 32 bits of `bits`), 4: the `word`, 5: no value,
    /// 6: a text in `word`.
    pub kind: u32,
    /// The value.
    pub bits: u64,
    /// A word, which has to be part of the library; or a text, which is copied within the call.
    pub word: Bytes,
}

/// A record of the journal. Id, text and names have to be part of the library.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RecordView {
    /// What the record is found by, in `snake_case`: it stays when the text is reworded. Empty: the text is the id.
    pub id: Bytes,
    /// The text, with `{name}` where a value goes, and `{name:one|several}` where a word depends on its being 1.
    pub text: Bytes,
    /// The names of the values, each with a comma behind it.
    pub names: Bytes,
    /// The values.
    pub values: *const ValueView,
    /// The number of the values, at most 6.
    pub count: usize,
}

/// A value for the run's report.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct ReportView {
    /// Its name within `children` of kind 6.
    pub name: Bytes,
    /// 0: null, 1: false or true (`bits`), 2: a whole number (`bits`), 3: a number (`bits` of its IEEE
    /// 754 form), 4: the `text`, 5: the list of `children`, 6: the named `children`.
    pub kind: u32,
    /// A number.
    pub bits: u64,
    /// A text.
    pub text: Bytes,
    /// The values that it consists of.
    pub children: *const ReportView,
    /// Their number.
    pub child_count: usize,
}
