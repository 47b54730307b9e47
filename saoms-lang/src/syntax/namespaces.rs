//! The namespaces in scope.

use std::borrow::Cow;
use std::collections::HashMap;

use super::document::{NO_NAMESPACE, XMLNS};
use super::{XML_NAMESPACE, XMLNS_NAMESPACE};

/// The bindings of prefixes in scope, and all namespaces by number.
#[derive(Debug)]
pub(super) struct Namespaces<'a> {
    names: Vec<Box<str>>,
    numbers: HashMap<Box<str>, u32>,
    /// The namespace of elements without a prefix.
    default: u32,
    bound: HashMap<&'a str, u32>,
    /// The declarations that each one in scope replaced, to be put back.
    replaced: Vec<Replaced<'a>>,
}

/// A binding that a declaration replaced.
#[derive(Debug)]
struct Replaced<'a> {
    prefix: &'a str,
    before: Option<u32>,
}

impl<'a> Namespaces<'a> {
    pub(super) fn new() -> Self {
        let names: Vec<Box<str>> = vec!["".into(), XML_NAMESPACE.into(), XMLNS_NAMESPACE.into()];
        let numbers = names.iter().cloned().zip(0..).collect();
        Self { names, numbers, default: NO_NAMESPACE, bound: HashMap::from([("xml", 1)]), replaced: Vec::new() }
    }

    /// The number of declarations in scope, for [`Namespaces::leave`].
    #[inline]
    pub(super) fn depth(&self) -> u32 {
        self.replaced.len() as u32
    }

    /// Binds `prefix`, empty for the default namespace, to `uri`, empty for none.
    pub(super) fn declare(&mut self, prefix: &'a str, uri: Cow<'a, str>) {
        let number = self.number(uri);
        let before = if prefix.is_empty() {
            Some(std::mem::replace(&mut self.default, number))
        } else {
            self.bound.insert(prefix, number)
        };
        self.replaced.push(Replaced { prefix, before });
    }

    /// Undoes the declarations beyond the first `depth`.
    #[inline]
    pub(super) fn leave(&mut self, depth: u32) {
        for Replaced { prefix, before, .. } in self.replaced.drain(depth as usize..).rev() {
            match before {
                Some(number) if prefix.is_empty() => self.default = number,
                Some(number) => _ = self.bound.insert(prefix, number),
                None => _ = self.bound.remove(prefix),
            }
        }
    }

    /// The namespace of elements without a prefix.
    pub(super) fn default(&self) -> u32 {
        self.default
    }

    /// The namespace of a prefix, if it is bound.
    pub(super) fn get(&self, prefix: &str) -> Option<u32> {
        self.bound.get(prefix).copied()
    }

    /// The prefixes that are bound.
    pub(super) fn prefixes(&self) -> Vec<&'a str> {
        let mut all: Vec<&str> = self.bound.keys().copied().collect();
        all.sort_unstable();
        all
    }

    /// A namespace by its number.
    pub(super) fn name(&self, number: u32) -> &str {
        &self.names[number as usize]
    }

    /// All namespaces; the index is the number.
    pub(super) fn into_names(self) -> Vec<Box<str>> {
        self.names
    }

    /// The number of a namespace.
    pub(super) fn number(&mut self, uri: Cow<'a, str>) -> u32 {
        if let Some(&number) = self.numbers.get(&*uri) {
            return number;
        }
        let number = self.names.len() as u32;
        let uri: Box<str> = uri.into();
        self.names.push(uri.clone());
        self.numbers.insert(uri, number);
        number
    }
}

/// The reason why a prefix cannot be bound to a namespace (Namespaces in XML 1.0, section 3), if it cannot.
pub(super) fn refusal(prefix: &str, uri: &str) -> Option<&'static str> {
    match (prefix, uri) {
        ("xmlns", _) => Some("the prefix `xmlns` cannot be declared"),
        ("xml", XML_NAMESPACE) => None,
        ("xml", _) => Some("the prefix `xml` stands for its own namespace and for no other"),
        (_, XML_NAMESPACE) => Some("no prefix but `xml` can stand for the namespace of `xml`"),
        (_, XMLNS_NAMESPACE) => Some("nothing can be bound to the namespace of declarations"),
        ("", _) => None,
        (_, "") => Some("a prefix cannot be bound to no namespace"),
        _ => None,
    }
}

const _: () = assert!(XMLNS == 2 && NO_NAMESPACE == 0, "the numbers that `Namespaces::new` gives");
