//! Loops of components, in the namespace of SAOMS.

use super::Loader;
use super::children::{Family, renaming};
use super::vocabulary::{COMPONENT_PROPERTY, LOOP};
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{LoopElement, Origin};
use crate::syntax::Element;

impl Loader<'_> {
    pub(super) fn looping(&mut self, element: Element<'_>) -> LoopElement {
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
        LoopElement {
            origin: Origin::of(element),
            name: self.name(element),
            class: self.optional(element, "class").map(Box::new),
            before: self.optional(element, "before").map(Box::new),
            after: self.optional(element, "after").map(Box::new),
            remove: self.boolean(element, "remove"),
            properties,
        }
    }

    /// Properties are of SCA, also in a loop.
    fn property_of_sca(&mut self, element: Element<'_>) {
        let prefix = element.document().root().prefix();
        let whole = prefix.map_or_else(|| "property".to_owned(), |prefix| format!("{prefix}:property"));
        let message = format!("{} is in the namespace of SAOMS", quoted(element.name()));
        let description = format!("replace {} with {}", quoted(element.name()), quoted(&whole));
        let one = Diagnostic::new(&codes::MISPLACED_ELEMENT, element.name_location(), message);
        let one = one.help("the properties of a loop are written as those of a component, as SCA has them");
        self.report(one.suggest_edits(description, renaming(element, prefix, "property")));
    }
}
