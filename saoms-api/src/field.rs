use crate::host::cdr::{DecodeError, Reader, Writer};
use crate::host::declaration::ConstText;
use crate::{Cause, Time, Value};

/// A type that a message, a service argument, a reply or an entry of a knowledge can hold. They are those of ROS 2
/// interfaces, so that a message of ROS 2 can be declared field by field:
///
/// | Rust | ROS 2 interfaces |
/// | --- | --- |
/// | `bool`, `i8` to `i64`, `u8` to `u64`, `f32`, `f64` | `bool`, `int8` to `int64`, `uint8` (also `byte`, `char`) to `uint64`, `float32`, `float64` |
/// | `String`, `Vec<T>` | `string`, `T[]` |
/// | `[T; 36]` | `T[36]` |
/// | [`Bounded<String, 10>`](crate::Bounded), [`Bounded<Vec<T>, 10>`](crate::Bounded) | `string<=10`, `T[<=10]` |
/// | `Option<T>` | `T[<=1]` |
/// | [`builtin_interfaces::Time`](crate::builtin_interfaces::Time), [`builtin_interfaces::Duration`](crate::builtin_interfaces::Duration) | the same |
/// | [`Time`] | `uint64`; a program of another machine gets it as a time of its own run |
/// | a struct with `#[derive(Message)]` or `#[derive(Field)]` | a nested message |
/// | an enum without data with `#[derive(Field)]` | its integer, with constants |
///
/// `#[field(pair)]` on a struct of two `i32` makes it a single value ([`Value::Pair`]), as which it stands in a
/// knowledge and in the journal.
///
/// Authors derive it; generated code and hosts call it.
pub trait Field: Sized + 'static {
    /// The type as a fragment of the schema, in JSON with the names of ROS 2 interfaces: `"uint32"`,
    /// `{"sequence":"int32"}`.
    const TYPE: ConstText;
    /// The least number of bytes that a value takes, at least 1. A sequence that claims more elements than the bytes
    /// left can hold is refused before anything is allocated.
    const LEAST_SIZE: usize;
    /// The name of the kind of [`Value`] that represents one, as declarations of entries say it; empty for a type
    /// without.
    const VALUE: &'static str = "";

    /// Appends the value.
    fn write(&self, writer: &mut Writer);

    /// Reads a value.
    ///
    /// # Errors
    /// The bytes hold no such value.
    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError>;

    /// As a single value; `None` where it is none.
    #[inline]
    fn as_value(&self) -> Option<Value> {
        None
    }

    /// The field of a single value; `None` where the value represents none of this type.
    fn of_value(value: Value) -> Option<Self> {
        let _ = value;
        None
    }

    /// Appends the elements of a sequence, after its length.
    fn write_all(values: &[Self], writer: &mut Writer) {
        for value in values {
            value.write(writer);
        }
    }

    /// Reads the elements of an array.
    ///
    /// # Errors
    /// As [`read`](Field::read).
    fn read_array<const COUNT: usize>(reader: &mut Reader<'_>) -> Result<[Self; COUNT], DecodeError> {
        let at = reader.offset();
        // Always as many as were asked for.
        Self::read_all(COUNT, reader)?.try_into().map_err(|_| DecodeError::new("not the elements of the array", at))
    }

    /// Reads the elements of a sequence, after its length.
    ///
    /// # Errors
    /// As [`read`](Field::read).
    fn read_all(count: usize, reader: &mut Reader<'_>) -> Result<Vec<Self>, DecodeError> {
        let mut values = Vec::with_capacity(count);
        for _ in 0..count {
            values.push(Self::read(reader)?);
        }
        Ok(values)
    }
}

macro_rules! numbers {
    ($($type:ty => $name:literal, $value:literal, $as_value:expr, $of_value:pat => $found:expr, $all:expr);* $(;)?) => {
        $(impl Field for $type {
            const TYPE: ConstText = ConstText::Plain(concat!("\"", $name, "\""));
            const LEAST_SIZE: usize = size_of::<$type>();
            const VALUE: &'static str = $value;

            #[inline]
            fn as_value(&self) -> Option<Value> {
                let as_value: fn($type) -> Option<Value> = $as_value;
                as_value(*self)
            }

            #[inline]
            fn of_value(value: Value) -> Option<Self> {
                match value {
                    $of_value => $found,
                    _ => None,
                }
            }

            #[inline]
            fn write(&self, writer: &mut Writer) {
                writer.scalar(self.to_le_bytes());
            }

            #[inline]
            fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
                reader.scalar().map(<$type>::from_le_bytes)
            }

            fn write_all(values: &[Self], writer: &mut Writer) {
                let write_all: fn(&[Self], &mut Writer) = $all;
                write_all(values, writer);
            }

            fn read_all(count: usize, reader: &mut Reader<'_>) -> Result<Vec<Self>, DecodeError> {
                reader.scalars(count, <$type>::from_le_bytes)
            }

            fn read_array<const COUNT: usize>(reader: &mut Reader<'_>) -> Result<[Self; COUNT], DecodeError> {
                reader.array(<$type>::from_le_bytes)
            }
        })*
    };
}

macro_rules! integers {
    ($($type:ty => $name:literal, $all:expr);* $(;)?) => {
        numbers! { $(
            // One that is too large for a single value is none.
            $type => $name, "integer", |number| i64::try_from(number).ok().map(Value::Integer),
                Value::Integer(number) => number.try_into().ok(), $all;
        )* }
    };
}

integers! {
    i8 => "int8", |values, writer| writer.scalars(values, i8::to_le_bytes);
    i16 => "int16", |values, writer| writer.scalars(values, i16::to_le_bytes);
    i32 => "int32", |values, writer| writer.scalars(values, i32::to_le_bytes);
    i64 => "int64", |values, writer| writer.scalars(values, i64::to_le_bytes);
    u8 => "uint8", |values, writer| writer.octets(values);
    u16 => "uint16", |values, writer| writer.scalars(values, u16::to_le_bytes);
    u32 => "uint32", |values, writer| writer.scalars(values, u32::to_le_bytes);
    u64 => "uint64", |values, writer| writer.scalars(values, u64::to_le_bytes);
}

numbers! {
    f32 => "float32", "number", |number| Some(Value::Number(number.into())), Value::Number(number) => Some(number as f32),
        |values, writer| writer.scalars(values, f32::to_le_bytes);
    f64 => "float64", "number", |number| Some(Value::Number(number)), Value::Number(number) => Some(number),
        |values, writer| writer.scalars(values, f64::to_le_bytes);
}

impl Field for bool {
    const TYPE: ConstText = ConstText::Plain("\"bool\"");
    const LEAST_SIZE: usize = 1;
    const VALUE: &'static str = "bool";

    #[inline]
    fn as_value(&self) -> Option<Value> {
        Some(Value::Bool(*self))
    }

    fn of_value(value: Value) -> Option<Self> {
        if let Value::Bool(value) = value { Some(value) } else { None }
    }

    #[inline]
    fn write(&self, writer: &mut Writer) {
        writer.scalar([u8::from(*self)]);
    }

    #[inline]
    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let at = reader.offset();
        match reader.scalar()? {
            [0] => Ok(false),
            [1] => Ok(true),
            [other] => Err(DecodeError::new(format!("found {other}, expected 0 or 1 for a bool"), at)),
        }
    }
}

/// Numbers of their own kind: a time in nanoseconds, and the number of a record in the journal of the run.
macro_rules! numbers_of_a_run {
    ($($type:ty: $name:expr, $number:expr, $made:expr);* $(;)?) => {
        $(impl Field for $type {
            const TYPE: ConstText = $name;
            const LEAST_SIZE: usize = <u64 as Field>::LEAST_SIZE;

            fn write(&self, writer: &mut Writer) {
                let number: fn(&$type) -> u64 = $number;
                number(self).write(writer);
            }

            fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
                u64::read(reader).map($made)
            }
        })*
    };
}

numbers_of_a_run! {
    Time: ConstText::Plain("\"time\""), |time| time.as_nanos(), Time::from_nanos;
    Cause: <u64 as Field>::TYPE, |cause| cause.0, Cause;
}

impl Field for String {
    const TYPE: ConstText = ConstText::Plain("\"string\"");
    const LEAST_SIZE: usize = 4;

    fn write(&self, writer: &mut Writer) {
        writer.string(self);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        reader.string().map(str::to_owned)
    }
}

impl<T: Field> Field for Vec<T> {
    const TYPE: ConstText = ConstText::Joined(&[ConstText::Plain("{\"sequence\":"), T::TYPE, ConstText::Plain("}")]);
    const LEAST_SIZE: usize = 4;

    fn write(&self, writer: &mut Writer) {
        writer.length(self.len());
        T::write_all(self, writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let count = reader.length(T::LEAST_SIZE)?;
        T::read_all(count, reader)
    }
}

impl<T: Field, const COUNT: usize> Field for [T; COUNT] {
    const TYPE: ConstText = ConstText::Joined(&[
        ConstText::Plain("{\"array\":"),
        T::TYPE,
        ConstText::Plain(",\"length\":"),
        ConstText::Number(COUNT),
        ConstText::Plain("}"),
    ]);
    const LEAST_SIZE: usize = {
        assert!(COUNT > 0, "an array in a message has at least one element");
        T::LEAST_SIZE * COUNT
    };

    fn write(&self, writer: &mut Writer) {
        T::write_all(self, writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        T::read_array(reader)
    }
}

/// Encoded as a sequence of at most one element, which is how ROS 2 interfaces say it: `T[<=1]`.
impl<T: Field> Field for Option<T> {
    const TYPE: ConstText = ConstText::Joined(&[ConstText::Plain("{\"optional\":"), T::TYPE, ConstText::Plain("}")]);
    const LEAST_SIZE: usize = 4;
    const VALUE: &'static str = T::VALUE;

    #[inline]
    fn as_value(&self) -> Option<Value> {
        self.as_ref().map_or(Some(Value::Nothing), T::as_value)
    }

    fn of_value(value: Value) -> Option<Self> {
        match value {
            Value::Nothing => Some(None),
            value => T::of_value(value).map(Some),
        }
    }

    fn write(&self, writer: &mut Writer) {
        writer.length(usize::from(self.is_some()));
        if let Some(value) = self {
            value.write(writer);
        }
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let at = reader.offset();
        match reader.length(T::LEAST_SIZE)? {
            0 => Ok(None),
            1 => T::read(reader).map(Some),
            more => Err(DecodeError::new(format!("found {more} values, expected at most one of an option"), at)),
        }
    }
}

/// The reply of an operation that has nothing to say.
impl Field for () {
    const TYPE: ConstText = ConstText::Plain("null");
    const LEAST_SIZE: usize = 1;

    fn write(&self, writer: &mut Writer) {
        writer.scalar([0]);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        reader.scalar::<1>().map(|_| ())
    }
}

/// The arguments of an operation: a tuple of up to six [`Field`]s, encoded one after the other.
pub trait Arguments: Sized + 'static {
    /// Appends the arguments.
    fn write(&self, writer: &mut Writer);

    /// Reads the arguments.
    ///
    /// # Errors
    /// The bytes hold no such arguments.
    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError>;
}

impl Arguments for () {
    fn write(&self, writer: &mut Writer) {
        Field::write(self, writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        Field::read(reader)
    }
}

macro_rules! arguments {
    ($($type:ident $place:tt),*) => {
        impl<$($type: Field),*> Arguments for ($($type,)*) {
            fn write(&self, writer: &mut Writer) {
                $(self.$place.write(writer);)*
            }

            fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
                Ok(($($type::read(reader)?,)*))
            }
        }
    };
}

arguments!(A 0);
arguments!(A 0, B 1);
arguments!(A 0, B 1, C 2);
arguments!(A 0, B 1, C 2, D 3);
arguments!(A 0, B 1, C 2, D 3, E 4);
arguments!(A 0, B 1, C 2, D 3, E 4, F 5);
