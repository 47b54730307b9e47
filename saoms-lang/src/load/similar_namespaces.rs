//! Namespaces that are nearly those of SCA or SAOMS: what is in them would be passed over in silence.

use std::collections::{HashMap, HashSet};

use super::Loader;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{SAOMS_NAMESPACE, Version};
use crate::syntax::{Attribute, Document};

impl Loader<'_> {
    /// Reports declarations of such namespaces, where elements or attributes are in them. That of the root is judged
    /// with it.
    pub(super) fn similar_namespaces(&mut self, document: &Document) {
        let near = document.namespaces().filter(|one| *one != self.namespace && *one != document.root().namespace());
        let near: Vec<(&str, &str)> = near.filter_map(|one| Some((one, meant(one)?))).collect();
        if near.is_empty() {
            return;
        }
        let (mut used, mut declared) = (HashSet::new(), HashMap::new());
        for element in document.elements() {
            used.insert(element.namespace());
            used.extend(element.attributes().map(Attribute::namespace));
            for one in element.namespace_declarations() {
                declared.entry(one.value()).or_insert(one);
            }
        }
        for (written, meant) in near {
            let Some(first) = declared.get(written).filter(|_| used.contains(written)) else { continue };
            let at = first.value_span().in_file(document.file());
            let message =
                format!("what is in the namespace {} is passed over: it is nearly {}", quoted(written), quoted(meant));
            let one = Diagnostic::new(&codes::NAMESPACE_NEAR, at, message);
            self.report(one.suggest(format!("replace it with {}", quoted(meant)), at, meant));
        }
    }
}

/// The namespace that is meant by one that differs in a slip of the pen.
fn meant(written: &str) -> Option<&'static str> {
    if written == SAOMS_NAMESPACE || Version::from_namespace(written).is_some() {
        return None;
    }
    let of_sca = Version::ALL.map(Version::namespace).into_iter().find(|known| {
        // Drafts and other versions have numbers of their own.
        let is_other_version = known.len() == written.len()
            && known.bytes().zip(written.bytes()).all(|(a, b)| a == b || a.is_ascii_digit() && b.is_ascii_digit());
        is_slip(written, known) && !is_other_version
    });
    of_sca.or_else(|| is_slip(written, SAOMS_NAMESPACE).then_some(SAOMS_NAMESPACE))
}

/// True if two texts differ in their case, in one character, or in two that stand together.
fn is_slip(written: &str, meant: &str) -> bool {
    let (written, meant) = (written.trim().trim_end_matches('/').to_lowercase(), meant.to_lowercase());
    let (one, other) = (written.as_bytes(), meant.as_bytes());
    let longest = one.len().max(other.len());
    let same = one.iter().zip(other).take_while(|(a, b)| a == b).count();
    let room = one.len().min(other.len()) - same;
    let behind = one.iter().rev().zip(other.iter().rev()).take(room).take_while(|(a, b)| a == b).count();
    longest - same - behind <= 2
}
