//! Which composites the expressions of a unit see: what is included by a condition may declare what another one
//! declares that is there in place of it.

use crate::check::unfolding::Unfolding;
use crate::expression::{boolean, parse};
use crate::model::{Composite, Contribution, Include, Link};

/// Rounds in which conditions are evaluated again with the properties of what others include.
const MOST_ROUNDS: usize = 100;

/// Composites in the order in which their properties count.
struct Included<'a> {
    contribution: &'a Contribution,
    all: Vec<&'a Composite>,
    /// Includes of these by a condition that is not decided.
    open: Vec<&'a Include>,
}

impl<'a> Unfolding<'a> {
    /// The composites of a unit and of what it includes: those that are there, and in a unit that is kept away then
    /// also those that conditions keep away, whose parts name their properties.
    pub(super) fn included(&mut self, unit: usize, owner: Option<usize>) -> Vec<&'a Composite> {
        let contribution = self.fleet.contribution;
        let mut included = Included { contribution, all: Vec::new(), open: Vec::new() };
        included.add(self.fleet.units[unit].main());
        let mut absent: Vec<&'a Include> = Vec::new();
        for _ in 0..MOST_ROUNDS {
            let open = std::mem::take(&mut included.open);
            if open.is_empty() {
                break;
            }
            let (count, before) = (open.len(), included.all.len());
            let names = self.names_in(&included.all, unit, owner);
            for include in open {
                let Some(condition) = &include.condition else { continue };
                match parse(condition).and_then(|one| boolean(&one, &mut |name| names.value(name))) {
                    Ok(true) => included.follow(include),
                    Ok(false) => absent.push(include),
                    // It may ask for what another one declares.
                    Err(_) => included.open.push(include),
                }
            }
            if included.all.len() == before && included.open.len() == count {
                break;
            }
        }
        if !self.fleet.units[unit].is_absent {
            return included.all;
        }
        let mut rest = [std::mem::take(&mut included.open), absent].concat();
        while !rest.is_empty() {
            rest.into_iter().for_each(|include| included.follow(include));
            rest = std::mem::take(&mut included.open);
        }
        included.all
    }
}

impl<'a> Included<'a> {
    fn follow(&mut self, include: &'a Include) {
        if let Some(Link::To(place)) = self.contribution.link(include.origin) {
            self.add(&self.contribution.composites()[*place]);
        }
    }

    /// Adds a composite and what it includes in any case.
    fn add(&mut self, composite: &'a Composite) {
        let mut next = self.all.len();
        let is_known = |all: &[&'a Composite], one| all.iter().any(|known| std::ptr::eq(*known, one));
        if !is_known(&self.all, composite) {
            self.all.push(composite);
        }
        while let Some(composite) = self.all.get(next).copied() {
            next += 1;
            for include in &composite.includes {
                if include.condition.is_some() {
                    self.open.push(include);
                } else if let Some(Link::To(place)) = self.contribution.link(include.origin) {
                    let included = &self.contribution.composites()[*place];
                    if !is_known(&self.all, included) {
                        self.all.push(included);
                    }
                }
            }
        }
    }
}
