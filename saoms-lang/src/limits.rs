//! Limits: bounds on work and output, so that time and memory grow with a file and not with its square, however hostile
//! it is.
//!
//! Lists in messages are cut where they are written.

use std::cell::Cell;

/// An allowance of work or output that all parts of a check share.
#[derive(Debug)]
pub(crate) struct Budget {
    /// The rest; `None` once it is exceeded.
    left: Cell<Option<u64>>,
    is_reported: Cell<bool>,
}

impl Budget {
    /// A budget of this size.
    pub(crate) fn of(limit: u64) -> Budget {
        Budget { left: Cell::new(Some(limit)), is_reported: Cell::new(false) }
    }

    /// Takes a part of it. Returns false once the parts are more than the whole.
    pub(crate) fn spend(&self, cost: u64) -> bool {
        self.left.set(self.left.get().and_then(|left| left.checked_sub(cost)));
        self.left.get().is_some()
    }

    /// The rest.
    pub(crate) fn left(&self) -> u64 {
        self.left.get().unwrap_or(0)
    }

    /// True for the first caller alone, who reports that it is exceeded.
    pub(crate) fn is_to_report(&self) -> bool {
        !self.is_reported.replace(true)
    }
}

// Files.
/// Size in bytes above which a file is refused unless something else is set: 256 MB.
pub const MAX_SIZE: u64 = 256_000_000;
/// Size in bytes that no setting exceeds: sources name bytes with 32 bits, and a byte behind the end must have a name.
pub(crate) const ADDRESSABLE_BYTES: u64 = u32::MAX as u64 - 1;
/// Bytes at the start of a file in which its first tag has to be.
pub(crate) const FIRST_TAG_BYTES: u64 = 64 * 1024;
/// Size of a file that is read to say why it holds no composite.
pub(crate) const EXPLAINED_FILE_BYTES: u64 = 1_000_000;
/// Files of a folder that are read to say why they hold no composite.
pub(crate) const EXPLAINED_FILES: usize = 20;

// Folders: they may hold far more than what belongs to a fleet.
/// Entries of folders that are looked at because of the files of one fleet.
pub(crate) const FLEET_ENTRIES: usize = 20_000;
/// Entries that are looked at in a folder that somebody asked for, and below.
pub(crate) const ASKED_FOLDER_ENTRIES: usize = 1_000_000;
/// Folders above a file in which a description of the contribution is looked for.
pub(crate) const FOLDERS_ABOVE: usize = 12;
/// Folders beside a contribution in which those that it imports from are looked for.
pub(crate) const FOLDERS_BESIDE: usize = 1_000;
/// Entries of one folder that are looked at for a name or an ending.
pub(crate) const FOLDER_ENTRIES: usize = 10_000;

// Texts: each bounds a step that would take quadratic time in a hostile one.
/// Elements before an end tag among which the one that it could be of is looked for.
pub(crate) const SIBLINGS_SEARCHED: usize = 1000;
/// Open elements that are looked at for one that can hold another.
pub(crate) const OPEN_ELEMENTS_SEARCHED: usize = 64;
/// Times that the end of one tag is looked for anew, behind quotes that do not fit.
pub(crate) const TAG_END_SEARCHES: u32 = 16;
/// Words of an attribute that is a list: a fleet has no more components.
pub(crate) const LIST_WORDS: usize = 1_000_000;

// Fleets: a few lines can name a composite of composites of composites.
/// Components that inner composites and replicas come to.
pub(crate) const COMPONENTS: usize = 1_000_000;
/// Composites inside each other.
pub(crate) const COMPOSITE_DEPTH: usize = 250;
/// Rounds in which conditions are evaluated again with the properties of what others include.
pub(crate) const CONDITION_ROUNDS: usize = 100;
/// Replicas of a fleet: a typing error must not take all memory.
pub(crate) const REPLICAS: u64 = 100_000;
/// Bytes of a component that counts as one replica; a longer one counts as several.
pub(crate) const REPLICA_BYTES: u64 = 2560;
/// Ends of wires: a group of replicas that calls a group has as many as the product of both.
pub(crate) const WIRE_ENDS: u64 = 1_000_000;

// Sources: each component that takes a value has it.
/// Values that the sources of a fleet lead to.
pub(crate) const SOURCE_VALUES: u64 = 4_000_000;
/// Bytes of these values.
pub(crate) const SOURCE_BYTES: u64 = 64 << 20;
/// Elements that the steps of all paths look at; those that take longer count several times.
pub(crate) const PATH_ELEMENTS: u64 = 200_000_000;
/// Steps of a path.
pub(crate) const PATH_STEPS: usize = 100;
/// Elements in the tables that are kept for one value.
pub(crate) const TABLE_ELEMENTS: usize = 1_000_000;

// Expressions: a value of a replicated component is evaluated for each replica.
/// Signs, names and numbers of an expression.
pub(crate) const EXPRESSION_TOKENS: usize = 20_000;
/// Operators of an expression.
pub(crate) const EXPRESSION_OPERATORS: usize = 200;
/// Parentheses and signs within each other: the parser is recursive.
pub(crate) const EXPRESSION_DEPTH: usize = 30;
/// Digits that a number is filled up to: those of the largest one.
pub(crate) const NUMBER_DIGITS: usize = 18;

// Diagnostics: a generated file may have one mistake a million times.
/// Faults that are kept of the text of one file.
pub(crate) const TEXT_FAULTS: usize = 1000;
/// References to declared entities that are shown with the declaration.
pub(crate) const DECLARED_ENTITIES: usize = 8;
/// Diagnostics of one code that are kept for one file.
pub(crate) const CODE_DIAGNOSTICS: u32 = 1000;
/// Diagnostics of all codes together that are kept for one file.
pub(crate) const FILE_DIAGNOSTICS: u32 = 2000;
/// Right names that are looked at for all wrong ones of a check together.
pub(crate) const CANDIDATES: u64 = 1_000_000;
/// Unresolved names whose search path is listed.
pub(crate) const EXPLAINED_NAMES: usize = 1000;
/// Unknown properties of a component that are compared with a name that is missing.
pub(crate) const MISSPELT_NAMES: usize = 100;
/// Names of missing components that are kept for each composite.
pub(crate) const DANGLING_NAMES: usize = 100;
/// Parts of a value that are searched for the one that a path means.
pub(crate) const SEARCHED_PARTS: usize = 1_000;
/// Names of such parts that are listed.
pub(crate) const LISTED_PARTS: usize = 50;
/// Names in a line of help.
pub(crate) const LISTED_NAMES: usize = 30;
/// Diagnostics about replicas that are merged; further ones are reported one by one.
pub(crate) const MERGED_DIAGNOSTICS: usize = 2000;
/// Diagnostics that are remembered, so that none is reported twice.
pub(crate) const REMEMBERED_DIAGNOSTICS: usize = 20_000;
/// Edits of one comment that are suggested.
pub(crate) const SUGGESTED_EDITS: usize = 100;
/// Characters of a text that a message repeats.
pub(crate) const QUOTED_CHARACTERS: usize = 60;
/// Words with hidden characters that are looked at.
pub(crate) const HIDDEN_CHARACTERS: usize = 1000;
/// Names that are offered in place of a wrong one.
pub(crate) const OFFERED_NAMES: usize = 3;
