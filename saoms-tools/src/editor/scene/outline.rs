//! Outline: the names and references of a composite, as far as they are written already.

use std::ops::Range;

use saoms_lang::expression::inside;
use saoms_lang::load::vocabulary::{
    COMPONENT, COMPOSITE, CONTRIBUTION, Holds, INCLUDE, Kind, LOOP, WIRE, own_attributes,
};
use saoms_lang::model::SAOMS_NAMESPACE;
use saoms_lang::syntax::{Attribute, Document, Element, ElementId};

use super::expressions::{INDEX, names, names_in_template, texts};
use crate::editor::syntax::{Places, bytes, value_of, words};

/// The parts of a composite.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outline {
    /// The name of the composite.
    pub(crate) name: Option<Named>,
    /// Its target namespace; empty for none.
    pub(crate) namespace: String,
    pub(crate) components: Vec<Component>,
    /// The composites that it includes.
    pub(crate) includes: Vec<Named>,
    /// The composites that the description of a contribution says run.
    pub(crate) deployables: Vec<Named>,
    /// The namespaces whose composites it says that others may take.
    pub(crate) exports: Vec<String>,
    pub(crate) properties: Vec<Named>,
    pub(crate) services: Vec<Named>,
    pub(crate) references: Vec<Named>,
    /// Every place that refers to a component.
    pub(crate) ends: Vec<End>,
    /// Every `$name`, without the `$`.
    pub(crate) sources: Vec<Named>,
    /// Every name in an expression.
    pub(crate) uses: Vec<Use>,
    /// The files beside the composite that hold values.
    pub(crate) beside: Vec<Named>,
    /// The libraries that classes are said to be in.
    pub(crate) libraries: Vec<String>,
}

/// A name and where it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Named {
    /// The element that it stands in.
    pub(crate) element: ElementId,
    pub(crate) text: String,
    pub(crate) at: Range<usize>,
}

/// A name in an expression.
#[derive(Clone, Debug)]
pub(crate) struct Use {
    pub(crate) name: Named,
    /// The place of the replicated component whose index it is.
    pub(crate) index_of: Option<usize>,
}

/// A component.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    pub(crate) name: Named,
    pub(crate) is_replicated: bool,
    /// The table that says how its replicas differ.
    pub(crate) table: Option<Named>,
    /// The files that its properties have their values from.
    pub(crate) files: Vec<Named>,
    pub(crate) implementation: Option<Implementation>,
    pub(crate) properties: Vec<Named>,
    pub(crate) services: Vec<Named>,
    pub(crate) references: Vec<Named>,
    pub(crate) loops: Vec<Loop>,
}

/// The implementation of a component.
#[derive(Clone, Debug)]
pub(crate) enum Implementation {
    /// A class of the registry.
    Class(Named),
    /// A composite, by its QName.
    Composite(Named),
}

/// A loop that a component says something about.
#[derive(Clone, Debug)]
pub(crate) struct Loop {
    pub(crate) name: Named,
    pub(crate) class: Option<Named>,
    /// The loops that it stands before or after.
    pub(crate) others: Vec<Named>,
}

/// A reference to a component: `component` or `component/part`.
#[derive(Clone, Debug)]
pub(crate) struct End {
    pub(crate) side: Side,
    /// True if the component is one around the composite.
    pub(crate) is_outer: bool,
    pub(crate) component: Named,
    pub(crate) part: Option<Named>,
}

/// The kind of the part of an [`End`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Service,
    Reference,
}

impl Outline {
    pub(crate) fn of(document: &Document, kinds: &[Option<&'static Kind>]) -> Self {
        let mut outline = Self::default();
        for (element, kind) in document.elements().zip(kinds) {
            let Some(kind) = kind else { continue };
            let parent = element.parent().and_then(|parent| kinds[parent.id().0 as usize]);
            outline.add(Reader(element), kind, parent);
        }
        let mut end = 0;
        for place in 0..outline.components.len() {
            let component = &outline.components[place];
            let span = document.element(component.name.element).span();
            // One that stands in another one is damage, and was looked at with that.
            if component.is_replicated && span.start >= end {
                outline.templates(document, place);
                end = span.end;
            }
        }
        outline
    }

    /// The services or the references of the composite.
    pub(crate) fn promoted(&self, side: Side) -> &[Named] {
        if side == Side::Service { &self.services } else { &self.references }
    }

    /// Every `$name` in the source of an element.
    pub(crate) fn sources_of(&self, element: ElementId) -> impl Iterator<Item = &Named> {
        // They are in the order of the elements.
        let first = self.sources.partition_point(|source| source.element < element);
        self.sources[first..].iter().take_while(move |source| source.element == element)
    }

    /// The files that an element takes values from.
    pub(crate) fn beside_of(&self, element: ElementId) -> impl Iterator<Item = &Named> {
        // They are in the order of the elements.
        let first = self.beside.partition_point(|name| name.element < element);
        self.beside[first..].iter().take_while(move |name| name.element == element)
    }

    /// The ends that an element has.
    pub(crate) fn ends_of(&self, element: ElementId) -> impl Iterator<Item = &End> {
        // They are in the order of the elements.
        let first = self.ends.partition_point(|end| end.component.element < element);
        self.ends[first..].iter().take_while(move |end| end.component.element == element)
    }

    /// The names in `${...}` of a component that is replicated.
    fn templates(&mut self, document: &Document, place: usize) {
        let element = document.element(self.components[place].name.element);
        for at in texts(element).into_iter().flat_map(|range| names_in_template(document.text(), range)) {
            self.add_use(Reader(element).at(at), Some(place));
        }
    }

    fn add_use(&mut self, name: Named, within: Option<usize>) {
        let index_of = within.filter(|_| name.text == INDEX);
        self.uses.push(Use { name, index_of });
    }

    /// The attributes of the namespace of SAOMS.
    fn own(&mut self, of: Reader<'_>, kind: &'static Kind) {
        let (mut table, mut is_replicated, mut expressions) = (None, false, Vec::new());
        for (known, at) in own_attributes(kind).filter_map(|known| Some((known, of.own(known.name)?))) {
            is_replicated |= matches!(known.name, "count" | "from" | "overrides");
            match known.holds {
                Holds::Number => expressions.push((at, false)),
                Holds::Condition => expressions.push((at, true)),
                Holds::Table => table = Some(of.at(at)),
                _ => {}
            }
        }
        let place = is_replicated.then(|| self.components.len().saturating_sub(1));
        for (at, is_condition) in expressions {
            for name in names(of.0.document().text(), at) {
                // How many there are is said before there is an index.
                self.add_use(of.at(name), place.filter(|_| is_condition));
            }
        }
        self.beside.extend(table.clone());
        if let Some(component) = self.components.last_mut().filter(|_| is_replicated) {
            (component.is_replicated, component.table) = (true, table);
        }
    }

    fn add(&mut self, of: Reader<'_>, kind: &'static Kind, parent: Option<&'static Kind>) {
        let is = |known: &Kind| std::ptr::eq(kind, known);
        if parent.is_some_and(|parent| std::ptr::eq(parent, &CONTRIBUTION)) {
            self.deployables.extend(of.named("composite"));
            self.exports.extend(of.named("namespace").filter(|_| kind.name == "export").map(|one| one.text));
        } else if is(&COMPOSITE) {
            self.name = of.named("name");
            self.namespace = of.named("targetNamespace").map(|one| one.text).unwrap_or_default();
        } else if is(&COMPONENT) {
            self.components.push(Component {
                name: of.named("name").unwrap_or_else(|| of.nameless()),
                is_replicated: false,
                table: None,
                files: Vec::new(),
                implementation: None,
                properties: Vec::new(),
                services: Vec::new(),
                references: Vec::new(),
                loops: Vec::new(),
            });
        } else if is(&INCLUDE) {
            self.includes.extend(of.named("name"));
        } else if is(&WIRE) {
            self.ends.extend(of.named("source").map(|one| end(one, Side::Reference)));
            self.ends.extend(of.named("target").map(|one| end(one, Side::Service)));
        } else if parent.is_some_and(|parent| std::ptr::eq(parent, &COMPOSITE)) {
            self.part(of, kind);
        } else {
            self.inside(of, kind, parent);
        }
        self.own(of, kind);
    }

    /// A property, a service or a reference of the composite.
    fn part(&mut self, of: Reader<'_>, kind: &'static Kind) {
        let named = of.named("name");
        match kind.name {
            "property" => {
                self.properties.extend(named);
                self.beside.extend(of.named("file"));
            }
            "service" => {
                self.services.extend(named);
                self.ends.extend(of.named("promote").map(|one| end(one, Side::Service)));
            }
            "reference" => {
                self.references.extend(named);
                self.ends.extend(of.list("promote").map(|one| end(one, Side::Reference)));
                let outer = |one| End { is_outer: true, ..end(one, Side::Service) };
                self.ends.extend(of.list("target").map(outer));
            }
            _ => {}
        }
    }

    /// The content of a component, a loop, a service or a reference.
    fn inside(&mut self, of: Reader<'_>, kind: &'static Kind, parent: Option<&'static Kind>) {
        if kind.name == "reference" {
            self.ends.extend(of.list("target").map(|one| end(one, Side::Service)));
        }
        // The URI of a reference's binding is a target, too.
        if kind.name == "binding.sca" && parent.is_some_and(|parent| parent.name == "reference") {
            self.ends.extend(of.named("uri").map(|one| end(one, Side::Service)));
        }
        if kind.name == "property"
            && let Some(source) = of.named("source")
        {
            let (start, element) = (source.at.start, source.element);
            self.sources.extend(variables(&source.text).into_iter().map(|at| Named {
                element,
                text: source.text[at.clone()].to_owned(),
                at: start + at.start..start + at.end,
            }));
        }
        self.libraries.extend(of.named("library").map(|one| one.text));
        if kind.name == "property"
            && let Some(file) = of.named("file")
            && let Some(component) = self.components.last_mut()
        {
            component.files.push(file.clone());
            self.beside.push(file);
        }
        let in_component = parent.is_some_and(|parent| std::ptr::eq(parent, &COMPONENT));
        let Some(component) = self.components.last_mut().filter(|_| in_component) else { return };
        let named = of.named("name");
        match kind.name {
            "property" => component.properties.extend(named),
            "service" => component.services.extend(named),
            "reference" => component.references.extend(named),
            "implementation.composite" => {
                component.implementation = named.map(Implementation::Composite);
            }
            "implementation.java" | "implementation.rust" => {
                component.implementation = of.named("class").map(Implementation::Class);
            }
            name if name == LOOP.name => {
                let name = named.unwrap_or_else(|| of.nameless());
                let others = ["before", "after"].into_iter().filter_map(|place| of.named(place)).collect();
                component.loops.push(Loop { name, class: of.named("class"), others });
            }
            _ => {}
        }
    }
}

/// Reader of the attributes of one element.
#[derive(Clone, Copy)]
struct Reader<'t>(Element<'t>);

impl<'t> Reader<'t> {
    fn named(self, attribute: &str) -> Option<Named> {
        let at = self.0.value(attribute)?;
        (!at.is_empty()).then(|| self.at(at))
    }

    /// The value of an attribute of our namespace.
    fn own(self, attribute: &str) -> Option<Range<usize>> {
        let is_meant = |one: &Attribute<'_>| one.local_name() == attribute && one.namespace() == SAOMS_NAMESPACE;
        value_of(self.0.written_attributes().find(is_meant)?)
    }

    fn list(self, attribute: &str) -> impl Iterator<Item = Named> + use<'t> {
        let range = self.0.value(attribute).unwrap_or(0..0);
        words(self.0.document().text(), range).map(move |at| self.at(at))
    }

    fn at(self, at: Range<usize>) -> Named {
        Named { element: self.0.id(), text: self.0.document().text()[at.clone()].to_owned(), at }
    }

    fn nameless(self) -> Named {
        Named { element: self.0.id(), text: String::new(), at: bytes(self.0.name_span()) }
    }
}

/// The parts of `component/part/binding`.
fn end(whole: Named, side: Side) -> End {
    let mut start = whole.at.start;
    let mut parts = whole.text.split('/').map(|part| {
        let at = start..start + part.len();
        start = at.end + 1;
        Named { element: whole.element, text: part.to_owned(), at }
    });
    let component = parts.next().unwrap_or_else(|| whole.clone());
    End { side, is_outer: false, component, part: parts.next() }
}

/// The bytes of the names behind `$` in an XPath, expressions of replicas that are parts of them included.
fn variables(text: &str) -> Vec<Range<usize>> {
    let expressions = inside(text);
    let is_inside = |at: usize| {
        let behind = expressions.partition_point(|one| one.end < at);
        expressions.get(behind).is_some_and(|one| at + 2 >= one.start)
    };
    let (mut all, mut quote, mut from): (Vec<Range<usize>>, Option<char>, usize) = (Vec::new(), None, 0);
    for (at, letter) in text.char_indices() {
        if at < from || is_inside(at) {
            continue;
        }
        match (letter, quote) {
            (_, Some(open)) => quote = Some(open).filter(|open| *open != letter),
            ('\'' | '"', None) => quote = Some(letter),
            ('$', None) => {
                let start = at + 1;
                let is_part = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.' | ':');
                let mut behind = text[start..].char_indices().map(|(place, letter)| (start + place, letter));
                let end = behind.find(|(place, letter)| !is_inside(*place) && !is_part(*letter));
                from = end.map_or(text.len(), |(end, _)| end);
                all.push(start..from);
            }
            _ => {}
        }
    }
    all
}
