//! Names in expressions: `robots` in `saoms:count="2 * robots"` and in `Robot${index % robots}`.

use std::borrow::Cow;
use std::ops::Range;

use saoms_lang::expression::{inside, words};
use saoms_lang::syntax::{Element, TokenKind};

use crate::editor::syntax::{bytes, is_declaration, value_of};

/// The name of the number of a replica.
pub(crate) const INDEX: &str = "index";

/// The names in a range that is one expression.
pub(crate) fn names(text: &str, range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let found = words(&plain(&text[range.clone()]));
    found.into_iter().map(move |at| range.start + at.start..range.start + at.end)
}

/// The names within `${...}` in a range.
pub(crate) fn names_in_template(text: &str, range: Range<usize>) -> Vec<Range<usize>> {
    if !text[range.clone()].contains("${") {
        return Vec::new();
    }
    let found = names_in_values(&plain(&text[range.clone()])).into_iter();
    found.map(|at| range.start + at.start..range.start + at.end).collect()
}

/// The names within `${...}` in a file that holds a value, which is no XML.
pub(crate) fn names_in_values(text: &str) -> Vec<Range<usize>> {
    let expressions = inside(text).into_iter();
    let found = expressions.flat_map(|at| words(&text[at.clone()]).into_iter().map(move |one| (at.start, one)));
    found.map(|(from, at)| from + at.start..from + at.end).collect()
}

/// The expression within `${...}` that a byte is in, up to that byte.
pub(crate) fn template_before(text: &str, range: Range<usize>, at: usize) -> Option<Range<usize>> {
    let last = inside(&text[range.start..at]).pop()?;
    // One that is closed before the byte does not reach it.
    (range.start + last.end == at && !text[..at].ends_with('}')).then(|| range.start + last.start..at)
}

/// A text with blanks in place of the rest of each reference, so that every byte keeps its place: `&lt;` becomes `<`
/// and three blanks.
fn plain(text: &str) -> Cow<'_, str> {
    const REFERENCES: [(&str, &str); 5] =
        [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&apos;", "'"), ("&amp;", "&")];
    if !text.contains('&') {
        return Cow::Borrowed(text);
    }
    let filled = |(written, meant): (&'static str, &str)| (written, format!("{meant:<0$}", written.len()));
    let all = REFERENCES.map(filled);
    all.iter().fold(Cow::Borrowed(text), |text, (written, meant)| Cow::Owned(text.replace(written, meant)))
}

/// The texts of an element with all that is in it: the values of its attributes and what stands between its tags.
pub(crate) fn texts(element: Element<'_>) -> Vec<Range<usize>> {
    const OPEN: &str = "<![CDATA[";
    let of_names = |name: &str| is_declaration(name) || name == "file";
    let attributes = element.descendants().flat_map(Element::written_attributes);
    let mut all: Vec<Range<usize>> = attributes.filter(|one| !of_names(one.name())).filter_map(value_of).collect();
    all.extend(element.document().tokens_in(element.content_span()).filter_map(|(kind, span)| {
        let Range { start, end } = bytes(span);
        match kind {
            TokenKind::Text | TokenKind::Error => Some(start..end),
            TokenKind::Section => Some((start + OPEN.len()).min(end)..end),
            _ => None,
        }
    }));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::syntax::parse;

    #[test]
    fn names_keep_their_places_beside_references() {
        let text = "ä robots &gt; 1 and site == &quot;north&quot; or a &amp; gt";
        let found: Vec<&str> = names(text, 0..text.len()).map(|at| &text[at]).collect();
        assert_eq!(found, ["ä", "robots", "site", "a", "gt"]);
        let text = "R${index &lt; n:03} ${site == '}'} $${no} ${open";
        let found: Vec<&str> = names_in_template(text, 2..text.len()).into_iter().map(|at| &text[at]).collect();
        assert_eq!(found, ["site", "open"], "the first one begins before the range");
    }

    #[test]
    fn the_expression_at_the_cursor_is_known() {
        let before = |text: &str| template_before(text, 0..text.len(), text.len()).map(|at| text[at].to_owned());
        assert_eq!(before("R${ro").as_deref(), Some("ro"));
        assert_eq!(before("R${").as_deref(), Some(""));
        assert_eq!(before("R${a}-${b + "), Some("b + ".to_owned()));
        assert_eq!(before("R${a}"), None);
        assert_eq!(before("R$${a"), None);
    }

    #[test]
    fn all_texts_of_an_element_are_found_and_no_comments() {
        let text = "<a><b c='1' file='no'>2<!-- no --><d>3</d>4<![CDATA[5]]><?no no?></b><e f='no'/></a>";
        let document = parse(&text.to_owned().into());
        let element = document.root().children().next().unwrap();
        let mut found: Vec<&str> = texts(element).into_iter().map(|at| text[at].trim_end_matches("]]>")).collect();
        found.sort_unstable();
        assert_eq!(found, ["1", "2", "3", "4", "5"]);
    }
}
