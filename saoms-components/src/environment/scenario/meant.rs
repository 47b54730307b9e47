//! What is probably meant by a wrong word of a line.
//!
//! A proposal is made only where the line is read further with it: applying it never leads to the same fault again.

use std::ops::Range;

use super::vocabulary::Vocabulary;
use super::{Before, event, line};
use crate::text::TextFault;

/// Words of other ways to say it, each with the word of a scenario.
const OTHER_WORDS: &[(&str, &str)] = &[
    ("->", "to"),
    ("=>", "to"),
    ("→", "to"),
    ("into", "to"),
    ("-", "to"),
    ("–", "to"),
    ("—", "to"),
    (",", " to"),
    ("till", "until"),
    ("package", "luggage"),
    ("parcel", "luggage"),
    ("baggage", "luggage"),
    ("bag", "luggage"),
    ("box", "luggage"),
    ("item", "luggage"),
    ("job", "luggage"),
    ("task", "luggage"),
    ("order", "luggage"),
    ("goto", "visit"),
    ("go", "visit"),
    ("arrival", "landing"),
    ("departure", "takeoff"),
    ("take-off", "takeoff"),
    ("break", "breakdown"),
    ("breaks", "breakdown"),
    ("fault", "breakdown"),
    ("fail", "breakdown"),
    ("failure", "breakdown"),
    ("lost", "gone"),
    ("remove", "gone"),
    ("removed", "gone"),
    ("stop", "end"),
    ("any", "random"),
    ("anywhere", "random"),
    ("*", "random"),
    ("?", "random"),
    ("//", "#"),
    ("--", "#"),
    ("and", ";"),
    (",", ";"),
    ("from", ""),
    (".", ""),
    ("one", "1"),
    ("once", "1 times"),
    ("two", "2"),
    ("twice", "2 times"),
    ("three", "3"),
    ("four", "4"),
    ("five", "5"),
    ("six", "6"),
    ("seven", "7"),
    ("eight", "8"),
    ("nine", "9"),
    ("ten", "10"),
];

/// The fault with a proposal, if it has none and one makes sense.
pub(super) fn proposed(
    text: &str,
    part: &str,
    (before, vocabulary): (Before, Vocabulary<'_>),
    fault: TextFault,
) -> TextFault {
    let start = crate::text::bytes(text, part).start;
    let Some(bytes) = within(&fault.bytes, start, part.len()).filter(|_| fault.instead.is_none()) else { return fault };
    let (word, behind) = (&part[bytes.clone()], &part[bytes.end..]);
    // `Some(true)` for a line that is right then, `None` for one that is no better.
    let leads_on = |meant: &String| {
        let is_comment = meant.starts_with('#');
        // A comment hides the rest, and what follows a `;` is another line.
        let end = meant.find(['#', ';']);
        let (meant, rest) = end.map_or((meant.as_str(), behind), |end| (&meant[..end], ""));
        let changed = format!("{}{meant}{rest}", &part[..bytes.start]);
        match line::read_line(&changed, &changed, before, vocabulary) {
            _ if changed.trim().is_empty() => is_comment.then_some(true),
            Ok(_) => Some(true),
            Err(next) => {
                let is_further = next.bytes.start > bytes.start && next.bytes.start >= bytes.start + meant.len();
                is_further.then_some(false)
            }
        }
    };
    let all = candidates(word, behind.split_whitespace().next());
    let mut better = all.into_iter().filter_map(|meant| Some((leads_on(&meant)?, meant)));
    let first = better.next();
    let meant = match first {
        Some((false, first)) => Some(better.find(|(is_right, _)| *is_right).map_or(first, |(_, meant)| meant)),
        right => right.map(|(_, meant)| meant),
    };
    match meant {
        Some(meant) => fault.instead(Some(meant)),
        None => match moved(part, bytes.start).filter(|line| line::read_line(line, line, before, vocabulary).is_ok()) {
            Some(line) => fault.help(format!("write it before the event: `{line}`")),
            None => fault,
        },
    }
}

/// The line with how often it happens, which stands behind the event from this byte on, before the event.
fn moved(part: &str, from: usize) -> Option<String> {
    let (head, often) = (part[..from].trim(), part[from..].trim());
    let is_repeated = often.starts_with("every ") || often.contains(" every ");
    if !is_repeated && !often.ends_with(" times") {
        return None;
    }
    let event = event::KINDS.iter().find_map(|kind| head.find(&format!(" {kind} ")))?;
    let start = match head[..event].strip_prefix("at ").filter(|_| is_repeated) {
        Some(time) => format!("from {time}"),
        None => head[..event].to_owned(),
    };
    // `every` comes before `times`.
    let often = match often.split_once(" every ").filter(|(times, _)| times.ends_with(" times")) {
        Some((times, every)) => format!("every {every} {times}"),
        None => often.to_owned(),
    };
    Some(format!("{start} {often}{}", &head[event..]))
}

/// The byte range within a part of the text, if it is a word of it.
fn within(bytes: &Range<usize>, start: usize, length: usize) -> Option<Range<usize>> {
    let range = bytes.start.checked_sub(start)?..bytes.end.checked_sub(start)?;
    (range.end <= length && !range.is_empty()).then_some(range)
}

/// What may be meant by a word, which `next` follows.
fn candidates(word: &str, next: Option<&str>) -> Vec<String> {
    let others = OTHER_WORDS.iter().filter(|(other, _)| other.eq_ignore_ascii_case(word));
    let others = others.map(|(_, meant)| (*meant).to_owned());
    let ended = word.trim_end_matches([',', ':', '.', ';']);
    let ended = (ended.len() < word.len() && !ended.is_empty()).then(|| ended.to_owned());
    let divided = ended.as_ref().filter(|_| next.is_some_and(|next| line::STARTS.contains(&next)));
    let divided = divided.map(|ended| format!("{ended};"));
    let counted = word.strip_suffix(['x', '×', '*']).filter(|number| is_number(number));
    let counted = counted.map(|number| format!("{number} times"));
    let repeated = next.filter(|_| word == "every").map(|time| format!("from {time} every"));
    let line = line::STARTS.contains(&word).then(|| format!("; {word}"));
    let decimal = word.contains(',').then(|| word.replacen(',', ".", 1));
    let ranges = ["-", "–", "."].iter().filter_map(|sign| word.split_once(sign));
    let ranges = ranges.map(|(least, most)| format!("{least}..{most}"));
    let target = word.starts_with('(').then(|| format!("to {word}"));
    let all = [divided, ended, counted, repeated, line, target, decimal].into_iter().flatten();
    others.chain(all).chain(blocks(word)).chain(ranges).filter(|meant| meant != word).collect()
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// The block that a word means: in other brackets, with another sign between its numbers, or without its end.
fn blocks(word: &str) -> Vec<String> {
    let block = |text: &str| {
        let (x, y) =
            text.trim_matches(['(', '[', '{', ')', ']', '}', ',', '.']).split_once([',', ';', ':', '/', '.'])?;
        let (x, y) = (x.trim(), y.trim());
        (is_number(x) && is_number(y)).then(|| format!("({x},{y})"))
    };
    let (first, rest) = word.split_at(word.find([' ', '\t']).unwrap_or(word.len()));
    let unended = block(first).map(|block| format!("{block}{rest}"));
    block(word).into_iter().chain(unended).collect()
}
