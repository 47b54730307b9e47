//! Namespaces of elements and attributes, and attributes that are the same.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

use super::document::{Declaration, ElementId, NO_NAMESPACE, XMLNS};
use super::element::split;
use super::fault::Input;
use super::lexer::Lexer;
use super::slips;
use super::value::{self, Place};
use super::{XML_NAMESPACE, XMLNS_NAMESPACE};
use crate::diagnostic::{Diagnostic, codes, nearest, quoted};

/// Prefixes that everybody writes for the same namespace.
const USUAL: [(&str, &str); 5] = [
    ("xsi", "http://www.w3.org/2001/XMLSchema-instance"),
    ("xsd", "http://www.w3.org/2001/XMLSchema"),
    ("xs", "http://www.w3.org/2001/XMLSchema"),
    ("saoms", "urn:saoms:1"),
    ("tuscany", "http://tuscany.apache.org/xmlns/sca/1.1"),
];

/// Binds all prefixes; gives the namespaces by number, and all declarations by element and prefix.
pub(super) fn resolve(lexer: &mut Lexer<'_>) -> (Vec<Box<str>>, Vec<Declaration>) {
    let mut resolver = Resolver {
        input: lexer.input,
        names: Vec::new(),
        numbers: HashMap::new(),
        bound: HashMap::new(),
        in_scope: Vec::new(),
        reported: HashSet::new(),
        declared: Vec::new(),
        sorted: Vec::new(),
    };
    // `NO_NAMESPACE` and `XMLNS` are the first of these and the last.
    let known = ["", XML_NAMESPACE, XMLNS_NAMESPACE].map(|uri| resolver.number(uri));
    resolver.bound.insert("", vec![known[0]]);
    resolver.bound.insert("xml", vec![known[1]]);
    for element in 0..lexer.elements.len() {
        resolver.element(lexer, element);
    }
    resolver.declared.sort_unstable_by(|one, other| one.key().cmp(&other.key()));
    (resolver.names, resolver.declared)
}

struct Resolver<'a> {
    input: Input<'a>,
    /// The namespaces by number.
    names: Vec<Box<str>>,
    numbers: HashMap<Box<str>, u32>,
    /// The namespaces that a prefix is bound to, the innermost last; "" is that of elements without one.
    bound: HashMap<&'a str, Vec<u32>>,
    /// The prefixes of the declarations in scope, each with the number of the element behind it.
    in_scope: Vec<(u32, &'a str)>,
    /// The prefixes that are reported as unbound.
    reported: HashSet<&'a str>,
    declared: Vec<Declaration>,
    /// The names of the attributes of the element at hand, each with its place.
    sorted: Vec<(&'a str, usize)>,
}

impl<'a> Resolver<'a> {
    fn element(&mut self, lexer: &mut Lexer<'a>, element: usize) {
        while let Some((_, prefix)) = self.in_scope.pop_if(|(after, _)| *after <= element as u32) {
            if let Entry::Occupied(mut bound) = self.bound.entry(prefix) {
                bound.get_mut().pop();
                if bound.get().is_empty() {
                    bound.remove();
                }
            }
        }
        let node = lexer.elements[element];
        let end = lexer.elements.get(element + 1).map_or(lexer.attributes.len(), |next| next.attributes as usize);
        let attributes = node.attributes as usize..end;
        let token = node.token as usize;
        self.same_names(lexer, token, attributes.clone());
        for at in attributes.clone() {
            self.declare(lexer, element, at);
        }
        let namespace = match split(self.input.piece(node.name_span())).0 {
            None => self.namespace(""),
            // It is no name, which is reported.
            Some(_) if lexer.tokens[token].is_unnamed => Some(NO_NAMESPACE),
            Some(prefix) => self.prefix(lexer, prefix, node.name),
        };
        if namespace.is_none() {
            let tag = &mut lexer.tokens[token];
            (tag.is_unnamed, tag.is_damaged) = (true, true);
        }
        lexer.elements[element].namespace = namespace.unwrap_or(NO_NAMESPACE);
        self.attributes(lexer, token, attributes);
    }

    /// Finds attributes of one name. Two names of one namespace are for later, when prefixes are known.
    fn same_names(&mut self, lexer: &mut Lexer<'a>, token: usize, range: Range<usize>) {
        let mut sorted = std::mem::take(&mut self.sorted);
        sorted.clear();
        sorted.extend(range.map(|at| (self.input.piece(lexer.attributes[at].name_span()), at)));
        sorted.sort_unstable();
        for same in sorted.chunk_by(|(one, _), (other, _)| one == other) {
            for (_, second) in &same[1..] {
                self.duplicate(lexer, token, same[0].1, *second);
            }
        }
        self.sorted = sorted;
    }

    /// Takes a declaration, if the attribute is one.
    fn declare(&mut self, lexer: &mut Lexer<'a>, element: usize, at: usize) {
        let one = lexer.attributes[at];
        let name = self.input.piece(one.name_span());
        let Some(prefix) = name.strip_prefix("xmlns").filter(|rest| rest.is_empty() || rest.starts_with(':')) else {
            return;
        };
        lexer.attributes[at].namespace = XMLNS;
        if !one.is_sure() {
            return;
        }
        let prefix = prefix.strip_prefix(':').unwrap_or_default();
        let uri = value::meant(self.input.piece(one.value), Place::Attribute);
        if let Some(message) = refusal(prefix, &uri) {
            lexer.faults.add(|| self.input.fault(&codes::XML_PREFIX, one.start, one.end(), message));
            lexer.attributes[at].is_misnamed = true;
            // That it is bound to nothing here is clear.
            self.reported.insert(prefix);
            return;
        }
        let namespace = self.number(&uri);
        self.bound.entry(prefix).or_default().push(namespace);
        self.in_scope.push((lexer.elements[element].after, prefix));
        self.declared.push(Declaration { element: ElementId(element as u32), prefix: prefix.into(), namespace });
    }

    /// Finds the namespaces of attributes with prefixes, and two of one namespace and name.
    fn attributes(&mut self, lexer: &mut Lexer<'a>, token: usize, range: Range<usize>) {
        let mut seen: HashMap<(u32, &str), usize> = HashMap::new();
        for at in range {
            let one = lexer.attributes[at];
            let (Some(prefix), local) = split(self.input.piece(one.name_span())) else { continue };
            if one.namespace == XMLNS {
                continue;
            }
            let Some(found) = (!one.is_misnamed).then(|| self.prefix(lexer, prefix, one.start)).flatten() else {
                lexer.attributes[at].is_misnamed = true;
                lexer.tokens[token].is_damaged = true;
                continue;
            };
            lexer.attributes[at].namespace = found;
            // Two of the same name are found already.
            if !one.is_duplicate
                && let Some(before) = seen.insert((found, local), at)
            {
                self.duplicate(lexer, token, before, at);
            }
        }
    }

    /// Reports the second of two attributes that are the same.
    fn duplicate(&self, lexer: &mut Lexer<'a>, token: usize, first: usize, second: usize) {
        let (one, other) = (&lexer.attributes[first], &lexer.attributes[second]);
        lexer.faults.add(|| slips::duplicate(self.input, one, other, &self.names[other.namespace as usize]));
        lexer.attributes[second].is_duplicate = true;
        lexer.tokens[token].is_damaged = true;
    }

    /// The namespace that a prefix is bound to here.
    fn namespace(&self, prefix: &str) -> Option<u32> {
        self.bound.get(prefix)?.last().copied()
    }

    /// The namespace of a prefix that is written at `start`; of an unbound one, which is reported once, the namespace
    /// that is meant.
    fn prefix(&mut self, lexer: &mut Lexer<'a>, prefix: &'a str, start: u32) -> Option<u32> {
        if let Some(number) = self.namespace(prefix) {
            return Some(number);
        }
        let root = lexer.elements[0];
        let (fault, meant) = self.unbound(prefix, start, root.name + root.name_len);
        if self.reported.insert(prefix) {
            lexer.faults.add(|| fault);
        }
        meant
    }

    /// The fault of an unbound prefix, and the namespace that is meant. A declaration would stand at `root_end`.
    fn unbound(&mut self, prefix: &str, start: u32, root_end: u32) -> (Diagnostic, Option<u32>) {
        let end = start + prefix.len() as u32;
        let message = format!("the prefix {} is not declared", quoted(prefix));
        let one = self.input.fault(&codes::XML_PREFIX, start, end, message);
        if let Some((_, uri)) = USUAL.iter().find(|(usual, _)| *usual == prefix) {
            let declaration = format!("xmlns:{prefix}=\"{uri}\"");
            let description = format!("declare it in the root element: {}", quoted(&declaration));
            let one = one.suggest(description, self.input.at(root_end, root_end), format!(" {declaration}"));
            return (one, Some(self.number(uri)));
        }
        let one = one.help(format!("declare it, as `xmlns:{prefix}=\"...\"`, in this element or in one around it"));
        let bound = self.bound.iter().filter(|(known, bound)| !bound.is_empty() && !["", "xml"].contains(known));
        let mut bound: Vec<&str> = bound.map(|(known, _)| *known).collect();
        bound.sort_unstable();
        match nearest(prefix, bound) {
            Some(meant) => (one.replace(prefix, self.input.at(start, end), meant), self.namespace(meant)),
            None => (one, None),
        }
    }

    /// The number of a namespace.
    fn number(&mut self, uri: &str) -> u32 {
        if let Some(&number) = self.numbers.get(uri) {
            return number;
        }
        let number = self.names.len() as u32;
        self.names.push(uri.into());
        self.numbers.insert(uri.into(), number);
        number
    }
}

/// The reason why a prefix cannot be bound to a namespace (Namespaces in XML 1.0, section 3), if it cannot.
fn refusal(prefix: &str, uri: &str) -> Option<&'static str> {
    match (prefix, uri) {
        ("xmlns", _) => Some("the prefix `xmlns` cannot be declared"),
        ("xml", XML_NAMESPACE) => None,
        ("xml", _) => Some("the prefix `xml` cannot be declared for another namespace than its own"),
        (_, XML_NAMESPACE) => Some("only the prefix `xml` can have the namespace of `xml`"),
        (_, XMLNS_NAMESPACE) => Some("no prefix can have the namespace of `xmlns`"),
        ("", _) => None,
        (_, "") => Some("the namespace of a prefix cannot be empty"),
        _ => None,
    }
}
