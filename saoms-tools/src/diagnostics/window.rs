//! The lines of a file that a picture shows.
//!
//! A picture costs the same in a file of 100 MB as in a small one, also when all of it is one line.

use std::ops::Range;

use saoms_api::host::Visible;

use saoms_lang::source::{LineColumn, SourceFile, Span};

/// Marks at most this many lines apart share a picture.
const TOGETHER: u32 = 12;
/// A mark over more lines than this is shown on its first line alone.
const TALLEST: u32 = 6;
/// A line of more bytes than this is cut.
const LONGEST: usize = 400;
/// The bytes of a cut line that stand before its first mark.
const BEFORE: usize = 80;

/// A place to point at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark<'a> {
    pub(super) span: Span,
    pub(super) text: &'a str,
    pub(super) is_primary: bool,
}

/// Lines of a file with marks on them.
#[derive(Debug)]
pub(super) struct Window<'a> {
    pub(super) text: String,
    pub(super) first_line: u32,
    /// The place of the first mark given, when it is not where it is in the file because its line is cut.
    pub(super) moved: Option<LineColumn>,
    /// The bytes of `text` that each mark covers.
    pub(super) marks: Vec<(Range<usize>, Mark<'a>)>,
}

/// A mark with the lines it covers.
struct Placed<'a> {
    mark: Mark<'a>,
    start: LineColumn,
    last_line: u32,
}

/// The marks, those close together in one window, windows in the order of their first marks.
pub(super) fn windows<'a>(file: &SourceFile, marks: Vec<Mark<'a>>) -> Vec<Window<'a>> {
    let mut groups: Vec<Vec<Placed<'a>>> = Vec::new();
    for mark in marks {
        let range = file.range(mark.span);
        let tall = range.end.line - range.start.line >= TALLEST;
        let last_line = if tall { range.start.line } else { range.end.line };
        let placed = Placed { mark, start: range.start, last_line };
        let near = |group: &&mut Vec<Placed<'a>>| {
            group.iter().any(|other| {
                placed.start.line <= other.last_line + TOGETHER && other.start.line <= placed.last_line + TOGETHER
            })
        };
        match groups.iter_mut().find(near) {
            Some(group) => group.push(placed),
            None => groups.push(vec![placed]),
        }
    }
    groups.into_iter().map(|group| window(file, group)).collect()
}

fn window<'a>(file: &SourceFile, group: Vec<Placed<'a>>) -> Window<'a> {
    let first_line = group.iter().map(|one| one.start.line).min().unwrap_or(1);
    let last_line = group.iter().map(|one| one.last_line).max().unwrap_or(1);
    let mut moved = None;
    let mut text = String::new();
    let mut marks: Vec<(Range<usize>, Mark<'a>)> =
        group.iter().map(|one| (Range { start: usize::MAX, end: 0 }, one.mark)).collect();
    for line in first_line..=last_line {
        let start = file.offset(LineColumn { line, column: 1 });
        let end = file.offset(LineColumn { line, column: u32::MAX });
        let shown = cut(file, Span::new(start, end), &group);
        if shown.start > start {
            moved = group.first().map(|one| one.start);
        }
        for (range, mark) in &mut marks {
            // The part of the mark on this line; an empty mark is on the line that its place is on.
            let from = boundary(file, mark.span.start, str::floor_char_boundary).clamp(shown.start, shown.end);
            let to = boundary(file, mark.span.end, str::ceil_char_boundary).clamp(shown.start, shown.end);
            if mark.span.start <= end && mark.span.end >= start {
                let at = |byte: u32| text.len() + visible(file, Span::new(shown.start, byte)).len();
                range.start = range.start.min(at(from));
                range.end = range.end.max(at(to));
            }
        }
        text.push_str(&visible(file, shown));
        if line < last_line {
            text.push('\n');
        }
    }
    for (range, _) in &mut marks {
        range.start = range.start.min(text.len());
        range.end = range.end.clamp(range.start, text.len());
    }
    Window { text, first_line, moved, marks }
}

/// A part of a line, with what would steer a terminal escaped, and without secrets.
fn visible(file: &SourceFile, part: Span) -> String {
    Visible(&*file.shown(part)).to_string()
}

/// The character boundary next to a place that may be within a character, or behind the text.
fn boundary(file: &SourceFile, at: u32, round: fn(&str, usize) -> usize) -> u32 {
    round(file.text(), at as usize).min(file.text().len()) as u32
}

/// The part of a line to show: all, or some hundred bytes around the first mark.
fn cut(file: &SourceFile, line: Span, group: &[Placed<'_>]) -> Span {
    if line.len() as usize <= LONGEST {
        return line;
    }
    let first = group.iter().map(|one| one.mark.span.start).filter(|&at| line.touches(at)).min();
    let text = &**file.text();
    let from = first.unwrap_or(line.start) as usize;
    let from = text.floor_char_boundary(from.saturating_sub(BEFORE).max(line.start as usize));
    let to = text.floor_char_boundary((from + LONGEST).min(line.end as usize));
    Span::new(from as u32, to as u32)
}
