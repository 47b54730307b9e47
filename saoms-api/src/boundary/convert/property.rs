use saoms_abi::{Bytes, PropertyView};

use crate::Failure;
use crate::host::declaration::Scalar;
use crate::host::{PropertyValue, SmolStr};

/// The views of property values, each as its usual text. What they point into is kept alive beside them.
pub struct PropertyViews {
    pub top: Vec<PropertyView>,
    _texts: Vec<Box<str>>,
    _below: Vec<PropertyViews>,
}

impl PropertyViews {
    pub fn of(values: &[(SmolStr, PropertyValue)]) -> PropertyViews {
        PropertyViews::of_each(&mut values.iter().map(|(name, value)| (name.as_str(), value)))
    }

    fn of_each<'a>(values: &mut dyn Iterator<Item = (&'a str, &'a PropertyValue)>) -> PropertyViews {
        let (mut top, mut texts, mut below) = (Vec::new(), Vec::new(), Vec::new());
        for (name, value) in values {
            let (kind, text, children) = match value {
                PropertyValue::Scalar(Scalar::Text(text)) => (0, Bytes::text(text), None),
                PropertyValue::Scalar(scalar) => {
                    let text: Box<str> = scalar.to_string().into();
                    let view = Bytes::text(&text);
                    texts.push(text);
                    (0, view, None)
                }
                PropertyValue::Many(values) => {
                    (1, Bytes::text(""), Some(PropertyViews::of_each(&mut values.iter().map(|value| ("", value)))))
                }
                PropertyValue::Complex(values) => (2, Bytes::text(""), Some(PropertyViews::of(values))),
            };
            let list = children.as_ref().map_or(&[][..], |children| &children.top);
            top.push(PropertyView {
                name: Bytes::text(name),
                kind,
                text,
                children: list.as_ptr(),
                child_count: list.len(),
            });
            below.extend(children);
        }
        PropertyViews { top, _texts: texts, _below: below }
    }
}

/// The values of a list of views.
///
/// # Errors
/// A text is no text, or a kind is unknown.
///
/// # Safety
/// The list, and everything it leads to, is readable.
pub(in crate::boundary) unsafe fn read_properties(
    list: *const PropertyView,
    count: usize,
) -> Result<Vec<(SmolStr, PropertyValue)>, Failure> {
    // SAFETY: as the caller promises.
    let views = unsafe { saoms_abi::list(list, count) }?;
    let mut values = Vec::with_capacity(views.len());
    for view in views {
        // SAFETY: as the caller promises.
        let (name, text, children) = unsafe {
            (view.name.get_text()?, view.text.get_text()?, read_properties(view.children, view.child_count)?)
        };
        let value = match view.kind {
            // Whoever takes it reads it.
            0 => text.into(),
            1 => PropertyValue::Many(children.into_iter().map(|(_, value)| value).collect()),
            2 => PropertyValue::Complex(children.into()),
            other => {
                return Err(Failure::new(format!("found {other} for the kind of a property value, expected 0 to 2")));
            }
        };
        values.push((name.into(), value));
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn values_cross_as_their_usual_texts() {
        let integer = |number: i128| PropertyValue::from(Scalar::Integer(number.into()));
        let values = [
            ("a", PropertyValue::from(" as it is ")),
            ("b", Scalar::Boolean(true).into()),
            ("c", integer(-7)),
            ("d", Scalar::Float(0.5).into()),
            ("e", Scalar::Duration(Duration::from_millis(1500)).into()),
            ("f", PropertyValue::Many([integer(1), integer(i128::from(u64::MAX))].into())),
            ("g", PropertyValue::Complex([("x".into(), integer(3)), ("y".into(), "z".into())].into())),
        ];
        let values = values.map(|(name, value)| (name.into(), value));
        let views = PropertyViews::of(&values);
        // SAFETY: the views and all that they lead to are above.
        let read = unsafe { read_properties(views.top.as_ptr(), views.top.len()) }.unwrap();
        let expected = [
            ("a", " as it is ".into()),
            ("b", "true".into()),
            ("c", "-7".into()),
            ("d", "0.5".into()),
            ("e", "1500ms".into()),
            ("f", PropertyValue::Many(["1".into(), "18446744073709551615".into()].into())),
            ("g", PropertyValue::Complex([("x".into(), "3".into()), ("y".into(), "z".into())].into())),
        ];
        assert_eq!(read, expected.map(|(name, value)| (name.into(), value)));
    }
}
