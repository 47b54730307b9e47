//! The files around a composite: what it names, and the contribution that it is part of.
//!
//! A contribution is a folder of composites, described by `sca-contribution.xml` where it has one.
//! [`Finder::load_named`] finds the composites and component types that composites name, [`Finder::load_folder`] the
//! fleets of a folder, and [`read_values`] the values that are in files.

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

pub use finder::{Finder, SideFile};
pub(crate) use fleets::InnerDeployable;
pub use fleets::{FolderFleet, composites_below};
pub use imports::{imported_near, importing_near};
pub use index::{composites_near, description_near, root};
pub use overrides::table;
pub use values::{read_tables, read_values};
