//! A writer of SVG: the document grows element by element.

use std::fmt::{self, Write};

use saoms_api::host::{escaped, one_line};

/// An SVG document that is being written. Attributes are given as they stand in the file: a text that comes from
/// outside goes through [`shown`].
#[derive(Default)]
pub(super) struct Svg {
    text: String,
    open: Vec<&'static str>,
}

impl Svg {
    /// Opens an element; those that follow are inside it until it is closed.
    pub(super) fn open(&mut self, name: &'static str, attributes: fmt::Arguments<'_>) {
        self.begin(name, attributes);
        self.text.push_str(">\n");
        self.open.push(name);
    }

    /// Closes the element that was opened last.
    pub(super) fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            self.indent();
            let _ = writeln!(self.text, "</{name}>");
        }
    }

    /// An element without content.
    pub(super) fn leaf(&mut self, name: &str, attributes: fmt::Arguments<'_>) {
        self.begin(name, attributes);
        self.text.push_str("/>\n");
    }

    /// An element that holds nothing but this text, which is escaped here.
    pub(super) fn element(&mut self, name: &str, attributes: fmt::Arguments<'_>, text: &str) {
        self.begin(name, attributes);
        let _ = writeln!(self.text, ">{}</{name}>", shown(text));
    }

    /// A whole document of this size inside this one, at this height, which shows a world.
    pub(super) fn nest(&mut self, inner: &Svg, y: f64, (width, height): (f64, f64), world: &str) {
        let (y, width, height) = (number(y), number(width), number(height));
        self.open(
            "svg",
            format_args!(
                r#"class="world" data-world="{}" y="{y}" width="{width}" height="{height}" viewBox="0 0 {width} {height}""#,
                shown(world)
            ),
        );
        self.text.push_str(&inner.text);
        self.close();
    }

    /// The whole document, of this size, with a title for those who do not see it.
    pub(super) fn finish(mut self, width: f64, height: f64, title: &str) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        let (width, height, title) = (number(width), number(height), shown(title));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\">\n <title>{title}</title>\n{}</svg>\n",
            self.text
        )
    }

    fn begin(&mut self, name: &str, attributes: fmt::Arguments<'_>) {
        self.indent();
        let _ = write!(self.text, "<{name}");
        let before = self.text.len();
        let _ = write!(self.text, " {attributes}");
        if self.text.len() == before + 1 {
            self.text.pop();
        }
    }

    fn indent(&mut self) {
        for _ in 0..=self.open.len() {
            self.text.push(' ');
        }
    }
}

/// A length or a coordinate, to a tenth.
pub(super) fn number(value: f64) -> Number {
    Number(value)
}

/// See [`number`].
#[derive(Clone, Copy)]
pub(super) struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded = (self.0 * 10.0).round() / 10.0;
        // Without a sign before zero.
        write!(formatter, "{}", if rounded == 0.0 { 0.0 } else { rounded })
    }
}

/// A text from outside, which may be a name of anybody.
pub(super) fn shown(text: &str) -> String {
    escaped(&one_line(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_is_well_formed_whatever_its_texts() {
        let mut svg = Svg::default();
        svg.open("g", format_args!(r#"id="{}""#, shown("\"1\"\u{1}")));
        svg.leaf("path", format_args!(r#"d="M{} {}""#, number(-0.01), number(1.25)));
        svg.element("text", format_args!(""), "x < y");
        assert_eq!(
            svg.finish(10.04, 20.0, "A & <B>"),
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"10\" height=\"20\" viewBox=\"0 0 10 20\" role=\"img\">\n \
             <title>A &amp; &lt;B&gt;</title>\n <g id=\"&quot;1&quot;\\u{1}\">\n  <path d=\"M0 1.3\"/>\n  \
             <text>x &lt; y</text>\n </g>\n</svg>\n"
        );
    }
}
