//! The files around a composite: what it names, and the contribution that it is part of.
//!
//! A contribution is a folder of composites, described by `sca-contribution.xml` where it has one. [`load_named`] finds
//! the composites and component types that composites name, [`load_folder`] the fleets of a folder, and [`read_values`]
//! the values that are in files.

mod component_types;
mod exchange;
mod finder;
mod fleets;
mod head;
mod imports;
mod index;
mod overrides;
mod resolve;
#[cfg(test)]
mod tests;
mod value_file;
mod values;

use std::path::Path;

pub use finder::{Finder, SideFile};
pub use fleets::{FolderFleet, composites_below, load_folder};
pub use imports::{imported_near, importing_near};
pub use index::{composites_near, description_near, root};
pub use overrides::table;
pub use resolve::load_named;
pub use values::{read_tables, read_values};

use crate::diagnostic::Diagnostics;
use crate::load::{MAX_SIZE, load_file, read};
use crate::model::Composite;
use crate::source::Sources;

/// Reads the composite in the file `path` and the files of its values, each of at most [`MAX_SIZE`] bytes; see
/// [`load_file`] and [`read_values`].
pub fn load(path: &Path, sources: &mut Sources, diagnostics: &mut Diagnostics) -> Option<Composite> {
    let file = read(path, MAX_SIZE, sources, diagnostics)?;
    let mut composite = load_file(file, sources, diagnostics)?;
    read_values(&mut composite, MAX_SIZE, sources, diagnostics);
    Some(composite)
}
