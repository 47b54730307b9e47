//! Files of a contribution that are no composites: descriptions, definitions and component types.

use std::path::Path;

use super::finder::Finder;
use super::head;
use super::index::is_of_definitions;
use crate::diagnostic::Diagnostics;
use crate::load::definitions;
use crate::load::vocabulary::{CONTRIBUTION, DEFINITIONS};
use crate::load::{ReadContext, load_component_type, read};
use crate::model::{ComponentType, Version};
use crate::source::Sources;

/// A file beside composites.
#[derive(Debug)]
pub enum SideFile {
    /// The composites need it when they are checked: its faults are reported already.
    Checked,
    /// The description of an implementation, which the checker holds to itself; `None` where it could not be read.
    ComponentType(Option<Box<ComponentType>>),
}

impl Finder {
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
}
