//! Bytes of a message, looked at without knowing its Rust type.

use saoms_api::host::cdr::{DecodeError, Reader};

use super::{Number, Schema, Type};

/// Reads a message and forgets it.
pub(super) fn skip_message(schema: &Schema, reader: &mut Reader<'_>) -> Result<(), DecodeError> {
    if schema.fields.is_empty() {
        return reader.scalar::<1>().map(drop);
    }
    schema.fields.iter().try_for_each(|field| skip(&field.kind, reader))
}

/// The two numbers of the field at this place, which is a block.
pub(super) fn block(schema: &Schema, place: usize, reader: &mut Reader<'_>) -> Option<(i32, i32)> {
    schema.fields[..place].iter().try_for_each(|field| skip(&field.kind, reader)).ok()?;
    let mut number = || Some(i32::from_le_bytes(reader.scalar().ok()?));
    Some((number()?, number()?))
}

/// The field at this place, which is a key, as a number: a negative one has its place too.
pub(super) fn key(schema: &Schema, place: usize, reader: &mut Reader<'_>) -> Option<u64> {
    schema.fields[..place].iter().try_for_each(|field| skip(&field.kind, reader)).ok()?;
    match &schema.fields[place].kind {
        Type::Bool => boolean(reader).ok().map(u64::from),
        Type::Number(number) | Type::Enumeration(number, _) => match scalar(*number, reader).ok()? {
            Scalar::Integer(key) => Some(key as u64),
            Scalar::Float(_) => None,
        },
        _ => None,
    }
}

pub(super) fn skip(kind: &Type, reader: &mut Reader<'_>) -> Result<(), DecodeError> {
    match kind {
        Type::Bool => boolean(reader).map(drop),
        Type::Number(number) => scalar(*number, reader).map(drop),
        Type::Time => scalar(Number::Uint64, reader).map(drop),
        Type::String => reader.string().map(drop),
        Type::Enumeration(number, values) => constant(*number, values, reader).map(drop),
        Type::Message(schema) => skip_message(schema, reader),
        Type::Sequence(element) => {
            let count = reader.length(element.least_size())?;
            skip_all(element, count, reader)
        }
        Type::Array(element, count) => skip_all(element, *count, reader),
        Type::Bounded(content, most) => {
            bound(content, *most, reader)?;
            skip(content, reader)
        }
        Type::Optional(element) => (0..option(element, reader)?).try_for_each(|_| skip(element, reader)),
    }
}

/// Elements that stand side by side.
fn skip_all(element: &Type, count: usize, reader: &mut Reader<'_>) -> Result<(), DecodeError> {
    match *element {
        // Any bits are a number: nothing to look at one by one.
        Type::Number(number) if number.size() == 8 => reader.scalars::<8, ()>(count, |_| ()).map(drop),
        Type::Number(number) if number.size() == 4 => reader.scalars::<4, ()>(count, |_| ()).map(drop),
        Type::Number(number) if number.size() == 2 => reader.scalars::<2, ()>(count, |_| ()).map(drop),
        Type::Number(_) => reader.scalars::<1, ()>(count, |_| ()).map(drop),
        _ => (0..count).try_for_each(|_| skip(element, reader)),
    }
}

/// Looks at the length of the string or sequence that comes next.
pub(super) fn bound(content: &Type, most: usize, reader: &Reader<'_>) -> Result<(), DecodeError> {
    let (at, mut ahead) = (reader.offset(), reader.clone());
    let length = match content {
        Type::Sequence(element) => ahead.length(element.least_size())?,
        _ => ahead.string()?.len(),
    };
    match length <= most {
        true => Ok(()),
        false => Err(DecodeError::new(format!("found a length of {length}, expected at most {most}"), at)),
    }
}

/// Reads whether something optional is there: 0 or 1.
pub(super) fn option(element: &Type, reader: &mut Reader<'_>) -> Result<usize, DecodeError> {
    let at = reader.offset();
    match reader.length(element.least_size())? {
        count @ 0..=1 => Ok(count),
        more => Err(DecodeError::new(format!("found {more} values, expected at most one of an option"), at)),
    }
}

pub(super) fn boolean(reader: &mut Reader<'_>) -> Result<bool, DecodeError> {
    let at = reader.offset();
    match reader.scalar()? {
        [0] => Ok(false),
        [1] => Ok(true),
        [other] => Err(DecodeError::new(format!("found {other}, expected 0 or 1 for a bool"), at)),
    }
}

/// A number as it was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
    Integer(i128),
    Float(f64),
}

pub(super) fn scalar(number: Number, reader: &mut Reader<'_>) -> Result<Scalar, DecodeError> {
    Ok(match number {
        Number::Int8 => Scalar::Integer(i8::from_le_bytes(reader.scalar()?).into()),
        Number::Int16 => Scalar::Integer(i16::from_le_bytes(reader.scalar()?).into()),
        Number::Int32 => Scalar::Integer(i32::from_le_bytes(reader.scalar()?).into()),
        Number::Int64 => Scalar::Integer(i64::from_le_bytes(reader.scalar()?).into()),
        Number::Uint8 => Scalar::Integer(u8::from_le_bytes(reader.scalar()?).into()),
        Number::Uint16 => Scalar::Integer(u16::from_le_bytes(reader.scalar()?).into()),
        Number::Uint32 => Scalar::Integer(u32::from_le_bytes(reader.scalar()?).into()),
        Number::Uint64 => Scalar::Integer(u64::from_le_bytes(reader.scalar()?).into()),
        Number::Float32 => Scalar::Float(f32::from_le_bytes(reader.scalar()?).into()),
        Number::Float64 => Scalar::Float(f64::from_le_bytes(reader.scalar()?)),
    })
}

/// The name of a constant of an enumeration.
pub(super) fn constant<'a>(
    number: Number,
    values: &'a [(String, i128)],
    reader: &mut Reader<'_>,
) -> Result<&'a str, DecodeError> {
    let at = reader.offset();
    let found = scalar(number, reader)?;
    let known = values.iter().find(|(_, value)| found == Scalar::Integer(*value));
    known.map(|(name, _)| name.as_str()).ok_or_else(|| {
        let Scalar::Integer(found) = found else { return DecodeError::new("expected an integer", at) };
        DecodeError::new(format!("found {found}, which is not a constant of the enumeration"), at)
    })
}
