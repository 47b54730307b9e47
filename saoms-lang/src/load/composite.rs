//! Composites, includes and wires.

use std::sync::Arc;

use super::Loader;
use super::children::Family;
use super::plan::Plans;
use super::vocabulary::{
    COMPOSITE, COMPOSITE_PROPERTY, COMPOSITE_REFERENCE, COMPOSITE_SERVICE, INCLUDE, WIRE,
};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Composite, Include, Origin, Wire, WireDetails};
use crate::source::{Located, Text};
use crate::xml::{Attribute, Document, Element};

impl Loader<'_> {
    /// Reads the whole composite.
    pub(super) fn composite(&mut self, document: &Arc<Document>) -> Composite {
        let root = document.root();
        self.check_attributes(root, &COMPOSITE);
        self.no_text(root);
        let name = self.name(root);
        let [properties, services, references, components, wires] = self.counted(root);
        let mut composite = Composite {
            origin: Origin::of(root),
            document: Arc::clone(document),
            version: self.version,
            target_namespace: self.target_namespace(root),
            local: self.boolean(root, "local"),
            autowire: self.boolean(root, "autowire"),
            constraining_type: self.optional(root, "constrainingType"),
            includes: Vec::new(),
            properties: Vec::with_capacity(properties),
            services: Vec::with_capacity(services),
            references: Vec::with_capacity(references),
            components: Vec::with_capacity(components),
            wires: Vec::with_capacity(wires),
            severities: Vec::new(),
            outside: Vec::new(),
            unusual: Vec::new(),
            policy: self.policy(root),
            name,
        };
        let mut alike = document.alike().iter().peekable();
        let mut plans = Plans::default();
        for child in root.children() {
            let alike = alike.next_if(|one| one.element == child.id());
            if let Some(made) = alike.and_then(|one| plans.make(*one, child, &composite)) {
                composite.components.push(made);
                continue;
            }
            let (family, name) = self.meaning(child);
            let (count, told) = (composite.components.len(), self.told());
            self.part(child, family, name, &mut composite);
            if let (Some(alike), Some(read)) = (alike, composite.components.get(count))
                && told == self.told()
            {
                self.plan(&mut plans, alike.form, count, (child, read), document);
            }
        }
        composite.severities = std::mem::take(&mut self.severities);
        composite.outside = std::mem::take(&mut self.outside);
        composite
    }

    /// Reads what is directly inside, as an element of this name.
    fn part(&mut self, child: Element<'_>, family: Family, name: &str, composite: &mut Composite) {
        match (family, name) {
            (Family::Foreign | Family::Nobody, _) => {}
            (Family::Sca, "component") => {
                let component = self.component(child);
                if !component.is_nothing() {
                    if !component.is_usual() {
                        // A text of at most 4 GiB has fewer.
                        composite.unusual.push(composite.components.len() as u32);
                    }
                    composite.components.push(component);
                }
            }
            (Family::Sca, "include") => {
                let include = self.include(child);
                if !include.name.is_empty() || include.uri.is_some() || !child.is_bare() {
                    composite.includes.push(include);
                }
            }
            (Family::Sca, "wire") => {
                let wire = self.wire(child);
                if wire.source.is_some() || wire.target.is_some() || !child.is_bare() {
                    composite.wires.push(wire);
                }
            }
            (Family::Sca, "property") => {
                composite.properties.push(self.property(child, &COMPOSITE_PROPERTY));
            }
            (Family::Sca, "service") => {
                composite.services.push(self.service(child, &COMPOSITE_SERVICE));
            }
            (Family::Sca, "reference") => {
                composite.references.push(self.reference(child, &COMPOSITE_REFERENCE));
            }
            (Family::Sca, "requires" | "policySetAttachment" | "documentation" | "extensions") => {
                self.beside(child);
            }
            (Family::Own, "severity") => {
                if let Some(parent) = child.parent() {
                    self.severity(child, parent);
                }
            }
            _ => {
                let meant = self.unexpected(child, &COMPOSITE, family).filter(|meant| *meant != name);
                if let Some(meant) = meant.filter(|_| family == Family::Sca) {
                    self.part(child, family, meant, composite);
                }
            }
        }
    }

    fn target_namespace(&mut self, root: Element<'_>) -> Option<Text> {
        let found = self.optional(root, "targetNamespace").filter(|uri| !uri.is_empty());
        let misspelt = root.attributes().any(|one| one.name().eq_ignore_ascii_case("targetNamespace"));
        if found.is_none() && (!misspelt || root.attribute("targetNamespace").is_some()) {
            let message = format!("{} has no `targetNamespace`", quoted(root.name()));
            let one = Diagnostic::new(&codes::MISSING_TARGET_NAMESPACE, root.name_location(), message)
                .help("other composites refer to this one by its namespace and name");
            // SCA 1.0 does not ask for it.
            let severity = if self.version.is_1_1() { Severity::Error } else { Severity::Warning };
            self.report(one.severity(severity));
        }
        found
    }

    fn include(&mut self, element: Element<'_>) -> Include {
        self.check_attributes(element, &INCLUDE);
        self.no_text(element);
        self.leaf(element, &INCLUDE);
        let name = self.required(element, "name");
        Include {
            origin: Origin::of(element),
            name: name.unwrap_or_else(|| Located::new("".into(), element.name_location())),
            uri: self.optional(element, "uri"),
            condition: self.own(element, "if"),
        }
    }

    fn wire(&mut self, element: Element<'_>) -> Wire {
        let is_plain = self.is_plain(element, &WIRE, &["source", "target"]);
        self.no_text(element);
        self.leaf(element, &WIRE);
        let mut wire = Wire {
            origin: Origin::of(element),
            source: self.required(element, "source"),
            target: self.required(element, "target"),
            details: None,
        };
        if !is_plain {
            // What is wrong was meant to say something: the targets of the reference are not counted then.
            let meant = |attribute: Attribute<'_>| Located::new(true, attribute.location());
            let replace =
                self.boolean(element, "replace").or_else(|| element.attribute("replace").map(meant));
            let condition = self.own(element, "if");
            let is_given = replace.is_some() || condition.is_some();
            wire.details = is_given.then(|| Box::new(WireDetails { replace, condition }));
        }
        wire
    }
}
