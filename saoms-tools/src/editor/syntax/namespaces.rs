//! Which elements are of SCA, which of SAOMS, and which of others.

use saoms_lang::load::vocabulary::{COMPOSITE, CONTRIBUTION, Kind, LOOP, OWN_ELEMENTS, SEVERITY};
use saoms_lang::model::{SAOMS_NAMESPACE, Version};

use super::{Tree, local};

/// Whose element it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    Sca,
    Own,
    Foreign,
}

impl Tree {
    /// The namespace that a prefix, "" for none, is bound to at an element.
    pub(crate) fn resolve<'t>(&self, text: &'t str, element: usize, prefix: &str) -> Option<&'t str> {
        let mut here = Some(element);
        while let Some(one) = here {
            for attribute in &self.elements[one].attributes {
                let bound = match &text[attribute.name.clone()] {
                    "xmlns" => prefix.is_empty(),
                    name => !prefix.is_empty() && name.strip_prefix("xmlns:") == Some(prefix),
                };
                if let (true, Some(value)) = (bound, &attribute.value) {
                    return Some(&text[value.clone()]);
                }
            }
            here = self.elements[one].parent;
        }
        None
    }

    /// The prefix that is bound to a namespace at an element; "" for the default namespace.
    pub(crate) fn prefix_of<'t>(&self, text: &'t str, element: usize, namespace: &str) -> Option<&'t str> {
        let mut here = Some(element);
        while let Some(one) = here {
            for attribute in &self.elements[one].attributes {
                if attribute.value.as_ref().is_some_and(|value| &text[value.clone()] == namespace) {
                    match &text[attribute.name.clone()] {
                        "xmlns" => return Some(""),
                        name => {
                            if let Some(prefix) = name.strip_prefix("xmlns:") {
                                return Some(prefix);
                            }
                        }
                    }
                }
            }
            here = self.elements[one].parent;
        }
        None
    }

    /// The version of SCA that the root is of; 1.1 while it says none.
    pub(crate) fn version(&self, text: &str) -> Version {
        let namespace = self.elements.first().and_then(|root| {
            let name = &text[root.name.clone()];
            self.resolve(text, 0, name.rsplit_once(':').map_or("", |(prefix, _)| prefix))
        });
        namespace.and_then(Version::from_namespace).unwrap_or(Version::Oasis200912)
    }

    /// Whose an element is. While the namespace is not there yet, what has the prefix of the root is of SCA.
    pub(crate) fn family(&self, text: &str, element: usize) -> Family {
        let prefix_of = |one: usize| {
            let name = &text[self.elements[one].name.clone()];
            name.rsplit_once(':').map_or("", |(prefix, _)| prefix)
        };
        let prefix = prefix_of(element);
        match self.resolve(text, element, prefix) {
            Some(SAOMS_NAMESPACE) => Family::Own,
            Some(namespace) if Version::from_namespace(namespace).is_some() => Family::Sca,
            _ if prefix == prefix_of(0) => Family::Sca,
            None if prefix == "saoms" => Family::Own,
            _ => Family::Foreign,
        }
    }

    /// What is known of each element, by its name and where it stands.
    pub(crate) fn kinds(&self, text: &str) -> Vec<Option<&'static Kind>> {
        let mut kinds: Vec<Option<&'static Kind>> = Vec::with_capacity(self.elements.len());
        for (place, element) in self.elements.iter().enumerate() {
            kinds.push(match element.parent {
                Some(parent) => kinds[parent].and_then(|parent| self.kind_in(text, parent, place)),
                None => {
                    [&COMPOSITE, &CONTRIBUTION].into_iter().find(|kind| self.local(text, place) == kind.name)
                }
            });
        }
        kinds
    }

    /// What is known of an element in one of a kind.
    fn kind_in(&self, text: &str, parent: &'static Kind, element: usize) -> Option<&'static Kind> {
        let name = self.local(text, element);
        match self.family(text, element) {
            Family::Own if name == LOOP.name => Some(&LOOP),
            Family::Own if name == SEVERITY.name => Some(&SEVERITY),
            Family::Own if !OWN_ELEMENTS.contains(&name) => None,
            Family::Foreign => None,
            _ => parent.child(name),
        }
    }
}

/// The prefix of a name with its colon; empty for none.
pub(crate) fn prefix(name: &str) -> &str {
    &name[..name.len() - local(name).len()]
}
