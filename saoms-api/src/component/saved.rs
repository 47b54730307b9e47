use crate::host::cdr::{self, Writer};
use crate::{Failure, Field, Message};

/// State of a component for its successor, when its library was rebuilt: a message, or nothing. See
/// [`Component::save`](crate::Component::save).
///
/// ```
/// use saoms_api::{Message, Saved};
///
/// #[derive(Clone, Debug, PartialEq, Message)]
/// struct Odometer {
///     blocks: u64,
/// }
///
/// let saved = Saved::of(&Odometer { blocks: 12 });
/// assert_eq!(saved.read::<Odometer>()?, Some(Odometer { blocks: 12 }));
/// assert_eq!(Saved::default().read::<Odometer>()?, None);
/// # Ok::<(), saoms_api::Failure>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Saved {
    bytes: Vec<u8>,
}

/// The form at boundaries: the type, and the CDR form.
#[derive(Field)]
struct Form {
    schema: String,
    message: Vec<u8>,
}

impl Saved {
    /// This message.
    pub fn of<M: Message>(message: &M) -> Saved {
        let mut writer = Writer::new();
        message.write(&mut writer);
        // The form, without a copy of its parts: components save often.
        let mut form = Writer::reusing(Vec::with_capacity(M::SCHEMA.len() + writer.bytes().len() + 16));
        form.string(M::SCHEMA);
        form.length(writer.bytes().len());
        form.octets(writer.bytes());
        Saved { bytes: form.into_bytes() }
    }

    /// State from the boundary to plugins; no bytes are nothing.
    pub const fn from_bytes(bytes: Vec<u8>) -> Saved {
        Saved { bytes }
    }

    /// The form at boundaries.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// True if nothing was saved.
    pub fn is_nothing(&self) -> bool {
        self.bytes.is_empty()
    }

    /// The message; `None` where nothing was saved.
    ///
    /// # Errors
    /// The earlier build saved a message of another type or with other fields.
    pub fn read<M: Message>(&self) -> Result<Option<M>, Failure> {
        if self.is_nothing() {
            return Ok(None);
        }
        let Form { schema, message } = cdr::decode(&self.bytes)
            .map_err(|error| Failure::new(format!("the saved state cannot be read: {error}")))?;
        if schema != M::SCHEMA {
            return Err(Failure::new(format!(
                "the earlier build saved {schema}, but this one reads {}: read the old form, or save nothing and \
                restart the fleet",
                M::SCHEMA
            )));
        }
        cdr::decode(&message)
            .map(Some)
            .map_err(|error| Failure::new(format!("the saved state cannot be read: {error}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Debug, PartialEq, Message)]
    struct Before {
        blocks: u32,
    }

    #[derive(Clone, Debug, PartialEq, Message)]
    struct After {
        blocks: u64,
    }

    #[test]
    fn what_another_build_saved_is_read_only_if_it_means_the_same() {
        let saved = Saved::from_bytes(Saved::of(&Before { blocks: 7 }).bytes().to_vec());
        assert_eq!(saved.read::<Before>().unwrap(), Some(Before { blocks: 7 }));
        let message = saved.read::<After>().unwrap_err().to_string();
        assert!(message.contains("the earlier build saved") && message.contains("uint32"), "{message}");
        for length in 1..saved.bytes().len() {
            assert!(Saved::from_bytes(saved.bytes()[..length].to_vec()).read::<Before>().is_err());
        }
    }
}
