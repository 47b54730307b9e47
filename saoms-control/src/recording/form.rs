//! The form of a recording, as far as a page relies on it.

use std::collections::HashMap;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;

use super::cells::references;
use super::fields::FieldKind;

/// Letters of a value that an error shows.
const EXCERPT: usize = 40;

/// What was recorded of a run.
#[derive(Deserialize)]
#[expect(dead_code, reason = "some fields have to be there, whatever they hold")]
pub(super) struct Form<'a> {
    pub(super) name: String,
    subjects: Vec<Subject>,
    #[serde(borrow)]
    cells: Vec<Vec<&'a RawValue>>,
    #[serde(borrow)]
    texts: Vec<&'a RawValue>,
    #[serde(borrow)]
    samples: Vec<(f64, Vec<&'a RawValue>)>,
    figures: Figures,
    alerts: Vec<Alert>,
    log: Vec<Line>,
}

/// What has fields: a component, a message that a topic retains, or the fleet.
#[derive(Deserialize)]
struct Subject {
    component: Option<String>,
    topic: Option<String>,
    message: Option<String>,
    by: Option<String>,
    #[serde(rename = "key")]
    _key: Option<String>,
}

#[derive(Deserialize)]
struct Figures {
    plots: Vec<Plot>,
    rows: Vec<Vec<Option<f64>>>,
}

#[derive(Deserialize)]
struct Plot {
    #[serde(rename = "title")]
    _title: String,
    #[serde(rename = "unit")]
    _unit: String,
    lines: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
#[expect(dead_code, reason = "the page reads them")]
struct Alert {
    id: u64,
    time_s: f64,
    kind: String,
    component: Option<String>,
}

#[derive(Deserialize)]
#[expect(dead_code, reason = "the page reads them")]
struct Line {
    time_s: f64,
    component: Option<String>,
    text: String,
}

impl Subject {
    fn is_known(&self) -> bool {
        let Subject { component, topic, message, by, .. } = self;
        let of_message = [topic, message, by].map(Option::is_some);
        of_message == [true; 3] && component.is_none() || of_message == [false; 3]
    }

    /// The kind of its field with these names; `None` where it has no such field.
    fn kind_of(&self, names: &[String]) -> Option<FieldKind> {
        match (&self.topic, &self.component) {
            (Some(_), _) => Some(FieldKind::Any),
            (None, Some(_)) => FieldKind::of_component(names),
            (None, None) => FieldKind::of_fleet(names),
        }
    }

    /// It in words.
    fn named(&self) -> String {
        match (&self.topic, &self.component) {
            (Some(topic), _) => format!("a message of topic `{topic}`"),
            (None, Some(component)) => format!("component `{component}`"),
            (None, None) => "the fleet".to_owned(),
        }
    }
}

impl Form<'_> {
    /// Holds it to what a page takes for granted.
    pub(super) fn judge(&self) -> Result<(), String> {
        let Form { subjects, cells, texts, samples, .. } = self;
        if samples.is_empty() {
            return Err("it has no samples".to_owned());
        }
        if let Some(place) = subjects.iter().position(|subject| !subject.is_known()) {
            return Err(format!("subject {place} is neither the fleet nor a component nor a message"));
        }
        let kinds = self.judge_cells()?;
        if !texts.iter().all(|text| text.get().starts_with('{')) {
            return Err("a text is no object".to_owned());
        }
        for (place, (time_s, changes)) in samples.iter().enumerate() {
            if place > 0 && samples[place - 1].0 >= *time_s {
                return Err(format!("the sample of {time_s} s is not later than the one before"));
            }
            let is_cell = |one: &&RawValue| one.get().parse::<usize>().is_ok_and(|cell| cell < cells.len());
            if changes.len() % 2 != 0 || !changes.iter().step_by(2).all(is_cell) {
                return Err(format!("the sample of {time_s} s names a cell that there is not"));
            }
            let entries = changes.iter().skip(1).step_by(2).filter_map(|holds| references(holds.get())).flatten();
            let mut numbers = entries.map(RawValue::get).filter(|entry| !entry.starts_with('{'));
            if !numbers.all(|entry| entry.parse::<usize>().is_ok_and(|text| text < texts.len())) {
                return Err(format!("the sample of {time_s} s names a text that there is not"));
            }
            for change in changes.chunks_exact(2) {
                let (cell, holds) = (change[0].get().parse::<usize>().unwrap_or_default(), change[1].get());
                if !kinds[cell].fits(holds) {
                    return Err(self.misfit(*time_s, &cells[cell], (kinds[cell], holds)));
                }
            }
        }
        self.figures.judge()
    }

    /// Each cell has a subject and one or two names, by which its values are of a kind.
    fn judge_cells(&self) -> Result<Vec<FieldKind>, String> {
        let mut lengths: HashMap<(usize, String), usize> = HashMap::new();
        let mut named = Vec::with_capacity(self.cells.len());
        for cell in &self.cells {
            let subject = cell.first().and_then(|subject| subject.get().parse::<usize>().ok());
            let subject = subject.filter(|subject| *subject < self.subjects.len());
            let names: Result<Vec<String>, _> =
                cell.iter().skip(1).map(|name| serde_json::from_str(name.get())).collect();
            let (Some(subject), Ok(names @ ([_] | [_, _]))) = (subject, names.as_deref()) else {
                return Err("a cell has no subject, or no name".to_owned());
            };
            if *lengths.entry((subject, names[0].clone())).or_insert(names.len()) != names.len() {
                return Err(format!("`{}` is both a value and has values", names[0]));
            }
            named.push((&self.subjects[subject], names.to_vec()));
        }
        let kind = |(subject, names): (&Subject, Vec<String>)| {
            subject.kind_of(&names).ok_or_else(|| format!("{} has no field `{}`", subject.named(), names.join(".")))
        };
        named.into_iter().map(kind).collect()
    }

    /// The error of a value that is not of the kind of its cell.
    fn misfit(&self, time_s: f64, cell: &[&RawValue], (kind, found): (FieldKind, &str)) -> String {
        let subject = cell.first().and_then(|subject| self.subjects.get(subject.get().parse::<usize>().ok()?));
        let names: Vec<&str> = cell.iter().skip(1).map(|name| name.get().trim_matches('"')).collect();
        let (subject, field) = (subject.map_or_else(String::new, Subject::named), names.join("."));
        let (found, expected) = (excerpt(found), kind.expected());
        format!("the sample of {time_s} s: field `{field}` of {subject}: found {found}, expected {expected}")
    }
}

/// The beginning of a value.
fn excerpt(json: &str) -> String {
    match json.char_indices().nth(EXCERPT) {
        Some((end, _)) => format!("{}...", &json[..end]),
        None => json.to_owned(),
    }
}

impl Figures {
    fn judge(&self) -> Result<(), String> {
        let columns = 1 + self.plots.iter().map(|plot| plot.lines.len()).sum::<usize>();
        let is_row = |row: &Vec<Option<f64>>| row.len() == columns && row[0].is_some();
        if self.rows.iter().all(is_row) {
            Ok(())
        } else {
            Err("a row of figures has not a value for each line".to_owned())
        }
    }
}
