//! Elements: the vocabulary each belongs to, and unknown ones.

use smol_str::SmolStr;

use super::Loader;
use super::attributes::{is_attribute_as_element, own_prefix};
use super::vocabulary::{self, Kind, OPERATION, OWN_ELEMENTS, POLICIES, SEVERITY, SEVERITY_PARENTS};
use super::wrong_place::{as_property, as_tag, belongs_outside};
use crate::diagnostic::{Diagnostic, Edit, HiddenNames, Severity, codes, list, nearest, quoted};
use crate::model::{SAOMS_NAMESPACE, Version};
use crate::source::{Location, Span};
use crate::syntax::Element;

/// Elements that SCA 1.0 has, and 1.1 has no longer.
const ONLY_1_0: &[&str] = &["operation"];
/// Elements that SCA 1.1 added.
const ONLY_1_1: &[&str] = &["requires", "policySetAttachment", "documentation", "extensions", "externalAttachment"];

/// The namespace of XInclude, which nobody reads here.
const XINCLUDE: &str = "http://www.w3.org/2001/XInclude";

/// Elements of SCA that the model does not keep.
const NOT_KEPT: [&str; 5] = ["operation", "requires", "policySetAttachment", "documentation", "extensions"];

/// Elements that a text may be the rest of.
const KINDS_IN_TEXT: [&str; 7] =
    ["property", "reference", "service", "wire", "include", "implementation.rust", "implementation.java"];

/// The vocabulary that an element belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// That of SCA.
    Sca,
    /// That of SAOMS.
    Own,
    /// Another one: an extension.
    Foreign,
    /// None; reported.
    Nobody,
}

impl Loader<'_> {
    /// The family of an element. One of no namespace, or of another version of SCA than the root, is reported.
    pub(super) fn family(&mut self, element: Element<'_>) -> Family {
        let root = element.document().root();
        if element.is_unnamed() {
            return Family::Nobody;
        }
        // The root is of SCA, or counts as that.
        if element.shares_namespace(root) {
            return Family::Sca;
        }
        let version = match element.namespace() {
            namespace if namespace == self.namespace => return Family::Sca,
            SAOMS_NAMESPACE => return Family::Own,
            "" => {
                self.without_namespace(element, root);
                return Family::Nobody;
            }
            namespace => match Version::from_namespace(namespace) {
                Some(version) => version,
                None => return Family::Foreign,
            },
        };
        let (name, around) = (quoted(element.name()), root.local_name());
        let message = format!("{name} is of {}, but the {around} is of {}", version.label(), self.version.label());
        let one = Diagnostic::new(&codes::OTHER_VERSION, element.name_location(), message);
        let help = "use one namespace of SCA for a composite and everything in it";
        self.report(one.label(root.name_location(), format!("the {around}")).help(help));
        Family::Sca
    }

    /// Reads the children of an element of this kind: `read` takes those that it knows, each by its vocabulary and its
    /// name, and gives true for them. The others are judged here; a misspelt one is read as the one that is meant.
    #[inline]
    pub(super) fn children(
        &mut self,
        parent: Element<'_>,
        kind: &'static Kind,
        mut read: impl FnMut(&mut Self, Element<'_>, Family, &str) -> bool,
    ) {
        for child in parent.children() {
            let (family, name) = (self.family(child), meant_name(child));
            if read(self, child, family, name) {
                continue;
            }
            match family {
                Family::Foreign => self.passed_over(child, kind),
                Family::Nobody => {}
                Family::Sca if NOT_KEPT.contains(&name) && kind.children.contains(&name) => self.check_not_kept(child),
                Family::Own if name == SEVERITY.name && SEVERITY_PARENTS.contains(&kind.name) => {
                    self.severity(child, parent);
                }
                Family::Sca if self.is_wrapper(child, kind) => {
                    // By reference, for what is in it may be a wrapper again.
                    let read: &mut dyn FnMut(&mut Self, Element<'_>, Family, &str) -> bool = &mut read;
                    for inner in child.children() {
                        let (family, name) = (self.family(inner), meant_name(inner));
                        read(self, inner, family, name);
                    }
                }
                _ => {
                    let meant = self.unexpected(child, kind, family).filter(|meant| *meant != name);
                    if let Some(meant) = meant.filter(|_| family == Family::Sca) {
                        read(self, child, family, meant);
                    }
                }
            }
        }
    }

    /// Reports an element of another vocabulary that is meant to count here: an inclusion of XML, or one with a name of
    /// SCA. What is in a namespace that is nearly one that counts is reported with that.
    #[cold]
    fn passed_over(&mut self, element: Element<'_>, parent: &'static Kind) {
        let (name, local, namespace) = (element.name(), element.local_name(), element.namespace());
        let is_of_sca = || parent.children.contains(&local) && !NOT_KEPT.contains(&local);
        let help = match namespace {
            XINCLUDE => "`<include name=\"...\"/>` without a prefix includes a composite by its name".to_owned(),
            _ if !is_of_sca() => return,
            _ if self.meant_namespace(namespace, element.document()).is_some() => return self.miss(element),
            _ => {
                let prefix = element.document().root().prefix().map_or_else(String::new, |prefix| format!("{prefix}:"));
                format!("write {} if you mean the element of SCA", quoted(&format!("<{prefix}{local}>")))
            }
        };
        let message = format!("{} is ignored: its namespace {} is not that of SCA", quoted(name), quoted(namespace));
        self.report(Diagnostic::new(&codes::FOREIGN_ELEMENT, element.name_location(), message).help(help));
        self.miss(element);
        if let Some(source) = element.attribute("source").filter(|_| local == "property") {
            let (value, file) = (source.value(), element.document().file());
            let name = value.trim().strip_prefix('$').and_then(|rest| rest.split(['/', '[', ' ']).next());
            name.into_iter().for_each(|name| self.diagnostics.add_meant(file, name));
        }
    }

    /// Notes that components are missing: what the fleet lacks without them is no fault of its own.
    fn miss(&mut self, element: Element<'_>) {
        if ["component", "include"].contains(&element.local_name()) {
            let hidden = HiddenNames { composites: false, components: true, others: true };
            self.diagnostics.add_damage(element.span().in_file(element.document().file()), hidden);
        }
    }

    /// Reports an element of SCA, or of SAOMS, that cannot be where it is. Gives the name that is meant where it is
    /// misspelt, to be read on as what has that.
    pub(super) fn unexpected(
        &mut self,
        element: Element<'_>,
        parent: &'static Kind,
        family: Family,
    ) -> Option<&'static str> {
        let name = element.local_name();
        if family == Family::Sca && element.namespace() != self.namespace {
            // Of another version, which is reported: its meaning in this one is unknown.
            return None;
        }
        if family == Family::Sca && is_own_alone(name) {
            self.own_without_namespace(element);
            return None;
        }
        let known: Vec<&'static str> = match family {
            Family::Own => OWN_ELEMENTS.to_vec(),
            _ => vocabulary::children(parent).collect(),
        };
        let is_own = family == Family::Own && OWN_ELEMENTS.contains(&name);
        if is_own && name == SEVERITY.name {
            self.meant_severity(element);
        }
        let is_of_sca = is_known(name) || vocabulary::is_of_definitions(name);
        let is_misplaced = is_own || (family == Family::Sca && is_of_sca);
        let code = if is_misplaced { &codes::MISPLACED_ELEMENT } else { &codes::UNKNOWN_ELEMENT };
        let location = element.name_location();
        // It may belong elsewhere.
        let is_doubtful = element.is_unnamed() || element.parent().is_some_and(|parent| !parent.is_closed());
        if is_doubtful || self.diagnostics.skip(code, Severity::Error, location) {
            return None;
        }
        let place = quoted(parent.name);
        let holds = || {
            let names = parent.children.iter().map(|child| match child.strip_suffix('.') {
                Some(prefix) => quoted(&format!("{prefix}.*")),
                None => quoted(child),
            });
            match names.collect::<Vec<_>>().join(", ") {
                none if none.is_empty() => format!("{place} cannot contain elements of SCA"),
                names => format!("{place} can contain {names}"),
            }
        };
        if is_misplaced {
            let message = format!("{} is not allowed in {place}", quoted(element.name()));
            let one = Diagnostic::new(code, location, message);
            if name == "implementation.composite" && vocabulary::children(parent).any(|one| one == "include") {
                self.report(renamed(one, element, "include"));
                return Some("include");
            }
            let is_implementation = |child: Element<'_>| child.local_name().starts_with("implementation.");
            let around = element.parent();
            if name == "include" && parent.name == "component" {
                let is_only = !around.is_some_and(|around| around.children().any(is_implementation));
                if is_only {
                    self.report(renamed(one, element, "implementation.composite"));
                    return Some("implementation.composite");
                }
                self.hide_components(element);
            }
            if name == "component" {
                self.hide_components(element);
            }
            self.report(match is_own {
                true => one.help(format!("it is allowed in {}", list(vocabulary::own_parents(name).iter().copied()))),
                false => one.help(belongs_outside(name, parent).unwrap_or_else(holds)),
            });
            return None;
        }
        let whose = if family == Family::Own { "SAOMS" } else { self.version.label() };
        let message = format!("{whose} has no element {}", quoted(name));
        let one = Diagnostic::new(code, location, message);
        // A slip in `implementation.jva` is one in its last part.
        let slip = match name.split_once('.') {
            Some((kind, variant)) if known.iter().any(|one| one.split('.').next() == Some(kind)) => {
                let variants = known.iter().filter(|one| one.split_once('.').is_some_and(|(of, _)| of == kind));
                let meant = nearest(variant, variants.clone().filter_map(|one| Some(one.split_once('.')?.1)));
                meant.and_then(|meant| {
                    variants.copied().find(|one| one.ends_with(meant) && one.len() == kind.len() + 1 + meant.len())
                })
            }
            _ => nearest(name, known.iter().copied()),
        };
        let is_exchange = matches!(name, "import" | "export") && element.attribute("namespace").is_some();
        let word = word(name).filter(|meant| known.contains(meant) && !is_exchange);
        self.report(match word.or(slip) {
            _ if is_exchange => one.help("write it in the `sca-contribution.xml` of the folder"),
            None if parent.has(name, self.version) && is_attribute_as_element(element) => as_attribute(one, element),
            Some("implementation.java") if let Some((kind, attribute)) = kind_in_attribute(element) => {
                let file = element.document().file();
                let name = if kind == "composite" { "name" } else { "class" };
                let mut edits = renaming(element, element.prefix(), &format!("implementation.{kind}"));
                edits.push(Edit { location: attribute.in_file(file), replacement: name.to_owned() });
                let meant = format!("<implementation.{kind} {name}=\"...\"/>");
                one.suggest_edits(format!("write it as {}", quoted(&meant)), edits)
            }
            Some(meant) => renamed(one, element, meant),
            None if name.starts_with("implementation.") => {
                one.help("if it is an extension, write it with a prefix of its own namespace").help(
                    "`implementation.rust`, `implementation.java` and `implementation.python` name a class, \
                    `implementation.composite` a composite",
                )
            }
            None if name.contains('.') => {
                one.help("if it is an extension, write it with a prefix of its own namespace").help(holds())
            }
            None if parent.name == "component" => as_property(one, element).help(holds()),
            None => one.help(holds()),
        });
        match word {
            // What it is called elsewhere has the same parts.
            Some(meant) => Some(meant).filter(|meant| !meant.contains('.')),
            None => slip.filter(|_| !is_exchange),
        }
    }

    /// Checks an element of SCA that the model does not keep: its version, and the names in it.
    pub(super) fn check_not_kept(&mut self, element: Element<'_>) {
        self.of_version(element);
        match POLICIES.into_iter().find(|kind| kind.name == element.local_name()) {
            // Its attributes are its owner's.
            Some(kind) if std::ptr::eq(kind, &OPERATION) => self.leaf(element, kind),
            Some(kind) => self.parts_of(element, kind),
            None => {}
        }
    }

    /// Checks the children of an element none of whose children the model holds.
    pub(super) fn leaf(&mut self, element: Element<'_>, kind: &'static Kind) {
        for child in element.children() {
            let family = self.family(child);
            let name = child.local_name();
            // Formats and selectors are made by those who make bindings.
            let is_made =
                |known: &&str| matches!(*known, "wireFormat." | "operationSelector.") && name.starts_with(*known);
            let is_known = vocabulary::children(kind).any(|known| known == name) || kind.children.iter().any(is_made);
            if family == Family::Own && name == SEVERITY.name && SEVERITY_PARENTS.contains(&kind.name) {
                self.severity(child, element);
                continue;
            }
            if family == Family::Sca && is_known {
                self.check_not_kept(child);
            } else if matches!(family, Family::Sca | Family::Own) {
                _ = self.unexpected(child, kind, family);
            }
        }
    }

    /// Tells of an element that another version of SCA alone has, once for all of its name. It changes nothing here.
    pub(super) fn of_version(&mut self, element: Element<'_>) {
        let is_1_1 = self.version.is_1_1();
        let others = if is_1_1 { ONLY_1_0 } else { ONLY_1_1 };
        let Some(name) = others.iter().copied().find(|known| *known == element.local_name()) else { return };
        // With a wrong namespace the version is unknown.
        if self.newer.contains(&name) || Version::from_namespace(&self.namespace).is_none() {
            return;
        }
        self.newer.push(name);
        let (version, other) = if is_1_1 { ("SCA 1.1", "SCA 1.0") } else { ("SCA 1.0", "SCA 1.1") };
        let message = format!("{} is an element of {other}, but this file is of {version}", quoted(name));
        let one = Diagnostic::new(&codes::UNKNOWN_ELEMENT, element.name_location(), message);
        let one = one.severity(Severity::Warning).help("other programs refuse it");
        self.report(match name {
            "documentation" => one.help("write a comment instead"),
            _ => one,
        });
    }

    /// Reports a second element of a kind that may occur once.
    pub(super) fn repeated(&mut self, element: Element<'_>, first: Location, parent: &'static Kind, what: &str) {
        let message = format!("{} has a second {what}", quoted(parent.name));
        let one = Diagnostic::new(&codes::REPEATED_ELEMENT, element.name_location(), message);
        self.report(one.label(first, format!("the first {what}")).help("keep one of the two"));
    }

    /// Reports text in an element that holds elements alone.
    pub(super) fn no_text(&mut self, element: Element<'_>) {
        let Some(span) = element.text_span().filter(|_| !element.has_damaged_content()) else { return };
        let location = span.in_file(element.document().file());
        let message = format!("unexpected text in {}: it contains elements only", quoted(element.name()));
        let one = Diagnostic::new(&codes::MISPLACED_TEXT, location, message);
        let is_of = |kind: &str| element.local_name().starts_with(kind);
        self.report(if is_of("implementation.") && element.attribute("class").is_none() {
            one.help("name the class with the attribute `class`")
        } else if element.local_name() == "wire" && element.attributes().next().is_none() {
            one.help("name the two ends with attributes: `<wire source=\"COMPONENT/REFERENCE\" target=\"COMPONENT\"/>`")
        } else if is_of("reference") && element.attribute("target").is_none() {
            one.help("name the component that it calls with the attribute `target`")
        } else if let Some(one) = as_tag(one.clone(), element, span, &KINDS_IN_TEXT) {
            one
        } else {
            as_comment(one, element, span)
        });
    }

    /// Reports an element of SAOMS that is not in its namespace, with what puts it there.
    fn own_without_namespace(&mut self, element: Element<'_>) {
        let name = element.local_name();
        if name == SEVERITY.name {
            self.meant_severity(element);
        }
        let shown = quoted(element.name());
        let message = format!("{shown} is an element of SAOMS: it has to be in the namespace `{SAOMS_NAMESPACE}`");
        let one = Diagnostic::new(&codes::UNKNOWN_ELEMENT, element.name_location(), message);
        let (prefix, declaration) = own_prefix(element);
        let edits = declaration.into_iter().chain(renaming(element, Some(prefix), name)).collect();
        let help = format!(
            "write `<{prefix}:{name} .../>`, and `xmlns:{prefix}=\"{SAOMS_NAMESPACE}\"` in the composite's start tag"
        );
        let description = format!("replace {shown} with {}", quoted(&format!("{prefix}:{name}")));
        self.report(one.help(help).suggest_edits(description, edits));
    }

    fn without_namespace(&mut self, element: Element<'_>, root: Element<'_>) {
        let name = element.local_name();
        if is_own_alone(name) {
            return self.own_without_namespace(element);
        }
        let message = format!("{} is in no namespace", quoted(name));
        let one = Diagnostic::new(&codes::UNKNOWN_ELEMENT, element.name_location(), message);
        self.report(match root.prefix().filter(|_| is_known(name)) {
            Some(prefix) => {
                let description = format!("replace {} with {}", quoted(name), quoted(&format!("{prefix}:{name}")));
                one.suggest_edits(description, renaming(element, Some(prefix), name))
            }
            None => one.help("write it in the namespace of the composite if it is of SCA, else in its own"),
        });
    }
}

/// The suggestion to give an element another name, with the prefix that it has.
pub(super) fn renamed(one: Diagnostic, element: Element<'_>, meant: &str) -> Diagnostic {
    let description = format!("replace {} with {}", quoted(element.local_name()), quoted(meant));
    one.suggest_edits(description, renaming(element, element.prefix(), meant))
}

/// An element that is to be an attribute of the one around it, with what makes it one.
fn as_attribute(one: Diagnostic, element: Element<'_>) -> Diagnostic {
    let (Some(around), Some(text)) = (element.parent(), element.trimmed_text()) else { return one };
    let document = element.document();
    let value = document.piece(text.location.span);
    let written = format!("{}=\"{}\"", element.local_name(), value.replace('"', "&quot;"));
    let place = Span::empty(around.name_span().end).in_file(document.file());
    let edits = vec![
        Edit { location: place, replacement: format!(" {written}") },
        Edit { location: element.span().in_file(document.file()), replacement: String::new() },
    ];
    one.suggest_edits(format!("write it as an attribute: {}", quoted(&written)), edits)
}

/// The comment that text between elements is meant to be, in the syntax of another language.
fn as_comment(one: Diagnostic, element: Element<'_>, span: Span) -> Diagnostic {
    let text = element.document().piece(span);
    let remark = ["#", "//", ";"].iter().find_map(|mark| text.strip_prefix(mark)).map(str::trim);
    match remark.filter(|remark| !remark.contains(['<', '\n']) && !remark.contains("--")) {
        Some(remark) => one.mend("write it as a comment", format!("<!-- {remark} -->")),
        None => one.help("remove it, or write a comment between `<!--` and `-->`"),
    }
}

/// The kind of an `implementation` that an attribute is called after, with the place of its name.
fn kind_in_attribute(element: Element<'_>) -> Option<(&str, Span)> {
    let mut kinds = element.attributes().filter(|one| matches!(one.name(), "java" | "rust" | "composite"));
    kinds.next().filter(|_| element.local_name() == "implementation").map(|one| (one.name(), one.name_span()))
}

/// Names of elements in other languages, and general names of several.
fn word(name: &str) -> Option<&'static str> {
    Some(match name {
        "implementation" => "implementation.java",
        "implementation.component" | "implementation.sca" => "implementation.composite",
        "interface" => "interface.java",
        "binding" => "binding.sca",
        "param" | "parameter" | "arg" | "argument" => "property",
        "node" | "bean" => "component",
        "connection" | "connect" | "link" => "wire",
        "import" => "include",
        _ => return None,
    })
}

/// True if an element of this name is of SAOMS, and none of SCA could be meant.
fn is_own_alone(name: &str) -> bool {
    OWN_ELEMENTS.contains(&name) && !name.contains('.')
}

/// True if SCA has an element of this name somewhere in a composite.
pub(super) fn is_known(name: &str) -> bool {
    vocabulary::names().any(|known| known == name)
}

/// The edits that give an element another name, in its end tag too.
pub(crate) fn renaming(element: Element<'_>, prefix: Option<&str>, name: &str) -> Vec<Edit> {
    let whole = prefix.map_or_else(|| name.to_owned(), |prefix| format!("{prefix}:{name}"));
    let file = element.document().file();
    let spans = [Some(element.name_span()), element.end_name_span()];
    let is_other = |span: &Span| element.document().piece(*span) != whole;
    let edit = |span: Span| Edit { location: span.in_file(file), replacement: whole.clone() };
    spans.into_iter().flatten().filter(is_other).map(edit).collect()
}

/// The types of SCA's schemas, as they stand in `xsi:type`, and the elements that they mean.
const TYPES: [(&str, &str); 9] = [
    ("JavaInterface", "interface.java"),
    ("WSDLPortType", "interface.wsdl"),
    ("JavaImplementation", "implementation.java"),
    ("SCAImplementation", "implementation.composite"),
    ("SpringImplementation", "implementation.spring"),
    ("SCABinding", "binding.sca"),
    ("WebServiceBinding", "binding.ws"),
    ("JMSBinding", "binding.jms"),
    ("EJBSessionBeanBinding", "binding.ejb"),
];

/// The local name of an element; of a general `interface`, `implementation` or `binding` that of what its `xsi:type`
/// makes of it, as modelling tools write them.
pub(super) fn meant_name(element: Element<'_>) -> &str {
    let name = element.local_name();
    match name {
        "interface" | "implementation" | "binding" => by_type(element).unwrap_or(name),
        _ => name,
    }
}

fn by_type(element: Element<'_>) -> Option<&'static str> {
    let given = element.attribute_in("http://www.w3.org/2001/XMLSchema-instance", "type")?.trimmed();
    let given = given.rsplit(':').next()?;
    let of_schema = TYPES.iter().find(|(known, _)| *known == given).map(|(_, meant)| *meant);
    let meant = of_schema.or_else(|| vocabulary::names().find(|known| *known == given))?;
    (meant.split('.').next() == Some(element.local_name())).then_some(meant)
}

/// The text behind `prefix` in the local name of an element.
pub(super) fn variant(element: Element<'_>, prefix: &str) -> SmolStr {
    meant_name(element).strip_prefix(prefix).unwrap_or_default().into()
}

/// True if SCA defines this variant of an implementation, an interface or a binding.
pub(super) fn is_defined(element: Element<'_>) -> bool {
    let name = meant_name(element);
    name.contains('.') && is_known(name)
}
