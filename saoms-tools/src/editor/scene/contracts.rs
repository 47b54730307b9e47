//! Services and references of components, followed through promotions to the classes behind them.

use saoms_lang::registry::InterfaceDeclaration;

use super::Scene;
use super::outline::{Component, Implementation, Named, Side};

/// The number of composites that a promotion is followed into.
const DEEPEST: usize = 16;

/// A service or a reference of a component.
#[derive(Clone, Debug)]
pub(crate) struct Contract<'s> {
    pub(crate) name: &'s str,
    /// `None` where it cannot be known.
    pub(crate) interface: Option<&'s InterfaceDeclaration>,
    /// The number of targets of a reference; `None` for services, and where it cannot be known.
    pub(crate) multiplicity: Option<&'static str>,
    /// True if the host serves it for every task.
    pub(crate) is_of_host: bool,
}

impl Scene {
    /// The services or the references of a component of a file; `None` where any can be there.
    pub(crate) fn contracts(&self, of: (usize, &Component), side: Side) -> Option<Vec<Contract<'_>>> {
        self.contracts_in(of, side, DEEPEST)
    }

    fn contracts_in(
        &self,
        (file, component): (usize, &Component),
        side: Side,
        depth: usize,
    ) -> Option<Vec<Contract<'_>>> {
        match component.implementation.as_ref()? {
            Implementation::Class(_) => self.of_class((file, component), side),
            Implementation::Composite(name) => {
                let inner = self.composite(file, name)?;
                let all = self.with_included(inner).into_iter().flat_map(|inner| {
                    let outline = &self.files[inner].outline;
                    let names = if side == Side::Service { &outline.services } else { &outline.references };
                    names.iter().map(move |name| self.promoted(inner, name, side, depth))
                });
                Some(all.collect())
            }
        }
    }

    fn of_class(&self, of: (usize, &Component), side: Side) -> Option<Vec<Contract<'_>>> {
        let class = self.class(of.1)?.declaration();
        if side == Side::Service {
            let all = class.offers().map(|one| Contract {
                name: &one.name,
                interface: Some(&one.interface),
                multiplicity: None,
                is_of_host: one.is_of_host(),
            });
            return Some(all.collect());
        }
        let mut all: Vec<Contract<'_>> = Vec::new();
        let of_loops = self.loops(of).flat_map(|one| &one.declaration().references);
        for one in class.references.iter().chain(of_loops) {
            if all.iter().any(|known| known.name == one.name) {
                continue;
            }
            let multiplicity = match (one.optional, one.many) {
                (true, true) => "0..n",
                (true, false) => "0..1",
                (false, true) => "1..n",
                (false, false) => "1..1",
            };
            all.push(Contract {
                name: &one.name,
                interface: Some(&one.interface),
                multiplicity: Some(multiplicity),
                is_of_host: false,
            });
        }
        Some(all)
    }

    /// The promotions of a composite under a name.
    fn promoted<'s>(&'s self, file: usize, name: &'s Named, side: Side, depth: usize) -> Contract<'s> {
        let found = depth.checked_sub(1).and_then(|depth| {
            let end = self.files[file].outline.ends_of(name.element).find(|end| end.side == side)?;
            let (of, component) = self.named(file, &end.component.text);
            let of = self.component(of, &component)?;
            let all = self.contracts_in(of, side, depth)?;
            match &end.part {
                Some(part) => all.into_iter().find(|one| one.name == part.text),
                None => only(all),
            }
        });
        Contract {
            name: &name.text,
            interface: found.as_ref().and_then(|one| one.interface),
            multiplicity: found.and_then(|one| one.multiplicity),
            is_of_host: false,
        }
    }

    /// The service or reference of this name of a component.
    pub(crate) fn contract(&self, of: (usize, &Component), side: Side, name: &str) -> Option<Contract<'_>> {
        self.contracts(of, side)?.into_iter().find(|one| one.name == name)
    }
}

/// The one that is meant where none is named: the only one. A service of the host counts where there is no other.
fn only(all: Vec<Contract<'_>>) -> Option<Contract<'_>> {
    let has_own = all.iter().any(|one| !one.is_of_host);
    let mut meant = all.into_iter().filter(|one| !has_own || !one.is_of_host);
    meant.next().filter(|_| meant.next().is_none())
}
