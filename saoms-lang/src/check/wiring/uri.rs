//! URIs such as `Robot001/move`, and the components that they name.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use super::misread_uri::{beside_user, inside, misread, unknown_component};
use super::target::fits;
use crate::check::contracts::offer::parts;
use crate::check::fleet::{Fleet, Side};
use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::limits::{Budget, WIRE_ENDS};
use crate::registry::{InterfaceDeclaration, RegisteredClass};
use crate::source::Text;

/// The parts of `component/part/binding`, each with its bytes.
pub(crate) struct Uri<'t> {
    /// True if the part is a service or a reference.
    pub(crate) side: Side,
    pub(crate) component: &'t str,
    pub(crate) part: Option<(&'t str, Range<usize>)>,
    pub(crate) binding: Option<(&'t str, Range<usize>)>,
    /// The interface that the component has to offer, where that is known.
    pub(crate) wants: Option<&'t InterfaceDeclaration>,
}

impl<'t> Uri<'t> {
    /// Splits a URI of at most `most` parts that names a service or a reference of a component in this scope; another
    /// one is reported.
    pub(crate) fn of(
        text: &'t Text,
        (most, side): (usize, Side),
        (scope, fleet): (usize, &Fleet<'_>),
        report: &mut Report<'_>,
    ) -> Option<Self> {
        let mut start = 0;
        let mut parts = text.split('/').map(|part| {
            let at = start..start + part.len();
            start = at.end + 1;
            (part, at)
        });
        let (component, _) = parts.next()?;
        let uri = Self { side, component, part: parts.next(), binding: parts.next(), wants: None };
        let has_more = parts.next().is_some() || (most < 3 && uri.binding.is_some());
        let inner = [uri.part.as_ref(), uri.binding.as_ref()];
        if component.is_empty() || inner.into_iter().flatten().any(|(part, _)| part.is_empty()) || has_more {
            let form = if most < 3 {
                "`component` or `component/name`"
            } else {
                "`component`, `component/service` or `component/service/binding`"
            };
            let message = format!("{} has the wrong form", quoted(text));
            let one = Diagnostic::new(&codes::URI_MALFORMED, text.location, message);
            let named: Vec<&str> = text.split('/').filter(|part| !part.is_empty()).collect();
            let meant = named.join("/");
            let is_known = named.first().is_some_and(|name| fleet.find(scope, name).is_some());
            let promoted = named.split_first().and_then(|(component, behind)| {
                inside(fleet.find(scope, component)?, behind, side, fleet).filter(|_| most < 3)
            });
            report.push(match promoted {
                Some(promoted) => promoted.add_to(one, text),
                None if is_known && named.len() <= most => one.replace(text, text.location, &meant),
                None if component.is_empty() => one.help(format!("write {form}, with no blank around the `/`")),
                None => one.help(format!("write {form}")),
            });
            return None;
        }
        Some(uri)
    }

    /// The component, which has to exist in the scope.
    ///
    /// `own` is the component that names it: another one is meant.
    pub(crate) fn member(
        &self,
        text: &Text,
        (scope, own): (usize, Option<usize>),
        fleet: &Fleet<'_>,
        rule: Option<&'static str>,
        report: &mut Report<'_>,
    ) -> Option<usize> {
        if let Some(found) = fleet.find(scope, self.component) {
            return Some(found);
        }
        if fleet.is_missing(scope, self.component) {
            return None;
        }
        let at = report.part(text, 0..self.component.len());
        if let Some(condition) = fleet.absent.get(&(scope, self.component)) {
            let message = format!("the component {} is excluded by its condition", quoted(self.component));
            let one = Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message);
            // Promotions are written in services and references of composites, and have a rule of their own.
            report.push(one.label(*condition, "this condition is false").help(match rule {
                None => "add the same condition to the element that names it",
                Some(_) => {
                    "put the component and the promotion into another composite, and include that with the same \
                    condition: a promotion cannot have a condition"
                }
            }));
            return None;
        }
        let one = if let Some([first, ..]) = fleet.group(scope, self.component) {
            let message = format!("{} names all replicas, expected one component", quoted(self.component));
            let first = quoted(&fleet.members[*first].component.name);
            let one = Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message);
            one.help(format!("name one of them, such as {first}"))
        } else {
            let message = format!("there is no component {}", quoted(self.component));
            match misread(text, scope, self.side, fleet) {
                Some(misread) => misread.add_to(Diagnostic::new(&codes::UNKNOWN_COMPONENT, at, message), text),
                None => {
                    let is_promoted = rule == Some(Side::Reference.rule());
                    let one = unknown_component(
                        self.component,
                        (scope, own),
                        (self.side, is_promoted),
                        at,
                        message,
                        fleet,
                        report,
                    );
                    let is_outside = beside_user(self.component, scope, fleet).is_some();
                    match self.wants.and_then(|wants| to_add(wants, scope, fleet)) {
                        Some(help) if one.suggestions.is_empty() && !is_outside => one.help(help),
                        _ => one,
                    }
                }
            }
        };
        report.push(Diagnostic { rule: rule.or(one.rule), ..one });
        None
    }
}

/// Advice to add a component of a class that offers an interface, where no component of the scope offers it.
fn to_add(wants: &InterfaceDeclaration, scope: usize, fleet: &Fleet<'_>) -> Option<String> {
    if fleet.scopes[scope]
        .members
        .iter()
        .any(|&member| fleet.offers(member).iter().any(|(_, offer)| fits(*offer, wants, fleet)))
    {
        return None;
    }
    let offers = |class: &&Arc<RegisteredClass>| class.declaration().services.iter().any(|one| one.interface == *wants);
    let mut classes = fleet.registry?.iter().filter(offers).map(|class| quoted(class.name()));
    Some(format!("add a component of the class {}", classes.next()?))
}

/// The texts that a text stands for which names components of a scope: itself, or one for each replica of a group, with
/// its place.
pub(crate) fn spread<'t>(
    text: &'t Text,
    scope: usize,
    fleet: &'t Fleet<'_>,
) -> impl Iterator<Item = (Cow<'t, Text>, Option<usize>)> + use<'t> {
    let (component, _) = parts(text);
    let members = fleet.group(scope, component);
    let itself = members.is_none().then_some((Cow::Borrowed(text), None));
    let rest = &text[component.len()..];
    let named = members.into_iter().flatten().map(move |&member| {
        let name = format!("{}{rest}", fleet.members[member].component.name);
        (Cow::Owned(Text::new(name.into(), text.location)), Some(member))
    });
    itself.into_iter().chain(named)
}

/// True if a target is an address on a network rather than a component.
pub(crate) fn is_address(text: &str) -> bool {
    let scheme = text.split(':').next().unwrap_or_default();
    scheme.len() < text.len() && !scheme.contains('/') && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
}

/// True if the budget of ends of wires has room for those of this target or source. That it has none is reported, once.
pub(crate) fn has_room(budget: &Budget, text: &Text, scope: usize, fleet: &Fleet<'_>, report: &mut Report<'_>) -> bool {
    let Some(group) = fleet.group(scope, parts(text).0) else { return true };
    let has_room = budget.spend(group.len() as u64);
    if !has_room && budget.is_to_report() {
        let message = format!("the groups of replicas have more than {WIRE_ENDS} ends of wires");
        let help = "use fewer replicas: each replica of the first group has a wire to each replica of the second";
        report.push(Diagnostic::new(&codes::FLEET_TOO_LARGE, text.location, message).help(help));
    }
    has_room
}
