//! Declarations, instructions, comments and what else starts with `<?` or `<!`.

use super::fault::{Checked, Fault, Input};
use super::names::{is_local_name, name_length};
use super::slips;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::Span;

/// Checks the processing instruction from `start` to `end`, or the XML declaration when it is at `first`.
pub(super) fn instruction(input: Input<'_>, start: u32, end: u32, first: u32) -> Checked<()> {
    let inside = input.slice(start + 2, end - 2);
    let name_len = name_length(inside.as_bytes());
    let (name, rest) = inside.split_at(name_len);
    let name_end = start + 2 + name_len as u32;
    if name == "xml" {
        if start != first {
            let before = input.text[first as usize..start as usize].trim();
            let message = "the XML declaration stands at the very start of a file, and only there";
            let mut one = input.fault(&codes::XML_DECLARATION, start, end, message);
            if before.is_empty() {
                let gap = Span::new(first, start).in_file(input.file);
                one = one.suggest("remove what is before it", gap, "");
            }
            return Err(one.into());
        }
        return declaration(input, start + 5, end - 2);
    }
    if name.eq_ignore_ascii_case("xml") {
        let message = format!("{} is reserved: an instruction cannot have this name", quoted(name));
        return Err(input.fault(&codes::XML_DECLARATION, start + 2, name_end, message).into());
    }
    if !is_local_name(name) || !(rest.is_empty() || rest.starts_with(is_space)) {
        let message = "a processing instruction is `<?`, a name, white space, anything, and `?>`";
        let shown = name_end.max(start + 2);
        return Err(input.fault(&codes::XML_NAME, start, shown, message).into());
    }
    Ok(())
}

/// Checks the comment from `start` to `end`.
pub(super) fn comment(input: Input<'_>, start: u32, end: u32) -> Checked<()> {
    let inside = input.slice(start + 4, end - 3);
    let at = inside.find("--").or_else(|| inside.ends_with('-').then(|| inside.len() - 1));
    let Some(at) = at else { return Ok(()) };
    let at = start + 4 + at as u32;
    let edits = slips::dashes(inside, start + 4, input);
    let one = input
        .fault(&codes::XML_SYNTAX, at, at + 2, "`--` inside a comment")
        .label(Span::new(start, start + 4).in_file(input.file), "the comment starts here")
        .help("XML allows `--` only in the `-->` that ends the comment");
    Err(if edits.is_empty() { one } else { one.suggest_edits("write single dashes", edits) }.into())
}

/// The fault in markup at `start` that quick-xml could not read to its end.
pub(super) fn broken(input: Input<'_>, start: u32) -> Fault {
    let rest = &input.text[start as usize..];
    let unclosed = |len: u32, what: &str| {
        input.ended(&codes::XML_UNCLOSED, start, start + len, format!("this {what} is never closed"))
    };
    if starts_doctype(rest) {
        return doctype(input, start, start + 9).into();
    }
    if rest.starts_with("<!--") {
        return unclosed(4, "comment");
    }
    if rest.starts_with("<![CDATA[") {
        return unclosed(9, "CDATA section");
    }
    if rest.starts_with("<?") {
        return unclosed(2, "processing instruction");
    }
    let whole = ["<!--", "<![CDATA[", "<!DOCTYPE"];
    if whole.iter().any(|markup| markup.starts_with(rest)) {
        return unclosed(rest.len() as u32, "markup");
    }
    let message = "`<!` starts a comment (`<!--`) or a CDATA section (`<![CDATA[`), and nothing else here";
    input.fault(&codes::XML_SYNTAX, start, start + 2, message).into()
}

/// The refusal of a document type declaration.
pub(super) fn doctype(input: Input<'_>, start: u32, end: u32) -> Diagnostic {
    input
        .fault(&codes::XML_DOCTYPE, start, end, "a document type declaration is not allowed here")
        .help("remove it; a composite needs no DTD, and entities beyond the five predefined ones are refused")
}

/// Whether it starts a document type declaration, in whatever case.
pub(super) fn starts_doctype(text: &str) -> bool {
    text.get(..9).is_some_and(|start| start.eq_ignore_ascii_case("<!DOCTYPE"))
}

/// Checks what is between `<?xml` and `?>`: version, then encoding, then standalone.
fn declaration(input: Input<'_>, start: u32, end: u32) -> Checked<()> {
    let help = "as in `<?xml version=\"1.0\" encoding=\"UTF-8\"?>`";
    let fault = |from: u32, to: u32, message: String| {
        Fault::from(input.fault(&codes::XML_DECLARATION, from, to, message).help(help))
    };
    let mut at = start;
    let mut expected: &[&str] = &["version", "encoding", "standalone"];
    loop {
        let text = input.slice(at, end);
        let trimmed = text.trim_start_matches(is_space);
        if trimmed.is_empty() {
            break;
        }
        let item = at + (text.len() - trimmed.len()) as u32;
        let Some((name_len, value, len)) = pseudo_attribute(trimmed) else {
            return Err(fault(
                item,
                end,
                "this is no declaration of version, encoding or standalone".to_owned(),
            ));
        };
        let name = &trimmed[..name_len];
        let position = expected.iter().position(|known| *known == name);
        let (Some(position), true) = (position, item > at) else {
            let message = format!("{} is misplaced in the XML declaration", quoted(name));
            return Err(fault(item, item + name_len as u32, message));
        };
        if expected.len() == 3 && position > 0 {
            break;
        }
        expected = &expected[position + 1..];
        let ok = match name {
            "version" => value.strip_prefix("1.").is_some_and(|minor| !minor.is_empty() && all_digits(minor)),
            "encoding" => is_encoding_name(value),
            _ => matches!(value, "yes" | "no"),
        };
        if !ok {
            let value_end = item + len as u32 - 1;
            let message = format!("{} is no value of {name} in an XML declaration", quoted(value));
            return Err(fault(value_end - value.len() as u32, value_end, message));
        }
        at = item + len as u32;
    }
    if expected.len() == 3 {
        return Err(fault(start - 3, start, "an XML declaration starts with its version".to_owned()));
    }
    Ok(())
}

/// `name = "value"` at the start of `text`: the name's length, the value, and the length of it all.
fn pseudo_attribute(text: &str) -> Option<(usize, &str, usize)> {
    let name_len = name_length(text.as_bytes());
    let rest = text[name_len..].trim_start_matches(is_space).strip_prefix('=')?;
    let rest = rest.trim_start_matches(is_space);
    let quote = rest.chars().next().filter(|quote| matches!(quote, '"' | '\''))?;
    let (value, after) = rest[1..].split_once(quote)?;
    Some((name_len, value, text.len() - after.len()))
}

fn all_digits(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit())
}

fn is_encoding_name(text: &str) -> bool {
    text.starts_with(|first: char| first.is_ascii_alphabetic())
        && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'_' | b'-'))
}

fn is_space(character: char) -> bool {
    matches!(character, ' ' | '\t' | '\r' | '\n')
}
