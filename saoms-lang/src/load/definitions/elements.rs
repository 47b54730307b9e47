//! The elements of `definitions.xml`.

use super::{Declared, Definitions, Map, Named, Qualifier, What};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::load::Loader;
use crate::load::children::Family;
use crate::load::vocabulary::{
    self, ATTACHMENT, BINDING_TYPE, DEFINITIONS, DEFINITIONS_1_0, IMPLEMENTATION_TYPE, INTENT, INTENT_1_0,
    INTENT_MAP, INTENT_QUALIFIER, Kind, MAP_QUALIFIER, MAP_QUALIFIER_1_0, POLICIES, POLICIES_1_0,
    POLICY_SET_REFERENCE,
};
use crate::model::OutsideKind;
use crate::source::{Location, Text};
use crate::xml::Element;

impl Loader<'_> {
    /// Reads the root; what is wrong is reported.
    pub(super) fn definitions(&mut self, root: Element<'_>) -> Definitions {
        let kind = if self.version.is_1_1() { &DEFINITIONS } else { &DEFINITIONS_1_0 };
        self.check_attributes(root, kind);
        self.no_text(root);
        let target = match self.version.is_1_1() {
            true => self.required(root, "targetNamespace"),
            false => self.optional(root, "targetNamespace"),
        };
        let target = target.map_or_else(String::new, |target| target.as_str().to_owned());
        let mut made = Definitions { version: self.version, target, declared: Vec::new(), named: Vec::new() };
        for child in root.children() {
            let Some(name) = self.part_in(child, kind) else { continue };
            match name {
                "intent" => self.intent(child, &mut made),
                "policySet" => self.policies(child, &mut made),
                "bindingType" => self.kind_of(child, &BINDING_TYPE, &mut made),
                "implementationType" => self.kind_of(child, &IMPLEMENTATION_TYPE, &mut made),
                "externalAttachment" => self.attachment(child, &mut made),
                "documentation" => {}
                // What is left are bindings, which SCA 1.0 lets stand here for others to take over.
                _ => self.extension(child, Family::Sca),
            }
        }
        made
    }

    /// What a child is called or meant to be; another one than those that elements of this kind hold is reported.
    fn part_in(&mut self, child: Element<'_>, kind: &'static Kind) -> Option<&'static str> {
        let family = self.family(child);
        if !matches!(family, Family::Sca | Family::Own) {
            return None;
        }
        let own = |known: &&str| family == Family::Sca && *known == child.local_name();
        let known = vocabulary::children(kind).find(own);
        if known.is_some() {
            self.of_version(child);
        }
        known.or_else(|| self.unexpected(child, kind, family))
    }

    /// Checks the attributes and the text of an element, and that it holds none of SCA.
    fn plain(&mut self, element: Element<'_>, kind: &'static Kind) {
        self.check_attributes(element, kind);
        self.no_text(element);
        self.leaf(element, kind);
    }

    fn intent(&mut self, element: Element<'_>, made: &mut Definitions) {
        let kind = if self.version.is_1_1() { &INTENT } else { &INTENT_1_0 };
        self.check_attributes(element, kind);
        self.no_text(element);
        let name = self.declared_name(element);
        _ = self.boolean(element, "mutuallyExclusive");
        self.one_of(element, "intentType", &["interaction", "implementation"], true);
        for constrained in self.list(element, "constrains") {
            self.prefixed_name(&constrained);
        }
        let requires = self.names(element, "requires", OutsideKind::Intent);
        let excludes = self.names(element, "excludes", OutsideKind::Intent);
        let (mut description, mut qualifiers) = (None, Vec::new());
        for child in element.children() {
            match self.part_in(child, kind) {
                Some("description") => self.once(child, &mut description, kind),
                Some("qualifier") => {
                    self.check_attributes(child, &INTENT_QUALIFIER);
                    self.no_text(child);
                    let mut description = None;
                    for inner in child.children() {
                        if self.part_in(inner, &INTENT_QUALIFIER).is_some() {
                            self.once(inner, &mut description, &INTENT_QUALIFIER);
                        }
                    }
                    let name = self.name(child);
                    let is_default = self.boolean(child, "default").is_some_and(|default| default.value);
                    if !name.is_empty() {
                        qualifiers.push(Qualifier { name, is_default });
                    }
                }
                _ => {}
            }
        }
        made.named.extend(requires.iter().chain(&excludes).cloned());
        made.declare(name, What::Intent { qualifiers, requires, excludes }, element);
    }

    fn policies(&mut self, element: Element<'_>, made: &mut Definitions) {
        let kind = if self.version.is_1_1() { &POLICIES } else { &POLICIES_1_0 };
        self.check_attributes(element, kind);
        self.no_text(element);
        let name = self.declared_name(element);
        if !self.version.is_1_1() {
            _ = self.required(element, "appliesTo");
        }
        let provides = self.names(element, "provides", OutsideKind::Intent);
        let (mut references, mut maps) = (Vec::new(), Vec::new());
        for child in element.children() {
            match self.part_in(child, kind) {
                Some("policySetReference") => {
                    self.plain(child, &POLICY_SET_REFERENCE);
                    references.extend(self.needed(child, "name", OutsideKind::PolicySet));
                }
                Some("intentMap") => maps.push(self.map(child)),
                // Who may call, and as whom a component calls (SCA Policy 1.0, 1.7.3).
                Some("allow") => _ = self.required(child, "roles"),
                Some("runAs") => _ = self.required(child, "role"),
                Some("authorization" | "securityIdentity") => self.roles(child),
                _ => {}
            }
        }
        made.named.extend(provides.iter().chain(&references).cloned());
        made.declare(name, What::PolicySet { provides, references, maps }, element);
    }

    /// What Apache Tuscany puts policies about roles into.
    fn roles(&mut self, element: Element<'_>) {
        for child in element.children() {
            match child.local_name() {
                "allow" => _ = self.required(child, "roles"),
                "runAs" => _ = self.required(child, "role"),
                _ => {}
            }
        }
    }

    fn map(&mut self, element: Element<'_>) -> Map {
        let is_1_1 = self.version.is_1_1();
        self.check_attributes(element, &INTENT_MAP);
        self.no_text(element);
        let provides = self.needed(element, "provides", OutsideKind::Intent);
        let default = element.attribute("default");
        if let Some(old) = default.filter(|_| is_1_1) {
            let at = old.name_span().in_file(element.document().file());
            let one = "`default` is an attribute of SCA 1.0, and this file is of SCA 1.1";
            let one = Diagnostic::new(&codes::UNKNOWN_ATTRIBUTE, at, one).severity(Severity::Warning);
            self.report(one.help("the intent says which of its qualifiers is the default"));
        }
        let default = default.filter(|_| !is_1_1).map(|default| default.trimmed());
        let mut qualifiers = Vec::new();
        let mut is_empty = true;
        for child in element.children() {
            is_empty = false;
            if self.part_in(child, &INTENT_MAP).is_none() {
                continue;
            }
            let kind = if is_1_1 { &MAP_QUALIFIER } else { &MAP_QUALIFIER_1_0 };
            self.check_attributes(child, kind);
            qualifiers.extend(self.required(child, "name"));
            for inner in child.children() {
                // A qualifier within a qualifier names no intent of its own.
                if self.part_in(inner, kind).is_some() {
                    _ = self.map(inner);
                }
            }
        }
        if is_empty {
            let one = format!("{} maps nothing", quoted(element.name()));
            let one = Diagnostic::new(&codes::POLICIES, element.name_location(), one);
            self.report(one.help("write a `qualifier` in it for each qualifier of the intent"));
        }
        Map { provides, default, qualifiers }
    }

    fn kind_of(&mut self, element: Element<'_>, kind: &'static Kind, made: &mut Definitions) {
        self.plain(element, kind);
        for name in ["alwaysProvides", "mayProvide"] {
            let names = self.names(element, name, OutsideKind::Intent);
            made.named.extend(names);
        }
        let named = self.needed(element, "type", OutsideKind::Intent);
        let (what, own, other) = match kind.name {
            "bindingType" => (What::BindingType, "binding", "implementation."),
            _ => (What::ImplementationType, "implementation", "binding."),
        };
        if let Some(named) = &named
            && let Some((_, local)) = &named.name
            && local.starts_with(other)
        {
            let message = format!("{} is no {own}", quoted(&named.written));
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, named.written.location, message);
            self.report(one.help(format!("it names the element of the {own}: `sca:{own}.NAME`")));
        }
        if let Some(Named { name: Some(name), written, .. }) = named {
            made.declared.push(Declared { name, written, what });
        }
    }

    fn attachment(&mut self, element: Element<'_>, made: &mut Definitions) {
        self.plain(element, &ATTACHMENT);
        _ = self.required(element, "attachTo");
        let mut attached = self.names(element, "intents", OutsideKind::Intent);
        attached.extend(self.names(element, "policySets", OutsideKind::PolicySet));
        if attached.is_empty() {
            let one = format!("{} attaches nothing", quoted(element.name()));
            let one = Diagnostic::new(&codes::MISSING_ATTRIBUTE, element.name_location(), one);
            self.report(one.severity(Severity::Warning).help("name `intents` or `policySets`"));
        }
        made.named.extend(attached);
    }

    /// The name that an element gives; in SCA 1.0 it can have a prefix.
    fn declared_name(&mut self, element: Element<'_>) -> Option<Text> {
        if !self.version.is_1_1() {
            let name = self.required(element, "name")?;
            self.prefixed_name(&name);
            return Some(name);
        }
        Some(self.name(element)).filter(|name| !name.is_empty())
    }

    /// The QName in an attribute that has to be there.
    fn needed(&mut self, element: Element<'_>, attribute: &str, kind: OutsideKind) -> Option<Named> {
        let written = self.required(element, attribute)?;
        Some(self.qname(element, written, kind))
    }

    /// The QNames in an attribute.
    fn names(&mut self, element: Element<'_>, attribute: &str, kind: OutsideKind) -> Vec<Named> {
        let words = self.list(element, attribute);
        words.into_iter().map(|word| self.qname(element, word, kind)).collect()
    }

    fn qname(&mut self, element: Element<'_>, written: Text, kind: OutsideKind) -> Named {
        self.prefixed_name(&written);
        let (prefix, local) = written.split_once(':').unwrap_or(("", &written));
        let namespace = match prefix {
            "" => Some(element.resolve_prefix("").unwrap_or_default().into_owned()),
            _ => element.resolve_prefix(prefix).map(|found| found.into_owned()),
        };
        if namespace.is_none() {
            let message = format!("the prefix {} is bound to no namespace", quoted(prefix));
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, written.location, message);
            self.report(
                one.severity(Severity::Warning).help(format!("declare it: `xmlns:{prefix}=\"...\"`")),
            );
        }
        Named { name: namespace.map(|namespace| (namespace, local.to_owned())), written, kind }
    }

    fn once(&mut self, element: Element<'_>, first: &mut Option<Location>, kind: &'static Kind) {
        match *first {
            Some(first) => self.repeated(element, first, kind, "description"),
            None => *first = Some(element.name_location()),
        }
    }
}

impl Definitions {
    fn declare(&mut self, written: Option<Text>, what: What, element: Element<'_>) {
        let Some(written) = written else { return };
        let namespace = match written.split_once(':') {
            Some((prefix, _)) => element.resolve_prefix(prefix).map(|found| found.into_owned()),
            None => None,
        };
        let local = written.rsplit(':').next().unwrap_or_default().to_owned();
        let name = (namespace.unwrap_or_else(|| self.target.clone()), local);
        self.declared.push(Declared { name, written, what });
    }
}
