//! Checks of open texts, without a protocol.

mod classes;
mod fixes;
mod fleets;
mod positions;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use saoms_lang::model::LibraryLink;
use saoms_lang::project::{Classes, LibraryResolver};
use saoms_lang::registry::Registry;
use saoms_lang::source::OpenTexts;

use super::{CheckOptions, CheckUpdate, Checker, ClassCache, EditorDiagnostic, PluginSearch};
use crate::editor::testing::composite;

/// A search that finds no plugin.
#[derive(Debug)]
struct NoPlugins;

impl PluginSearch for NoPlugins {
    fn places(&self, _: &Path) -> Vec<PathBuf> {
        Vec::new()
    }

    fn find(&self, _: &Path, _: &str) -> Option<PathBuf> {
        None
    }

    fn libraries(&self, _: &Path) -> Rc<dyn LibraryResolver> {
        Rc::new(Self)
    }

    fn classes(&self, _: &Path) -> Classes {
        Registry::linked().unwrap().into()
    }
}

impl LibraryResolver for NoPlugins {
    fn open(&self, _: &Path, _: &str, _: &dyn Fn(&Path) -> Option<PathBuf>, _: &mut Registry) -> LibraryLink {
        LibraryLink::Missing(Vec::new())
    }

    fn declare(&self, _: &Path, _: &str, _: (&str, &str), _: &mut Registry) -> LibraryLink {
        LibraryLink::Missing(Vec::new())
    }
}

/// A folder that is not on disk.
const FOLDER: &str = "/nowhere";

/// An editor without a protocol: texts, and what the checks of them find.
struct Desk {
    checker: Checker,
    open: OpenTexts,
}

/// All diagnostics by file, as a check reports them.
type Diagnostics = BTreeMap<PathBuf, Arc<Vec<EditorDiagnostic>>>;

impl Desk {
    fn new(files: &[(&str, &str)]) -> Self {
        let checker = Checker::new(Arc::new(ClassCache::new(NoPlugins)), CheckOptions::default());
        let mut desk = Self { checker, open: OpenTexts::default() };
        files.iter().for_each(|(name, text)| desk.write(name, text));
        desk
    }

    fn write(&mut self, name: &str, text: &str) {
        self.open.insert(&Path::new(FOLDER).join(name), text.to_owned());
    }

    /// All that a check reports, one after another.
    fn updates(&mut self, looks_anew: bool) -> Vec<Diagnostics> {
        let mut all = Vec::new();
        self.checker.check(&self.open, looks_anew, &|| true, &mut |update| match update {
            CheckUpdate::Diagnostics(files) => all.push(files),
            CheckUpdate::Failed(failure) => panic!("{failure}"),
        });
        all
    }

    /// What is wrong in the end, as `file code`.
    fn found(&mut self) -> Vec<String> {
        let last = self.updates(true).pop().unwrap();
        shown(&last)
    }
}

fn shown(files: &Diagnostics) -> Vec<String> {
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    let all = files.iter().flat_map(|(path, all)| all.iter().map(move |one| format!("{} {}", name(path), one.code)));
    all.collect()
}

/// A composite of this name.
fn named(name: &str, inside: &str) -> String {
    composite(inside).replacen("name=\"fleet\"", &format!("name=\"{name}\""), 1)
}

const WRONG: &str = "<component name=\"A\"><implementation.java class=\"saoms.Robto\"/></component>";
const RIGHT: &str = "<component name=\"A\"><implementation.java class=\"resources.robotEnvironment.GPS\"/></component>";
