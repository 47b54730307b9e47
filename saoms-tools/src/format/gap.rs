//! Gaps between elements: comments, instructions and white space.

/// A comment, an instruction or a CDATA section, and how many lines end before it; without a text what is at the end.
pub(super) struct Item<'a> {
    pub(super) text: Option<&'a str>,
    pub(super) breaks: usize,
}

/// The items of a stretch without elements and without text.
pub(super) struct Gap<'a> {
    rest: &'a str,
    is_done: bool,
}

impl<'a> Gap<'a> {
    pub(super) fn new(stretch: &'a str) -> Self {
        Self { rest: stretch, is_done: false }
    }
}

impl<'a> Iterator for Gap<'a> {
    type Item = Item<'a>;

    fn next(&mut self) -> Option<Item<'a>> {
        if self.is_done {
            return None;
        }
        let trimmed = self.rest.trim_start_matches(is_space);
        let breaks = line_ends(&self.rest[..self.rest.len() - trimmed.len()]);
        // What starts in another way is nothing that can stand here.
        let close = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")]
            .into_iter()
            .find(|(open, _)| trimmed.starts_with(open))
            .and_then(|(open, close)| Some(open.len() + trimmed[open.len()..].find(close)? + close.len()));
        self.is_done = close.is_none();
        let (text, rest) = trimmed.split_at(close.unwrap_or(trimmed.len()));
        self.rest = rest;
        Some(Item { text: (!text.is_empty()).then_some(text), breaks })
    }
}

/// True if there is nothing but white space.
pub(super) fn is_blank(text: &str) -> bool {
    text.chars().all(is_space)
}

/// The number of line ends in the text: LF, CR LF, or a CR alone.
fn line_ends(text: &str) -> usize {
    text.matches('\n').count() + text.matches('\r').count() - text.matches("\r\n").count()
}

fn is_space(character: char) -> bool {
    matches!(character, ' ' | '\t' | '\r' | '\n')
}
