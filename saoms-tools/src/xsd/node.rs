//! Elements of a schema.

pub(super) use crate::element::NewElement;

/// Documentation of elements of schemas.
pub(super) trait Documented {
    /// With documentation, which has to be the first inside; with none where the text is empty.
    fn doc(self, text: &str) -> Self;

    /// As the text of a file.
    fn document(&self) -> String;
}

impl Documented for NewElement {
    fn doc(self, text: &str) -> Self {
        if text.is_empty() {
            return self;
        }
        self.child(NewElement::new("xs:annotation").child(NewElement::new("xs:documentation").text(text)))
    }

    fn document(&self) -> String {
        let mut out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
        self.write(0, &mut out);
        out
    }
}
