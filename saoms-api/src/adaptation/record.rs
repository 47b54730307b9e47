use std::fmt;

use super::text::{self, ShortText};

/// A value in a [`Record`] or in an entry of a component's knowledge.
///
/// Each number and each text becomes one. A text of more than 22 bytes is kept, once, for as long as the program runs;
/// where such texts are more than 4 MiB together, further ones are cut.
#[derive(Clone, Copy, Debug)]
pub enum Value {
    /// No value: an optional entry that has none.
    Nothing,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Number(f64),
    /// Two whole numbers, such as the column and the row of a block.
    Pair(i32, i32),
    /// A word that is known when the loop is compiled, or a text that is kept.
    Word(&'static str),
    /// A short text. It is the same as a word of the same letters.
    Text(ShortText),
}

const _: () = assert!(size_of::<Value>() == 24, "records are copied on the path of executions");

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Nothing => formatter.write_str("none"),
            Value::Bool(true) => formatter.write_str("yes"),
            Value::Bool(false) => formatter.write_str("no"),
            Value::Integer(value) => value.fmt(formatter),
            Value::Number(value) => value.fmt(formatter),
            Value::Pair(x, y) => write!(formatter, "({x},{y})"),
            Value::Word(word) => formatter.write_str(word),
            Value::Text(text) => formatter.write_str(text.as_str()),
        }
    }
}

macro_rules! from {
    ($($type:ty => $variant:ident),* $(,)?) => {
        $(impl From<$type> for Value {
            fn from(value: $type) -> Value {
                Value::$variant(value.into())
            }
        })*
    };
}

from!(bool => Bool, i64 => Integer, i32 => Integer, i16 => Integer, i8 => Integer, u32 => Integer, u16 => Integer, u8 => Integer, f64 => Number);

/// Numbers that a whole number of 64 bits may not hold: the nearest number then.
macro_rules! from_wide {
    ($($type:ty),*) => {
        $(impl From<$type> for Value {
            fn from(value: $type) -> Value {
                i64::try_from(value).map_or(Value::Number(value as f64), Value::Integer)
            }
        })*
    };
}

from_wide!(u64, usize, isize, u128, i128);

/// The number with the decimals that the value has: 0.1 stays 0.1.
impl From<f32> for Value {
    fn from(value: f32) -> Value {
        let exact = f64::from(value);
        let rounded = (0..=9).map(|decimals| {
            let scale = 10f64.powi(decimals);
            (exact * scale).round() / scale
        });
        Value::Number(rounded.into_iter().find(|rounded| *rounded as f32 == value).unwrap_or(exact))
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Value {
        text::value_of(text)
    }
}

impl From<&String> for Value {
    fn from(text: &String) -> Value {
        text::value_of(text)
    }
}

impl From<String> for Value {
    fn from(text: String) -> Value {
        text::value_of(&text)
    }
}

impl From<(i32, i32)> for Value {
    fn from((x, y): (i32, i32)) -> Value {
        Value::Pair(x, y)
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Value {
        value.map_or(Value::Nothing, Into::into)
    }
}

impl PartialEq for Value {
    fn eq(&self, other: &Value) -> bool {
        match (self, other) {
            (Value::Nothing, Value::Nothing) => true,
            (Value::Bool(one), Value::Bool(other)) => one == other,
            (Value::Integer(one), Value::Integer(other)) => one == other,
            (Value::Number(one), Value::Number(other)) => one == other,
            (Value::Pair(x, y), Value::Pair(other_x, other_y)) => (x, y) == (other_x, other_y),
            (one, other) => one.as_text().is_some_and(|one| Some(one) == other.as_text()),
        }
    }
}

impl Value {
    /// The text, or the word.
    pub fn as_text(&self) -> Option<&str> {
        match self {
            Value::Word(word) => Some(word),
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        }
    }

    /// True if both are the same value: as `==`, but NaN is the same as itself.
    #[must_use]
    pub fn is_same(self, other: Value) -> bool {
        match (self, other) {
            (Value::Number(one), Value::Number(other)) => one.to_bits() == other.to_bits() || one == other,
            (one, other) => one == other,
        }
    }
}

/// Maximum number of values in a record.
const VALUES: usize = 6;

/// A record of a symptom, decision or effect: an id, a text with placeholders, and the values. Constructing one formats
/// and allocates nothing.
///
/// Records are the same where id and values are: the text is for people alone. It can be reworded, and neither the
/// `trace_hash` of a run changes nor what finds records by their id. [`record!`](crate::record) makes one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    id: &'static str,
    text: &'static str,
    /// The names of the values, each with a comma behind it.
    names: &'static str,
    values: [Value; VALUES],
    /// The number of values in use. Counting the names instead took a tenth of the time of a record.
    count: u8,
}

impl Record {
    /// For [`record!`](crate::record): the id, a text with `{name}` where a value goes, the names with a comma behind
    /// each, and their values in the same order; values beyond the sixth are left out.
    #[doc(hidden)]
    #[must_use]
    #[inline]
    pub const fn new(id: &'static str, text: &'static str, names: &'static str, values: &[Value]) -> Record {
        let mut all = [Value::Bool(false); VALUES];
        let mut place = 0;
        while place < values.len() && place < VALUES {
            all[place] = values[place];
            place += 1;
        }
        Record { id, text, names, values: all, count: place as u8 }
    }

    /// The id, which stays when the text is reworded; the text itself where none was given.
    pub const fn id(&self) -> &'static str {
        self.id
    }

    /// The text with its places.
    pub const fn text(&self) -> &'static str {
        self.text
    }

    /// For hosts: the names of the values, with a comma behind each.
    #[doc(hidden)]
    pub const fn names(&self) -> &'static str {
        self.names
    }

    /// For hosts: the values in the order of their names.
    #[doc(hidden)]
    #[inline]
    pub fn used(&self) -> &[Value] {
        // The bound is for the optimizer: `new` counts no more.
        &self.values[..usize::from(self.count).min(VALUES)]
    }

    /// The values by name.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, Value)> {
        self.names.split_terminator(',').zip(self.used().iter().copied())
    }
}

impl fmt::Display for Record {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rest = self.text;
        while let Some((before, after)) = rest.split_once('{') {
            formatter.write_str(before)?;
            let Some((name, after)) = after.split_once('}') else { return formatter.write_str(after) };
            let (name, nouns) = name.split_once(':').map_or((name, None), |(name, nouns)| (name, Some(nouns)));
            match (self.values().find(|(known, _)| *known == name), nouns.and_then(|nouns| nouns.split_once('|'))) {
                (Some((_, value)), None) => value.fmt(formatter)?,
                (Some((_, Value::Integer(1))), Some((one, _))) => formatter.write_str(one)?,
                (Some(_), Some((_, several))) => formatter.write_str(several)?,
                (None, _) => write!(formatter, "{{{name}}}")?,
            }
            rest = after;
        }
        formatter.write_str(rest)
    }
}

/// Makes a [`Record`]: its id, a text with `{name}` where a value goes, then the values, as `name` or
/// `name = expression`.
///
/// Give each record an id, a few words in `snake_case` that say what it is: programs find the record by it, and the
/// `trace_hash` of a run takes it, so that the text can be reworded later. Without one the text is the id. Within a
/// loop an id stands for one text: of two records with the same id and values in one phase, the journal takes the
/// second for a repetition of the first.
///
/// A value is a number, a truth value, a pair of whole numbers, a text, or an `Option` of one of them. The values hold
/// data, no words of the sentence: `{name:one|several}` is the first of the two words where the value
/// is 1, and the second where it is another one.
///
/// ```
/// use saoms_api::record;
///
/// let battery = 34.0;
/// let record = record!(
///     low_battery: "has {battery} % left: {home} {home:execution|executions} home",
///     battery,
///     home = 12
/// );
/// assert_eq!(record.id(), "low_battery");
/// assert_eq!(record.to_string(), "has 34 % left: 12 executions home");
///
/// // Without an id, the text is the id: then it has to stay as it is.
/// assert_eq!(record!("luggage {piece} waits", piece = 3).id(), "luggage {piece} waits");
/// ```
#[macro_export]
macro_rules! record {
    ($id:ident: $text:literal $(, $name:ident $(= $value:expr)?)* $(,)?) => {
        $crate::record!(@new stringify!($id), $text $(, $name $(= $value)?)*)
    };
    ($text:literal $(, $name:ident $(= $value:expr)?)* $(,)?) => {
        $crate::record!(@new $text, $text $(, $name $(= $value)?)*)
    };
    (@new $id:expr, $text:literal $(, $name:ident $(= $value:expr)?)*) => {{
        const _: () = ::core::assert!((&[$(stringify!($name)),*] as &[&str]).len() <= 6, "a record holds at most 6 values");
        $crate::Record::new(
            $id,
            $text,
            concat!($(stringify!($name), ","),*),
            &[$($crate::Value::from($crate::record!(@value $name $(= $value)?))),*],
        )
    }};
    (@value $name:ident) => { $name };
    (@value $name:ident = $value:expr) => { $value };
}

/// A value that can be written to the journal: a record itself, or a loop's own symptoms and decisions.
pub trait Recordable {
    /// The record.
    fn record(&self) -> Record;

    /// The record, made in `place` unless it is there already: a copy costs as much as the rest of an entry.
    #[doc(hidden)]
    #[inline]
    fn lend<'a>(&'a self, place: &'a mut Option<Record>) -> &'a Record {
        place.insert(self.record())
    }
}

impl Recordable for Record {
    fn record(&self) -> Record {
        *self
    }

    #[inline]
    fn lend<'a>(&'a self, _: &'a mut Option<Record>) -> &'a Record {
        self
    }
}

/// The phase of a loop that left a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Finding of the analysis.
    Symptom,
    /// Decision of the planning.
    Decision,
    /// Effect of the execution.
    Effect,
}

impl Phase {
    /// Its name in journals.
    pub fn name(self) -> &'static str {
        match self {
            Phase::Symptom => "symptom",
            Phase::Decision => "decision",
            Phase::Effect => "effect",
        }
    }
}

/// The number of a record in the run's journal, for what follows from it; the default one means no record.
///
/// A message carries the cause that its sender had ([`Header::cause`](crate::Header)); a loop that acts on it says so
/// with [`Context::because`](crate::Context::because). So a chain leads from an act of a robot back to the message that
/// it received, and from there to why another robot said it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Cause(pub u64);
