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
    pub(crate) fn contracts(
        &self,
        of @ (file, component): (usize, &Component),
        side: Side,
    ) -> Option<Vec<Contract<'_>>> {
        match component.implementation.as_ref()? {
            Implementation::Class(_) => self.of_class(of, side),
            Implementation::Composite(name) => {
                let inner = self.composite(file, name)?;
                let all = self.with_included(inner).iter().flat_map(|inner| {
                    let names = self.files[*inner].outline.promoted(side).iter();
                    names.map(move |name| self.promoted(*inner, name, side, DEEPEST))
                });
                Some(all.collect())
            }
        }
    }

    /// One of them: that of a name, or else the only one. Of a composite inside no others are followed.
    fn contract_in(
        &self,
        of @ (file, component): (usize, &Component),
        side: Side,
        name: Option<&str>,
        depth: usize,
    ) -> Option<Contract<'_>> {
        let inner = match component.implementation.as_ref()? {
            Implementation::Class(_) => {
                let all = self.of_class(of, side)?;
                return match name {
                    Some(name) => all.into_iter().find(|one| one.name == name),
                    None => only(all),
                };
            }
            Implementation::Composite(name) => self.composite(file, name)?,
        };
        let mut files = self.with_included(inner).iter().copied();
        let (file, named) = match name {
            Some(name) => files.find_map(|file| {
                let place = self.files[file].names().promoted(side, name)?;
                Some((file, &self.files[file].outline.promoted(side)[place]))
            })?,
            None => {
                let named = |file: usize| self.files[file].outline.promoted(side).iter().map(move |one| (file, one));
                let mut all = files.flat_map(named);
                all.next().filter(|_| all.next().is_none())?
            }
        };
        Some(self.promoted(file, named, side, depth))
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
            let part = end.part.as_ref().map(|part| part.text.as_str());
            self.contract_in(self.component(of, &component)?, side, part, depth)
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
        self.contract_in(of, side, Some(name), DEEPEST)
    }
}

/// The one that is meant where none is named: the only one. A service of the host counts where there is no other.
fn only(all: Vec<Contract<'_>>) -> Option<Contract<'_>> {
    let has_own = all.iter().any(|one| !one.is_of_host);
    let mut meant = all.into_iter().filter(|one| !has_own || !one.is_of_host);
    meant.next().filter(|_| meant.next().is_none())
}
