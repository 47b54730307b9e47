//! The services that autowire chooses from.

use std::collections::HashMap;

use crate::check::contracts::offer::{Offer, Provider};
use crate::check::fleet::Fleet;
use crate::registry::InterfaceDeclaration;

/// The services of each scope by interface, collected when they are asked for.
#[derive(Default)]
pub(crate) struct Autowire<'c> {
    scopes: HashMap<usize, Services<'c>>,
}

/// The services in one scope.
#[derive(Default)]
struct Services<'c> {
    /// By the name of the interface, with the component of the scope that offers each.
    by_interface: HashMap<&'c str, Vec<(usize, Provider)>>,
    /// True if there are components whose services are not known.
    is_open: bool,
}

impl<'c> Autowire<'c> {
    /// The services with an interface in a scope, at most so many, each with the component of the scope that offers it,
    /// which is another one than the one that asks; and whether there may be more.
    pub(crate) fn offers(
        &mut self,
        (scope, asking): (usize, usize),
        most: usize,
        interface: &InterfaceDeclaration,
        fleet: &'c Fleet<'_>,
    ) -> (Vec<(usize, Provider)>, bool) {
        let services = self.scopes.entry(scope).or_insert_with(|| Services::of(scope, fleet));
        let named = services.by_interface.get(interface.name.as_str()).map_or(&[][..], Vec::as_slice);
        let fits = |provider: Provider| fleet.interface_of(provider) == Some(interface);
        let others = named.iter().filter(|(offering, _)| *offering != asking);
        let fitting = others.filter(|(_, provider)| fits(*provider)).copied();
        (fitting.take(most).collect(), services.is_open)
    }
}

impl<'c> Services<'c> {
    fn of(scope: usize, fleet: &'c Fleet<'_>) -> Self {
        let mut all = Self::default();
        for &member in &fleet.scopes[scope].members {
            all.is_open |= fleet.service_names(member).is_none();
            for (_, offer) in fleet.offers(member) {
                match offer {
                    Offer::Service(provider) => {
                        let Some(interface) = fleet.interface_of(provider) else { continue };
                        all.by_interface.entry(&interface.name).or_default().push((member, provider));
                    }
                    Offer::Open => all.is_open = true,
                    Offer::Missing => {}
                }
            }
        }
        all
    }
}
