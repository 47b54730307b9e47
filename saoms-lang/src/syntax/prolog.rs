//! Checks of declarations, instructions, comments and of what else starts with `<?` or `<!`.

use super::characters::{is_local_name, name_length};
use super::document::TokenKind;
use super::fault::Input;
use super::unseen::looks_like;
use super::value::is_space;
use crate::diagnostic::{Diagnostic, Edit, codes, quoted};
use crate::limits::SUGGESTED_EDITS;

/// The fault of the processing instruction from `start` to `end`, or of the XML declaration.
pub(super) fn instruction(input: Input<'_>, start: u32, end: u32) -> Option<Diagnostic> {
    let first = if input.text.starts_with('\u{feff}') { 3 } else { 0 };
    let inside = input.slice(start + 2, end - 2);
    let name_len = name_length(inside.as_bytes());
    let (name, rest) = inside.split_at(name_len);
    let name_end = start + 2 + name_len as u32;
    if name == "xml" {
        if start == first {
            return declaration(input, start + 5, end - 2);
        }
        let message = "the XML declaration is not at the very start of the file";
        let one = input.fault(&codes::XML_DECLARATION, start, end, message);
        let before = input.slice(first, start);
        // That there is text before the root element is reported.
        if before.contains(|sign: char| !is_space(sign)) && !before.contains('<') {
            return None;
        }
        if !before.trim().is_empty() {
            return Some(one);
        }
        let gap = input.at(first, start);
        return Some(one.suggest("remove what is before it", gap, ""));
    }
    if name.eq_ignore_ascii_case("xml") {
        let message = format!("{} is reserved: an instruction cannot have this name", quoted(name));
        return Some(input.fault(&codes::XML_DECLARATION, start + 2, name_end, message));
    }
    if is_local_name(name) && (rest.is_empty() || rest.starts_with(is_space)) {
        return None;
    }
    let message = "a processing instruction is `<?`, a name, white space, anything, and `?>`";
    Some(input.fault(&codes::XML_NAME, start, name_end.max(start + 2), message))
}

/// The fault of the comment from `start` to `end`.
pub(super) fn comment(input: Input<'_>, start: u32, end: u32) -> Option<Diagnostic> {
    let inside = input.slice(start + 4, end - 3);
    let at = inside.find("--").or_else(|| inside.ends_with('-').then(|| inside.len() - 1))?;
    let at = start + 4 + at as u32;
    let edits = single_dashes(inside, start + 4, input);
    let one = input
        .fault(&codes::XML_SYNTAX, at, at + 2, "`--` inside a comment")
        .label(input.at(start, start + 4), "the comment starts here")
        .help("XML allows `--` only in the `-->` that ends the comment");
    Some(if edits.is_empty() { one } else { one.suggest_edits("write single dashes", edits) })
}

/// One `-` in place of each `--` of a comment, unless there are very many.
fn single_dashes(inside: &str, start: u32, input: Input<'_>) -> Vec<Edit> {
    let mut edits = Vec::new();
    let mut at = 0;
    while let Some(length) = inside[at..].find('-') {
        let from = at + length;
        at = from + inside[from..].bytes().take_while(|byte| *byte == b'-').count();
        let replacement = if at == inside.len() { "" } else { "-" };
        if at - from > 1 || replacement.is_empty() {
            let place = input.at(start + from as u32, start + at as u32);
            edits.push(Edit { location: place, replacement: replacement.to_owned() });
            if edits.len() > SUGGESTED_EDITS {
                return Vec::new();
            }
        }
    }
    edits
}

/// Markup that starts with `<!` or `<?`, by its start, with its name in messages.
const MARKUP: [(&str, TokenKind, &str); 3] = [
    ("<!--", TokenKind::Comment, "comment"),
    ("<![CDATA[", TokenKind::Section, "CDATA section"),
    ("<?", TokenKind::Instruction, "processing instruction"),
];

/// The kind of such markup; that of its start alone is known at the end of a text, too.
pub(super) fn kind(rest: &str) -> Option<TokenKind> {
    if starts_doctype(rest) {
        return Some(TokenKind::Doctype);
    }
    let found = MARKUP.into_iter().find(|(start, ..)| rest.starts_with(start) || start.starts_with(rest));
    found.map(|(_, kind, _)| kind)
}

/// The fault of markup at `start` that quick-xml cannot read to its end.
pub(super) fn broken(input: Input<'_>, start: u32) -> Diagnostic {
    let rest = &input.text[start as usize..];
    let unclosed = |len: usize, what: &str| {
        let one = input.ended(&codes::XML_UNCLOSED, start, start + len as u32, format!("this {what} has no end"));
        one.help("close it: until then, the rest of the file belongs to it and is not checked")
    };
    if starts_doctype(rest) {
        return doctype(input, start, start + 9);
    }
    if let Some((start, _, what)) = MARKUP.into_iter().find(|(start, ..)| rest.starts_with(start)) {
        return unclosed(start.len(), what);
    }
    if kind(rest).is_some() || "<!DOCTYPE".starts_with(rest) {
        return unclosed(rest.len(), "markup");
    }
    let message = "`<!` starts a comment (`<!--`) or a CDATA section (`<![CDATA[`), and nothing else here";
    input.fault(&codes::XML_SYNTAX, start, start + 2, message)
}

/// The refusal of a document type declaration.
pub(super) fn doctype(input: Input<'_>, start: u32, end: u32) -> Diagnostic {
    input
        .fault(&codes::XML_DOCTYPE, start, end, "a document type declaration is not allowed here")
        .help("remove it; a composite needs no DTD, and entities beyond the five predefined ones are refused")
}

/// True if the text starts with a document type declaration, in whatever case.
pub(super) fn starts_doctype(text: &str) -> bool {
    text.get(..9).is_some_and(|start| start.eq_ignore_ascii_case("<!DOCTYPE"))
}

/// The fault of what is between `<?xml` and `?>`: version, then encoding, then standalone.
fn declaration(input: Input<'_>, start: u32, end: u32) -> Option<Diagnostic> {
    let help = "as in `<?xml version=\"1.0\" encoding=\"UTF-8\"?>`";
    let fault =
        |from: u32, to: u32, message: String| Some(input.fault(&codes::XML_DECLARATION, from, to, message).help(help));
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
            let one = fault(item, end, "expected `version`, `encoding` or `standalone` here".to_owned());
            let meant: String = trimmed.chars().map(|sign| looks_like(sign).unwrap_or(sign)).collect();
            let is_better = meant != trimmed && pseudo_attribute(&meant).is_some();
            return one.map(|one| match is_better {
                true => one.suggest(format!("replace it with {}", quoted(&meant)), input.at(item, end), meant),
                false => one,
            });
        };
        let name = &trimmed[..name_len];
        let position = expected.iter().position(|known| *known == name);
        let (Some(position), true) = (position, item > at) else {
            let message = format!("{} is misplaced in the XML declaration", quoted(name));
            return fault(item, item + name_len as u32, message);
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
            let message = format!("{} is not a value of {name} in an XML declaration", quoted(value));
            return fault(value_end - value.len() as u32, value_end, message);
        }
        at = item + len as u32;
    }
    if expected.len() == 3 {
        return fault(start - 3, start, "the XML declaration must start with `version`".to_owned());
    }
    None
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
