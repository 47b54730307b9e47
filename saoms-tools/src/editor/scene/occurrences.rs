//! The names in composites, and in the files beside them, each with its symbol.

use saoms_lang::contribution::table;
use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::model::Table;
use saoms_lang::source::{Sources, Text};

use super::Scene;
use super::expressions::{INDEX, names_in_values};
use super::file::File;
use super::outline::{Component, Implementation, Named, Side};
use super::symbol::{FileRange, Occurrence, Symbol, is_replica};

/// The names of a file that have a symbol, and those in files that hold values for it.
pub(crate) struct Found<'s> {
    scene: &'s Scene,
    file: usize,
    /// The byte of the file that a name has to touch.
    touched: Option<usize>,
    all: Vec<Occurrence>,
}

impl<'s> Found<'s> {
    pub(crate) fn of(scene: &'s Scene, file: usize, touched: Option<usize>) -> Vec<Occurrence> {
        let mut all = Self { scene, file, touched, all: Vec::new() };
        let outline = &scene.files[file].outline;
        if let Some(name) = &outline.name {
            all.add(name, true, || Some(Symbol::Composite { file }));
        }
        for name in outline.includes.iter().chain(&outline.deployables) {
            all.add(name, false, || Some(Symbol::Composite { file: scene.composite(file, name)? }));
        }
        for name in &outline.properties {
            all.add(name, true, || Some(Symbol::Parameter { file, name: name.text.clone() }));
        }
        for (side, names) in [(Side::Service, &outline.services), (Side::Reference, &outline.references)] {
            for name in names {
                all.add(name, true, || Some(Symbol::Promoted { file, side, name: name.text.clone() }));
            }
        }
        for source in &outline.sources {
            all.add(source, false, || Some(scene.parameter(file, &source.text)));
        }
        for one in &outline.uses {
            all.used(FileRange::new(file, &one.name.at), || match one.index_of {
                Some(place) => Symbol::Index { file, component: outline.components[place].name.text.clone() },
                None => scene.parameter(file, &one.name.text),
            });
        }
        outline.components.iter().for_each(|component| all.component(component));
        for end in &outline.ends {
            for &scope in scene.scopes(&file, end) {
                let named = || scene.named(scope, &end.component.text);
                all.add(&end.component, false, || {
                    let (file, name) = named();
                    Some(Symbol::Component { file, name })
                });
                if let Some(part) = &end.part {
                    all.add(part, false, || {
                        let (file, name) = named();
                        Some(scene.part(file, &name, end.side, &part.text))
                    });
                }
            }
        }
        all.all
    }

    /// Adds a name, where it is asked for.
    fn add(&mut self, name: &Named, is_definition: bool, symbol: impl FnOnce() -> Option<Symbol>) {
        let at = FileRange::new(self.file, &name.at);
        if !name.text.is_empty() && self.is_wanted(&at) {
            let made = symbol().map(|symbol| Occurrence { symbol, at, is_definition, is_in_expression: false });
            self.all.extend(made);
        }
    }

    /// Adds a name in an expression.
    fn used(&mut self, at: FileRange, symbol: impl FnOnce() -> Symbol) {
        if self.is_wanted(&at) {
            let symbol = symbol();
            self.all.push(Occurrence { symbol, at, is_definition: false, is_in_expression: true });
        }
    }

    fn is_wanted(&self, at: &FileRange) -> bool {
        self.touched.is_none_or(|byte| at.start <= byte && byte <= at.end)
    }

    fn component(&mut self, component: &Component) {
        let (scene, file) = (self.scene, self.file);
        let element = scene.files[file].element(component.name.element);
        if self.touched.is_some_and(|at| !element.span().touches(at as u32)) {
            return;
        }
        let of = &component.name.text;
        self.add(&component.name, true, || Some(Symbol::Component { file, name: of.clone() }));
        match &component.implementation {
            Some(Implementation::Class(name)) => {
                self.add(name, false, || Some(Symbol::Class { name: name.text.clone() }));
            }
            Some(Implementation::Composite(name)) => {
                self.add(name, false, || Some(Symbol::Composite { file: scene.composite(file, name)? }));
            }
            None => {}
        }
        // What is said about a part of a composite inside is said about what that declares.
        let inner = scene.inner(file, component);
        if let Some(inner) = inner {
            for name in &component.properties {
                self.add(name, false, || Some(scene.parameter(inner, &name.text)));
            }
        }
        for (side, names) in [(Side::Service, &component.services), (Side::Reference, &component.references)] {
            for name in names {
                let symbol = scene.part(file, of, side, &name.text);
                let is_definition = matches!(symbol, Symbol::Part { .. });
                self.add(name, is_definition, || Some(symbol));
            }
        }
        for one in &component.loops {
            let named = |name: &Named| Symbol::Loop { file, component: of.clone(), name: name.text.clone() };
            self.add(&one.name, true, || Some(named(&one.name)));
            for name in &one.others {
                self.add(name, false, || Some(named(name)));
            }
            if let Some(class) = &one.class {
                self.add(class, false, || Some(Symbol::Class { name: class.text.clone() }));
            }
        }
        if self.touched.is_none() {
            self.beside(component, inner);
            return;
        }
        for [_, new] in scene.renamed(file, component) {
            let text = scene.files[file].text[new.clone()].to_owned();
            let name = Named { element: component.name.element, text, at: new };
            self.add(&name, false, || Some(Symbol::Topic { name: name.text.clone() }));
        }
    }

    /// Places about a component in files beside the composite.
    fn beside(&mut self, component: &Component, inner: Option<usize>) {
        let (scene, file) = (self.scene, self.file);
        if !component.is_replicated {
            return;
        }
        for beside in component.files.iter().filter_map(|name| scene.beside(file, name)) {
            let text = &scene.files[beside].text;
            for at in names_in_values(text).into_iter().filter(|at| text[at.clone()] != *INDEX) {
                self.used(FileRange::new(beside, &at), || scene.parameter(file, &text[at.clone()]));
            }
        }
        let Some(beside) = component.table.as_ref().and_then(|name| scene.beside(file, name)) else { return };
        let Some(table) = table_of(&scene.files[beside]) else { return };
        let mut add = |cell: &Text, symbol: Symbol| {
            let span = cell.location.span;
            let at = FileRange { file: beside, start: span.start as usize, end: span.end as usize };
            self.all.push(Occurrence { symbol, at, is_definition: false, is_in_expression: false });
        };
        if let Some(inner) = inner {
            table.properties.iter().for_each(|column| add(column, scene.parameter(inner, column)));
        }
        let of = &component.name.text;
        let keys = table.rows.iter().map(|row| &row.key).filter(|_| table.key == *"name");
        for key in keys.filter(|key| is_replica(of, key)) {
            add(key, Symbol::Component { file, name: of.clone() });
        }
    }
}

/// A table of replicas; `None` where it has a fault.
fn table_of(file: &File) -> Option<Table> {
    let mut sources = Sources::new();
    let id = sources.add(file.path.display().to_string(), file.text.to_string());
    table(id, &sources, &mut Diagnostics::new())
}
