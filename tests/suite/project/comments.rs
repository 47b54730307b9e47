//! The layout of comments, which rustfmt leaves as they are.

use std::path::Path;

use super::architecture::rust_files;
use crate::support::root;

/// The columns of a line, as in `rustfmt.toml`.
const COLUMNS: usize = 120;

/// The lines of comments that end beyond the last column. The rows of a table cannot be broken.
fn long_comments(file: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(file).unwrap();
    let is_comment = |line: &str| line.trim_start().starts_with("//");
    let is_row = |line: &str| line.trim_start().trim_start_matches(['/', '!']).starts_with(" |");
    let lines = text.lines().zip(1..).filter(|(line, _)| line.chars().count() > COLUMNS);
    let long = lines.filter(|(line, _)| is_comment(line) && !is_row(line));
    long.map(|(_, number)| format!("{}:{number}", file.strip_prefix(root()).unwrap().display())).collect()
}

#[test]
fn lines_of_comments_end_at_the_last_column() {
    let long: Vec<String> = rust_files(root()).iter().flat_map(|file| long_comments(file)).collect();
    assert!(long.is_empty(), "these comments go beyond column {COLUMNS}:\n{}", long.join("\n"));
}
