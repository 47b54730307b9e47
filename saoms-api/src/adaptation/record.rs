use std::fmt;

/// A value in a [`Record`] or in an entry of a component's knowledge.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// A word that is known when the loop is compiled.
    Word(&'static str),
}

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

from!(bool => Bool, i64 => Integer, i32 => Integer, u32 => Integer, u16 => Integer, u8 => Integer, f64 => Number, &'static str => Word);

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

impl Value {
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

/// A record of a symptom, decision or effect: a text with placeholders, and the values. Constructing one formats and
/// allocates nothing.
///
/// ```
/// use saoms_api::record;
///
/// let battery = 34.0;
/// let record = record!("has {battery} % left and needs {home} executions home", battery, home = 12);
/// assert_eq!(record.to_string(), "has 34 % left and needs 12 executions home");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    text: &'static str,
    /// The names of the values, each with a comma behind it.
    names: &'static str,
    values: [Value; VALUES],
}

impl Record {
    /// For [`record!`](crate::record): a text with `{name}` where a value goes, the names with a comma behind each, and
    /// their values in the same order; values beyond the sixth are left out.
    #[doc(hidden)]
    #[must_use]
    pub const fn new<const N: usize>(text: &'static str, names: &'static str, values: [Value; N]) -> Record {
        let mut all = [Value::Bool(false); VALUES];
        let mut place = 0;
        while place < N && place < VALUES {
            all[place] = values[place];
            place += 1;
        }
        Record { text, names, values: all }
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
    pub fn used(&self) -> &[Value] {
        let count = self.names.bytes().filter(|byte| *byte == b',').count();
        &self.values[..count.min(VALUES)]
    }

    /// The values by name.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, Value)> {
        self.names.split_terminator(',').zip(self.values)
    }
}

impl fmt::Display for Record {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rest = self.text;
        while let Some((before, after)) = rest.split_once('{') {
            formatter.write_str(before)?;
            let Some((name, after)) = after.split_once('}') else { return formatter.write_str(after) };
            match self.values().find(|(known, _)| *known == name) {
                Some((_, value)) => value.fmt(formatter)?,
                None => write!(formatter, "{{{name}}}")?,
            }
            rest = after;
        }
        formatter.write_str(rest)
    }
}

/// Makes a [`Record`]: a text with `{name}` where a value goes, then the values, as `name` or `name = expression`.
#[macro_export]
macro_rules! record {
    ($text:literal $(, $name:ident $(= $value:expr)?)* $(,)?) => {{
        const _: () = ::core::assert!((&[$(stringify!($name)),*] as &[&str]).len() <= 6, "a record holds at most 6 values");
        $crate::Record::new(
            $text,
            concat!($(stringify!($name), ","),*),
            [$($crate::Value::from($crate::record!(@value $name $(= $value)?))),*],
        )
    }};
    (@value $name:ident) => { $name };
    (@value $name:ident = $value:expr) => { $value };
}

/// A value that can be written to the journal: a record itself, or a loop's own symptoms and decisions.
pub trait Recordable {
    /// The record.
    fn record(&self) -> Record;
}

impl Recordable for Record {
    fn record(&self) -> Record {
        *self
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
