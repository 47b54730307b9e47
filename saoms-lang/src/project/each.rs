//! Several fleets: the files together are one, and each folder has its own.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::merge::Merged;
use super::{ClassPath, Classes, Input, PluginFault, Project, folder, load};
use crate::assembly::Assembly;
use crate::check::{self, Options};
use crate::contribution::{Finder, FolderFleet, SideFile};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::model::Contribution;
use crate::source::{Sources, identity};

/// The outcome of a compilation of several fleets.
#[derive(Debug)]
pub struct Compilations {
    /// The assemblies; fleets with errors have none.
    pub outputs: Vec<FleetOutput>,
    /// The number of fleets.
    pub fleets: usize,
    /// The texts that were read.
    pub sources: Sources,
    /// All diagnostics, fleet by fleet; those of a composite that several fleets name are there once.
    pub diagnostics: Vec<Diagnostic>,
    /// Faults of plugins, which have no place in a composite.
    pub problems: Vec<PluginFault>,
}

/// The assembly of one of several fleets.
#[derive(Debug)]
pub struct FleetOutput {
    /// The first file of the fleet.
    pub file: PathBuf,
    /// The assembly.
    pub output: Assembly,
}

/// A fleet among several.
struct Member {
    inputs: Vec<Input>,
    /// True if it is known to run by itself.
    is_deployable: bool,
    /// True if the contribution gives it to others.
    is_exported: bool,
}

impl Project {
    /// The faults of contributions, without those of their composites: every input is a folder.
    pub fn check_folders(&self, finder: &mut Finder) -> (Vec<Diagnostic>, Sources) {
        let (mut sources, mut diagnostics) = (self.sources(), Diagnostics::new());
        for folder in load::files(&self.inputs) {
            finder.load_folder(&folder, self.max_size, &mut sources, &mut diagnostics);
        }
        (diagnostics.into_all(), sources)
    }

    /// Loads and checks every fleet of the inputs: files and texts are one together, each folder has its own.
    pub fn compile_each(&self, class_path: &impl ClassPath) -> Compilations {
        let (mut sources, mut diagnostics) = (self.sources(), Diagnostics::new());
        let mut finder = self.finder();
        let mut problems = Vec::new();
        let (mut fleets, beside) = self.fleets(&mut finder, &mut sources, &mut diagnostics);
        let options = self.options(&mut sources, &mut diagnostics);
        let options = Options { shared_settings: fleets.len() > 1, ..options };
        if !beside.component_types().is_empty() {
            let classes = class_path.classes(&load::files(&self.inputs));
            add_new(&mut problems, classes.problems);
            check::check(&beside, &classes.registry, &options, &sources, &mut diagnostics);
        }
        let mut merged = Merged::default();
        let mut count = fleets.len();
        merged.add(diagnostics.into_all(), true, &sources);
        let mut outputs = Vec::new();
        // Composites in one folder have the same plugins, which are read once.
        let mut known: HashMap<Vec<PathBuf>, Classes> = HashMap::new();
        // A fleet that a contribution exports is one of its own only where no other one that is checked takes it.
        fleets.sort_by_key(|fleet| fleet.is_exported);
        let mut taken: HashSet<PathBuf> = HashSet::new();
        for Member { inputs, is_deployable, is_exported } in fleets {
            let files = load::files(&inputs);
            if is_exported && files.iter().all(|file| taken.contains(&identity(file))) {
                count -= 1;
                continue;
            }
            let folders = files.iter().filter_map(|file| file.parent().map(Path::to_owned)).collect();
            let classes = match known.entry(folders) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => {
                    let classes = new.insert(class_path.classes(&files));
                    add_new(&mut problems, std::mem::take(&mut classes.problems));
                    classes
                }
            };
            let start = (sources, Diagnostics::new());
            let loaded = self.load_fleet(&inputs, &mut finder, classes.clone(), options.clone(), start);
            let found = loaded.compile();
            sources = found.sources;
            // A composite that is made for others may lack what these give it, also where nothing else is in the
            // folder.
            let is_whole = is_deployable || count == 1 && !is_exported;
            merged.add(found.diagnostics, is_whole, &sources);
            let named = found.contribution.composites().iter().skip(inputs.len());
            taken.extend(named.map(|one| identity(Path::new(sources.get(one.file()).path()))));
            let file = files.into_iter().next().unwrap_or_default();
            outputs.extend(found.output.map(|output| FleetOutput { file, output }));
        }
        let diagnostics = merged.finish(count);
        Compilations { outputs, fleets: count, sources, diagnostics, problems }
    }

    /// The fleets of the inputs, and a contribution of the component types among them. Other files beside composites
    /// are checked at once.
    fn fleets(
        &self,
        finder: &mut Finder,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> (Vec<Member>, Contribution) {
        let mut folders: Vec<PathBuf> = Vec::new();
        let (mut inputs, mut beside) = (Vec::new(), Contribution::default());
        for input in &self.inputs {
            if let Some(folder) = folder::folder_of(input, &self.inputs) {
                folders.push(folder);
                continue;
            }
            let found = match input {
                Input::Path(path) => finder.load_side_file(path, self.max_size, sources, diagnostics),
                Input::Text { .. } => None,
            };
            match found {
                None => inputs.push(input.clone()),
                Some(SideFile::ComponentType(Some(made))) => _ = beside.add_component_type(*made),
                Some(SideFile::ComponentType(None) | SideFile::Checked) => {}
            }
        }
        let together = Member { inputs, is_deployable: true, is_exported: false };
        let mut fleets: Vec<Member> = Some(together).filter(|one| !one.inputs.is_empty()).into_iter().collect();
        for folder in folders {
            let found = finder.load_folder(&folder, self.max_size, sources, diagnostics);
            fleets.extend(found.into_iter().map(Member::from));
        }
        (fleets, beside)
    }
}

impl From<FolderFleet> for Member {
    fn from(FolderFleet { files, is_deployable, is_exported }: FolderFleet) -> Self {
        Self { inputs: files.into_iter().map(Input::Path).collect(), is_deployable, is_exported }
    }
}

/// Adds problems that are not known yet: several folders can have the same plugin.
fn add_new(known: &mut Vec<PluginFault>, found: Vec<PluginFault>) {
    for one in found {
        if !known.contains(&one) {
            known.push(one);
        }
    }
}
