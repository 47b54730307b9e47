//! Services and references of components, whatever implements them.

use crate::check::contracts::multiplicity::of_class;
use crate::check::fleet::{Fleet, Kind};
use crate::model::Multiplicity;
use crate::registry::InterfaceDeclaration;

/// A reference of a component, by its name.
pub(crate) type ReferenceId<'f> = (usize, &'f str);

/// A service of a component of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Provider {
    pub(crate) member: usize,
    /// The place of the service in the class.
    pub(crate) service: usize,
}

/// The component of a URI, and the name behind it.
pub(crate) fn parts(uri: &str) -> (&str, Option<&str>) {
    let (component, rest) = uri.split_once('/').map_or((uri, None), |(component, rest)| (component, Some(rest)));
    (component, rest.map(|rest| rest.split('/').next().unwrap_or(rest)))
}

/// The meaning of the name of a service.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Offer {
    /// The service of a component of a class; where a composite promotes it, the one that is promoted.
    Service(Provider),
    /// Nothing that could be looked at: taken as given, or with a fault that is reported.
    Open,
    /// Nothing.
    Missing,
}

impl<'a> Fleet<'a> {
    /// The names of the services of a component; `None` where any may be there.
    pub(crate) fn service_names(&self, member: usize) -> Option<Vec<&str>> {
        Some(match self.class_of(member) {
            Some(class) => class.services.iter().map(|service| service.name.as_str()).collect(),
            None => self.inner(member)?.services().map(|service| service.name.as_str()).collect(),
        })
    }

    /// The names of the references of a component; `None` where any may be there.
    pub(crate) fn reference_names(&self, member: usize) -> Option<Vec<&str>> {
        Some(match self.class_of(member) {
            Some(class) => class.references.iter().map(|reference| reference.name.as_str()).collect(),
            None => self.inner(member)?.references().map(|reference| reference.name.as_str()).collect(),
        })
    }

    /// The service of a component that is meant where none is named: the only one. What the host serves for a component
    /// counts where there is no other.
    pub(crate) fn only_service(&self, member: usize) -> Option<&str> {
        let names = match self.class_of(member) {
            Some(class) if class.services.iter().any(|service| !service.is_of_host()) => {
                let own = class.services.iter().filter(|service| !service.is_of_host());
                own.map(|service| service.name.as_str()).collect()
            }
            _ => self.service_names(member)?,
        };
        if let [only] = names[..] { Some(only) } else { None }
    }

    /// The service of this name of a component.
    pub(crate) fn offer(&self, member: usize, name: &str) -> Offer {
        // What a composite promotes and is not there is reported where it is promoted.
        let mut missing = Offer::Missing;
        let (mut member, mut name) = (member, name);
        loop {
            let scope = match self.members[member].kind {
                Kind::Class(class) => {
                    let found = self.classes[class].services.iter().position(|service| service.name == name);
                    return found.map_or(missing, |service| Offer::Service(Provider { member, service }));
                }
                Kind::Composite(scope) => scope,
                Kind::Given | Kind::Nothing => return Offer::Open,
            };
            let service = self.inner(member).and_then(|inner| inner.services().find(|service| service.name == name));
            let Some(service) = service else { return missing };
            missing = Offer::Open;
            // Each step leads one composite further in. What does not lead on is reported where it is written.
            let next = service.promote.as_ref().and_then(|promote| {
                let (component, part) = parts(promote);
                let member = self.find(scope, component)?;
                Some((member, part.or_else(|| self.only_service(member))?))
            });
            match next {
                Some(next) => (member, name) = next,
                None => return Offer::Open,
            }
        }
    }

    /// Every service of a component by name, as far as it is known.
    pub(crate) fn offers(&self, member: usize) -> Vec<(&str, Offer)> {
        let names = self.service_names(member).unwrap_or_default();
        names.into_iter().map(|name| (name, self.offer(member, name))).collect()
    }

    /// The interface of a service.
    pub(crate) fn interface_of(&self, provider: Provider) -> Option<&InterfaceDeclaration> {
        Some(&self.class_of(provider.member)?.services[provider.service].interface)
    }

    /// The number of targets a reference of a component can have, as far as that is known.
    pub(crate) fn multiplicity(&self, (member, name): ReferenceId<'_>) -> Option<Multiplicity> {
        let implied = match self.members[member].kind {
            Kind::Class(class) => {
                let mut declared = self.classes[class].references.iter();
                declared.find(|declared| declared.name == name).map(|declared| of_class(declared))
            }
            Kind::Composite(_) => Some(Multiplicity::One),
            Kind::Given | Kind::Nothing => None,
        };
        self.given_multiplicity((member, name)).or(implied)
    }

    /// The multiplicity that the component or the composite that implements it writes.
    pub(crate) fn given_multiplicity(&self, (member, name): ReferenceId<'_>) -> Option<Multiplicity> {
        let own = self.members[member].component.reference(name);
        let inner = self.inner(member).and_then(|inner| inner.references().find(|one| one.name == name));
        [own, inner].into_iter().flatten().find_map(|one| Some(one.multiplicity?.value))
    }
}
