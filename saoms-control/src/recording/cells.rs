//! What is recorded, as a table: a cell for each field of what there is to see.

use std::collections::HashMap;

use serde_json::value::RawValue;
use serde_json::{Value, json};

use super::samples::Samples;
use super::text;

/// What a cell that is empty holds.
const EMPTY: &str = "null";

/// What has fields.
#[derive(Clone, Copy, Debug)]
pub(super) enum Subject<'a> {
    /// The fleet as a whole.
    Fleet,
    /// A component, by its path.
    Component(&'a str),
    /// A message that a state topic retains.
    Message { topic: &'a str, message: &'a str, component: &'a str, key: Option<&'a str> },
}

impl Subject<'_> {
    /// A text that no other subject has.
    fn name(&self) -> String {
        match self {
            Subject::Fleet => String::new(),
            Subject::Component(path) => format!("c{path}"),
            Subject::Message { topic, component, key, .. } => {
                format!("m{topic}\n{component}\n{}", key.unwrap_or_default())
            }
        }
    }

    fn json(&self) -> Value {
        match self {
            Subject::Fleet => json!({}),
            Subject::Component(path) => json!({"component": path}),
            Subject::Message { topic, message, component, key } => {
                json!({"topic": topic, "message": message, "by": component, "key": key})
            }
        }
    }
}

/// The table, with what its cells hold at present.
#[derive(Debug)]
pub(super) struct Cells {
    rows: Vec<Row>,
    numbers: HashMap<String, usize>,
    paths: Vec<Value>,
    texts: Texts,
    changes: Vec<(u32, String)>,
    /// Number of the present sample.
    round: u64,
}

/// The cells of a subject.
#[derive(Debug)]
struct Row {
    subject: Value,
    cells: Vec<Cell>,
}

#[derive(Debug)]
struct Cell {
    path: Vec<String>,
    number: u32,
    holds: String,
    /// The sample in which its value was given last.
    seen: u64,
}

impl Cells {
    /// An empty table, whose texts have so many bytes at most.
    pub(super) fn new(most_texts: usize) -> Cells {
        Cells {
            rows: Vec::new(),
            numbers: HashMap::new(),
            paths: Vec::new(),
            texts: Texts { most: most_texts, ..Texts::default() },
            changes: Vec::new(),
            round: 1,
        }
    }

    /// The row of a subject.
    pub(super) fn row(&mut self, subject: &Subject<'_>) -> usize {
        let next = self.rows.len();
        let number = *self.numbers.entry(subject.name()).or_insert(next);
        if number == next {
            self.rows.push(Row { subject: subject.json(), cells: Vec::new() });
        }
        number
    }

    /// Says what a field of a row holds.
    pub(super) fn put(&mut self, number: usize, path: &[&str], value: &Value) {
        let Some(row) = self.rows.get_mut(number) else { return };
        let holds = self.texts.shown(value);
        let known = row.cells.iter_mut().find(|cell| cell.path == path);
        match known {
            Some(cell) => {
                cell.seen = self.round;
                if cell.holds != holds {
                    self.changes.push((cell.number, holds.clone()));
                    cell.holds = holds;
                }
            }
            None => {
                let cell = self.paths.len() as u32;
                let named: Vec<Value> = path.iter().map(|name| Value::from(*name)).collect();
                self.paths.push([vec![Value::from(number)], named].concat().into());
                if holds != EMPTY {
                    self.changes.push((cell, holds.clone()));
                }
                let path = path.iter().map(|name| (*name).to_owned()).collect();
                row.cells.push(Cell { path, number: cell, holds, seen: self.round });
            }
        }
    }

    /// Says that the fields with these first names hold what they held.
    pub(super) fn keep(&mut self, number: usize, names: &[&str]) {
        let round = self.round;
        let cells = self.rows.get_mut(number).into_iter().flat_map(|row| &mut row.cells);
        let kept = cells.filter(|cell| cell.path.first().is_some_and(|first| names.contains(&first.as_str())));
        kept.for_each(|cell| cell.seen = round);
    }

    /// Says that all fields of a row hold what they held.
    pub(super) fn keep_all(&mut self, number: usize) {
        let round = self.round;
        self.rows.get_mut(number).into_iter().flat_map(|row| &mut row.cells).for_each(|cell| cell.seen = round);
    }

    /// Forgets entries of lists to which neither samples nor cells refer any more, and numbers the others anew.
    pub(super) fn forget_texts(&mut self, samples: &mut Samples) {
        let mut renewal = Renewal::of(&mut self.texts);
        samples.rewrite(|holds| renewal.shown(holds));
        for cell in self.rows.iter_mut().flat_map(|row| &mut row.cells) {
            if let Some(holds) = renewal.shown(&cell.holds) {
                cell.holds = holds;
            }
        }
    }

    /// What differs since the last call, by the numbers of cells. Fields that were not named since hold nothing.
    pub(super) fn changes(&mut self) -> Vec<(u32, String)> {
        for row in &mut self.rows {
            for cell in row.cells.iter_mut().filter(|cell| cell.seen != self.round && cell.holds != EMPTY) {
                EMPTY.clone_into(&mut cell.holds);
                self.changes.push((cell.number, EMPTY.to_owned()));
            }
        }
        self.round += 1;
        std::mem::take(&mut self.changes)
    }

    /// All subjects.
    pub(super) fn subjects(&self) -> Value {
        self.rows.iter().map(|row| row.subject.clone()).collect()
    }

    /// The number of the subject and the name of the field of each cell.
    pub(super) fn paths(&self) -> Value {
        Value::from(self.paths.clone())
    }

    /// The entries of lists, by their numbers.
    pub(super) fn texts(&self) -> String {
        format!("[{}]", self.texts.all.join(","))
    }
}

/// Entries of lists, each once: of a long list little differs from sample to sample.
#[derive(Debug, Default)]
struct Texts {
    all: Vec<String>,
    numbers: HashMap<String, usize>,
    bytes: usize,
    most: usize,
}

impl Texts {
    /// A value as text. A list of objects is an object with the name `#`, whose entries are numbers of texts as long as
    /// there is room for these.
    fn shown(&mut self, value: &Value) -> String {
        let mut shown = String::new();
        let list = value.as_array().filter(|list| !list.is_empty() && list.iter().all(Value::is_object));
        let Some(list) = list else {
            text::write(value, &mut shown);
            return shown;
        };
        let entries: Vec<String> = list.iter().map(|entry| self.entry(entry)).collect();
        format!("{{\"#\":[{}]}}", entries.join(","))
    }

    fn entry(&mut self, entry: &Value) -> String {
        let mut shown = String::new();
        text::write(entry, &mut shown);
        if let Some(number) = self.numbers.get(&shown) {
            return number.to_string();
        }
        if self.bytes + shown.len() > self.most {
            return shown;
        }
        self.add(shown).to_string()
    }

    fn add(&mut self, text: String) -> usize {
        let number = self.all.len();
        self.bytes += text.len();
        self.all.push(text.clone());
        self.numbers.insert(text, number);
        number
    }
}

/// Texts that are filled again with those that are still used.
struct Renewal<'a> {
    texts: &'a mut Texts,
    before: Vec<String>,
    /// The new numbers by those from before.
    numbers: Vec<Option<usize>>,
}

impl Renewal<'_> {
    fn of(texts: &mut Texts) -> Renewal<'_> {
        let Texts { all, most, .. } = std::mem::take(texts);
        texts.most = most;
        Renewal { texts, numbers: vec![None; all.len()], before: all }
    }

    /// What a cell holds with new numbers, if it has any.
    fn shown(&mut self, holds: &str) -> Option<String> {
        let entries: Vec<String> = references(holds)?.iter().map(|entry| self.entry(entry.get())).collect();
        Some(format!("{{\"#\":[{}]}}", entries.join(",")))
    }

    fn entry(&mut self, entry: &str) -> String {
        let place = entry.parse::<usize>().ok().filter(|place| *place < self.before.len());
        let Some(place) = place else { return entry.to_owned() };
        let texts = &mut *self.texts;
        let number = *self.numbers[place].get_or_insert_with(|| texts.add(std::mem::take(&mut self.before[place])));
        number.to_string()
    }
}

/// The entries of a list of objects that a cell holds: texts, or numbers of texts.
pub(super) fn references(holds: &str) -> Option<Vec<&RawValue>> {
    serde_json::from_str(holds.strip_prefix("{\"#\":")?.strip_suffix('}')?).ok()
}
