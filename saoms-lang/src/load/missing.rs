//! Files that are not there, and what could have been meant.

use std::fs;
use std::path::Path;

use crate::diagnostic::{nearest_few, quoted};
use crate::limits::{FOLDER_ENTRIES, OFFERED_NAMES};

/// Help for a path that does not exist; files with the ending are shown where no name is alike.
pub(super) fn help(path: &Path, ending: Option<&str>) -> Option<String> {
    let parent = path.parent()?;
    let folder = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
    if !folder.is_dir() {
        let shown = quoted(&folder.display().to_string());
        return Some(match folder.exists() {
            true => format!("{shown} is no directory"),
            false => format!("there is no directory {shown} either"),
        });
    }
    let wanted = path.file_name()?.to_string_lossy();
    let names = names(folder);
    let all = names.iter().map(String::as_str);
    let near = nearest_few(&wanted, all.clone(), OFFERED_NAMES);
    let near = if near.is_empty() {
        // Many forget the ending.
        let stem = |name: &&str| Path::new(name).file_stem().is_some_and(|stem| stem == &*wanted);
        all.clone().filter(stem).take(OFFERED_NAMES).collect()
    } else {
        near
    };
    if !near.is_empty() {
        return Some(format!("there is {}", listed(&near, parent)));
    }
    let likely: Vec<&str> = all.filter(|name| ends_with(name, ending)).take(OFFERED_NAMES).collect();
    (!likely.is_empty()).then(|| format!("the folder has {}", listed(&likely, parent)))
}

/// Files with the ending in a directory that was given in place of one.
pub(super) fn inside(directory: &Path, ending: Option<&str>) -> Option<String> {
    let names = names(directory);
    let likely: Vec<&str> =
        names.iter().map(String::as_str).filter(|name| ends_with(name, ending)).take(OFFERED_NAMES).collect();
    (!likely.is_empty()).then(|| format!("it has {}", listed(&likely, directory)))
}

fn ends_with(name: &str, ending: Option<&str>) -> bool {
    ending.is_some_and(|ending| name.ends_with(ending))
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
