//! Start and end tags, byte by byte.

use std::collections::HashMap;

use super::curly;
use super::fault::{Checked, Input};
use super::names::{is_qualified_name, name_length, scan};
use super::reference;
use super::slips;
use super::tree::{NO_NAMESPACE, XMLNS};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::Span;

/// An element with more attributes than this has them compared through a map.
const FEW: usize = 16;

/// An attribute as written, declarations of namespaces included.
#[derive(Debug)]
pub(super) struct RawAttribute {
    pub(super) start: u32,
    pub(super) name_len: u32,
    /// Without the quotes.
    pub(super) value: Span,
    pub(super) namespace: u32,
}

/// What a start tag is.
#[derive(Debug)]
pub(super) struct StartTag {
    /// Behind its `>`.
    pub(super) end: u32,
    pub(super) name_len: u32,
    /// `<a/>`
    pub(super) is_empty: bool,
    /// Whether the name has no colon for certain.
    pub(super) is_plain: bool,
    /// Whether an attribute is named `xmlns` or `xmlns:...`, or has another prefix.
    pub(super) has_prefixes: bool,
}

/// Reads the start tag whose `<` is at `start`; its attributes are appended to `attributes`.
pub(super) fn start_tag(
    input: Input<'_>,
    start: u32,
    attributes: &mut Vec<RawAttribute>,
) -> Checked<StartTag> {
    let bytes = input.bytes();
    let first = attributes.len();
    let name = scan(&bytes[start as usize + 1..]);
    let name_end = start + 1 + name.len;
    if name.len == 0 {
        return Err(nameless(input, start).into());
    }
    if !name.is_plain {
        check_name(input, start + 1, name_end, "element")?;
    }
    let mut tag = StartTag {
        end: 0,
        name_len: name.len,
        is_plain: name.is_plain,
        is_empty: false,
        has_prefixes: false,
    };
    let mut at = name_end;
    loop {
        let space_start = at;
        at = skip_space(bytes, at);
        match bytes.get(at as usize) {
            None => return Err(unclosed(input, start, name_end)),
            Some(b'>') => {
                tag.end = at + 1;
                break;
            }
            Some(b'/') if bytes.get(at as usize + 1) == Some(&b'>') => {
                tag.end = at + 2;
                tag.is_empty = true;
                break;
            }
            Some(b'/') if bytes.len() == at as usize + 1 => return Err(unclosed(input, start, name_end)),
            Some(_) => {}
        }
        if space_start == at {
            return Err(misplaced(input, start, name_end, at, attributes.len() > first).into());
        }
        let attribute = attribute(input, start, name_end, at)?;
        at = attribute.value.end + 1;
        tag.has_prefixes |= attribute.namespace != NO_NAMESPACE;
        attributes.push(attribute);
    }
    check_unique(input, &attributes[first..])?;
    Ok(tag)
}

/// Reads the end tag whose `<` is at `start`; gives its name, and where it ends.
pub(super) fn end_tag(input: Input<'_>, start: u32) -> Checked<(Span, u32)> {
    let bytes = input.bytes();
    let name_start = start + 2;
    let name_end = name_start + name_length(&bytes[name_start as usize..]) as u32;
    let close = skip_space(bytes, name_end);
    match bytes.get(close as usize) {
        _ if name_start == name_end && (close as usize) < bytes.len() => {
            let message = "an end tag is `</`, the name of the element, and `>`";
            Err(input.fault(&codes::XML_NAME, start, name_start, message).into())
        }
        Some(b'>') => Ok((Span::new(name_start, name_end), close + 1)),
        None => Err(input.ended(&codes::XML_UNCLOSED, start, name_end, "this end tag is never closed")),
        Some(_) => {
            let message = format!("{} is misplaced in an end tag", found(input, close));
            let end = input.character_end(close);
            Err(input
                .fault(&codes::XML_SYNTAX, close, end, message)
                .help("an end tag holds nothing but the name of the element")
                .into())
        }
    }
}

fn attribute(input: Input<'_>, tag: u32, tag_name_end: u32, start: u32) -> Checked<RawAttribute> {
    let bytes = input.bytes();
    let name = scan(&bytes[start as usize..]);
    let name_end = start + name.len;
    if name.len == 0 {
        return Err(misplaced(input, tag, tag_name_end, start, true).into());
    }
    let equals = skip_space(bytes, name_end);
    match bytes.get(equals as usize) {
        Some(b'=') => {}
        None => return Err(unclosed(input, tag, tag_name_end)),
        Some(_) => {
            if let Some(one) = slips::colon(input, start, name_end, equals) {
                return Err(one.into());
            }
            check_name(input, start, name_end, "attribute")?;
            let name = input.slice(start, name_end);
            let message = format!("the attribute {} has no value", quoted(name));
            let one = input.fault(&codes::XML_ATTRIBUTE, start, name_end, message);
            let has_quote = matches!(bytes.get(equals as usize), Some(b'"' | b'\''));
            return Err(match has_quote {
                true => one.suggest("insert `=`", Span::new(name_end, equals).in_file(input.file), "="),
                false => one.help(format!("write {}", quoted(&format!("{name}=\"...\"")))),
            }
            .into());
        }
    }
    if !name.is_plain {
        check_name(input, start, name_end, "attribute")?;
    }
    let quote_at = skip_space(bytes, equals + 1);
    let quote = match bytes.get(quote_at as usize) {
        Some(&quote @ (b'"' | b'\'')) => quote,
        None => return Err(unclosed(input, tag, tag_name_end)),
        Some(_) => return Err(unquoted(input, start, name_end, quote_at).into()),
    };
    let end = value_end(input, start, name_end, quote_at, quote)?;
    let value = Span::new(quote_at + 1, end);
    let bytes = &bytes[start as usize..name_end as usize];
    let namespace = if bytes.starts_with(b"xmlns") && matches!(bytes.get(5), None | Some(b':')) {
        XMLNS
    } else if !name.is_plain && bytes.contains(&b':') {
        // The namespace is looked up when all declarations of the tag are known.
        u32::MAX
    } else {
        NO_NAMESPACE
    };
    Ok(RawAttribute { start, name_len: name_end - start, value, namespace })
}

/// Where the closing quote is of the value whose opening quote is at `quote_at`.
fn value_end(input: Input<'_>, start: u32, name_end: u32, quote_at: u32, quote: u8) -> Checked<u32> {
    let bytes = input.bytes();
    let mut at = quote_at + 1;
    loop {
        let rest = &bytes[at as usize..];
        let Some(length) = memchr::memchr3(quote, b'<', b'&', rest) else {
            let message = format!("the value of {} is never closed", quoted(input.slice(start, name_end)));
            return Err(input.ended(&codes::XML_UNCLOSED, quote_at, quote_at + 1, message));
        };
        at += length as u32;
        match bytes[at as usize] {
            b'&' => at = reference::check(input, at)?,
            b'<' => {
                if let Some(curly) = curly::closing(input, quote_at, at) {
                    return Err(curly.into());
                }
                let name = input.slice(start, name_end);
                return Err(slips::open_value(input, name, quote_at, at).into());
            }
            _ => return Ok(at),
        }
    }
}

/// Two attributes of one name. Two names of one namespace are for later, when prefixes are known.
fn check_unique(input: Input<'_>, attributes: &[RawAttribute]) -> Checked<()> {
    let name = |one: &RawAttribute| input.slice(one.start, one.start + one.name_len);
    if attributes.len() <= FEW {
        for (index, one) in attributes.iter().enumerate() {
            let same = |other: &&RawAttribute| other.name_len == one.name_len && name(other) == name(one);
            if let Some(first) = attributes[..index].iter().find(same) {
                return Err(duplicate(input, first, one, None).into());
            }
        }
        return Ok(());
    }
    let mut seen = HashMap::with_capacity(attributes.len());
    for one in attributes {
        if let Some(first) = seen.insert(name(one), one) {
            return Err(duplicate(input, first, one, None).into());
        }
    }
    Ok(())
}

/// The diagnostic for the second of two attributes that are the same.
pub(super) fn duplicate(
    input: Input<'_>,
    first: &RawAttribute,
    second: &RawAttribute,
    namespace: Option<&str>,
) -> Diagnostic {
    let span = |one: &RawAttribute| Span::new(one.start, one.start + one.name_len);
    let here = span(second);
    let name = quoted(input.slice(here.start, here.end));
    let message = match namespace {
        None => format!("the attribute {name} is given twice"),
        Some(uri) => format!("the attribute {name} is given twice: both prefixes are of {}", quoted(uri)),
    };
    let behind = attribute_with_space(input, second);
    input
        .fault(&codes::XML_DUPLICATE_ATTRIBUTE, here.start, here.end, message)
        .label(span(first).in_file(input.file), "first given here")
        .suggest(format!("remove the second {name}"), behind.in_file(input.file), "")
}

fn attribute_with_space(input: Input<'_>, one: &RawAttribute) -> Span {
    let before = &input.text[..one.start as usize];
    Span::new(before.trim_end_matches([' ', '\t', '\r', '\n']).len() as u32, one.value.end + 1)
}

fn check_name(input: Input<'_>, start: u32, end: u32, what: &str) -> Checked<()> {
    let name = input.slice(start, end);
    if is_qualified_name(name) {
        return Ok(());
    }
    if let Some(one) = slips::odd_space(input, start, name, what) {
        return Err(one.into());
    }
    let message = format!("{} is no name for an {what}", quoted(name));
    let help = if name.contains(':') {
        "a name has at most one colon, with a prefix before and a name behind it"
    } else {
        "a name starts with a letter or `_` and goes on with letters, digits, `-`, `_` and `.`"
    };
    Err(input.fault(&codes::XML_NAME, start, end, message).help(help).into())
}

fn nameless(input: Input<'_>, start: u32) -> Diagnostic {
    let message = match input.bytes().get(start as usize + 1) {
        Some(_) => {
            format!("{} cannot follow `<`: the name of an element is expected", found(input, start + 1))
        }
        None => "the file ends behind `<`".to_owned(),
    };
    let location = Span::new(start, start + 1).in_file(input.file);
    input
        .fault(&codes::XML_NAME, start, start + 1, message)
        .help("write `&lt;` for the character itself")
        .suggest("replace `<` with `&lt;`", location, "&lt;")
}

fn misplaced(input: Input<'_>, tag: u32, name_end: u32, at: u32, in_attributes: bool) -> Diagnostic {
    let name = quoted(input.slice(tag + 1, name_end));
    let what = found(input, at);
    let end = input.character_end(at);
    let next = input.bytes()[at as usize];
    if in_attributes && name_length(&[next]) == 1 {
        // What looks like two attributes may be a value that a curly quote does not close.
        let quote = char::from(input.bytes()[at as usize - 1]);
        let opened = input.slice(tag, at - 1).rfind(quote).map(|length| tag + length as u32);
        if let Some(curly) = opened.and_then(|opened| curly::closing(input, opened, at - 1)) {
            return curly;
        }
        if let Some(open) = opened.and_then(|opened| slips::open_before(input, opened, at - 1)) {
            return open;
        }
        let message = "white space is missing between two attributes";
        let location = Span::empty(at).in_file(input.file);
        return input.fault(&codes::XML_ATTRIBUTE, at, end, message).suggest("insert a blank", location, " ");
    }
    if next == b'<' {
        let message = format!("the start tag of {name} is not closed before the next `<`");
        let location = Span::new(tag + 1, name_end).in_file(input.file);
        return input
            .fault(&codes::XML_UNCLOSED, at, end, message)
            .label(location, "this tag is open")
            .help("close it with `>` or `/>`");
    }
    let message = format!("{what} is misplaced in the start tag of {name}");
    let one = input.fault(&codes::XML_SYNTAX, at, end, message);
    if matches!(next, b',' | b';') {
        let has_space = input.bytes().get(end as usize).is_some_and(u8::is_ascii_whitespace);
        let place = Span::new(at, end).in_file(input.file);
        return one.suggest(format!("remove {what}"), place, if has_space { "" } else { " " });
    }
    one.help("attributes are written `name=\"value\"`; the tag ends with `>` or `/>`")
}

fn unquoted(input: Input<'_>, start: u32, name_end: u32, at: u32) -> Diagnostic {
    let name = quoted(input.slice(start, name_end));
    let rest = &input.text[at as usize..];
    let stop = |c: char| matches!(c, ' ' | '\t' | '\r' | '\n' | '>' | '<' | '"' | '\'' | '/' | '&');
    let length = rest.find(stop).unwrap_or(rest.len()) as u32;
    let message = format!("the value of {name} is not in quotes");
    if let Some(curly) = curly::around(input, at) {
        return curly;
    }
    if length == 0 {
        return input.fault(&codes::XML_ATTRIBUTE, at, input.character_end(at), message);
    }
    let word = input.slice(at, at + length);
    input.fault(&codes::XML_ATTRIBUTE, at, at + length, message).suggest(
        "put it in quotes",
        Span::new(at, at + length).in_file(input.file),
        format!("\"{word}\""),
    )
}

fn unclosed(input: Input<'_>, start: u32, name_end: u32) -> super::fault::Fault {
    let name = quoted(input.slice(start + 1, name_end));
    input.ended(&codes::XML_UNCLOSED, start + 1, name_end, format!("the start tag of {name} is never closed"))
}

/// The character at a byte, for a message.
fn found(input: Input<'_>, at: u32) -> String {
    match input.text[at as usize..].chars().next() {
        Some(' ' | '\t' | '\r' | '\n') => "white space".to_owned(),
        Some(character) => quoted(character.encode_utf8(&mut [0; 4])),
        None => "the end of the file".to_owned(),
    }
}

fn skip_space(bytes: &[u8], at: u32) -> u32 {
    let rest = &bytes[at as usize..];
    let space = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t' | b'\r' | b'\n'));
    at + space.count() as u32
}
