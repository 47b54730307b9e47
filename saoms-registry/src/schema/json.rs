//! Messages as JSON: a message is an object, a sequence or an array a list, a constant of an enumeration its name, a
//! number that JSON does not have (`NaN`, `inf`, `-inf`) its name, something optional that is not there `null`.

use saoms_api::host::cdr::{DecodeError, Reader, Writer};
use serde_json::{Map, Number as JsonNumber, Value};

use super::read::{Scalar, boolean, bound, constant, option, scalar};
use super::{Number, Schema, SchemaError, Type};

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
    /// The value is no such message: a field is missing, unknown or of another type, or a number is out of its range.
    pub fn encode(&self, value: &Value) -> Result<Vec<u8>, SchemaError> {
        let mut writer = Writer::new();
        write_message(self, value, &mut writer)?;
        Ok(writer.into_bytes())
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

fn write_message(schema: &Schema, value: &Value, writer: &mut Writer) -> Result<(), SchemaError> {
    let Some(object) = value.as_object() else { return Err(wrong(value, "an object")) };
    if let Some(unknown) = object.keys().find(|name| !schema.fields.iter().any(|field| field.name == **name)) {
        let names: Vec<&str> = schema.fields.iter().map(|field| field.name.as_str()).collect();
        return Err(SchemaError(format!(
            "`{}` has no field `{unknown}`; its fields are: {}",
            schema.name,
            names.join(", ")
        )));
    }
    if schema.fields.is_empty() {
        writer.scalar([0]);
    }
    schema.fields.iter().try_for_each(|field| {
        let absent = matches!(field.kind, Type::Optional(_)).then_some(&Value::Null);
        let value = object
            .get(&field.name)
            .or(absent)
            .ok_or_else(|| SchemaError(format!("field `{}` of `{}` is missing", field.name, schema.name)))?;
        write(&field.kind, value, writer)
            .map_err(|SchemaError(error)| SchemaError(format!("field `{}`: {error}", field.name)))
    })
}

fn wrong(value: &Value, expected: &str) -> SchemaError {
    SchemaError(format!("found {value}, expected {expected}"))
}

fn write(kind: &Type, value: &Value, writer: &mut Writer) -> Result<(), SchemaError> {
    match kind {
        Type::Bool => {
            writer.scalar([u8::from(value.as_bool().ok_or_else(|| wrong(value, "true or false"))?)]);
        }
        Type::Number(number) if number.is_float() => {
            let named = || value.as_str()?.parse::<f64>().ok();
            let found = value.as_f64().or_else(named).ok_or_else(|| wrong(value, "a number"))?;
            match number {
                Number::Float32 => writer.scalar((found as f32).to_le_bytes()),
                _ => writer.scalar(found.to_le_bytes()),
            }
        }
        Type::Number(number) => {
            let found = value.as_i64().map(i128::from).or_else(|| value.as_u64().map(i128::from));
            let (least, greatest) = number.bounds();
            let expected = || wrong(value, &format!("a whole number from {least} to {greatest}"));
            write_integer(
                *number,
                found.filter(|found| (least..=greatest).contains(found)).ok_or_else(expected)?,
                writer,
            );
        }
        Type::Time => write(&Type::Number(Number::Uint64), value, writer)?,
        Type::String => writer.string(value.as_str().ok_or_else(|| wrong(value, "a text"))?),
        Type::Enumeration(number, values) => {
            let found = value.as_str().and_then(|name| values.iter().find(|(known, _)| known == name));
            let (_, constant) = found.ok_or_else(|| {
                let names: Vec<&str> = values.iter().map(|(name, _)| name.as_str()).collect();
                wrong(value, &format!("one of {}", names.join(", ")))
            })?;
            write_integer(*number, *constant, writer);
        }
        Type::Message(schema) => write_message(schema, value, writer)?,
        Type::Sequence(element) => {
            let list = value.as_array().ok_or_else(|| wrong(value, "a list"))?;
            writer.length(list.len());
            list.iter().try_for_each(|value| write(element, value, writer))?;
        }
        Type::Array(element, count) => {
            let list = value.as_array().filter(|list| list.len() == *count);
            let list = list.ok_or_else(|| wrong(value, &format!("a list of {count}")))?;
            list.iter().try_for_each(|value| write(element, value, writer))?;
        }
        Type::Bounded(content, most) => {
            let length = value.as_array().map(Vec::len).or_else(|| value.as_str().map(str::len));
            match (length, &**content) {
                (Some(length), Type::Sequence(_)) if length > *most => {
                    return Err(wrong(value, &format!("a list of at most {most}")));
                }
                (Some(length), Type::String) if length > *most => {
                    return Err(wrong(value, &format!("a text of at most {most} bytes")));
                }
                _ => write(content, value, writer)?,
            }
        }
        Type::Optional(_) if value.is_null() => writer.length(0),
        Type::Optional(element) => {
            writer.length(1);
            write(element, value, writer)?;
        }
    }
    Ok(())
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
