//! The finder: one for all contributions of a check, so that each file is read once.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::fleets::InnerDeployable;
use super::head;
use super::imports::Imports;
use super::index::{Index, is_of_definitions};
use crate::diagnostic::{Candidates, Diagnostic, Diagnostics, Severity, codes, quoted};
use crate::limits::{EXPLAINED_FILE_BYTES, EXPLAINED_FILES, EXPLAINED_NAMES, OFFERED_NAMES};
use crate::load::description::DESCRIPTIONS;
use crate::load::vocabulary::{CONTRIBUTION, DEFINITIONS};
use crate::load::{ReadContext, definitions, load_component_type, load_file, read};
use crate::model::{ComponentType, Version};
use crate::source::{OpenTexts, Sources, Span};

/// Finder of what composites name in other files. It looks at each folder and each first tag of a file once: with one
/// finder for all fleets of a folder, the time of their checks grows linearly with their number.
///
/// It does not see what changes on disk while it is used.
pub struct Finder {
    pub(super) index: Index,
    pub(super) imports: Imports,
    /// The contributions around others; faults of their descriptions are not reported.
    pub(super) around: Option<Imports>,
    /// The number of right names that may still be compared with wrong ones.
    pub(super) candidates: Candidates,
    /// The number of unresolved names whose search path may still be listed.
    pub(super) explained: usize,
    /// The files of folders that are called as composites and are none, with the reason.
    unread: HashMap<PathBuf, Vec<(PathBuf, String)>>,
    /// The files of composites that share a name, which is reported.
    pub(super) repeated: HashSet<PathBuf>,
    /// The files of deployable composites that others use.
    pub(crate) inner_deployables: HashMap<PathBuf, InnerDeployable>,
}

impl Finder {
    /// Nothing is known yet but the texts that count in place of files.
    pub fn new(open: OpenTexts) -> Self {
        Self {
            index: Index::new(open),
            imports: Imports::default(),
            around: None,
            candidates: Candidates::default(),
            explained: EXPLAINED_NAMES,
            unread: HashMap::new(),
            repeated: HashSet::new(),
            inner_deployables: HashMap::new(),
        }
    }

    /// Checks a file that is no composite but one beside them: definitions of policies, the description of a
    /// contribution, or a component type. `None` where its first tag is none of these, and where its name ends with
    /// `.composite`.
    pub fn load_side_file(
        &mut self,
        path: &Path,
        max_size: u64,
        sources: &mut Sources,
        diagnostics: &mut Diagnostics,
    ) -> Option<SideFile> {
        if path.extension().is_some_and(|ending| ending == "composite") {
            return None;
        }
        let (name, namespace) = head::root(path, sources.open())?;
        let is_of_sca = namespace.is_some_and(|namespace| Version::from_namespace(&namespace).is_some());
        let folder = path.parent().unwrap_or(Path::new(""));
        if name == DEFINITIONS.name && (is_of_sca || is_of_definitions(path)) {
            definitions::check(path, true, &mut ReadContext { max_size, sources, diagnostics });
        } else if name == CONTRIBUTION.name {
            let above = folder.parent().filter(|_| folder.ends_with("META-INF"));
            let context = &mut ReadContext { max_size, sources, diagnostics };
            misnamed(path, context);
            self.describe(path, above.unwrap_or(folder), context);
        } else if name == "componentType" {
            let file = read(path, max_size, sources, diagnostics);
            let made = file.and_then(|file| load_component_type(file, sources, diagnostics));
            return Some(SideFile::ComponentType(made.map(Box::new)));
        } else {
            return None;
        }
        Some(SideFile::Checked)
    }

    /// The reasons why files are not read that may hold a composite of this name, the file of that name first.
    pub(super) fn unread(&mut self, folder: &Path, local: &str, open: &OpenTexts) -> Vec<String> {
        if !self.unread.contains_key(folder) {
            let all = self.index.unread(folder).into_iter().take(EXPLAINED_FILES);
            let all = all.filter_map(|path| Some((reason(&path, open)?, path)));
            let all = all.map(|(reason, path)| (path, reason)).collect();
            self.unread.insert(folder.to_owned(), all);
        }
        let all = &self.unread[folder];
        let is_called_so = |path: &Path| path.file_stem().is_some_and(|stem| stem == local);
        let first = all.iter().filter(|(path, _)| is_called_so(path));
        let others = all.iter().filter(|(path, _)| !is_called_so(path));
        let shown = |(path, reason): &(PathBuf, String)| {
            format!("{} is not a composite: {reason}", quoted(&path.display().to_string()))
        };
        first.chain(others).take(OFFERED_NAMES).map(shown).collect()
    }
}

/// A file beside composites.
#[derive(Debug)]
pub enum SideFile {
    /// The composites need it when they are checked: its faults are reported already.
    Checked,
    /// The description of an implementation, which the checker holds to itself; `None` where it could not be read.
    ComponentType(Option<Box<ComponentType>>),
}

/// Names that people give to the description of a contribution, which is not found by them.
const NEAR_DESCRIPTIONS: [&str; 6] = [
    "contribution.xml", "sca_contribution.xml", "sca-contributions.xml", "sca.contribution.xml",
    "SCA-Contribution.xml", "sca-contribution.xml.txt",
];

/// Reports a file in a folder without a description that is meant as one: what it says would be passed over silently.
pub(super) fn misnamed_in(folder: &Path, context: &mut ReadContext<'_>) {
    let mut named = NEAR_DESCRIPTIONS.iter().map(|name| folder.join(name));
    let is_meant = |path: &PathBuf| {
        path.is_file()
            && head::root(path, context.sources.open())
                .is_some_and(|(local, namespace)| local == "contribution" && is_of_sca(namespace.as_deref()))
    };
    if let Some(path) = named.find(is_meant) {
        misnamed(&path, context);
    }
}

fn is_of_sca(namespace: Option<&str>) -> bool {
    namespace.is_some_and(|namespace| Version::from_namespace(namespace).is_some())
}

/// Reports the description of a contribution in a file where none is looked for.
fn misnamed(path: &Path, context: &mut ReadContext<'_>) {
    if DESCRIPTIONS.iter().any(|name| path.ends_with(name)) {
        return;
    }
    let usual = quoted(DESCRIPTIONS[1]);
    let file = context.sources.add(path.display().to_string(), "");
    let message = format!("this describes a contribution, but a description is read only from {usual}");
    let one = Diagnostic::new(&codes::ROOT, Span::empty(0).in_file(file), message).severity(Severity::Warning);
    context.diagnostics.push(one.help(format!("rename the file to {usual}")));
}

/// The fault of a file that should be a composite.
fn reason(path: &Path, open: &OpenTexts) -> Option<String> {
    let (mut sources, mut diagnostics) = (Sources::with_open(open.clone()), Diagnostics::new());
    let file = read(path, EXPLAINED_FILE_BYTES, &mut sources, &mut diagnostics);
    file.and_then(|file| load_file(file, &sources, &mut diagnostics));
    let fault = diagnostics.into_sorted().into_iter().find(|one| one.severity == Severity::Error)?;
    Some(fault.message)
}
