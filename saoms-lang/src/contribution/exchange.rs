//! Checks of imports and exports against the contributions around (SCA Assembly 1.1, 10.2).

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use super::finder::Finder;
use super::index::is_of_definitions;
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};
use crate::limits::FOLDER_ENTRIES;
use crate::load::ReadContext;
use crate::load::description::{Description, Entry, Kind, path_in};

/// The endings of files that hold no names to import, or only names that are known.
const USUAL: &[&str] = &["composite", "componentType", "csv", "txt", "md", "properties"];
impl Finder {
    /// Warns of exported namespaces for which the contribution in `root` holds nothing, and of imported ones that no
    /// contribution around it exports. These may be elsewhere: so a missing one is reported only where its name is
    /// nearly that of another.
    pub(super) fn exchange(&mut self, description: &Description, root: &Path, context: &mut ReadContext<'_>) {
        for entry in description.imports.iter().filter(|entry| entry.location.is_some()) {
            self.imports.refuse_outside(entry, root, context);
        }
        let ReadContext { max_size, sources, diagnostics } = context;
        if description.exports.is_empty() && description.imports.is_empty() {
            return;
        }
        let own: BTreeSet<String> = self.index.heads(root).into_iter().map(|one| one.namespace).collect();
        for entry in &description.exports {
            let Some(namespace) = entry.namespace().filter(|one| !own.is_empty() && !own.contains(*one)) else {
                continue;
            };
            // What is imported can be given on.
            if description.imports.iter().any(|entry| entry.is(Kind::Namespace, namespace)) {
                continue;
            }
            let is_near = nearest(namespace, own.iter().map(String::as_str)).is_some();
            if !is_near && holds_others(root) {
                continue;
            }
            let message =
                format!("the contribution has no composite or definition in the namespace {}", quoted(namespace));
            diagnostics.push(with_nearest(entry, message, namespace, own.iter().map(String::as_str)));
        }
        let around = self.around.get_or_insert_default();
        for entry in &description.imports {
            let Some(namespace) = entry.namespace().filter(|one| !own.contains(*one)) else { continue };
            let others = around.around(root, namespace, *max_size);
            if others.iter().any(|(_, exports)| exports.iter().any(|one| one == namespace)) {
                continue;
            }
            let shown = quoted(namespace);
            let mut all = others.iter();
            let holder = all.find(|(other, _)| {
                if path_in(other).is_some() {
                    // What describes itself as a contribution is there for others to read.
                    sources.open().permit(other);
                }
                self.candidates.admit(1) && self.index.heads(other).iter().any(|one| one.namespace == namespace)
            });
            if let Some((holder, _)) = holder {
                let holder = quoted(&holder.display().to_string());
                let message = format!("the contribution in {holder} has the namespace {shown}, but does not export it");
                let help = format!("write `<export namespace=\"{namespace}\"/>` in its description");
                diagnostics.push(Diagnostic::new(&codes::EXCHANGE, entry.at, message).help(help));
                continue;
            }
            let exported = || others.iter().flat_map(|(_, exports)| exports.iter().map(String::as_str));
            if nearest(namespace, exported()).is_some() {
                let message = format!("no contribution around this one exports the namespace {shown}");
                diagnostics.push(with_nearest(entry, message, namespace, exported()));
            }
        }
    }
}

/// True if a contribution has files with other endings, whose contents are unknown.
fn holds_others(root: &Path) -> bool {
    let root = if root.as_os_str().is_empty() { Path::new(".") } else { root };
    let mut waiting = vec![root.to_owned()];
    let mut left = FOLDER_ENTRIES;
    while let Some(next) = waiting.pop() {
        for entry in fs::read_dir(next).into_iter().flatten().flatten() {
            left = left.saturating_sub(1);
            let (path, is_folder) = (entry.path(), entry.file_type().is_ok_and(|kind| kind.is_dir()));
            let ending = path.extension().map(|ending| ending.to_string_lossy().into_owned());
            let is_usual = ending.is_some_and(|ending| USUAL.contains(&ending.as_str()))
                || path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("sca-contribution"));
            match is_folder {
                true => waiting.push(path),
                false if left == 0 || !is_usual && !is_of_definitions(&path) => return true,
                false => {}
            }
        }
    }
    false
}

fn with_nearest<'a>(
    entry: &Entry,
    message: String,
    namespace: &str,
    all: impl Iterator<Item = &'a str> + Clone,
) -> Diagnostic {
    let one = Diagnostic::new(&codes::EXCHANGE, entry.at, message);
    match nearest(namespace, all.clone()) {
        Some(near) if !namespace.is_empty() => {
            let what = format!("replace {} with {}", quoted(namespace), quoted(near));
            one.suggest(what, entry.at, near)
        }
        _ => {
            let names: Vec<String> = all.take(5).map(quoted).collect();
            one.help(format!("it has {}", names.join(", ")))
        }
    }
}
