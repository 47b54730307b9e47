//! Messages as JSON: a message is an object, a sequence or an array a list, a constant of an enumeration its name, a
//! number that JSON does not have (`NaN`, `inf`, `-inf`) its name, something optional that is not there `null`.

use saoms_api::host::cdr::{DecodeError, Reader, Writer};
use saoms_api::rule::nearest;
use serde_json::{Map, Number as JsonNumber, Value};

use super::json_fault::{At, JsonFaults};
use super::read::{Scalar, boolean, bound, constant, option, scalar};
use super::{Number, Schema, Type};

impl Schema {
    /// The message of these bytes as JSON.
    ///
    /// # Errors
    /// They are none.
    pub fn decode(&self, bytes: &[u8]) -> Result<Value, DecodeError> {
        let mut reader = Reader::new(bytes)?;
        let value = message(self, &mut reader)?;
        reader.finish()?;
        Ok(value)
    }

    /// The bytes of a message that is given as JSON. What is optional may be left out.
    ///
    /// # Errors
    /// The value is no such message: fields are missing, unknown or of another type, or numbers are out of their range.
    /// All faults are told, each with its place in the value.
    pub fn encode(&self, value: &Value) -> Result<Vec<u8>, JsonFaults> {
        let (mut writer, mut faults) = (Writer::new(), JsonFaults::default());
        write_message(self, value, &At::Root, &mut Writing { writer: &mut writer, faults: &mut faults });
        if faults.is_empty() { Ok(writer.into_bytes()) } else { Err(faults) }
    }
}

fn message(schema: &Schema, reader: &mut Reader<'_>) -> Result<Value, DecodeError> {
    if schema.fields.is_empty() {
        reader.scalar::<1>()?;
    }
    let fields = schema.fields.iter().map(|field| Ok((field.name.clone(), read(&field.kind, reader)?)));
    fields.collect::<Result<Map<_, _>, _>>().map(Value::Object)
}

fn read(kind: &Type, reader: &mut Reader<'_>) -> Result<Value, DecodeError> {
    Ok(match kind {
        Type::Bool => boolean(reader)?.into(),
        Type::Number(number) => match scalar(*number, reader)? {
            // All integers are of 64 bits or less.
            Scalar::Integer(value) => i64::try_from(value).map_or_else(|_| (value as u64).into(), Value::from),
            Scalar::Float(value) => JsonNumber::from_f64(value).map_or_else(|| value.to_string().into(), Value::Number),
        },
        Type::Time => read(&Type::Number(Number::Uint64), reader)?,
        Type::String => reader.string()?.into(),
        Type::Enumeration(number, values) => constant(*number, values, reader)?.into(),
        Type::Message(schema) => message(schema, reader)?,
        Type::Sequence(element) => {
            let count = reader.length(element.least_size())?;
            (0..count).map(|_| read(element, reader)).collect::<Result<_, _>>()?
        }
        Type::Array(element, count) => (0..*count).map(|_| read(element, reader)).collect::<Result<_, _>>()?,
        Type::Bounded(content, most) => {
            bound(content, *most, reader)?;
            read(content, reader)?
        }
        Type::Optional(element) => match option(element, reader)? {
            0 => Value::Null,
            _ => read(element, reader)?,
        },
    })
}

/// Bytes that are written, and what is wrong with the value that they come from: with a fault, nobody gets the bytes.
struct Writing<'w> {
    writer: &'w mut Writer,
    faults: &'w mut JsonFaults,
}

impl Writing<'_> {
    /// Writes what a value comes to, or tells what was expected.
    fn scalar<const N: usize>(&mut self, value: &Value, at: &At<'_>, found: Option<[u8; N]>, expected: &str) {
        match found {
            Some(bytes) => self.writer.scalar(bytes),
            None => self.faults.wrong(at, value, expected),
        }
    }
}

fn write_message(schema: &Schema, value: &Value, at: &At<'_>, to: &mut Writing<'_>) {
    let Some(object) = value.as_object() else { return to.faults.wrong(at, value, "an object") };
    let mut meant: Vec<&str> = Vec::new();
    for unknown in object.keys().filter(|name| !schema.fields.iter().any(|field| field.name == **name)) {
        let names = || schema.fields.iter().map(|field| field.name.as_str());
        let absent = || names().filter(|name| !object.contains_key(*name) && !meant.contains(name));
        let known = match nearest(unknown, absent()) {
            Some(near) => {
                meant.push(near);
                format!("did you mean `{near}`?")
            }
            None if schema.fields.is_empty() => "it has none".to_owned(),
            None => format!("its fields are: {}", names().collect::<Vec<_>>().join(", ")),
        };
        to.faults.add(&At::Field(at, unknown), format!("`{}` has no field `{unknown}`; {known}", schema.name));
    }
    if schema.fields.is_empty() {
        to.writer.scalar([0]);
    }
    for field in &schema.fields {
        let here = At::Field(at, &field.name);
        let absent = matches!(field.kind, Type::Optional(_)).then_some(&Value::Null);
        match object.get(&field.name).or(absent) {
            Some(value) => write(&field.kind, value, &here, to),
            // That is one mistake.
            None if meant.contains(&field.name.as_str()) => {}
            None => to.faults.add(&here, format!("field `{}` of `{}` is missing", field.name, schema.name)),
        }
    }
}

fn write_all(element: &Type, list: &[Value], at: &At<'_>, to: &mut Writing<'_>) {
    for (place, value) in list.iter().enumerate() {
        write(element, value, &At::Element(at, place), to);
    }
}

fn write(kind: &Type, value: &Value, at: &At<'_>, to: &mut Writing<'_>) {
    match kind {
        Type::Bool => to.scalar(value, at, value.as_bool().map(|found| [u8::from(found)]), "true or false"),
        Type::Number(number) if number.is_float() => {
            let found = value.as_f64().or_else(|| named(value.as_str()?));
            match number {
                Number::Float32 => {
                    let fits = |found: &f64| !found.is_finite() || (*found as f32).is_finite();
                    let found = found.filter(fits).map(|found| (found as f32).to_le_bytes());
                    to.scalar(value, at, found, "a number of 32 bits");
                }
                _ => to.scalar(value, at, found.map(f64::to_le_bytes), "a number"),
            }
        }
        Type::Number(number) => {
            let found = whole(value);
            let (least, greatest) = number.bounds();
            match found.filter(|found| (least..=greatest).contains(found)) {
                Some(found) => write_integer(*number, found, to.writer),
                None => to.faults.wrong(at, value, &format!("a whole number from {least} to {greatest}")),
            }
        }
        Type::Time => write(&Type::Number(Number::Uint64), value, at, to),
        Type::String => match value.as_str() {
            Some(text) => to.writer.string(text),
            None => to.faults.wrong(at, value, "a text"),
        },
        Type::Enumeration(number, values) => {
            let found = value.as_str().and_then(|name| values.iter().find(|(known, _)| known == name));
            if let Some((_, constant)) = found {
                return write_integer(*number, *constant, to.writer);
            }
            let names = || values.iter().map(|(name, _)| name.as_str());
            let meant = value.as_str().and_then(|name| nearest(name, names()));
            let meant = meant.map(|meant| format!("; did you mean `{meant}`?")).unwrap_or_default();
            to.faults.wrong(at, value, &format!("one of {}{meant}", names().collect::<Vec<_>>().join(", ")));
        }
        Type::Message(schema) => write_message(schema, value, at, to),
        Type::Sequence(element) => match value.as_array() {
            Some(list) => {
                to.writer.length(list.len());
                write_all(element, list, at, to);
            }
            None => to.faults.wrong(at, value, "a list"),
        },
        Type::Array(element, count) => match value.as_array().filter(|list| list.len() == *count) {
            Some(list) => write_all(element, list, at, to),
            None => to.faults.wrong(at, value, &format!("a list of {count}")),
        },
        Type::Bounded(content, most) => {
            let length = value.as_array().map(Vec::len).or_else(|| value.as_str().map(str::len));
            match (length, &**content) {
                (Some(length), Type::Sequence(_)) if length > *most => {
                    to.faults.wrong(at, value, &format!("a list of at most {most}"));
                }
                (Some(length), Type::String) if length > *most => {
                    to.faults.wrong(at, value, &format!("a text of at most {most} bytes"));
                }
                _ => write(content, value, at, to),
            }
        }
        Type::Optional(_) if value.is_null() => to.writer.length(0),
        Type::Optional(element) => {
            to.writer.length(1);
            write(element, value, at, to);
        }
    }
}

/// A number that JSON does not have.
fn named(name: &str) -> Option<f64> {
    match name {
        "NaN" => Some(f64::NAN),
        "inf" => Some(f64::INFINITY),
        "-inf" => Some(f64::NEG_INFINITY),
        _ => None,
    }
}

/// A whole number, however it is written: to JSON, `1.0` is one.
fn whole(value: &Value) -> Option<i128> {
    let exact = value.as_i64().map(i128::from).or_else(|| value.as_u64().map(i128::from));
    exact.or_else(|| value.as_f64().filter(|number| number.fract() == 0.0).map(|number| number as i128))
}

/// Writes an integer within the bounds of its type: the lower bytes of any wider one are its own.
fn write_integer(number: Number, value: i128, writer: &mut Writer) {
    match number.size() {
        1 => writer.scalar((value as i8).to_le_bytes()),
        2 => writer.scalar((value as i16).to_le_bytes()),
        4 => writer.scalar((value as i32).to_le_bytes()),
        _ => writer.scalar((value as i64).to_le_bytes()),
    }
}
