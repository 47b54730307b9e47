//! Tables of what differs among replicas.

use std::collections::HashSet;
use std::ops::Range;

use super::ProposalKind;
use saoms_lang::expression::{ExpressionValue, render};
use saoms_lang::model::SAOMS_NAMESPACE;

use super::{Proposal, language, names, value, values};
use crate::editor::describe;
use crate::editor::scene::Scene;
use crate::editor::scene::expressions::INDEX;
use crate::editor::scene::outline::Component;
use crate::editor::syntax::trimmed;

/// The most replicas that are named.
const MOST: i64 = 200;

/// Proposals at a byte of the table of a component.
pub(super) fn complete(scene: &Scene, of: (usize, &Component), at: usize) -> Vec<Proposal> {
    let text = &scene.file().text;
    let lines = lines(text);
    let Some(line) = lines.iter().position(|line| line.last().is_some_and(|last| at <= last.whole.end)) else {
        return Vec::new();
    };
    let Some(column) = lines[line].iter().position(|cell| at <= cell.whole.end) else { return Vec::new() };
    let range = lines[line][column].inside.clone();
    // Among the blanks around a value nothing is replaced.
    let range = if range.start <= at && at <= range.end { range } else { at..at };
    let head: Vec<&str> = lines[0].iter().map(|cell| text[cell.inside.clone()].trim()).collect();
    match (line, column) {
        (0, 0) => {
            let one = |name: &str, what| Proposal::new(name, ProposalKind::Field, &range).detail(what);
            vec![
                one(INDEX, "each line names its replica by the index"),
                one("name", "each line names its replica by the name"),
            ]
        }
        (0, _) => columns(scene, of, &head, column, &range),
        (_, 0) => {
            let known: HashSet<&str> = lines[1..].iter().map(|line| text[line[0].inside.clone()].trim()).collect();
            let typed = text[range.clone()].trim();
            let all = replicas(scene, of, head[0] == "name").into_iter();
            let free = all.filter(|one| one == typed || !known.contains(one.as_str()));
            free.zip(0..).map(|(one, rank)| value(one, &range).rank(rank)).collect()
        }
        (_, column) => {
            let Some(name) = head.get(column) else { return Vec::new() };
            if let Some(language) = language::of_column(scene, of, name) {
                return language::complete(&language, scene, range, at);
            }
            let declared = names::declared_in(scene, of.0, of.1.name.element);
            match declared.into_iter().find(|(one, _)| one.name == *name) {
                Some((one, preset)) => values::explained(one, preset, &text[range.start..at], &range),
                None => {
                    let inner = scene.inner(of.0, of.1);
                    inner.map_or_else(Vec::new, |inner| values::as_used(scene, inner, name, &range, at))
                }
            }
        }
    }
}

/// Documentation of a column, or of a value in it.
pub(crate) fn hover(scene: &Scene, at: usize) -> Option<(String, Range<usize>)> {
    let text = &scene.file().text;
    let of = owner(scene)?;
    let lines = lines(text);
    let line = lines.iter().find(|line| line.last().is_some_and(|last| at <= last.whole.end))?;
    let column = line.iter().position(|cell| at <= cell.whole.end)?;
    let cell = line[column].inside.clone();
    let name = text[lines[0].get(column)?.inside.clone()].trim();
    if column == 0 {
        let what = match name {
            "name" => "the name of the replica that the line is about",
            _ => "the index of the replica that the line is about",
        };
        return Some((format!("**{name}**, {what}"), cell));
    }
    let declared = names::declared_in(scene, of.0, of.1.name.element);
    let (one, preset) = declared.into_iter().find(|(one, _)| one.name == name)?;
    Some((describe::property(one, preset), cell))
}

/// The component whose table the first file is.
pub(super) fn owner(scene: &Scene) -> Option<(usize, &Component)> {
    scene.owners().iter().find_map(|&file| {
        let mut components = scene.files[file].outline.components.iter();
        let is_one = |one: &&Component| one.table.as_ref().is_some_and(|name| scene.is_first(file, name));
        Some((file, components.find(is_one)?))
    })
}

/// The properties that have no column yet.
fn columns(
    scene: &Scene,
    of: (usize, &Component),
    head: &[&str],
    column: usize,
    range: &Range<usize>,
) -> Vec<Proposal> {
    let others = head.iter().zip(0..).filter(|(_, at)| *at != column);
    let others: HashSet<&str> = others.map(|(known, _)| *known).collect();
    let is_free = |name: &str| !others.contains(name);
    let one = |name: &str| Proposal::new(name, ProposalKind::Property, range);
    let declared = names::declared_in(scene, of.0, of.1.name.element).into_iter();
    let declared = declared.filter(|(property, _)| is_free(&property.name)).map(|(property, preset)| {
        one(&property.name).detail(describe::facts(property, preset)).doc(describe::property(property, preset))
    });
    let inner = scene.inside(of.0, of.1).iter().flat_map(|file| &scene.files[*file].outline.properties);
    let inner = inner.filter(|property| is_free(&property.text)).map(|property| one(&property.text));
    declared.chain(inner).collect()
}

/// The indices or the names of the replicas, where their number is written as one, or is that of a property.
fn replicas(scene: &Scene, (file, component): (usize, &Component), by_name: bool) -> Vec<String> {
    let of = &scene.files[file];
    let number = |attribute: &str| -> Option<i64> {
        let text = of.element(component.name.element).attribute_in(SAOMS_NAMESPACE, attribute)?;
        let text = text.raw_value().trim();
        text.parse().ok().or_else(|| scene.parameter_value(file, text)?.trim().parse().ok())
    };
    let (first, count) = (number("from").unwrap_or(1), number("count").unwrap_or(0));
    let name = |index: i64| render(&component.name.text, &mut |_| Ok(ExpressionValue::Integer(index))).ok();
    (0..count.min(MOST))
        .filter_map(|step| {
            let index = first.checked_add(step)?;
            if by_name { name(index) } else { Some(index.to_string()) }
        })
        .collect()
}

/// A value of a table.
struct Cell {
    whole: Range<usize>,
    /// Without the blanks and quotes around it.
    inside: Range<usize>,
}

impl Cell {
    fn of(text: &str, whole: Range<usize>) -> Self {
        let plain = trimmed(text, whole.clone());
        let inside = match text[plain.clone()].strip_prefix('"') {
            Some(rest) => plain.start + 1..plain.end - usize::from(rest.ends_with('"')),
            None => plain,
        };
        Self { whole, inside }
    }
}

/// The cells of each line; each line has at least one.
fn lines(text: &str) -> Vec<Vec<Cell>> {
    let mut all = vec![Vec::new()];
    let first = text.len() - text.trim_start_matches('\u{feff}').len();
    let mut start = first;
    let mut is_quoted = false;
    let bytes = text.as_bytes();
    for at in first..=text.len() {
        let byte = bytes.get(at).copied();
        is_quoted ^= byte == Some(b'"');
        if byte.is_none() || (!is_quoted && matches!(byte, Some(b',' | b'\n'))) {
            all.last_mut().into_iter().for_each(|line| line.push(Cell::of(text, start..at)));
            start = at + 1;
        }
        if !is_quoted && byte == Some(b'\n') {
            all.push(Vec::new());
        }
    }
    all
}
