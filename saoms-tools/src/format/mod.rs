//! One layout for composites: indentation, attributes, blank lines.
//!
//! The layout changes nothing that an XML parser tells its user, white space between elements aside: order, prefixes,
//! comments, instructions, CDATA sections, references and the text of every value stay as they are written. Formatting
//! what is formatted changes nothing.

mod gap;
mod lines;
mod tag;
#[cfg(test)]
mod tests;

use std::fmt;

use gap::{Gap, Item};
use lines::Lines;

use saoms_lang::model::Version;
use saoms_lang::source::Span;
use saoms_lang::syntax::{Document, Element, XML_NAMESPACE};

/// The columns that a start tag has to fit into unless something else is set.
pub const WIDTH: usize = 120;

/// Elements of SCA whose text means something, that between their parts included.
const WITH_TEXT: [&str; 3] = ["property", "value", "documentation"];

/// The text of a well-formed document in the one layout; start tags that do not fit into `width` columns have an
/// attribute a line.
///
/// ```
/// use saoms_lang::{source::Sources, syntax};
/// use saoms_tools::format::{format, WIDTH};
///
/// let mut sources = Sources::new();
/// let file = sources.add("t", "<fleet><!-- the first --><robot  id = '1'></robot></fleet>");
/// let document = syntax::parse(file, sources.get(file).text()).well_formed().unwrap();
/// assert_eq!(format(&document, WIDTH), "<fleet> <!-- the first -->\n  <robot id=\"1\"/>\n</fleet>\n");
/// ```
///
/// A document of a text with faults is not for this function.
pub fn format(document: &Document, width: usize) -> String {
    Formatted { document, width }.to_string()
}

/// A formatted text, made while it is written: of a file with deep elements it is many times as long.
#[derive(Clone, Copy, Debug)]
pub struct Formatted<'d> {
    /// The document.
    pub document: &'d Document,
    /// The columns that a start tag has to fit into.
    pub width: usize,
}

impl fmt::Display for Formatted<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { document, width } = *self;
        let text = document.text();
        let mark = if text.starts_with('\u{feff}') { "\u{feff}" } else { "" };
        let lines = Lines::new(text, mark, out);
        let mut writer = Writer { text, lines, width, at: mark.len() as u32, open: Vec::new() };
        let mut end = writer.at;
        for element in document.elements() {
            // What is inside an element whose content stays as it is was written with it.
            if element.span().start >= end {
                end = writer.element(element);
            }
        }
        writer.finish()
    }
}

struct Writer<'a, 'w> {
    text: &'a str,
    lines: Lines<'w>,
    width: usize,
    /// Up to where the text is written.
    at: u32,
    /// The elements that are open, without those whose content stays as it is.
    open: Vec<Element<'a>>,
}

impl<'a> Writer<'a, '_> {
    /// Writes an element, of one that is laid out only the start tag. Gives the place up to which elements are done.
    fn element(&mut self, element: Element<'a>) -> u32 {
        let span = element.span();
        while let Some(&outer) = self.open.last().filter(|outer| outer.span().end <= span.start) {
            self.close(outer);
        }
        let blank = self.gap(span.start);
        if !self.lines.is_empty {
            self.lines.next(self.open.len(), blank);
        }
        let content = element.content_span();
        let inside = &self.text[content.start as usize..content.end as usize];
        let is_laid_out = is_laid_out(element);
        let is_empty = inside.is_empty() || (is_laid_out && gap::is_blank(inside));
        tag::start(element, is_empty, self.width, self.open.len(), &mut self.lines);
        self.at = span.end;
        if is_empty {
            return span.end;
        }
        if is_laid_out {
            self.at = content.start;
            self.open.push(element);
            return content.start;
        }
        self.lines.verbatim(inside);
        tag::end(element, &mut self.lines);
        span.end
    }

    /// Writes the comments and instructions up to `end`. Gives whether a blank line follows them.
    fn gap(&mut self, end: u32) -> bool {
        let mut blank = false;
        for Item { text, breaks } in Gap::new(&self.text[self.at as usize..end as usize]) {
            blank = breaks > 1;
            let Some(text) = text else { continue };
            if self.lines.is_empty {
                // The very start of the file.
            } else if breaks == 0 {
                self.lines.push(" ");
            } else {
                self.lines.next(self.open.len(), blank);
            }
            self.lines.verbatim(text);
            blank = false;
        }
        self.at = end;
        blank
    }

    /// Writes the end of the element that was opened last; the comments before its end tag still stand in it.
    fn close(&mut self, element: Element<'a>) {
        let blank = self.gap(element.content_span().end);
        self.open.pop();
        self.lines.next(self.open.len(), blank);
        tag::end(element, &mut self.lines);
        self.at = element.span().end;
    }

    fn finish(mut self) -> fmt::Result {
        while let Some(&outer) = self.open.last() {
            self.close(outer);
        }
        self.gap(self.text.len() as u32);
        self.lines.finish()
    }
}

/// True if white space in the content means nothing, so that each part gets a line of its own.
fn is_laid_out(element: Element<'_>) -> bool {
    if element.has_text() || has_section(element) || is_preserved(element) {
        return false;
    }
    let local = element.local_name();
    element.children().next().is_some()
        || (Version::from_namespace(element.namespace()).is_some() && !WITH_TEXT.contains(&local))
}

/// True if a CDATA section stands directly in the element.
fn has_section(element: Element<'_>) -> bool {
    let text = element.document().text();
    let Span { start, end } = element.content_span();
    let mut from = start;
    let starts = element.children().map(|child| child.span()).chain([Span::empty(end)]);
    starts.into_iter().any(|next| {
        let gap = &text[from as usize..next.start as usize];
        from = next.end;
        Gap::new(gap).any(|item| item.text.is_some_and(|text| text.starts_with("<![CDATA[")))
    })
}

/// True if `xml:space` asks for white space as it is.
fn is_preserved(element: Element<'_>) -> bool {
    element.attribute_in(XML_NAMESPACE, "space").is_some_and(|space| space.value() == "preserve")
}
