use std::ops::Range;

/// The language of the text in a property, as editors complete it.
///
/// The checker needs none of this: the class judges the text when it is constructed.
#[derive(Clone, Copy, Debug)]
pub struct PropertyLanguage {
    /// The class with the property; classes that extend it have the property, too.
    pub class: &'static str,
    /// The name of the property.
    pub property: &'static str,
    /// The texts that can stand at a place of the property.
    pub complete: fn(&PropertyText<'_>) -> Vec<Completion>,
}

inventory::collect!(PropertyLanguage);

impl PropertyLanguage {
    /// The languages that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static PropertyLanguage> {
        inventory::iter::<PropertyLanguage>()
    }
}

/// A property's text with the place of the cursor.
#[derive(Clone, Copy)]
pub struct PropertyText<'a> {
    /// The text as the file has it, half typed as it may be.
    pub text: &'a str,
    /// The byte at which the cursor stands.
    pub at: usize,
    /// The names of the components of a class in the composite; of replicas, the name of the first.
    pub components: &'a dyn Fn(&str) -> Vec<String>,
}

/// A text that can stand at the cursor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// The text.
    pub label: String,
    /// Kind of the completion.
    pub kind: CompletionKind,
    /// Its meaning, in a few words.
    pub detail: String,
    /// Completions with a smaller rank come first; 5 where the order does not matter.
    pub rank: u8,
    /// The text as a snippet of the Language Server Protocol, with places to fill in.
    pub snippet: Option<String>,
    /// The bytes of the property's text that it replaces.
    pub range: Range<usize>,
}

impl Completion {
    /// A completion without detail, of rank 5.
    pub fn new(label: impl Into<String>, kind: CompletionKind, range: &Range<usize>) -> Completion {
        let (detail, snippet) = (String::new(), None);
        Completion { label: label.into(), kind, detail, rank: 5, snippet, range: range.clone() }
    }

    /// The same with its meaning.
    #[must_use]
    pub fn detail(self, detail: impl Into<String>) -> Completion {
        Completion { detail: detail.into(), ..self }
    }

    /// The same with a rank.
    #[must_use]
    pub fn rank(self, rank: u8) -> Completion {
        Completion { rank, ..self }
    }

    /// The same with a snippet.
    #[must_use]
    pub fn snippet(self, snippet: impl Into<String>) -> Completion {
        Completion { snippet: Some(snippet.into()), ..self }
    }
}

/// Kinds of completions; editors show them as icons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompletionKind {
    /// A word of the language.
    Keyword,
    /// A value.
    Value,
    /// The name of a component.
    Component,
}
