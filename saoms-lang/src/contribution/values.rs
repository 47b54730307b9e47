//! Values that properties take from files beside their composite.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use smol_str::SmolStr;

use super::overrides::table;
use super::value_file::{self, FileValue};
use crate::diagnostic::{Diagnostic, Diagnostics, codes, quoted};
use crate::expression::has_expression;
use crate::load::read;
use crate::model::{Composite, Contribution, Table};
use crate::source::{FileId, Location, Sources, Text};

/// Reads the files that properties of the composite's components and their loops name with `file`, each of at most
/// `max_size` bytes. A name is a URI (SCA Assembly 1.1, 4.1.3), as a rule a path relative to the folder of the
/// composite; files are read from disk alone.
///
/// The content of the file is the value, without white space at its ends if it is one line; its place is in that file.
/// XML with the root `values` of SCA holds values in elements (ASM50046). A file that cannot be read is reported where
/// it is named. So are the tables that replicated components name with `overrides`.
pub fn read_values(composite: &mut Composite, max_size: u64, sources: &mut Sources, diagnostics: &mut Diagnostics) {
    let own = Path::new(sources.get(composite.file()).path());
    let folder = own.parent().map(Path::to_owned).unwrap_or_default();
    // Many components may share a file.
    let mut known: HashMap<PathBuf, FileValue> = HashMap::new();
    let properties = composite.components.iter_mut().flat_map(|component| {
        let of_loops = component.loops.iter_mut().flat_map(|one| &mut one.properties);
        component.properties.iter_mut().chain(of_loops)
    });
    for property in properties {
        let Some(details) = property.details.as_mut() else { continue };
        let Some(file) = &details.file else { continue };
        let path = match path_of(file, &folder, sources) {
            Ok(path) => path,
            Err(diagnostic) => {
                diagnostics.push(*diagnostic);
                continue;
            }
        };
        if !known.contains_key(&path) {
            match read::value(&path, max_size, file, sources.open()) {
                Ok(text) => {
                    let file = sources.add(path.display().to_string(), text);
                    let value = value_file::read(file, sources, diagnostics);
                    known.insert(path.clone(), value);
                }
                Err(diagnostic) => diagnostics.push(*diagnostic),
            }
        }
        if let Some(FileValue { text, document }) = known.get(&path).cloned() {
            (details.from_file, details.document) = (text, document);
        }
    }
    let (components, properties) = (composite.components.iter_mut(), &composite.properties);
    let mut tables: HashMap<SmolStr, Arc<Table>> = HashMap::new();
    for replicas in components.filter_map(|component| component.replicas.as_mut()) {
        // Which file an expression names is known when composites are unfolded: see `read_tables`.
        if let Some(file) = replicas.overrides.as_ref().filter(|file| !has_expression(file)) {
            replicas.table = tables.get(&file.value).cloned();
            if replicas.table.is_some() {
                continue;
            }
            replicas.table = read_table(file, file.location, max_size, sources, diagnostics).unwrap_or_else(|fault| {
                let (name, mut fault) = (file.strip_prefix('$').unwrap_or(file), *fault);
                if properties.iter().any(|one| *one.name == *name && !name.is_empty()) {
                    fault.help.clear();
                    fault = fault.replace(file, file.location, &format!("${{{name}}}"));
                }
                diagnostics.push(fault);
                None
            });
            tables.extend(replicas.table.iter().map(|table| (file.value.clone(), Arc::clone(table))));
        }
    }
}

/// Reads the tables that components of a fleet name by expressions, until no further ones are wanted: the lines of one
/// may name others.
pub fn read_tables(
    contribution: &mut Contribution,
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
    wanted: impl Fn(&Contribution, &Sources) -> Vec<(Text, Location)>,
) {
    let mut known: HashSet<(FileId, SmolStr)> = HashSet::new();
    loop {
        let count = known.len();
        for (name, attribute) in wanted(contribution, sources) {
            let file = name.location.file;
            if known.insert((file, name.value.clone())) {
                match read_table(&name, attribute, max_size, sources, diagnostics) {
                    Ok(table) => table.into_iter().for_each(|table| contribution.add_table(file, &name, table)),
                    Err(fault) => diagnostics.push(*fault),
                }
            }
        }
        if known.len() == count {
            return;
        }
    }
}

/// The table that an `attribute` names, in a file whose path is from the folder of the file in which it is written.
fn read_table(
    name: &Text,
    attribute: Location,
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Result<Option<Arc<Table>>, Box<Diagnostic>> {
    let folder = Path::new(sources.get(name.location.file).path()).parent().unwrap_or(Path::new(""));
    let path = folder.join(name.as_str());
    match read::value(&path, max_size, name, sources.open()) {
        Ok(text) => {
            let file = sources.add(path.display().to_string(), text);
            Ok(table(file, sources, diagnostics).map(Arc::new))
        }
        Err(mut diagnostic) => {
            // An expression stands for several names.
            if sources.snippet(name.location) != name.as_str() {
                diagnostic.message = format!("{}: {}", quoted(name), diagnostic.message);
            }
            let is_here = attribute == name.location;
            Err(if is_here { diagnostic } else { Box::new(diagnostic.label(attribute, "the table of these")) })
        }
    }
}

/// The path that a URI names. One that is no file on this machine is a fault.
fn path_of(uri: &Text, folder: &Path, sources: &Sources) -> Result<PathBuf, Box<Diagnostic>> {
    let (scheme, rest) = uri.split_once(':').unwrap_or(("", uri));
    // One letter is a drive of Windows.
    let has_scheme = scheme.len() > 1
        && scheme.starts_with(|letter: char| letter.is_ascii_alphabetic())
        && scheme.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(&byte));
    if !has_scheme {
        let written = folder.join(uri.as_str());
        let is_there = sources.open().get(&written).is_some() || written.exists();
        return Ok(if is_there { written } else { folder.join(&*decoded(uri)) });
    }
    let refused = |message: String| {
        let one = Diagnostic::new(&codes::FILE_UNREADABLE, uri.location, message);
        Box::new(one.help("keep the file beside the composite, and name it by its path from there"))
    };
    if !scheme.eq_ignore_ascii_case("file") {
        return Err(refused(format!("{} is not read: values come from files on this machine", quoted(uri))));
    }
    let path = match rest.strip_prefix("//") {
        None => rest,
        Some(rest) => match rest.find('/').map(|slash| rest.split_at(slash)) {
            Some(("" | "localhost", path)) => path,
            _ => return Err(refused(format!("{} is a file of another machine", quoted(uri)))),
        },
    };
    Ok(folder.join(&*decoded(path)))
}

/// A text with each `%` and two digits replaced by the byte they encode (RFC 3986, 2.1); unchanged where the bytes are
/// no text.
fn decoded(text: &str) -> Cow<'_, str> {
    let digit = |at: usize| text.as_bytes().get(at).and_then(|digit| char::from(*digit).to_digit(16));
    let (mut bytes, mut at) = (Vec::with_capacity(text.len()), 0);
    while let Some(byte) = text.as_bytes().get(at) {
        match (byte, digit(at + 1), digit(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                bytes.push((high * 16 + low) as u8);
                at += 3;
            }
            _ => {
                bytes.push(*byte);
                at += 1;
            }
        }
    }
    String::from_utf8(bytes).map_or(Cow::Borrowed(text), Cow::Owned)
}
