use std::ops::Deref;

use crate::host::cdr::{DecodeError, Reader, Writer};
use crate::host::declaration::ConstText;
use crate::{Failure, Field};

/// A sequence or text in a message that has at most so many elements or bytes, as `int32[<=16]` and `string<=32` in ROS
/// 2 interfaces: `Bounded<Vec<i32>, 16>`, `Bounded<String, 32>`. It is encoded as one without a bound.
///
/// ```
/// use saoms_api::Bounded;
///
/// let name: Bounded<String, 8> = Bounded::new("gripper".to_owned())?;
/// assert_eq!(name.len(), 7);
/// let error = Bounded::<String, 8>::new("left gripper".to_owned()).unwrap_err();
/// assert_eq!(error.message(), "found a length of 12, expected at most 8");
/// # Ok::<(), saoms_api::Failure>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Bounded<C, const MOST: usize>(C);

/// What a [`Bounded`] can hold: `Vec` and `String`.
pub trait Measured {
    /// Number of elements, or of bytes of UTF-8.
    fn length(&self) -> usize;
}

impl<T> Measured for Vec<T> {
    fn length(&self) -> usize {
        self.len()
    }
}

impl Measured for String {
    fn length(&self) -> usize {
        self.len()
    }
}

impl<C: Measured, const MOST: usize> Bounded<C, MOST> {
    /// Takes it over, if it is no longer than that.
    ///
    /// # Errors
    /// It is longer.
    pub fn new(content: C) -> Result<Self, Failure> {
        match content.length() {
            length if length <= MOST => Ok(Bounded(content)),
            length => Err(Failure::new(too_long(length, MOST))),
        }
    }

    /// The content without its bound.
    pub fn into_inner(self) -> C {
        self.0
    }
}

impl<C, const MOST: usize> Deref for Bounded<C, MOST> {
    type Target = C;

    fn deref(&self) -> &C {
        &self.0
    }
}

impl<C: Measured + Field, const MOST: usize> Field for Bounded<C, MOST> {
    const TYPE: ConstText = ConstText::Joined(&[
        ConstText::Plain("{\"bounded\":"),
        C::TYPE,
        ConstText::Plain(",\"most\":"),
        ConstText::Number(MOST),
        ConstText::Plain("}"),
    ]);
    const LEAST_SIZE: usize = C::LEAST_SIZE;

    fn write(&self, writer: &mut Writer) {
        self.0.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let at = reader.offset();
        let content = C::read(reader)?;
        match content.length() {
            length if length <= MOST => Ok(Bounded(content)),
            length => Err(DecodeError::new(too_long(length, MOST), at)),
        }
    }
}

fn too_long(length: usize, most: usize) -> String {
    format!("found a length of {length}, expected at most {most}")
}
