//! Reading files.

use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::{description, encoding};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, codes, nearest_few, quoted};
pub use crate::limits::MAX_SIZE;
use crate::limits::{ADDRESSABLE_BYTES, FOLDER_ENTRIES, OFFERED_NAMES};
use crate::source::{FileId, Location, OpenTexts, Sources, Span, Text};

/// The name of a text from standard input. Its folder is the current one.
pub const STANDARD_INPUT: &str = "<stdin>";

/// The texts and diagnostics of a check, to which reading files adds.
pub(crate) struct ReadContext<'a> {
    /// The most bytes of a file.
    pub(crate) max_size: u64,
    pub(crate) sources: &'a mut Sources,
    pub(crate) diagnostics: &'a mut Diagnostics,
}

impl ReadContext<'_> {
    /// Does what [`read`] does.
    pub(crate) fn read(&mut self, path: &Path) -> Option<FileId> {
        read(path, self.max_size, self.sources, self.diagnostics)
    }
}

/// Reads the text of a file of at most `max_size` bytes. `None`, and a diagnostic that says why, when there is no such
/// file or it is no text in UTF-8.
///
/// The file is in `sources` in either case: diagnostics have to name it.
pub fn read(path: &Path, max_size: u64, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<FileId> {
    let max_size = max_size.min(ADDRESSABLE_BYTES);
    add(path, bytes(path, max_size, sources.open()), max_size, sources, diagnostics)
}

/// Reads the text of `input` as [`read`] does that of a file; `name` is what diagnostics call it.
pub fn read_from(
    input: impl Read,
    name: &str,
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Option<FileId> {
    let max_size = max_size.min(ADDRESSABLE_BYTES);
    add(Path::new(name), limited(input, Vec::new(), max_size), max_size, sources, diagnostics)
}

fn add(
    path: &Path,
    bytes: Result<Vec<u8>, Failure>,
    max_size: u64,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Option<FileId> {
    let name = path.display().to_string();
    let bytes = match bytes {
        Ok(bytes) => bytes,
        Err(failure) => {
            let file = sources.add(name, "");
            diagnostics.push(failure.diagnostic(path, max_size, start_of(file), &COMPOSITE));
            return None;
        }
    };
    match text(path, bytes, &COMPOSITE) {
        Ok(text) => {
            let is_empty = text.trim_start_matches('\u{feff}').trim().is_empty();
            let file = sources.add(name, text);
            if is_empty {
                diagnostics.push(match description::is_name(path) {
                    true => empty_of(file, "<contribution xmlns=\"...\"/>"),
                    false => empty(file),
                });
                return None;
            }
            Some(file)
        }
        Err(wrong) => {
            let len = wrong.shown[wrong.at as usize..].chars().next().map_or(0, char::len_utf8);
            let file = sources.add(name, wrong.shown);
            let location = Span::new(wrong.at, wrong.at + len as u32).in_file(file);
            let one = Diagnostic::new(wrong.code, location, wrong.message);
            diagnostics.push(one.help(wrong.help));
            None
        }
    }
}

/// Reads the text of a file of at most `max_size` bytes that is named at a place, as it is written there.
///
/// # Errors
/// The message for a file that does not exist or is no text in UTF-8.
pub(crate) fn value(path: &Path, max_size: u64, written: &Text, open: &OpenTexts) -> Result<String, Box<Diagnostic>> {
    let named = written.location;
    let max_size = max_size.min(ADDRESSABLE_BYTES);
    let bytes = named_bytes(path, max_size, open).map_err(|failure| {
        let mut one = failure.diagnostic(path, max_size, named, &VALUE);
        if one.code == &codes::FILE_NOT_FOUND {
            let with_slashes = written.replace('\\', "/");
            if written.contains("${") {
                one.help
                    .insert(0, "the path of a `file` has no expressions: `${...}` is not evaluated in it".to_owned());
            } else if with_slashes != written.as_str() {
                // What it leads to is one file.
                if Path::new(&path.display().to_string().replace('\\', "/")).is_file() {
                    one.help.clear();
                }
                one.help.insert(0, format!("separate folders with `/`: write {}", quoted(&with_slashes)));
            } else {
                let shown = std::path::absolute(path).unwrap_or_else(|_| path.into()).display().to_string();
                one.help.insert(0, format!("the full path is {}", quoted(&shown)));
            }
        }
        Box::new(one)
    })?;
    text(path, bytes, &VALUE).map_err(|wrong| {
        let Wrong { code, shown, at, message, help, .. } = *wrong;
        let one = Diagnostic::new(code, named, message).help(help);
        if shown.is_empty() {
            return Box::new(one);
        }
        // The place is in a text that is none: people find it by its numbers.
        let before = &shown[..at as usize];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        let file = quoted(&path.display().to_string());
        Box::new(one.help(format!("it is in line {line}, column {column} of {file}")))
    })
}

/// The diagnostic for a file of nothing, or of nothing but white space.
pub(super) fn empty(file: FileId) -> Diagnostic {
    empty_of(file, "<composite xmlns=\"...\" name=\"...\" targetNamespace=\"...\"/>")
}

fn empty_of(file: FileId, least: &str) -> Diagnostic {
    let one = Diagnostic::new(&codes::FILE_EMPTY, start_of(file), "the file is empty");
    one.help(format!("write at least {}", quoted(least)))
}

fn start_of(file: FileId) -> Location {
    Span::empty(0).in_file(file)
}

/// The expected kind of a file.
struct Expected {
    kind: &'static str,
    help: &'static str,
    /// The extension of such files, if they have one in common.
    ending: Option<&'static str>,
}

const COMPOSITE: Expected =
    Expected { kind: "XML text", help: "a composite is an XML text in UTF-8", ending: Some(".composite") };
const VALUE: Expected = Expected {
    kind: "text",
    help: "the value of a property is a text in UTF-8; save a spreadsheet as CSV",
    ending: None,
};

/// The reason why there are no bytes.
enum Failure {
    Directory,
    /// A pipe, a device or a socket.
    Irregular,
    /// With the size, where it is known.
    TooLarge(Option<u64>),
    /// Nobody allowed to read it; with its path without links.
    Outside(PathBuf),
    Io(io::Error),
}

impl Failure {
    fn diagnostic(self, path: &Path, max_size: u64, location: Location, expected: &Expected) -> Diagnostic {
        let not_there = "there is no such file".to_owned();
        let (code, message, help) = match self {
            Self::Directory => {
                let message = "found a folder, expected a file".to_owned();
                (&codes::FILE_IS_DIRECTORY, message, inside(path, expected.ending))
            }
            Self::Irregular => {
                let message = "the file cannot be read: it is not a regular file".to_owned();
                let help = "a pipe or a device may have no end: name a file that contains the text";
                (&codes::FILE_UNREADABLE, message, Some(help.to_owned()))
            }
            Self::TooLarge(size) => {
                let message = match size {
                    Some(size) => format!("the file has {size} bytes, and the limit is {max_size} bytes"),
                    None => format!("the file has more than the limit of {max_size} bytes"),
                };
                (&codes::FILE_TOO_LARGE, message, Some("the limit is set with `--max-size`".to_owned()))
            }
            Self::Outside(real) => {
                let message = "this file is outside the folder of the composite, and is not read".to_owned();
                let help = format!(
                    "move {} into the folder of the composite or its contribution, or allow it with `--allow-outside`",
                    quoted(&real.display().to_string())
                );
                (&codes::FILE_OUTSIDE, message, Some(help))
            }
            Self::Io(error) if error.raw_os_error() == Some(libc::ELOOP) => {
                let help = "change the link, or remove it".to_owned();
                (&codes::FILE_NOT_FOUND, "this link leads back to itself".to_owned(), Some(help))
            }
            Self::Io(error) if error.kind() == io::ErrorKind::NotFound => match fs::read_link(path) {
                Ok(target) => {
                    let help = format!("it leads to {}", quoted(&target.display().to_string()));
                    (&codes::FILE_NOT_FOUND, "this link leads to no file".to_owned(), Some(help))
                }
                Err(_) => (&codes::FILE_NOT_FOUND, not_there, near(path, expected.ending)),
            },
            Self::Io(error) if error.kind() == io::ErrorKind::NotADirectory => {
                let help = "a part of its path is a file, not a folder".to_owned();
                (&codes::FILE_NOT_FOUND, not_there, Some(help))
            }
            Self::Io(error) => (&codes::FILE_UNREADABLE, format!("the file cannot be read: {error}"), None),
        };
        let mut one = Diagnostic::new(code, location, message);
        one.help.extend(help);
        one
    }
}

fn bytes(path: &Path, max_size: u64, open: &OpenTexts) -> Result<Vec<u8>, Failure> {
    if let Some(real) = open.outside(path) {
        return Err(Failure::Outside(real));
    }
    if let Some(text) = open.get(path) {
        return limited(text.as_bytes(), Vec::with_capacity(text.len()), max_size);
    }
    let about = fs::metadata(path).map_err(Failure::Io)?;
    if about.is_dir() {
        return Err(Failure::Directory);
    }
    if about.len() > max_size {
        return Err(Failure::TooLarge(Some(about.len())));
    }
    let file = open.read(path).map_err(Failure::Io)?;
    limited(file, Vec::with_capacity(about.len() as usize + 1), max_size)
}

/// The bytes of a file that another one names. Nobody writes to it for this one reader, as to a pipe on the command
/// line: it has to be a regular file.
fn named_bytes(path: &Path, max_size: u64, open: &OpenTexts) -> Result<Vec<u8>, Failure> {
    let about = fs::metadata(path);
    let is_irregular = about.is_ok_and(|about| !about.is_file() && !about.is_dir());
    if is_irregular && open.get(path).is_none() && open.outside(path).is_none() {
        return Err(Failure::Irregular);
    }
    bytes(path, max_size, open)
}

/// A file can grow while it is read, and devices and pipes have no length.
fn limited(input: impl Read, mut bytes: Vec<u8>, max_size: u64) -> Result<Vec<u8>, Failure> {
    input.take(max_size + 1).read_to_end(&mut bytes).map_err(Failure::Io)?;
    if bytes.len() as u64 > max_size {
        return Err(Failure::TooLarge(None));
    }
    Ok(bytes)
}

/// Bytes that are no text.
struct Wrong {
    code: &'static Code,
    /// The part of the file that can be shown.
    shown: String,
    /// The place of the fault in it: the character shown in place of invalid bytes.
    at: u32,
    message: String,
    help: String,
}

fn text(path: &Path, bytes: Vec<u8>, expected: &Expected) -> Result<String, Box<Wrong>> {
    let whole =
        |code, message: String, help: String| Box::new(Wrong { code, shown: String::new(), at: 0, message, help });
    let convert = |name: &str| format!("convert it: `iconv -f {name} -t UTF-8 {}`", path.display());
    if let Some(name) = encoding::by_its_bytes(&bytes) {
        let message = format!("the file is in {name}, expected UTF-8");
        return Err(whole(&codes::FILE_ENCODING, message, convert(name)));
    }
    if let Some(what) = encoding::of_another_kind(&bytes) {
        let message = format!("the file is {what}, not {}", expected.kind);
        return Err(whole(&codes::FILE_BINARY, message, expected.help.to_owned()));
    }
    if let Some(at) = memchr::memchr(0, &bytes) {
        let message = format!("the file is binary: byte {at} is zero");
        return Err(whole(&codes::FILE_BINARY, message, expected.help.to_owned()));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let bytes = error.into_bytes();
        let declared = encoding::declared(&bytes).filter(|name| !name.eq_ignore_ascii_case("UTF-8"));
        let byte = bytes.get(at).copied().unwrap_or_default();
        let (message, help) = match declared {
            Some(name) => (format!("the XML declaration says {}, expected UTF-8", quoted(&name)), convert(&name)),
            None => (
                format!("the byte 0x{byte:02X} is not valid UTF-8"),
                format!("if the file is in Windows-1252 or Latin-1, {}", convert("WINDOWS-1252")),
            ),
        };
        let shown = String::from_utf8_lossy(&bytes).into_owned();
        let help = format!("{help}; until then the file cannot be checked");
        Box::new(Wrong { code: &codes::FILE_ENCODING, shown, at: at as u32, message, help })
    })
}

/// Help for a path of a file that does not exist: what there is that may be meant.
pub fn missing_file_help(path: &Path) -> Option<String> {
    near(path, None)
}

/// Help for a path that does not exist; files with the ending are shown where no name is alike.
fn near(path: &Path, ending: Option<&str>) -> Option<String> {
    let parent = path.parent()?;
    let folder = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
    if !folder.is_dir() {
        let shown = quoted(&folder.display().to_string());
        return Some(match folder.exists() {
            true => format!("{shown} is not a folder"),
            false => format!("there is no folder {shown}"),
        });
    }
    let wanted = path.file_name()?.to_string_lossy();
    let names = names(folder);
    let all = names.iter().map(String::as_str);
    if let Some(same) = all.clone().find(|name| name.to_lowercase() == wanted.to_lowercase()) {
        return Some(format!("there is {}, in other upper and lower case", listed(&[same], parent)));
    }
    let mut near = nearest_few(&wanted, all.clone(), OFFERED_NAMES);
    if near.is_empty() {
        // Many forget the ending, or write another one.
        let other = Path::new(&*wanted).file_stem();
        let has_ending = |name: &str| ending.is_some_and(|ending| name.ends_with(ending));
        let is_stem = |name: &&str| {
            let stem = Path::new(name).file_stem();
            stem.is_some_and(|stem| stem == &*wanted) || stem == other && has_ending(name)
        };
        near = all.filter(is_stem).take(OFFERED_NAMES).collect();
    }
    match near.is_empty() {
        false => Some(format!("there is {}", listed(&near, parent))),
        true => likely(&names, ending, parent).map(|likely| format!("the folder contains {likely}")),
    }
}

/// Files with the ending in a directory that was given in place of one.
fn inside(directory: &Path, ending: Option<&str>) -> Option<String> {
    likely(&names(directory), ending, directory).map(|likely| format!("the folder contains {likely}"))
}

fn likely(names: &[String], ending: Option<&str>, shown_as: &Path) -> Option<String> {
    let ending = ending?;
    let likely: Vec<&str> =
        names.iter().map(String::as_str).filter(|name| name.ends_with(ending)).take(OFFERED_NAMES).collect();
    (!likely.is_empty()).then(|| listed(&likely, shown_as))
}

fn listed(names: &[&str], shown_as: &Path) -> String {
    let paths: Vec<String> = names.iter().map(|name| quoted(&shown_as.join(name).display().to_string())).collect();
    paths.join(", ")
}

/// The names in a folder, in order; empty when it cannot be read.
fn names(folder: &Path) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut names: Vec<String> =
        entries.take(FOLDER_ENTRIES).flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort_unstable();
    names
}
