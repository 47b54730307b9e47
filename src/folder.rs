//! Folders on the command line: contributions, with the fleets in them.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use saoms_lang::check::Options;
use saoms_lang::diagnostic::{Diagnostic, Diagnostics, Severity, codes, quoted};
use saoms_lang::load::{Finder, FolderFleet, SideFile};
use saoms_lang::model::Contribution;
use saoms_lang::registry::Registry;
use saoms_lang::source::{Sources, Span, identity};

use crate::Exit;
use crate::arguments::FleetArguments;
use crate::fleet::{Asked, Checked, Checker, checked_with, options};
use crate::plugins::{registry, search};

/// Composites that are named where one of them has to be.
const OFFERED: usize = 5;

/// The files of the one fleet that these paths stand for: for a folder those that run in it. Where that is unclear, it is reported.
pub(crate) fn one_fleet(
    paths: &[PathBuf],
    max_size: u64,
    finder: &mut Finder,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> Vec<PathBuf> {
    let mut files = Vec::with_capacity(paths.len());
    for path in paths {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let mut fleets = finder.load_folder(path, max_size, sources, diagnostics);
        if fleets.iter().any(|one| one.is_deployable) {
            fleets.retain(|one| one.is_deployable);
        }
        match &fleets[..] {
            [] => {}
            [only] => files.extend_from_slice(&only.files),
            several => diagnostics.push(unclear(path, several, sources)),
        }
    }
    files
}

fn unclear(folder: &Path, fleets: &[FolderFleet], sources: &mut Sources) -> Diagnostic {
    let file = sources.add(folder.display().to_string(), "");
    let message = format!("a directory with {} fleets, and one is asked for", fleets.len());
    let firsts = fleets.iter().filter_map(|fleet| fleet.files.first());
    let mut names: Vec<String> =
        firsts.take(OFFERED).map(|path| quoted(&path.display().to_string())).collect();
    if fleets.len() > OFFERED {
        names.push(format!("{} more", fleets.len() - OFFERED));
    }
    let one = Diagnostic::new(&codes::FILE_IS_DIRECTORY, Span::empty(0).in_file(file), message);
    let one = one.help(format!("name one: {}", names.join(", ")));
    if fleets[0].is_deployable {
        return one;
    }
    let description = folder.join("sca-contribution.xml");
    one.help(format!(
        "or let {} say what runs: `<deployable composite=\"...\"/>`",
        quoted(&description.display().to_string())
    ))
}

/// What a check of several fleets comes to.
pub(crate) struct Several<T> {
    /// All that is wrong.
    pub(crate) checked: Checked<T>,
    /// What the checker made of the fleets, with the first file of each; those with errors are not among them.
    pub(crate) made: Vec<(PathBuf, T)>,
    /// How many fleets there are.
    pub(crate) fleets: usize,
}

/// Checks every fleet that these paths stand for: the files together are one, and each folder has its own.
///
/// # Errors
/// A plugin cannot be used, which was told.
pub(crate) fn checked_each<T>(
    arguments: &FleetArguments,
    asked: Options,
    check: Checker<T>,
) -> Result<Several<T>, Exit> {
    let mut sources = Sources::new();
    let mut diagnostics = Diagnostics::new();
    let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) =
        arguments.files.iter().cloned().partition(|path| path.is_dir());
    let mut finder = Finder::new(sources.open().clone());
    let mut fleets = Vec::new();
    let (files, beside) = side_files(files, arguments.max_size, &mut finder, &mut sources, &mut diagnostics);
    if !files.is_empty() {
        fleets.push(FolderFleet { files, is_deployable: true, is_exported: false });
    }
    for folder in &folders {
        fleets.extend(finder.load_folder(folder, arguments.max_size, &mut sources, &mut diagnostics));
    }
    let options = options(arguments, asked, &mut sources, &mut diagnostics);
    let options = Options { shared_settings: fleets.len() > 1, ..options };
    if !beside.component_types().is_empty() {
        let registry = registry(&arguments.plugins, &arguments.files)?;
        _ = check(&beside, &registry, &options, &sources, &mut diagnostics);
    }
    let mut merged = Merged::default();
    let mut count = fleets.len();
    merged.add(diagnostics.into_all(), true, &sources);
    let mut contribution = Contribution::default();
    let mut made = Vec::new();
    // Composites in one folder have the same plugins, whose faults are told once.
    let mut registries: HashMap<Vec<PathBuf>, Registry> = HashMap::new();
    // What a contribution exports is a fleet of its own only where no other one that is checked takes it.
    fleets.sort_by_key(|fleet| fleet.is_exported);
    let mut taken: HashSet<PathBuf> = HashSet::new();
    for FolderFleet { files, is_deployable, is_exported } in fleets {
        if is_exported && files.iter().all(|file| taken.contains(&identity(file))) {
            count -= 1;
            continue;
        }
        let beside: Vec<PathBuf> =
            files.iter().filter_map(|file| file.parent().map(Path::to_owned)).collect();
        let registry = match registries.entry(beside) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(registry(&arguments.plugins, &files)?),
        };
        let search = search(&arguments.plugins, &files);
        let (options, registry) = (options.clone(), registry.clone());
        let asked = Asked {
            files: &files,
            max_size: arguments.max_size,
            options,
            search: &search,
            finder: &mut finder,
        };
        let found = checked_with(check, asked, registry, sources, Diagnostics::new());
        sources = found.sources;
        // What is made for others alone may lack what these give it, also where nothing else is in the folder.
        let is_whole = is_deployable || count == 1 && !is_exported;
        merged.add(found.diagnostics, is_whole, &sources);
        contribution = found.contribution;
        let named = contribution.composites().iter().skip(files.len());
        taken.extend(named.map(|one| identity(Path::new(sources.get(one.file()).path()))));
        made.extend(files.into_iter().next().zip(found.made));
    }
    let diagnostics = merged.finish(count);
    let checked = Checked { made: None, contribution, sources, diagnostics };
    Ok(Several { checked, made, fleets: count })
}

/// Checks those among files that are no composites but stand beside them; gives the others, and a contribution of the component types.
fn side_files(
    mut files: Vec<PathBuf>,
    max_size: u64,
    finder: &mut Finder,
    sources: &mut Sources,
    diagnostics: &mut Diagnostics,
) -> (Vec<PathBuf>, Contribution) {
    let mut beside = Contribution::default();
    files.retain(|path| {
        let found = finder.load_side_file(path, max_size, sources, diagnostics);
        if let Some(SideFile::ComponentType(Some(made))) = found {
            beside.add_component_type(*made);
            return false;
        }
        found.is_none()
    });
    (files, beside)
}

/// Whether it is for those who use a composite to mend: it is no fault where these may be elsewhere.
pub(crate) fn is_of_user(one: &Diagnostic) -> bool {
    [&codes::COMPOSITE_PROPERTY_MISSING, &codes::PROMOTED_UNWIRED].contains(&one.code)
}

/// The diagnostics of several fleets, in which composites can be that several of them name.
#[derive(Default)]
struct Merged {
    all: Vec<Diagnostic>,
    /// What was said of each place with each code.
    known: HashMap<(String, Span, &'static str), Told>,
    fleets: usize,
    /// Settings that fleets do not know: a fault where none of them does.
    unknown: Vec<Diagnostic>,
}

/// What a fleet says of a place.
struct Told {
    fleet: usize,
    worst: Severity,
    messages: Vec<String>,
}

impl Merged {
    /// Adds those of a fleet. One that is not `whole`, and that nobody says runs by itself, may lack what those that use it give.
    fn add(&mut self, found: Vec<Diagnostic>, is_whole: bool, sources: &Sources) {
        self.fleets += 1;
        for one in found {
            if is_of_user(&one) && !is_whole {
                continue;
            }
            if one.code == &codes::UNKNOWN_SETTING {
                self.unknown.push(one);
                continue;
            }
            let path = sources.get(one.location.file).path().to_owned();
            // What a fleet says of a place is not said again of another one in other words, unless it is worse there.
            let new = Told { fleet: self.fleets, worst: one.severity, messages: Vec::new() };
            let told = self.known.entry((path, one.location.span, one.code.id)).or_insert(new);
            let is_wanted = told.fleet == self.fleets || one.severity > told.worst;
            if is_wanted && !told.messages.contains(&one.message) {
                told.fleet = self.fleets;
                told.worst = told.worst.max(one.severity);
                told.messages.push(one.message.clone());
                self.all.push(one);
            }
        }
    }

    fn finish(mut self, fleets: usize) -> Vec<Diagnostic> {
        while let Some(first) = self.unknown.first().cloned() {
            let (same, others): (Vec<_>, Vec<_>) =
                self.unknown.into_iter().partition(|one| one.location == first.location);
            self.unknown = others;
            if same.len() >= fleets {
                self.all.push(first.severity(Severity::Error));
            }
        }
        self.all
    }
}
