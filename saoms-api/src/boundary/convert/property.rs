use saoms_abi::{Bytes, PropertyView};

use crate::Failure;
use crate::host::{PropertyValue, SmolStr};

/// The views of property values. Those below the top are kept alive beside them.
pub struct PropertyViews {
    pub top: Vec<PropertyView>,
    /// Only held: the views above point into it.
    _below: Vec<PropertyViews>,
}

impl PropertyViews {
    pub fn of(values: &[(SmolStr, PropertyValue)]) -> PropertyViews {
        PropertyViews::of_each(&mut values.iter().map(|(name, value)| (name.as_str(), value)))
    }

    fn of_each<'a>(values: &mut dyn Iterator<Item = (&'a str, &'a PropertyValue)>) -> PropertyViews {
        let (mut top, mut below) = (Vec::new(), Vec::new());
        for (name, value) in values {
            let (kind, text, children) = match value {
                PropertyValue::Text(text) => (0, text.as_str(), None),
                PropertyValue::Many(values) => {
                    (1, "", Some(PropertyViews::of_each(&mut values.iter().map(|value| ("", value)))))
                }
                PropertyValue::Complex(values) => (2, "", Some(PropertyViews::of(values))),
            };
            let list = children.as_ref().map_or(&[][..], |children| &children.top);
            top.push(PropertyView {
                name: Bytes::text(name),
                kind,
                text: Bytes::text(text),
                children: list.as_ptr(),
                child_count: list.len(),
            });
            below.extend(children);
        }
        PropertyViews { top, _below: below }
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
