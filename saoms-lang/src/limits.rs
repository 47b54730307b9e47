//! Limits: bounds on work and output, so that time and memory grow with a file and not with its square, however hostile
//! it is.
//!
//! Bounds of the checker itself stand in `check`, beside what they count.

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
/// Diagnostics of one code that are kept for one file.
pub(crate) const CODE_DIAGNOSTICS: u32 = 1000;
/// Diagnostics of all codes together that are kept for one file.
pub(crate) const FILE_DIAGNOSTICS: u32 = 2000;
/// Right names that are looked at for all wrong ones of a check together.
pub(crate) const CANDIDATES: usize = 1_000_000;
/// Names that lead nowhere of which it is said where they were looked for.
pub(crate) const EXPLAINED_NAMES: usize = 1000;
/// Edits of one comment that are suggested.
pub(crate) const SUGGESTED_EDITS: usize = 100;
/// Characters of a text that a message repeats.
pub(crate) const QUOTED_CHARACTERS: usize = 60;
/// Names that are offered in place of a wrong one.
pub(crate) const OFFERED_NAMES: usize = 3;
