//! Values that properties take from files beside their composite.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::read;
use super::table::table;
use crate::diagnostic::Diagnostics;
use crate::model::Composite;
use crate::source::{Sources, Span, Text};

/// Reads the files that properties of the composite's components and their loops name with `file`, each of at most `max_size` bytes. A name is a path,
/// relative to the folder of the composite.
///
/// What the file holds, without white space at its ends, is the value; its place is in that file. A file that cannot be read is
/// reported where it is named. So are the tables that replicated components name with `overrides`.
pub fn read_values(
    composite: &mut Composite,
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) {
    let own = Path::new(sources.get(composite.file()).path());
    let folder = own.parent().map(Path::to_owned).unwrap_or_default();
    // Many components may share a file.
    let mut known: HashMap<PathBuf, Text> = HashMap::new();
    let properties = composite.components.iter_mut().flat_map(|component| {
        let of_loops = component.loops.iter_mut().flat_map(|one| &mut one.properties);
        component.properties.iter_mut().chain(of_loops)
    });
    for property in properties {
        let Some(details) = property.details.as_mut() else { continue };
        let Some(file) = &details.file else { continue };
        let path = folder.join(file.as_str());
        if !known.contains_key(&path) {
            match read::value(&path, max_size, file.location, sources.open()) {
                Ok(text) => _ = known.insert(path.clone(), add(&path, text, sources)),
                Err(diagnostic) => diagnostics.push(*diagnostic),
            }
        }
        details.from_file = known.get(&path).cloned();
    }
    for replicas in composite.components.iter_mut().filter_map(|component| component.replicas.as_mut()) {
        let Some(file) = &replicas.overrides else { continue };
        let path = folder.join(file.as_str());
        match read::value(&path, max_size, file.location, sources.open()) {
            Ok(text) => {
                let file = sources.add(path.display().to_string(), text);
                replicas.table = table(file, sources, diagnostics);
            }
            Err(diagnostic) => diagnostics.push(*diagnostic),
        }
    }
}

fn add(path: &Path, text: String, sources: &mut Sources) -> Text {
    let whole = text.trim_start_matches('\u{feff}');
    let value = whole.trim();
    let start = text.len() - whole.len() + whole.find(value).unwrap_or(0);
    let (value, span) = (value.into(), Span::new(start as u32, (start + value.len()) as u32));
    let file = sources.add(path.display().to_string(), text);
    Text::new(value, span.in_file(file))
}
