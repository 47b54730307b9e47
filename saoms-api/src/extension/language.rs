use std::ops::Range;

use crate::Finding;
use crate::event::fault::FaultCall;
use crate::event::{EventCall, Events};

/// The language of the text in a property. A class names it at the property: `#[property(language = "scenario")]`.
///
/// The checker asks the language before the constructor of the class, since the language alone is given the events that
/// other classes take.
#[derive(Clone, Copy, Debug)]
pub struct PropertyLanguage {
    /// Its name.
    pub name: &'static str,
    /// Words of the language: no event has one of them as its name.
    pub words: &'static [&'static str],
    /// Judges the texts of a property.
    pub check: fn(&PropertyTexts<'_>) -> JudgedTexts,
    /// The texts that can stand at a place of the property.
    pub complete: fn(&PropertyText<'_>) -> Vec<Completion>,
    /// The meaning of the word at a place.
    pub explain: fn(&PropertyText<'_>) -> Option<Explanation>,
}

inventory::collect!(PropertyLanguage);

impl PropertyLanguage {
    /// The languages that are linked into this program, in no particular order.
    pub fn linked() -> impl Iterator<Item = &'static PropertyLanguage> {
        inventory::iter::<PropertyLanguage>()
    }

    /// The language of this name, if one is linked into this program.
    pub fn named(name: &str) -> Option<&'static PropertyLanguage> {
        PropertyLanguage::linked().find(|language| language.name == name)
    }
}

/// The texts of a property, with what is known about the fleet around it.
#[derive(Clone, Copy, Debug)]
pub struct PropertyTexts<'a> {
    /// The name of the property.
    pub property: &'a str,
    /// Its values.
    pub texts: &'a [&'a str],
    /// The words of the language whose events the class plays itself.
    pub plays: &'a [String],
    /// The events that classes take.
    pub events: &'a Events,
}

/// The judgement of a language.
#[derive(Clone, Debug, Default)]
pub struct JudgedTexts {
    /// All that is wrong, as findings about the property.
    pub findings: Vec<Finding>,
    /// The events of classes that the texts have.
    pub raised: Vec<RaisedEvent>,
    /// The faults of messages and executions that the texts have.
    pub faults: Vec<RaisedFault>,
}

/// A fault of messages or executions, in a text of a property.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RaisedFault {
    /// Index of the text.
    pub text: usize,
    /// The fault, with its places in the text.
    pub call: FaultCall,
}

/// An event of a class, in a text of a property.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RaisedEvent {
    /// Index of the text.
    pub text: usize,
    /// The event, with its places in the text.
    pub call: EventCall,
}

/// A property's text with the place of the cursor.
#[derive(Clone, Copy)]
pub struct PropertyText<'a> {
    /// The text as the file has it, half typed as it may be.
    pub text: &'a str,
    /// The byte at which the cursor stands.
    pub at: usize,
    /// The words of the language whose events the class plays itself.
    pub plays: &'a [String],
    /// The events that classes take.
    pub events: &'a Events,
    /// The names of the components of a class in the composite, or of all for an empty name; of replicas, the name of
    /// the first.
    pub components: &'a dyn Fn(&str) -> Vec<String>,
}

/// The meaning of a word of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Explanation {
    /// The meaning, in Markdown.
    pub text: String,
    /// The bytes of the word in the property's text.
    pub bytes: Range<usize>,
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
