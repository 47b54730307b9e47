//! Attributes: which there are, and what their values say.

use std::borrow::Cow;

use super::Loader;
use super::children::is_known;
use super::other_words::{
    as_property, given_already, is_class_beside_implementation, is_class_without_implementation, is_word_for,
};
use super::vocabulary::{self, Holds, Kind, Known};
use crate::diagnostic::{Diagnostic, Edit, Severity, codes, meant_boolean, nearest, quoted};
use crate::limits::LIST_WORDS;
use crate::model::{Multiplicity, SAOMS_NAMESPACE, Version};
use crate::source::{Located, Span, Text};
use crate::syntax::{Attribute, Element, escaped, is_local_name};

impl Loader<'_> {
    /// Reports the attributes that an element of this kind does not have. Foreign ones are kept and not looked at.
    pub(super) fn check_attributes(&mut self, element: Element<'_>, kind: &'static Kind) {
        let mut free: Option<Vec<&'static str>> = None;
        self.refused.clear();
        for attribute in element.named_attributes() {
            if attribute.namespace().is_empty()
                && let Some(known) = kind.find(attribute.name(), self.version)
            {
                if known.only_1_1 && !self.version.is_1_1() {
                    self.newer(element, attribute, known);
                }
                if matches!(known.holds, Holds::Names | Holds::Element) {
                    self.prefixes(element, attribute);
                }
                continue;
            }
            let is_own = match attribute.namespace() {
                SAOMS_NAMESPACE if vocabulary::is_own(kind, attribute.local_name()) => continue,
                "" | SAOMS_NAMESPACE => true,
                namespace if namespace == self.namespace || Version::from_namespace(namespace).is_some() => {
                    !kind.has(attribute.local_name(), self.version)
                }
                _ => continue,
            };
            // What is given already is not meant a second time.
            let free = free.get_or_insert_with(|| {
                let names = kind.names(self.version);
                names.filter(|known| element.attribute(known).is_none()).collect()
            });
            // What an attribute says that nobody reads would be used.
            for word in
                attribute.value().split(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '-' | '.'))).take(8)
            {
                self.diagnostics.add_meant(element.document().file(), word);
            }
            if is_own {
                self.unknown(element, attribute, kind, free);
            } else {
                self.prefixed(attribute, free);
            }
        }
    }

    /// Tells of names whose prefixes mean nothing: what they name is not found by others.
    fn prefixes(&mut self, element: Element<'_>, attribute: Attribute<'_>) {
        for word in attribute.words().take(LIST_WORDS) {
            let Some((prefix, local)) = word.split_once(':') else { continue };
            if is_local_name(prefix) && !local.starts_with('/') && element.resolve_prefix(prefix).is_none() {
                let message = format!("the prefix {} of {} is not declared", quoted(prefix), quoted(&word));
                let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, word.location, message).severity(Severity::Warning);
                let help = format!("declare it in the root element: `xmlns:{prefix}=\"...\"`, or correct it");
                self.report(one.help(help));
            }
        }
    }

    /// Tells of an attribute of SCA 1.1 in a file of 1.0, once for all of its name.
    fn newer(&mut self, element: Element<'_>, attribute: Attribute<'_>, known: &'static Known) {
        // With a wrong namespace the version is unknown.
        if self.newer.contains(&known.name) || Version::from_namespace(&self.namespace).is_none() {
            return;
        }
        self.newer.push(known.name);
        let (name, of) = (quoted(known.name), quoted(element.name()));
        let message = format!("{name} of {of} is an attribute of SCA 1.1, but this file is of SCA 1.0");
        let one = Diagnostic::new(&codes::NEWER_ATTRIBUTE, attribute.name_location(), message)
            .help("SAOMS reads it, other programs may not: change the file to SCA 1.1");
        let inside = "or write the value as text inside";
        self.report(if known.name == "value" { one.help(inside) } else { one });
    }

    fn unknown(&mut self, element: Element<'_>, attribute: Attribute<'_>, kind: &'static Kind, free: &[&'static str]) {
        let (name, location) = (attribute.name(), attribute.name_location());
        if attribute.namespace() == SAOMS_NAMESPACE {
            return self.unknown_own(element, attribute, kind);
        }
        let meant = nearest(name, free.iter().copied()).or_else(|| nearest(name, kind.names(self.version)));
        let meant = meant.or_else(|| free.iter().copied().find(|known| is_word_for(name, known, element)));
        // The schema of SCA 1.0 lets any attribute pass; tools put some of their own there.
        let passes = meant.is_none()
            && !is_named_so(element, attribute)
            && attribute.namespace().is_empty()
            && !self.version.is_1_1()
            && element.namespace() != SAOMS_NAMESPACE;
        let severity = if passes { Severity::Warning } else { Severity::Error };
        self.refused.extend((!passes).then_some(attribute.name_span()));
        if self.diagnostics.skip(&codes::UNKNOWN_ATTRIBUTE, severity, location) {
            return;
        }
        let message = format!("{} has no attribute {}", quoted(element.name()), quoted(name));
        let mut one = Diagnostic::new(&codes::UNKNOWN_ATTRIBUTE, location, message).severity(severity);
        one = match meant {
            None if is_named_so(element, attribute) => {
                let (value, whole) = (attribute.raw_value().replace('"', "&quot;"), attribute.location());
                let meant = format!("name=\"{name}\" value=\"{value}\"");
                match self.version.is_1_1() && element.attribute("value").is_none() {
                    true => one.suggest(format!("replace it with {}", quoted(&meant)), whole, meant),
                    false => one.help(format!("write `<{} name=\"{name}\">{value}</{0}>`", element.name())),
                }
            }
            Some("name") if attribute.value().trim().ends_with(".composite") => one.help(
                "write the composite's `name` with the prefix of its `targetNamespace`, not the name of its file",
            ),
            Some(meant) if free.contains(&meant) => {
                self.meant.push((element.id(), meant, name.to_owned()));
                one.replace(name, location, meant)
            }
            Some(meant) => one.help(given_already(meant)),
            None if vocabulary::own_names(kind).any(|known| known == name) => {
                own_without_prefix(one, attribute, element)
            }
            // There is no end tag to write it before.
            None if element.end_tag_span().is_none() && is_class_without_implementation(element, attribute) => one
                .help(format!(
                    "write `<implementation.rust class=\"{}\"/>` in the component",
                    attribute.value().trim()
                )),
            None if name == "mustSupply" => {
                one.help("remove it: it belongs to a property of the composite that its users have to give")
            }
            None if kind.has(name, Version::Osoa10) => one.help("remove it: only SCA 1.0 has this attribute"),
            None if name == "file" => {
                one.help("only a property of a component has this attribute: write the value here")
            }
            None if kind.names(self.version).next().is_none() => one.help("it has no attributes"),
            None => {
                let names: Vec<String> = kind.names(self.version).map(quoted).collect();
                let one = one.help(format!("{} has the attributes {}", quoted(kind.name), names.join(", ")));
                match is_class_beside_implementation(element, attribute) {
                    _ if passes => one,
                    true => one
                        .help("`class` belongs to its `implementation.rust` or `implementation.java`: write it there"),
                    false => as_property(one, element, attribute),
                }
            }
        };
        self.report(one);
    }

    /// An attribute in the namespace of SAOMS that is none of SAOMS.
    fn unknown_own(&mut self, element: Element<'_>, attribute: Attribute<'_>, kind: &'static Kind) {
        let name = attribute.local_name();
        self.refused.push(attribute.name_span());
        let message = format!("{} has no attribute {}", quoted(element.name()), quoted(attribute.name()));
        let one = Diagnostic::new(&codes::UNKNOWN_ATTRIBUTE, attribute.name_location(), message);
        let prefix = attribute.prefix().unwrap_or_default();
        let names: Vec<String> =
            vocabulary::own_names(kind).map(|known| quoted(&format!("{prefix}:{known}"))).collect();
        let is_free = |known: &&str| element.attribute_in(SAOMS_NAMESPACE, known).is_none();
        let meant = nearest(name, vocabulary::own_names(kind).filter(is_free));
        self.report(match meant.or_else(|| nearest(name, vocabulary::own_names(kind))) {
            Some(meant) if !is_free(&meant) => one.help(given_already(&format!("{prefix}:{meant}"))),
            Some(meant) => one.replace(attribute.name(), attribute.name_location(), &format!("{prefix}:{meant}")),
            None if kind.has(name, self.version) && element.attribute(name).is_some() => one.help(given_already(name)),
            None if kind.has(name, self.version) => one.mend("remove the prefix", name),
            None if name == "env" => one.help(
                "only a property of the composite has this attribute: take the value of such a property with `source`",
            ),
            None if kind.name == "include" && matches!(name, "site" | "node" | "count") => one.help(format!(
                "only a component can have it: write `<component name=\"...\" {}=\"{}\"><implementation.composite \
                 name=\"{}\"/></component>` in place of the `include`",
                attribute.name(),
                attribute.value(),
                element.attribute("name").map(|one| one.value().into_owned()).unwrap_or_default()
            )),
            None if vocabulary::own_names(&vocabulary::COMPONENT).any(|known| known == name) => one.help(format!(
                "write it in the start tag of a `component`: {} has no such attribute",
                quoted(kind.name)
            )),
            None if vocabulary::own_names(&vocabulary::COMPOSITE).any(|known| known == name) => {
                one.help("write it in the start tag of the outermost `composite`")
            }
            None if names.is_empty() => one.help(format!("{} has no attributes of SAOMS", quoted(kind.name))),
            None => one.help(format!("its attributes of SAOMS are {}", names.join(", "))),
        });
    }

    /// An attribute of SCA with a prefix: SCA's attributes have none.
    fn prefixed(&mut self, attribute: Attribute<'_>, free: &[&str]) {
        self.refused.push(attribute.name_span());
        let message = format!("{} has a prefix; attributes of SCA have none", quoted(attribute.name()));
        let one = Diagnostic::new(&codes::UNKNOWN_ATTRIBUTE, attribute.name_location(), message);
        let local = attribute.local_name();
        self.report(if free.contains(&local) { one.mend("remove the prefix", local) } else { one });
    }

    /// The value of an attribute, white space at its ends left out.
    pub(super) fn optional(&mut self, element: Element<'_>, name: &str) -> Option<Text> {
        self.attribute(element, name).map(Attribute::trimmed)
    }

    /// The attribute of this name, or its misspelling, which is reported.
    fn attribute<'e>(&self, element: Element<'e>, name: &str) -> Option<Attribute<'e>> {
        element.attribute(name).or_else(|| {
            let mut meant = self.meant.iter().rev().take_while(|(of, ..)| *of == element.id());
            let (_, _, written) = meant.find(|(_, meant, _)| *meant == name)?;
            element.attribute(written)
        })
    }

    /// The value of an attribute of SAOMS on an element of SCA.
    pub(super) fn own(&mut self, element: Element<'_>, name: &str) -> Option<Text> {
        let attribute = element.attribute_in(SAOMS_NAMESPACE, name)?;
        let value = attribute.trimmed();
        if value.is_empty() {
            self.empty(attribute, attribute.name());
            return None;
        }
        Some(value)
    }

    /// The value of an attribute that has to be there, and not be empty.
    pub(super) fn required(&mut self, element: Element<'_>, name: &str) -> Option<Text> {
        let attribute = self.attribute(element, name);
        let value = attribute.map(Attribute::trimmed).filter(|value| !value.is_empty());
        match attribute {
            None => self.missing(element, name),
            // Of a tag that ends in the middle nothing more is said.
            Some(attribute) if value.is_none() && !element.has_damaged_tag() => self.empty(attribute, name),
            Some(_) => {}
        }
        value
    }

    fn empty(&mut self, attribute: Attribute<'_>, name: &str) {
        let message = format!("the attribute {} is empty", quoted(name));
        let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, attribute.location(), message);
        self.report(one.help(match name {
            "class" => "name a class: `saoms components` lists all",
            _ => "write its value between the quotes",
        }));
    }

    fn missing(&mut self, element: Element<'_>, name: &str) {
        // A misspelt one is reported already, with the right name as suggestion; so is a class that is written inside.
        let is_child = |child: Element<'_>| is_attribute_as_element(child) && child.local_name() == name;
        let is_inside = name == "class" && element.has_text() || element.children().any(is_child);
        if is_inside || element.has_damaged_tag() || has_near_miss(element, name) {
            return;
        }
        let message = format!("{} needs the attribute {}", quoted(element.name()), quoted(name));
        let help = format!("add {} to it", quoted(&format!("{name}=\"...\"")));
        self.report(Diagnostic::new(&codes::MISSING_ATTRIBUTE, element.name_location(), message).help(help));
    }

    /// The name of a part; empty, at the tag, when there is none.
    pub(super) fn name(&mut self, element: Element<'_>) -> Text {
        let Some(name) = self.required(element, "name") else {
            return Located::new("".into(), element.name_location());
        };
        if name.is_ascii() && is_local_name(&name) {
            return name;
        }
        // Copied from a page or a document, of no width. What turns the writing direction is warned of.
        let is_unseen = |letter| matches!(letter, '\u{ad}' | '\u{200b}'..='\u{200d}' | '\u{2060}' | '\u{feff}');
        if let Some(unseen) = name.chars().find(|letter| is_unseen(*letter)) {
            let clean: String = name.chars().filter(|letter| !is_unseen(*letter)).collect();
            let code = format!("U+{:04X}", unseen as u32);
            let message = format!("the name {} contains the invisible character {code}", quoted(&clean));
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, name.location, message);
            self.report(one.suggest("remove that character", name.location, escaped(&clean)));
            return Located::new(clean.into(), name.location);
        }
        if is_local_name(&name) {
            return name;
        }
        if let Some(bad) = without_expressions(&name).chars().find(|c| c.is_whitespace() || *c == '/') {
            let shown = quoted(bad.encode_utf8(&mut [0; 4]));
            let message = format!("{} cannot be a name: it contains {shown}", quoted(&name));
            let help =
                "remove it from the name: targets use `/` in `component/service`, and lists separate names with blanks";
            self.report(Diagnostic::new(&codes::ATTRIBUTE_VALUE, name.location, message).help(help));
        } else if !name.contains("${") && (name.contains(':') || !name.starts_with(is_first)) {
            self.no_name(&name);
        }
        name
    }

    /// Warns of a name that XML does not allow as one (NCName, Namespaces in XML 1.0, 3): it does here what any other
    /// does.
    fn no_name(&mut self, name: &Text) {
        let why = match name.starts_with(is_first) {
            true => "has a colon in it",
            false => "does not start with a letter or `_`",
        };
        let message = format!("{} {why}: it is not an XML name", quoted(name));
        let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, name.location, message);
        self.report(one.severity(Severity::Warning).help("other programs refuse it"));
    }

    /// The value of a boolean attribute.
    pub(super) fn boolean(&mut self, element: Element<'_>, name: &str) -> Option<Located<bool>> {
        let attribute = self.attribute(element, name)?;
        let text = attribute.trimmed();
        let value = match text.as_str() {
            "true" | "1" => true,
            "false" | "0" => false,
            other => {
                let message = format!("{} is {}, expected `true` or `false`", quoted(name), quoted(other));
                let meant = meant_boolean(other);
                self.value_fault(attribute, message, meant);
                meant? == "true"
            }
        };
        Some(Located::new(value, text.location))
    }

    /// The value of `multiplicity`.
    pub(super) fn multiplicity(&mut self, element: Element<'_>) -> Option<Located<Multiplicity>> {
        let attribute = element.attribute("multiplicity")?;
        let text = attribute.trimmed();
        if let Some(value) = Multiplicity::from_name(&text) {
            return Some(Located::new(value, text.location));
        }
        let meant = text.to_ascii_lowercase().replace(['*', 'm'], "n").replace("unbounded", "n");
        let names = Multiplicity::ALL.map(Multiplicity::name);
        let is_of_class = element.parent().is_some_and(|parent| parent.local_name() == "component");
        let meant = match meant.as_str() {
            "1" => Some("1..1"),
            "n" => Some("0..n"),
            other => names.into_iter().find(|name| *name == other),
        };
        let message = format!("`multiplicity` is {}, expected `0..1`, `1..1`, `0..n` or `1..n`", quoted(&text));
        match meant.filter(|meant| is_of_class && meant.ends_with('n')) {
            // How many targets the reference can have its class says.
            Some(_) => {
                let location = attribute.value_span().in_file(attribute.location().file);
                let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, location, message);
                let before = &element.document().text()[..attribute.span().start as usize];
                let whole = Span { start: before.trim_end().len() as u32, end: attribute.span().end };
                self.report(one.suggest(
                    "remove `multiplicity`: the class says how many targets there can be",
                    whole.in_file(location.file),
                    "",
                ));
            }
            None => self.value_fault(attribute, message, meant),
        }
        None
    }

    /// The words of an attribute that is a list.
    pub(super) fn list(&mut self, element: Element<'_>, name: &str) -> Vec<Text> {
        let Some(attribute) = self.attribute(element, name) else { return Vec::new() };
        let mut words: Vec<Text> = attribute.words().take(LIST_WORDS + 1).collect();
        if let Some(beyond) = words.get(LIST_WORDS) {
            let message = format!("{} has more than {LIST_WORDS} words", quoted(name));
            let one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, beyond.location, message);
            self.report(one.help("the other words are ignored"));
            words.truncate(LIST_WORDS);
        }
        words
    }

    pub(super) fn value_fault(&mut self, attribute: Attribute<'_>, message: String, meant: Option<&str>) {
        let whole = attribute.location();
        let value = attribute.value_span().in_file(whole.file);
        // Nothing can be seen between two quotes.
        let location = if attribute.trimmed().is_empty() { whole } else { value };
        let mut one = Diagnostic::new(&codes::ATTRIBUTE_VALUE, location, message);
        if let Some(meant) = meant {
            one = one.suggest(format!("replace it with {}", quoted(meant)), value, escaped(meant));
        }
        self.report(one);
    }
}

/// The prefix of the namespace of SAOMS in the document of an element, and the edit that declares it where the root
/// does not.
pub(super) fn own_prefix(element: Element<'_>) -> (&str, Option<Edit>) {
    let root = element.document().root();
    let mut declared = root.namespace_declarations();
    match declared.find(|one| one.value() == SAOMS_NAMESPACE && one.name() != "xmlns") {
        Some(bound) => (bound.local_name(), None),
        None => {
            let location = Span::empty(root.name_span().end).in_file(element.document().file());
            let replacement = format!(" xmlns:saoms=\"{SAOMS_NAMESPACE}\"");
            ("saoms", Some(Edit { location, replacement }))
        }
    }
}

/// Help for an attribute of SAOMS without the prefix of its namespace.
fn own_without_prefix(one: Diagnostic, attribute: Attribute<'_>, element: Element<'_>) -> Diagnostic {
    let (prefix, declaration) = own_prefix(element);
    let whole = format!("{prefix}:{}", attribute.name());
    let edit = Edit { location: attribute.name_location(), replacement: whole.clone() };
    let edits = declaration.into_iter().chain([edit]).collect();
    one.help(format!("write it with a prefix of the namespace `{SAOMS_NAMESPACE}`: it is an attribute of SAOMS"))
        .suggest_edits(format!("replace {} with {}", quoted(attribute.name()), quoted(&whole)), edits)
}

/// True if a name can start with this.
pub(super) fn is_first(letter: char) -> bool {
    letter.is_alphabetic() || letter == '_' || !letter.is_ascii()
}

/// A text of a replicated component without its expressions, in which blanks and slashes are nothing odd.
fn without_expressions(text: &str) -> Cow<'_, str> {
    let mut plain = Cow::Borrowed(text);
    while let Some(start) = plain.find("${") {
        let end = plain[start..].find('}').map_or(plain.len(), |length| start + length + 1);
        plain.to_mut().replace_range(start..end, "");
    }
    plain
}

/// True if an element is written in place of an attribute of the one around it, as far as its content shows it: it is
/// reported as an element that does not exist.
pub(super) fn is_attribute_as_element(element: Element<'_>) -> bool {
    let Some(around) = element.parent() else { return false };
    // What is in a property may be its value.
    around.local_name() != "property"
        && element.namespace() == around.namespace()
        && element.attributes().next().is_none()
        && element.children().next().is_none()
        && element.trimmed_text().is_some_and(|text| !text.value.is_empty())
        && !is_known(element.local_name())
        && around.attribute(element.local_name()).is_none()
}

/// True if an attribute of the element could be a misspelt `name`.
fn has_near_miss(element: Element<'_>, name: &str) -> bool {
    let mut own = element.attributes().filter(|attribute| attribute.namespace().is_empty());
    own.any(|attribute| {
        nearest(attribute.name(), [name]).is_some()
            || is_word_for(attribute.name(), name, element)
            || name == "name" && is_named_so(element, attribute)
    })
}

/// True if an attribute of a property without a name has the name that the property is to have: `<property
/// period="100"/>`.
fn is_named_so(element: Element<'_>, attribute: Attribute<'_>) -> bool {
    let is_free = |one: &Attribute<'_>| {
        let known = &vocabulary::COMPONENT_PROPERTY;
        one.namespace().is_empty() && !known.has(one.name(), Version::Osoa10)
    };
    let mut free = element.attributes().filter(is_free);
    element.local_name() == "property"
        && element.attribute("name").is_none()
        && free.next().is_some_and(|one| one.name() == attribute.name())
        && free.next().is_none()
}
