//! Services and references, their interfaces, callbacks and bindings.

use std::time::Duration;

use saoms_api::host::{meant_duration, parse_duration};

use super::Loader;
use super::children::{Family, is_defined, meant_name, variant};
use super::vocabulary::{
    BINDING_REST, BINDING_SCA, CALLBACK, COMPOSITE_REFERENCE, COMPOSITE_SERVICE, INTERFACE_JAVA, INTERFACE_RUST,
    INTERFACE_WSDL, Kind,
};
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::{
    Binding, Callback, Contract, InterfaceElement, InterfaceKind, Origin, ReferenceElement, SAOMS_NAMESPACE,
    ServiceElement,
};
use crate::source::{Located, Text};
use crate::syntax::Element;

impl Loader<'_> {
    pub(super) fn service(&mut self, element: Element<'_>, kind: &'static Kind) -> ServiceElement {
        self.check_attributes(element, kind);
        let name = self.name(element);
        let is_promoting = std::ptr::eq(kind, &COMPOSITE_SERVICE);
        let promote = if is_promoting { self.required(element, "promote") } else { None };
        let contract = self.contract(element, kind);
        let deadline = self.deadline(element).map(Box::new);
        ServiceElement { origin: Origin::of(element), name, promote, deadline, contract }
    }

    pub(super) fn reference(&mut self, element: Element<'_>, kind: &'static Kind) -> ReferenceElement {
        self.check_attributes(element, kind);
        let name = self.name(element);
        let is_promoting = std::ptr::eq(kind, &COMPOSITE_REFERENCE);
        let promote = if is_promoting { self.promoted(element) } else { Vec::new() };
        let mut targets = self.list(element, "target");
        if is_promoting && element.attribute("promote").is_none() {
            // Where it stands is reported, whatever it leads to.
            targets.clear();
        } else if targets.is_empty()
            && !element.has_damaged_tag()
            && let Some(attribute) = element.attribute("target")
        {
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, attribute.location(), "`target` names nothing");
            let one = one.severity(Severity::Warning).help("name a component, or remove `target`");
            // The schema lets the list be empty.
            self.report(Diagnostic { rule: None, ..one });
        }
        let contract = self.contract(element, kind);
        ReferenceElement {
            origin: Origin::of(element),
            name,
            targets,
            promote,
            multiplicity: self.multiplicity(element),
            autowire: self.boolean(element, "autowire"),
            wired_by_impl: self.boolean(element, "wiredByImpl"),
            non_overridable: self.boolean(element, "nonOverridable"),
            deadline: self.deadline(element).map(Box::new),
            token_env: self.variable(element, "tokenEnv").map(Box::new),
            contract,
        }
    }

    /// The time within which a call through a reference, or of a service from the web, is answered.
    fn deadline(&mut self, element: Element<'_>) -> Option<Located<Duration>> {
        let text = self.own(element, "deadline")?;
        let why = match parse_duration(&text) {
            Ok(Duration::ZERO) => "no call is answered within no time".to_owned(),
            Ok(deadline) => return Some(Located::new(deadline, text.location)),
            Err(why) => why,
        };
        let attribute = element.attribute_in(SAOMS_NAMESPACE, "deadline")?;
        let message = format!("{}: {why}", quoted(attribute.name()));
        self.value_fault(attribute, message, meant_duration(&text).as_deref());
        None
    }

    /// The references that a composite's reference promotes. The schema lets the list be empty.
    fn promoted(&mut self, element: Element<'_>) -> Vec<Text> {
        let list = self.list(element, "promote");
        if !list.is_empty() {
            return list;
        }
        match element.attribute("promote") {
            None if element.attribute("target").is_some() => {
                let message = "a `reference` with a `target`, outside of the component that has it";
                let one = Diagnostic::new(&codes::MISSING_ATTRIBUTE, element.name_location(), message);
                let text =
                    |name: &str| element.attribute(name).map(|one| one.value().into_owned()).unwrap_or("...".into());
                let wire = format!("<wire source=\"COMPONENT/{}\" target=\"{}\"/>", text("name"), text("target"));
                self.report(one.help(format!(
                    "move it into that component, or write {}; a reference of the composite has a `promote`",
                    quoted(&wire)
                )));
            }
            None => _ = self.required(element, "promote"),
            Some(attribute) => {
                let message = format!("the attribute `promote` of {} is empty", quoted(element.name()));
                let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, attribute.location(), message);
                self.report(one.severity(Severity::Warning));
            }
        }
        list
    }

    /// The children and the policy of a service or a reference.
    fn contract(&mut self, element: Element<'_>, kind: &'static Kind) -> Option<Box<Contract>> {
        self.no_text(element);
        let mut contract = Contract::default();
        self.children(element, kind, |loader, child, family, name| {
            match (family, name) {
                (Family::Sca, "callback") => match &contract.callback {
                    Some(first) => loader.repeated(child, first.origin.tag, kind, "callback"),
                    None => contract.callback = Some(loader.callback(child)),
                },
                (Family::Own, "interface.rust") => loader.interface(child, family, kind, &mut contract),
                _ if is_one(child, family, "interface.") => loader.interface(child, family, kind, &mut contract),
                (Family::Own, "binding.rest") => contract.bindings.push(loader.binding(child, family)),
                _ if is_one(child, family, "binding.") => contract.bindings.push(loader.binding(child, family)),
                _ => return false,
            }
            true
        });
        (contract != Contract::default()).then(|| Box::new(contract))
    }

    fn interface(&mut self, element: Element<'_>, family: Family, parent: &'static Kind, contract: &mut Contract) {
        if let Some(first) = &contract.interface {
            return self.repeated(element, first.origin.tag, parent, "interface");
        }
        let (kind, of) = match (family, meant_name(element)) {
            (Family::Sca, "interface.java") => (InterfaceKind::Java, Some(&INTERFACE_JAVA)),
            (Family::Sca | Family::Own, "interface.rust") => (InterfaceKind::Rust, Some(&INTERFACE_RUST)),
            (Family::Sca, "interface.wsdl") => (InterfaceKind::Sca, Some(&INTERFACE_WSDL)),
            (Family::Sca, _) => (InterfaceKind::Sca, None),
            _ => (InterfaceKind::Other, None),
        };
        let interface = match of {
            Some(of) => {
                self.parts_of(element, of);
                self.required(element, "interface")
            }
            None => self.optional(element, "interface"),
        };
        contract.interface = Some(InterfaceElement { origin: Origin::of(element), kind, interface });
    }

    fn binding(&mut self, element: Element<'_>, family: Family) -> Binding {
        // What other bindings hold is theirs.
        match (family, meant_name(element)) {
            (Family::Sca, "binding.sca") => self.parts_of(element, &BINDING_SCA),
            (Family::Sca | Family::Own, "binding.rest") => self.parts_of(element, &BINDING_REST),
            _ => {}
        }
        Binding {
            origin: Origin::of(element),
            kind: variant(element, "binding."),
            is_sca: family == Family::Sca,
            is_own: family == Family::Own,
            name: self.optional(element, "name"),
            uri: self.optional(element, "uri"),
        }
    }

    fn callback(&mut self, element: Element<'_>) -> Callback {
        self.check_attributes(element, &CALLBACK);
        self.no_text(element);
        let mut bindings = Vec::new();
        self.children(element, &CALLBACK, |loader, child, family, _| {
            let is_binding = is_one(child, family, "binding.");
            bindings.extend(is_binding.then(|| loader.binding(child, family)));
            is_binding
        });
        Callback { origin: Origin::of(element), bindings }
    }
}

/// True for an interface or a binding that SCA defines, or that others do.
fn is_one(element: Element<'_>, family: Family, prefix: &str) -> bool {
    let is_known = family == Family::Foreign || family == Family::Sca && is_defined(element);
    is_known && meant_name(element).starts_with(prefix)
}
