//! Times of a run in messages: each program counts from the start of its own run.

use saoms_api::host::cdr::{DecodeError, Reader};

use super::read::{option, skip};
use super::{Schema, Type};

impl Schema {
    /// True if messages have times of a run, in nested messages, too.
    pub fn has_times(&self) -> bool {
        self.has_times
    }

    /// Moves all times of a run in the bytes of a message, by nanoseconds: from the start of a run to 1970, or back.
    /// What would be before the start becomes the start.
    ///
    /// ```
    /// use saoms_registry::schema::Schema;
    ///
    /// let began = r#"{"name":"Began","fields":[{"name":"robot","type":"uint8"},{"name":"at","type":"time"}]}"#;
    /// let schema = Schema::parse(began)?;
    /// let mut bytes = schema.encode(&serde_json::json!({"robot": 7, "at": 1_000}))?;
    /// schema.move_times(&mut bytes, 500)?;
    /// assert_eq!(schema.decode(&bytes)?.to_string(), r#"{"at":1500,"robot":7}"#);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The bytes are no such message; the times before the fault have been moved.
    pub fn move_times(&self, bytes: &mut [u8], by: i64) -> Result<(), DecodeError> {
        let mut places = Vec::new();
        if self.has_times {
            find_in_message(self, &mut Reader::new(bytes)?, &mut places)?;
        }
        for place in places {
            let Some(time) = bytes.get_mut(place..).and_then(|rest| rest.first_chunk_mut::<8>()) else { continue };
            *time = u64::from_le_bytes(*time).saturating_add_signed(by).to_le_bytes();
        }
        Ok(())
    }
}

fn find_in_message(schema: &Schema, reader: &mut Reader<'_>, places: &mut Vec<usize>) -> Result<(), DecodeError> {
    if schema.fields.is_empty() {
        return reader.scalar::<1>().map(drop);
    }
    schema.fields.iter().try_for_each(|field| find(&field.kind, reader, places))
}

fn find(kind: &Type, reader: &mut Reader<'_>, places: &mut Vec<usize>) -> Result<(), DecodeError> {
    if !kind.has_times() {
        return skip(kind, reader);
    }
    match kind {
        Type::Message(schema) => find_in_message(schema, reader, places),
        Type::Optional(element) => (0..option(element, reader)?).try_for_each(|_| find(element, reader, places)),
        Type::Array(element, count) => (0..*count).try_for_each(|_| find(element, reader, places)),
        Type::Sequence(element) => {
            let count = reader.length(element.least_size())?;
            (0..count).try_for_each(|_| find(element, reader, places))
        }
        Type::Bounded(content, _) => find(content, reader, places),
        Type::Time | Type::Bool | Type::Number(_) | Type::String | Type::Enumeration(..) => {
            reader.scalar::<8>()?;
            // It is aligned, and ends here.
            places.push(reader.offset() - 8);
            Ok(())
        }
    }
}

impl Type {
    /// True if it is a time of a run, or has one.
    pub(super) fn has_times(&self) -> bool {
        match self {
            Type::Time => true,
            Type::Bool | Type::Number(_) | Type::String | Type::Enumeration(..) => false,
            Type::Sequence(inner) | Type::Array(inner, _) | Type::Bounded(inner, _) | Type::Optional(inner) => {
                inner.has_times()
            }
            Type::Message(schema) => schema.has_times,
        }
    }
}
