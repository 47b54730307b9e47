//! The parser and its tree. Tags and text are read here, once, with all that has to be checked of them; quick-xml finds what else there is.

use std::sync::Arc;

use quick_xml::Reader;
use quick_xml::events::Event;

use super::arena::{Arena, Node};
use super::characters::{Survey, forbidden, is_blank, survey};
use super::eight::{blanks, first_of, same};
use super::fault::{Checked, Fault, Input};
use super::form::Forms;
use super::namespaces::{Namespaces, refusal};
use super::shape::Known;
use super::tag::RawAttribute;
use super::tree::{Declared, Document, ElementId, NO_NAMESPACE, NONE, XMLNS};
use super::{prolog, reference, tag, unbound, value};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::{FileId, Span};

/// What a text is as XML.
#[derive(Debug)]
pub struct Parsed {
    /// The tree; up to the fault when there is one. `None` when not even the root was reached.
    pub document: Option<Document>,
    /// The first thing that is not well-formed.
    pub fault: Option<Diagnostic>,
    /// Why start tags and end tags do not fit, where that is the fault.
    pub tangle: Option<Tangle>,
}

/// Why start tags and end tags do not fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tangle {
    /// An element that is open has no end tag.
    LeftOpen,
    /// This element ends in its start tag, and an end tag comes for it.
    ClosedEarly(ElementId),
}

/// Reads a text of less than 4 GiB as XML 1.0 with namespaces.
///
/// ```
/// use saoms_lang::{source::Sources, xml};
///
/// let mut sources = Sources::new();
/// let file = sources.add("t", "<fleet size='2 &gt; 1'><robot/>idle</fleet>");
/// let document = xml::parse(file, sources.get(file).text()).document.unwrap();
/// let fleet = document.root();
/// assert_eq!(fleet.attribute("size").unwrap().value(), "2 > 1");
/// assert_eq!(fleet.children().next().unwrap().name(), "robot");
/// assert_eq!(fleet.text(), "idle");
/// ```
pub fn parse(file: FileId, text: &Arc<String>) -> Parsed {
    // A character that XML forbids ends the text for all that follows: faults before it come first.
    let survey = survey(text.as_bytes());
    let bad = survey.forbidden;
    let visible = &text[..bad.unwrap_or(text.len())];
    let mut parser = Parser::new(Input { file, text: visible }, &survey);
    let fault = match (parser.run(), bad) {
        (Err(Fault::Wrong(one)), _) => Some(*one),
        (Err(Fault::Ended(_)) | Ok(()), Some(at)) => Some(forbidden(Input { file, text }, at as u32)),
        (Err(fault), None) => Some(fault.into_diagnostic()),
        (Ok(()), None) => None,
    };
    let tangle = parser.tangle;
    Parsed { document: parser.into_document(text), fault, tangle }
}

/// An element whose end tag has not come yet.
#[derive(Debug)]
pub(super) struct Open {
    pub(super) element: u32,
    /// Its place among the elements that are kept.
    pub(super) kept: usize,
    /// Declarations of namespaces in scope outside it.
    outside: u32,
}

pub(super) struct Parser<'a> {
    pub(super) input: Input<'a>,
    /// Where the event being read starts.
    start: u32,
    pub(super) arena: Arena,
    shapes: Known,
    forms: Forms,
    /// Those of the tag at hand, when it is read name by name.
    attributes: Vec<RawAttribute>,
    namespaces: Namespaces<'a>,
    pub(super) open: Vec<Open>,
    pub(super) tangle: Option<Tangle>,
}

impl<'a> Parser<'a> {
    fn new(input: Input<'a>, survey: &Survey) -> Self {
        // Lists that grow have room for twice as much. So many elements and values there are, or somewhat more, as comments and texts count as
        // well; the shortest are `<a>` and ` a=""`.
        let elements = survey.starts.min(input.text.len() / 3);
        let values = survey.equals.min(input.text.len() / 5);
        Self {
            input,
            start: 0,
            arena: Arena::with_capacity(elements, values),
            shapes: Known::new(),
            forms: Forms::new(),
            attributes: Vec::new(),
            namespaces: Namespaces::new(),
            open: Vec::new(),
            tangle: None,
        }
    }

    fn run(&mut self) -> Checked<()> {
        let text = self.input.text;
        let base = if text.starts_with('\u{feff}') { 3 } else { 0 };
        self.start = base;
        if text[base as usize..].starts_with('\u{feff}') {
            // quick-xml would take it for the mark that is already gone.
            return Err(self.outside(base, base + 3));
        }
        loop {
            let start = self.start;
            self.start = match text.as_bytes()[start as usize..] {
                [] => return self.finish(),
                [b'<', b'/', ..] => self.end_tag(start)?,
                [b'<', b'!' | b'?', ..] => self.other_markup(start, base)?,
                [b'<', ..] => self.start_tag(start)?,
                [b'&', ..] => self.reference(start)?,
                [..] => self.text(start)?,
            };
        }
    }

    /// What is neither a tag nor text: comments, instructions, CDATA. quick-xml finds where they end.
    fn other_markup(&mut self, start: u32, base: u32) -> Checked<u32> {
        let mut reader = Reader::from_str(&self.input.text[start as usize..]);
        let event = reader.read_event();
        let end = start + reader.buffer_position() as u32;
        match event {
            Ok(Event::CData(_)) => self.cdata(start, end)?,
            Ok(Event::Comment(_)) => prolog::comment(self.input, start, end)?,
            Ok(Event::PI(_) | Event::Decl(_)) => prolog::instruction(self.input, start, end, base)?,
            Ok(Event::DocType(_)) => return Err(prolog::doctype(self.input, start, start + 9).into()),
            _ => return Err(prolog::broken(self.input, start)),
        }
        Ok(end)
    }

    /// Gives where it ends.
    fn start_tag(&mut self, start: u32) -> Checked<u32> {
        if self.open.len() == 1
            && let Some(end) = self.forms.read(self.input, start, &mut self.arena)
        {
            return Ok(end);
        }
        let outside = self.namespaces.depth();
        let values = self.arena.values.len() as u32;
        let known = self.shapes.find(self.input, start, self.namespaces.scope(), &mut self.arena.values);
        let (shape, end) = match known {
            Some(known) if !self.open.is_empty() => known,
            _ => {
                self.arena.values.truncate(values as usize);
                self.new_shape(start)?
            }
        };
        let is_closed = self.shapes.shapes.get(shape).is_empty;
        let (element, kept) = (self.arena.len(), self.arena.kept.len());
        self.arena.kept.push(Node {
            start,
            end,
            tag_end: end,
            shape,
            parent: self.open.last().map_or(NONE, |open| open.element),
            after: element + 1,
            values,
            has_text: false,
            is_closed,
        });
        if is_closed {
            self.namespaces.leave(outside);
        } else {
            self.open.push(Open { element, kept, outside });
        }
        Ok(end)
    }

    /// Reads a start tag name by name; gives its shape, and where it ends.
    fn new_shape(&mut self, start: u32) -> Checked<(u32, u32)> {
        self.attributes.clear();
        let tag = tag::start_tag(self.input, start, &mut self.attributes)?;
        let name = Span::new(start + 1, start + 1 + tag.name_len);
        if self.open.is_empty() && !self.arena.kept.is_empty() {
            return Err(self.second_root(name));
        }
        if tag.has_prefixes {
            self.declare()?;
        }
        let prefix = || self.input.slice(name.start, name.end).split_once(':').map(|(prefix, _)| prefix);
        let prefix = if tag.is_plain { None } else { prefix() };
        let namespace = match prefix {
            None => self.namespaces.default(),
            Some(prefix) => self.resolve(prefix, name)?,
        };
        if tag.has_prefixes {
            self.resolve_attributes()?;
        }
        let scope = self.namespaces.scope();
        let shape = self.shapes.take(self.input, start, &tag, namespace, &self.attributes, scope);
        self.arena.values.extend(self.attributes.iter().map(|one| one.value));
        Ok((shape, tag.end))
    }

    /// Takes the declarations among the attributes.
    fn declare(&mut self) -> Checked<()> {
        for one in &self.attributes {
            if one.namespace != XMLNS {
                continue;
            }
            let name = self.input.slice(one.start, one.start + one.name_len);
            let prefix = name.strip_prefix("xmlns:").unwrap_or_default();
            let uri = value::attribute_value(self.input.slice(one.value.start, one.value.end));
            if let Some(message) = refusal(prefix, &uri) {
                let end = one.value.end + 1;
                return Err(self.input.fault(&codes::XML_PREFIX, one.start, end, message).into());
            }
            self.namespaces.declare(prefix, uri);
        }
        Ok(())
    }

    /// Finds the namespaces of the attributes, and two of one namespace and name.
    fn resolve_attributes(&mut self) -> Checked<()> {
        let input = self.input;
        let mut seen = std::collections::HashMap::new();
        for index in 0..self.attributes.len() {
            let one = &self.attributes[index];
            if one.namespace == XMLNS || one.namespace == NO_NAMESPACE {
                continue;
            }
            let name = Span::new(one.start, one.start + one.name_len);
            let (prefix, local) = input.slice(name.start, name.end).split_once(':').unwrap_or_default();
            let namespace = self.resolve(prefix, name)?;
            self.attributes[index].namespace = namespace;
            if let Some(before) = seen.insert((namespace, local), index) {
                let uri = self.namespaces.name(namespace);
                let (before, one) = (&self.attributes[before], &self.attributes[index]);
                return Err(tag::duplicate(input, before, one, Some(uri)).into());
            }
        }
        Ok(())
    }

    fn resolve(&self, prefix: &str, name: Span) -> Checked<u32> {
        match self.namespaces.get(prefix) {
            Some(number) => Ok(number),
            None => {
                let prefixes = self.namespaces.prefixes();
                let root = self.arena.kept.first().map_or(self.start, |root| root.start);
                Err(unbound::prefix(self.input, prefix, name.start, &prefixes, root).into())
            }
        }
    }

    fn end_tag(&mut self, start: u32) -> Checked<u32> {
        if let Some(open) = self.open.last() {
            // Nearly every end tag has the name of its start tag, and nothing behind it.
            let name = self.name_span(&self.arena.kept[open.kept]);
            let bytes = self.input.bytes();
            let (from, end) = (start as usize + 2, (start + 2 + name.len()) as usize);
            let is_it = |found| same(found, &bytes[name.start as usize..name.end as usize]);
            if bytes.get(end) == Some(&b'>') && bytes.get(from..end).is_some_and(is_it) {
                return Ok(self.close(end as u32 + 1));
            }
        }
        let (name, end) = tag::end_tag(self.input, start)?;
        let found = self.input.slice(name.start, name.end);
        let Some(open) = self.open.last() else {
            let message = format!("{} closes nothing: no element is open", quoted(&format!("</{found}>")));
            let one = self.input.fault(&codes::XML_TAG_MISMATCH, start, end, message);
            return Err(one.into());
        };
        if self.name(&self.arena.kept[open.kept]) != found {
            return Err(self.mismatch(found, start, end));
        }
        Ok(self.close(end))
    }

    /// Closes the element that was opened last, with an end tag that ends at `end`; gives that.
    fn close(&mut self, end: u32) -> u32 {
        if let Some(open) = self.open.pop() {
            let after = self.arena.len();
            let node = &mut self.arena.kept[open.kept];
            (node.end, node.after, node.is_closed) = (end, after, true);
            self.namespaces.leave(open.outside);
            if self.open.len() == 1 {
                self.forms.take(self.input, &open, &self.shapes.shapes, &mut self.arena);
            }
        }
        end
    }

    pub(super) fn name(&self, node: &Node) -> &'a str {
        let name = self.name_span(node);
        self.input.slice(name.start, name.end)
    }

    pub(super) fn name_span(&self, node: &Node) -> Span {
        self.name_at(node.start, node.shape)
    }

    /// The name in a start tag.
    pub(super) fn name_at(&self, start: u32, shape: u32) -> Span {
        Span::new(start + 1, start + 1 + self.shapes.shapes.get(shape).name_len)
    }

    fn text(&mut self, start: u32) -> Checked<u32> {
        let rest = &self.input.bytes()[start as usize..];
        // Of what comes before a blank, XML allows white space alone.
        let blank = blanks(rest);
        if matches!(rest.get(blank), None | Some(b'<' | b'&')) {
            return Ok(start + blank as u32);
        }
        if let Some(open) = self.open.last()
            && let Some(length) = first_of(rest, [b'<', b'&', b']'])
            && rest[length] != b']'
        {
            self.arena.kept[open.kept].has_text = true;
            return Ok(start + length as u32);
        }
        let end = start + memchr::memchr2(b'<', b'&', rest).unwrap_or(rest.len()) as u32;
        let text = self.input.slice(start, end);
        let Some(open) = self.open.last() else {
            let blank = |c: char| matches!(c, ' ' | '\t' | '\r' | '\n');
            let from = end - text.trim_start_matches(blank).len() as u32;
            return Err(self.outside(from, start + text.trim_end_matches(blank).len() as u32));
        };
        self.arena.kept[open.kept].has_text = true;
        if let Some(at) = text.find("]]>") {
            let at = start + at as u32;
            let place = Span::new(at, at + 3).in_file(self.input.file);
            return Err(self
                .input
                .fault(
                    &codes::XML_SYNTAX,
                    at,
                    at + 3,
                    "`]]>` in text, which XML allows only to end a CDATA section",
                )
                .suggest("replace it with `]]&gt;`", place, "]]&gt;")
                .into());
        }
        Ok(end)
    }

    fn cdata(&mut self, start: u32, end: u32) -> Checked<()> {
        let Some(open) = self.open.last() else {
            return Err(self.outside(start, end));
        };
        if !is_blank(&self.input.bytes()[start as usize + 9..end as usize - 3]) {
            self.arena.kept[open.kept].has_text = true;
        }
        Ok(())
    }

    fn reference(&mut self, start: u32) -> Checked<u32> {
        let end = reference::check(self.input, start)?;
        let Some(open) = self.open.last() else {
            return Err(self.outside(start, end));
        };
        self.arena.kept[open.kept].has_text = true;
        Ok(end)
    }

    fn outside(&self, start: u32, end: u32) -> Fault {
        let one = self.input.fault(&codes::XML_OUTSIDE_ROOT, start, end, "text outside of the root element");
        match self.arena.kept.first() {
            None => {
                one.help("a file is one element; before it only comments and instructions can stand").into()
            }
            Some(root) => {
                let name = self.name_span(root).in_file(self.input.file);
                one.label(name, "the root element").into()
            }
        }
    }

    fn second_root(&self, name: Span) -> Fault {
        let Some(root) = self.arena.kept.first() else { return self.outside(name.start, name.end) };
        let first = self.name_span(root).in_file(self.input.file);
        self.input
            .fault(
                &codes::XML_OUTSIDE_ROOT,
                name.start,
                name.end,
                "a second root element: a file is one element",
            )
            .label(first, "the first root element")
            .into()
    }

    fn finish(&mut self) -> Checked<()> {
        let input = self.input;
        if let Some(open) = self.open.last() {
            let Span { start, end } = self.name_span(&self.arena.kept[open.kept]);
            let name = quoted(input.slice(start, end));
            self.tangle = Some(Tangle::LeftOpen);
            return Err(input.ended(&codes::XML_UNCLOSED, start, end, format!("{name} is never closed")));
        }
        if self.arena.kept.is_empty() {
            let at = input.text.len() as u32;
            return Err(input.ended(&codes::XML_SYNTAX, at, at, "the file holds no element"));
        }
        Ok(())
    }

    fn into_document(mut self, text: &Arc<String>) -> Option<Document> {
        // Behind a fault the open elements end where reading ended.
        let after = self.arena.len();
        for open in &self.open {
            let node = &mut self.arena.kept[open.kept];
            (node.end, node.after) = (self.start, after);
        }
        self.arena.finish();
        (!self.arena.kept.is_empty()).then(|| Document {
            file: self.input.file,
            text: Arc::clone(text),
            arena: self.arena,
            shapes: self.shapes.shapes,
            namespaces: self.namespaces.into_names(),
            declared: Declared::default(),
        })
    }
}
