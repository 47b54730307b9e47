//! What implementations, interfaces and bindings need that are defined elsewhere: their required attributes, and the values
//! that their attributes can have.
//!
//! Sources: the SCA 1.0 and 1.1 specifications of the JMS, EJB and web service bindings, of BPEL, Spring and EJB implementations, and the
//! schemas of Apache Tuscany for its own.

use super::Loader;
use super::children::{Family, meant_name};
use crate::diagnostic::{Diagnostic, Severity, codes, nearest, quoted};
use crate::model::{OutsideKind, Version};
use crate::xml::{Attribute, Element, escaped};

/// The namespaces of what Tuscany adds to SCA.
pub(super) const TUSCANY: [&str; 2] =
    ["http://tuscany.apache.org/xmlns/sca/1.0", "http://tuscany.apache.org/xmlns/sca/1.1"];

/// The attributes that an element has to have.
const REQUIRED: &[(&str, &[&str])] = &[
    ("implementation.bpel", &["process"]),
    ("implementation.c", &["module", "componentType"]),
    ("implementation.cpp", &["library", "header"]),
    ("implementation.ejb", &["ejb-link"]),
    ("implementation.jee", &["archive"]),
    ("implementation.node", &["composite"]),
    ("implementation.notification", &["name"]),
    ("implementation.osgi", &["bundleSymbolicName"]),
    ("implementation.resource", &["location"]),
    ("implementation.spring", &["location"]),
    ("implementation.widget", &["location"]),
    ("implementation.xquery", &["location"]),
];

/// Where a description of the services and references of OSGi says whose they are.
const OSGI_OWNERS: [&str; 4] = ["service", "reference", "serviceCallback", "referenceCallback"];

/// What may be done about a resource of JMS that is not there.
const JMS_CREATE: &[&str] = &["always", "never", "ifNotExist"];

/// What `binding.jms` and its `response` can hold; a name that ends with a dot stands for all that start so.
const JMS_CHILDREN: &[&str] = &[
    "destination",
    "connectionFactory",
    "activationSpec",
    "response",
    "resourceAdapter",
    "headers",
    "subscriptionHeaders",
    "SubscriptionHeaders",
    "messageSelection",
    "operationProperties",
    "operation",
    "callback",
    "wireFormat.",
    "operationSelector.",
    "requires",
    "policySetAttachment",
    "documentation",
    "extensions",
    "property",
];

/// What a `jms:` URI can say behind its `?` (SCA JMS binding 1.0, 1.5).
const JMS_TOKENS: &[&str] = &[
    "connectionFactoryName",
    "transport.jms.ConnectionFactoryJNDIName",
    "jndiConnectionFactoryName",
    "deliveryMode",
    "timeToLive",
    "priority",
    "type",
    "selector",
    "java.naming.factory.initial",
    "java.naming.provider.url",
];

impl Loader<'_> {
    /// Checks an implementation, an interface or a binding that is not described by the vocabulary of the core.
    pub(super) fn extension(&mut self, element: Element<'_>, family: Family) {
        if family != Family::Sca && !TUSCANY.contains(&element.namespace()) {
            return;
        }
        let name = meant_name(element);
        if let Some((_, attributes)) = REQUIRED.iter().find(|(known, _)| *known == name) {
            for attribute in *attributes {
                // Nobody else looks at the names of these attributes.
                self.misspelt(element, attribute);
                self.required(element, attribute);
            }
        }
        match name {
            "implementation.bpel" => self.process(element),
            "interface.wsdl" => {
                self.wsdl(element, "interface");
                self.wsdl(element, "callbackInterface");
            }
            "binding.ws" => self.wsdl(element, "wsdlElement"),
            "binding.ejb" => {
                self.one_of(element, "session-type", &["stateful", "stateless"], true);
                self.one_of(element, "ejb-version", &["EJB2", "EJB3"], true);
            }
            "binding.jms" => self.jms(element),
            "implementation.osgi" => self.osgi(element),
            // It may be written inside.
            "implementation.script" if !element.has_text() && element.children().next().is_none() => {
                self.required(element, "script");
            }
            _ => {}
        }
    }

    /// Reports an attribute in whose place the one of this name is meant.
    fn misspelt(&mut self, element: Element<'_>, meant: &str) {
        let mut all = element.attributes().filter(|one| one.namespace().is_empty());
        let Some(slip) = all.find(|one| one.name() != meant && nearest(one.name(), [meant]).is_some()) else {
            return;
        };
        if element.attribute(meant).is_some() {
            return;
        }
        let location = slip.name_span().in_file(element.document().file());
        let message = format!("{} has no attribute {}", quoted(element.name()), quoted(slip.name()));
        let description = format!("replace {} with {}", quoted(slip.name()), quoted(meant));
        self.report(Diagnostic::new(&codes::UNKNOWN_ATTRIBUTE, location, message).suggest(
            description,
            location,
            meant,
        ));
    }

    /// The properties by which services of OSGi are found or offered.
    fn osgi(&mut self, element: Element<'_>) {
        for child in element.children().filter(|child| child.local_name() == "properties") {
            if TUSCANY.contains(&child.namespace())
                && OSGI_OWNERS.iter().all(|one| child.attribute(one).is_none())
            {
                let message =
                    format!("{} says of no service or reference what it is about", quoted(child.name()));
                let one = Diagnostic::new(&codes::MISSING_ATTRIBUTE, child.name_location(), message);
                let known: Vec<String> = OSGI_OWNERS.into_iter().map(quoted).collect();
                self.report(one.help(format!("give it one of the attributes {}", known.join(", "))));
            }
        }
    }

    /// The QName of a process.
    fn process(&mut self, element: Element<'_>) {
        let Some(attribute) = element.attribute("process") else { return };
        let text = attribute.trimmed();
        if text.is_empty() {
            return;
        }
        let is_expanded = text.starts_with('{') && text.find('}').is_some_and(|end| end + 1 < text.len());
        let Some((prefix, local)) = text.split_once(':').filter(|_| !text.starts_with('{')) else {
            if !is_expanded {
                let message = format!("{} names no process: it has no namespace", quoted(&text));
                self.wrong_value(
                    attribute,
                    message,
                    "write `prefix:Process`, with a prefix that is bound to its namespace",
                );
            }
            return;
        };
        if element.resolve_prefix(prefix).is_none() || local.is_empty() {
            let message = format!("the prefix {} is bound to no namespace", quoted(prefix));
            let help = format!("declare it: `xmlns:{prefix}=\"...\"`");
            self.wrong_value(attribute, message, &help);
        }
    }

    /// A place in a WSDL document: `namespace#wsdl.kind(name)`.
    fn wsdl(&mut self, element: Element<'_>, name: &str) {
        let Some(attribute) = element.attribute(name) else { return };
        let text = attribute.trimmed();
        self.outside(element, &text, OutsideKind::Wsdl);
        let known: &[&str] = match name {
            "wsdlElement" => &["binding", "port", "endpoint", "service", "porttype", "interface"],
            _ => &["interface", "porttype"],
        };
        let is_known = |fragment: &str| {
            let inside =
                fragment.strip_prefix("wsdl.").and_then(|rest| rest.strip_suffix(')')?.split_once('('));
            inside.is_some_and(|(what, name)| {
                !name.is_empty() && known.iter().any(|known| known.eq_ignore_ascii_case(what))
            })
        };
        let help = |start: &str| match name {
            "wsdlElement" => {
                format!(
                    "write `{start}#wsdl.binding(NAME)`, `#wsdl.port(SERVICE/PORT)` or `#wsdl.service(NAME)`"
                )
            }
            _ => format!("write `{start}#wsdl.interface(NAME)`, or `#wsdl.porttype(NAME)`"),
        };
        match text.split_once('#') {
            None if !text.is_empty() => {
                let message = format!("{} names nothing in a WSDL document", quoted(&text));
                self.wrong_value(attribute, message, &help(&text));
            }
            Some((start, fragment)) if fragment.starts_with("wsdl.") && !is_known(fragment) => {
                let what = if name == "wsdlElement" { "binding, port or service" } else { "interface" };
                let message = format!("{} is no {what} in a WSDL document", quoted(&format!("#{fragment}")));
                self.wrong_value(attribute, message, &help(start));
            }
            _ => {}
        }
    }

    fn jms(&mut self, element: Element<'_>) {
        if let Some(uri) = element.attribute("uri") {
            self.jms_uri(uri);
            self.jms_in_two_ways(element, uri);
        }
        if let Some(scheme) = element.attribute("correlationScheme")
            && !(self.version.is_1_1() && scheme.trimmed().contains(':'))
        {
            let known: &[&str] = match self.version {
                Version::Osoa10 => &["RequestMsgIDToCorrelID", "RequestCorrelIDToCorrelID", "None"],
                _ => &["sca:messageID", "sca:correlationID", "sca:none"],
            };
            self.one_of(element, "correlationScheme", known, false);
        }
        self.jms_children(element);
    }

    /// The parts of `binding.jms`, or of its `response`.
    fn jms_children(&mut self, element: Element<'_>) {
        let namespace = element.namespace();
        for child in element.children() {
            if child.namespace() != namespace {
                // One of no namespace, or of another version of SCA, is reported; others are extensions.
                self.family(child);
                continue;
            }
            let name = child.local_name();
            let is_known = |known: &&str| *known == name || known.ends_with('.') && name.starts_with(known);
            if !JMS_CHILDREN.iter().any(is_known) {
                let place = quoted(element.local_name());
                let message = format!("{} cannot stand in {place}", quoted(child.name()));
                let one = Diagnostic::new(&codes::UNKNOWN_ELEMENT, child.name_location(), message);
                let known = JMS_CHILDREN.iter().map(|known| match known.strip_suffix('.') {
                    Some(prefix) => quoted(&format!("{prefix}.*")),
                    None => quoted(known),
                });
                let help = format!("{place} can hold {}", known.collect::<Vec<_>>().join(", "));
                self.report(one.help(help));
                continue;
            }
            match name {
                "destination" => {
                    self.one_of(child, "type", &["queue", "topic"], false);
                    self.one_of(child, "create", JMS_CREATE, false);
                    self.usual_type(child);
                    self.named(child);
                }
                "connectionFactory" | "activationSpec" => {
                    self.one_of(child, "create", JMS_CREATE, false);
                    self.named(child);
                }
                "resourceAdapter" | "operationProperties" => _ = self.required(child, "name"),
                "response" => self.jms_children(child),
                "wireFormat.jmsDefault" => self.one_of(child, "sendFormat", &["text", "bytes"], true),
                "wireFormat.jmsObject" => _ = self.boolean(child, "wrapSingle"),
                "headers" => {
                    self.one_of(child, "JMSDeliveryMode", &["PERSISTENT", "NON_PERSISTENT"], false);
                    self.one_of(child, "deliveryMode", &["persistent", "nonpersistent"], false);
                    self.priority(child, "JMSPriority");
                    self.priority(child, "priority");
                }
                _ => {}
            }
        }
    }

    /// Warns of a `destination` beside the `uri`, which names one as well (SCA JMS binding 1.1, 2).
    fn jms_in_two_ways(&mut self, element: Element<'_>, uri: Attribute<'_>) {
        let is_destination =
            |one: &Element<'_>| one.local_name() == "destination" && one.namespace() == element.namespace();
        let Some(destination) = element.children().find(is_destination) else { return };
        let message = "binding.jms has a `uri`, and a `destination` that says where messages go";
        let one = Diagnostic::new(&codes::TARGET_IN_TWO_WAYS, destination.name_location(), message);
        let one = one.severity(Severity::Warning).rule("ASM50015");
        self.report(one.label(uri.trimmed().location, "the other one").help("keep one of them"));
    }

    fn jms_uri(&mut self, attribute: Attribute<'_>) {
        let text = attribute.trimmed();
        let Some(rest) = text.strip_prefix("jms:") else {
            if !text.is_empty() {
                let message = format!("{} is no URI of JMS: it has to start with `jms:`", quoted(&text));
                self.wrong_value(
                    attribute,
                    message,
                    "as in `jms:jndi:Queue`, or leave `uri` out and name a `destination`",
                );
            }
            return;
        };
        // SCA 1.1 takes over the scheme of others, which lets any token pass.
        let tokens = rest.split_once('?').map_or("", |(_, tokens)| tokens).split('&');
        let unknown = tokens
            .map(|token| token.split('=').next().unwrap_or_default())
            .find(|token| !token.is_empty() && !JMS_TOKENS.contains(token));
        if let Some(token) = unknown.filter(|_| !self.version.is_1_1()) {
            let message = format!("a URI of JMS has no {}", quoted(token));
            let known: Vec<String> = JMS_TOKENS.iter().copied().map(quoted).collect();
            self.wrong_value(attribute, message, &format!("`uri` can have {}", known.join(", ")));
        }
    }

    /// A part that names something by `name` or `jndiName`.
    fn named(&mut self, element: Element<'_>) {
        let is_named = |name| element.attribute(name).is_some_and(|one| !one.trimmed().is_empty());
        if is_named("name") || is_named("jndiName") {
            return;
        }
        match element.attribute("name").or_else(|| element.attribute("jndiName")) {
            Some(empty) => {
                let one = format!("the attribute {} is empty", quoted(empty.name()));
                let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, empty.location(), one);
                self.report(one.help("it is the name by which the resource is looked up"));
            }
            None => _ = self.required(element, if self.version.is_1_1() { "jndiName" } else { "name" }),
        }
    }

    /// A type that says what holds without it: programs of SCA 1.0 tell it.
    fn usual_type(&mut self, element: Element<'_>) {
        if self.version.is_1_1() {
            return;
        }
        if let Some(attribute) = element.attribute("type").filter(|one| one.trimmed().as_str() == "queue") {
            let message = "`type=\"queue\"` has no effect: a destination is a queue";
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, attribute.location(), message);
            self.report(one.severity(Severity::Warning).help("remove it"));
        }
    }

    fn priority(&mut self, element: Element<'_>, name: &str) {
        let Some(attribute) = element.attribute(name) else { return };
        let text = attribute.trimmed();
        if !text.parse::<u8>().is_ok_and(|priority| priority <= 9) {
            let message = format!("{} is {}, and a priority is from 0 to 9", quoted(name), quoted(&text));
            self.wrong_value(attribute, message, "9 is the most urgent; 4 is usual");
        }
    }

    /// An attribute that can have one of these values.
    pub(super) fn one_of(&mut self, element: Element<'_>, name: &str, known: &[&str], is_exact: bool) {
        let Some(attribute) = element.attribute(name) else { return };
        let text = attribute.trimmed();
        let is =
            |known: &&str| if is_exact { *known == text.as_str() } else { known.eq_ignore_ascii_case(&text) };
        if known.iter().any(is) {
            return;
        }
        let names: Vec<String> = known.iter().copied().map(quoted).collect();
        let message = format!("{} is {}, and has to be {}", quoted(name), quoted(&text), names.join(" or "));
        let location = attribute.value_span().in_file(element.document().file());
        let location = if text.is_empty() { attribute.location() } else { location };
        let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, location, message);
        self.report(match nearest(&text, known.iter().copied()) {
            Some(meant) => {
                one.suggest(format!("replace it with {}", quoted(meant)), location, escaped(meant))
            }
            None => one,
        });
    }

    fn wrong_value(&mut self, attribute: Attribute<'_>, message: String, help: &str) {
        let location = attribute.trimmed().location;
        self.report(Diagnostic::new(&codes::ATTRIBUTE_VALUE, location, message).help(help));
    }
}
