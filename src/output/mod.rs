//! Where a command writes: standard output and standard error, and files that it was asked for.
//!
//! A file is written whole or not at all, and never over one that the command reads ([`Outputs`]).

mod json;
mod outputs;
mod place;
mod replace;
mod standard;

use std::path::Path;

use saoms_api::host::one_line;

pub(crate) use json::json;
pub(crate) use outputs::{Asked, Outputs, write_into};
pub(crate) use place::{Place, Sink, keep_folder};
pub(crate) use replace::{keep_mask, mode_of_files, replace};
pub(crate) use standard::{
    eprint, eprint_coloured, eprint_json, fail, has_failed, has_lost_descriptors, has_reader, keep_from_libraries,
    limit_patience, lose_terminal, own, print, print_as_is, print_json, print_json_line, printed, wait_for_input,
    wait_for_no_reader, write_error,
};

/// A path on one line, whatever characters are in it.
pub(crate) fn displayed(path: &Path) -> String {
    one_line(&path.display().to_string()).into_owned()
}

/// `1 error`, `2 errors`.
pub(crate) fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
