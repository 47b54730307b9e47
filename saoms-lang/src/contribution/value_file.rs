//! Files that properties take their values from: a text, or XML.

use std::sync::Arc;

use crate::diagnostic::{Diagnostic, Diagnostics, codes, nearest, quoted};
use crate::load::renaming;
use crate::model::{ValueDocument, Version};
use crate::source::{FileId, Sources, Span, Text};
use crate::syntax::{self, Element, Parse};

/// The element of SCA that holds the values of a file.
const VALUES: &str = "values";

/// The content of a file.
#[derive(Clone, Default)]
pub(super) struct FileValue {
    /// The text, where that is all.
    pub(super) text: Option<Text>,
    /// XML that is more than a text.
    pub(super) document: Option<ValueDocument>,
}

/// Reads a file (SCA Assembly 1.1, 4.1.3; ASM50046): XML with the root `values` of SCA holds a `value` for each value,
/// or elements; other XML is one value as a whole, with the root as its name; all else is a text. Faults are reported
/// in the file.
pub(super) fn read(file: FileId, sources: &Sources, diagnostics: &mut Diagnostics) -> FileValue {
    let whole = sources.get(file).text();
    let content = whole.trim_start_matches('\u{feff}');
    let text = Text::part_of(file, whole, content);
    // The blanks of a text of several lines may mean something: a map may have rows of blanks.
    let plain = || {
        let span = Span::new((whole.len() - content.len()) as u32, whole.len() as u32);
        let has_lines = text.contains('\n');
        let text = if has_lines { Text::new(content.into(), span.in_file(file)) } else { text.clone() };
        FileValue { text: Some(text), document: None }
    };
    if !text.starts_with('<') {
        return plain();
    }
    let Parse { document, faults } = syntax::parse(file, whole);
    if !faults.is_empty() && !is_meant_as_values(&text) {
        // A text that begins like XML and is none is a text.
        return plain();
    }
    let is_damaged = !faults.is_empty();
    faults.into_iter().for_each(|fault| diagnostics.push(fault));
    let document = Arc::new(document);
    let root = document.root();
    if root.local_name() != VALUES && !is_damaged {
        let document = Some(ValueDocument { document: Arc::clone(&document), is_list: false });
        return FileValue { text: Some(text), document };
    }
    let fault = if root.is_damaged() { None } else { wrong(root) };
    if is_damaged || fault.is_some() {
        fault.into_iter().for_each(|fault| diagnostics.push(fault));
        return FileValue::default();
    }
    // One plain value is a text, whatever is around it.
    let mut children = root.children();
    let only = children.next().filter(|only| is_value(*only) && only.children().next().is_none());
    match (only, children.next()) {
        (Some(only), None) => {
            let nothing = || Text::new("".into(), only.name_location());
            FileValue { text: Some(only.trimmed_text().unwrap_or_else(nothing)), document: None }
        }
        _ => {
            let document = Some(ValueDocument { document: Arc::clone(&document), is_list: true });
            FileValue { text: None, document }
        }
    }
}

/// True if the first tag of a text is `values`.
fn is_meant_as_values(text: &str) -> bool {
    let tags = text.split('<').skip(1);
    let mut names = tags.filter(|tag| tag.starts_with(|first: char| first.is_alphabetic() || first == '_'));
    let first = names.next().and_then(|tag| tag.split([' ', '\n', '\r', '\t', '>', '/']).next());
    first.is_some_and(|name| name.rsplit(':').next() == Some(VALUES))
}

fn is_value(element: Element<'_>) -> bool {
    element.local_name() == "value" && Version::from_namespace(element.namespace()).is_some()
}

/// The fault of `values`.
fn wrong(root: Element<'_>) -> Option<Diagnostic> {
    let fault = |at, message: String| Diagnostic::new(&codes::VALUE_FILE, at, message);
    let at = root.name_location();
    if Version::from_namespace(root.namespace()).is_none() {
        let found = match root.namespace() {
            "" => "no namespace".to_owned(),
            namespace => format!("the namespace {}", quoted(namespace)),
        };
        let one = fault(at, format!("`values` is in {found}, expected one of SCA"));
        return Some(one.help(format!("that of {} is `{}`", Version::ALL[0].label(), Version::ALL[0].namespace())));
    }
    if let Some(span) = root.text_span() {
        let one = fault(span.in_file(at.file), "unexpected text in `values`: it contains elements only".to_owned());
        return Some(one.help("write each value as `<value>...</value>`"));
    }
    let Some(first) = root.children().next() else {
        let one = fault(at, "`values` contains no value".to_owned());
        return Some(one.help("write each value as `<value>...</value>` in it"));
    };
    let is_slip = |one: &Element<'_>| one.namespace() == root.namespace() && !is_value(*one);
    if let Some(other) = root.children().find(is_slip) {
        let (name, at) = (other.local_name(), other.name_location());
        let one = fault(at, format!("{} is not allowed in `values`", quoted(other.name())));
        return Some(match nearest(name, ["value"]) {
            Some(meant) => {
                let edits = renaming(other, other.prefix(), meant);
                one.suggest_edits(format!("replace {} with `value`", quoted(name)), edits)
            }
            None => one.help("it can contain `value`, or elements of another namespace"),
        });
    }
    let other = root.children().find(|one| is_value(*one) != is_value(first))?;
    let one = fault(other.name_location(), "`values` contains both `value` and other elements".to_owned());
    Some(one.label(first.name_location(), "the first of the others").help("write all of them in one way"))
}
