//! Rewriting of the expectations in a composite.

use super::Found;
use super::comments::{Comment, comments, lines, plain};

/// Placement of the comments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Placement {
    /// After their diagnostic, at the first place where a comment is allowed.
    Behind,
    /// At the end, otherwise at the start of the text: for texts that are not XML.
    End,
    Start,
}

impl Placement {
    pub(super) const ALL: [Self; 3] = [Self::Behind, Self::End, Self::Start];
}

/// The text with a comment for each diagnostic that was found, and no other expectations.
pub(super) fn rewritten(text: &str, found: &[Found], placement: Placement) -> String {
    let (bare, removed) = without_comments(text);
    let bare_line = |line: u32| line - removed.iter().filter(|gone| **gone < line).count() as u32;
    let last = lines(&bare) + u32::from(!bare.ends_with('\n'));
    let safe = safe_lines(&bare);
    // Line after which each comment is written, sorted.
    let mut placed: Vec<(u32, u32, &Found)> = found
        .iter()
        .map(|one| {
            let line = bare_line(one.line).min(last.max(1));
            let behind = match placement {
                Placement::Behind => safe.iter().copied().find(|safe| *safe >= line).unwrap_or(last),
                Placement::End => last,
                Placement::Start => u32::from(bare.starts_with("<?xml")),
            };
            (behind, line, one)
        })
        .collect();
    placed.sort_by_key(|(behind, line, _)| (*behind, *line));
    let mut out = String::with_capacity(text.len());
    let mut next = placed.iter().enumerate().peekable();
    let mut put = |out: &mut String, number: u32, indent: &str| {
        while let Some((place, (_, line, one))) = next.next_if(|(_, (behind, ..))| *behind == number) {
            if !out.is_empty() && !out.ends_with('\n') {
                out.push('\n');
            }
            // Comments before the line move it down as well.
            let own = number + place as u32 + 1;
            let about = line + placed.iter().filter(|(behind, ..)| behind < line).count() as u32;
            let arrow = match own.abs_diff(about) {
                1 => String::new(),
                distance => distance.to_string(),
            };
            let arrow = if about < own { format!("^{arrow}") } else { format!("v{arrow}") };
            let message = format!("{} {} {}", one.severity, one.code, plain(&one.message));
            out.push_str(&format!("{indent}<!--~{arrow} {} -->\n", message.trim_end()));
        }
    };
    put(&mut out, 0, "");
    for (number, line) in (1..).zip(bare.split_inclusive('\n')) {
        out.push_str(line);
        let indent = &line[..line.len() - line.trim_start_matches([' ', '\t']).len()];
        put(&mut out, number, indent);
    }
    out
}

/// The text without its expectations, and the lines that are removed with them.
fn without_comments(text: &str) -> (String, Vec<u32>) {
    let (mut bare, mut removed, mut at) = (String::with_capacity(text.len()), Vec::new(), 0);
    for Comment { at: comment, .. } in comments(text) {
        let start = text[..comment.start].rfind('\n').map_or(0, |end| end + 1);
        let end = text[comment.end..].find('\n').map_or(text.len(), |end| comment.end + end + 1);
        let is_alone = text[start..comment.start].trim().is_empty() && text[comment.end..end].trim().is_empty();
        if is_alone && start >= at {
            bare.push_str(&text[at..start]);
            let first = lines(&text[..start]) + 1;
            removed.extend(first..first + lines(&text[start..end]));
            at = end;
        } else {
            bare.push_str(text[at..comment.start].trim_end_matches([' ', '\t']));
            at = comment.end;
        }
    }
    bare.push_str(&text[at..]);
    (bare, removed)
}

/// Lines after which a comment is allowed: between tags, where the text is blank.
fn safe_lines(text: &str) -> Vec<u32> {
    let (mut safe, mut line, mut rest) = (Vec::new(), 1, text);
    loop {
        let until = rest.find('<').unwrap_or(rest.len());
        let (blank, markup) = rest.split_at(until);
        let is_blank = blank.trim().is_empty();
        for _ in 0..lines(blank) {
            safe.extend(is_blank.then_some(line));
            line += 1;
        }
        if markup.is_empty() {
            safe.extend(is_blank.then_some(line));
            return safe;
        }
        let end = match markup {
            _ if markup.starts_with("<!--") => markup.find("-->").map(|end| end + 3),
            _ if markup.starts_with("<![CDATA[") => markup.find("]]>").map(|end| end + 3),
            _ if markup.starts_with("<?") => markup.find("?>").map(|end| end + 2),
            _ => end_of_tag(markup),
        };
        let Some(end) = end else { return safe };
        line += lines(&markup[..end]);
        rest = &markup[end..];
    }
}

/// Position after the `>` that ends a tag, outside of quotes.
fn end_of_tag(tag: &str) -> Option<usize> {
    let mut quote = None;
    for (at, byte) in tag.bytes().enumerate() {
        match (quote, byte) {
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'>') => return Some(at + 1),
            (Some(open), byte) if open == byte => quote = None,
            _ => {}
        }
    }
    None
}
