//! Components with their implementations and loops.

use super::children::{Family, is_defined, renaming, variant};
use super::other_words::is_class_of_component;
use super::vocabulary::{
    COMPONENT, COMPONENT_PROPERTY, COMPONENT_REFERENCE, COMPONENT_SERVICE, IMPLEMENTATION_COMPOSITE,
    IMPLEMENTATION_JAVA, IMPLEMENTATION_PYTHON, IMPLEMENTATION_RUST, Kind, LOOP,
};
use super::{Loader, PassedOver};
use crate::diagnostic::{Diagnostic, Severity, codes, meant_boolean, nearest, quoted};
use crate::expression::{self, INDEX, has_expression};
use crate::model::{
    ComponentElement, Implementation, ImplementationKind, LoopElement, MisreadCount, Origin, PythonClass, Replicas,
    SAOMS_NAMESPACE,
};
use crate::source::Text;
use crate::syntax::{Attribute, Element, is_local_name};

impl Loader<'_> {
    pub(super) fn component(&mut self, element: Element<'_>) -> ComponentElement {
        self.check_attributes(element, &COMPONENT);
        self.no_text(element);
        let name = self.name(element);
        let replicas = self.replicas(element, &name);
        // Lists are allocated at their size: there may be very many components, most with one reference.
        let number_of = |name: &str| element.children().filter(|one| one.local_name() == name).count();
        let mut component = ComponentElement {
            origin: Origin::of(element),
            name,
            implementation: None,
            properties: Vec::with_capacity(number_of("property")),
            services: Vec::with_capacity(number_of("service")),
            references: Vec::with_capacity(number_of("reference")),
            path: self.path(element).map(Box::new),
            site: self.site(element).map(Box::new),
            node: self.own(element, "node").map(Box::new),
            condition: self.own(element, "if").map(Box::new),
            replicas: replicas.map(Box::new),
            autowire: self.boolean(element, "autowire"),
            loops: Vec::new(),
        };
        let mut has_faulty = false;
        self.children(element, &COMPONENT, |loader, child, family, name| {
            match (family, name) {
                (Family::Sca, "property") => component.properties.push(loader.property(child, &COMPONENT_PROPERTY)),
                (Family::Sca, "service") => component.services.push(loader.service(child, &COMPONENT_SERVICE)),
                (Family::Sca, "reference") => component.references.push(loader.reference(child, &COMPONENT_REFERENCE)),
                (Family::Sca | Family::Own | Family::Foreign, name) if name.starts_with("implementation.") => {
                    let made = loader.implementation(child, family, name);
                    if let Some(first) = &component.implementation {
                        loader.repeated(child, first.origin.tag, &COMPONENT, "implementation");
                    } else {
                        has_faulty |= made.is_none();
                        component.implementation = made;
                    }
                }
                (Family::Own, "loop") => component.loops.push(loader.looping(child)),
                _ => {
                    has_faulty |= family != Family::Foreign && name.starts_with("impl");
                    return false;
                }
            }
            true
        });
        if component.implementation.is_none() && !has_faulty && !element.has_damaged_content() {
            self.missing_implementation(element, &component.name);
        }
        component
    }

    /// Replicas of a component of this name.
    fn replicas(&mut self, element: Element<'_>, name: &str) -> Option<Replicas> {
        let mut replicas = Replicas {
            count: self.own(element, "count"),
            misread_count: None,
            from: self.own(element, "from"),
            overrides: self.own(element, "overrides"),
            table: None,
        };
        let is_given = replicas.count.is_some() || replicas.from.is_some() || replicas.overrides.is_some();
        // A name with an expression is one of replicas, also where nothing says how many there are.
        if !is_given && !is_of_replicas(name, element) {
            return None;
        }
        if replicas.count.is_none() {
            replicas.misread_count = self.misread_count(element);
        }
        Some(replicas)
    }

    /// The reason why the attribute that probably stands for `count` is not read, which is reported.
    fn misread_count(&mut self, element: Element<'_>) -> Option<MisreadCount> {
        let mut attributes = element.attributes();
        let meant = attributes.find(|attribute| nearest(attribute.local_name(), ["count"]).is_some())?;
        let is_empty = meant.namespace() == SAOMS_NAMESPACE && meant.local_name() == "count";
        if is_empty || self.refused.contains(&meant.name_span()) {
            return Some(MisreadCount::Attribute);
        }
        self.meant_namespace(meant.namespace(), element.document())?;
        self.pass_over(meant, "gives the number of replicas, which are missing without it");
        Some(MisreadCount::Namespace)
    }

    /// The site of a component. One in a namespace that is nearly that of SAOMS is an error there, and counts here.
    fn site(&mut self, element: Element<'_>) -> Option<Text> {
        if let Some(site) = self.own(element, "site") {
            return Some(site);
        }
        let named = |one: &Attribute<'_>| one.local_name() == "site";
        let meant = element.attributes().find(|one| {
            named(one) && self.meant_namespace(one.namespace(), element.document()) == Some(SAOMS_NAMESPACE)
        })?;
        self.pass_over(meant, "makes a site, and without it sites are mixed");
        Some(meant.trimmed()).filter(|site| !site.is_empty())
    }

    /// Notes the first attribute without which there is another fleet.
    fn pass_over(&mut self, attribute: Attribute<'_>, meaning: &'static str) {
        self.passed_over.get_or_insert_with(|| PassedOver {
            namespace: attribute.namespace().to_owned(),
            name: attribute.name().to_owned(),
            meaning,
        });
    }

    /// The path that a component of an expanded composite keeps.
    fn path(&mut self, element: Element<'_>) -> Option<Text> {
        let attribute = element.attribute_in(SAOMS_NAMESPACE, "path")?;
        let path = attribute.trimmed();
        if path.split('/').any(|name| name.is_empty() || name.contains(char::is_whitespace)) {
            let message = format!("{} is not a component path", quoted(&path));
            let location = if path.is_empty() { attribute.location() } else { path.location };
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, location, message);
            self.report(one.help("write names with `/` between them, such as `hall/Robot001`"));
            return None;
        }
        Some(path)
    }

    /// `None` for an implementation of SCA, or of SAOMS, that does not exist; it is reported.
    fn implementation(&mut self, element: Element<'_>, family: Family, name: &str) -> Option<Implementation> {
        let kind = match (family, name) {
            (Family::Sca, "implementation.java") => {
                self.parts_of(element, &IMPLEMENTATION_JAVA);
                ImplementationKind::Java { class: self.required(element, "class") }
            }
            (Family::Sca, "implementation.composite") => {
                self.parts_of(element, &IMPLEMENTATION_COMPOSITE);
                ImplementationKind::Composite { name: self.required(element, "name") }
            }
            (Family::Sca | Family::Own, "implementation.rust") => {
                self.parts_of(element, &IMPLEMENTATION_RUST);
                let class = self.required(element, "class");
                ImplementationKind::Rust { class, library: self.optional(element, "library") }
            }
            (Family::Sca | Family::Own, "implementation.python") => {
                self.parts_of(element, &IMPLEMENTATION_PYTHON);
                let (module, class) = (self.required(element, "module"), self.required(element, "class"));
                let named = module.as_ref().zip(class.as_ref());
                let name = named.map(|(module, class)| Text::new(format!("{module}.{class}").into(), class.location));
                ImplementationKind::Python(Box::new(PythonClass { module, class, name }))
            }
            (Family::Own, _) => {
                _ = self.unexpected(element, &COMPONENT, family);
                return None;
            }
            (Family::Sca, _) if !is_defined(element) => {
                let meant = self.unexpected(element, &COMPONENT, family)?;
                let is_read = matches!(
                    meant,
                    "implementation.java"
                        | "implementation.rust"
                        | "implementation.python"
                        | "implementation.composite"
                );
                return is_read.then(|| self.implementation(element, family, meant))?;
            }
            _ => ImplementationKind::Other { kind: variant(element, "implementation."), is_sca: family == Family::Sca },
        };
        Some(Implementation { origin: Origin::of(element), kind })
    }

    /// Checks attributes, text and children of an element that the model keeps without its children.
    pub(super) fn parts_of(&mut self, element: Element<'_>, kind: &'static Kind) {
        self.check_attributes(element, kind);
        self.no_text(element);
        self.leaf(element, kind);
    }

    fn looping(&mut self, element: Element<'_>) -> LoopElement {
        let known = self.diagnostics.len();
        self.check_attributes(element, &LOOP);
        self.no_text(element);
        let mut properties = Vec::new();
        self.children(element, &LOOP, |loader, child, family, name| {
            match (family, name) {
                (Family::Sca, "property") => properties.push(loader.property(child, &COMPONENT_PROPERTY)),
                (Family::Own, "property") => loader.property_of_sca(child),
                _ => return false,
            }
            true
        });
        let named = self.name_in_remove(element);
        let (name, remove) = match named {
            Some(name) => (name, None),
            None => (self.name(element), self.boolean(element, "remove")),
        };
        LoopElement {
            origin: Origin::of(element),
            name,
            class: self.optional(element, "class"),
            before: self.optional(element, "before"),
            after: self.optional(element, "after"),
            remove,
            properties,
            is_misread: self.diagnostics.len() > known || self.faults.iter().any(|one| element.span().contains(*one)),
        }
    }

    /// The name of a loop that is written in `remove`: one mistake, and not two attributes that are wrong.
    fn name_in_remove(&mut self, element: Element<'_>) -> Option<Text> {
        let attribute = element.attribute("remove").filter(|_| element.attribute("name").is_none())?;
        let name = attribute.trimmed();
        if !is_local_name(&name) || ["true", "false"].contains(&name.as_str()) || meant_boolean(&name).is_some() {
            return None;
        }
        let message = format!("`remove` is {}, expected `true` or `false`", quoted(&name));
        let meant = format!("name=\"{name}\" remove=\"true\"");
        let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, name.location, message);
        self.report(one.suggest(format!("replace it with {}", quoted(&meant)), attribute.location(), meant));
        Some(name)
    }

    /// Properties are of SCA, also in a loop.
    fn property_of_sca(&mut self, element: Element<'_>) {
        let prefix = element.document().root().prefix();
        let whole = prefix.map_or_else(|| "property".to_owned(), |prefix| format!("{prefix}:property"));
        let message = format!("{} is in the namespace of SAOMS", quoted(element.name()));
        let description = format!("replace {} with {}", quoted(element.name()), quoted(&whole));
        let one = Diagnostic::new(&codes::MISPLACED_ELEMENT, element.name_location(), message);
        let one = one.help("write the properties of a loop as elements of SCA, as in a component");
        self.report(one.suggest_edits(description, renaming(element, prefix, "property")));
    }

    fn missing_implementation(&mut self, element: Element<'_>, name: &Text) {
        // Its class is written as an attribute, which is reported.
        if element.attributes().any(is_class_of_component) {
            return;
        }
        let severity = if self.version.is_1_1() { Severity::Error } else { Severity::Warning };
        let message = match name.as_str() {
            "" => "a component has no implementation".to_owned(),
            name => format!("the component {} has no implementation", quoted(name)),
        };
        let help = "write `<implementation.java class=\"...\"/>` or `<implementation.rust class=\"...\"/>` in it";
        let one = Diagnostic::new(&codes::MISSING_IMPLEMENTATION, element.name_location(), message);
        self.report(one.severity(severity).help(help));
    }
}

/// True if a name is one of replicas: it uses the index, or anything else where SAOMS is spoken of at all. Templates of
/// others have such names, too.
fn is_of_replicas(name: &str, element: Element<'_>) -> bool {
    let is_of_saoms = || element.document().namespaces().any(|one| one == SAOMS_NAMESPACE);
    has_expression(name) && (is_of_saoms() || expression::names(name).iter().any(|name| name == INDEX))
}
