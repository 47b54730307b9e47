//! Folders among the inputs of one fleet.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::Input;
use crate::contribution::{Finder, FolderFleet, InnerDeployable};
use crate::diagnostic::{Diagnostic, Diagnostics, codes, quoted};
use crate::source::{Sources, Span};

/// Composites that are named where one of them has to be.
const OFFERED: usize = 5;

/// The inputs of one fleet: a folder means the files that run in it. A folder where that is unclear is reported.
pub(super) fn one_fleet(
    inputs: &[Input],
    max_size: u64,
    finder: &mut Finder,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Vec<Input> {
    let mut all = Vec::with_capacity(inputs.len());
    for input in inputs {
        let Some(path) = &folder_of(input, inputs) else {
            all.push(input.clone());
            continue;
        };
        let mut fleets = finder.load_folder(path, max_size, sources, diagnostics);
        if fleets.iter().any(|one| one.is_deployable) {
            fleets.retain(|one| one.is_deployable);
        }
        match &fleets[..] {
            [] => {}
            [only] => all.extend(only.files.iter().cloned().map(Input::Path)),
            several => diagnostics.push(unclear(path, several, sources)),
        }
    }
    all
}

/// The folder that an input means: itself, or the contribution that it describes. Beside other inputs a description is
/// a file as these are.
pub(super) fn folder_of(input: &Input, inputs: &[Input]) -> Option<PathBuf> {
    let Input::Path(path) = input else { return None };
    if path.is_dir() {
        return Some(path.clone());
    }
    if inputs.len() > 1 {
        return None;
    }
    let folder = path.parent()?;
    let name = path.file_name()?;
    let (folder, is_inside) = match folder.ends_with("META-INF") {
        true => (folder.parent()?, true),
        false => (folder, false),
    };
    let is_description = name == "sca-contribution.xml" || is_inside && name == "sca-contribution-generated.xml";
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    (is_description && path.is_file()).then(|| here.to_owned())
}

fn unclear(folder: &Path, fleets: &[FolderFleet], sources: &mut Sources) -> Diagnostic {
    let file = sources.add(folder.display().to_string(), "");
    let message = format!("found {} fleets in this folder, expected one", fleets.len());
    let firsts = fleets.iter().filter_map(|fleet| fleet.files.first());
    let mut names: Vec<String> = firsts.take(OFFERED).map(|path| quoted(&path.display().to_string())).collect();
    if fleets.len() > OFFERED {
        names.push(format!("{} more", fleets.len() - OFFERED));
    }
    let one = Diagnostic::new(&codes::FILE_IS_DIRECTORY, Span::empty(0).in_file(file), message);
    let one = one.help(format!("name one: {}", names.join(", ")));
    if fleets[0].is_deployable {
        return one;
    }
    let description: PathBuf = folder.join("sca-contribution.xml");
    one.help(format!(
        "or let {} say what runs: `<deployable composite=\"...\"/>`",
        quoted(&description.display().to_string())
    ))
}

/// True for a fault that those who use a composite have to mend: it is none where these may be elsewhere.
pub(super) fn is_left_to_users(one: &Diagnostic) -> bool {
    [&codes::COMPOSITE_PROPERTY_MISSING, &codes::PROMOTED_UNWIRED].contains(&one.code)
}

/// Adds why a composite that others use runs by itself to the faults that follow from that: the place to each of them,
/// what to do to the first.
pub(super) fn blame_deployables(
    diagnostics: &mut [Diagnostic],
    mut deployables: HashMap<PathBuf, InnerDeployable>,
    sources: &Sources,
) {
    for one in diagnostics.iter_mut().filter(|one| is_left_to_users(one)) {
        let Some(inner) = deployables.get_mut(Path::new(sources.get(one.location.file).path())) else { continue };
        *one = one.clone().label(inner.at, "it is deployable: it runs by itself");
        let user = std::mem::take(&mut inner.user);
        if !user.is_empty() {
            let help = format!(
                "list only composites as deployable that run by themselves: {} uses this one, and supplies what it lacks",
                quoted(&user)
            );
            one.help.insert(0, help);
        }
    }
}
