use std::collections::BTreeMap;
use std::ops::Range;

use super::{Block, Map};
use crate::text::{TextFault, bytes};

/// Maximum number of wrong lines, after which reading stops.
const MOST_WRONG: usize = 1000;

/// The signs of blocks: four of free ones, and four of blocked ones.
const SIGNS: &str = ".GES@OTW";

/// The header of a map file as read so far: the sides and their places in the text.
#[derive(Default)]
struct Header<'a> {
    width: Option<(u32, &'a str)>,
    height: Option<(u32, &'a str)>,
    ended: bool,
}

/// Rows that somebody drew with blanks for their blocks: as many of them as the other rows are long.
struct BlankRows {
    /// Length of the first row with signs of a map, without and with the blanks behind it.
    lengths: [usize; 2],
}

impl BlankRows {
    fn of(text: &str) -> BlankRows {
        let is_row = |line: &&str| line.trim().starts_with(|sign| SIGNS.contains(sign));
        let first = text.lines().find(is_row).unwrap_or_default();
        BlankRows { lengths: [first.trim_end(), first].map(|line| line.chars().count()) }
    }

    fn have(&self, line: &str) -> bool {
        !line.is_empty() && line.trim().is_empty() && self.lengths.contains(&line.chars().count())
    }

    /// The fault of all of them. White space of another length is layout, and so is what follows the last line end: the
    /// indentation of an end tag.
    fn fault(&self, text: &str) -> Option<TextFault> {
        let lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
        let mut blank = lines.map(|line| line.trim_end_matches(['\n', '\r'])).filter(|line| self.have(line));
        let first = blank.next()?;
        let also = match blank.count() {
            0 => String::new(),
            more => format!(" (in this row and {more} more)"),
        };
        let message =
            format!("found a row of blanks, expected `.` for each free block or `@` for each blocked one{also}");
        Some(
            TextFault::of(text, first, message).help("write `....` for four free blocks, `@@@@` for four blocked ones"),
        )
    }
}

/// The fault of a text that is no map, but a scenario, a table or XML: all its lines have one cause.
fn other(text: &str) -> Option<TextFault> {
    let head = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'))?;
    let is_event = ["at ", "from ", "then "].iter().any(|start| head.starts_with(start));
    let what = match head {
        _ if is_event => "a scenario",
        _ if head.starts_with("index,") || head.starts_with("name,") => "a table",
        _ if head.starts_with('<') => "XML",
        _ => return None,
    };
    let fault = TextFault::of(text, head, format!("this is {what}, expected a map with one row of `.` and `@` a line"));
    Some(fault.help(match what {
        "a table" => "name the table with `saoms:overrides`",
        "XML" => "`..@@..` is a row with two blocked blocks",
        _ => "a scenario is the property `scenario` of a `saoms.Environment`",
    }))
}

impl Map {
    /// Reads a map: one line for each row, starting with y = 0. `.`, `G`, `E` and `S` are free; `@`, `O`, `T` and `W`
    /// are blocked. The header of the MovingAI format (`type octile`, `height H`, `width W`, `map`) may stand before
    /// the rows, with or without its first line.
    ///
    /// The format is that of Nathan Sturtevant, "Benchmarks for Grid-Based Pathfinding" (2012); `E` and `S` are the
    /// stations of the League of Robot Runners' maps.
    ///
    /// ```
    /// use saoms_components::grid::{Block, Map};
    ///
    /// let map = Map::read("height 2\nwidth 3\nmap\n..@\n...").unwrap();
    /// assert!(map.is_free(Block::new(2, 1)) && !map.is_free(Block::new(2, 0)));
    ///
    /// let faults = Map::read("..@\n.x.\n....").unwrap_err();
    /// assert_eq!(faults[0].message, "found 4 blocks in this row, expected 3 as in the others");
    /// assert_eq!(faults[1].bytes, 5..6);
    /// ```
    ///
    /// # Errors
    /// The lines that do not fit, at most a thousand.
    pub fn read(text: &str) -> Result<Map, Vec<TextFault>> {
        if let Some(fault) = TextFault::of_file_name(text) {
            return Err(vec![fault]);
        }
        if let Some(fault) = other(text) {
            return Err(vec![fault]);
        }
        let (mut header, mut faults) = (Header::default(), Vec::new());
        let mut rows: Vec<&str> = Vec::new();
        // The last empty line behind a row: only at the end of a map it means nothing.
        let mut empty: Option<&str> = None;
        let blank_rows = BlankRows::of(text);
        for line in text.lines() {
            let (whole, line) = (line, line.trim());
            if faults.len() >= MOST_WRONG {
                break;
            }
            if line.is_empty() {
                empty = Some(line).filter(|_| !rows.is_empty() && !blank_rows.have(whole));
                continue;
            }
            if let Some(empty) = empty.take() {
                let message = format!("found an empty line after row {}, expected the next row", rows.len() - 1);
                faults.push(TextFault::of(text, empty, message));
            }
            match header.take(line) {
                _ if !rows.is_empty() => rows.push(line),
                Ok(true) => {}
                Ok(false) => rows.push(line),
                Err((part, message)) => faults.push(TextFault::of(text, part, message)),
            }
        }
        let blank = blank_rows.fault(text);
        // The header may count them: one mistake.
        let counts_blank = blank.is_some();
        faults.extend(blank);
        let Some(first) = rows.first().copied() else {
            faults.push(TextFault::new(0..text.len(), "found no rows, expected one line of `.` and `@` a row"));
            return Err(faults);
        };
        let width = header.width.map_or_else(|| usual_length(&rows), |(width, _)| width as usize);
        let height = header.height.map_or(rows.len(), |(height, _)| height as usize);
        let longest = Map::LONGEST as usize;
        if width > longest || height > longest {
            let message = format!("found {width} x {height} blocks, expected at most {longest} on a side");
            let side = if width > longest { header.width } else { header.height };
            faults.push(TextFault::of(text, side.map_or(first, |(_, side)| side), message));
            return Err(faults);
        }
        if let Some((_, side)) = header.height.filter(|_| rows.len() != height && !counts_blank) {
            let message = format!("found {} rows, expected the {height} of the header", rows.len());
            let beyond = rows.get(height).map_or(bytes(text, side), |row| bytes(text, row));
            faults.push(TextFault::new(beyond, message));
        }
        #[expect(clippy::cast_possible_truncation, reason = "both are at most `LONGEST`")]
        let mut map = Map::new(width as u32, height as u32);
        let (mut unknown, mut lengths) = (Vec::new(), Vec::new());
        let width_said = header.width.map(|(width, _)| width);
        for (y, row) in (0..).zip(rows) {
            if faults.len() + unknown.len() + lengths.len() >= MOST_WRONG {
                break;
            }
            match map.read_row(y, row, width, width_said) {
                Ok(None) => {}
                Ok(Some(sign)) => unknown.push(sign),
                Err(wrong) => lengths.push(wrong),
            }
        }
        if let Some((row, message)) = lengths.first() {
            // They have one cause.
            let also = (lengths.len() > 1).then(|| format!(" (and in {} more)", lengths.len() - 1));
            faults.push(TextFault::of(text, row, format!("{message}{}", also.unwrap_or_default())));
        }
        faults.extend(unknown_signs(text, &unknown));
        if faults.is_empty() { Ok(map) } else { Err(faults) }
    }

    /// Byte range of a block in the text of a map for [`read`](Map::read).
    pub(crate) fn written(text: &str, block: Block) -> Option<Range<usize>> {
        let mut header = Header::default();
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        let mut rows = lines.skip_while(|line| header.take(line).unwrap_or(true));
        let row = rows.nth(usize::try_from(block.y).ok()?)?;
        let (start, sign) = row.char_indices().nth(usize::try_from(block.x).ok()?)?;
        Some(bytes(text, &row[start..start + sign.len_utf8()]))
    }

    /// Reads a row up to its first unknown sign, which is returned.
    fn read_row<'a>(
        &mut self,
        y: i32,
        row: &'a str,
        width: usize,
        said: Option<u32>,
    ) -> Result<Option<&'a str>, (&'a str, String)> {
        for (x, (start, sign)) in (0..).zip(row.char_indices()) {
            match sign {
                '.' | 'G' | 'E' | 'S' => {}
                '@' | 'O' | 'T' | 'W' => {
                    self.set_blocked(Block::new(x, y));
                }
                other => return Ok(Some(&row[start..start + other.len_utf8()])),
            }
        }
        let found = row.chars().count();
        if found == width {
            return Ok(None);
        }
        let whose = if said.is_some() { "in the header" } else { "in the others" };
        Err((row, format!("found {found} blocks in this row, expected {width} as {whose}")))
    }
}

/// The fault of all rows with unknown signs, of each its first: they have one cause.
fn unknown_signs(text: &str, signs: &[&str]) -> Option<TextFault> {
    let sign = *signs.first()?;
    if let Some(comment) = comment(text, sign) {
        let message = "found a comment, expected a row of `.` and `@`: a map has no comments";
        return Some(TextFault::of(text, comment, message.to_owned()).help("remove this line"));
    }
    let also = match signs.len() {
        1 => String::new(),
        rows => format!(" (in this row and {} more)", rows - 1),
    };
    let message = format!("found `{sign}`, expected `.` for a free block or `@` for a blocked one{also}");
    let fault = TextFault::of(text, sign, message);
    let meant = match sign {
        "#" | "X" | "x" | "*" | "1" => "@",
        "0" | "_" | "-" => ".",
        _ => return Some(fault),
    };
    Some(match text.matches(sign).count() {
        1 => fault.instead(Some(meant)),
        _ => fault.help(format!("replace each `{sign}` with `{meant}`")),
    })
}

/// The line of a sign if it is a comment, as other files have them: it begins with the sign, and has words.
fn comment<'t>(text: &'t str, sign: &str) -> Option<&'t str> {
    let before = &text[..bytes(text, sign).start];
    let line = text[before.rfind('\n').map_or(0, |end| end + 1)..].lines().next()?.trim();
    let is_word = |sign: char| sign.is_alphabetic() && !"GESOTWXx".contains(sign) || sign == ' ';
    let starts = ["#", "//", ";", "<!--"].iter().any(|start| line.starts_with(start));
    (starts && line.contains(is_word)).then_some(line)
}

/// The most frequent length of a row; of equally frequent ones the first.
fn usual_length(rows: &[&str]) -> usize {
    let mut counts: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
    for (place, row) in rows.iter().enumerate() {
        counts.entry(row.chars().count()).or_insert((0, rows.len() - place)).0 += 1;
    }
    counts.into_iter().max_by_key(|(_, rank)| *rank).map_or(0, |(length, _)| length)
}

impl<'a> Header<'a> {
    /// Takes a line of the header; `false` if it belongs to the rows.
    fn take(&mut self, line: &'a str) -> Result<bool, (&'a str, String)> {
        if self.ended {
            return Ok(false);
        }
        let mut words = line.split_whitespace();
        let (word, value) = (words.next().unwrap_or_default(), words.next());
        let side = || {
            let side = value.and_then(|value| value.parse().ok()).filter(|side| *side > 0);
            let found = value.map_or("nothing".to_owned(), |value| format!("`{value}`"));
            let message = format!("found {found} after `{word}`, expected a number of blocks");
            side.zip(value).ok_or((value.unwrap_or(line), message))
        };
        match word {
            "type" => {}
            "height" => self.height = Some(side()?),
            "width" => self.width = Some(side()?),
            "map" => self.ended = true,
            _ => return Ok(false),
        }
        Ok(true)
    }
}
