//! The step from the inputs of a project to the model.

use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};

use super::{ClassPath, Classes, Compilation, Input, PluginFault, Project, folder, libraries};
use crate::assembly::Assembly;
use crate::check::{self, Occurrences, Options, Setting, SeveritySetting, Variable};
use crate::contribution::{Finder, InnerDeployable, read_tables, read_values, root};
use crate::diagnostic::Diagnostics;
use crate::load::{self, STANDARD_INPUT, load_file, read_from};
use crate::model::{Composite, Contribution};
use crate::registry::Registry;
use crate::source::{FileId, Sources, Text};

/// The path that means standard input.
pub const INPUT: &str = "-";
/// The name that diagnostics have for the values of composite properties beside the files.
pub const SET: &str = "--set";
/// The name that diagnostics have for severities beside the files.
pub const SEVERITY: &str = "--severity";
/// The name that diagnostics have for the node that is to run.
pub const NODE: &str = "--node";

/// A fleet that was read and is not checked yet, with all that its composites name.
#[derive(Debug)]
pub struct Loaded {
    /// The composites.
    pub contribution: Contribution,
    /// The classes that they can name.
    pub registry: Registry,
    /// The texts that were read.
    pub sources: Sources,
    pub(super) problems: Vec<PluginFault>,
    pub(super) diagnostics: Diagnostics,
    pub(super) options: Options,
    pub(super) is_part: bool,
    /// The files of deployable composites that others use.
    pub(super) inner_deployables: HashMap<PathBuf, InnerDeployable>,
}

/// A step from the model to something: `None` where there is an error.
type Check<T> = fn(&Contribution, &Registry, &Options, &Sources, &mut Diagnostics) -> Option<T>;

/// Reads a file of at most `max_size` bytes, or standard input where the path is [`INPUT`].
pub fn read(path: &Path, max_size: u64, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<FileId> {
    if path == Path::new(INPUT) {
        return read_from(io::stdin().lock(), STANDARD_INPUT, max_size, sources, diagnostics);
    }
    load::read(path, max_size, sources, diagnostics)
}

impl Project {
    /// As [`load`](Self::load) with a [`finder`](Self::finder) that may know some of the files.
    pub fn load_with(&self, finder: &mut Finder, classes: &impl ClassPath) -> Loaded {
        let (mut sources, mut diagnostics) = (self.sources(), Diagnostics::new());
        let inputs = folder::one_fleet(&self.inputs, self.max_size, finder, &mut sources, &mut diagnostics);
        let options = self.options(&mut sources, &mut diagnostics);
        let classes = classes.classes(&files(&inputs));
        self.load_fleet(&inputs, finder, classes, options, (sources, diagnostics))
    }

    /// No texts yet. What is asked for may be read, and what belongs to it.
    pub(super) fn sources(&self) -> Sources {
        let permit = |path: &Path, folder: &Path| {
            self.open.permit(path);
            self.open.permit(folder);
            self.open.permit(&root(folder));
        };
        let above = |path: &Path| path.parent().unwrap_or(Path::new("")).to_owned();
        for input in &self.inputs {
            match input {
                Input::Path(path) if path.is_dir() => permit(path, path),
                Input::Path(path) => permit(path, &above(path)),
                Input::Text { name, .. } => permit(Path::new(name), &above(Path::new(name))),
            }
        }
        for (name, _) in &self.others {
            permit(Path::new(name), &above(Path::new(name)));
        }
        Sources::with_open(self.open.clone())
    }

    /// The options of a check, but for the variables, which the composites name.
    pub(super) fn options(&self, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Options {
        let settings = self.settings.iter();
        let settings = settings.filter_map(|text| Setting::parse(SET, text, sources, diagnostics)).collect();
        let severities = self.severities.iter();
        let severities =
            severities.filter_map(|text| SeveritySetting::parse(SEVERITY, text, sources, diagnostics)).collect();
        let node = self.node.as_ref().map(|node| Text::part_of(sources.add(NODE, node), node, node));
        Options {
            settings,
            severities,
            node,
            assume_classes: self.assume_classes,
            wiring: self.wiring,
            without_plugin_code: self.without_plugin_code,
            is_to_start: self.is_to_start,
            ..Options::default()
        }
    }

    /// Loads these inputs as one fleet; what was read and found before is kept.
    pub(super) fn load_fleet(
        &self,
        inputs: &[Input],
        finder: &mut Finder,
        classes: Classes,
        options: Options,
        (mut sources, mut diagnostics): (Sources, Diagnostics),
    ) -> Loaded {
        let Classes { mut registry, libraries, problems } = classes;
        let mut composites = Vec::with_capacity(inputs.len());
        for input in inputs {
            let file = match input {
                Input::Path(path) => read(path, self.max_size, &mut sources, &mut diagnostics),
                Input::Text { name, text } => Some(sources.add(name.as_str(), text.as_str())),
            };
            composites.extend(file.and_then(|file| self.composite(file, &mut sources, &mut diagnostics)));
        }
        let mut others = Vec::with_capacity(self.others.len());
        for (name, text) in &self.others {
            let file = sources.add(name.as_str(), text.as_str());
            others.extend(self.composite(file, &mut sources, &mut diagnostics));
        }
        let mut contribution = Contribution::with(composites, others);
        if !self.in_memory {
            finder.load_named(&mut contribution, self.max_size, &mut sources, &mut diagnostics);
        }
        if let Some(libraries) = libraries {
            libraries::open_named(&mut contribution, libraries.as_ref(), &sources, &mut registry);
        }
        let variables = Variable::read(&contribution, |name| (self.environment)(name), &mut sources, &mut diagnostics);
        let options = Options { variables, ..options };
        if !self.in_memory {
            read_tables(&mut contribution, self.max_size, &mut sources, &mut diagnostics, |contribution, sources| {
                check::wanted_tables(contribution, &registry, &options, sources)
            });
        }
        let inner_deployable = |path: PathBuf| Some((finder.inner_deployables.get(&path)?.clone(), path));
        let inner_deployables = files(inputs).into_iter().filter_map(inner_deployable);
        let inner_deployables = inner_deployables.map(|(inner, path)| (path, inner)).collect();
        let is_part = self.is_part;
        Loaded { contribution, registry, sources, problems, diagnostics, options, is_part, inner_deployables }
    }

    /// The composite in a text, with the values in files beside it.
    fn composite(&self, file: FileId, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<Composite> {
        let mut composite = load_file(file, sources, diagnostics)?;
        if !self.in_memory {
            read_values(&mut composite, self.max_size, sources, diagnostics);
        }
        Some(composite)
    }
}

impl Loaded {
    /// Checks the fleet. There is an assembly where there is no error.
    pub fn compile(self) -> Compilation<Assembly> {
        self.checked(check::check)
    }

    /// As [`Project::census`].
    pub fn census(self) -> Compilation<Occurrences> {
        self.checked(|contribution, registry, options, sources, diagnostics| {
            Some(Occurrences::of(contribution, registry, options, sources, diagnostics))
        })
    }

    fn checked<T>(self, check: Check<T>) -> Compilation<T> {
        let Self { contribution, registry, sources, problems, mut diagnostics, options, is_part, inner_deployables } =
            self;
        let output = check(&contribution, &registry, &options, &sources, &mut diagnostics);
        let mut diagnostics = diagnostics.into_all();
        if is_part {
            diagnostics.retain(|one| !folder::is_left_to_users(one));
        }
        folder::blame_deployables(&mut diagnostics, inner_deployables, &sources);
        Compilation { output, contribution, registry, sources, diagnostics, problems }
    }
}

/// The paths among inputs.
pub(super) fn files(inputs: &[Input]) -> Vec<PathBuf> {
    let path = |input: &Input| match input {
        Input::Path(path) => Some(path.clone()),
        Input::Text { .. } => None,
    };
    inputs.iter().filter_map(path).collect()
}
