//! Characters that nobody sees, and letters of other alphabets that look like Latin ones, in names and values. Where
//! something is wrong because of one, what is told of that says so; where nothing else tells of it, this rule does.

use std::collections::HashMap;

use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, Edit, codes, quoted};
use crate::limits::HIDDEN_CHARACTERS;
use crate::model::Contribution;
use crate::source::{FileId, Location, Sources, Span};
use crate::syntax::{Document, TokenKind, is_unseen, looks_like, named};

/// A word with such characters.
struct Word<'t> {
    text: &'t str,
    /// True if no other word stands beside it.
    is_alone: bool,
    at: Location,
    /// Each character with its place, and what belongs there.
    hidden: Vec<(char, Location, Option<char>)>,
}

/// Tells of hidden characters; `sources` holds the texts.
pub(crate) fn check(contribution: &Contribution, sources: &Sources, report: &mut Report<'_>) {
    let documents = contribution.composites().iter().map(|one| (one.file(), &*one.document));
    let documents: HashMap<FileId, &Document> = documents.collect();
    let mut left = HIDDEN_CHARACTERS;
    for (file, source) in sources.iter() {
        let text = source.text();
        if text.is_ascii() {
            continue;
        }
        let document = documents.get(&file).copied();
        let is_xml = report.is_xml(file);
        for word in words(file, text).take(left) {
            left -= 1;
            let is_value = match document {
                Some(document) => is_in_value(document, &word),
                None => !is_xml,
            };
            if !explain(&word, report) && is_value && word.is_misleading(is_xml) {
                report.push(word.diagnostic());
            }
        }
    }
}

/// The words of a text with hidden characters.
fn words<'t>(file: FileId, text: &'t str) -> impl Iterator<Item = Word<'t>> {
    let is_end = |sign: char| sign.is_ascii_whitespace() || sign.is_ascii() && "\"'<>,;()=/${}`".contains(sign);
    text.split(is_end).filter(|word| !word.is_ascii()).filter_map(move |word| {
        // A mark of the byte order starts a file.
        let start = word.as_ptr() as usize - text.as_ptr() as usize;
        let marked = if start == 0 { word.strip_prefix('\u{feff}').unwrap_or(word) } else { word };
        let start = start + word.len() - marked.len();
        let hidden = |(at, sign): (usize, char)| {
            let place = Span::new((start + at) as u32, (start + at + sign.len_utf8()) as u32).in_file(file);
            let meant = looks_like(sign);
            (is_unseen(sign) || meant.is_some()).then_some((sign, place, meant))
        };
        let hidden: Vec<_> = marked.char_indices().filter_map(hidden).collect();
        let at = Span::new(start as u32, (start + marked.len()) as u32).in_file(file);
        let (before, behind) = (&text[..start], &text[start + marked.len()..]);
        let is_alone = !before.ends_with([' ', '\t']) && !behind.starts_with([' ', '\t']);
        (!hidden.is_empty()).then_some(Word { text: marked, is_alone, at, hidden })
    })
}

/// True if a word stands in the value of an attribute, or in a text other than that for people.
fn is_in_value(document: &Document, word: &Word<'_>) -> bool {
    let at = word.at.span.start;
    let Some(element) = document.innermost(at + 1) else { return false };
    let is_for_people = |name: &str| matches!(name, "documentation" | "extensions");
    let mut around = std::iter::successors(Some(element), |one| one.parent());
    if around.any(|one| is_for_people(one.local_name())) {
        return false;
    }
    match document.token_at(at) {
        Some((TokenKind::Text | TokenKind::Section, _)) => true,
        Some((TokenKind::StartTag | TokenKind::EmptyTag, _)) => {
            let spans = element.written_attributes().map(|one| one.value_span());
            spans.into_iter().any(|span| span.start <= at && at < span.end.max(span.start + 1))
        }
        _ => false,
    }
}

/// Adds what is hidden in a word to what is told of it: of its place, or of a name that is not the same for it. False
/// if nothing is.
fn explain(word: &Word<'_>, report: &mut Report<'_>) -> bool {
    let mut is_told = false;
    report.diagnostics().adjust(0, |one| {
        if is_told {
            return;
        }
        if word.hidden.iter().any(|(_, place, _)| word.is_met_by(*place, one)) {
            is_told = true;
            // Of quotes and dashes the one beside them says it.
            let is_plain =
                word.hidden.iter().all(|(_, _, meant)| meant.is_some_and(|meant| meant.is_ascii_punctuation()));
            if (one.suggestions.is_empty() || !is_plain) && !one.message.contains("U+") {
                one.help.insert(0, word.message());
                if one.suggestions.is_empty() && !word.has_markup() {
                    *one = word.mended(one.clone());
                }
            }
            return;
        }
        let is_word = |edit: &Edit| edit.replacement.contains(word.text);
        let elsewhere = format!("{}` of another composite contains ", word.clean());
        if one.suggestions.iter().any(|suggestion| suggestion.edits.iter().any(is_word))
            || one.help.iter().any(|help| help.contains(&elsewhere))
        {
            is_told = true;
            one.suggestions.clear();
            *one = word.mended(one.clone().label(word.at, word.message()));
        }
    });
    is_told
}

impl Word<'_> {
    /// True if nobody can see that the word is not what it seems to be. Between the words of a line, blanks of other
    /// kinds are harmless.
    fn is_misleading(&self, is_xml: bool) -> bool {
        let is_mixed = || {
            let is_other = |sign: char| !sign.is_ascii() && looks_like(sign).is_none() && !is_unseen(sign);
            self.text.contains(|sign: char| sign.is_ascii_alphabetic()) && !self.text.contains(is_other)
        };
        // Joiners belong to texts in scripts that have them.
        let joins = |sign: char| matches!(sign, '\u{200c}' | '\u{200d}');
        let is_joined = self.text.contains(joins) && !is_mixed();
        self.hidden.iter().any(|(_, _, meant)| match meant {
            None => !is_joined,
            Some(' ') => self.is_alone && (is_xml || self.text.trim().contains(char::is_whitespace)),
            Some(meant) => meant.is_ascii_alphanumeric() && is_mixed(),
        }) && !self.text.contains(char::is_control)
    }

    /// True if what is told is told of one of the hidden characters, or of what is behind it in the word.
    fn is_met_by(&self, hidden: Location, one: &Diagnostic) -> bool {
        let Location { file, span } = one.location;
        let (at, word) = (hidden.span, self.at.span);
        let is_inside = word.start < at.start && at.end < word.end;
        file == hidden.file && span.start < at.end + u32::from(is_inside) && at.start < span.end.max(span.start + 1)
    }

    /// True if a sign that is meant can be one of the markup around the word, such as a quote.
    fn has_markup(&self) -> bool {
        self.hidden.iter().any(|(_, _, meant)| meant.is_some_and(|meant| "\"'<>&".contains(meant)))
    }

    /// The word as it seems to be.
    fn clean(&self) -> String {
        let signs = self.text.chars().filter(|sign| !is_unseen(*sign));
        signs.map(|sign| looks_like(sign).unwrap_or(sign)).collect()
    }

    fn message(&self) -> String {
        let more = match self.hidden.len() {
            1 => String::new(),
            count => format!(", and {} more such characters", count - 1),
        };
        format!("{} contains {}{more}", quoted(&self.clean()), named(self.hidden[0].0))
    }

    /// The diagnostic with the suggestion to write the word as it seems to be.
    fn mended(&self, one: Diagnostic) -> Diagnostic {
        let edit = |(_, place, meant): &(char, Location, Option<char>)| Edit {
            location: *place,
            // A blank is not meant within a word.
            replacement: meant.filter(|meant| *meant != ' ' || !self.is_alone).map(String::from).unwrap_or_default(),
        };
        let description = match &self.hidden[..] {
            [(_, _, None)] => "remove this character".to_owned(),
            [(_, _, Some(' '))] if self.is_alone => "remove this character".to_owned(),
            [(_, _, Some(' '))] => "replace this character with a blank".to_owned(),
            [(_, _, Some(meant))] => format!("replace this character with `{meant}`"),
            _ => "write it without these characters".to_owned(),
        };
        one.suggest_edits(description, self.hidden.iter().map(edit).collect())
    }

    fn diagnostic(&self) -> Diagnostic {
        self.mended(Diagnostic::new(&codes::HIDDEN_CHARACTER, self.at, self.message()))
    }
}
