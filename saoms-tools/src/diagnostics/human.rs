//! Diagnostics for people, with a picture of the place in the look of rustc.

use std::fmt;
use std::path::{Path, PathBuf};

use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet};

use saoms_api::host::one_line;

use super::grouping::grouped;
use super::window::{Mark, Window, windows};
use saoms_lang::diagnostic::{Diagnostic, Severity};
use saoms_lang::project::Compilation;
use saoms_lang::source::{FileId, Sources};

/// All diagnostics as text, one after the other, an empty line between two. Beside the code stands the rule of the SCA
/// specification, where there is one. Many that are alike are shown once, with the lines of the others.
pub fn human(diagnostics: &[Diagnostic], sources: &Sources, colour: bool) -> String {
    Human::of(diagnostics, sources, colour).to_string()
}

/// The diagnostics of a compilation as people read them, without colours.
pub fn human_of<T>(compilation: &Compilation<T>) -> String {
    Human::of(compilation.reported(), &compilation.sources, false).to_string()
}

/// Diagnostics for people, made while they are written: those of a thousand files are long.
#[derive(Debug)]
pub struct Human<'d> {
    shown: Vec<(&'d Diagnostic, Option<String>)>,
    sources: &'d Sources,
    renderer: Renderer,
    /// The folder from which paths go.
    folder: PathBuf,
}

impl<'d> Human<'d> {
    /// These diagnostics, in colours if asked.
    pub fn of(diagnostics: impl IntoIterator<Item = &'d Diagnostic>, sources: &'d Sources, colour: bool) -> Self {
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        Self { shown: grouped(diagnostics.into_iter().collect(), sources), sources, renderer, folder: PathBuf::new() }
    }

    /// The same for a reader in this folder: the paths of files in it go from there.
    #[must_use]
    pub fn seen_from(self, folder: &Path) -> Self {
        Self { folder: folder.to_owned(), ..self }
    }
}

impl fmt::Display for Human<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, (one, others)) in self.shown.iter().enumerate() {
            if place > 0 {
                out.write_str("\n")?;
            }
            let rendered = render(one, others.as_deref(), (self.sources, &self.folder), &self.renderer);
            // Where a part of a line is shown, its place is written before it, and the picture has a place without a
            // name besides.
            let lines = rendered.lines().filter(|line| !is_nameless_place(line));
            // A blank line that only ends the picture would be two with ours.
            writeln!(out, "{}", lines.collect::<Vec<_>>().join("\n").trim_end())?;
        }
        Ok(())
    }
}

/// A path as it is called in a folder: that of a file elsewhere stays.
pub fn from_folder<'p>(path: &'p str, folder: &Path) -> &'p str {
    let inside = folder.to_str().filter(|folder| !folder.is_empty()).and_then(|folder| path.strip_prefix(folder));
    inside.and_then(|rest| rest.strip_prefix('/')).unwrap_or(path)
}

/// True if a line has nothing but `:::` in it, which stands before the path of a file.
fn is_nameless_place(line: &str) -> bool {
    let mut plain = String::new();
    let mut rest = line;
    while let Some((before, behind)) = rest.split_once('\u{1b}') {
        plain.push_str(before);
        rest = behind.split_once('m').map_or("", |(_, behind)| behind);
    }
    (plain + rest).trim() == ":::"
}

fn render(one: &Diagnostic, others: Option<&str>, (sources, folder): (&Sources, &Path), renderer: &Renderer) -> String {
    let level = match one.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let id = one.rule.map_or_else(|| one.code.id.to_owned(), |rule| format!("{}, {rule}", one.code.id));
    let mut group = Group::with_title(level.primary_title(one_line(&one.message)).id(id));
    let windows = pictures(one, sources);
    for (file, window) in &windows {
        group = picture(group, *file, window, (sources, folder));
    }
    for suggestion in &one.suggestions {
        group = group.element(Level::HELP.message(one_line(&suggestion.description)));
    }
    for help in &one.help {
        group = group.element(Level::HELP.message(one_line(help)));
    }
    if let Some(others) = others {
        group = group.element(Level::NOTE.message(others));
    }
    renderer.render(&[group])
}

/// The parts of files to show: that of the diagnostic's own place first.
fn pictures<'a>(one: &'a Diagnostic, sources: &Sources) -> Vec<(FileId, Window<'a>)> {
    let own = Mark { span: one.location.span, text: one.at.as_deref().unwrap_or(""), is_primary: true };
    let mut files: Vec<(FileId, Vec<Mark<'a>>)> = vec![(one.location.file, vec![own])];
    for label in &one.labels {
        let mark = Mark { span: label.location.span, text: &label.text, is_primary: false };
        match files.iter_mut().find(|(file, _)| *file == label.location.file) {
            Some((_, marks)) => marks.push(mark),
            None => files.push((label.location.file, vec![mark])),
        }
    }
    let shown = |(file, marks)| windows(sources.get(file), marks).into_iter().map(move |one| (file, one));
    files.into_iter().flat_map(shown).collect()
}

fn picture<'a>(
    group: Group<'a>,
    file: FileId,
    window: &'a Window<'a>,
    (sources, folder): (&'a Sources, &Path),
) -> Group<'a> {
    let path = one_line(from_folder(sources.get(file).path(), folder));
    if sources.get(file).text().is_empty() {
        return group.element(Origin::path(path));
    }
    let snippet = Snippet::source(&window.text).line_start(window.first_line as usize);
    let snippet = snippet.annotations(window.marks.iter().map(|(range, mark)| {
        let kind = if mark.is_primary { AnnotationKind::Primary } else { AnnotationKind::Context };
        kind.span(range.clone()).label((!mark.text.is_empty()).then(|| one_line(mark.text)))
    }));
    match window.moved {
        None => group.element(snippet.path(path)),
        Some(place) => {
            let origin = Origin::path(path).line(place.line as usize).char_column(place.column as usize);
            group.element(origin).element(snippet)
        }
    }
}
