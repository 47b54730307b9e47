//! Namespaces of elements and attributes.

use std::collections::{HashMap, HashSet};

use super::attribute::{BAD_NAME, DUPLICATE, NO_VALUE, RawAttribute, UNRESOLVED, UNSURE};
use super::document::{NO_NAMESPACE, Node, XMLNS};
use super::fault::Input;
use super::fault::slips;
use super::fault::unbound::{self, Meant};
use super::lexer::Lexer;
use super::namespaces::{Namespaces, refusal};
use super::token::{DAMAGED_TAG, PREFIXED, UNNAMED};
use super::value;
use crate::diagnostic::codes;

/// Binds all prefixes; gives the namespaces by number.
pub(super) fn resolve<'a>(lexer: &mut Lexer<'a>) -> Namespaces<'a> {
    let mut resolver =
        Resolver { input: lexer.input, namespaces: Namespaces::new(), unbound: HashSet::new(), scopes: Vec::new() };
    for element in 0..lexer.elements.len() {
        resolver.element(lexer, element);
    }
    resolver.namespaces
}

struct Resolver<'a> {
    input: Input<'a>,
    namespaces: Namespaces<'a>,
    /// The prefixes that are reported as unbound.
    unbound: HashSet<&'a str>,
    /// The elements with declarations that are open: each with the number behind it, and how many declarations are
    /// around it.
    scopes: Vec<(u32, u32)>,
}

impl<'a> Resolver<'a> {
    fn element(&mut self, lexer: &mut Lexer<'a>, element: usize) {
        while let Some(&(after, depth)) = self.scopes.last()
            && element as u32 >= after
        {
            self.namespaces.leave(depth);
            self.scopes.pop();
        }
        let Node { token, after, attributes, name, name_len, .. } = lexer.elements[element];
        let token = token as usize;
        if lexer.tokens[token].flags & PREFIXED == 0 {
            lexer.elements[element].namespace = self.namespaces.default();
            return;
        }
        let end = lexer.elements.get(element + 1).map_or(lexer.attributes.len(), |next| next.attributes as usize);
        let range = attributes as usize..end;
        let depth = self.namespaces.depth();
        for at in range.clone() {
            self.declare(lexer, at);
        }
        if self.namespaces.depth() > depth {
            self.scopes.push((after, depth));
        }
        let root = lexer.elements[0];
        let root_end = root.name + root.name_len;
        let written = self.input.slice(name, name + name_len);
        let namespace = match written.split_once(':') {
            None => Some(self.namespaces.default()),
            // That it is no name is told.
            Some(_) if lexer.tokens[token].flags & UNNAMED != 0 => Some(NO_NAMESPACE),
            Some((prefix, _)) => self.prefix(lexer, prefix, name, root_end),
        };
        if namespace.is_none() {
            lexer.tokens[token].flags |= UNNAMED | DAMAGED_TAG;
        }
        lexer.elements[element].namespace = namespace.unwrap_or(NO_NAMESPACE);
        self.attributes(lexer, token, range, root_end);
    }

    /// Takes a declaration, if the attribute is one.
    fn declare(&mut self, lexer: &mut Lexer<'a>, at: usize) {
        let RawAttribute { start, name_len, value, namespace, flags } = lexer.attributes[at];
        if namespace != XMLNS || flags & (NO_VALUE | UNSURE | DUPLICATE | BAD_NAME) != 0 {
            return;
        }
        let name = self.input.slice(start, start + name_len);
        let prefix = name.strip_prefix("xmlns:").unwrap_or_default();
        let uri = value::attribute_value(self.input.slice(value.start, value.end));
        if let Some(message) = refusal(prefix, &uri) {
            let end = lexer.attributes[at].end();
            lexer.faults.add(|| self.input.fault(&codes::XML_PREFIX, start, end, message));
            lexer.attributes[at].flags |= BAD_NAME;
            // That it is bound to nothing here is clear.
            self.unbound.insert(prefix);
            return;
        }
        self.namespaces.declare(prefix, uri);
    }

    /// Finds the namespaces of attributes with prefixes, and two of one namespace and name.
    fn attributes(&mut self, lexer: &mut Lexer<'a>, token: usize, range: std::ops::Range<usize>, root_end: u32) {
        let input = self.input;
        let mut seen: HashMap<(u32, &str), usize> = HashMap::new();
        for at in range {
            let RawAttribute { start, name_len, namespace, flags, .. } = lexer.attributes[at];
            if namespace != UNRESOLVED {
                continue;
            }
            let (prefix, local) = input.slice(start, start + name_len).split_once(':').unwrap_or_default();
            let is_named = flags & BAD_NAME == 0;
            let Some(found) = is_named.then(|| self.prefix(lexer, prefix, start, root_end)).flatten() else {
                lexer.attributes[at].namespace = NO_NAMESPACE;
                lexer.attributes[at].flags |= BAD_NAME;
                lexer.tokens[token].flags |= DAMAGED_TAG;
                continue;
            };
            lexer.attributes[at].namespace = found;
            // Two of the same name are found already.
            if flags & DUPLICATE == 0
                && let Some(before) = seen.insert((found, local), at)
            {
                let uri = self.namespaces.name(found);
                let (before, one) = (&lexer.attributes[before], &lexer.attributes[at]);
                lexer.faults.add(|| slips::duplicate(input, before, one, Some(uri)));
                lexer.attributes[at].flags |= DUPLICATE;
                lexer.tokens[token].flags |= DAMAGED_TAG;
            }
        }
    }

    /// The namespace of a prefix that is written at `start`; of an unbound one, which is reported once, the namespace
    /// that is meant.
    fn prefix(&mut self, lexer: &mut Lexer<'a>, prefix: &'a str, start: u32, root_end: u32) -> Option<u32> {
        if let Some(number) = self.namespaces.get(prefix) {
            return Some(number);
        }
        let bound = self.namespaces.prefixes();
        let (fault, meant) = unbound::prefix(self.input, prefix, start, &bound, root_end);
        if self.unbound.insert(prefix) {
            lexer.faults.add(|| fault);
        }
        match meant? {
            Meant::Namespace(uri) => Some(self.namespaces.number(uri.into())),
            Meant::Prefix(meant) => self.namespaces.get(meant),
        }
    }
}
