//! Ways to mend what is wrong at a place, or in all of a file.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use saoms_lang::source::LineRange;

use super::diagnostic::{EditorDiagnostic, Fix, RangeEdit};
use crate::editor::FileEdit;
use crate::editor::allow::{Allowance, allowances};
use crate::editor::scene::Scene;
use crate::editor::scene::file::File;

/// An action that mends diagnostics.
#[derive(Clone, Debug, PartialEq)]
pub struct FixAction<'d> {
    /// The title and the edits.
    pub fix: Fix,
    /// The diagnostics that it mends.
    pub of: Vec<&'d EditorDiagnostic>,
    /// True for the likeliest one of a diagnostic.
    pub is_preferred: bool,
}

/// The diagnostics of a file that a range touches.
pub fn touching(all: &[EditorDiagnostic], range: LineRange) -> impl Iterator<Item = &EditorDiagnostic> {
    all.iter().filter(move |one| overlap(one.range, range))
}

/// The actions for the diagnostics of the first file that a range touches, the likeliest first; last those that allow
/// what can be allowed.
pub fn fixes<'d>(scene: &Scene, all: &'d [EditorDiagnostic], range: LineRange) -> Vec<FixAction<'d>> {
    let file = scene.file();
    let mut actions = Vec::new();
    for one in touching(all, range) {
        let fixes = one.fixes.iter().enumerate();
        actions.extend(fixes.map(|(rank, fix)| FixAction { fix: fix.clone(), of: vec![one], is_preferred: rank == 0 }));
    }
    for one in touching(all, range).filter(|one| one.can_be_allowed) {
        let at = file.lines.offset(&file.text, one.range.start);
        let ways = allowances(scene, at, one.code).into_iter().map(|Allowance { title, edits }| {
            let edits = edits.into_iter().map(|edit| range_edit(file, edit)).collect();
            let fix = Fix { title, edits: BTreeMap::from([(file.path.clone(), edits)]) };
            FixAction { fix, of: vec![one], is_preferred: false }
        });
        actions.extend(ways);
    }
    actions
}

/// The action that mends all diagnostics of a file with one suggestion; `None` where these are fewer than `least`.
/// Suggestions that change other files, or overlap with others, are left out.
pub fn fix_all<'d>(all: &'d [EditorDiagnostic], path: &Path, least: usize) -> Option<FixAction<'d>> {
    let (mut of, mut edits): (Vec<&EditorDiagnostic>, Vec<RangeEdit>) = (Vec::new(), Vec::new());
    for one in all {
        let [fix] = &one.fixes[..] else { continue };
        let Some(own) = fix.edits.get(path).filter(|_| fix.edits.len() == 1) else { continue };
        let meets = |new: &RangeEdit| edits.iter().any(|known| overlap(known.range, new.range));
        if own.iter().any(meets) {
            continue;
        }
        edits.extend(own.iter().cloned());
        of.push(one);
    }
    let title = match of.len() {
        1 => "Fix the error of this file that has one suggestion".to_owned(),
        count => format!("Fix all {count} errors of this file that have one suggestion"),
    };
    let fix = Fix { title, edits: BTreeMap::from([(path.to_owned(), edits)]) };
    (of.len() >= least.max(1)).then_some(FixAction { fix, of, is_preferred: false })
}

fn range_edit(file: &File, FileEdit { range, text }: FileEdit) -> RangeEdit {
    let Range { start, end } = range;
    let place = |at| file.lines.line_column(&file.text, at);
    RangeEdit { range: LineRange { start: place(start), end: place(end) }, text }
}

/// True if two ranges touch.
fn overlap(one: LineRange, other: LineRange) -> bool {
    one.start <= other.end && other.start <= one.end
}
