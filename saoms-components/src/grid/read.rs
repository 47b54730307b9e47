use std::fmt;

use super::{Block, Map};

/// Why a text is no map: in which row, what was found, what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapError {
    /// The line of the map's text, from 1, blank lines counted.
    pub line: usize,
    /// What was found, and what was expected.
    pub message: String,
}

impl fmt::Display for MapError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "line {}: {}", self.line, self.message)
    }
}

impl std::error::Error for MapError {}

/// The header of a map file, as far as it was read.
#[derive(Default)]
struct Header {
    width: Option<u32>,
    height: Option<u32>,
    ended: bool,
}

impl Map {
    /// Reads a map: one line a row, the first is y = 0, with `.`, `G`, `E` and `S` free and `@`, `O`, `T` and `W` blocked. The header of
    /// the MovingAI format (`type octile`, `height H`, `width W`, `map`) may stand before the rows, with or without its first line.
    ///
    /// The format is that of Nathan Sturtevant, "Benchmarks for Grid-Based Pathfinding" (2012); `E` and `S` are the stations of the League
    /// of Robot Runners' maps.
    ///
    /// ```
    /// use saoms_components::grid::{Block, Map};
    ///
    /// let map = Map::read("height 2\nwidth 3\nmap\n..@\n...").unwrap();
    /// assert!(map.is_free(Block::new(2, 1)) && !map.is_free(Block::new(2, 0)));
    /// ```
    ///
    /// # Errors
    /// The first line that does not fit.
    pub fn read(text: &str) -> Result<Map, MapError> {
        let mut header = Header::default();
        let mut rows: Vec<(usize, &str)> = Vec::new();
        for (number, line) in text.lines().enumerate().map(|(at, line)| (at + 1, line.trim())) {
            if line.is_empty() || (rows.is_empty() && header.take(number, line)?) {
                continue;
            }
            rows.push((number, line));
        }
        let last = text.lines().count().max(1);
        let error = |line: usize, message: String| Err(MapError { line, message });
        let Some((first, row)) = rows.first().copied() else {
            return error(last, "found no rows, expected one line of `.` and `@` a row".to_owned());
        };
        let width = header.width.map_or(row.len(), |width| width as usize);
        let height = header.height.map_or(rows.len(), |height| height as usize);
        let longest = Map::LONGEST as usize;
        if width > longest || height > longest {
            return error(
                first,
                format!("found {width} x {height} blocks, expected at most {longest} on a side"),
            );
        }
        if rows.len() != height {
            let (line, _) = rows.get(height).or(rows.last()).copied().unwrap_or((last, ""));
            return error(line, format!("found {} rows, expected the {height} of the header", rows.len()));
        }
        #[expect(clippy::cast_possible_truncation, reason = "both are at most `LONGEST`")]
        let mut map = Map::new(width as u32, height as u32);
        for (y, (line, row)) in (0..).zip(rows) {
            map.read_row(y, row, width).map_err(|message| MapError { line, message })?;
        }
        Ok(map)
    }

    fn read_row(&mut self, y: i32, row: &str, width: usize) -> Result<(), String> {
        let found = row.chars().count();
        if found != width {
            return Err(format!("found {found} blocks, expected {width} as in the other rows"));
        }
        for (x, sign) in (0..).zip(row.chars()) {
            match sign {
                '.' | 'G' | 'E' | 'S' => {}
                '@' | 'O' | 'T' | 'W' => {
                    self.set_blocked(Block::new(x, y));
                }
                other => {
                    return Err(format!(
                        "found `{other}`, expected `.` for a free block or `@` for a blocked one"
                    ));
                }
            }
        }
        Ok(())
    }
}

impl Header {
    /// Takes a line of the header; `false` when it is none.
    fn take(&mut self, number: usize, line: &str) -> Result<bool, MapError> {
        if self.ended {
            return Ok(false);
        }
        let mut words = line.split_whitespace();
        let (word, value) = (words.next().unwrap_or_default(), words.next());
        let side = || {
            let side = value.and_then(|value| value.parse().ok()).filter(|side| *side > 0);
            let found = value.unwrap_or("nothing");
            let message = format!("found {found} after `{word}`, expected a number of blocks");
            side.ok_or(MapError { line: number, message })
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
