//! Composites, includes, wires, and the severities that are set in composites.

use std::sync::Arc;

use super::Loader;
use super::children::Family;
use super::vocabulary::{
    COMPOSITE, COMPOSITE_PROPERTY, COMPOSITE_REFERENCE, COMPOSITE_SERVICE, INCLUDE, SEVERITY, WIRE,
};
use crate::diagnostic::{Diagnostic, Severity, SeverityLevel, codes, nearest, quoted};
use crate::model::{Composite, Include, Origin, SeverityRule, WireElement};
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
            run: self.run_settings(root),
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
                (Family::Sca, "property") => composite.properties.push(loader.property(child, &COMPOSITE_PROPERTY)),
                (Family::Sca, "service") => composite.services.push(loader.service(child, &COMPOSITE_SERVICE)),
                (Family::Sca, "reference") => composite.references.push(loader.reference(child, &COMPOSITE_REFERENCE)),
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
                .help("add `targetNamespace=\"urn:...\"`: other composites refer to this one by it");
            // SCA 1.0 does not ask for it.
            let severity = if self.version.is_1_1() { Severity::Error } else { Severity::Warning };
            self.report(one.severity(severity));
        }
        found
    }

    fn include(&mut self, element: Element<'_>) -> Include {
        self.parts_of(element, &INCLUDE);
        let name = self.required(element, "name");
        Include {
            origin: Origin::of(element),
            name: name.unwrap_or_else(|| Located::new("".into(), element.name_location())),
            uri: self.optional(element, "uri"),
            condition: self.own(element, "if"),
        }
    }

    fn wire(&mut self, element: Element<'_>) -> WireElement {
        let mut ends = || (self.required(element, "source"), self.required(element, "target"));
        let (source, target) = match element.has_text() && !has_attributes(element) {
            // The text is in place of the attributes.
            true => (None, None),
            false => ends(),
        };
        self.parts_of(element, &WIRE);
        // What is wrong was meant to say something: the targets of the reference are not counted then.
        let meant = |attribute: Attribute<'_>| Located::new(true, attribute.location());
        let replace = self.boolean(element, "replace").or_else(|| element.attribute("replace").map(meant));
        let condition = self.own(element, "if");
        WireElement { origin: Origin::of(element), source, target, replace, condition }
    }

    /// Reads a `severity` that stands in `parent`.
    pub(super) fn severity(&mut self, element: Element<'_>, parent: Element<'_>) {
        self.parts_of(element, &SEVERITY);
        let code = self.required(element, "code");
        let level = self.level(element);
        let reason = self.required(element, "reason");
        self.severities.extend(code.map(|code| severity_rule(element, parent, code, level, reason)));
    }

    /// Remembers the code of a `severity` without its prefix or in a wrong place, so that diagnostics of that code are
    /// not reported beside it.
    pub(super) fn meant_severity(&mut self, element: Element<'_>) {
        let (Some(parent), Some(code)) = (element.parent(), element.attribute("code")) else { return };
        self.severities.push(severity_rule(element, parent, code.trimmed(), None, None));
    }

    fn level(&mut self, element: Element<'_>) -> Option<Located<SeverityLevel>> {
        let text = self.required(element, "level")?;
        if let Some(level) = SeverityLevel::from_name(&text) {
            return Some(Located::new(level, text.location));
        }
        let names = SeverityLevel::ALL.map(SeverityLevel::name);
        let meant = match text.to_ascii_lowercase().as_str() {
            "deny" | "forbid" | "fail" => Some("error"),
            "warn" => Some("warning"),
            "info" | "hint" => Some("note"),
            "ignore" | "off" | "none" | "suppress" => Some("allow"),
            other => nearest(other, names),
        };
        let message = format!("`level` is {}, expected `allow`, `note`, `warning` or `error`", quoted(&text));
        if let Some(attribute) = element.attribute("level") {
            self.value_fault(attribute, message, meant);
        }
        None
    }
}

/// The setting of a `severity` in `parent`, whose subject is this, or the whole composite; without a level or a reason
/// it is wrong.
fn severity_rule(
    element: Element<'_>,
    parent: Element<'_>,
    code: Text,
    level: Option<Located<SeverityLevel>>,
    reason: Option<Text>,
) -> SeverityRule {
    SeverityRule {
        origin: Origin::of(element),
        is_wrong: level.is_none() || reason.is_none(),
        level: level.unwrap_or_else(|| Located::new(SeverityLevel::Allow, code.location)),
        reason: reason.unwrap_or_else(|| Located::new("".into(), code.location)),
        code,
        within: parent.parent().is_some().then(|| parent.span().in_file(parent.document().file())),
    }
}

fn has_attributes(element: Element<'_>) -> bool {
    element.attributes().next().is_some()
}
