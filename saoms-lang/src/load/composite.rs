//! Composites, includes and wires.

use std::sync::Arc;

use super::children::Family;
use super::vocabulary::{COMPOSITE, COMPOSITE_PROPERTY, COMPOSITE_REFERENCE, COMPOSITE_SERVICE, INCLUDE, WIRE};
use super::{Loader, boxed};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{Composite, Include, Origin, WireDetails, WireElement};
use crate::source::{Located, Text};
use crate::syntax::{Attribute, Document, Element};

impl Loader<'_> {
    /// Reads the whole composite.
    pub(super) fn composite(&mut self, document: &Arc<Document>) -> Composite {
        let root = document.root();
        self.check_attributes(root, &COMPOSITE);
        self.no_text(root);
        let name = self.name(root);
        let mut composite = Composite {
            origin: Origin::of(root),
            document: Arc::clone(document),
            version: self.version,
            target_namespace: self.target_namespace(root),
            local: self.boolean(root, "local"),
            autowire: self.boolean(root, "autowire"),
            includes: Vec::new(),
            properties: Vec::new(),
            services: Vec::new(),
            references: Vec::new(),
            components: Vec::new(),
            wires: Vec::new(),
            severities: Vec::new(),
            name,
        };
        self.children(root, &COMPOSITE, |loader, child, family, name| {
            match (family, name) {
                (Family::Sca, "component") => composite.components.push(loader.component(child)),
                // One without attributes is reported, and says nothing.
                (Family::Sca, "include") => {
                    let include = loader.include(child);
                    composite.includes.extend(has_attributes(child).then_some(include));
                }
                (Family::Sca, "wire") => {
                    let wire = loader.wire(child);
                    composite.wires.extend(has_attributes(child).then_some(wire));
                }
                (Family::Sca, "property") => {
                    composite.properties.push(loader.property(child, &COMPOSITE_PROPERTY));
                }
                (Family::Sca, "service") => {
                    composite.services.push(loader.service(child, &COMPOSITE_SERVICE));
                }
                (Family::Sca, "reference") => {
                    composite.references.push(loader.reference(child, &COMPOSITE_REFERENCE));
                }
                _ => return false,
            }
            true
        });
        composite.severities = std::mem::take(&mut self.severities);
        composite
    }

    fn target_namespace(&mut self, root: Element<'_>) -> Option<Text> {
        let found = self.optional(root, "targetNamespace").filter(|uri| !uri.is_empty());
        let misspelt = root.attributes().any(|one| one.name().eq_ignore_ascii_case("targetNamespace"));
        if found.is_none() && !root.has_damaged_tag() && (!misspelt || root.attribute("targetNamespace").is_some()) {
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

    fn wire(&mut self, element: Element<'_>) -> WireElement {
        self.check_attributes(element, &WIRE);
        self.no_text(element);
        self.leaf(element, &WIRE);
        let (source, target) = (self.required(element, "source"), self.required(element, "target"));
        // What is wrong was meant to say something: the targets of the reference are not counted then.
        let meant = |attribute: Attribute<'_>| Located::new(true, attribute.location());
        let replace = self.boolean(element, "replace").or_else(|| element.attribute("replace").map(meant));
        let details = boxed(WireDetails { replace, condition: self.own(element, "if") });
        WireElement { origin: Origin::of(element), source, target, details }
    }
}

fn has_attributes(element: Element<'_>) -> bool {
    element.attributes().next().is_some()
}
