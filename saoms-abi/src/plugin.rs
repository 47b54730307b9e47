use core::ptr;

use crate::{Bytes, ClassTable, ImplementationTable, LoopClassTable, RuleTable, VERSION};

/// The section of a library that holds its metadata: one JSON text, which is read before anything in the library
/// runs.
///
/// | member | meaning |
/// | --- | --- |
/// | `saoms` | `"plugin"` |
/// | `abi` | the [`VERSION`] of the boundary |
/// | `api` | the version of `saoms-api` that the library was built with, for people |
/// | `package`, `version` | those of the library, for people |
/// | `panic` | `unwind`; a library whose panics abort is refused |
/// | `entry` | the name of its function of type [`EntryPoint`] |
/// | `classes` | the declarations of its classes, as `saoms-api/src/host/declaration` describes them |
/// | `loops` | those of its loops |
/// | `rules` | its rules over whole fleets |
/// | `implementations` | the languages whose classes it runs, such as `python`: see [`ImplementationTable`] |
///
/// A rule:
///
/// ```json
/// {"code": "X0001", "name": "one-clock", "meaning": "...", "severity": "warning", "rule": null,
///  "judgesParts": true, "preventsStart": false}
/// ```
pub const SECTION: &str = ".saoms.plugin";

/// The function by which a library gives its table: it takes the version of the program's boundary.
pub type EntryPoint = unsafe extern "C" fn(version: u32) -> *const PluginTable;

/// The tables of what a library offers, each list in the order of its metadata.
#[repr(C)]
#[derive(Debug)]
pub struct PluginTable {
    /// The size of this table in bytes.
    pub size: usize,
    /// The version of the boundary that the library was built with.
    pub version: u32,
    /// The metadata, as in its own section of the library.
    pub metadata: Bytes,
    /// The classes.
    pub classes: *const *const ClassTable,
    /// Their number.
    pub class_count: usize,
    /// The loops.
    pub loops: *const *const LoopClassTable,
    /// Their number.
    pub loop_count: usize,
    /// The rules over whole fleets.
    pub rules: *const *const RuleTable,
    /// Their number.
    pub rule_count: usize,
    /// The functions for classes in other languages. Null, or beyond the `size` of the table: there are none.
    pub implementations: *const ImplementationTable,
}

// SAFETY: what the pointers lead to is constant.
unsafe impl Sync for PluginTable {}

impl PluginTable {
    /// The table of a library with this metadata and these tables.
    pub const fn new(
        metadata: &'static [u8],
        classes: &'static [&'static ClassTable],
        loops: &'static [&'static LoopClassTable],
        rules: &'static [&'static RuleTable],
    ) -> PluginTable {
        PluginTable {
            size: size_of::<PluginTable>(),
            version: VERSION,
            metadata: Bytes::lend(metadata),
            classes: classes.as_ptr().cast(),
            class_count: classes.len(),
            loops: loops.as_ptr().cast(),
            loop_count: loops.len(),
            rules: rules.as_ptr().cast(),
            rule_count: rules.len(),
            implementations: ptr::null(),
        }
    }

    /// The same with functions for classes in other languages.
    pub const fn with_implementations(self, implementations: &'static ImplementationTable) -> PluginTable {
        PluginTable { implementations, ..self }
    }
}
