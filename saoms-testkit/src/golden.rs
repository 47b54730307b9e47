//! Comparison of texts with files.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

use crate::Bench;

/// Number of lines that are shown around a difference.
const AROUND: usize = 3;

#[cfg(feature = "fleets")]
impl crate::Fleet {
    /// Compares the fleet with everything resolved, as `saoms expand` writes it, with the text of a file; paths are
    /// relative to the crate.
    ///
    /// With `UPDATE_EXPECT=1` in the environment the file is written anew.
    ///
    /// # Panics
    /// With the lines that differ, when the text is another one, or there is no such file; with all diagnostics when
    /// the composites have errors.
    #[track_caller]
    pub fn expect_expanded(&self, path: impl AsRef<Path>) {
        use saoms_lang::source::FileId;
        use saoms_lang::syntax;
        use saoms_tools::format::{WIDTH, format};

        let path = path.as_ref();
        let text = self.expanded();
        let text = match syntax::parse(FileId(0), &std::sync::Arc::new(text.clone())).well_formed() {
            Ok(document) => format(&document, WIDTH),
            Err(_) => text,
        };
        hold("the fleet comes to", &text, path);
    }
}

impl Bench {
    /// Compares the [transcript](Bench::transcript) of everything that the component did so far with the text of a
    /// file; paths are relative to the crate.
    ///
    /// With `UPDATE_EXPECT=1` in the environment the file is written anew.
    ///
    /// # Panics
    /// With the lines that differ, when the text is another one, or there is no such file.
    #[track_caller]
    pub fn expect_transcript(&self, path: impl AsRef<Path>) {
        hold("the component did", &self.transcript(), path.as_ref());
    }
}

/// Compares a text with that of a file, or writes the file.
#[track_caller]
#[expect(clippy::panic, reason = "a test whose expectation is not met has failed")]
fn hold(what: &str, text: &str, path: &Path) {
    if env::var_os("UPDATE_EXPECT").is_some() {
        return fs::write(path, text).unwrap_or_else(|error| panic!("`{}` cannot be written: {error}", path.display()));
    }
    let expected = fs::read_to_string(path).unwrap_or_default();
    if let Some(difference) = difference(&expected, text) {
        panic!(
            "{what} something else than `{}` says:\n{difference}- is expected, + is so; UPDATE_EXPECT=1 writes what \
             is so",
            path.display()
        );
    }
}

/// The lines between the first and the last that differ, with some around them.
fn difference(expected: &str, found: &str) -> Option<String> {
    if expected == found {
        return None;
    }
    let (old, new): (Vec<&str>, Vec<&str>) = (expected.lines().collect(), found.lines().collect());
    let shorter = old.len().min(new.len());
    let same = old.iter().zip(&new).take_while(|(one, other)| one == other).count();
    let rest =
        (old.iter().rev().zip(new.iter().rev()).take_while(|(one, other)| one == other).count()).min(shorter - same);
    let mut out = String::new();
    let mut put = |sign: &str, lines: &[&str]| {
        for line in lines {
            let _ = writeln!(out, "{sign} {line}");
        }
    };
    put(" ", &old[same.saturating_sub(AROUND)..same]);
    put("-", &old[same..old.len() - rest]);
    put("+", &new[same..new.len() - rest]);
    put(" ", &old[old.len() - rest..(old.len() - rest + AROUND).min(old.len())]);
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::difference;

    #[test]
    fn the_lines_that_differ_are_shown_among_others() {
        assert_eq!(difference("a\n", "a\n"), None);
        let old = "1\n2\n3\n4\n5\n6\n7\n8\n9\n";
        assert_eq!(
            difference(old, &old.replace("5\n", "x\ny\n")).unwrap(),
            "  2\n  3\n  4\n- 5\n+ x\n+ y\n  6\n  7\n  8\n"
        );
        assert_eq!(difference("a\na\n", "a\n").unwrap(), "  a\n- a\n");
        assert_eq!(difference("", "a\n").unwrap(), "+ a\n");
    }
}
