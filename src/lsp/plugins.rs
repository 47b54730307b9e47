//! The plugins around the composites of an editor, as `saoms check` finds them.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use saoms_core::plugin::Search;
use saoms_lang::project::{Classes, LibraryResolver, PluginFault};
use saoms_lang::registry::Registry;
use saoms_tools::editor::PluginSearch;

use crate::arguments::PluginArguments;
use crate::plugins::search;

impl PluginArguments {
    fn search(&self, file: &Path) -> Search {
        search(self, &[file.to_owned()])
    }
}

impl PluginSearch for PluginArguments {
    fn places(&self, file: &Path) -> Vec<PathBuf> {
        let Search { named, folders, around, .. } = self.search(file);
        named.into_iter().chain(folders).chain(around).collect()
    }

    fn find(&self, file: &Path, name: &str) -> Option<PathBuf> {
        self.search(file).find(file.parent().unwrap_or(Path::new("")), name).ok()
    }

    fn libraries(&self, file: &Path) -> Rc<dyn LibraryResolver> {
        Rc::new(self.search(file))
    }

    fn classes(&self, file: &Path) -> Classes {
        match Registry::linked() {
            Ok(linked) => self.search(file).classes(linked),
            Err(error) => {
                let problem = PluginFault { is_error: true, text: error.to_string() };
                Classes { problems: vec![problem], ..Registry::new().into() }
            }
        }
    }
}
