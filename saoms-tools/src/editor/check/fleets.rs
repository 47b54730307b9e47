//! The fleets that open files are part of, with what a check found in each, kept until one of its files changes.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use saoms_lang::contribution::Finder;
use saoms_lang::diagnostic::{Diagnostic, codes};
use saoms_lang::project::Project;
use saoms_lang::source::{OpenTexts, Sources, identity};

use super::checker::CheckOptions;
use super::classes::ClassCache;
use super::diagnostic::{EditorDiagnostic, merged, reported};
use crate::editor::scene::Scene;
use crate::editor::scene::workspace::{Shape, Workspace};

/// Files that are checked together.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Fleet {
    /// Composites; of some that others elsewhere may use, what they leave open is no fault.
    Composites { files: Vec<PathBuf>, may_be_part: bool },
    /// The description of a contribution, and the names of the composites there.
    Description(PathBuf),
}

/// The result of the check of one fleet.
#[derive(Debug)]
pub(super) struct Found {
    files: BTreeMap<PathBuf, Arc<Vec<EditorDiagnostic>>>,
    /// All files that were read for it.
    sources: HashSet<PathBuf>,
}

/// What open files are part of.
#[derive(Debug, Default)]
pub(super) struct CheckedFleets {
    open: OpenTexts,
    /// What the fleets follow from, of each open file.
    shapes: HashMap<PathBuf, Shape>,
    /// The fleets in the order of the open files, each once.
    all: Vec<Fleet>,
    /// The open composites, which some fleet has to lead to.
    composites: Vec<PathBuf>,
    /// What is known of these and of single files that no fleet leads to.
    found: HashMap<Fleet, Found>,
    stale: HashSet<Fleet>,
}

impl CheckedFleets {
    /// Takes in the open texts. Gives the files that changed.
    pub(super) fn update(
        &mut self,
        open: &OpenTexts,
        looks_anew: bool,
        workspace: &mut Workspace,
        classes: &ClassCache,
    ) -> HashSet<PathBuf> {
        let known = std::mem::replace(&mut self.open, open.clone());
        let is_new = |path: &&Path| {
            let (before, now) = (known.get(path), open.get(path));
            before.zip(now).is_none_or(|(before, now)| !Arc::ptr_eq(before, now))
        };
        let changed: HashSet<PathBuf> = open.paths().filter(is_new).map(Path::to_owned).collect();
        let (mut is_named_anew, mut names_others) = (looks_anew, looks_anew);
        self.shapes.retain(|path, _| open.get(path).is_some());
        for path in &changed {
            let shape = workspace.shape(path);
            let before = self.shapes.insert(path.clone(), shape);
            is_named_anew |= before.is_none_or(|before| before.names != shape.names);
            names_others |= before.is_none_or(|before| before.uses != shape.uses);
        }
        if is_named_anew || names_others {
            self.find(workspace, classes);
        }
        let has_changed = |fleet: &Fleet, found: &Found| {
            is_named_anew || fleet.files().iter().chain(&found.sources).any(|file| changed.contains(file))
        };
        self.stale
            .extend(self.found.iter().filter(|(fleet, found)| has_changed(fleet, found)).map(|(one, _)| one.clone()));
        changed
    }

    /// Finds the fleets of all open files. Files with the same others around them are looked at together.
    fn find(&mut self, workspace: &mut Workspace, classes: &ClassCache) {
        let paths: BTreeSet<PathBuf> = self.open.paths().map(Path::to_owned).collect();
        let mut groups: HashMap<PathBuf, (Scene, HashMap<PathBuf, usize>)> = HashMap::new();
        let around = |workspace: &mut Workspace, path: &Path| {
            let scene = Scene::new(workspace.around(path), classes.of(path, &[]));
            let places = scene.files.iter().enumerate().map(|(place, file)| (file.path.clone(), place)).collect();
            (scene, places)
        };
        let (mut all, mut seen) = (Vec::new(), HashSet::new());
        self.composites.clear();
        for path in paths {
            let group = workspace.group(&path);
            let group = groups.entry(group).or_insert_with(|| around(workspace, &path));
            let alone;
            let (scene, places) = match group.1.contains_key(&path) {
                true => &*group,
                // What others take no values from, or from elsewhere.
                false => {
                    alone = around(workspace, &path);
                    &alone
                }
            };
            let mut add = |fleet: Fleet| {
                if seen.insert(fleet.clone()) {
                    all.push(fleet);
                }
            };
            let Some(&place) = places.get(&path) else {
                self.composites.push(path);
                continue;
            };
            match &scene.files[place] {
                one if one.is_beside => {}
                one if one.is_description() => add(Fleet::Description(path)),
                _ => self.composites.push(path),
            }
            for fleet in scene.fleets_of(place) {
                let files: Vec<PathBuf> = fleet.files.iter().map(|file| scene.files[*file].path.clone()).collect();
                if !files.is_empty() {
                    add(Fleet::Composites { files, may_be_part: fleet.may_be_part });
                }
            }
        }
        self.found.retain(|fleet, _| seen.contains(fleet));
        self.stale.retain(|fleet| seen.contains(fleet));
        self.all = all;
    }

    /// The fleets that are to be checked: those that have to do with these files, and the others.
    pub(super) fn stale(&self, changed: &HashSet<PathBuf>) -> (Vec<Fleet>, Vec<Fleet>) {
        let is_stale = |fleet: &&Fleet| self.stale.contains(*fleet) || !self.found.contains_key(*fleet);
        let is_concerned = |fleet: &Fleet| {
            let sources = self.found.get(fleet).into_iter().flat_map(|found| &found.sources);
            fleet.files().iter().chain(sources).any(|file| changed.contains(file))
        };
        self.all.iter().filter(is_stale).cloned().partition(is_concerned)
    }

    /// The open composites to which no fleet leads, each as one of its own that is to be checked.
    pub(super) fn unseen(&mut self) -> Vec<Fleet> {
        let known: HashSet<&Fleet> = self.all.iter().collect();
        let sources = self.all.iter().filter_map(|fleet| self.found.get(fleet)).flat_map(|found| &found.sources);
        let seen: HashSet<&PathBuf> = sources.collect();
        let unseen = self.composites.iter().filter(|path| !seen.contains(path));
        let alone = unseen.map(|path| Fleet::Composites { files: vec![path.clone()], may_be_part: false });
        let alone: HashSet<Fleet> = alone.filter(|fleet| !known.contains(fleet)).collect();
        self.found.retain(|fleet, _| known.contains(fleet) || alone.contains(fleet));
        let is_stale = |fleet: &Fleet| self.stale.contains(fleet) || !self.found.contains_key(fleet);
        alone.into_iter().filter(is_stale).collect()
    }

    pub(super) fn add(&mut self, fleet: &Fleet, found: Found) {
        self.stale.remove(fleet);
        self.found.insert(fleet.clone(), found);
    }

    /// All diagnostics by file.
    pub(super) fn diagnostics(&self) -> BTreeMap<PathBuf, Arc<Vec<EditorDiagnostic>>> {
        let mut all: BTreeMap<&PathBuf, Vec<&Arc<Vec<EditorDiagnostic>>>> = BTreeMap::new();
        let of_fleets = self.all.iter().filter_map(|fleet| self.found.get(fleet));
        let known: HashSet<&Fleet> = self.all.iter().collect();
        let of_single = self.found.iter().filter(|(fleet, _)| !known.contains(fleet)).map(|(_, found)| found);
        for found in of_fleets.chain(of_single) {
            for (path, diagnostics) in &found.files {
                all.entry(path).or_default().push(diagnostics);
            }
        }
        let merged = |of_fleets: &[&Arc<Vec<EditorDiagnostic>>]| match of_fleets {
            [one] => Arc::clone(one),
            _ => merged(of_fleets),
        };
        all.into_iter().map(|(path, of_fleets)| (path.clone(), merged(&of_fleets))).collect()
    }
}

impl Fleet {
    /// The files that it is named by.
    fn files(&self) -> &[PathBuf] {
        match self {
            Self::Composites { files, .. } => files,
            Self::Description(path) => std::slice::from_ref(path),
        }
    }

    /// Checks it, with all that it names.
    pub(super) fn check(
        &self,
        open: &OpenTexts,
        options: CheckOptions,
        finder: &mut Finder,
        classes: &ClassCache,
    ) -> Found {
        match self {
            Self::Composites { files, may_be_part } => {
                // Nothing of a plugin runs because somebody looks at a file.
                let project = Project::new()
                    .files(files)
                    .open_texts(open.clone())
                    .allow_outside(options.allow_outside)
                    .assume_classes(options.assume_classes)
                    .without_plugin_code()
                    .part(*may_be_part);
                let found = project.load_with(finder, classes).compile();
                let reported: Vec<_> = found.reported().cloned().collect();
                self.found(&reported, &found.sources)
            }
            Self::Description(path) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                let inner = folder.ends_with("META-INF").then(|| folder.parent()).flatten();
                let project = Project::new().file(inner.unwrap_or(folder)).open_texts(open.clone());
                let (mut found, sources) = project.check_folders(finder);
                found.retain(|one| one.code != &codes::FILE_IS_DIRECTORY);
                self.found(&found, &sources)
            }
        }
    }

    /// The result of a check that failed.
    pub(super) fn unchecked(&self) -> Found {
        self.found(&[], &Sources::new())
    }

    fn found(&self, diagnostics: &[Diagnostic], sources: &Sources) -> Found {
        let mut files: BTreeMap<PathBuf, Vec<EditorDiagnostic>> = BTreeMap::new();
        for (path, one) in reported(diagnostics, sources) {
            files.entry(path).or_default().push(one);
        }
        let read = sources.iter().map(|(_, file)| identity(Path::new(file.path())));
        let sources = self.files().iter().cloned().chain(read).collect();
        Found { files: files.into_iter().map(|(path, all)| (path, merged(&[&Arc::new(all)]))).collect(), sources }
    }
}
