use std::borrow::Cow;
use std::sync::OnceLock;

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
#[derive(Clone, Debug, Default)]
pub struct Saved {
    /// The type of a message that was saved here: its text is copied only where the state leaves the library.
    schema: Option<&'static str>,
    /// The CDR form of that message; without a type, the form at boundaries.
    bytes: Vec<u8>,
    /// The form at boundaries, once somebody asked for it.
    form: OnceLock<Vec<u8>>,
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
        Saved { schema: Some(M::SCHEMA), bytes: cdr::encode(message), form: OnceLock::new() }
    }

    /// State from the boundary to plugins; no bytes are nothing.
    pub const fn from_bytes(bytes: Vec<u8>) -> Saved {
        Saved { schema: None, bytes, form: OnceLock::new() }
    }

    /// The form at boundaries.
    pub fn bytes(&self) -> &[u8] {
        match self.schema {
            Some(schema) => self.form.get_or_init(|| form(schema, &self.bytes)),
            None => &self.bytes,
        }
    }

    /// The form at boundaries.
    pub fn into_bytes(self) -> Vec<u8> {
        match self.schema {
            Some(schema) => self.form.into_inner().unwrap_or_else(|| form(schema, &self.bytes)),
            None => self.bytes,
        }
    }

    /// The type and the CDR form of the message; `None` where nothing was saved, or it cannot be read.
    pub fn parts(&self) -> Option<(Cow<'static, str>, Cow<'_, [u8]>)> {
        if let Some(schema) = self.schema {
            return Some((schema.into(), (&self.bytes).into()));
        }
        let Form { schema, message } = cdr::decode(&self.bytes).ok()?;
        Some((schema.into(), message.into()))
    }

    /// True if nothing was saved.
    pub fn is_nothing(&self) -> bool {
        self.schema.is_none() && self.bytes.is_empty()
    }

    /// The message; `None` where nothing was saved.
    ///
    /// # Errors
    /// The earlier build saved a message of another type or with other fields.
    pub fn read<M: Message>(&self) -> Result<Option<M>, Failure> {
        if self.is_nothing() {
            return Ok(None);
        }
        let form = || cdr::decode(&self.bytes).map(|Form { schema, message }| (schema.into(), message.into()));
        let parts: Result<(Cow<'_, str>, Cow<'_, [u8]>), _> =
            self.schema.map_or_else(form, |schema| Ok((schema.into(), (&self.bytes).into())));
        let (schema, message) =
            parts.map_err(|error| Failure::new(format!("the saved state cannot be read: {error}")))?;
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

impl PartialEq for Saved {
    fn eq(&self, other: &Saved) -> bool {
        match (self.schema, other.schema) {
            // The text of one type has one place, as a rule.
            (Some(own), Some(other_one)) => {
                self.bytes == other.bytes && (std::ptr::eq(own, other_one) || own == other_one)
            }
            _ => self.bytes() == other.bytes(),
        }
    }
}

impl Eq for Saved {}

/// The form at boundaries of a message of this type.
fn form(schema: &str, message: &[u8]) -> Vec<u8> {
    let mut form = Writer::reusing(Vec::with_capacity(schema.len() + message.len() + 16));
    form.string(schema);
    form.length(message.len());
    form.octets(message);
    form.into_bytes()
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
        let own = Saved::of(&Before { blocks: 7 });
        let saved = Saved::from_bytes(own.bytes().to_vec());
        assert_eq!((own.parts(), saved.bytes()), (saved.parts(), own.bytes()));
        assert!(own == saved && own.clone().into_bytes() == saved.bytes());
        assert_ne!(own, Saved::of(&Before { blocks: 8 }));
        assert_eq!(own.read::<Before>().unwrap(), Some(Before { blocks: 7 }));
        assert!(own.read::<After>().is_err());
        assert_eq!(saved.read::<Before>().unwrap(), Some(Before { blocks: 7 }));
        let message = saved.read::<After>().unwrap_err().to_string();
        assert!(message.contains("the earlier build saved") && message.contains("uint32"), "{message}");
        for length in 1..saved.bytes().len() {
            assert!(Saved::from_bytes(saved.bytes()[..length].to_vec()).read::<Before>().is_err());
        }
    }
}
