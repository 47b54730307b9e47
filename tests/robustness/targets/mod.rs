//! Laws that hold for files of any bytes. The tests beside this file and the fuzzers in `fuzz/` run the same functions.

mod grammar;
mod input;
mod laws;
pub(crate) mod memory;

use std::sync::Arc;

use saoms_api::Time;
use saoms_core::journal::read as read_journal;
use saoms_lang::assembly::TaskProperties;
use saoms_lang::check::Occurrences;
use saoms_lang::diagnostic::{Diagnostic, Diagnostics, Severity, codes};
use saoms_lang::expression::{
    ExpressionError, ExpressionFault, ExpressionValue, boolean, has_expression, integer, names, parse, pattern, render,
};
use saoms_lang::load::{MAX_SIZE, load_file, read_from};
use saoms_lang::model::Composite;
use saoms_lang::project::Compilation;
use saoms_lang::registry::Registry;
use saoms_lang::source::{FileId, Location, Sources};
use saoms_lang::syntax::{self, Document};
use saoms_tools::diagnostics::{human, json, sarif};
use saoms_tools::format::format;
use saoms_tools::graph::{Diagram, dot, mermaid, svg};

use input::Input;
use memory::within;

/// Reads bytes as a composite. What is said of them points into them and can be shown.
pub(crate) fn load(bytes: &[u8]) {
    let loaded = within("reading", bytes.len(), || Loaded::of(bytes));
    let all = loaded.diagnostics.into_sorted();
    let has_errors = all.iter().any(|one| one.severity == Severity::Error);
    assert!(has_errors || loaded.composite.is_some(), "what is refused is refused for a reason");
    show(&all, &loaded.sources);
}

/// Checks bytes as a fleet, with the classes that ship and with classes as given, and draws it.
pub(crate) fn check(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return load(bytes) };
    REGISTRY.with(|registry| laws::holds(&Input::Text(text.to_owned()), registry));
}

/// Makes files of a fleet out of bytes, and holds them to what has to be.
pub(crate) fn fleet(bytes: &[u8]) {
    REGISTRY.with(|registry| laws::holds(&Input::Files(grammar::fleet(bytes, registry)), registry));
}

/// Gives a property of a class a value. The first line of the text is its name, or chooses it by how long it is.
pub(crate) fn value(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let (first, value) = text.split_once('\n').unwrap_or(("", &text));
    let value = value.replace('&', "&amp;").replace('<', "&lt;").replace("]]>", "]]&gt;");
    let composite = REGISTRY.with(|registry| {
        let task = TaskProperties::declarations();
        let own = registry.iter().filter(|class| !class.is_alias());
        let all = own.flat_map(|class| {
            let task = if class.declaration().is_periodic() { task } else { &[] };
            let properties = class.declaration().properties.iter().chain(task);
            properties.map(move |property| (class, property.name.as_str()))
        });
        let all: Vec<_> = all.collect();
        let named = all.iter().find(|(_, property)| first.trim() == *property);
        let (class, property) = named.unwrap_or(&all[first.len() % all.len()]);
        let needed = [("ID", "R"), ("period", "1s")].iter().filter(|(name, _)| name != property);
        let needed = needed.filter(|_| class.declaration().is_periodic());
        let needed: String =
            needed.map(|(name, value)| format!("<property name='{name}'>{value}</property>")).collect();
        format!(
            "<composite xmlns='http://docs.oasis-open.org/ns/opencsa/sca/200912' name='c' targetNamespace='u'>
               <component name='C'><implementation.java class='{}'/>{needed}<property name='{property}'>{value}</property></component></composite>",
            class.name()
        )
    });
    check(composite.as_bytes());
}

/// Reads a text as an expression, and as one that holds expressions. What is said of it points into it.
pub(crate) fn expression(bytes: &[u8]) {
    let text = &*String::from_utf8_lossy(bytes);
    let mut lookup = |name: &str| match name {
        "index" => Ok(ExpressionValue::Integer(7)),
        "large" => Ok(ExpressionValue::Integer(i64::MAX)),
        "site" => Ok(ExpressionValue::Text("north".into())),
        "is" => Ok(ExpressionValue::Boolean(true)),
        _ => Err(ExpressionError::new("there is none")),
    };
    let is_inside = |fault: ExpressionFault| assert!(text.get(fault.at.clone()).is_some(), "{fault:?} in {text:?}");
    match parse(text) {
        Ok(one) => {
            one.names().into_iter().for_each(|(name, at)| assert_eq!(text.get(at), Some(name), "{text:?}"));
            integer(&one, &mut lookup).err().map(is_inside);
            boolean(&one, &mut lookup).err().map(is_inside);
        }
        Err(fault) => is_inside(fault),
    }
    match render(text, &mut lookup) {
        Ok(value) => assert!(has_expression(text) || value == text, "{text:?} became {value:?}"),
        Err(faults) => faults.into_iter().for_each(is_inside),
    }
    assert!(has_expression(text) || names(text).is_empty() && pattern(text) == text, "{text:?}");
}

/// Reads a text as a report or a journal, and asks it why.
pub(crate) fn journal(bytes: &[u8]) {
    let text = &*String::from_utf8_lossy(bytes);
    let Ok(document) = read_journal(text) else { return };
    let ends = [None, document.end, Some(Time::START)];
    for (component, at) in document.components.iter().flat_map(|one| ends.map(|at| (one, at))) {
        match document.journal.why(&component.name, at) {
            Ok(why) => _ = serde_json::json!([why.chains, why.knowledge]),
            Err(error) => _ = error.to_string(),
        }
    }
}

/// Draws a fleet in every format.
pub(crate) fn draw(fleet: &Compilation<Occurrences>, registry: &Registry) {
    let Some(census) = &fleet.output else { return };
    let diagram = Diagram::of(&fleet.contribution, registry, census);
    let pictures = [svg(&diagram).to_string(), dot(&diagram).to_string(), mermaid(&diagram).to_string()];
    assert!(syntax::parse(FileId(0), &Arc::new(pictures[0].clone())).faults.is_empty(), "{}", pictures[0]);
}

/// Formats bytes: the result has the same elements, attributes and texts, and is its own format.
pub(crate) fn fmt(bytes: &[u8]) {
    let Some(document) = parsed(&String::from_utf8_lossy(bytes)) else { return };
    for width in [120, 30] {
        let once = format(&document, width);
        let again = parsed(&once);
        assert!(again.is_some(), "{once:?} is not well-formed");
        let Some(again) = again else { continue };
        assert_eq!(meaning(&again), meaning(&document), "{once:?}");
        assert_eq!(format(&again, width), once);
    }
}

thread_local! {
    pub(crate) static REGISTRY: Registry = Registry::linked().unwrap();
}

/// The outcome of the step that reads a composite, alone: a project takes texts, and these are bytes.
struct Loaded {
    composite: Option<Composite>,
    sources: Sources,
    diagnostics: Diagnostics,
}

impl Loaded {
    fn of(bytes: &[u8]) -> Self {
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        let file = read_from(bytes, "x", MAX_SIZE, &mut sources, &mut diagnostics);
        let composite = file.and_then(|file| load_file(file, &sources, &mut diagnostics));
        Self { composite, sources, diagnostics }
    }
}

/// A text as XML; `None` where it is ill-formed.
pub(crate) fn parsed(text: &str) -> Option<Document> {
    syntax::parse(FileId(0), &Arc::new(text.to_owned())).well_formed().ok()
}

/// Elements with their attributes and texts, white space between elements left out, and the comments and instructions
/// among them.
fn meaning(document: &Document) -> Vec<String> {
    let mut elements = document.elements();
    let element = |element: syntax::Element<'_>| {
        let attributes = element.written_attributes();
        let attributes: Vec<_> = attributes.map(|one| (one.name().to_owned(), one.value().into_owned())).collect();
        let text = element.has_text().then(|| element.text().into_owned());
        format!("{} {attributes:?} {text:?}", element.name())
    };
    let lines = |text: &str| text.replace("\r\n", "\n").replace('\r', "\n");
    let tree = roxmltree::Document::parse(document.text()).unwrap();
    let all = tree.root().descendants().filter_map(|node| {
        let inside = node.ancestors().skip(1).count();
        match node.node_type() {
            roxmltree::NodeType::Element => Some(element(elements.next()?)),
            roxmltree::NodeType::Comment => Some(format!("{inside} {:?}", node.text().map(lines))),
            roxmltree::NodeType::PI => {
                let value = node.pi().and_then(|pi| pi.value).map(lines);
                Some(format!("{inside} {:?} {value:?}", node.pi().map(|pi| pi.target)))
            }
            _ => None,
        }
    });
    all.collect()
}

/// Shows diagnostics in all formats; the first ones, when there are very many. Each is of a known code and at places in
/// its files.
pub(crate) fn show(all: &[Diagnostic], sources: &Sources) {
    let is_inside = |at: Location| {
        let file = sources.get(at.file);
        let Some(_) = file.text().get(at.span.start as usize..at.span.end as usize) else { return false };
        // Lines and columns, which people and editors see, name the same place; those of a mark at the start are those
        // behind it.
        let is_same = |from: u32, to: u32| from == to || to == 3 && file.text().starts_with('\u{feff}');
        [at.span.start, at.span.end].iter().all(|&end| is_same(end, file.offset(file.line_column(end))))
    };
    for one in all {
        let id = one.code.id;
        assert!(id.starts_with("S5") || codes::ALL.iter().any(|code| code.id == id), "{one:?}");
        let labels = one.labels.iter().map(|label| label.location);
        let edits = one.suggestions.iter().flat_map(|one| &one.edits).map(|edit| edit.location);
        let places = [one.location].into_iter().chain(labels).chain(edits);
        places.for_each(|place| assert!(is_inside(place), "{one:?}"));
    }
    let first = &all[..all.len().min(20)];
    assert!(first.is_empty() || !human(first, sources, false).is_empty());
    assert_eq!(json(first, sources).len(), first.len());
    assert_eq!(
        serde_json::json!(sarif(first, sources, "0", None::<()>))["runs"][0]["results"].as_array().map(Vec::len),
        Some(first.len())
    );
}
