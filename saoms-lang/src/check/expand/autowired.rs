//! Autowire of components whose classes are not known.

use super::Expanding;
use crate::check::fleet::Kind;
use crate::diagnostic::{Diagnostic, Severity, codes, quoted};
use crate::model::Reference;

impl Expanding<'_, '_> {
    /// A warning that autowire has more to choose from for a component once composites are resolved: before, those beside it (SCA Assembly 1.1, 4.3.1.1).
    /// What it chooses depends on a class that nobody knows.
    pub(super) fn widened(&self, place: usize) -> Option<Diagnostic> {
        let member = self.member(place);
        let all: usize = self.beside.iter().sum();
        let is_widened = self.beside[member.scope] < all;
        if member.kind != Kind::Given || !is_widened || !self.is_autowired(place) {
            return None;
        }
        let component = member.component;
        let own = component.autowire().filter(|said| said.value);
        let of_reference =
            component.references.iter().filter_map(Reference::autowire).find(|said| said.value);
        let said = own.or(member.composite.autowire).filter(|said| said.value).or(of_reference);
        let at = said.map_or(component.name.location, |said| said.location);
        let message = format!(
            "autowire wires component {} to others of its composite; once expanded, to any of all composites",
            quoted(&component.name)
        );
        let one = Diagnostic::new(&codes::TARGET_AMBIGUOUS, at, message).severity(Severity::Warning);
        Some(one.help("which they are only its class knows: give its references each a `target`"))
    }

    /// Whether a reference of a component may have targets by autowire.
    fn is_autowired(&self, place: usize) -> bool {
        let member = self.member(place);
        let component = member.component;
        let usual = component.autowire().map_or(member.autowire, |said| said.value);
        let is_open = |one: &Reference| {
            one.autowire().map_or(usual, |said| said.value) && self.ends((place, &one.name)).is_empty()
        };
        // Its class may have further references.
        usual || component.references.iter().any(is_open)
    }
}
