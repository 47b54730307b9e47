//! Faults of tags, with what is probably meant.

use super::attribute::RawAttribute;
use super::characters::{is_qualified_name, name_length};
use super::fault::Input;
use super::unseen::is_unseen;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::source::Span;

/// The quotes of word processors and web pages.
const CURLY: [char; 9] =
    ['\u{201c}', '\u{201d}', '\u{201e}', '\u{201f}', '\u{2018}', '\u{2019}', '\u{201a}', '\u{ab}', '\u{bb}'];

impl Input<'_> {
    /// The character at a byte, for a message.
    pub(super) fn shown(self, at: u32) -> String {
        match self.text[at as usize..].chars().next() {
            Some(' ' | '\t' | '\r' | '\n') => "white space".to_owned(),
            Some(character) => quoted(character.encode_utf8(&mut [0; 4])),
            None => "the end of the file".to_owned(),
        }
    }
}

/// The marks of git around two versions of the same lines, of which the first starts at `start`: the fault, the end of
/// the first mark, and the part with the second version; behind everything where there is none.
pub(super) fn conflict(input: Input<'_>, start: u32) -> Option<(Diagnostic, u32, (u32, u32))> {
    let rest = &input.text[start as usize..];
    let is_line = start == 0 || input.byte(start - 1) == Some(b'\n');
    rest.strip_prefix("<<<<<<< ").filter(|_| is_line)?;
    let place = |mark: &str, from: usize| rest[from..].find(mark).map(|at| from + at + 1);
    let line_end = |from: usize| input.find(b'\n', start + from as u32).unwrap_or(input.len());
    let one = input
        .fault(&codes::XML_SYNTAX, start, line_end(0), "conflict markers of git, with two versions of these lines")
        .help("keep one version, and remove the lines with `<<<<<<<`, `=======` and `>>>>>>>`");
    let second = place("\n=======", 0).and_then(|middle| Some((middle, place("\n>>>>>>>", middle)?)));
    let Some((middle, last)) = second else { return Some((one, line_end(0), (u32::MAX, u32::MAX))) };
    let at = start + middle as u32;
    Some((one.label(input.at(at, line_end(middle)), "the other version"), line_end(0), (at, line_end(last))))
}

/// The fault of a `<` without a name behind it; `name` is where one begins after blanks.
pub(super) fn nameless(input: Input<'_>, start: u32, name: Option<u32>) -> Diagnostic {
    let message = match input.byte(start + 1) {
        Some(_) => {
            format!("{} cannot follow `<`: the name of an element is expected", input.shown(start + 1))
        }
        None => "the file ends after `<`".to_owned(),
    };
    if let Some(name) = name {
        let one = input.fault(&codes::XML_NAME, start, start + 1, message);
        return one.suggest("remove the white space", input.at(start + 1, name), "");
    }
    input
        .fault(&codes::XML_NAME, start, start + 1, message)
        .help("write `&lt;` for the character itself")
        .mend("replace `<` with `&lt;`", "&lt;")
}

/// The fault of a `\` before the `>` of a start tag, where `/` is meant.
pub(super) fn backslash(input: Input<'_>, at: u32) -> Diagnostic {
    let message = "a tag without content ends with `/>`, not with `\\>`";
    input.fault(&codes::XML_SYNTAX, at, at + 1, message).mend("replace `\\` with `/`", "/")
}

/// The fault of a name that is none; `what` it is of.
pub(super) fn bad_name(input: Input<'_>, start: u32, end: u32, what: &str) -> Option<Diagnostic> {
    let name = input.slice(start, end);
    if is_qualified_name(name) && !name.contains(is_unseen) {
        return None;
    }
    if let Some((length, odd)) = odd_space(name) {
        let at = start + length as u32;
        let end = at + odd.len_utf8() as u32;
        let code = u32::from(odd);
        let kind = if odd.is_whitespace() { "a blank" } else { "nothing" };
        // Behind the name of an element, an attribute may begin.
        let is_attribute = what == "element" && input.byte(input.skip_space(start + name.len() as u32)) == Some(b'=');
        let meant = if odd.is_whitespace() || is_attribute { " " } else { "" };
        let message = format!("U+{code:04X}, which looks like {kind}, in the name of an {what}");
        let one = input.fault(&codes::XML_NAME, at, end, message);
        let description = if meant.is_empty() { "remove it" } else { "replace it with a blank" };
        return Some(one.mend(description, meant));
    }
    let message = format!("{} is not a valid name for an {what}", quoted(name));
    let help = if name.contains(':') {
        "use at most one colon: a prefix, the colon, a name"
    } else {
        "start the name with a letter or `_`, and use only letters, digits, `-`, `_` and `.`"
    };
    Some(input.fault(&codes::XML_NAME, start, end, message).help(help))
}

/// The first character of a name that looks like a blank, or like nothing, and where it is.
pub(super) fn odd_space(name: &str) -> Option<(usize, char)> {
    name.char_indices().find(|(_, c)| c.is_whitespace() || is_unseen(*c))
}

/// The fault of a start tag, of the element at `name`, whose `>` is missing at `at`, before the text of the element.
pub(super) fn text_in_tag(input: Input<'_>, name: Span, at: u32) -> Diagnostic {
    let shown = quoted(input.piece(name));
    let message = format!("the start tag of {shown} has no `>` before the text");
    let one = input.fault(&codes::XML_UNCLOSED, name.start, name.end, message);
    let place = input.at(at, at);
    one.label(place, "the tag ends here").suggest("insert `>`", place, ">")
}

/// The quote that closes a value with its first character at `at`, where the opening quote is missing or misplaced:
/// nothing before it ends the value, and the tag continues behind it.
pub(super) fn first_quote(input: Input<'_>, at: u32) -> Option<u32> {
    let is_end = |byte: &u8| matches!(byte, b'"' | b'\'' | b'<' | b'>' | b'=' | b' ' | b'\t' | b'\r' | b'\n');
    let end = at + input.bytes()[at as usize..].iter().position(is_end)? as u32;
    let is_quote = matches!(input.byte(end), Some(b'"' | b'\''));
    let goes_on = matches!(input.byte(end + 1), Some(b' ' | b'\t' | b'\r' | b'\n' | b'/' | b'>'));
    (is_quote && goes_on).then_some(end)
}

/// The fault of a value from `at` to `end` without its first quote.
pub(super) fn without_first_quote(input: Input<'_>, one: &RawAttribute, at: u32, end: u32) -> Diagnostic {
    let name = quoted(input.slice(one.start, one.start + one.name_len));
    let quote = input.slice(end, end + 1);
    let message = format!("the value of {name} has no quote before it");
    let fault = input.fault(&codes::XML_ATTRIBUTE, at, end, message);
    let place = input.at(at, at);
    fault.suggest(format!("insert {}", quoted(quote)), place, quote)
}

/// The fault of the second of two quotes, at `at`.
pub(super) fn doubled_quote(input: Input<'_>, at: u32) -> Diagnostic {
    let shown = input.shown(at);
    let one = input.fault(&codes::XML_ATTRIBUTE, at, at + 1, format!("{shown} is written twice here"));
    one.mend(format!("remove {shown}"), "")
}

/// The fault of a value at `at` in the quotes of a word processor; also the value inside, and where it ends.
pub(super) fn curly_quotes(input: Input<'_>, at: u32) -> Option<(Diagnostic, Span, u32)> {
    let text = &input.text[at as usize..];
    let first = text.chars().next().filter(|first| CURLY.contains(first))?;
    let inside = &text[first.len_utf8()..];
    let length = inside.find([CURLY.as_slice(), &['"', '\'', '<', '>', '\n']].concat().as_slice())?;
    let last = inside[length..].chars().next()?;
    let is_closed = CURLY.contains(&last) || matches!(last, '"' | '\'');
    let end = at + (first.len_utf8() + length + if is_closed { last.len_utf8() } else { 0 }) as u32;
    let shown = quoted(first.encode_utf8(&mut [0; 4]));
    let message = format!("{shown} is not a quote of XML: write values between two `\"`");
    let one = input.fault(&codes::XML_ATTRIBUTE, at, end, message);
    let straight = format!("\"{}\"", &inside[..length]);
    let start = at + first.len_utf8() as u32;
    let value = Span::new(start, start + length as u32);
    Some((one.mend(format!("replace it with {}", quoted(&straight)), straight), value, end))
}

/// The fault of a value that starts with a straight quote and is closed by one of a word processor before `end`; also
/// where that is.
pub(super) fn closing_quote(input: Input<'_>, quote_at: u32, end: u32) -> Option<(Diagnostic, Span)> {
    let value = input.slice(quote_at + 1, end);
    let (length, found) = value.char_indices().find(|(_, c)| CURLY.contains(c))?;
    let at = quote_at + 1 + length as u32;
    let end = at + found.len_utf8() as u32;
    let shown = quoted(found.encode_utf8(&mut [0; 4]));
    let straight = input.slice(quote_at, quote_at + 1);
    let message = format!("{shown} does not close a value that starts with {}", quoted(straight));
    let one = input.fault(&codes::XML_ATTRIBUTE, at, end, message);
    let one = one.label(input.at(quote_at, quote_at + 1), "the value starts here");
    Some((one.mend(format!("replace {shown} with {}", quoted(straight)), straight), Span::new(at, end)))
}

/// The fault of an attribute without a value; with a quote at `quote_at`, it lacks a `=` alone.
pub(super) fn without_value(input: Input<'_>, start: u32, name_end: u32, quote_at: Option<u32>) -> Diagnostic {
    let name = input.slice(start, name_end);
    let message = format!("the attribute {} has no value", quoted(name));
    let one = input.fault(&codes::XML_ATTRIBUTE, start, name_end, message);
    match quote_at {
        Some(at) => one.suggest("insert `=`", input.at(name_end, at), "="),
        None => one.help(format!("write {}", quoted(&format!("{name}=\"...\"")))),
    }
}

/// The fault of `name: "value"`, as other languages write it.
pub(super) fn colon(input: Input<'_>, start: u32, name_end: u32, next: u32) -> Option<Diagnostic> {
    let name = input.slice(start, name_end).strip_suffix(':').filter(|name| !name.is_empty())?;
    if !matches!(input.byte(next), Some(b'"' | b'\'')) {
        return None;
    }
    let message = format!("found `:` between {} and its value, expected `=`", quoted(name));
    let one = input.fault(&codes::XML_ATTRIBUTE, name_end - 1, name_end, message);
    let place = input.at(name_end - 1, next);
    Some(one.suggest("replace `:` with `=`", place, "="))
}

/// The fault of a value without quotes at `at`, and how long the value is.
pub(super) fn unquoted(input: Input<'_>, one: &RawAttribute, at: u32) -> (Diagnostic, u32) {
    let name = quoted(input.slice(one.start, one.start + one.name_len));
    let rest = &input.text[at as usize..];
    let stop = |c: char| matches!(c, ' ' | '\t' | '\r' | '\n' | '>' | '<' | '"' | '\'' | '/' | '&');
    let length = rest.find(stop).unwrap_or(rest.len()) as u32;
    let message = format!("the value of {name} is not in quotes");
    if length == 0 {
        return (input.fault(&codes::XML_ATTRIBUTE, at, input.character_end(at), message), 0);
    }
    let word = input.slice(at, at + length);
    let fault = input.fault(&codes::XML_ATTRIBUTE, at, at + length, message);
    (fault.mend("put it in quotes", format!("\"{word}\"")), length)
}

/// The fault of a value that is open at a `<`: its quote is missing before the end of the tag, or the character is
/// meant.
pub(super) fn open_value(input: Input<'_>, name: &str, quote_at: u32, at: u32) -> Diagnostic {
    let name = quoted(name);
    let (quote, value) = (input.slice(quote_at, quote_at + 1), input.slice(quote_at + 1, at));
    if let Some(length) = value.find('>') {
        let inside = &value[..length];
        let inside = inside.strip_suffix('/').unwrap_or(inside).trim_end();
        let end = quote_at + 1 + inside.len() as u32;
        let message = format!("the value of {name} has no closing quote");
        let one = input.fault(&codes::XML_ATTRIBUTE, quote_at, end, message);
        let one = one.label(input.at(at, at + 1), "`<` is not allowed in a value");
        let other = inside.ends_with(['"', '\'']);
        let place = input.at(end - u32::from(other), end);
        let description = match other {
            true => format!("replace {} with {}", quoted(&inside[inside.len() - 1..]), quoted(quote)),
            false => format!("close it with {}", quoted(quote)),
        };
        return one.suggest(description, place, quote);
    }
    let message = format!("`<` in the value of {name}");
    let one = input
        .fault(&codes::XML_ATTRIBUTE, at, at + 1, message)
        .label(input.at(quote_at, quote_at + 1), "the value starts here");
    if closed_behind(input, quote_at, at).is_some() {
        return one.mend("replace `<` with `&lt;`", "&lt;");
    }
    one.help("add the closing quote before it, or write `&lt;` for the character itself")
}

/// The end of a value with a `<` at `at`, if that surely is its quote.
pub(super) fn closed_behind(input: Input<'_>, quote_at: u32, at: u32) -> Option<u32> {
    if input.slice(quote_at, at).contains('>') {
        return None;
    }
    let quote = input.byte(quote_at)?;
    let behind = &input.text[at as usize + 1..];
    let length = memchr::memchr3(quote, b'<', b'>', behind.as_bytes())?;
    // `a="<b c="d"`: the quote found is that of an attribute of the next tag.
    let before = behind[..length].trim_end().strip_suffix('=').map(str::trim_end);
    let is_of_next = before.is_some_and(|tag| ends_with_attribute_name(tag) && name_length(tag.as_bytes()) > 0);
    (behind.as_bytes()[length] == quote && !is_of_next).then_some(at + 1 + length as u32)
}

/// True if a name stands behind white space at the end of a text.
fn ends_with_attribute_name(text: &str) -> bool {
    let name = text.rsplit_once([' ', '\t', '\r', '\n']).map_or("", |(_, name)| name);
    !name.is_empty() && name_length(name.as_bytes()) == name.len()
}

/// The end of a value without a closing quote, the place where its tag continues, and true if it surely ends there.
pub(super) fn value_end(input: Input<'_>, quote_at: u32) -> (u32, u32, bool) {
    let start = quote_at + 1;
    let rest = &input.text[start as usize..];
    let mut length = 0;
    let mut found = None;
    while let Some(next) = memchr::memchr3(b'\n', b'>', b'<', &rest.as_bytes()[length..]) {
        length += next;
        let byte = rest.as_bytes()[length];
        let is_tag = rest[length + 1..].starts_with(|c: char| c.is_alphabetic() || matches!(c, '_' | '/' | '!' | '?'));
        if byte != b'<' || is_tag {
            found = Some(byte);
            break;
        }
        length += 1;
    }
    let line = if found.is_some() { &rest[..length] } else { rest };
    let line = line.strip_suffix('/').filter(|_| found == Some(b'>')).unwrap_or(line).trim_end();
    // A quote of the other kind was to close it.
    let value = line.strip_suffix(['"', '\'']).unwrap_or(line);
    let start_of = |text: &str| start + text.len() as u32;
    (start_of(value), start_of(line), found == Some(b'>'))
}

/// The fault of a value that is closed by the quote at `end`, with which the next attribute starts: `a="b c="d"`. Also
/// where the value should end.
pub(super) fn open_before(input: Input<'_>, quote_at: u32, end: u32) -> Option<(Diagnostic, u32)> {
    let value = input.slice(quote_at + 1, end);
    let next = value.strip_suffix('=')?;
    if !ends_with_attribute_name(next) {
        return None;
    }
    let (before, name) = next.rsplit_once([' ', '\t', '\r', '\n'])?;
    let before = before.trim_end();
    let end = quote_at + 1 + before.len() as u32;
    let message = format!("this value has no closing quote before {}", quoted(name));
    let one = input.fault(&codes::XML_ATTRIBUTE, quote_at, end, message);
    let quote = input.slice(quote_at, quote_at + 1);
    let place = input.at(end, end);
    Some((one.suggest(format!("close it with {}", quoted(quote)), place, quote), end))
}

/// The fault of the second of two attributes that are the same, in the namespace `uri`.
pub(super) fn duplicate(input: Input<'_>, first: &RawAttribute, second: &RawAttribute, uri: &str) -> Diagnostic {
    let here = second.name_span();
    let name = quoted(input.piece(here));
    let there = first.name_span();
    let message = match input.piece(there) == input.piece(here) {
        true => format!("the attribute {name} is given twice"),
        false => format!("the attribute {name} is given twice: both prefixes are of {}", quoted(uri)),
    };
    let before = input.slice(0, second.start).trim_end_matches([' ', '\t', '\r', '\n']).len() as u32;
    input
        .fault(&codes::XML_DUPLICATE_ATTRIBUTE, here.start, here.end, message)
        .label(there.in_file(input.file), "first given here")
        .suggest(format!("remove the second {name}"), input.at(before, second.end()), "")
}
