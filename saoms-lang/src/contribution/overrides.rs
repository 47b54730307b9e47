//! Tables of what differs from one replica to another: comma-separated values (RFC 4180).

use std::collections::HashMap;

use crate::diagnostic::{Diagnostic, Diagnostics, codes, nearest, quoted};
use crate::model::{Row, Table};
use crate::source::{FileId, Location, Sources, Span, Text};

/// The columns that can say which replica a line is about.
const KEYS: [&str; 2] = ["index", "name"];

/// Reads a table. What is wrong with it is reported at its line and column. `None` where it has no columns; otherwise
/// all that can be understood, so that what is wrong with names and values is found together with a line that is too
/// long.
pub fn table(file: FileId, sources: &Sources, diagnostics: &mut Diagnostics) -> Option<Table> {
    let text = sources.get(file).text();
    if let Some(fault) = conflict(file, text).or_else(|| separator(file, text)).or_else(|| separated(file, text)) {
        diagnostics.push(fault);
        return None;
    }
    let mut lines = lines(file, text, diagnostics);
    without_comments(&mut lines, diagnostics);
    surplus(&mut lines, diagnostics);
    let mut lines = lines.into_iter();
    let Some(mut head) = lines.next().map(Vec::into_iter) else {
        let one = Diagnostic::new(&codes::OVERRIDES, Span::empty(0).in_file(file), "the table is empty");
        diagnostics.push(one.help("write a first line that names the columns: `index` or `name`, then properties"));
        return None;
    };
    let mut key = head.next()?;
    if key.parse::<i64>().is_ok() {
        let message = format!("the first line has the value {}, expected the names of the columns", quoted(&key));
        let one = Diagnostic::new(&codes::OVERRIDES, key.location, message);
        diagnostics.push(one.help("write a line such as `index,period` before it: `index` or `name`, then properties"));
        return None;
    }
    let report = |at: Location, message: String| Diagnostic::new(&codes::OVERRIDES, at, message);
    if !KEYS.contains(&key.as_str()) {
        let one = report(key.location, format!("the first column is {}, expected `index` or `name`", quoted(&key)));
        let moved = head.as_slice().iter().find(|column| KEYS.contains(&column.as_str()));
        diagnostics.push(match nearest(&key, KEYS) {
            _ if let Some(moved) = moved => {
                one.help(format!("move the column {} to the front of each line", quoted(moved)))
            }
            Some(meant) => one.suggest(format!("replace it with {}", quoted(meant)), key.location, meant),
            None => one.help("the first column names the replica of a row; the other columns are properties"),
        });
        // As the lines look.
        let has_number = lines.as_slice().first().and_then(|line| line.first()?.parse::<i64>().ok()).is_some();
        let near = nearest(&key, KEYS);
        if moved.is_some() || near.is_none() && !has_number {
            // Nobody knows what they are about, or whether this is a table at all.
            lines = Vec::new().into_iter();
        }
        key.value = near.unwrap_or(KEYS[usize::from(!has_number)]).into();
    }
    let properties: Vec<Text> = head.collect();
    let mut first: HashMap<&str, Location> = HashMap::new();
    let mut is_usable = vec![true; properties.len()];
    for (name, is_usable) in properties.iter().zip(&mut is_usable) {
        if name.is_empty() {
            *is_usable = false;
            let one = report(name.location, "a column without a name".to_owned());
            diagnostics.push(one.help("write a property name in the first line of each column"));
        } else if let Some(first) = first.insert(name, name.location) {
            *is_usable = false;
            let one = report(name.location, format!("there are two columns {}", quoted(name)));
            diagnostics.push(one.label(first, "the first").help("merge them"));
        }
    }
    let mut rows = Vec::new();
    for line in lines {
        let count = line.len();
        let mut cells = line.into_iter();
        let Some(of) = cells.next() else { continue };
        let mut values: Vec<Option<Text>> = cells.by_ref().take(properties.len()).map(given).collect();
        if count != properties.len() + 1 {
            // Which of its values belongs to which column is not known.
            let at = cells.next().map_or(of.location, |beyond| beyond.location);
            let (values, columns) = (many(count, "value"), many(properties.len() + 1, "column"));
            let one = report(at, format!("this line has {values}, but the table has {columns}"));
            diagnostics.push(one.help(match (of.contains([';', '\t']), count > properties.len()) {
                (true, _) => "separate the values with commas",
                (_, true) => "write a value that contains a comma between two `\"`",
                _ => "write an empty value, with its comma, for each property that the replica does not change",
            }));
            if !of.contains([';', '\t']) {
                rows.push(Row { key: of, values: vec![None; properties.len()] });
            }
            continue;
        }
        let unusable = values.iter_mut().zip(&is_usable).filter(|(_, is_usable)| !**is_usable);
        unusable.for_each(|(value, _)| *value = None);
        rows.push(Row { key: of, values });
    }
    Some(Table { file, key, properties, rows })
}

/// Removes the lines that are meant as comments, and reports the first of them. In a table of names a later line may be
/// about a component whose name begins so.
fn without_comments(lines: &mut Vec<Vec<Text>>, diagnostics: &mut Diagnostics) {
    let is_comment = |line: &[Text]| line.first().is_some_and(|first| first.starts_with('#'));
    let head = lines.iter().position(|line| !is_comment(line)).unwrap_or(lines.len());
    let is_of_names = lines.get(head).and_then(|line| line.first()).is_some_and(|key| *key == *"name");
    let (mut place, mut first) = (0, None);
    lines.retain(|line| {
        let is_meant = is_comment(line) && (place < head || !is_of_names);
        place += 1;
        if is_meant && first.is_none() {
            first = line.first().map(|cell| cell.location);
        }
        !is_meant
    });
    if let Some(at) = first {
        let one = Diagnostic::new(&codes::OVERRIDES, at, "a line that begins with `#`: tables have no comments");
        diagnostics.push(one.help("remove the line, or write what it says into a comment of the composite"));
    }
}

/// Removes the empty columns behind the last one with a name, as spreadsheets write them, and reports them.
fn surplus(lines: &mut [Vec<Text>], diagnostics: &mut Diagnostics) {
    let Some(head) = lines.first() else { return };
    let named = head.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
    let is_empty = |line: &Vec<Text>| line.iter().skip(named).all(|cell| cell.is_empty());
    let Some(first) = head.get(named).filter(|_| lines.iter().all(is_empty)) else { return };
    let message = match head.len() - named {
        1 => "a column without a name, in which nothing is".to_owned(),
        more => format!("{more} columns without a name, in which nothing is"),
    };
    let one = Diagnostic::new(&codes::OVERRIDES, first.location, message);
    diagnostics.push(one.help("remove the commas at the end of each line"));
    lines.iter_mut().for_each(|line| line.truncate(named));
}

/// The fault of a table whose first line tells a spreadsheet the separator.
fn separator(file: FileId, text: &str) -> Option<Diagnostic> {
    let start = text.len() - text.trim_start_matches('\u{feff}').len();
    let line = text[start..].lines().next().filter(|line| line.to_ascii_lowercase().starts_with("sep="))?;
    let behind =
        text[start + line.len()..].find(|c| !matches!(c, '\r' | '\n')).unwrap_or(text.len() - start - line.len());
    let whole = Span::new(start as u32, (start + line.len() + behind) as u32).in_file(file);
    let message = "this line tells a spreadsheet the separator of the values, which is a comma here";
    let one = Diagnostic::new(&codes::OVERRIDES, Text::part_of(file, text, line).location, message);
    Some(one.suggest("remove this line", whole, ""))
}

/// The fault of a table with the marks of git around two versions of its lines.
fn conflict(file: FileId, text: &str) -> Option<Diagnostic> {
    let line = text.lines().find(|line| line.starts_with("<<<<<<< "))?;
    let message = "conflict markers of git, with two versions of these lines";
    let one = Diagnostic::new(&codes::OVERRIDES, Text::part_of(file, text, line).location, message);
    Some(one.help("keep one version, and remove the lines with `<<<<<<<`, `=======` and `>>>>>>>`"))
}

/// The fault of a table whose first line has another separator than commas, as some spreadsheets write them.
fn separated(file: FileId, text: &str) -> Option<Diagnostic> {
    let start = text.len() - text.trim_start_matches('\u{feff}').trim_start().len();
    let head = text[start..].lines().next()?;
    let (at, separator) = head.match_indices([';', '\t', '|']).next().filter(|_| !head.contains(','))?;
    let first = head[..at].trim().trim_matches('"');
    nearest(first, KEYS)?;
    let shown = if separator == "\t" { "tabs".to_owned() } else { quoted(separator) };
    let place = Span::new((start + at) as u32, (start + at + separator.len()) as u32).in_file(file);
    let message = format!("the values of this table are separated by {shown}, expected commas");
    let one = Diagnostic::new(&codes::OVERRIDES, place, message);
    Some(one.help("save it as comma-separated values; write a value that contains a comma between two `\"`"))
}

fn many(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// An empty value is none.
fn given(cell: Text) -> Option<Text> {
    (!cell.is_empty()).then_some(cell)
}

/// The values of all lines that are not empty.
fn lines(file: FileId, text: &str, diagnostics: &mut Diagnostics) -> Vec<Vec<Text>> {
    let mut lines = Vec::new();
    let mut line = Vec::new();
    let mut at = text.len() - text.trim_start_matches('\u{feff}').len();
    while at < text.len() {
        let known = diagnostics.len();
        let (cell, end) = cell(file, text, at, diagnostics);
        line.push(cell);
        at = end;
        if diagnostics.len() > known && at == text.len() {
            // What is behind a `"` without an end is no line of its own.
            return lines;
        }
        if text[at..].starts_with(',') {
            at += 1;
            // A comma at the end of the file is followed by an empty value.
            if at < text.len() {
                continue;
            }
            line.push(Text::new("".into(), Span::empty(at as u32).in_file(file)));
        }
        at += text[at..].chars().next().map_or(0, char::len_utf8);
        let whole = std::mem::take(&mut line);
        if whole.iter().any(|cell| !cell.is_empty()) {
            lines.push(whole);
        }
    }
    lines
}

/// The value at a place, and where the comma or the end of the line behind it is.
fn cell(file: FileId, text: &str, at: usize, diagnostics: &mut Diagnostics) -> (Text, usize) {
    let is_end = |c: char| matches!(c, ',' | '\n' | '\r');
    let end_of = |from: usize| text[from..].find(is_end).map_or(text.len(), |length| from + length);
    let end = end_of(at);
    let plain = Text::part_of(file, text, &text[at..end]);
    if !plain.starts_with('"') {
        return (plain, end);
    }
    let start = plain.location.span.start as usize;
    let mut value = String::new();
    let mut inside = start + 1;
    loop {
        let Some(length) = text[inside..].find('"') else {
            let place = Span::new(start as u32, start as u32 + 1).in_file(file);
            let one = Diagnostic::new(&codes::OVERRIDES, place, "a `\"` without a closing `\"`");
            diagnostics.push(one.help("write a `\"` inside a quoted value twice"));
            return (Text::new("".into(), place), text.len());
        };
        value.push_str(&text[inside..inside + length]);
        inside += length + 1;
        if !text[inside..].starts_with('"') {
            break;
        }
        value.push('"');
        inside += 1;
    }
    let end = end_of(inside);
    let behind = Text::part_of(file, text, &text[inside..end]);
    if !behind.is_empty() {
        let message = format!("{} after a closing `\"`", quoted(&behind));
        let one = Diagnostic::new(&codes::OVERRIDES, behind.location, message);
        diagnostics.push(one.help("write a `\"` inside a quoted value twice"));
    }
    let span = Span::new(start as u32 + 1, inside as u32 - 1).in_file(file);
    (Text::new(value.trim().into(), span), end)
}
